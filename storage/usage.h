/* Counts what visitors look at, without any personal data: how often in each hour a visit began, a
 * part's card or page was opened, a language was chosen, the search was opened, a tour was started.
 * Counts are kept for 400 days in one text file, the CSV that is handed out (docs/visitors.md).
 *
 * Counts are collected in memory. usage_write, called when a visit ends, appends them to the file
 * without waiting for the disk. A power cut loses what was counted since then, and what the kernel
 * had not yet written. At the start, and when the file has grown much, it is made tidy: an
 * incomplete line is dropped, and repeated entries are added up. One thread. */
#ifndef GOPURA_STORAGE_USAGE_H
#define GOPURA_STORAGE_USAGE_H

#include <stdint.h>

#include "base/compiler.h"

enum usage_kind { USAGE_VISIT, USAGE_PART, USAGE_PAGE, USAGE_LANGUAGE, USAGE_SEARCH, USAGE_TOUR };

enum { USAGE_KEPT_DAYS = 400, USAGE_FILE_MAX = 32 << 20 };

struct usage;

/* Reads the file at path, adds up its entries, and removes what is too old or not valid; nothing is
 * too old if most is, because then the clock is wrong. Of a file that is larger than USAGE_FILE_MAX
 * the newest half of that is read. copy_path (NULL: none) gets the same contents and is kept up to
 * date: for programs that must not read path's folder. now_s: wall clock, seconds since 1970; 0 if
 * it may not be set. *out is owned by the caller. Fails only with -ENOMEM: other errors are logged,
 * and counting goes on in memory. */
must_check int usage_create(struct usage **out, const char *path, const char *copy_path,
			    int64_t now_s);
void usage_destroy(struct usage *usage); /* writes what is pending; NULL is fine */

/* Adds one event. what: the id of a part or tour, or "". what and language may contain only
 * letters, digits, - and _; other values count as "". */
void usage_add(struct usage *usage, enum usage_kind kind, const char *what, const char *language,
	       int64_t now_s);
/* Appends what was counted since the last write to the file. If the file has grown much, it is made
 * tidy, which waits for the disk. */
void usage_write(struct usage *usage);

#endif
