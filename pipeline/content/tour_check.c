/* Checks the path of each tour against the scan. The scan is large and the path is small, so the
 * tree of boxes is built over the path, and the scan's triangles pass once in any order. The path
 * is sampled in steps of a quarter of the clearance, so even a thin triangle that crosses it is
 * nearer to one of the steps than the clearance. */
#include "pipeline/content/tour_check.h"
#include "pipeline/content/info_build.h"

#include <errno.h>
#include <math.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "geometry/tour_path.h"
#include "geometry/vec.h"
#include "storage/info_tour.h"

/* Raise VERSION when the check refuses what it let pass before. */
enum { VERSION = 2, LEAF = 8, STEPS_MAX = 1 << 20, LOOK_MS = 100, KEY_TEXT_MAX = 1 << 20 };

#define STEP_SHARE    0.25f /* of the clearance */
#define THROUGH_SHARE 0.2f  /* nearer than this share of the clearance counts as through */
#define FAR_SHARE     1.2f  /* of the diagonal, from the model's centre; the same as in the kiosk */
#define GROUND_SHARE  1.5f  /* of the clearance, above the lowest point */
#define TURN_MOST_RAD 1.05f /* per second: 60 degrees */

struct step {
	float at_m[3];
	uint32_t leg;
};

struct box {
	float low[3], high[3];
};

/* For one leg: the step at which the scan is nearest, and that distance. */
struct nearest {
	float distance_m, at_m[3];
};

struct way {
	const struct tour_check_options *options;
	const struct info_built *built;
	const struct info_tour *tour;
	uint32_t number; /* number of the tour */
	float clearance_m, diagonal_m, box_min_m[3], box_max_m[3];
	struct tour_path path;
	struct step *steps; /* owned */
	uint32_t step_count;
	struct box *boxes; /* owned; the children of node n are 2n + 1 and 2n + 2 */
	uint32_t depth;
	struct nearest nearest[TOUR_STOPS_MAX];
	uint32_t faults;
};

/* leg is -1 for faults of the whole tour. */
static void report(struct way *way, int leg, const char *text, ...) printf_like(3, 4);

static void report(struct way *way, int leg, const char *text, ...)
{
	const struct info_tour_lines *lines = &way->built->tour_lines[way->number];
	const uint32_t count = way->tour->stop_count;
	const uint32_t to = leg < 0 ? 0 : ((uint32_t)leg + 1) % count;
	char message[300], where[60] = "";
	va_list args;

	va_start(args, text);
	vsnprintf(message, sizeof(message), text, args);
	va_end(args);
	if (leg >= 0)
		snprintf(where, sizeof(where), ", from stop %d to stop %u", leg + 1, to + 1);
	way->faults++;
	diagnostics_add(way->options->diagnostics, -EINVAL, "tours.json",
			leg < 0 ? lines->tour : lines->stops[to], "tour \"%.64s\"%s: %s",
			way->tour->id, where, message);
}

/* ---- steps along the path, and their tree */

static int take_steps(struct way *way)
{
	const float step_m = STEP_SHARE * way->clearance_m;
	uint64_t count = 0;

	for (uint32_t leg = 0; leg < way->path.leg_count; leg++)
		count += (uint64_t)(tour_path_leg_m(&way->path, leg) / step_m) + 2;
	if (count > STEPS_MAX) {
		report(way, -1, "its way is too long: stops are far outside of the model");
		return -EINVAL;
	}
	way->steps = malloc(count * sizeof(*way->steps));
	if (!way->steps)
		return -ENOMEM;
	for (uint32_t leg = 0; leg < way->path.leg_count; leg++) {
		const uint32_t pieces = (uint32_t)(tour_path_leg_m(&way->path, leg) / step_m) + 1;

		for (uint32_t i = 0; i <= pieces; i++) {
			struct step *step = &way->steps[way->step_count++];

			step->leg = leg;
			tour_path_place(&way->path, leg, (float)i / (float)pieces, step->at_m);
		}
	}
	return 0;
}

static void range_of(const struct way *way, uint32_t node, uint32_t level, uint32_t *from,
		     uint32_t *to)
{
	const uint32_t index = node + 1 - (1u << level);

	*from = (uint32_t)((uint64_t)way->step_count * index >> level);
	*to = (uint32_t)((uint64_t)way->step_count * (index + 1) >> level);
}

static int grow_tree(struct way *way)
{
	while (way->step_count >> way->depth > LEAF)
		way->depth++;
	way->boxes = malloc(((size_t)2 << way->depth) * sizeof(*way->boxes));
	if (!way->boxes)
		return -ENOMEM;
	for (uint32_t level = 0; level <= way->depth; level++)
		for (uint32_t node = (1u << level) - 1; node < (2u << level) - 1; node++) {
			struct box *box = &way->boxes[node];
			uint32_t from, to;

			range_of(way, node, level, &from, &to);
			for (int i = 0; i < 3; i++) {
				box->low[i] = INFINITY;
				box->high[i] = -INFINITY;
				for (uint32_t s = from; s < to; s++) {
					const float at = way->steps[s].at_m[i];

					box->low[i] = fminf(box->low[i], at - way->clearance_m);
					box->high[i] = fmaxf(box->high[i], at + way->clearance_m);
				}
			}
		}
	return 0;
}

/* ---- the triangles of the scan */

struct triangle {
	float a[3], ab[3], ac[3];
	struct box box;
};

static float edge_distance2(const float from[3], const float along[3])
{
	const float length2 = vec_dot(along, along);
	float share = length2 > 0 ? vec_dot(from, along) / length2 : 0, off[3];

	share = fminf(fmaxf(share, 0), 1);
	vec_add_scaled(off, from, -share, along);
	return vec_dot(off, off);
}

/* If the point projects into the triangle, the plane is nearest; otherwise one of the three
 * edges. */
static float triangle_distance(const struct triangle *t, const float point[3])
{
	float from_a[3], from_b[3], bc[3], normal[3], cross[3], d2;

	vec_sub(from_a, point, t->a);
	vec_cross(normal, t->ab, t->ac);
	const float area2 = vec_dot(normal, normal);

	if (area2 > 0) {
		vec_cross(cross, from_a, t->ac);
		const float u = vec_dot(cross, normal) / area2;

		vec_cross(cross, t->ab, from_a);
		const float v = vec_dot(cross, normal) / area2;

		if (u >= 0 && v >= 0 && u + v <= 1)
			return fabsf(vec_dot(from_a, normal)) / sqrtf(area2);
	}
	vec_sub(from_b, from_a, t->ab);
	vec_sub(bc, t->ac, t->ab);
	d2 = fminf(edge_distance2(from_a, t->ab), edge_distance2(from_a, t->ac));
	return sqrtf(fminf(d2, edge_distance2(from_b, bc)));
}

static bool meet(const struct box *a, const struct box *b)
{
	for (int i = 0; i < 3; i++)
		if (a->low[i] > b->high[i] || b->low[i] > a->high[i])
			return false;
	return true;
}

static void pass_by(struct way *way, const struct triangle *t, uint32_t node, uint32_t level)
{
	uint32_t from, to;

	if (!meet(&way->boxes[node], &t->box))
		return;
	if (level < way->depth) {
		pass_by(way, t, 2 * node + 1, level + 1);
		pass_by(way, t, 2 * node + 2, level + 1);
		return;
	}
	range_of(way, node, level, &from, &to);
	for (uint32_t s = from; s < to; s++) {
		struct nearest *nearest = &way->nearest[way->steps[s].leg];
		const float distance_m = triangle_distance(t, way->steps[s].at_m);

		if (distance_m < nearest->distance_m) {
			nearest->distance_m = distance_m;
			memcpy(nearest->at_m, way->steps[s].at_m, sizeof(nearest->at_m));
		}
	}
}

static void see_the_scan(struct way *way)
{
	const struct mesh *mesh = way->options->mesh;

	for (uint32_t i = 0; i < mesh->triangle_count; i++) {
		const float *a = mesh->positions[mesh->triangles[i][0]];
		const float *b = mesh->positions[mesh->triangles[i][1]];
		const float *c = mesh->positions[mesh->triangles[i][2]];
		struct triangle t;

		for (int k = 0; k < 3; k++) {
			t.a[k] = a[k];
			t.ab[k] = b[k] - a[k];
			t.ac[k] = c[k] - a[k];
			t.box.low[k] = fminf(fminf(a[k], b[k]), c[k]);
			t.box.high[k] = fmaxf(fmaxf(a[k], b[k]), c[k]);
		}
		pass_by(way, &t, 0, 0);
	}
}

/* ---- faults */

static void judge_clearance(struct way *way)
{
	for (uint32_t leg = 0; leg < way->path.leg_count; leg++) {
		const struct nearest *n = &way->nearest[leg];
		const bool is_through = n->distance_m < THROUGH_SHARE * way->clearance_m;

		if (n->distance_m >= way->clearance_m)
			continue;
		report(way, (int)leg,
		       is_through
			       ? "the way leads through the scan at %.2f %.2f %.2f: lead it "
				 "round by a stop between with \"stay\": 0 (%.2f m off it are needed)"
			       : "the way is too near to the scan at %.2f %.2f %.2f, less than "
				 "%.2f m: move a stop, or add one between with \"stay\": 0",
		       (double)n->at_m[0], (double)n->at_m[1], (double)n->at_m[2],
		       (double)way->clearance_m);
	}
}

/* Checks the limits that hold for a visitor's camera, because a visitor may take over the camera
 * anywhere on the path. */
static void judge_bounds(struct way *way)
{
	const float ground_m = way->box_min_m[2] + GROUND_SHARE * way->clearance_m;
	int reported = -1;

	for (uint32_t s = 0; s < way->step_count; s++) {
		const struct step *step = &way->steps[s];
		float middle[3];

		for (int i = 0; i < 3; i++)
			middle[i] = (way->box_min_m[i] + way->box_max_m[i]) / 2;
		if ((int)step->leg <= reported)
			continue;
		reported = (int)step->leg;
		if (step->at_m[2] < ground_m)
			report(way, (int)step->leg,
			       "the way is under the ground at %.2f %.2f %.2f: the eye stays "
			       "above %.2f m",
			       (double)step->at_m[0], (double)step->at_m[1], (double)step->at_m[2],
			       (double)ground_m);
		else if (vec_distance(step->at_m, middle) > FAR_SHARE * way->diagonal_m)
			report(way, (int)step->leg,
			       "the way is too far away at %.2f %.2f %.2f: the eye stays within "
			       "%.0f m of the model's middle",
			       (double)step->at_m[0], (double)step->at_m[1], (double)step->at_m[2],
			       (double)(FAR_SHARE * way->diagonal_m));
		else
			reported--;
	}
}

static void judge_pace(struct way *way)
{
	struct tour_pose before, pose;
	int reported = -1;

	if (way->path.duration_ms > TOUR_MINUTES_MAX * 60000)
		report(way, -1, "takes %.1f minutes, the limit is %d",
		       (double)way->path.duration_ms / 60000, TOUR_MINUTES_MAX);
	tour_path_pose(&way->path, 0, &before);
	for (int64_t ms = LOOK_MS; ms <= way->path.duration_ms; ms += LOOK_MS) {
		const uint32_t stops = way->tour->stop_count;
		float from[3], to[3], turn;
		int leg;

		tour_path_pose(&way->path, ms, &pose);
		vec_sub(from, before.target_m, before.eye_m);
		vec_sub(to, pose.target_m, pose.eye_m);
		turn = acosf(fminf(vec_dot(from, to), 1)) * 1000 / LOOK_MS;
		leg = (int)((pose.stop + stops - 1) % stops);
		before = pose;
		if (turn <= TURN_MOST_RAD || leg <= reported)
			continue;
		reported = leg;
		report(way, leg,
		       "the view turns too fast, by %.0f degrees a second: raise \"travel\"",
		       (double)turn * 180 / M_PI);
	}
}

static int judge_tour(struct way *way)
{
	struct tour_view views[TOUR_STOPS_MAX];
	int rc;

	for (uint32_t i = 0; i < way->tour->stop_count; i++) {
		const struct info_stop *stop = &way->tour->stops[i];

		views[i].stay_s = stop->stay_s;
		views[i].travel_s = stop->travel_s;
		views[i].is_even = stop->is_even;
		memcpy(views[i].eye_m, stop->eye_m, sizeof(views[i].eye_m));
		memcpy(views[i].target_m, stop->target_m, sizeof(views[i].target_m));
	}
	tour_path_init(&way->path, views, way->tour->stop_count, way->tour->attract,
		       way->diagonal_m);
	for (uint32_t i = 0; i < TOUR_STOPS_MAX; i++)
		way->nearest[i].distance_m = INFINITY;
	rc = take_steps(way);
	if (rc == 0)
		rc = grow_tree(way);
	if (rc == 0) {
		see_the_scan(way);
		judge_clearance(way);
		judge_bounds(way);
		judge_pace(way);
		rc = way->faults > 0 ? -EINVAL : 0;
	}
	free(way->steps);
	free(way->boxes);
	return rc;
}

int tour_check_key(struct hash *out, const struct info_built *built, struct hash scans)
{
	struct buffer text;
	struct info *info;
	int rc = info_open(&info, buffer_bytes(&built->database));

	if (rc < 0)
		return rc;
	buffer_init(&text, KEY_TEXT_MAX);
	buffer_put_u32(&text, VERSION);
	buffer_put(&text, scans.bytes, HASH_BYTES);
	for (uint32_t i = 0; i < info_tour_count(info); i++) {
		const struct info_tour *tour = info_tour(info, i);

		buffer_put_u8(&text, tour->attract);
		buffer_put_u32(&text, tour->stop_count);
		for (uint32_t n = 0; n < tour->stop_count; n++) {
			const struct info_stop *stop = &tour->stops[n];

			for (int k = 0; k < 3; k++) {
				buffer_put_f32(&text, stop->eye_m[k]);
				buffer_put_f32(&text, stop->target_m[k]);
			}
			buffer_put_f32(&text, stop->stay_s);
			buffer_put_f32(&text, stop->travel_s);
			buffer_put_u8(&text, stop->is_even);
		}
	}
	rc = text.error;
	*out = hash_of(buffer_bytes(&text));
	buffer_finish(&text);
	info_close(info);
	return rc;
}

int tour_check(const struct info_built *built, const struct tour_check_options *options)
{
	struct way *way;
	struct info *info;
	int rc = info_open(&info, buffer_bytes(&built->database)), worst = rc;

	way = rc == 0 ? malloc(sizeof(*way)) : NULL;
	if (rc == 0 && !way)
		worst = -ENOMEM;
	for (uint32_t i = 0; way && i < info_tour_count(info) && worst != -ENOMEM; i++) {
		*way = (struct way){
			.options = options, .built = built, .tour = info_tour(info, i), .number = i
		};
		mesh_box(options->mesh, way->box_min_m, way->box_max_m);
		way->diagonal_m = vec_distance(way->box_min_m, way->box_max_m);
		way->clearance_m = tour_path_clearance_m(way->diagonal_m);
		rc = judge_tour(way);
		worst = rc < 0 ? rc : worst;
	}
	free(way);
	info_close(info);
	return worst;
}
