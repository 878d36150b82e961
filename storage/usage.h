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

enum tally_kind { TALLY_VISIT, TALLY_PART, TALLY_PAGE, TALLY_LANGUAGE, TALLY_SEARCH, TALLY_TOUR };

enum { TALLY_KEPT_DAYS = 400, TALLY_FILE_MOST = 32 << 20 };

struct tally;

/* The file at path is read, summed up and freed of what is too old and of what is no line of ours.
 * copy_path (NULL: none) gets the same and is kept like it: for those who must not see into path's
 * folder. now_s: wall clock, 0 where it is not known to be set. *out is owned by the caller.
 * -ENOMEM alone: what the disk refuses is logged, and counts are gathered all the same. */
must_check int tally_create(struct tally **out, const char *path, const char *copy_path,
			    int64_t now_s);
void tally_destroy(struct tally *tally); /* writes; NULL is fine */

/* what: a part's or tour's id, or ""; letters, digits, - and _ alone. language: likewise. */
void tally_add(struct tally *tally, enum tally_kind kind, const char *what, const char *language,
	       int64_t now_s);
/* What was counted since goes to the file. */
void tally_write(struct tally *tally);

#endif
