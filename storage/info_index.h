/* Private to storage: the full-text index over information_contents, an FTS5 table without contents
 * of its own ("search": title, caption, body; a row a content_id). It holds the words of words.h.
 */
#ifndef GOPURA_STORAGE_INFO_INDEX_H
#define GOPURA_STORAGE_INFO_INDEX_H

#include <sqlite3.h>

#include "base/bytes.h"

struct info_index_options {
	bool temporary;   /* in temp, for an image that has none; else in main */
	bool has_reading; /* information_contents has that column */
};

/* Makes and fills it. SQLITE_OK, or SQLite's code. */
must_check int info_index_make(sqlite3 *db, const struct info_index_options *options);

/* A row that was found; false: enough. */
typedef bool info_index_hit(void *data, int64_t content_id);

/* Every row that holds every word of text, those again that were found before: in titles, then in
 * titles and captions, then anywhere; of these by bm25, and by importance. SQLITE_OK, or SQLite's
 * code. */
must_check int info_index_find(sqlite3 *db, const char *text, info_index_hit *hit, void *data);

#endif
