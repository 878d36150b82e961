/* Opens an information database. Everything except pages is loaded when it is opened: a thousand
 * parts in eight languages are a few hundred KB, and no frame ever waits for SQLite. The image may
 * come from a damaged cache or a stranger. So the schema is not trusted (it cannot run functions),
 * the pages of the file are checked, and work is limited. */
#include "storage/info.h"

#include <errno.h>
#include <sqlite3.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "base/array.h"
#include "base/log.h"
#include "format/article.h"
#include "storage/info_index.h"
#include "storage/info_languages.h"
#include "storage/info_rows.h"
#include "storage/info_schema.h"
#include "storage/info_spoken.h"
#include "storage/info_tools.h"
#include "storage/info_tour.h"
#include "storage/plain_page.h"

enum {
	STEPS_PER_CALL = 1000,
	PICTURES_MAX = 100000,
};

static int bound_work(void *data)
{
	struct info *info = data;

	return ++info->calls > info->calls_most;
}

/* ---- rows ---- */

static int read_language(struct info *info, sqlite3_stmt *row)
{
	int rc;

	if (info->language_count == INFO_LANGUAGES_MAX ||
	    sqlite3_column_int64(row, 0) != info->language_count)
		return -EBADMSG;
	rc = info_copy_text(row, 1, &info->languages[info->language_count]);
	if (rc == 0 && !info->languages[info->language_count])
		rc = -EBADMSG;
	if (rc == 0)
		info->language_count++;
	return rc;
}

static int read_picture(struct info *info, sqlite3_stmt *row)
{
	struct info_picture *picture;
	char *name = NULL;
	int rc;

	if (info->picture_count == PICTURES_MAX || sqlite3_column_bytes(row, 1) != HASH_BYTES)
		return -EBADMSG;
	rc = info_copy_text(row, 0, &name);
	if (rc < 0 || !name)
		return rc < 0 ? rc : -EBADMSG;
	rc = ARRAY_RESERVE(info->pictures, info->picture_room, info->picture_count + 1,
			   PICTURES_MAX);
	if (rc < 0) {
		free(name);
		return rc;
	}
	picture = &info->pictures[info->picture_count++];
	*picture = (struct info_picture){ .name = name,
					  .width_px = (uint32_t)sqlite3_column_int(row, 2),
					  .height_px = (uint32_t)sqlite3_column_int(row, 3) };
	memcpy(picture->hash.bytes, sqlite3_column_blob(row, 1), HASH_BYTES);
	return 0;
}

static int read_region(sqlite3_stmt *row, struct region *region)
{
	static const char *const kinds[] = { "point", "sphere", "box", "prism" };
	const char *kind = (const char *)sqlite3_column_text(row, 2);
	size_t i = 0;
	int rc;

	while (i < ARRAY_COUNT(kinds) && (!kind || strcmp(kind, kinds[i]) != 0))
		i++;
	if (i == ARRAY_COUNT(kinds))
		return -EBADMSG;
	region->kind = (enum region_kind)i;
	rc = info_read_floats(row, 3, region->centre_m, 3);
	if (rc == 0)
		rc = info_read_floats(row, 9, &region->radius_m, 1);
	if (rc == 0)
		rc = info_read_floats(row, 10, region->half_m, 3);
	if (rc == 0)
		rc = info_read_floats(row, 13, &region->turn_deg, 1);
	if (rc == 0)
		rc = info_read_floats(row, 14, &region->floor_m, 1);
	if (rc == 0)
		rc = info_read_floats(row, 15, &region->roof_m, 1);
	return rc;
}

static int read_part(struct info *info, sqlite3_stmt *row)
{
	struct part *part;
	char *id = NULL;
	int rc;

	if (info->part_count == INFO_PARTS_MAX || sqlite3_column_int64(row, 0) != info->part_count)
		return -EBADMSG;
	rc = info_copy_text(row, 1, &id);
	if (rc < 0 || !id)
		return rc < 0 ? rc : -EBADMSG;
	rc = ARRAY_RESERVE(info->parts, info->part_room, info->part_count + 1, INFO_PARTS_MAX);
	if (rc < 0) {
		free(id);
		return rc;
	}
	part = &info->parts[info->part_count++];
	memset(part, 0, sizeof(*part));
	part->public.id = id;
	rc = read_region(row, &part->public.region);
	if (rc == 0)
		rc = info_read_floats(row, 6, part->public.anchor_m, 3);
	return rc;
}

static int read_corner(struct info *info, sqlite3_stmt *row)
{
	sqlite3_int64 id = sqlite3_column_int64(row, 0);
	struct region *region;

	if (id < 0 || id >= info->part_count)
		return -EBADMSG;
	region = &info->parts[id].public.region;
	if (region->corner_count == REGION_CORNERS_MAX)
		return -EBADMSG;
	return info_read_floats(row, 1, region->corners_m[region->corner_count++], 2);
}

static int read_thumbnail(struct info *info, sqlite3_stmt *row)
{
	sqlite3_int64 id = sqlite3_column_int64(row, 0);
	const char *name = (const char *)sqlite3_column_text(row, 1);

	if (id < 0 || id >= info->part_count || !name)
		return -EBADMSG;
	for (uint32_t i = 0; i < info->picture_count; i++)
		if (strcmp(info->pictures[i].name, name) == 0)
			info->parts[id].thumbnail = i + 1;
	return info->parts[id].thumbnail ? 0 : -EBADMSG;
}

static int read_content(struct info *info, sqlite3_stmt *row)
{
	sqlite3_int64 id = sqlite3_column_int64(row, 0);
	sqlite3_int64 language = sqlite3_column_int64(row, 1);
	struct text *text;
	int rc;

	if (id < 0 || id >= info->part_count || language < 0 || language >= info->language_count)
		return -EBADMSG;
	text = &info->parts[id].texts[language];
	if (text->title || text->caption || text->has_page)
		return 0; /* a second information about the part; the kiosk shows the first */
	text->content_id = sqlite3_column_int64(row, 5);
	text->has_page = sqlite3_column_int(row, 4) != 0;
	info->parts[id].public.has_page |= text->has_page;
	rc = info_copy_text(row, 2, &text->title);
	return rc == 0 ? info_copy_text(row, 3, &text->caption) : rc;
}

/* ---- open ---- */

static int read_one_number(struct info *info, const char *sql, sqlite3_int64 *out)
{
	sqlite3_stmt *statement = NULL;
	int code = sqlite3_prepare_v2(info->db, sql, -1, &statement, NULL);

	if (code == SQLITE_OK)
		code = sqlite3_step(statement);
	*out = code == SQLITE_ROW ? sqlite3_column_int64(statement, 0) : -1;
	sqlite3_finalize(statement);
	return info_from_sqlite(info->db, code, sql);
}

static int attach_image(struct info *info, struct bytes image)
{
	unsigned char *copy;
	int code = sqlite3_open(":memory:", &info->db);

	if (code != SQLITE_OK)
		return info_from_sqlite(info->db, code, "open");
	copy = sqlite3_malloc64(image.size ? image.size : 1);
	if (!copy)
		return -ENOMEM;
	memcpy(copy, image.data, image.size);
	/* It frees the copy, also on failure. */
	code = sqlite3_deserialize(info->db, "main", copy, (sqlite3_int64)image.size,
				   (sqlite3_int64)image.size,
				   SQLITE_DESERIALIZE_FREEONCLOSE | SQLITE_DESERIALIZE_READONLY);
	if (code != SQLITE_OK)
		return info_from_sqlite(info->db, code, "open");
	sqlite3_db_config(info->db, SQLITE_DBCONFIG_DEFENSIVE, 1, NULL);
	sqlite3_db_config(info->db, SQLITE_DBCONFIG_TRUSTED_SCHEMA, 0, NULL);
	sqlite3_db_config(info->db, SQLITE_DBCONFIG_ENABLE_TRIGGER, 0, NULL);
	sqlite3_db_config(info->db, SQLITE_DBCONFIG_ENABLE_VIEW, 0, NULL);
	sqlite3_limit(info->db, SQLITE_LIMIT_LENGTH, 16 << 20);
	info->calls_most = INFO_CALLS_MAX;
	sqlite3_progress_handler(info->db, STEPS_PER_CALL, bound_work, info);
	return 0;
}

/* Checks kind and version of the file, and whether its b-trees are intact. */
static int check_image(struct info *info)
{
	sqlite3_int64 application = 0, version = 0;
	sqlite3_stmt *statement = NULL;
	const char *verdict = NULL;
	int code, rc;

	rc = read_one_number(info, "PRAGMA application_id", &application);
	if (rc == 0)
		rc = read_one_number(info, "PRAGMA user_version", &version);
	if (rc < 0)
		return rc;
	if (application != INFO_APPLICATION_ID || version < INFO_SCHEMA_OLDEST ||
	    version > INFO_SCHEMA_VERSION) {
		log_error("storage",
			  "content bug: information database of kind %llx version %lld; this "
			  "program reads versions %d to %d",
			  (unsigned long long)application, (long long)version, INFO_SCHEMA_OLDEST,
			  INFO_SCHEMA_VERSION);
		return -EBADMSG;
	}
	info->version = (int)version;
	code = sqlite3_prepare_v2(info->db, "PRAGMA quick_check(1)", -1, &statement, NULL);
	if (code == SQLITE_OK)
		code = sqlite3_step(statement);
	if (code == SQLITE_ROW)
		verdict = (const char *)sqlite3_column_text(statement, 0);
	rc = verdict && strcmp(verdict, "ok") == 0 ? 0 : -EBADMSG;
	sqlite3_finalize(statement);
	return rc;
}

/* Creates what version 1 lacks, in temp: the image itself is never written. */
static int complete_version_1(struct info *info)
{
	static const char missing[] =
		"PRAGMA temp_store = MEMORY;"
		"CREATE TEMP TABLE dublin_core(information_id INTEGER, position INTEGER,"
		" element TEXT, language INTEGER, value TEXT)";
	int code = sqlite3_exec(info->db, missing, NULL, NULL, NULL);

	if (code == SQLITE_OK)
		code = info_index_make(info->db, info->version);
	return info_from_sqlite(info->db, code, "completing version 1");
}

static int load(struct info *info)
{
	static const struct {
		const char *sql;
		info_row_reader *read;
	} steps[] = {
		{ "SELECT position, code FROM language ORDER BY position", read_language },
		{ "SELECT name, hash, width_px, height_px FROM picture ORDER BY name",
		  read_picture },
		{ "SELECT part_id, name, region_kind, centre_x, centre_y, centre_z, anchor_x,"
		  " anchor_y, anchor_z, radius, half_x, half_y, half_z, turn_deg, floor, roof"
		  " FROM identified_part ORDER BY part_id",
		  read_part },
		{ "SELECT part_id, x, y FROM part_corner ORDER BY part_id, position", read_corner },
		{ "SELECT a.part_id, p.name FROM assigned_information a JOIN information i"
		  " USING(information_id) JOIN picture p ON p.picture_id = i.thumbnail"
		  " ORDER BY a.part_id, a.position DESC",
		  read_thumbnail },
		{ "SELECT a.part_id, c.language, c.title, c.caption, c.body IS NOT NULL,"
		  " c.content_id"
		  " FROM assigned_information a JOIN information_contents c USING(information_id)"
		  " ORDER BY a.part_id, a.position",
		  read_content },
	};
	int rc = 0;

	for (size_t i = 0; i < ARRAY_COUNT(steps) && rc == 0; i++)
		rc = info_each_row(info, steps[i].sql, steps[i].read);
	if (rc == 0 && info->language_count == 0)
		rc = -EBADMSG;
	for (uint32_t i = 0; i < info->part_count && rc == 0; i++) {
		const struct region *region = &info->parts[i].public.region;

		if (!info->parts[i].texts[0].title)
			rc = -EBADMSG;
		if (region->kind == REGION_PRISM && region->corner_count < 3)
			rc = -EBADMSG;
	}
	return rc;
}

static int open_image(struct info *info, struct bytes image)
{
	static const char page_sql[] =
		"SELECT c.body FROM assigned_information a JOIN information_contents c"
		" USING(information_id) WHERE a.part_id = ?1 AND c.language = ?2"
		" AND c.body IS NOT NULL ORDER BY a.position LIMIT 1";
	int rc = attach_image(info, image);

	if (rc == 0)
		rc = check_image(info);
	if (rc == 0)
		rc = load(info);
	if (rc == 0)
		rc = info_from_sqlite(info->db,
				      sqlite3_prepare_v2(info->db, page_sql, -1, &info->page, NULL),
				      "page");
	if (rc == 0 && info->version >= INFO_SCHEMA_TOURS)
		rc = info_load_tours(info);
	if (rc == 0)
		rc = info_load_tools(info);
	if (rc == 0)
		rc = info_load_spoken(info);
	if (rc == 0 && info->version < INFO_SCHEMA_SEARCH)
		rc = complete_version_1(info);
	return rc;
}

int info_open(struct info **out, struct bytes image)
{
	struct info *info = calloc(1, sizeof(*info));
	int rc;

	*out = NULL;
	if (!info)
		return -ENOMEM;
	buffer_init(&info->plain, ARTICLE_BYTES_MAX);
	buffer_init(&info->credits, INFO_CREDITS_BYTES_MAX);
	rc = open_image(info, image);
	if (rc < 0) {
		info_close(info);
		return rc;
	}
	*out = info;
	return 0;
}

void info_close(struct info *info)
{
	if (!info)
		return;
	sqlite3_finalize(info->page);
	sqlite3_close(info->db);
	buffer_finish(&info->plain);
	buffer_finish(&info->credits);
	free(info->contents);
	info_drop_tours(info);
	info_drop_spoken(info);
	for (uint32_t i = 0; i < info->part_count; i++) {
		free((char *)info->parts[i].public.id);
		for (size_t k = 0; k < INFO_LANGUAGES_MAX; k++) {
			free(info->parts[i].texts[k].title);
			free(info->parts[i].texts[k].caption);
		}
	}
	for (uint32_t i = 0; i < info->picture_count; i++)
		free((char *)info->pictures[i].name);
	for (size_t i = 0; i < INFO_LANGUAGES_MAX; i++)
		free(info->languages[i]);
	free(info->parts);
	free(info->pictures);
	free(info);
}

/* ---- queries ---- */

uint32_t info_part_count(const struct info *info)
{
	return info->part_count;
}

const struct info_part *info_part(const struct info *info, uint32_t part)
{
	return &info->parts[part].public;
}

int info_find(const struct info *info, const char *id)
{
	for (uint32_t i = 0; i < info->part_count; i++)
		if (strcmp(info->parts[i].public.id, id) == 0)
			return (int)i;
	return -ENOENT;
}

uint32_t info_language_count(const struct info *info)
{
	return info->language_count;
}

const char *info_language(const struct info *info, uint32_t index)
{
	return info->languages[index];
}

const char *info_nearest_language(const struct info *info, const char *language)
{
	return info->languages[info_language_index(info, language)];
}

struct info_text info_text(const struct info *info, uint32_t part, const char *language)
{
	const struct part *p = &info->parts[part];
	const struct info_order order = info_order_of(info, language);
	uint32_t at = 0, found;
	struct info_text text;

	while (!p->texts[order.languages[at]].title)
		at++; /* one has a title: this was checked when the image was opened */
	found = order.languages[at];
	text.language = info->languages[found];
	text.title = p->texts[found].title;
	text.caption = p->texts[found].caption ? p->texts[found].caption : "";
	text.thumbnail = p->thumbnail ? info->pictures[p->thumbnail - 1].name : "";
	return text;
}

int info_page(struct info *info, uint32_t part, const char *language, struct bytes *article,
	      const char **language_found)
{
	uint32_t found = info_page_language(info, &info->parts[part], language);
	int code, rc = 0;

	*article = (struct bytes){ 0 };
	if (found == info->language_count)
		return -ENOENT;
	info->calls = 0;
	sqlite3_reset(info->page);
	sqlite3_bind_int64(info->page, 1, part);
	sqlite3_bind_int64(info->page, 2, found);
	code = sqlite3_step(info->page);
	if (code != SQLITE_ROW)
		return code == SQLITE_DONE ? -EBADMSG : info_from_sqlite(info->db, code, "page");
	article->data = sqlite3_column_blob(info->page, 0);
	article->size = (size_t)sqlite3_column_bytes(info->page, 0);
	if (info->version < INFO_SCHEMA_ARTICLES) {
		buffer_clear(&info->plain);
		rc = plain_page(&info->plain, *article);
		*article = buffer_bytes(&info->plain);
	}
	if (language_found)
		*language_found = info->languages[found];
	return rc;
}

uint32_t info_picture_count(const struct info *info)
{
	return info->picture_count;
}

const struct info_picture *info_picture(const struct info *info, uint32_t index)
{
	return &info->pictures[index];
}

const struct info_picture *info_find_picture(const struct info *info, const char *name)
{
	uint32_t low = 0, high = info->picture_count;

	while (low < high) {
		uint32_t middle = low + (high - low) / 2;
		int order = strcmp(name, info->pictures[middle].name);

		if (order == 0)
			return &info->pictures[middle];
		if (order < 0)
			high = middle;
		else
			low = middle + 1;
	}
	return NULL;
}
