/* Makes the messages of JSON. */
#include "curator/session/answers.h"

#include <cjson/cJSON.h>

#include "base/json_tree.h"
#include "curator/session/part_store.h"

enum { PARTS_BYTES_MAX = 4 << 20 };

static cJSON *message_of(const char *type)
{
	cJSON *json = cJSON_CreateObject();

	cJSON_AddStringToObject(json, "type", type);
	return json;
}

/* json is taken. */
static char *text_of(cJSON *json)
{
	char *text = json_line(json);

	cJSON_Delete(json);
	return text;
}

char *answer_error(const char *of, const char *conflict, const char *text)
{
	cJSON *json = message_of("error");

	if (of)
		cJSON_AddStringToObject(json, "of", of);
	if (conflict)
		cJSON_AddStringToObject(json, "conflict", conflict);
	cJSON_AddStringToObject(json, "message", text);
	return text_of(json);
}

char *answer_region(const struct region_set *set, bool has_marks, const char *opened)
{
	cJSON *json = message_of("region");

	cJSON_AddNumberToObject(json, "triangles", set->count);
	cJSON_AddNumberToObject(json, "undo", set->done_count);
	cJSON_AddNumberToObject(json, "redo", set->step_count - set->done_count);
	cJSON_AddBoolToObject(json, "marks", has_marks);
	if (opened)
		cJSON_AddStringToObject(json, "opened", opened);
	return text_of(json);
}

static char *answer_list(struct bytes parts, const char *saved)
{
	cJSON *json = message_of("parts"), *rows;

	if (json_parse(&rows, parts) < 0)
		rows = NULL; /* only for lack of memory, which loses the session */
	json_add(json, "parts", rows);
	if (saved)
		cJSON_AddStringToObject(json, "saved", saved);
	return text_of(json);
}

char *answer_parts(struct site *site, const char *saved)
{
	struct diagnostics diagnostics = { 0 };
	struct buffer parts;
	char *text;
	int rc;

	buffer_init(&parts, PARTS_BYTES_MAX);
	rc = part_store_list(site, &parts, &diagnostics);
	if (rc == 0)
		rc = parts.error;
	text = rc < 0 ? answer_error(NULL, NULL, diagnostics_cause(&diagnostics, rc))
		      : answer_list(buffer_bytes(&parts), saved);
	buffer_finish(&parts);
	return text;
}

static void add_point(cJSON *json, const char *key, const float point[3])
{
	json_add(json, key, cJSON_CreateFloatArray(point, 3));
}

char *answer_point(const float point_m[3])
{
	cJSON *json = message_of("point");

	if (point_m)
		add_point(json, "at", point_m);
	return text_of(json);
}

char *answer_hello(const struct site *site)
{
	const struct content *content = &site->content;
	cJSON *json = message_of("hello"), *languages;

	cJSON_AddStringToObject(json, "name", content->name);
	cJSON_AddNumberToObject(json, "triangles", site->mesh->triangle_count);
	if (content->error_mm > 0)
		cJSON_AddNumberToObject(json, "error", content->error_mm / 1000);
	add_point(json, "low", site->master->box_min_m);
	add_point(json, "high", site->master->box_max_m);
	if (content->has_start) {
		add_point(json, "eye", content->start_eye_m);
		add_point(json, "target", content->start_target_m);
	}
	languages = cJSON_AddArrayToObject(json, "languages");
	for (uint32_t n = 0; n < content->language_count; n++)
		json_append(languages, cJSON_CreateString(content->languages[n]));
	return text_of(json);
}
