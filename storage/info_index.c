/* Makes the full-text index (FTS5) of the information database and searches in it. */
#include "storage/info_index.h"

#include <errno.h>
#include <libxml/HTMLparser.h>
#include <stdio.h>
#include <string.h>

#include "format/html_tags.h"
#include "storage/info.h"
#include "storage/words.h"

enum { WORDS_BYTES_MAX = 32 * INFO_PAGE_BYTES_MAX };

/* ---- a page's words ---- */

static bool is_one_of(const char *name, const char *const *names, size_t count)
{
	for (size_t i = 0; i < count; i++)
		if (strcmp(name, names[i]) == 0)
			return true;
	return false;
}

/* Returns true if the element separates words, unlike an <em> in the middle of one. */
static bool parts_words(const xmlNode *node)
{
	static const char *const within[] = {
		"a",   "em",   "i", "strong", "b",    "span", "sub",
		"sup", "cite", "q", "abbr",   "time", "dfn",  "small"
	};

	return !is_one_of((const char *)node->name, within, ARRAY_COUNT(within));
}

static bool is_unread(const xmlNode *node)
{
	static const char *const unread[] = { "head", "script", "style", "template" };

	return is_one_of((const char *)node->name, unread, ARRAY_COUNT(unread));
}

/* Returns the next node in text order, without recursion. */
static const xmlNode *next_node(const xmlNode *node, struct buffer *text)
{
	bool is_element = node->type == XML_ELEMENT_NODE;

	if (is_element && parts_words(node))
		buffer_put_u8(text, ' ');
	if (is_element && node->children && !is_unread(node))
		return node->children;
	while (node && !node->next) {
		node = node->parent && node->parent->type == XML_ELEMENT_NODE ? node->parent : NULL;
		if (node && parts_words(node))
			buffer_put_u8(text, ' ');
	}
	return node ? node->next : NULL;
}

static int read_text(struct buffer *text, const char *html)
{
	const struct bytes page = { (const uint8_t *)html, strlen(html) };
	struct buffer reduced;
	xmlDoc *doc = NULL;

	buffer_init(&reduced, HTML_TAGS_GROWTH * page.size + 64);
	if (html_tags_reduce(&reduced, page, NULL) == 0 && reduced.size > 0)
		doc = htmlReadMemory((const char *)reduced.data, (int)reduced.size, NULL, "UTF-8",
				     HTML_PARSE_RECOVER | HTML_PARSE_NOERROR |
					     HTML_PARSE_NOWARNING | HTML_PARSE_NONET);
	buffer_finish(&reduced);
	for (const xmlNode *node = doc ? xmlDocGetRootElement(doc) : NULL; node;
	     node = next_node(node, text))
		if (node->type == XML_TEXT_NODE && node->content)
			buffer_put(text, node->content, strlen((const char *)node->content));
	xmlFreeDoc(doc);
	buffer_put_u8(text, 0);
	return text->error;
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

static int bind_page(sqlite3_stmt *to, int column, const char *html)
{
	struct buffer text;
	int code = SQLITE_NOMEM;

	buffer_init(&text, WORDS_BYTES_MAX);
	if (!html)
		code = bind_words(to, column, NULL, NULL);
	else if (read_text(&text, html) == 0)
		code = bind_words(to, column, (char *)text.data, NULL);
	buffer_finish(&text);
	return code;
}

/* from: content_id, title, reading, caption, body, subjects. */
static int copy_row(sqlite3_stmt *to, sqlite3_stmt *from)
{
	int code = sqlite3_bind_int64(to, 1, sqlite3_column_int64(from, 0));

	if (code == SQLITE_OK)
		code = bind_words(to, 2, (const char *)sqlite3_column_text(from, 1),
				  (const char *)sqlite3_column_text(from, 2));
	if (code == SQLITE_OK)
		code = bind_words(to, 3, (const char *)sqlite3_column_text(from, 3),
				  (const char *)sqlite3_column_text(from, 5));
	if (code == SQLITE_OK)
		code = bind_page(to, 4, (const char *)sqlite3_column_text(from, 4));
	if (code == SQLITE_OK)
		code = sqlite3_step(to) == SQLITE_DONE ? SQLITE_OK : SQLITE_ERROR;
	sqlite3_reset(to);
	return code;
}

static int fill(sqlite3 *db, const char *schema, bool has_reading)
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
		 has_reading ? "reading" : "NULL");
	code = sqlite3_prepare_v2(db, sql, -1, &from, NULL);
	snprintf(sql, sizeof(sql),
		 "INSERT INTO %s.search(rowid, title, caption, body) VALUES(?, ?, ?, ?)", schema);
	if (code == SQLITE_OK)
		code = sqlite3_prepare_v2(db, sql, -1, &to, NULL);
	while (code == SQLITE_OK && (step = sqlite3_step(from)) == SQLITE_ROW)
		code = copy_row(to, from);
	sqlite3_finalize(from);
	sqlite3_finalize(to);
	return code == SQLITE_OK && step != SQLITE_DONE ? step : code;
}

int info_index_make(sqlite3 *db, const struct info_index_options *options)
{
	const char *schema = options->temporary ? "temp" : "main";
	char sql[200];
	int code;

	snprintf(sql, sizeof(sql), create, schema);
	code = sqlite3_exec(db, sql, NULL, NULL, NULL);
	if (code == SQLITE_OK)
		code = fill(db, schema, options->has_reading);
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
	buffer_put(&query, columns, strlen(columns));
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
