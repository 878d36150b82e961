/* An information database of anybody's: the bytes as a database file; or, where they begin with
 * "SQL:", the database that these statements make, so that the fuzzer reaches rows that contradict
 * one another; or, where they begin with "ADD:", one that was built as at publishing, which these
 * statements change. What opens answers every question about itself. */
#include <math.h>
#include <sqlite3.h>
#include <stdlib.h>
#include <string.h>

#include "storage/info.h"
#include "storage/info_ask.h"
#include "storage/info_spoken.h"
#include "storage/info_tools.h"
#include "storage/info_tour.h"
#include "tests/fuzz/built_info.h"

enum { STEPS_PER_CALL = 1000, CALLS_MAX = 200, SQL_BYTES_MAX = 64 << 10 };

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size);

static void ask_of_speech(struct info *info, uint32_t part, const char *language)
{
	struct info_spoken spoken;

	if (info_spoken(info, part, language, &spoken) < 0)
		return;
	if (spoken.duration_ms == 0 || spoken.bytes == 0)
		abort();
	for (uint32_t n = 0; n < spoken.cue_count; n++)
		if (spoken.cues[n].end_ms <= spoken.cues[n].begin_ms ||
		    strlen(spoken.cues[n].text) > INFO_CUE_BYTES_MAX)
			abort();
}

static void ask_of_part(struct info *info, uint32_t part, const char *language)
{
	const struct info_text text = info_text(info, part, language);
	const char *found = NULL;
	struct bytes article;

	if (!text.title || !text.caption || !text.thumbnail || !text.language)
		abort();
	if (text.thumbnail[0] && !info_find_picture(info, text.thumbnail))
		abort();
	if (info_page(info, part, language, &article, &found) == 0 && !found)
		abort();
	if (!info_credits(info, part, language))
		abort();
	ask_of_speech(info, part, language);
	if (info_find(info, info_part(info, part)->id) < 0)
		abort();
}

static void ask_of_tour(const struct info *info, uint32_t t, const char *language)
{
	const struct info_tour *tour = info_tour(info, t);

	if (!info_tour_text(info, t, language).title || info_find_tour(info, tour->id) < 0 ||
	    tour->stop_count > INFO_STOPS_MAX)
		abort();
	for (uint32_t s = 0; s < tour->stop_count; s++)
		if (!info_stop_caption(info, t, s, language) ||
		    tour->stops[s].part >= (int)info_part_count(info) ||
		    !isfinite(tour->stops[s].eye_m[0]))
			abort();
}

static void ask(struct info *info)
{
	static const char *const languages[] = { "en", "km", "xx" };
	uint32_t hits[8], count;

	for (size_t l = 0; l < ARRAY_COUNT(languages); l++) {
		for (uint32_t p = 0; p < info_part_count(info); p++)
			ask_of_part(info, p, languages[l]);
		for (uint32_t t = 0; t < info_tour_count(info); t++)
			ask_of_tour(info, t, languages[l]);
		count = info_search(info, "tower ga", languages[l], hits, ARRAY_COUNT(hits));
		if (count > ARRAY_COUNT(hits))
			abort();
		for (uint32_t i = 0; i < count; i++)
			if (hits[i] >= info_part_count(info))
				abort();
	}
	info_tools(info);
	for (uint32_t i = 0; i < info_picture_count(info); i++)
		if (!info_picture(info, i)->name)
			abort();
}

static void open_image(struct bytes image)
{
	struct info *info;

	if (info_open(&info, image) < 0)
		return;
	ask(info);
	info_close(info);
}

/* ---- a database by statements */

static int bound_work(void *data)
{
	return ++*(int *)data > CALLS_MAX;
}

/* No other file is reached. */
static int allow(void *data, int action, const char *a, const char *b, const char *c, const char *d)
{
	(void)data, (void)b, (void)c, (void)d;
	if (action == SQLITE_ATTACH || action == SQLITE_DETACH)
		return SQLITE_DENY;
	return action == SQLITE_PRAGMA && (strcmp(a, "user_version") && strcmp(a, "application_id"))
		       ? SQLITE_DENY
		       : SQLITE_OK;
}

/* The built database, in memory of the caller's that can grow. */
static void open_built(sqlite3 *db)
{
	static struct info_built built;
	unsigned char *copy;

	if (built.database.size == 0)
		built_info(&built);
	copy = sqlite3_malloc64(built.database.size);
	if (!copy)
		abort();
	memcpy(copy, built.database.data, built.database.size);
	if (sqlite3_deserialize(db, "main", copy, (sqlite3_int64)built.database.size,
				(sqlite3_int64)built.database.size,
				SQLITE_DESERIALIZE_FREEONCLOSE | SQLITE_DESERIALIZE_RESIZEABLE) !=
	    SQLITE_OK)
		abort();
}

static void make_and_open(const uint8_t *sql, size_t size, bool adds)
{
	char text[SQL_BYTES_MAX + 1];
	unsigned char *image;
	sqlite3_int64 image_bytes;
	bool is_changed;
	int rc, calls = 0;
	sqlite3 *db;

	if (size > SQL_BYTES_MAX)
		return;
	memcpy(text, sql, size);
	text[size] = '\0';
	if (sqlite3_open(":memory:", &db) != SQLITE_OK)
		abort();
	if (adds)
		open_built(db);
	if (sqlite3_exec(db, "PRAGMA page_size=512; PRAGMA max_page_count=2000;", NULL, NULL,
			 NULL) != SQLITE_OK)
		abort();
	sqlite3_limit(db, SQLITE_LIMIT_LENGTH, 1 << 20);
	sqlite3_progress_handler(db, STEPS_PER_CALL, bound_work, &calls);
	sqlite3_set_authorizer(db, allow, NULL);
	/* One after the other: those before a statement that is wrong count. */
	rc = sqlite3_exec(db, text, NULL, NULL, NULL);
	/* Most mistakes are in the first statement: what was built is then as it was. */
	is_changed = !adds || rc == SQLITE_OK || sqlite3_total_changes(db) > 0;
	image = is_changed ? sqlite3_serialize(db, "main", &image_bytes, 0) : NULL;
	if (image)
		open_image((struct bytes){ image, (size_t)image_bytes });
	sqlite3_free(image);
	sqlite3_close(db);
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
	if (size > 4 && (memcmp(data, "SQL:", 4) == 0 || memcmp(data, "ADD:", 4) == 0))
		make_and_open(data + 4, size - 4, data[0] == 'A');
	else
		open_image((struct bytes){ data, size });
	return 0;
}
