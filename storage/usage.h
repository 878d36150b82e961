/* What visitors looked at, counted without anything about them: how often in each hour a visit
 * began, a part's card or page was opened, a language chosen, the search opened, a tour begun. Kept
 * 400 days in one file of text, which is the CSV that is handed out (docs/visitors.md).
 *
 * Counts are gathered in memory and added as lines at the file's end, without waiting for the disk:
 * a power cut costs the last half minute at most, a torn line is dropped at the next start, and
 * what stands twice is summed then. One thread. */
#ifndef GOPURA_STORAGE_USAGE_H
#define GOPURA_STORAGE_USAGE_H

#include <stdint.h>

#include "base/compiler.h"

enum usage_kind { USAGE_VISIT, USAGE_PART, USAGE_PAGE, USAGE_LANGUAGE, USAGE_SEARCH, USAGE_TOUR };

enum { USAGE_KEPT_DAYS = 400, USAGE_FILE_MAX = 32 << 20 };

struct usage;

/* The file at path is read, summed up and freed of what is too old and of what is no line of ours.
 * copy_path (NULL: none) gets the same and is kept like it: for those who must not see into path's
 * folder. now_s: wall clock, 0 where it is not known to be set. *out is owned by the caller.
 * -ENOMEM alone: what the disk refuses is logged, and counts are gathered all the same. */
must_check int usage_create(struct usage **out, const char *path, const char *copy_path,
			    int64_t now_s);
void usage_destroy(struct usage *usage); /* writes; NULL is fine */

/* what: a part's or tour's id, or ""; letters, digits, - and _ alone. language: likewise. */
void usage_add(struct usage *usage, enum usage_kind kind, const char *what, const char *language,
	       int64_t now_s);
/* What was counted since goes to the file. */
void usage_write(struct usage *usage);

#endif
