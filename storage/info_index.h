/* The full-text index of information_contents, private to storage. It is an FTS5 table without
 * contents of its own ("search": title, caption, body; one row per content_id), and holds the words
 * of words.h. */
#ifndef GOPURA_STORAGE_INFO_INDEX_H
#define GOPURA_STORAGE_INFO_INDEX_H

#include <sqlite3.h>

#include "base/bytes.h"

/* Creates and fills the index of an image of that schema version; in temp if its version has none
 * of its own, else in main. Returns SQLITE_OK, or SQLite's code. */
must_check int info_index_make(sqlite3 *db, int version);

/* Receives a row that was found. Returns false if no more are needed. */
typedef bool info_index_hit(void *data, int64_t content_id);

/* Finds the rows that contain every word of text: first in titles, then in titles and captions,
 * then anywhere. Rows found before are reported again. In each round they are ordered by bm25, then
 * by importance. Returns SQLITE_OK, or SQLite's code. */
must_check int info_index_find(sqlite3 *db, const char *text, info_index_hit *hit, void *data);

#endif
