/* Reads tours.json into tours. Whether a path leads through a wall is checked in
 * pipeline/content/tour_check, where the scan is available. */
#include "pipeline/content/info_tours.h"

#include <cjson/cJSON.h>
#include <errno.h>
#include <math.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "geometry/viewpoint.h"
#include "pipeline/content/info_parts.h"
#include "pipeline/content/tour_scene.h"

static const char tours_file[] = "tours.json";

#define STAY_S       6.0f
#define SECONDS_MAX  120.0f
#define PART_LEAST_M 0.5f /* size assumed for a part without one */

/* Shared by the functions that read a tour. stop: number of the current stop, from 1; 0: none. */
struct tour_reader {
	struct draft *draft;
	const struct json_text *json;
	struct draft_tour *tour;
	unsigned line;
	uint32_t stop;
};

static void report(const struct tour_reader *r, const char *text, ...) printf_like(2, 3);

static void report(const struct tour_reader *r, const char *text, ...)
{
	char message[400], where[120] = "";
	va_list args;

	va_start(args, text);
	vsnprintf(message, sizeof(message), text, args);
	va_end(args);
	if (r->stop > 0)
		snprintf(where, sizeof(where), ", stop %u", r->stop);
	diagnostics_add(r->draft->diagnostics, -EINVAL, tours_file, r->line, "tour \"%.64s\"%s: %s",
			r->tour->id ? r->tour->id : "?", where, message);
}

/* Reports unknown keys, which are usually misspelt. */
static void check_keys(const struct tour_reader *r, const cJSON *json, const char *known)
{
	for (const cJSON *item = json->child; item; item = item->next) {
		char key[40];

		snprintf(key, sizeof(key), " %.36s ", item->string);
		if (!strstr(known, key))
			report(r, "\"%.40s\" is not one of its keys, which are:%s", item->string,
			       known);
	}
}

static bool read_vector(const struct tour_reader *r, const cJSON *json, const char *key,
			float out[3])
{
	const cJSON *array = cJSON_GetObjectItemCaseSensitive(json, key);
	bool is_vector = cJSON_IsArray(array) && cJSON_GetArraySize(array) == 3;

	for (int i = 0; is_vector && i < 3; i++) {
		const cJSON *item = cJSON_GetArrayItem(array, i);

		is_vector = cJSON_IsNumber(item) && fabs(item->valuedouble) <= DRAFT_FAR_M;
		out[i] = is_vector ? (float)item->valuedouble : 0;
	}
	if (!is_vector)
		report(r, "\"%s\" must be three numbers, metres, up to %g: [x, y, z]", key,
		       DRAFT_FAR_M);
	return is_vector;
}

/* Returns the value in seconds, or `usual` if the key is missing. */
static float read_seconds(const struct tour_reader *r, const cJSON *json, const char *key,
			  float usual, bool may_be_none)
{
	const cJSON *item = cJSON_GetObjectItemCaseSensitive(json, key);
	double seconds = cJSON_IsNumber(item) ? item->valuedouble : -1;

	if (!item)
		return usual;
	if (seconds >= 1 && seconds <= SECONDS_MAX)
		return (float)seconds;
	if (seconds != 0 || !may_be_none)
		report(r, "\"%s\" must be %s1 to %.0f seconds", key, may_be_none ? "0 or " : "",
		       (double)SECONDS_MAX);
	return 0;
}

/* Reads {"en": "...", "fr": "..."}. If there is any text, or if it is needed, the first language
 * must be there. */
static int read_texts(const struct tour_reader *r, const cJSON *json, const char *key,
		      char *texts[], bool needed)
{
	const struct info_build_options *options = r->draft->options;
	const cJSON *object = cJSON_GetObjectItemCaseSensitive(json, key);

	if (object && !cJSON_IsObject(object))
		report(r, "\"%s\" must be texts by language: {\"%s\": \"...\"}", key,
		       options->languages[0]);
	for (uint32_t i = 0; i < options->language_count; i++) {
		const char *text = cJSON_GetStringValue(
			cJSON_GetObjectItemCaseSensitive(object, options->languages[i]));

		if (text && strspn(text, " \t\r\n") < strlen(text)) {
			texts[i] = strdup(text);
			if (!texts[i])
				return -ENOMEM;
		} else if (i == 0 && (needed || object)) {
			report(r,
			       "no %s in \"%s\", the first language: add \"%s\": {\"%s\": \"...\"}",
			       key, options->languages[i], key, options->languages[i]);
		} else if (object) {
			diagnostics_add(
				r->draft->diagnostics, 0, tours_file, r->line,
				"tour \"%.64s\": no %s in \"%s\": that of another language is "
				"shown instead",
				r->tour->id, key, options->languages[i]);
		}
	}
	return 0;
}

/* ---- stops ---- */

static void read_part(const struct tour_reader *r, const cJSON *json, struct info_stop *stop)
{
	const cJSON *item = cJSON_GetObjectItemCaseSensitive(json, "part");
	const char *id = cJSON_GetStringValue(item);

	stop->part = -1;
	if (!item)
		return;
	stop->part = id ? draft_find_part(r->draft, id) : -1;
	if (stop->part < 0)
		report(r, "part \"%.64s\": no part has that id; see parts.json", id ? id : "");
}

/* Reads the stop's own eye and target; place_stop computes what it leaves to its part. */
static void read_view(const struct tour_reader *r, const cJSON *json, struct draft_stop *stop,
		      bool is_first)
{
	const bool has_part = stop->view.part >= 0;
	const bool has_eye = cJSON_HasObjectItem(json, "eye");
	const bool has_target = cJSON_HasObjectItem(json, "target");

	if (has_eye && (has_target || has_part)) {
		stop->has_eye = read_vector(r, json, "eye", stop->view.eye_m);
		stop->has_target =
			has_target && read_vector(r, json, "target", stop->view.target_m);
	} else if (has_eye || has_target) {
		report(r, "\"%s\" alone is not a view: add \"%s\": [x, y, z]",
		       has_eye ? "eye" : "target", has_eye ? "target" : "eye");
	} else if (has_part && is_first) {
		report(r, "a part is shown from where the stop before stands, and the first has "
			  "none: add \"eye\": [x, y, z]");
	} else if (!cJSON_HasObjectItem(json, "part")) {
		report(r, "it has no view: add \"eye\" and \"target\": [x, y, z], or "
			  "\"part\": \"ID\"");
	}
}

static int read_stop(struct tour_reader *r, const cJSON *json, bool is_end)
{
	struct draft_stop *stop = &r->tour->stops[r->tour->stop_count];
	const bool is_first = r->tour->stop_count == 0;

	stop->line = r->line;
	r->stop = ++r->tour->stop_count; /* from here on draft_finish frees it */
	stop->view.part = -1;
	if (!cJSON_IsObject(json)) {
		report(r, "must be an object: {\"eye\": [x, y, z], \"target\": [x, y, z]}");
		return 0;
	}
	check_keys(r, json, " eye target part stay travel caption ");
	read_part(r, json, &stop->view);
	read_view(r, json, stop, is_first);
	stop->view.stay_s = read_seconds(r, json, "stay", STAY_S, !is_end);
	stop->view.travel_s = read_seconds(r, json, "travel", 0, false);
	return read_texts(r, json, "caption", stop->captions, false);
}

static int read_stops(struct tour_reader *r, const cJSON *json)
{
	const cJSON *array = cJSON_GetObjectItemCaseSensitive(json, "stops");
	int count = cJSON_IsArray(array) ? cJSON_GetArraySize(array) : 0, i = 0, rc = 0;
	const unsigned line = r->line;
	const cJSON *item;

	if (count < 2 || count > INFO_STOPS_MAX) {
		report(r, "a tour needs 2 to %d \"stops\", it has %d", INFO_STOPS_MAX, count);
		return 0;
	}
	r->tour->stops = calloc((size_t)count, sizeof(*r->tour->stops));
	if (!r->tour->stops)
		return -ENOMEM;
	cJSON_ArrayForEach(item, array)
	{
		r->line = cJSON_IsObject(item) ? json_text_line(r->json, item) : line;
		if (rc == 0)
			rc = read_stop(r, item, i == 0 || i == count - 1);
		i++;
	}
	r->stop = 0;
	r->line = line;
	return rc;
}

/* ---- stops from a scene ---- */

/* What tours.json adds to the halt of a tour whose views are a scene's. */
static int read_halt(struct tour_reader *r, const cJSON *json, struct draft_stop *stop)
{
	r->line = cJSON_IsObject(json) ? json_text_line(r->json, json) : r->line;
	stop->line = r->line;
	if (!cJSON_IsObject(json)) {
		report(r, "must be an object: {\"caption\": {...}}");
		return 0;
	}
	check_keys(r, json, " part stay caption ");
	read_part(r, json, &stop->view);
	stop->view.stay_s = read_seconds(r, json, "stay", stop->view.stay_s, false);
	return read_texts(r, json, "caption", stop->captions, false);
}

static int read_halts(struct tour_reader *r, const cJSON *json)
{
	const cJSON *array = cJSON_GetObjectItemCaseSensitive(json, "stops"), *item;
	const int told = cJSON_GetArraySize(array);
	const unsigned line = r->line;
	uint32_t at = 0, halts = 0;
	int rc = 0;

	for (uint32_t i = 0; i < r->tour->stop_count; i++)
		halts += r->tour->stops[i].view.stay_s > 0;
	if (array && (!cJSON_IsArray(array) || told > (int)halts)) {
		report(r, "\"stops\" must be a list of at most %u, as often as its scene halts",
		       halts);
		return 0;
	}
	cJSON_ArrayForEach(item, array)
	{
		while (r->tour->stops[at].view.stay_s == 0)
			at++;
		r->stop = ++at;
		if (rc == 0)
			rc = read_halt(r, item, &r->tour->stops[at - 1]);
	}
	r->stop = 0;
	r->line = line;
	return rc;
}

/* Reads the stops of a tour through a scene. */
static int read_scene(struct tour_reader *r, const cJSON *json)
{
	const cJSON *scene = cJSON_GetObjectItemCaseSensitive(json, "scene");
	const cJSON *viewpoint = cJSON_GetObjectItemCaseSensitive(json, "viewpoint");
	int rc;

	if (!cJSON_IsString(scene) || strncmp(scene->valuestring, "scenes/", 7) != 0) {
		report(r, "\"scene\" must be a file that scenes.json names, \"scenes/NAME.wrl\"");
		return 0;
	}
	if (viewpoint && !cJSON_IsString(viewpoint)) {
		report(r, "\"viewpoint\" must be the description of a Viewpoint");
		return 0;
	}
	rc = tour_scene_stops(r->draft, r->tour, scene->valuestring,
			      cJSON_GetStringValue(viewpoint));
	return rc == 0 && r->tour->stop_count > 0 ? read_halts(r, json) : rc;
}

/* ---- places ---- */

/* Computes the view of the stop's part, as for a visitor who comes from the stop before. */
static void place_stop(const struct tour_reader *r, struct draft_stop *stop,
		       const struct info_stop *before)
{
	const struct draft_part *part =
		stop->view.part >= 0 ? &r->draft->parts[stop->view.part] : NULL;
	struct info_stop *view = &stop->view;
	float apart = 0;

	if (part && !stop->has_target)
		memcpy(view->target_m, part->anchor_m, sizeof(view->target_m));
	if (!stop->has_eye) {
		if (part && before)
			viewpoint_of_region(&part->region, part->anchor_m, PART_LEAST_M,
					    before->eye_m, view->eye_m, view->target_m);
		return;
	}
	for (int i = 0; i < 3; i++)
		apart = fmaxf(apart, fabsf(view->eye_m[i] - view->target_m[i]));
	if ((part || stop->has_target) && apart < 0.01f)
		report(r, "\"eye\" and \"target\" are one place: move the target to what is to "
			  "be seen");
}

void draft_place_stops(struct draft *draft)
{
	for (uint32_t t = 0; t < draft->tour_count; t++) {
		struct draft_tour *tour = &draft->tours[t];
		struct tour_reader r = { .draft = draft, .tour = tour };

		for (uint32_t i = 0; i < tour->stop_count; i++) {
			r.line = tour->stops[i].line;
			r.stop = i + 1;
			place_stop(&r, &tour->stops[i], i > 0 ? &tour->stops[i - 1].view : NULL);
		}
	}
}

/* ---- tours ---- */

static int read_thumbnail(const struct tour_reader *r, const cJSON *json)
{
	const char *name =
		cJSON_GetStringValue(cJSON_GetObjectItemCaseSensitive(json, "thumbnail"));

	r->tour->thumbnail_picture =
		name ? draft_add_picture(r->draft, name, tours_file, r->line) : -1;
	return r->tour->thumbnail_picture == -ENOMEM ? -ENOMEM : 0;
}

static void check_attract(const struct tour_reader *r, const cJSON *json)
{
	const cJSON *attract = cJSON_GetObjectItemCaseSensitive(json, "attract");

	if (attract && !cJSON_IsBool(attract))
		report(r, "\"attract\" must be true or false");
	r->tour->attract = cJSON_IsTrue(attract);
	for (uint32_t i = 0; r->tour->attract && i + 1 < r->draft->tour_count; i++)
		if (r->draft->tours[i].attract)
			report(r,
			       "tour \"%s\" has \"attract\" too: only one can be shown while "
			       "nobody is there",
			       r->draft->tours[i].id);
}

static int read_tour(struct draft *draft, const struct json_text *text, const cJSON *json)
{
	struct draft_tour *tour = &draft->tours[draft->tour_count];
	struct tour_reader r = {
		.draft = draft, .json = text, .tour = tour, .line = json_text_line(text, json)
	};
	const char *id = cJSON_GetStringValue(cJSON_GetObjectItemCaseSensitive(json, "id"));
	const bool is_twice = id && draft_find_tour(draft, id) >= 0;
	int rc;

	tour->line = r.line;
	tour->thumbnail_picture = -1;
	tour->id = strdup(id ? id : "");
	if (!tour->id)
		return -ENOMEM;
	draft->tour_count++; /* from here on draft_finish frees it */
	if (!draft_is_id(tour->id))
		report(&r, "use 1 to %d of a-z, 0-9, - and _ for its \"id\"", INFO_ID_BYTES_MAX);
	if (is_twice)
		report(&r, "is defined twice: rename or remove one");
	check_keys(&r, json, " id title caption thumbnail attract scene viewpoint stops ");
	check_attract(&r, json);
	rc = read_texts(&r, json, "title", tour->titles, true);
	if (rc == 0)
		rc = read_texts(&r, json, "caption", tour->captions, false);
	if (rc == 0)
		rc = read_thumbnail(&r, json);
	if (rc < 0)
		return rc;
	return cJSON_HasObjectItem(json, "scene") ? read_scene(&r, json) : read_stops(&r, json);
}

static int read_array(struct draft *draft, const struct json_text *json, const cJSON *array)
{
	const cJSON *item;
	int count = cJSON_GetArraySize(array), rc = 0, i = 0;

	if (count > INFO_TOURS_MAX) {
		diagnostics_add(draft->diagnostics, -EINVAL, tours_file, 0,
				"%d tours: at most %d are possible", count, INFO_TOURS_MAX);
		return 0;
	}
	draft->tours = calloc((size_t)count + 1, sizeof(*draft->tours));
	if (!draft->tours)
		return -ENOMEM;
	cJSON_ArrayForEach(item, array)
	{
		if (rc < 0)
			break;
		if (cJSON_IsObject(item))
			rc = read_tour(draft, json, item);
		else
			diagnostics_add(
				draft->diagnostics, -EINVAL, tours_file, 0,
				"entry %d of \"tours\" is not an object: write {\"id\": ...}",
				i + 1);
		i++;
	}
	return rc;
}

int draft_read_tours(struct draft *draft)
{
	struct json_text json;
	const cJSON *array;
	int rc = draft_read_json(draft, tours_file, "tours", &json, &array);

	if (rc == 0 && array)
		rc = read_array(draft, &json, array);
	json_text_finish(&json);
	return rc;
}
