/* Queries that run in SQLite while the kiosk runs, except for pages: credits and search. Their work
 * is limited, so that no image can block a frame for long. */
#include "storage/info_ask.h"

#include <errno.h>
#include <glib.h>
#include <stdlib.h>
#include <string.h>

#include "base/log.h"
#include "storage/info_index.h"
#include "storage/info_languages.h"
#include "storage/info_rows.h"

enum { CALLS_OF_A_SEARCH = 1000 };

/* ---- credits ---- */

/* Appends a text with each run of white space as one space. */
static void put_in_one_line(struct buffer *out, const char *text)
{
	static const char space[] = " \t\r\n";

	text += strspn(text, space);
	while (*text) {
		const size_t size = strcspn(text, space);

		buffer_put(out, text, size);
		text += size;
		text += strspn(text, space);
		if (*text)
			buffer_put_u8(out, ' ');
	}
}

/* For an element in several languages, reads the requested language, else the default. */
static int read_credits(struct info *info, uint32_t part, uint32_t language)
{
	static const char sql[] =
		"SELECT d.value FROM assigned_information a JOIN dublin_core d"
		" USING(information_id) WHERE a.part_id = ?1 AND d.element IN ('creator',"
		" 'contributor', 'publisher', 'date', 'source', 'rights') AND"
		" (d.language IS NULL OR d.language = ?2 OR (d.language = 0 AND NOT EXISTS"
		" (SELECT 1 FROM dublin_core e WHERE e.information_id = d.information_id"
		" AND e.element = d.element AND e.language = ?2))) ORDER BY a.position, d.position";
	sqlite3_stmt *statement = NULL;
	int code = sqlite3_prepare_v2(info->db, sql, -1, &statement, NULL);

	if (code == SQLITE_OK) {
		sqlite3_bind_int64(statement, 1, part);
		sqlite3_bind_int64(statement, 2, language);
	}
	while (code == SQLITE_OK && (code = sqlite3_step(statement)) == SQLITE_ROW) {
		const char *value = (const char *)sqlite3_column_text(statement, 0);

		code = SQLITE_OK;
		if (!value || !g_utf8_validate(value, -1, NULL))
			code = SQLITE_CORRUPT;
		else if (info->credits.size > 0)
			buffer_put_text(&info->credits, " · ");
		if (code == SQLITE_OK)
			put_in_one_line(&info->credits, value);
	}
	sqlite3_finalize(statement);
	return info_from_sqlite(info->db, code, "credits");
}

const char *info_credits(struct info *info, uint32_t part, const char *language)
{
	info->calls = 0;
	buffer_clear(&info->credits);
	if (read_credits(info, part, info_language_index(info, language)) < 0)
		buffer_clear(&info->credits);
	buffer_put_u8(&info->credits, 0);
	return info->credits.error ? "" : (const char *)info->credits.data;
}

/* ---- search ---- */

static int by_content(const void *a, const void *b)
{
	const struct info_hit *left = a, *right = b;

	return (left->content_id > right->content_id) - (left->content_id < right->content_id);
}

/* Lists the part and language of each row of the index, sorted by row. */
static int list_contents(struct info *info)
{
	info->contents = calloc((size_t)info->part_count * info->language_count + 1,
				sizeof(*info->contents));
	if (!info->contents)
		return -ENOMEM;
	for (uint32_t p = 0; p < info->part_count; p++) {
		for (uint32_t i = 0; i < info->language_count; i++) {
			const struct text *text = &info->parts[p].texts[i];

			if (text->title || text->caption || text->has_page)
				info->contents[info->content_count++] =
					(struct info_hit){ text->content_id, p, i };
		}
	}
	qsort(info->contents, info->content_count, sizeof(*info->contents), by_content);
	return 0;
}

/* Search results, each part once: in the requested language, and in others. */
struct search {
	struct info *info;
	uint32_t language;
	uint32_t *parts, count, most;
	uint32_t others[INFO_PARTS_MAX], other_count;
};

static bool is_listed(const uint32_t *parts, uint32_t count, uint32_t part)
{
	for (uint32_t i = 0; i < count; i++)
		if (parts[i] == part)
			return true;
	return false;
}

static bool on_hit(void *data, int64_t content_id)
{
	struct search *search = data;
	const struct info_hit key = { .content_id = content_id };
	const struct info_hit *hit = bsearch(&key, search->info->contents,
					     search->info->content_count, sizeof(key), by_content);

	if (!hit)
		return true;
	if (hit->language != search->language) {
		if (search->other_count < search->most && search->other_count < INFO_PARTS_MAX &&
		    !is_listed(search->others, search->other_count, hit->part))
			search->others[search->other_count++] = hit->part;
		return true;
	}
	if (!is_listed(search->parts, search->count, hit->part))
		search->parts[search->count++] = hit->part;
	return search->count < search->most;
}

uint32_t info_search(struct info *info, const char *query, const char *language, uint32_t *parts,
		     uint32_t most)
{
	struct search search = { .info = info,
				 .language = info_language_index(info, language),
				 .parts = parts,
				 .most = most };
	int code;

	if (most == 0 || (!info->contents && list_contents(info) < 0))
		return 0;
	info->calls = 0;
	info->calls_most = CALLS_OF_A_SEARCH;
	code = info_index_find(info->db, query, on_hit, &search);
	info->calls_most = INFO_CALLS_MAX;
	/* What was found before the limit or the damage is still valid. */
	if (code != SQLITE_OK)
		log_warn("storage", "search in the information database: %s",
			 sqlite3_errmsg(info->db));
	for (uint32_t i = 0; i < search.other_count && search.count < most; i++)
		if (!is_listed(parts, search.count, search.others[i]))
			parts[search.count++] = search.others[i];
	return search.count;
}
