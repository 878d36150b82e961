/* Files for people, of [section]s and key = value lines, read by inih. Unlike inih's own callback
 * a key must stand in a table, so that a misspelt one is a complaint with its line and not a
 * setting that silently does nothing. */
#ifndef GOPURA_BASE_INI_H
#define GOPURA_BASE_INI_H

#include <stdbool.h>
#include <stddef.h>

#include "base/compiler.h"
#include "base/fault.h"

struct ini_key {
	const char *section; /* "": before the first section */
	const char *name;
	const char *expects; /* for the complaint: "a number from 8 to 32" */
	/* False: value is not what the key expects. value is borrowed. */
	bool (*set)(void *target, const char *value);
};

/* Each key of the file that the table knows is handed to its set, in the file's order. Comments
 * begin with # or ; at a line's start, or with ; behind a value. -EBADMSG with a fault
 * "PATH:LINE: ..." for what is no such line, for a key that the table does not know or that stands
 * twice, and for a value that set refuses; other errors are the file's. What was set before the
 * fault stays set. */
must_check int ini_read(const char *path, const struct ini_key *keys, size_t key_count,
			void *target, struct fault *fault);

/* ---- values, for set functions; false leaves *out as it was */

/* One finite number in least .. most, and nothing behind it. */
bool ini_number(const char *value, double least, double most, double *out);
/* 1 to most numbers, separated by spaces or commas; *count is how many. */
bool ini_numbers(const char *value, double *out, size_t most, size_t *count);
/* One whole number in least .. most. */
bool ini_whole(const char *value, long least, long most, long *out);
bool ini_yes_no(const char *value, bool *out); /* yes, no, true, false, on, off */
/* Index of value in names, a table that ends with NULL. */
bool ini_choice(const char *value, const char *const *names, int *out);
bool ini_colour(const char *value, unsigned char rgb[3]); /* #rrggbb, also in quotes */

#endif
