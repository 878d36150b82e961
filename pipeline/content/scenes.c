/* Reads scenes.json and makes scenery of the files that it names. */
#include "pipeline/content/scenes.h"

#include <cjson/cJSON.h>
#include <errno.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "base/array.h"
#include "base/json_text.h"
#include "format/page.h"
#include "format/scenery_code.h"
#include "pipeline/import/import_scenery.h"

static const char scenes_file[] = "scenes.json";

enum { FILE_BYTES_MAX = 1 << 20, ID_BYTES_MAX = 64, LOOKS_MAX = 64 };

struct reading {
	const struct content *content;
	struct diagnostics *diagnostics;
	struct json_text json;
	struct scenery_maker maker;
	const char *layer_ids[SCENERY_LAYERS_MAX]; /* borrowed from json */
	unsigned layer_uses[SCENERY_LAYERS_MAX];
	uint32_t title_room;
};

static int fault(const struct reading *r, unsigned line, const char *text, ...) printf_like(3, 4);

/* Adds a fault of scenes.json. Returns 0: reading goes on, to find others. */
static int fault(const struct reading *r, unsigned line, const char *text, ...)
{
	char message[400];
	va_list args;

	va_start(args, text);
	vsnprintf(message, sizeof(message), text, args);
	va_end(args);
	diagnostics_add(r->diagnostics, -EINVAL, scenes_file, line, "%s", message);
	return 0;
}

static const char *text_of(const cJSON *object, const char *key)
{
	return cJSON_GetStringValue(cJSON_GetObjectItemCaseSensitive(object, key));
}

/* Reports unknown keys, which are usually misspelt. */
static void check_keys(const struct reading *r, const cJSON *object, const char *known)
{
	char key[44];

	for (const cJSON *item = object->child; item; item = item->next) {
		snprintf(key, sizeof(key), " %.40s ", item->string);
		if (!strstr(known, key))
			fault(r, json_text_line(&r->json, object),
			      "\"%.40s\" is not one of its keys, which are:%s", item->string,
			      known);
	}
}

/* ---- layers */

static int add_title(struct reading *r, struct scenery_layer *layer, const char *language,
		     const char *text, unsigned line)
{
	struct scenery *out = &r->maker.out;
	struct scenery_title *title;
	int rc = ARRAY_RESERVE(out->titles, r->title_room, (uint64_t)out->title_count + 1,
			       SCENERY_TITLES_MAX);

	if (rc < 0)
		return rc;
	title = &out->titles[out->title_count];
	memset(title, 0, sizeof(*title));
	snprintf(title->language, sizeof(title->language), "%s", language);
	if (snprintf(title->text, sizeof(title->text), "%s", text) >= SCENERY_TITLE_BYTES)
		return fault(r, line, "the title in \"%s\" has over %d bytes: shorten it", language,
			     SCENERY_TITLE_BYTES - 1);
	out->title_count++;
	layer->title_count++;
	return 0;
}

static int read_titles(struct reading *r, const cJSON *json, struct scenery_layer *layer,
		       unsigned line)
{
	const struct content *content = r->content;
	const cJSON *titles = cJSON_GetObjectItemCaseSensitive(json, "title");
	int rc = 0;

	layer->first_title = r->maker.out.title_count;
	for (uint32_t i = 0; i < content->language_count && rc == 0; i++) {
		const char *text = text_of(titles, content->languages[i]);

		if (text && strspn(text, " \t\r\n") < strlen(text))
			rc = add_title(r, layer, content->languages[i], text, line);
		else if (i == 0)
			fault(r, line,
			      "a layer has no title in \"%s\", the first language: add \"title\": "
			      "{\"%s\": \"...\"}",
			      content->languages[i], content->languages[i]);
		else
			diagnostics_add(r->diagnostics, 0, scenes_file, line,
					"a layer has no title in \"%s\": that of another language "
					"is shown instead",
					content->languages[i]);
	}
	return rc;
}

static int find_layer(const struct reading *r, const char *id)
{
	for (uint32_t i = 0; i < r->maker.out.layer_count; i++)
		if (strcmp(r->layer_ids[i], id) == 0)
			return (int)i;
	return -1;
}

static int read_layer(struct reading *r, const cJSON *json)
{
	struct scenery *out = &r->maker.out;
	const unsigned line = json_text_line(&r->json, json);
	const char *id = text_of(json, "id");

	if (!cJSON_IsObject(json) || !id || !*id || strlen(id) > ID_BYTES_MAX)
		return fault(r, line, "a layer is {\"id\": \"built\", \"title\": {...}}");
	if (find_layer(r, id) >= 0)
		return fault(r, line, "layer \"%.64s\" is defined twice: rename or remove one", id);
	check_keys(r, json, " id title ");
	r->layer_ids[out->layer_count] = id;
	return read_titles(r, json, &out->layers[out->layer_count++], line);
}

static int read_layers(struct reading *r)
{
	const cJSON *array = cJSON_GetObjectItemCaseSensitive(r->json.root, "layers");
	const int count = cJSON_GetArraySize(array);
	const cJSON *item;
	int rc = 0;

	if (!array)
		return 0;
	if (!cJSON_IsArray(array) || count < 2 || count > SCENERY_LAYERS_MAX)
		return fault(r, 1, "\"layers\" must be a list of 2 to %d: visitors choose one",
			     SCENERY_LAYERS_MAX);
	r->maker.out.layers = calloc((size_t)count, sizeof(*r->maker.out.layers));
	if (!r->maker.out.layers)
		return -ENOMEM;
	cJSON_ArrayForEach(item, array) if (rc == 0) rc = read_layer(r, item);
	return rc;
}

/* ---- scenes */

/* Sets the layer of a scene. Returns false after a fault. */
static bool read_place(struct reading *r, const cJSON *json, unsigned line, uint32_t *layer,
		       struct import_options *options)
{
	const char *id = text_of(json, "layer"), *up = text_of(json, "up");
	const char *unit = text_of(json, "unit");
	int found = id ? find_layer(r, id) : -1;

	*layer = found < 0 ? SCENERY_NONE : (uint32_t)found;
	*options = (struct import_options){ .up = IMPORT_Y_UP };
	if (id && found < 0)
		fault(r, line, "layer \"%.64s\" is not one of \"layers\"; correct its name", id);
	else if (up && !import_axis_named(up, &options->up))
		fault(r, line, "\"up\" must be \"x\", \"y\" or \"z\", not \"%.20s\"", up);
	else if (unit && !import_unit_named(unit, &options->metres_per_unit))
		fault(r, line, "\"unit\" must be m, cm, mm, in or metres, not \"%.20s\"", unit);
	else
		return true;
	return false;
}

/* Sets what a scene says of a glTF file. Returns false after a fault. */
static bool read_choice(struct reading *r, const cJSON *json, unsigned line,
			struct import_scene *scene)
{
	const cJSON *plays = cJSON_GetObjectItemCaseSensitive(json, "plays");
	const char *how = cJSON_GetStringValue(plays);

	*scene = (struct import_scene){ .name = text_of(json, "scene"),
					.plays_always = how && strcmp(how, "always") == 0,
					.says_how = plays };
	if (!plays || (how && (scene->plays_always || strcmp(how, "touch") == 0)))
		return true;
	fault(r, line,
	      "\"plays\" must be \"touch\", when a visitor touches what moves, or \"always\"");
	return false;
}

/* ---- materials */

/* Returns the number of a key from 0 to most, 0 if it is left out. */
static float get_share(struct reading *r, const cJSON *json, const char *key, float most,
		       unsigned line)
{
	const cJSON *item = cJSON_GetObjectItemCaseSensitive(json, key);

	if (!item)
		return 0;
	if (cJSON_IsNumber(item) && item->valuedouble >= 0 && item->valuedouble <= most)
		return (float)item->valuedouble;
	fault(r, line, "\"%s\" must be a number from 0 to %g", key, most);
	return 0;
}

static void read_look(struct reading *r, const cJSON *json, struct scenery_look *look)
{
	const unsigned line = json_text_line(&r->json, json);
	const cJSON *substance = cJSON_GetObjectItemCaseSensitive(json, "substance");
	const char *name = cJSON_GetStringValue(substance);

	*look = (struct scenery_look){ .name = json->string };
	if (!cJSON_IsObject(json)) {
		fault(r, line, "material \"%.64s\" must be {\"substance\": \"wood\"}", look->name);
		return;
	}
	check_keys(r, json, " substance relief mirror ");
	look->substance = name ? substance_named(name) : SUBSTANCE_NONE;
	if (look->substance == SUBSTANCE_KINDS || (substance && !name)) {
		fault(r, line,
		      "\"substance\" must be marble, wood, sandstone, laterite or none, not "
		      "\"%.20s\"",
		      name ? name : "");
		look->substance = SUBSTANCE_NONE;
	}
	look->relief_m = get_share(r, json, "relief", 0.1f, line);
	look->mirror = get_share(r, json, "mirror", 1, line);
}

/* Fills looks from the materials of a scene. */
static uint32_t read_looks(struct reading *r, const cJSON *scene,
			   struct scenery_look looks[LOOKS_MAX])
{
	const cJSON *materials = cJSON_GetObjectItemCaseSensitive(scene, "materials");
	const unsigned line = json_text_line(&r->json, scene);
	uint32_t count = 0;
	const cJSON *item;

	if (!materials)
		return 0;
	if (!cJSON_IsObject(materials) || cJSON_GetArraySize(materials) > LOOKS_MAX) {
		fault(r, line, "\"materials\" must be {\"NAME\": {...}} with at most %d names",
		      LOOKS_MAX);
		return 0;
	}
	cJSON_ArrayForEach(item, materials) read_look(r, item, &looks[count++]);
	return count;
}

/* ---- the scenes */

static int read_scene(struct reading *r, const cJSON *json)
{
	const unsigned line = json_text_line(&r->json, json);
	const char *name = text_of(json, "file");
	char path[CONTENT_PATH_BYTES];
	struct scenery_look looks[LOOKS_MAX];
	struct import_options options;
	struct import_scene scene;
	uint32_t layer;
	int rc;

	if (!cJSON_IsObject(json) || !name)
		return fault(r, line, "a scene is {\"file\": \"scenes/door.wrl\"}");
	check_keys(r, json, " file layer up unit scene plays materials ");
	if (strncmp(name, "scenes/", 7) != 0 || strchr(name + 7, '/') ||
	    content_file_path(r->content, name, path) < 0)
		return fault(r, line,
			     "\"file\" must be in the folder scenes: \"scenes/NAME.wrl\" or .glb");
	if (!read_place(r, json, line, &layer, &options) || !read_choice(r, json, line, &scene))
		return 0;
	if (layer != SCENERY_NONE)
		r->layer_uses[layer]++;
	r->maker.looks = looks;
	r->maker.look_count = read_looks(r, json, looks);
	rc = import_scenery(&r->maker, path, layer, &options, &scene, r->diagnostics,
			    r->diagnostics);
	for (uint32_t i = 0; rc == 0 && i < r->maker.look_count; i++)
		if (!looks[i].is_used)
			fault(r, line, "no material of %s is called \"%.64s\": correct the name",
			      name, looks[i].name);
	r->maker.looks = NULL;
	r->maker.look_count = 0;
	return rc == -ENOMEM ? rc : 0;
}

static int read_scenes(struct reading *r)
{
	const cJSON *array = cJSON_GetObjectItemCaseSensitive(r->json.root, "scenes");
	uint32_t empty = 0;
	const cJSON *item;
	int rc = 0;

	if (!cJSON_IsArray(array) || cJSON_GetArraySize(array) == 0)
		return fault(r, 1, "must be {\"scenes\": [...]} at the top level");
	check_keys(r, r->json.root, " scenes layers ");
	cJSON_ArrayForEach(item, array) if (rc == 0) rc = read_scene(r, item);
	for (uint32_t i = 0; i < r->maker.out.layer_count; i++)
		empty += r->layer_uses[i] == 0;
	if (empty > 1)
		fault(r, 1, "%u layers have no scene and would look alike: remove all but one",
		      empty);
	return rc;
}

static int make(struct reading *r, struct scenery *out)
{
	const uint32_t errors = r->diagnostics->error_count;
	struct buffer object;
	int rc = read_layers(r);

	if (rc == 0)
		rc = read_scenes(r);
	if (rc < 0 || r->diagnostics->error_count > errors)
		return rc < 0 ? rc : -EINVAL;
	rc = scenery_maker_end(&r->maker, out);
	buffer_init(&object, OBJECT_BYTES_MAX);
	if (rc == 0)
		rc = scenery_encode(&object, out);
	buffer_finish(&object);
	if (rc == -EFBIG)
		diagnostics_add(r->diagnostics, -EINVAL, scenes_file, 0,
				"all scenes together are larger than an object may be, or over %d "
				"vertices bend or change their colours; simplify them",
				SCENERY_BENT_VERTICES_MAX);
	else if (rc == -EINVAL)
		diagnostics_add(r->diagnostics, rc, scenes_file, 0,
				"a scene has places or sizes beyond a thousand kilometres, or "
				"nodes nested over %d deep; correct its unit, or flatten it",
				SCENERY_DEPTH_MAX);
	return rc == -EFBIG ? -EINVAL : rc;
}

int scenes_read(struct scenery *out, const struct content *content, struct diagnostics *diagnostics)
{
	struct reading r = { .content = content, .diagnostics = diagnostics };
	char path[CONTENT_PATH_BYTES];
	struct buffer text;
	int rc = content_file_path(content, scenes_file, path);

	*out = (struct scenery){ 0 };
	buffer_init(&text, FILE_BYTES_MAX);
	if (rc == 0)
		rc = buffer_read_file(&text, path);
	if (rc == 0)
		rc = json_text_parse(&r.json, &text, scenes_file, diagnostics);
	else if (rc != -ENOENT)
		diagnostics_add(diagnostics, rc, scenes_file, 0, "cannot be read: %s",
				strerror(-rc));
	if (rc == 0)
		rc = make(&r, out);
	if (rc < 0)
		scenery_finish(out);
	scenery_maker_finish(&r.maker);
	json_text_finish(&r.json);
	buffer_finish(&text);
	return rc == -ENOENT ? 0 : rc == -EBADMSG ? -EINVAL : rc;
}
