/* Makes the full-text index (FTS5) of the information database and searches in it. */
#include "storage/info_index.h"

#include <errno.h>
#include <stdio.h>
#include <string.h>

#include "format/article.h"
#include "storage/info_schema.h"
#include "storage/plain_page.h"
#include "storage/words.h"

enum { WORDS_BYTES_MAX = 8 * ARTICLE_BYTES_MAX };

/* ---- a page's words ---- */

/* Writes the texts of an article, ended by a zero byte. A page that is no article has no words. */
static int read_text(struct buffer *text, struct bytes page)
{
	struct article_blocks article;
	int rc = article_decode(&article, page);

	for (uint32_t i = 0; i < article.block_count; i++) {
		const struct article_block *block = &article.blocks[i];

		if (block->kind == ARTICLE_TEXT) {
			buffer_put_text(text, block->text);
			buffer_put_u8(text, ' ');
		}
	}
	article_finish(&article);
	buffer_put_u8(text, 0);
	return rc == -ENOMEM ? rc : text->error;
}

/* ---- creation ---- */

/* The text is not stored a second time (content = ''). The words are already split by words.h, so
 * FTS5 only separates them at spaces: "ascii" treats every byte from 128 on as part of a word. */
static const char create[] = "CREATE VIRTUAL TABLE %s.search USING fts5(title, caption, body,"
			     " content = '', tokenize = 'ascii')";

static int bind_words(sqlite3_stmt *to, int column, const char *text, const char *more)
{
	struct buffer words;
	int code = SQLITE_NOMEM;

	buffer_init(&words, WORDS_BYTES_MAX);
	if ((!text || words_of(&words, text) == 0) && (!more || words_of(&words, more) == 0))
		code = sqlite3_bind_text64(to, column, words.data ? (char *)words.data : "",
					   words.size, SQLITE_TRANSIENT, SQLITE_UTF8);
	buffer_finish(&words);
	return code;
}

/* body: an article, or HTML in images from before there were any. */
static int bind_page(sqlite3_stmt *to, int column, struct bytes body, int version)
{
	struct buffer plain, text;
	int code = SQLITE_NOMEM, rc = 0;

	buffer_init(&plain, ARTICLE_BYTES_MAX);
	buffer_init(&text, WORDS_BYTES_MAX);
	if (version < INFO_SCHEMA_ARTICLES) {
		rc = plain_page(&plain, body);
		body = buffer_bytes(&plain);
	}
	if (rc != -ENOMEM && read_text(&text, body) == 0)
		code = bind_words(to, column, (char *)text.data, NULL);
	buffer_finish(&plain);
	buffer_finish(&text);
	return code;
}

/* from: content_id, title, reading, caption, body, subjects. */
static int copy_row(sqlite3_stmt *to, sqlite3_stmt *from, int version)
{
	const void *body;

	int code = sqlite3_bind_int64(to, 1, sqlite3_column_int64(from, 0));

	if (code == SQLITE_OK)
		code = bind_words(to, 2, (const char *)sqlite3_column_text(from, 1),
				  (const char *)sqlite3_column_text(from, 2));
	if (code == SQLITE_OK)
		code = bind_words(to, 3, (const char *)sqlite3_column_text(from, 3),
				  (const char *)sqlite3_column_text(from, 5));
	body = sqlite3_column_blob(from, 4);
	if (code == SQLITE_OK)
		code = bind_page(to, 4,
				 (struct bytes){ body, (size_t)sqlite3_column_bytes(from, 4) },
				 version);
	if (code == SQLITE_OK)
		code = sqlite3_step(to) == SQLITE_DONE ? SQLITE_OK : SQLITE_ERROR;
	sqlite3_reset(to);
	return code;
}

static int fill(sqlite3 *db, const char *schema, int version)
{
	sqlite3_stmt *from = NULL, *to = NULL;
	char sql[500];
	int code, step = SQLITE_DONE;

	snprintf(sql, sizeof(sql),
		 "SELECT content_id, title, %s, caption, body,"
		 " (SELECT group_concat(value, ' ') FROM dublin_core d WHERE d.information_id ="
		 " c.information_id AND element = 'subject'"
		 " AND (d.language IS NULL OR d.language = c.language))"
		 " FROM main.information_contents c ORDER BY content_id",
		 version < INFO_SCHEMA_SEARCH ? "NULL" : "reading");
	code = sqlite3_prepare_v2(db, sql, -1, &from, NULL);
	snprintf(sql, sizeof(sql),
		 "INSERT INTO %s.search(rowid, title, caption, body) VALUES(?, ?, ?, ?)", schema);
	if (code == SQLITE_OK)
		code = sqlite3_prepare_v2(db, sql, -1, &to, NULL);
	while (code == SQLITE_OK && (step = sqlite3_step(from)) == SQLITE_ROW)
		code = copy_row(to, from, version);
	sqlite3_finalize(from);
	sqlite3_finalize(to);
	return code == SQLITE_OK && step != SQLITE_DONE ? step : code;
}

int info_index_make(sqlite3 *db, int version)
{
	const char *schema = version < INFO_SCHEMA_SEARCH ? "temp" : "main";
	char sql[200];
	int code;

	snprintf(sql, sizeof(sql), create, schema);
	code = sqlite3_exec(db, sql, NULL, NULL, NULL);
	if (code == SQLITE_OK)
		code = fill(db, schema, version);
	/* Merge into one segment: smaller, and independent of the order of inserts. */
	snprintf(sql, sizeof(sql), "INSERT INTO %s.search(search) VALUES('optimize')", schema);
	if (code == SQLITE_OK)
		code = sqlite3_exec(db, sql, NULL, NULL, NULL);
	return code;
}

/* ---- search ---- */

/* words: from words_query. *more becomes false if the caller needs no more. */
static int find_in(sqlite3_stmt *statement, const char *columns, struct bytes words,
		   info_index_hit *hit, void *data, bool *more)
{
	struct buffer query;
	int code = SQLITE_NOMEM, step = SQLITE_DONE;

	buffer_init(&query, words.size + 100);
	buffer_put_u8(&query, '{');
	buffer_put_text(&query, columns);
	buffer_put(&query, "} : (", 5);
	buffer_put(&query, words.data, words.size);
	buffer_put_u8(&query, ')');
	if (query.error == 0)
		code = sqlite3_bind_text64(statement, 1, (char *)query.data, query.size,
					   SQLITE_STATIC, SQLITE_UTF8);
	while (code == SQLITE_OK && *more && (step = sqlite3_step(statement)) == SQLITE_ROW)
		*more = hit(data, sqlite3_column_int64(statement, 0));
	sqlite3_reset(statement);
	buffer_finish(&query);
	return code != SQLITE_OK || step == SQLITE_ROW || step == SQLITE_DONE ? code : step;
}

int info_index_find(sqlite3 *db, const char *text, info_index_hit *hit, void *data)
{
	static const char *const columns[] = { "title", "title caption", "title caption body" };
	sqlite3_stmt *statement = NULL;
	struct buffer words;
	bool more = true;
	int code = SQLITE_NOMEM;

	buffer_init(&words, 16 * WORDS_QUERY_BYTES_MAX);
	if (words_query(&words, text) == 0)
		code = sqlite3_prepare_v2(
			db, "SELECT rowid FROM search WHERE search MATCH ? ORDER BY rank, rowid",
			-1, &statement, NULL);
	for (size_t i = 0; code == SQLITE_OK && more && words.size > 0 && i < ARRAY_COUNT(columns);
	     i++)
		code = find_in(statement, columns[i], buffer_bytes(&words), hit, data, &more);
	sqlite3_finalize(statement);
	buffer_finish(&words);
	return code;
}
