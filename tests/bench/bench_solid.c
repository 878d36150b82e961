/* What questions about the space for the eye cost, and whether it holds: bench_solid GESTURES
 * FILE..., scans in metres with z up. For each scan, and for cells of several sizes on the first
 * one: the octree, the medians of its questions, and flights between random places. Then GESTURES
 * random drags, pinches, flings and flights on the first scan, with the distance of the eye to the
 * nearest triangle. JSON to standard output. */
#include <errno.h>
#include <inttypes.h>
#include <time.h>

#include "base/clock.h"
#include "geometry/foot_way.h"
#include "geometry/solid_space.h"
#include "geometry/tour_path.h"
#include "pipeline/content/start_view.h"
#include "pipeline/import/import.h"
#include "pipeline/release/solid_grid.h"
#include "tests/app/view/random_hand.h"
#include "tests/bench/surface_error.h"

enum { QUESTIONS = 20000, FLIGHTS = 300 };

static uint32_t seed = 3;

static float share(void)
{
	seed = seed * 1664525 + 1013904223;
	return (float)(seed >> 8) / (1 << 24);
}

static double now_us(void)
{
	struct timespec time;

	clock_gettime(CLOCK_MONOTONIC, &time);
	return 1e6 * (double)time.tv_sec + 1e-3 * (double)time.tv_nsec;
}

static int by_size(const void *a, const void *b)
{
	const double *left = a, *right = b;

	return (*left > *right) - (*left < *right);
}

static double quantile(double *times, int count, double at)
{
	qsort(times, (size_t)count, sizeof(*times), by_size);
	return times[(int)(at * (count - 1))];
}

struct model {
	struct mesh mesh;
	float low_m[3], high_m[3], room_m;
	struct solid solid;
};

static void load(struct model *model, const char *path)
{
	const struct import_options options = { .up = IMPORT_Z_UP, .metres_per_unit = 1 };
	struct diagnostics diagnostics = { 0 };
	int rc = import_scan(&model->mesh, path, &options, NULL, &diagnostics);

	need_ok(rc, diagnostics_cause(&diagnostics, rc));
	mesh_box(&model->mesh, model->low_m, model->high_m);
	model->room_m = tour_path_clearance_m(vec_distance(model->low_m, model->high_m));
}

static void build(struct model *model, float cell_m)
{
	struct solid_grid_options options = { .cell_m = cell_m, .room_m = model->room_m };
	struct solid_grid *grid;
	struct buffer object;
	double began_us = now_us(), made_us, decoded_us;

	memcpy(options.box_min_m, model->low_m, sizeof(options.box_min_m));
	memcpy(options.box_max_m, model->high_m, sizeof(options.box_max_m));
	need_ok(solid_grid_create(&grid, &options), "grid");
	for (uint32_t t = 0; t < model->mesh.triangle_count; t++) {
		float corners[3][3];

		for (int c = 0; c < 3; c++)
			vec_copy(corners[c], model->mesh.positions[model->mesh.triangles[t][c]]);
		solid_grid_add(grid, (const float(*)[3])corners);
	}
	need_ok(solid_grid_tree(grid, &model->solid), "octree");
	solid_grid_destroy(grid);
	made_us = now_us();
	buffer_init(&object, 1 << 24);
	need_ok(solid_encode(&object, &model->solid), "encoding");
	solid_finish(&model->solid);
	decoded_us = now_us();
	need_ok(solid_decode(&model->solid, buffer_bytes(&object)), "decoding");
	printf("{\"triangles\": %u, \"cell_m\": %g, \"levels\": %u, \"nodes\": %u, "
	       "\"bytes\": %zu, \"made_ms\": %.0f, \"decoded_ms\": %.0f",
	       model->mesh.triangle_count, (double)cell_m, model->solid.depth,
	       model->solid.node_count, object.size, (made_us - began_us) / 1e3,
	       (now_us() - decoded_us) / 1e3);
	buffer_finish(&object);
}

static void random_point(const struct model *model, bool is_free, float out[3])
{
	do
		for (int axis = 0; axis < 3; axis++)
			out[axis] = model->low_m[axis] +
				    share() * (model->high_m[axis] - model->low_m[axis]);
	while (solid_is_free(&model->solid, out) != is_free);
}

/* The clock takes a fortieth of a microsecond, which is counted. */
static void ask(const struct model *model)
{
	static double point_us[QUESTIONS], move_us[QUESTIONS], ray_us[QUESTIONS];
	static double nearest_us[QUESTIONS];
	float sum = 0;

	for (int i = 0; i < QUESTIONS; i++) {
		float at[3], stone[3], way[3], out[3];
		double us[5];

		random_point(model, true, at);
		random_point(model, false, stone);
		for (int axis = 0; axis < 3; axis++)
			way[axis] = share() - 0.5f;
		vec_normalise(way);
		us[0] = now_us();
		sum += solid_is_free(&model->solid, at);
		us[1] = now_us();
		sum += vec_least(9, solid_reach(&model->solid, at, way, 0.5f, NULL));
		us[2] = now_us();
		sum += vec_least(9, solid_reach(&model->solid, at, way, INFINITY, NULL));
		us[3] = now_us();
		sum += solid_nearest_free(&model->solid, stone, INFINITY, out);
		us[4] = now_us();
		point_us[i] = us[1] - us[0];
		move_us[i] = us[2] - us[1];
		ray_us[i] = us[3] - us[2];
		nearest_us[i] = us[4] - us[3];
	}
	printf(", \"point_us\": %.2f, \"move_us\": %.2f, \"ray_us\": %.2f, \"nearest_us\": %.2f, "
	       "\"sum\": %.0f",
	       quantile(point_us, QUESTIONS, 0.5), quantile(move_us, QUESTIONS, 0.5),
	       quantile(ray_us, QUESTIONS, 0.5), quantile(nearest_us, QUESTIONS, 0.5), (double)sum);
}

static void fly(const struct model *model)
{
	static double around_ms[FLIGHTS];
	static struct solid_way way;
	int straight = 0, around = 0, none = 0;

	for (int i = 0; i < FLIGHTS; i++) {
		float from[3], to[3];
		double began_us, ms;

		random_point(model, true, from);
		random_point(model, true, to);
		began_us = now_us();
		none += solid_way_plan(&way, &model->solid, from, to) < 0;
		ms = (now_us() - began_us) / 1e3;
		if (way.count == 2)
			straight++;
		else
			around_ms[around++] = ms;
	}
	printf(", \"flights\": {\"straight\": %d, \"around\": %d, \"none\": %d, "
	       "\"around_ms\": %.1f, \"around_ms_p95\": %.1f, \"around_ms_most\": %.1f}",
	       straight, around, none, quantile(around_ms, around, 0.5),
	       quantile(around_ms, around, 0.95), quantile(around_ms, around, 1));
}

static void walk(const struct model *model)
{
	const struct foot foot = { &model->solid, model->low_m[2], 1.6f };
	static double walk_ms[FLIGHTS];
	static struct solid_way way;
	int arrived = 0, nearer = 0, none = 0;

	for (int i = 0; i < FLIGHTS;) {
		struct foot_stance from, to;
		float at[3], to_at[3];
		double began_us;
		int rc;

		random_point(model, true, at);
		random_point(model, true, to_at);
		if (!foot_stand(&foot, at, INFINITY, &from) ||
		    !foot_stand(&foot, to_at, INFINITY, &to))
			continue;
		began_us = now_us();
		rc = foot_way_plan(&way, &foot, &from, &to);
		walk_ms[i++] = (now_us() - began_us) / 1e3;
		if (rc < 0)
			none++;
		else if (vec_distance(solid_way_end_m(&way), to.eye_m) < 0.01f)
			arrived++;
		else
			nearer++;
	}
	printf(", \"walks\": {\"arrived\": %d, \"nearer\": %d, \"none\": %d, \"ms\": %.1f, "
	       "\"ms_p95\": %.1f, \"ms_most\": %.1f}}",
	       arrived, nearer, none, quantile(walk_ms, FLIGHTS, 0.5),
	       quantile(walk_ms, FLIGHTS, 0.95), quantile(walk_ms, FLIGHTS, 1));
}

/* ---- gestures */

struct watch {
	const struct model *model;
	struct nearest *nearest;
	float least_m;
	uint32_t looks, in_stone;
};

static void look(void *data, const struct navigator *nav)
{
	struct watch *watch = data;
	struct nearest_place place;

	nearest_find(watch->nearest, nav->eye_m, NULL, watch->least_m, &place);
	watch->least_m = vec_least(watch->least_m, place.distance_m);
	watch->in_stone += !solid_is_free(&watch->model->solid, nav->eye_m);
	watch->looks++;
}

static const struct solid *solid_of(void *data)
{
	return &((struct model *)data)->solid;
}

static float reach(void *data, const float from_m[3], const float direction[3], float most_m,
		   int *axis)
{
	return solid_reach(solid_of(data), from_m, direction, most_m, axis);
}

static void play(struct model *model, int gestures)
{
	struct navigator_options options = {
		.fov_deg = 45, .reach = reach, .solid = solid_of, .data = model
	};
	struct watch watch = { .model = model, .least_m = 100 };
	struct random_hand hand = { .seed = 7, .look = look, .data = &watch };
	struct camera camera = { 0 };
	struct navigator nav;
	int stuck = 0, stuck_most = 0, below = 0;

	vec_copy(options.box_min_m, model->low_m);
	vec_copy(options.box_max_m, model->high_m);
	start_view(options.home_eye_m, options.home_target_m, model->low_m, model->high_m);
	vec_copy(hand.low_m, model->low_m);
	vec_copy(hand.high_m, model->high_m);
	need_ok(nearest_create(&watch.nearest, model->mesh.positions, model->mesh.triangles,
			       model->mesh.triangle_count),
		"tree of boxes");
	navigator_init(&nav, &options);
	for (int i = 0; i < gestures; i++) {
		float was[3];

		vec_copy(was, nav.eye_m);
		random_hand_play(&hand, &nav);
		stuck = vec_distance(was, nav.eye_m) > 0.01f ? 0 : stuck + 1;
		stuck_most = stuck > stuck_most ? stuck : stuck_most;
		below += nav.eye_m[2] < model->high_m[2] / 2 &&
			 fabsf(nav.eye_m[0]) < model->high_m[0] &&
			 fabsf(nav.eye_m[1]) < model->high_m[1];
	}
	navigator_camera(&nav, &camera);
	printf("\"gestures\": {\"count\": %d, \"looks\": %u, \"in_stone\": %u, "
	       "\"least_m\": %.3f, \"near_m\": %.3f, \"without_effect_in_a_row\": %d, "
	       "\"ended_among_walls\": %d}}\n",
	       gestures, watch.looks, watch.in_stone, (double)watch.least_m, (double)camera.near_m,
	       stuck_most, below);
	nearest_destroy(watch.nearest);
}

int main(int argc, char **argv)
{
	static struct model first;

	if (argc < 3) {
		fputs("usage: bench_solid GESTURES FILE...\n", stderr);
		return 2;
	}
	printf("{\"octrees\": [\n");
	load(&first, argv[2]);
	for (float cells = 4; cells >= 0.5f; cells /= 2) {
		solid_finish(&first.solid);
		build(&first, cells * first.room_m);
		ask(&first);
		fly(&first);
		walk(&first);
		printf(",\n");
	}
	for (int i = 3; i < argc; i++) {
		struct model model = { .room_m = 0 };

		load(&model, argv[i]);
		build(&model, model.room_m / 2);
		ask(&model);
		fly(&model);
		walk(&model);
		printf(",\n");
		solid_finish(&model.solid);
		mesh_finish(&model.mesh);
	}
	printf("{}],\n");
	play(&first, (int)strtol(argv[1], NULL, 10));
	solid_finish(&first.solid);
	mesh_finish(&first.mesh);
	return 0;
}
