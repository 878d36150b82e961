/* Counts what visitors look at, together with the language they use: storage/usage.h. */
#ifndef GOPURA_APP_VISIT_COUNTING_H
#define GOPURA_APP_VISIT_COUNTING_H

#include "app/view/exhibit.h"
#include "storage/usage.h"

struct counting {
	struct usage *usage; /* owned; NULL: nothing is counted */
	const struct exhibit *shown;
};

/* Opens the counts. path: their file; copy_path: of a copy, or NULL; both are borrowed for the
 * call. shown is borrowed for the counting's life. Returns 0 or a negative errno. */
must_check int counting_init(struct counting *counting, const struct exhibit *shown,
			     const char *path, const char *copy_path);
void counting_finish(struct counting *counting); /* a zeroed one is fine */

/* Counts that a visitor looked at the part; -1: at something that belongs to no part. */
void counting_part(struct counting *counting, enum usage_kind kind, int part);
/* The same, by the id of a part or tour. */
void counting_id(struct counting *counting, enum usage_kind kind, const char *id);
/* Writes the counts to disk. */
void counting_write(struct counting *counting);

#endif
