/* Lets SQLite compare: each kind is a query for keys and values, which is asked of both databases
 * and joined. docs/information.md has the tables. */
#include "curator/publish/info_difference.h"

#include <cjson/cJSON.h>
#include <errno.h>
#include <sqlite3.h>
#include <stdio.h>

#include "base/json_tree.h"

enum { QUERY_BYTES_MAX = 8192 };

/* In each, % stands for the schema. */
static const struct {
	const char *name, *query;
} kinds[] = {
	{ "parts",
	  "SELECT p.name AS key, (SELECT c.title FROM %.assigned_information a"
	  " JOIN %.information_contents c USING(information_id)"
	  " WHERE a.part_id = p.part_id AND c.title IS NOT NULL ORDER BY c.language LIMIT 1) AS title,"
	  " p.region_kind || quote(centre_x) || quote(centre_y) || quote(centre_z)"
	  " || quote(anchor_x) || quote(anchor_y) || quote(anchor_z) || quote(radius)"
	  " || quote(half_x) || quote(half_y) || quote(half_z) || quote(turn_deg) || quote(floor)"
	  " || quote(roof) || coalesce((SELECT group_concat(quote(x) || quote(y)) FROM"
	  " %.part_corner k WHERE k.part_id = p.part_id), '') AS value FROM %.identified_part p" },
	{ "cards",
	  "SELECT p.name || '.' || l.code AS key, c.title AS title, quote(c.title)"
	  " || quote(c.reading) || quote(c.caption) || quote((SELECT name FROM %.picture t"
	  " WHERE t.picture_id = i.thumbnail)) AS value FROM %.information_contents c"
	  " JOIN %.information i USING(information_id)"
	  " JOIN %.assigned_information a USING(information_id)"
	  " JOIN %.identified_part p USING(part_id) JOIN %.language l ON l.position = c.language"
	  " WHERE c.title IS NOT NULL OR c.caption IS NOT NULL" },
	{ "pages",
	  "SELECT p.name || '.' || l.code AS key, (SELECT d.title FROM %.information_contents d"
	  " WHERE d.information_id = c.information_id AND d.title IS NOT NULL"
	  " ORDER BY d.language LIMIT 1) AS title, quote(c.body)"
	  " || coalesce((SELECT group_concat(quote(r.element) || quote(r.language) ||"
	  " quote(r.value)) FROM %.dublin_core r WHERE r.information_id = c.information_id), '')"
	  " AS value FROM %.information_contents c"
	  " JOIN %.assigned_information a USING(information_id)"
	  " JOIN %.identified_part p USING(part_id) JOIN %.language l ON l.position = c.language"
	  " WHERE length(c.body) > 0" },
	{ "pictures", "SELECT name AS key, '' AS title, hash AS value FROM %.picture" },
	{ "tours",
	  "SELECT t.name AS key, (SELECT c.title FROM %.tour_contents c WHERE c.tour_id = t.tour_id"
	  " ORDER BY c.language LIMIT 1) AS title, quote(t.attract)"
	  " || coalesce((SELECT group_concat(quote(c.language) || quote(c.title) ||"
	  " quote(c.caption)) FROM %.tour_contents c WHERE c.tour_id = t.tour_id), '')"
	  " || coalesce((SELECT group_concat(quote(eye_x) || quote(eye_y) || quote(eye_z)"
	  " || quote(target_x) || quote(target_y) || quote(target_z) || quote(stay_s)"
	  " || quote(travel_s)) FROM %.tour_stop s WHERE s.tour_id = t.tour_id), '')"
	  " || coalesce((SELECT group_concat(quote(position) || quote(language) || quote(caption))"
	  " FROM %.tour_stop_contents s WHERE s.tour_id = t.tour_id), '') AS value FROM %.tour t" },
};

/* What is spoken, and its words; not every database has these tables. */
static const char sounds_query[] =
	"SELECT p.name || '.' || l.code AS key, (SELECT d.title FROM %.information_contents d"
	" JOIN %.assigned_information b USING(information_id) WHERE b.part_id = a.part_id"
	" AND d.title IS NOT NULL ORDER BY d.language LIMIT 1) AS title, quote(s.hash)"
	" || coalesce((SELECT group_concat(quote(begin_ms) || quote(end_ms) || quote(text)) FROM"
	" %.spoken_cue q WHERE q.content_id = s.content_id), '') AS value FROM %.spoken s"
	" JOIN %.information_contents c USING(content_id)"
	" JOIN %.assigned_information a USING(information_id)"
	" JOIN %.identified_part p USING(part_id) JOIN %.language l ON l.position = c.language";

static void put_query(struct buffer *out, const char *query, const char *schema)
{
	for (; *query; query++)
		if (*query == '%')
			buffer_put_text(out, schema);
		else
			buffer_put_u8(out, (uint8_t)*query);
}

/* ---- rows */

static cJSON *row_of(sqlite3_stmt *statement)
{
	cJSON *row = cJSON_CreateObject();

	for (int n = 0; n < sqlite3_column_count(statement); n++) {
		const char *name = sqlite3_column_name(statement, n);
		const char *text = (const char *)sqlite3_column_text(statement, n);

		if (sqlite3_column_type(statement, n) == SQLITE_INTEGER)
			cJSON_AddNumberToObject(row, name,
						(double)sqlite3_column_int64(statement, n));
		else
			cJSON_AddStringToObject(row, name, text ? text : "");
	}
	return row;
}

/* Adds the rows of a query as a list. */
static int add_rows(cJSON *json, const char *name, sqlite3 *db, const char *query)
{
	cJSON *list = cJSON_AddArrayToObject(json, name);
	sqlite3_stmt *statement;
	int code = sqlite3_prepare_v2(db, query, -1, &statement, NULL);

	if (code != SQLITE_OK || !list)
		return -EBADMSG;
	while ((code = sqlite3_step(statement)) == SQLITE_ROW)
		json_append(list, row_of(statement));
	sqlite3_finalize(statement);
	return code == SQLITE_DONE ? 0 : -EBADMSG;
}

/* A database without spoken texts has no tables of them; neither has one that is not there. */
static bool has_sounds(sqlite3 *db, const char *schema)
{
	sqlite3_stmt *statement;
	char query[128];
	bool found = false;

	snprintf(query, sizeof(query), "SELECT 1 FROM %s.sqlite_master WHERE name = 'spoken'",
		 schema);
	if (sqlite3_prepare_v2(db, query, -1, &statement, NULL) == SQLITE_OK)
		found = sqlite3_step(statement) == SQLITE_ROW;
	sqlite3_finalize(statement);
	return found;
}

static void put_side(struct buffer *out, const char *query, const char *schema, bool is_there)
{
	put_query(out,
		  is_there ? query : "SELECT NULL AS key, NULL AS title, NULL AS value WHERE 0",
		  schema);
}

static int add_kind(cJSON *json, const char *name, const char *query, sqlite3 *db, bool has_now,
		    bool has_before)
{
	struct buffer text;
	int rc;

	buffer_init(&text, QUERY_BYTES_MAX);
	buffer_put_text(&text, "SELECT coalesce(n.key, o.key) AS key,"
			       " coalesce(n.title, o.title, '') AS title,"
			       " CASE WHEN o.key IS NULL THEN 'added' WHEN n.key IS NULL THEN"
			       " 'removed' ELSE 'changed' END AS change FROM (");
	put_side(&text, query, "main", has_now);
	buffer_put_text(&text, ") n FULL JOIN (");
	put_side(&text, query, "before", has_before);
	buffer_put_text(&text, ") o ON n.key = o.key WHERE n.value IS NOT o.value ORDER BY 1");
	buffer_put_u8(&text, 0);
	rc = text.error ? text.error : add_rows(json, name, db, (const char *)text.data);
	buffer_finish(&text);
	return rc;
}

/* How large those files of a table are that are not known yet. */
static int add_bytes(cJSON *json, const char *name, const char *table, sqlite3 *db, bool has_before)
{
	sqlite3_stmt *statement;
	char query[256];
	int code, length = snprintf(query, sizeof(query),
				    "SELECT coalesce(sum(bytes), 0) FROM main.%s", table);

	if (has_before)
		snprintf(query + length, sizeof(query) - (size_t)length,
			 " WHERE hash NOT IN (SELECT hash FROM before.%s)", table);
	code = sqlite3_prepare_v2(db, query, -1, &statement, NULL);
	if (code == SQLITE_OK && sqlite3_step(statement) == SQLITE_ROW)
		cJSON_AddNumberToObject(json, name, (double)sqlite3_column_int64(statement, 0));
	else
		code = SQLITE_ERROR;
	sqlite3_finalize(statement);
	return code == SQLITE_OK ? 0 : -EBADMSG;
}

/* A page is missing where the part has one in another language. */
static int add_languages(cJSON *json, sqlite3 *db)
{
	static const char query[] =
		"WITH texts AS (SELECT a.part_id, c.language, c.title, length(c.body) > 0 AS has_page"
		" FROM main.information_contents c"
		" JOIN main.assigned_information a USING(information_id))"
		" SELECT l.code AS code, (SELECT count(*) FROM main.identified_part p WHERE NOT EXISTS"
		" (SELECT 1 FROM texts t WHERE t.part_id = p.part_id AND t.language = l.position"
		" AND t.title IS NOT NULL)) AS titles,"
		" (SELECT count(DISTINCT part_id) FROM texts w WHERE w.has_page AND NOT EXISTS"
		" (SELECT 1 FROM texts t WHERE t.part_id = w.part_id AND t.language = l.position"
		" AND t.has_page)) AS pages FROM main.language l ORDER BY l.position";

	return add_rows(json, "languages", db, query);
}

/* ---- the databases */

/* The image is borrowed for as long as the database is open. */
static int attach(sqlite3 *db, const char *schema, struct bytes image)
{
	const int code = sqlite3_deserialize(db, schema, (unsigned char *)image.data,
					     (sqlite3_int64)image.size, (sqlite3_int64)image.size,
					     SQLITE_DESERIALIZE_READONLY);

	return code == SQLITE_OK ? 0 : -EBADMSG;
}

static int open_both(sqlite3 **db, struct bytes now, struct bytes before)
{
	int rc = 0;

	if (sqlite3_open_v2(":memory:", db, SQLITE_OPEN_READWRITE | SQLITE_OPEN_NOMUTEX, NULL) !=
		    SQLITE_OK ||
	    sqlite3_exec(*db, "ATTACH ':memory:' AS before", NULL, NULL, NULL) != SQLITE_OK)
		return -ENOMEM;
	rc = attach(*db, "main", now);
	if (rc == 0 && before.size > 0)
		rc = attach(*db, "before", before);
	return rc;
}

int info_difference(struct cJSON *json, struct bytes now, struct bytes before)
{
	const bool has_before = before.size > 0;
	sqlite3 *db = NULL;
	int rc = open_both(&db, now, before);
	const bool now_sounds = rc == 0 && has_sounds(db, "main"),
		   before_sounds = rc == 0 && has_before && has_sounds(db, "before");

	for (unsigned n = 0; rc == 0 && n < ARRAY_COUNT(kinds); n++)
		rc = add_kind(json, kinds[n].name, kinds[n].query, db, true, has_before);
	if (rc == 0)
		rc = add_kind(json, "sounds", sounds_query, db, now_sounds, before_sounds);
	if (rc == 0)
		rc = add_bytes(json, "picture_bytes", "picture", db, has_before);
	if (rc == 0 && now_sounds)
		rc = add_bytes(json, "sound_bytes", "spoken", db, before_sounds);
	if (rc == 0)
		rc = add_languages(json, db);
	sqlite3_close(db);
	return rc;
}
