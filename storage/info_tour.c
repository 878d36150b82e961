/* Loads the tours of an information database from an image that is not trusted, and answers queries
 * about them. */
#include "storage/info_tour.h"

#include <errno.h>
#include <stdlib.h>
#include <string.h>

#include "base/array.h"
#include "storage/info_languages.h"
#include "storage/info_rows.h"

/* Reads an index below count; returns count if it is out of range. */
static uint32_t column_index(sqlite3_stmt *row, int column, uint32_t count)
{
	const sqlite3_int64 value = sqlite3_column_int64(row, column);

	return value >= 0 && value < count ? (uint32_t)value : count;
}

static int read_tour(struct info *info, sqlite3_stmt *row)
{
	struct tour_row *tour;
	int rc;

	if (info->tour_count == INFO_TOURS_MAX || sqlite3_column_int64(row, 0) != info->tour_count)
		return -EBADMSG;
	rc = ARRAY_RESERVE(info->tours, info->tour_room, info->tour_count + 1, INFO_TOURS_MAX);
	if (rc < 0)
		return rc;
	tour = &info->tours[info->tour_count++];
	memset(tour, 0, sizeof(*tour));
	tour->public.attract = sqlite3_column_int(row, 2) != 0;
	rc = info_copy_text(row, 1, (char **)&tour->public.id);
	if (rc == 0 && !tour->public.id)
		rc = -EBADMSG;
	return rc;
}

static int read_tour_thumbnail(struct info *info, sqlite3_stmt *row)
{
	const uint32_t id = column_index(row, 0, info->tour_count);
	const char *name = (const char *)sqlite3_column_text(row, 1);

	if (id == info->tour_count || !name)
		return -EBADMSG;
	for (uint32_t i = 0; i < info->picture_count; i++)
		if (strcmp(info->pictures[i].name, name) == 0)
			info->tours[id].thumbnail = i + 1;
	return info->tours[id].thumbnail ? 0 : -EBADMSG;
}

static int read_tour_text(struct info *info, sqlite3_stmt *row)
{
	const uint32_t id = column_index(row, 0, info->tour_count);
	const uint32_t language = column_index(row, 1, info->language_count);
	int rc;

	if (id == info->tour_count || language == info->language_count ||
	    info->tours[id].titles[language] || info->tours[id].captions[language])
		return -EBADMSG;
	rc = info_copy_text(row, 2, &info->tours[id].titles[language]);
	return rc == 0 ? info_copy_text(row, 3, &info->tours[id].captions[language]) : rc;
}

static int read_stop(struct info *info, sqlite3_stmt *row)
{
	const uint32_t id = column_index(row, 0, info->tour_count);
	struct info_tour *tour;
	struct info_stop *stop;
	int rc;

	if (id == info->tour_count)
		return -EBADMSG;
	tour = &info->tours[id].public;
	if (tour->stop_count == INFO_STOPS_MAX || sqlite3_column_int64(row, 1) != tour->stop_count)
		return -EBADMSG;
	stop = &tour->stops[tour->stop_count++];
	rc = info_read_floats(row, 2, stop->eye_m, 3);
	if (rc == 0)
		rc = info_read_floats(row, 5, stop->target_m, 3);
	if (rc == 0)
		rc = info_read_floats(row, 8, &stop->stay_s, 1);
	if (rc == 0)
		rc = info_read_floats(row, 9, &stop->travel_s, 1);
	stop->part = sqlite3_column_type(row, 10) == SQLITE_NULL
			     ? -1
			     : (int)column_index(row, 10, info->part_count);
	if (stop->part == (int)info->part_count || !(stop->stay_s >= 0 && stop->stay_s <= 3600) ||
	    !(stop->travel_s >= 0 && stop->travel_s <= 3600))
		return -EBADMSG;
	return rc;
}

static int read_stop_text(struct info *info, sqlite3_stmt *row)
{
	const uint32_t id = column_index(row, 0, info->tour_count);
	const uint32_t language = column_index(row, 2, info->language_count);
	uint32_t stop;

	if (id == info->tour_count || language == info->language_count)
		return -EBADMSG;
	stop = column_index(row, 1, info->tours[id].public.stop_count);
	if (stop == info->tours[id].public.stop_count ||
	    info->tours[id].stop_captions[stop][language])
		return -EBADMSG;
	return info_copy_text(row, 3, &info->tours[id].stop_captions[stop][language]);
}

static int note_even_legs(struct info *info, sqlite3_stmt *row)
{
	(void)row;
	info->has_even_legs = true;
	return 0;
}

static int read_even_leg(struct info *info, sqlite3_stmt *row)
{
	const uint32_t id = column_index(row, 0, info->tour_count);
	struct info_tour *tour;
	uint32_t stop;

	if (id == info->tour_count)
		return -EBADMSG;
	tour = &info->tours[id].public;
	stop = column_index(row, 1, tour->stop_count);
	if (stop == tour->stop_count || !(tour->stops[stop].travel_s > 0))
		return -EBADMSG;
	tour->stops[stop].is_even = true;
	return 0;
}

/* The table exists only if there are such legs. Programs that do not know it fly a curve through
 * the same stops in the same time, and the schema version stays the same for them. */
static int read_even_legs(struct info *info)
{
	int rc = info_each_row(info,
			       "SELECT 1 FROM sqlite_schema WHERE type = 'table'"
			       " AND name = 'tour_even'",
			       note_even_legs);

	if (rc == 0 && info->has_even_legs)
		rc = info_each_row(info, "SELECT tour_id, position FROM tour_even", read_even_leg);
	return rc;
}

int info_load_tours(struct info *info)
{
	static const struct {
		const char *sql;
		info_row_reader *read;
	} steps[] = {
		{ "SELECT tour_id, name, attract FROM tour ORDER BY tour_id", read_tour },
		{ "SELECT t.tour_id, p.name FROM tour t JOIN picture p"
		  " ON p.picture_id = t.thumbnail ORDER BY t.tour_id",
		  read_tour_thumbnail },
		{ "SELECT tour_id, language, title, caption FROM tour_contents", read_tour_text },
		{ "SELECT tour_id, position, eye_x, eye_y, eye_z, target_x, target_y, target_z,"
		  " stay_s, travel_s, part_id FROM tour_stop ORDER BY tour_id, position",
		  read_stop },
		{ "SELECT tour_id, position, language, caption FROM tour_stop_contents",
		  read_stop_text },
	};
	int rc = 0;

	for (size_t i = 0; i < ARRAY_COUNT(steps) && rc == 0; i++)
		rc = info_each_row(info, steps[i].sql, steps[i].read);
	if (rc == 0)
		rc = read_even_legs(info);
	for (uint32_t i = 0; i < info->tour_count && rc == 0; i++) {
		const struct info_tour *tour = &info->tours[i].public;

		/* The first and the last stop must have a stay: movements lie between stays
		 * (geometry/tour_path.h). */
		if (!info->tours[i].titles[0] || tour->stop_count < 2 ||
		    tour->stops[0].stay_s == 0 || tour->stops[tour->stop_count - 1].stay_s == 0)
			rc = -EBADMSG;
	}
	return rc;
}

void info_drop_tours(struct info *info)
{
	for (uint32_t i = 0; i < info->tour_count; i++) {
		free((char *)info->tours[i].public.id);
		for (size_t k = 0; k < INFO_LANGUAGES_MAX; k++) {
			free(info->tours[i].titles[k]);
			free(info->tours[i].captions[k]);
			for (size_t s = 0; s < INFO_STOPS_MAX; s++)
				free(info->tours[i].stop_captions[s][k]);
		}
	}
	free(info->tours);
}

/* ---- queries ---- */

uint32_t info_tour_count(const struct info *info)
{
	return info->tour_count;
}

const struct info_tour *info_tour(const struct info *info, uint32_t tour)
{
	return &info->tours[tour].public;
}

int info_find_tour(const struct info *info, const char *id)
{
	for (uint32_t i = 0; i < info->tour_count; i++)
		if (strcmp(info->tours[i].public.id, id) == 0)
			return (int)i;
	return -ENOENT;
}

struct info_text info_tour_text(const struct info *info, uint32_t tour, const char *language)
{
	const struct tour_row *t = &info->tours[tour];
	const struct info_order order = info_order_of(info, language);
	const char *caption = info_first_of(&order, t->captions, NULL);
	uint32_t found = 0;
	const char *title = info_first_of(&order, t->titles, &found);

	return (struct info_text){
		.language = info->languages[found],
		.title = title,
		.caption = caption ? caption : "",
		.thumbnail = t->thumbnail ? info->pictures[t->thumbnail - 1].name : "",
	};
}

const char *info_stop_caption(const struct info *info, uint32_t tour, uint32_t stop,
			      const char *language)
{
	const struct info_order order = info_order_of(info, language);
	const char *caption = info_first_of(&order, info->tours[tour].stop_captions[stop], NULL);

	return caption ? caption : "";
}
