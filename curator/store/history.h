/* Versions of files in a bare Git repository, by libgit2: who changed what, and when. It knows no
 * folder: curator/store/documents.h keeps one and the history equal. One thread at a time.
 *
 * A change has two steps, so that a program that is killed leaves neither half of it: it is staged
 * (a commit that refs/gopura/staged names), the caller writes its files, and it is accepted
 * (refs/heads/main names it). What is staged when the program starts is finished or given up then.
 */
#ifndef GOPURA_CURATOR_STORE_HISTORY_H
#define GOPURA_CURATOR_STORE_HISTORY_H

#include <stdbool.h>

#include "base/bytes.h"
#include "base/diagnostics.h"

enum {
	HISTORY_ID_BYTES = 41, /* 40 digits in hex, and an end */
	HISTORY_AUTHOR_BYTES = 65,
	HISTORY_WHAT_BYTES = 200,
};

struct history;

/* A file in a version, or a change of one. */
struct history_file {
	const char *name;          /* borrowed */
	char id[HISTORY_ID_BYTES]; /* of its bytes; "": it is removed */
};

/* A version of one file. */
struct history_version {
	char id[HISTORY_ID_BYTES];
	char text_id[HISTORY_ID_BYTES]; /* of the file's bytes then; "": it was removed */
	char author[HISTORY_AUTHOR_BYTES];
	char what[HISTORY_WHAT_BYTES]; /* one line */
	int64_t time_s;                /* since 1970 */
};

/* Opens a repository, or makes it. The caller is the only one who writes to it: locks that are
 * there are of a program that was killed, and are removed. A repository that is damaged is renamed
 * to PATH.broken-TIME, with a warning, and a new one is made. *out is owned by the caller; NULL on
 * failure, which has a diagnostic. */
must_check int history_open(struct history **out, const char *path,
			    struct diagnostics *diagnostics);
void history_close(struct history *history); /* NULL is fine */

/* Gives the id that bytes have. */
must_check int history_id(struct bytes bytes, char id[HISTORY_ID_BYTES]);
/* Keeps bytes, which are reachable from the next version that names them. */
must_check int history_put(struct history *history, struct bytes bytes, char id[HISTORY_ID_BYTES]);
/* Appends the bytes of an id. -ENOENT: there are none. -EINVAL: it is no id. -EBADMSG: damaged. */
must_check int history_get(struct history *history, const char *id, struct buffer *out);

/* Calls for each file of the newest version, by name; a negative result ends it and is returned. */
must_check int history_each(struct history *history,
			    int (*call)(void *user, const struct history_file *file), void *user);

/* Begins a change of the newest version. author is one line, what is cut to one. */
must_check int history_stage(struct history *history, const struct history_file *files,
			     uint32_t count, const char *author, const char *what);
bool history_has_staged(const struct history *history);
/* Calls for each file that the staged change changes: before is its id until then, "": none. */
must_check int history_each_staged(struct history *history,
				   int (*call)(void *user, const struct history_file *file,
					       const char *before),
				   void *user);
/* Makes the staged change the newest version. */
must_check int history_accept(struct history *history);
/* Forgets the staged change. */
must_check int history_give_up(struct history *history);

/* Lists the versions of a file, the newest first, at most max; *count is how many. */
must_check int history_list(struct history *history, const char *name, struct history_version *out,
			    uint32_t max, uint32_t *count);
/* Finds the bytes that a file had in a version. -ENOENT: no such version, or not in it. -EINVAL. */
must_check int history_find(struct history *history, const char *version, const char *name,
			    char id[HISTORY_ID_BYTES]);

#endif
