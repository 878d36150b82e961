/* Reads a browser's JSON; nothing in it is trusted. */
#include "curator/session/request.h"

#include <cjson/cJSON.h>
#include <errno.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "base/json_tree.h"
#include "base/utf8.h"
#include "curator/session/painter.h"

static const double far_m = 1e6; /* of everything */

struct parse {
	const cJSON *root;
	char *problem;
};

static int wrong(const struct parse *parse, const char *key, const char *expects)
{
	snprintf(parse->problem, REQUEST_PROBLEM_BYTES, "\"%s\" must be %s", key, expects);
	return -EINVAL;
}

static bool in_range(const cJSON *item, double least, double most)
{
	return cJSON_IsNumber(item) && isfinite(item->valuedouble) && item->valuedouble >= least &&
	       item->valuedouble <= most;
}

static int read_number(const struct parse *parse, const char *key, double least, double most,
		       double *out)
{
	const cJSON *item = cJSON_GetObjectItemCaseSensitive(parse->root, key);
	char expects[64];

	if (in_range(item, least, most)) {
		*out = item->valuedouble;
		return 0;
	}
	snprintf(expects, sizeof(expects), "a number from %g to %g", least, most);
	return wrong(parse, key, expects);
}

static int read_side(const struct parse *parse, const char *key, int *out)
{
	double value;
	int rc = read_number(parse, key, PAINTER_SIDE_MIN_PX, PAINTER_SIDE_MAX_PX, &value);

	if (rc == 0)
		*out = (int)value / 2 * 2;
	return rc;
}

static int read_view(const struct parse *parse, uint32_t *out)
{
	double value;
	int rc = read_number(parse, "view", 0, UINT32_MAX, &value);

	if (rc == 0)
		*out = (uint32_t)value;
	return rc;
}

static int read_point(const struct parse *parse, const char *key, float out[3])
{
	const cJSON *list = cJSON_GetObjectItemCaseSensitive(parse->root, key);

	if (!cJSON_IsArray(list) || cJSON_GetArraySize(list) != 3)
		return wrong(parse, key, "three numbers");
	for (int i = 0; i < 3; i++) {
		const cJSON *item = cJSON_GetArrayItem(list, i);

		if (!in_range(item, -far_m, far_m))
			return wrong(parse, key, "three numbers of metres");
		out[i] = (float)item->valuedouble;
	}
	return 0;
}

/* Missing is no. */
static int read_flag(const struct parse *parse, const char *key, bool *out)
{
	const cJSON *item = cJSON_GetObjectItemCaseSensitive(parse->root, key);

	if (item && !cJSON_IsBool(item))
		return wrong(parse, key, "true or false");
	*out = cJSON_IsTrue(item);
	return 0;
}

static int read_flags(const struct parse *parse, struct request *out)
{
	int rc = read_flag(parse, "take", &out->take);

	return rc == 0 ? read_flag(parse, "through", &out->through) : rc;
}

/* ---- kinds */

static int read_camera(const struct parse *parse, struct request *out)
{
	struct camera *camera = &out->camera;
	double fov_deg;
	int rc = read_view(parse, &out->view);

	*camera = (struct camera){ .up = { 0, 0, 1 } };
	if (rc == 0)
		rc = read_point(parse, "eye", camera->eye_m);
	if (rc == 0)
		rc = read_point(parse, "target", camera->target_m);
	if (rc == 0)
		rc = read_number(parse, "fov", 5, 120, &fov_deg);
	if (rc == 0)
		rc = read_side(parse, "width", &camera->width_px);
	if (rc == 0)
		rc = read_side(parse, "height", &camera->height_px);
	if (rc == 0)
		rc = read_flag(parse, "moving", &out->moving);
	if (rc == 0 && memcmp(camera->eye_m, camera->target_m, sizeof(camera->eye_m)) == 0)
		rc = wrong(parse, "target", "another point than \"eye\"");
	if (rc == 0)
		camera->fov_deg = (float)fov_deg;
	return rc;
}

/* x0, y0, x1, y1 and so on. */
static int read_points(const struct parse *parse, struct request *out, uint32_t most)
{
	const cJSON *list = cJSON_GetObjectItemCaseSensitive(parse->root, "points"), *item;
	const int count = cJSON_IsArray(list) ? cJSON_GetArraySize(list) : 0;
	char expects[64];
	int n = 0;

	snprintf(expects, sizeof(expects), "pairs of numbers, 1 to %u of them", most);
	if (count < 2 || count % 2 != 0 || (unsigned)count > 2 * most)
		return wrong(parse, "points", expects);
	out->points_px = malloc((size_t)count / 2 * sizeof(*out->points_px));
	if (!out->points_px)
		return -ENOMEM;
	out->point_count = (uint32_t)count / 2;
	cJSON_ArrayForEach(item, list)
	{
		if (!in_range(item, -2 * PAINTER_SIDE_MAX_PX, 2 * PAINTER_SIDE_MAX_PX))
			return wrong(parse, "points", "pairs of numbers of pixels");
		out->points_px[n / 2][n % 2] = (float)item->valuedouble;
		n++;
	}
	return 0;
}

static int read_tool(const struct parse *parse, enum request_tool *out)
{
	static const char *const names[] = { "lasso", "part", "rest", "heavy" };
	const cJSON *item = cJSON_GetObjectItemCaseSensitive(parse->root, "tool");

	for (unsigned n = 0; cJSON_IsString(item) && n < ARRAY_COUNT(names); n++)
		if (strcmp(item->valuestring, names[n]) == 0) {
			*out = (enum request_tool)n;
			return 0;
		}
	return wrong(parse, "tool", "lasso, part, rest or heavy");
}

static int read_stroke(const struct parse *parse, struct request *out)
{
	double width_px;
	int rc = read_view(parse, &out->view);

	if (rc == 0)
		rc = read_tool(parse, &out->tool);
	if (rc == 0)
		rc = read_number(parse, "width", 1, 200, &width_px);
	if (rc == 0)
		rc = read_flags(parse, out);
	if (rc < 0)
		return rc;
	out->width_px = (float)width_px;
	return read_points(parse, out, STROKE_POINTS_MAX);
}

static int read_apply(const struct parse *parse, struct request *out)
{
	int rc = read_view(parse, &out->view);

	return rc == 0 ? read_flags(parse, out) : rc;
}

static int read_pick(const struct parse *parse, struct request *out)
{
	int rc = read_view(parse, &out->view);

	return rc == 0 ? read_points(parse, out, 1) : rc;
}

static int read_open(const struct parse *parse, struct request *out)
{
	const cJSON *item = cJSON_GetObjectItemCaseSensitive(parse->root, "id");
	const char *id = cJSON_IsString(item) ? item->valuestring : "";
	const size_t bytes = strlen(id);

	if (bytes == 0 || bytes >= sizeof(out->id) ||
	    strspn(id, "abcdefghijklmnopqrstuvwxyz0123456789-_") != bytes)
		return wrong(parse, "id", "1 to 64 characters of a-z 0-9 - _");
	memcpy(out->id, id, bytes + 1);
	return 0;
}

/* Missing is "". */
static int read_text(const struct parse *parse, const char *key, char *out, size_t out_bytes)
{
	const cJSON *item = cJSON_GetObjectItemCaseSensitive(parse->root, key);
	size_t bytes;

	if (!item)
		return 0;
	bytes = cJSON_IsString(item) ? strlen(item->valuestring) : out_bytes;
	if (bytes >= out_bytes)
		return wrong(parse, key, "a text, and shorter");
	for (size_t i = 0, size; i < bytes; i += size) {
		size = utf8_bytes(item->valuestring + i, bytes - i);
		if (size == 0)
			return wrong(parse, key, "a text of one line in UTF-8");
	}
	memcpy(out, item->valuestring, bytes + 1);
	return 0;
}

static int read_save(const struct parse *parse, struct request *out)
{
	int rc = read_open(parse, out);

	if (rc == 0)
		rc = read_text(parse, "title", out->title, sizeof(out->title));
	if (rc == 0)
		rc = read_text(parse, "from", out->from, sizeof(out->from));
	if (rc == 0)
		rc = read_flag(parse, "new", &out->is_new);
	if (rc == 0)
		rc = read_flag(parse, "replace", &out->replaces);
	if (rc == 0)
		rc = read_text(parse, "language", out->language, sizeof(out->language));
	return rc;
}

static int read_nothing(const struct parse *parse, struct request *out)
{
	(void)parse;
	(void)out;
	return 0;
}

static const struct {
	const char *name;
	int (*read)(const struct parse *parse, struct request *out);
} kinds[] = {
	[REQUEST_CAMERA] = { "camera", read_camera },
	[REQUEST_GOT] = { "got", read_nothing },
	[REQUEST_STROKE] = { "stroke", read_stroke },
	[REQUEST_APPLY] = { "apply", read_apply },
	[REQUEST_CLEAR] = { "clear", read_nothing },
	[REQUEST_UNDO] = { "undo", read_nothing },
	[REQUEST_REDO] = { "redo", read_nothing },
	[REQUEST_GROW] = { "grow", read_nothing },
	[REQUEST_SHRINK] = { "shrink", read_nothing },
	[REQUEST_SMOOTH] = { "smooth", read_nothing },
	[REQUEST_EMPTY] = { "empty", read_nothing },
	[REQUEST_PICK] = { "pick", read_pick },
	[REQUEST_SAVE] = { "save", read_save },
	[REQUEST_OPEN] = { "open", read_open },
};

const char *request_type(enum request_kind kind)
{
	return kinds[kind].name;
}

static int read_kind(const struct parse *parse, struct request *out)
{
	const cJSON *item = cJSON_GetObjectItemCaseSensitive(parse->root, "type");

	for (unsigned n = 0; cJSON_IsString(item) && n < ARRAY_COUNT(kinds); n++)
		if (strcmp(item->valuestring, kinds[n].name) == 0) {
			out->kind = (enum request_kind)n;
			return kinds[n].read(parse, out);
		}
	return wrong(parse, "type", "one that docs/curator.md lists");
}

int request_parse(struct request *out, const char *text, size_t bytes,
		  char problem[REQUEST_PROBLEM_BYTES])
{
	cJSON *root = NULL;
	int rc = -EINVAL;

	*out = (struct request){ 0 };
	snprintf(problem, REQUEST_PROBLEM_BYTES, "is not an object of JSON");
	if (bytes <= REQUEST_BYTES_MAX)
		rc = json_parse(&root, (struct bytes){ (const uint8_t *)text, bytes });
	if (cJSON_IsObject(root))
		rc = read_kind(&(struct parse){ root, problem }, out);
	else if (rc != -ENOMEM)
		rc = -EINVAL;
	cJSON_Delete(root);
	if (rc == -ENOMEM)
		snprintf(problem, REQUEST_PROBLEM_BYTES, "no memory is left");
	if (rc < 0)
		request_finish(out);
	return rc;
}

void request_finish(struct request *request)
{
	if (!request)
		return;
	free(request->points_px);
	*request = (struct request){ 0 };
}
