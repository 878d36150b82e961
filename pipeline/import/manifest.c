/* Walks the scenes of a manifest and multiplies the transformations on the way. */
#include "pipeline/import/manifest.h"

#include <errno.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "base/array.h"
#include "pipeline/import/import_files.h"
#include "pipeline/import/json.h"

enum {
	SHOWN_BYTES = 80,
	STEPS_MAX = 8,    /* from a body to the resource in it */
	NESTED_MAX = 4,   /* scenes in one another */
	PAINTED_MAX = 64, /* scenes that are painted into others, altogether */
	SCENES_MAX = 256,
};

struct walk {
	struct manifest *out;
	const struct json_text *json;
	const cJSON *root;
	const char *path;
	struct diagnostics *diagnostics;
	uint32_t painted_scenes;
	uint32_t seen; /* annotations */
};

/* A scene that is being walked. */
struct scene {
	const cJSON *json;
	struct transform place; /* of the scene in the outermost one */
	uint32_t first;         /* of its items */
	int depth;              /* 0: it is painted into no other */
};

static const struct transform identity = { { { 1, 0, 0, 0 }, { 0, 1, 0, 0 }, { 0, 0, 1, 0 } } };

/* ---- JSON */

static const char *type_of(const cJSON *object)
{
	const char *type = json_string(object, "type");

	return type ? type : "";
}

static bool is_type(const cJSON *object, const char *type)
{
	return strcmp(type_of(object), type) == 0;
}

static bool ends_with(const char *text, const char *end)
{
	const size_t length = strlen(text), end_length = strlen(end);

	return length >= end_length && strcmp(text + length - end_length, end) == 0;
}

const char *manifest_id(const cJSON *resource)
{
	const char *id = cJSON_GetStringValue(resource);

	return id ? id : json_string(resource, "id");
}

static const char *shown_id(const cJSON *resource)
{
	const char *id = manifest_id(resource);

	return id ? id : "without id";
}

bool manifest_is(const cJSON *root)
{
	return is_type(root, "Manifest");
}

/* ---- what has no place */

/* Adds a warning unless it is there already: a scene may be painted twice. */
static void leave_out(struct walk *walk, const cJSON *object, const char *what, const char *id,
		      const char *cure)
{
	struct diagnostics *list = &walk->out->left_out;
	struct diagnostics one = { 0 };

	diagnostics_add(&one, 0, walk->path, json_text_line(walk->json, object),
			"%.*s %.*s is left out: %s", SHOWN_BYTES, what, SHOWN_BYTES, id, cure);
	for (uint32_t i = 0; i < list->count; i++)
		if (strcmp(diagnostics_get(list, i)->text, one.first.text) == 0)
			return;
	diagnostics_add(list, 0, walk->path, one.first.line, "%s",
			one.first.text + one.first.place_bytes);
}

static void leave_out_type(struct walk *walk, const cJSON *annotation, const cJSON *resource)
{
	const char *type = type_of(resource);

	leave_out(walk, annotation, type[0] ? type : "a resource without type", shown_id(resource),
		  ends_with(type, "Light")
			  ? "a release has no lights of its own; see lit and sun in temple.ini"
			  : "only models, scenes and comments are imported");
}

/* Names the members of a scene, an annotation or a target that nothing here stands for. */
static void leave_out_members(struct walk *walk, const cJSON *object)
{
	static const struct {
		const char *key, *cure;
	} members[] = {
		{ "duration", "a release has no time" },
		{ "spatialScale", "write its metres as 'unit' into temple.ini" },
		{ "exclude", "cameras and lights in a model's file are never imported" },
		{ "instant", "a release has no time" },
		{ "timeMode", "a release has no time" },
		{ "structures", "tours are written in tours.json" },
	};
	const char *colour = json_string(object, "backgroundColor");
	char key[32];

	if (colour)
		leave_out(walk, object, "backgroundColor", colour,
			  "write it as 'background' into [model] of temple.ini");
	for (size_t i = 0; i < ARRAY_COUNT(members); i++) {
		if (!json_member(object, members[i].key))
			continue;
		snprintf(key, sizeof(key), "\"%s\" of", members[i].key);
		leave_out(walk, object, key, shown_id(object), members[i].cure);
	}
}

/* ---- transformations */

/* out = a * b: what b does comes first. out may be neither. */
static void multiply(struct transform *out, const struct transform *a, const struct transform *b)
{
	for (int r = 0; r < 3; r++)
		for (int c = 0; c < 4; c++) {
			double sum = c == 3 ? a->rows[r][3] : 0;

			for (int k = 0; k < 3; k++)
				sum += a->rows[r][k] * b->rows[k][c];
			out->rows[r][c] = sum;
		}
}

static void append(struct transform *place, const struct transform *step)
{
	struct transform product;

	multiply(&product, place, step);
	*place = product;
}

static void read_xyz(const cJSON *object, double missing, double out[3])
{
	static const char *const keys[] = { "x", "y", "z" };

	for (int k = 0; k < 3; k++) {
		const cJSON *number = json_member(object, keys[k]);

		out[k] = cJSON_IsNumber(number) ? number->valuedouble : missing;
	}
}

/* Quarter turns are exact. */
static void turn_of(double deg, double *cosine, double *sine)
{
	static const double quarters[] = { 1, 0, -1, 0 };
	const double turn = fmod(deg, 360);

	if (isfinite(turn) && fmod(turn, 90) == 0) {
		const int i = ((int)(turn / 90) + 4) % 4;

		*cosine = quarters[i];
		*sine = quarters[(i + 3) % 4];
		return;
	}
	*cosine = cos(turn * M_PI / 180);
	*sine = sin(turn * M_PI / 180);
}

/* Turns about x, y and z, counter-clockwise seen from the axis's end: Rx * Ry * Rz. */
static void rotate(struct transform *place, const double degrees[3])
{
	for (int k = 0; k < 3; k++) {
		const int a = (k + 1) % 3, b = (k + 2) % 3;
		struct transform step = identity;

		turn_of(degrees[k], &step.rows[a][a], &step.rows[b][a]);
		step.rows[b][b] = step.rows[a][a];
		step.rows[a][b] = -step.rows[b][a];
		append(place, &step);
	}
}

static void translate(struct transform *place, const double by[3])
{
	struct transform step = identity;

	for (int k = 0; k < 3; k++)
		step.rows[k][3] = by[k];
	append(place, &step);
}

static void transform_by(struct walk *walk, struct transform *place, const cJSON *said)
{
	struct transform step = identity;
	double xyz[3];

	read_xyz(said, is_type(said, "ScaleTransform"), xyz);
	if (is_type(said, "RotateTransform")) {
		rotate(place, xyz);
	} else if (is_type(said, "TranslateTransform")) {
		translate(place, xyz);
	} else if (is_type(said, "ScaleTransform")) {
		for (int k = 0; k < 3; k++)
			step.rows[k][k] = xyz[k];
		append(place, &step);
	} else {
		leave_out(walk, said, "a transform of type", type_of(said),
			  "what is known are RotateTransform, ScaleTransform and "
			  "TranslateTransform");
	}
}

/* The first of the list is done first, so it stands last in the product. */
static void append_transforms(struct walk *walk, struct transform *place, const cJSON *resource)
{
	const cJSON *list = json_member(resource, "transform");
	const cJSON *at = json_first(list);

	if (!at)
		return;
	if (cJSON_IsArray(list))
		at = at->prev; /* cJSON: the first child's prev is the last child */
	for (;; at = at->prev) {
		transform_by(walk, place, at);
		if (!cJSON_IsArray(list) || at == list->child)
			return;
	}
}

bool manifest_point(const cJSON *selector, double out[3])
{
	read_xyz(selector, 0, out);
	return is_type(selector, "PointSelector");
}

/* Appends where the target says that the body lies. */
static void append_position(struct walk *walk, struct transform *place, const cJSON *target)
{
	const cJSON *selectors = json_member(target, "selector");
	double point[3];

	for (const cJSON *s = json_first(selectors); s; s = json_next(selectors, s)) {
		leave_out_members(walk, s);
		if (manifest_point(s, point)) {
			translate(place, point);
			return;
		}
	}
	if (json_first(selectors))
		leave_out(walk, json_first(selectors), "a selector of type",
			  type_of(json_first(selectors)),
			  "what is painted there lies at the scene's origin; give a "
			  "PointSelector");
}

/* ---- the walk */

static int add_item(struct walk *walk, enum manifest_kind kind, const cJSON *annotation,
		    const cJSON *resource, const struct transform *place)
{
	struct manifest *out = walk->out;
	const unsigned line = json_text_line(walk->json, annotation);
	int rc = ARRAY_RESERVE(out->items, out->room, out->count + 1, MANIFEST_ITEMS_MAX);

	if (rc == -EFBIG)
		return diagnostics_add(walk->diagnostics, rc, walk->path, line,
				       "over %d models, cameras and comments; split the manifest",
				       MANIFEST_ITEMS_MAX);
	if (rc == 0)
		out->items[out->count++] =
			(struct manifest_item){ kind, annotation, resource, line, *place };
	return rc;
}

static const cJSON *find_scene(const struct walk *walk, const char *id)
{
	const cJSON *item;

	if (!id)
		return NULL;
	cJSON_ArrayForEach(item, json_member(walk->root, "items"))
	{
		const char *other = json_string(item, "id");

		if (is_type(item, "Scene") && other && strcmp(id, other) == 0)
			return item;
	}
	return NULL;
}

/* Follows the body through lists, choices and specific resources, with their transformations, to
 * what is painted. Returns NULL if there is nothing. */
static const cJSON *resource_of(struct walk *walk, const cJSON *annotation, const cJSON *body,
				struct transform *place)
{
	for (int i = 0; i < STEPS_MAX && body; i++) {
		const cJSON *first = json_first(body);

		if (first && json_next(body, first))
			leave_out(walk, annotation, "all but the first of several bodies of",
				  shown_id(annotation), "write an annotation for each");
		body = first;
		if (is_type(body, "SpecificResource")) {
			append_transforms(walk, place, body);
			body = json_member(body, "source");
		} else if (is_type(body, "Choice")) {
			leave_out(walk, annotation, "all but the first of the Choice in",
				  shown_id(annotation), "visitors have no choice of models");
			body = json_member(body, "items");
		} else {
			return body;
		}
	}
	return NULL;
}

static int walk_scene(struct walk *walk, const struct scene *scene);

static int paint_scene(struct walk *walk, const struct scene *into, const cJSON *annotation,
		       const cJSON *painted, const struct transform *place)
{
	const struct scene scene = { painted, *place, walk->out->count, into->depth + 1 };

	if (scene.depth > NESTED_MAX || ++walk->painted_scenes > PAINTED_MAX)
		return diagnostics_add(walk->diagnostics, -EFBIG, walk->path,
				       json_text_line(walk->json, annotation),
				       "scenes are painted into scenes more than %d deep, or over "
				       "%d altogether: paint their models into one scene",
				       NESTED_MAX, PAINTED_MAX);
	return walk_scene(walk, &scene);
}

static bool is_model(const cJSON *resource)
{
	static const char *const extensions[] = { ".glb", ".gltf", ".obj", ".ply", ".stl", ".off" };
	const char *id = cJSON_GetStringValue(resource);

	for (size_t i = 0; id && i < ARRAY_COUNT(extensions); i++)
		if (import_has_extension(id, extensions[i]))
			return true;
	return is_type(resource, "Model");
}

static int paint(struct walk *walk, const struct scene *scene, const cJSON *annotation)
{
	struct transform place = scene->place, own = identity;
	const cJSON *resource =
		resource_of(walk, annotation, json_member(annotation, "body"), &own);
	const cJSON *nested = find_scene(walk, resource ? manifest_id(resource) : NULL);
	const bool is_camera = ends_with(type_of(resource), "Camera");

	if (!nested && !is_camera && !is_model(resource)) {
		leave_out_type(walk, annotation, resource);
		return 0;
	}
	append_position(walk, &place, json_first(json_member(annotation, "target")));
	append(&place, &own);
	if (nested)
		return paint_scene(walk, scene, annotation, nested, &place);
	return add_item(walk, is_camera ? MANIFEST_CAMERA : MANIFEST_MODEL, annotation, resource,
			&place);
}

/* Returns where the axes of the comment's target are: those of the scene, or of a model in it. */
static struct transform axes_of(const struct walk *walk, const struct scene *scene,
				const cJSON *source)
{
	const char *id = manifest_id(source), *scene_id = json_string(scene->json, "id");

	if (!id || (scene_id && strcmp(id, scene_id) == 0))
		return scene->place;
	for (uint32_t i = scene->first; i < walk->out->count; i++) {
		const struct manifest_item *item = &walk->out->items[i];
		const char *annotation = json_string(item->annotation, "id");
		const char *resource = item->resource ? manifest_id(item->resource) : NULL;

		if (item->kind == MANIFEST_MODEL && ((annotation && strcmp(id, annotation) == 0) ||
						     (resource && strcmp(id, resource) == 0)))
			return item->place;
	}
	return scene->place;
}

static int comment(struct walk *walk, const struct scene *scene, const cJSON *annotation)
{
	const cJSON *target = json_first(json_member(annotation, "target"));
	struct transform place = axes_of(walk, scene, json_first(json_member(target, "source")));

	append_transforms(walk, &place, target);
	return add_item(walk, MANIFEST_COMMENT, annotation, NULL, &place);
}

static bool has_motivation(const cJSON *annotation, const char *wanted)
{
	const cJSON *said = json_member(annotation, "motivation");

	for (const cJSON *one = json_first(said); one; one = json_next(said, one))
		if (cJSON_IsString(one) && strcmp(one->valuestring, wanted) == 0)
			return true;
	return false;
}

static int walk_annotation(struct walk *walk, const struct scene *scene, const cJSON *annotation)
{
	static const char *const comments[] = { "commenting", "describing", "tagging" };

	if (is_type(annotation, "Choice")) {
		leave_out(walk, annotation, "all but the first of the Choice", shown_id(annotation),
			  "visitors have no choice of views");
		annotation = json_first(json_member(annotation, "items"));
	}
	if (++walk->seen > MANIFEST_ITEMS_MAX * 16)
		return diagnostics_add(walk->diagnostics, -EFBIG, walk->path, 0,
				       "over %d annotations; split the manifest",
				       MANIFEST_ITEMS_MAX * 16);
	leave_out_members(walk, annotation);
	if (has_motivation(annotation, "painting"))
		return paint(walk, scene, annotation);
	for (size_t i = 0; i < ARRAY_COUNT(comments); i++)
		if (has_motivation(annotation, comments[i]))
			return comment(walk, scene, annotation);
	leave_out(walk, annotation, "annotation", shown_id(annotation),
		  "its motivation is none of painting, commenting, describing and tagging");
	return 0;
}

static int walk_pages(struct walk *walk, const struct scene *scene, const char *key)
{
	const cJSON *page, *annotation;
	int rc = 0;

	cJSON_ArrayForEach(page, json_member(scene->json, key))
	{
		if (cJSON_IsObject(page) && !json_member(page, "items"))
			leave_out(walk, page, "page", shown_id(page),
				  "it is in another file; fetch it and put its \"items\" here");
		cJSON_ArrayForEach(annotation, json_member(page, "items")) if (rc == 0) rc =
			walk_annotation(walk, scene, annotation);
	}
	return rc;
}

/* Comments come last: their targets may be models of the scene. */
static int walk_scene(struct walk *walk, const struct scene *scene)
{
	int rc;

	leave_out_members(walk, scene->json);
	rc = walk_pages(walk, scene, "items");
	return rc == 0 ? walk_pages(walk, scene, "annotations") : rc;
}

/* The scenes that others paint; they do not stand on their own. */
struct painted {
	uint32_t count;
	const cJSON *scenes[SCENES_MAX];
};

static bool is_painted(const struct painted *painted, const cJSON *scene)
{
	for (uint32_t i = 0; i < painted->count; i++)
		if (painted->scenes[i] == scene)
			return true;
	return false;
}

static void find_painted(const struct walk *walk, struct painted *painted)
{
	struct manifest unused = { 0 };
	struct walk look = { .out = &unused, .json = walk->json, .root = walk->root };
	const cJSON *scene, *page, *annotation;

	painted->count = 0;
	cJSON_ArrayForEach(scene, json_member(walk->root, "items"))
		cJSON_ArrayForEach(page, json_member(scene, "items"))
			cJSON_ArrayForEach(annotation, json_member(page, "items"))
	{
		struct transform place = identity;
		const cJSON *resource =
			resource_of(&look, annotation, json_member(annotation, "body"), &place);
		const cJSON *found = find_scene(walk, resource ? manifest_id(resource) : NULL);

		if (found && found != scene && !is_painted(painted, found))
			painted->scenes[painted->count++] = found;
	}
}

static int walk_manifest(struct walk *walk)
{
	struct painted painted;
	const cJSON *item;
	uint32_t scenes = 0;
	int rc = 0;

	if (cJSON_GetArraySize(json_member(walk->root, "items")) > SCENES_MAX)
		return diagnostics_add(walk->diagnostics, -EFBIG, walk->path, 1,
				       "over %d scenes and canvases; split the manifest",
				       SCENES_MAX);
	leave_out_members(walk, walk->root);
	find_painted(walk, &painted);
	cJSON_ArrayForEach(item, json_member(walk->root, "items"))
	{
		const struct scene scene = { item, identity, walk->out->count, 0 };

		if (rc < 0)
			break;
		if (!is_type(item, "Scene")) {
			leave_out(walk, item, type_of(item), shown_id(item),
				  "only scenes are imported");
			continue;
		}
		if (is_painted(&painted, item))
			continue;
		if (++scenes == 2)
			leave_out(walk, item, "the border between scene", shown_id(item),
				  "it lies together with the scenes before it; keep one scene in "
				  "each manifest to part them");
		rc = walk_scene(walk, &scene);
	}
	if (rc == 0 && scenes == 0)
		rc = diagnostics_add(
			walk->diagnostics, -EBADMSG, walk->path, 1,
			"the manifest has no scene, or only such as are painted into one "
			"another: add a Scene to its \"items\"");
	return rc;
}

int manifest_read(struct manifest *out, const struct json_text *json, const char *path,
		  struct diagnostics *diagnostics)
{
	struct walk walk = { .out = out,
			     .json = json,
			     .root = json->root,
			     .path = path,
			     .diagnostics = diagnostics };
	int rc;

	*out = (struct manifest){ .left_out.max = MANIFEST_LEFT_OUT_MAX };
	if (manifest_is(json->root))
		rc = walk_manifest(&walk);
	else
		rc = diagnostics_add(diagnostics, -EBADMSG, path, 1,
				     "is no IIIF manifest: \"type\" must be \"Manifest\"");
	if (rc < 0)
		manifest_finish(out);
	return rc;
}

void manifest_finish(struct manifest *manifest)
{
	if (!manifest)
		return;
	free(manifest->items);
	diagnostics_finish(&manifest->left_out);
	*manifest = (struct manifest){ 0 };
}

/* ---- cameras */

/* Returns the annotation's place: that of its first PointSelector, or of its axes. */
static void place_of(const struct manifest_item *item, double out[3])
{
	const cJSON *selectors =
		json_member(json_first(json_member(item->annotation, "target")), "selector");
	double point[3] = { 0, 0, 0 };

	if (item->kind == MANIFEST_COMMENT && !manifest_point(json_first(selectors), point))
		memset(point, 0, sizeof(point));
	transform_point(&item->place, point, out);
}

void manifest_view(const struct manifest *manifest, const struct manifest_item *camera,
		   double eye[3], double target[3])
{
	static const double origin[3] = { 0, 0, 0 };
	const cJSON *look_at = json_member(camera->resource, "lookAt");
	const char *id = manifest_id(look_at);
	double ahead[3] = { 0, 0, -1 };

	transform_point(&camera->place, origin, eye);
	if (manifest_point(look_at, target))
		return;
	for (uint32_t i = 0; id && i < manifest->count; i++) {
		const char *other = json_string(manifest->items[i].annotation, "id");

		if (other && strcmp(id, other) == 0) {
			place_of(&manifest->items[i], target);
			return;
		}
	}
	/* as far as the scene's origin, which is in the midst of what there is to see */
	ahead[2] = -fmax(sqrt(eye[0] * eye[0] + eye[1] * eye[1] + eye[2] * eye[2]), 1e-3);
	transform_point(&camera->place, ahead, target);
}

void manifest_z_up(const double from[3], double to[3])
{
	const double y = from[1], z = from[2];

	to[0] = from[0];
	to[1] = 0 - z; /* no -0 */
	to[2] = y;
}
