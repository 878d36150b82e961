/* Reads the steps of a deformation. Every key is known, every number is checked. */
#include "pipeline/deform/deform_plan.h"

#include <cjson/cJSON.h>
#include <errno.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "base/bytes.h"
#include "base/json_text.h"
#include "base/safe_open.h"
#include "geometry/nurbs.h"
#include "pipeline/deform/control_lattice.h"

#define COORDINATE_MAX 1e9

enum { FILE_BYTES_MAX = 16 << 20 };

struct plan_reader {
	struct deform_plan *plan;
	const struct json_text *json;
	const char *path;
	struct diagnostics *diagnostics;
	uint32_t moves;
};

static void finish_step(struct deform_step *step)
{
	free(step->moves);
	free(step->surface.points);
	free(step->surface.weights);
	free(step->surface.knots[0]);
	free(step->surface.knots[1]);
}

void deform_plan_finish(struct deform_plan *plan)
{
	for (uint32_t i = 0; i < plan->step_count; i++)
		finish_step(&plan->steps[i]);
	free(plan->steps);
	*plan = (struct deform_plan){ 0 };
}

static const cJSON *member(const cJSON *object, const char *key)
{
	return cJSON_GetObjectItemCaseSensitive(object, key);
}

static int refuse(const struct plan_reader *r, unsigned line, const char *key, const char *cure)
{
	return diagnostics_add(r->diagnostics, -EINVAL, r->path, line, "\"%s\" %s", key, cure);
}

/* Refuses keys that are not known, which are usually misspelt. */
static int check_keys(const struct plan_reader *r, const cJSON *object, const char *known)
{
	const unsigned line = json_text_line(r->json, object);

	for (const cJSON *item = object->child; item; item = item->next) {
		char key[40];

		snprintf(key, sizeof(key), " %.36s ", item->string);
		if (!strstr(known, key))
			return diagnostics_add(r->diagnostics, -EINVAL, r->path, line,
					       "\"%.40s\" is not one of the keys, which are:%s",
					       item->string, known);
	}
	return 0;
}

static bool is_coordinate(const cJSON *item)
{
	return cJSON_IsNumber(item) && fabs(item->valuedouble) <= COORDINATE_MAX;
}

static bool read_vector(const cJSON *array, double out[3])
{
	const cJSON *item = cJSON_IsArray(array) ? array->child : NULL;

	for (int k = 0; k < 3; k++, item = item->next) {
		if (!item || !is_coordinate(item))
			return false;
		out[k] = item->valuedouble;
	}
	return !item;
}

static bool read_whole(const cJSON *item, int least, int most, int *out)
{
	if (!cJSON_IsNumber(item) || !(item->valuedouble >= least && item->valuedouble <= most) ||
	    item->valuedouble > floor(item->valuedouble))
		return false;
	*out = (int)item->valuedouble;
	return true;
}

/* ---- moves */

/* Reads the points along one axis: a number, the first and the last, or "all". */
static bool read_range(const cJSON *item, int cells, int *first, int *last)
{
	const char *word = cJSON_GetStringValue(item);

	*first = -1;
	*last = cells + 1;
	if (word)
		return strcmp(word, "all") == 0;
	if (!cJSON_IsArray(item)) {
		const bool good = read_whole(item, -1, cells + 1, first);

		*last = *first;
		return good;
	}
	return cJSON_GetArraySize(item) == 2 && read_whole(item->child, -1, cells + 1, first) &&
	       read_whole(item->child->next, *first, cells + 1, last);
}

static int read_points(const struct plan_reader *r, const cJSON *json,
		       const struct deform_step *step, struct deform_move *move)
{
	const cJSON *points = member(json, "points");
	const cJSON *item = cJSON_IsArray(points) ? points->child : NULL;
	bool good = true;
	char cure[200];

	for (int k = 0; k < 3; k++) {
		good = good && item &&
		       read_range(item, (int)(step->cells[k] << move->level), &move->first[k],
				  &move->last[k]);
		item = item ? item->next : NULL;
	}
	if (good && !item)
		return 0;
	snprintf(cure, sizeof(cure),
		 "must be for x, y and z a number, [first, last] or \"all\"; at level %u there are "
		 "points -1 to %u, %u and %u",
		 move->level, (step->cells[0] << move->level) + 1,
		 (step->cells[1] << move->level) + 1, (step->cells[2] << move->level) + 1);
	return refuse(r, move->line, "points", cure);
}

static int read_level(const struct plan_reader *r, const cJSON *json,
		      const struct deform_step *step, struct deform_move *move)
{
	const cJSON *item = member(json, "level");
	int level = 0;

	if (item && !read_whole(item, 0, DEFORM_LEVEL_MAX, &level))
		return refuse(r, move->line, "level", "must be a whole number, 0 to 6");
	for (int k = 0; k < 3; k++)
		if (step->cells[k] << level > LATTICE_CELLS_MAX)
			return refuse(r, move->line, "level",
				      "is too high: the lattice would have more than 64 cells "
				      "along an axis");
	move->level = (uint32_t)level;
	return 0;
}

static int read_turn(const struct plan_reader *r, const cJSON *turn, struct deform_move *move)
{
	const cJSON *degrees = member(turn, "degrees");
	double length;
	int rc;

	move->kind = DEFORM_TURN;
	if (!cJSON_IsObject(turn))
		return refuse(r, move->line, "turn", "must be {\"degrees\", \"axis\", \"about\"}");
	rc = check_keys(r, turn, " degrees axis about ");
	if (rc < 0)
		return rc;
	if (!cJSON_IsNumber(degrees) || !(fabs(degrees->valuedouble) <= 360))
		return refuse(r, move->line, "degrees", "must be a number, -360 to 360");
	move->turn_deg = degrees->valuedouble;
	if (!read_vector(member(turn, "about"), move->place))
		return refuse(r, move->line, "about", "must be a place on the axis: [x, y, z]");
	if (!read_vector(member(turn, "axis"), move->axis))
		return refuse(r, move->line, "axis", "must be a direction: [x, y, z]");
	length = sqrt(move->axis[0] * move->axis[0] + move->axis[1] * move->axis[1] +
		      move->axis[2] * move->axis[2]);
	if (!(length > 1e-9))
		return refuse(r, move->line, "axis", "has no length; give a direction");
	for (int k = 0; k < 3; k++)
		move->axis[k] /= length;
	return 0;
}

static int read_move(const struct plan_reader *r, const cJSON *json, const struct deform_step *step,
		     struct deform_move *move)
{
	const cJSON *by = member(json, "by"), *to = member(json, "to"),
		    *turn = member(json, "turn");
	int rc;

	if (!cJSON_IsObject(json))
		return refuse(r, step->line, "moves",
			      "must be a list of {\"points\", \"level\", \"by\"}");
	move->line = json_text_line(r->json, json);
	rc = check_keys(r, json, " points level by to turn ");
	if (rc == 0)
		rc = read_level(r, json, step, move);
	if (rc == 0)
		rc = read_points(r, json, step, move);
	if (rc < 0)
		return rc;
	if (!!by + !!to + !!turn != 1)
		return refuse(r, move->line, "by",
			      "must be there, or \"to\", or \"turn\": exactly one of them");
	if (turn)
		return read_turn(r, turn, move);
	move->kind = by ? DEFORM_BY : DEFORM_TO;
	return read_vector(by ? by : to, move->place) ? 0
						      : refuse(r, move->line, by ? "by" : "to",
							       "must be three numbers: [x, y, z]");
}

static int read_moves(struct plan_reader *r, const cJSON *list, struct deform_step *step)
{
	const int count = cJSON_IsArray(list) ? cJSON_GetArraySize(list) : 0;
	int rc = 0;

	if (!cJSON_IsArray(list))
		return refuse(r, step->line, "moves",
			      "must be a list of {\"points\", \"level\", \"by\"}");
	r->moves += (uint32_t)count;
	if (r->moves > DEFORM_MOVES_MAX)
		return refuse(r, step->line, "moves", "are more than 100000 in all");
	step->moves = calloc((size_t)count + 1, sizeof(*step->moves));
	if (!step->moves)
		return -ENOMEM;
	for (const cJSON *item = list->child; item && rc == 0; item = item->next)
		rc = read_move(r, item, step, &step->moves[step->move_count++]);
	return rc;
}

/* ---- surfaces */

enum { SURFACE_POINTS_MAX = 256 }; /* along an axis */

/* Reads rows of items of width numbers. Returns false if any is missing, or a number is below
 * least. */
static bool read_rows(const cJSON *rows, const uint32_t count[2], int width, double least,
		      float *out)
{
	const cJSON *row = rows->child;

	for (uint32_t j = 0; j < count[1]; j++, row = row->next) {
		const cJSON *item = cJSON_IsArray(row) ? row->child : NULL;

		if (cJSON_GetArraySize(row) != (int)count[0])
			return false;
		for (uint32_t i = 0; i < count[0]; i++, item = item->next) {
			double numbers[3] = { 0 };

			if (width == 3 ? !read_vector(item, numbers) : !is_coordinate(item))
				return false;
			if (width == 1)
				numbers[0] = item->valuedouble;
			for (int k = 0; k < width; k++, out++) {
				*out = (float)numbers[k];
				if (!(numbers[k] > least))
					return false;
			}
		}
	}
	return true;
}

static int read_order(const struct plan_reader *r, const cJSON *json,
		      const struct deform_step *step, struct deform_surface *out)
{
	const cJSON *order = member(json, "order");
	int numbers[2] = { 3, 3 };

	if (order && !(cJSON_IsArray(order) && cJSON_GetArraySize(order) == 2 &&
		       read_whole(order->child, 2, NURBS_ORDER_MAX, &numbers[0]) &&
		       read_whole(order->child->next, 2, NURBS_ORDER_MAX, &numbers[1])))
		return refuse(r, step->line, "order", "must be two whole numbers, 2 to 12");
	for (int k = 0; k < 2; k++) {
		out->order[k] = (uint32_t)numbers[k];
		if (out->count[k] < out->order[k])
			return refuse(r, step->line, "points",
				      "must be at least as many along each axis as the order");
		if (out->order[k] == 2 && out->count[k] > 2)
			return refuse(r, step->line, "order",
				      "must be 3 or more where an axis has over two points: "
				      "straight pieces meet in creases");
		out->knots[k] = malloc((out->count[k] + out->order[k]) * sizeof(*out->knots[k]));
		if (!out->knots[k])
			return -ENOMEM;
		nurbs_even_knots(out->knots[k], out->order[k], out->count[k]);
	}
	return 0;
}

static int read_surface(const struct plan_reader *r, const cJSON *json, struct deform_step *step)
{
	struct deform_surface *out = &step->surface;
	const cJSON *points = member(json, "points"), *weights = member(json, "weights");
	const char *way = cJSON_GetStringValue(member(json, "way"));
	const int rows = cJSON_IsArray(points) ? cJSON_GetArraySize(points) : 0;
	const int columns = rows > 0 ? cJSON_GetArraySize(points->child) : 0;
	int rc;

	if (!cJSON_IsObject(json))
		return refuse(r, step->line, "surface", "must be {\"points\", \"order\", \"way\"}");
	rc = check_keys(r, json, " points weights order way ");
	if (rc < 0)
		return rc;
	if (!way || (strcmp(way, "onto") != 0 && strcmp(way, "flat") != 0))
		return refuse(r, step->line, "way",
			      "must be \"flat\", which lays flat what lies along the surface, or "
			      "\"onto\", which bends it so");
	out->is_flattening = strcmp(way, "flat") == 0;
	if (rows < 2 || columns < 2 || rows > SURFACE_POINTS_MAX || columns > SURFACE_POINTS_MAX)
		return refuse(r, step->line, "points",
			      "must be 2 to 256 rows of as many [x, y, z]");
	out->count[0] = (uint32_t)columns;
	out->count[1] = (uint32_t)rows;
	out->points = malloc((size_t)rows * (size_t)columns * 3 * sizeof(*out->points));
	out->weights =
		weights ? malloc((size_t)rows * (size_t)columns * sizeof(*out->weights)) : NULL;
	if (!out->points || (weights && !out->weights))
		return -ENOMEM;
	if (!read_rows(points, out->count, 3, -2 * COORDINATE_MAX, out->points))
		return refuse(r, step->line, "points", "must be rows of as many [x, y, z]");
	if (weights && !(cJSON_IsArray(weights) && cJSON_GetArraySize(weights) == rows &&
			 read_rows(weights, out->count, 1, 1e-6, out->weights)))
		return refuse(r, step->line, "weights",
			      "must be as many rows of numbers above 0 as of points");
	return read_order(r, json, step, out);
}

/* ---- steps */

static int read_box(const struct plan_reader *r, const cJSON *box, struct deform_step *step)
{
	bool good = cJSON_IsObject(box) && read_vector(member(box, "low"), step->low) &&
		    read_vector(member(box, "high"), step->high);

	for (int k = 0; k < 3 && good; k++)
		good = step->high[k] - step->low[k] >= 1e-9;
	step->has_box = true;
	if (!good)
		return refuse(r, step->line, "box",
			      "must be {\"low\": [x, y, z], \"high\": [x, y, z]}, high above low");
	return check_keys(r, box, " low high ");
}

static int read_step(struct plan_reader *r, const cJSON *json, struct deform_step *step)
{
	double cells[3];
	int rc;

	if (!cJSON_IsObject(json))
		return refuse(r, 1, "steps", "must be a list of {\"lattice\", \"moves\"}");
	step->line = json_text_line(r->json, json);
	if (member(json, "surface")) {
		rc = check_keys(r, json, " surface ");
		return rc == 0 ? read_surface(r, member(json, "surface"), step) : rc;
	}
	rc = check_keys(r, json, " lattice box moves surface ");
	if (rc < 0)
		return rc;
	if (!read_vector(member(json, "lattice"), cells))
		return refuse(r, step->line, "lattice",
			      "must be the cells along x, y and z, such as [1, 1, 4]");
	for (int k = 0; k < 3; k++) {
		if (!(cells[k] >= 1 && cells[k] <= LATTICE_CELLS_MAX) || cells[k] > floor(cells[k]))
			return refuse(r, step->line, "lattice", "must be whole numbers, 1 to 64");
		step->cells[k] = (uint32_t)cells[k];
	}
	if (member(json, "box"))
		rc = read_box(r, member(json, "box"), step);
	return rc == 0 ? read_moves(r, member(json, "moves"), step) : rc;
}

static int read_plan(struct plan_reader *r, const cJSON *root)
{
	const cJSON *tolerance = member(root, "tolerance"), *steps = member(root, "steps");
	const int count = cJSON_IsArray(steps) ? cJSON_GetArraySize(steps) : 0;
	int rc;

	if (!cJSON_IsObject(root))
		return refuse(r, 1, "steps", "are missing: write {\"steps\": [...]}");
	rc = check_keys(r, root, " tolerance steps ");
	if (rc < 0)
		return rc;
	if (tolerance && !(is_coordinate(tolerance) && tolerance->valuedouble > 0))
		return refuse(r, 1, "tolerance", "must be a length above 0");
	r->plan->tolerance = tolerance ? tolerance->valuedouble : 0;
	if (count < 1 || count > DEFORM_STEPS_MAX)
		return refuse(r, 1, "steps",
			      "must be a list of 1 to 64 steps, {\"lattice\", \"moves\"}");
	r->plan->steps = calloc((size_t)count, sizeof(*r->plan->steps));
	if (!r->plan->steps)
		return -ENOMEM;
	for (const cJSON *item = steps->child; item && rc == 0; item = item->next)
		rc = read_step(r, item, &r->plan->steps[r->plan->step_count++]);
	return rc;
}

int deform_plan_read(struct deform_plan *out, const char *path, struct diagnostics *diagnostics)
{
	struct json_text json = { 0 };
	struct plan_reader r = { out, &json, path, diagnostics, 0 };
	struct buffer text;
	int rc;

	*out = (struct deform_plan){ 0 };
	buffer_init(&text, FILE_BYTES_MAX);
	rc = buffer_read_file(&text, path);
	if (rc < 0)
		diagnostics_add(diagnostics, rc, path, 0, "%s", open_problem(rc));
	if (rc == 0)
		rc = json_text_parse(&json, &text, path, diagnostics);
	if (rc == 0)
		rc = read_plan(&r, json.root);
	if (rc == -ENOMEM)
		diagnostics_add(diagnostics, rc, path, 0, "%s", strerror(ENOMEM));
	json_text_finish(&json);
	buffer_finish(&text);
	return rc;
}
