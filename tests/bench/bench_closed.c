/* What [hierarchy] surface = octree costs and gives.
 *
 *   bench_closed signs                  how often ways to tell inside from outside are wrong, and
 *                                       what they take, at corners near dirty boxes
 *   bench_closed NAME FILE UP M CELL_M  a scan: time, memory, parts, distances; M: metres in its
 *                                       unit, CELL_M: 0 for the default
 *
 * JSON to standard output. */
#include <math.h>
#include <string.h>

#include "base/clock.h"
#include "base/resource_usage.h"
#include "pipeline/import/import.h"
#include "pipeline/import/mesh_edges.h"
#include "pipeline/octree/closed_surface.h"
#include "pipeline/octree/mesh_parts.h"
#include "pipeline/octree/mesh_shells.h"
#include "tests/bench/surface_error.h"
#include "tests/pipeline/octree/dirty_boxes.h"

/* ---- signs */

enum { TRIED = 10000, BOXES = 40, RAYS_MOST = 13 };

static const float near_m = 0.03f; /* about a cube from the true surface, or nearer */

/* Boxes at random places; the truth is their union. */
static void make_boxes(struct mesh *mesh, struct box boxes[BOXES])
{
	*mesh = boxes_begin();
	for (int i = 0; i < BOXES; i++) {
		boxes[i] = (struct box){ .steps = 12, .missing = 0.02, .doubled = 0.05 };
		for (int k = 0; k < 3; k++) {
			boxes[i].low[k] = (float)rand() / (float)RAND_MAX;
			boxes[i].size[k] = 0.1f + 0.4f * (float)rand() / (float)RAND_MAX;
		}
		boxes[i].is_turned = i % 2;
		box_add(mesh, &boxes[i]);
	}
}

/* Returns how far a place is inside the union; below 0: outside. */
static float depth_in(const struct box boxes[BOXES], const float at[3])
{
	float deepest = -INFINITY;

	for (int i = 0; i < BOXES; i++) {
		float depth = INFINITY;

		for (int k = 0; k < 3; k++) {
			depth = fminf(depth, at[k] - boxes[i].low[k]);
			depth = fminf(depth, boxes[i].low[k] + boxes[i].size[k] - at[k]);
		}
		deepest = fmaxf(deepest, depth);
	}
	return deepest;
}

static void direction(float out[3], int i)
{
	const float up = 1 - 2 * ((float)i + 0.5f) / RAYS_MOST, turn = 2.39996f * (float)i;
	const float flat = sqrtf(1 - up * up);

	out[0] = flat * cosf(turn);
	out[1] = flat * sinf(turn);
	out[2] = up;
}

/* Is inside if most rays meet an odd number of faces. */
static bool odd_rays(const struct triangle_tree *tree, const float at[3], int rays)
{
	int odd = 0;

	for (int i = 0; i < rays; i++) {
		float towards[3];

		direction(towards, i);
		odd += triangle_tree_crossings(tree, at, towards, UINT32_MAX) % 2;
	}
	return 2 * odd > rays;
}

/* Is inside if no ray escapes, or one of the 13. */
static bool caught_rays(const struct triangle_tree *tree, const float at[3], int rays)
{
	int escaped = 0;

	for (int i = 0; i < rays; i++) {
		float towards[3];

		direction(towards, i);
		escaped += triangle_tree_crossings(tree, at, towards, 1) == 0;
	}
	return escaped <= rays / RAYS_MOST;
}

static bool winding(const struct triangle_tree *tree, const float at[3], int rays)
{
	(void)rays;
	return triangle_tree_winding(tree, at) > 0.5;
}

static void print_signs(struct triangle_tree *tree, float (*places)[3], const bool *inside)
{
	static const struct {
		const char *name;
		bool (*is_inside)(const struct triangle_tree *tree, const float at[3], int rays);
		int rays;
		float far_radii;
	} ways[] = {
		{ "winding number, exact", winding, 0, 1e9f },
		{ "winding number, 4 radii", winding, 0, 4 },
		{ "winding number, 3 radii", winding, 0, 3 },
		{ "winding number, 2 radii", winding, 0, 2 },
		{ "winding number, 1.5 radii", winding, 0, 1.5f },
		{ "3 rays, most meet odd", odd_rays, 3, 2 },
		{ "13 rays, most meet odd", odd_rays, 13, 2 },
		{ "3 rays, none escapes", caught_rays, 3, 2 },
		{ "13 rays, one escapes at most", caught_rays, 13, 2 },
	};

	for (size_t w = 0; w < ARRAY_COUNT(ways); w++) {
		const int64_t began_us = clock_now_us();
		int wrong = 0;

		tree->far_radii = ways[w].far_radii;
		for (int i = 0; i < TRIED; i++)
			wrong += ways[w].is_inside(tree, places[i], ways[w].rays) != inside[i];
		printf("%s  {\"way\": \"%s\", \"wrong_share\": %.5f, \"us\": %.2f}",
		       w > 0 ? ",\n" : "", ways[w].name, (double)wrong / TRIED,
		       (double)(clock_now_us() - began_us) / TRIED);
	}
}

static void signs(void)
{
	static float places[TRIED][3];
	static bool inside[TRIED];
	static struct box boxes[BOXES];
	struct triangle_tree tree;
	struct mesh_shells shells;
	struct mesh mesh;
	uint32_t count;
	uint8_t *turned;

	make_boxes(&mesh, boxes);
	need_ok(mesh_drop_copies(&mesh, &count), "copies");
	need_ok(triangle_tree_init(&tree, &mesh), "tree");
	need_ok(mesh_shells_find(&shells, &mesh), "shells");
	turned = need(calloc(mesh.triangle_count, 1));
	need_ok(mesh_shells_judge(turned, &count, &shells, &mesh, &tree, 1e-4f), "judging");
	need_ok(triangle_tree_turn(&tree, turned), "turning");
	for (int i = 0; i < TRIED;) {
		float depth;

		for (int k = 0; k < 3; k++)
			places[i][k] = 1.6f * (float)rand() / (float)RAND_MAX - 0.05f;
		depth = depth_in(boxes, places[i]);
		inside[i] = depth > 0;
		i += fabsf(depth) < near_m && fabsf(depth) > 0.001f;
	}
	printf("{\"triangles\": %u, \"shells\": %u, \"turned\": %u, \"places\": %d, \"ways\": [\n",
	       mesh.triangle_count, shells.count, count, TRIED);
	print_signs(&tree, places, (const bool *)inside);
	puts("]}");
	free(turned);
	mesh_shells_finish(&shells);
	triangle_tree_finish(&tree);
	mesh_finish(&mesh);
}

/* ---- a scan */

static void count_border(void *data, const struct mesh_edge *edge)
{
	uint32_t *counts = data;

	counts[0] += edge->face_count == 1;
	counts[1] += edge->face_count > 2;
}

static void edges_of(const struct mesh *mesh, uint32_t counts[2])
{
	struct mesh_edges edges;

	counts[0] = counts[1] = 0;
	need_ok(mesh_edges_init(&edges, mesh, 1), "edges");
	need_ok(mesh_edges_each(&edges, count_border, counts), "edges");
	mesh_edges_finish(&edges);
}

static struct surface copy_of(const struct mesh *mesh)
{
	struct surface copy = { .positions = need(malloc(mesh->vertex_count * 12ul)),
				.triangles = need(malloc(mesh->triangle_count * 12ul)),
				.triangle_count = mesh->triangle_count };

	memcpy(copy.positions, mesh->positions, mesh->vertex_count * 12ul);
	memcpy(copy.triangles, mesh->triangles, mesh->triangle_count * 12ul);
	return copy;
}

static void scan(char **argv)
{
	struct import_options options = { .metres_per_unit = strtod(argv[4], NULL) };
	struct closed_surface_report report;
	struct diagnostics diagnostics = { 0 };
	struct resource_usage before, after;
	struct surface from, to;
	uint32_t open[2], closed[2];
	struct mesh mesh;
	int64_t began_us;
	int rc;

	if (!import_axis_named(argv[3], &options.up))
		exit(EXIT_FAILURE);
	rc = import_scan(&mesh, argv[2], &options, NULL, &diagnostics);
	need_ok(rc, diagnostics_cause(&diagnostics, rc));
	edges_of(&mesh, open);
	from = copy_of(&mesh);
	resource_usage_reset_own();
	resource_usage_now(&before);
	began_us = clock_now_us();
	rc = closed_surface_make(&mesh, strtod(argv[5], NULL), &report, &diagnostics);
	need_ok(rc, diagnostics_cause(&diagnostics, rc));
	began_us = clock_now_us() - began_us;
	resource_usage_now(&after);
	edges_of(&mesh, closed);
	printf("{\"scan\": \"%s\", \"triangles\": %u, \"shells\": %u, \"turned_shells\": %u, "
	       "\"border_edges\": %u, \"crowded_edges\": %u, \"cell_mm\": %.3f, "
	       "\"seconds\": %.1f, \"processor_s\": %.1f, \"resident_mb\": %.0f, "
	       "\"parts\": %u, \"dropped_parts\": %u, \"inner_share\": %.3f, "
	       "\"sheet_share\": %.3f, \"closed_border_edges\": %u, "
	       "\"closed_crowded_edges\": %u, ",
	       argv[1], report.triangles, report.shells, report.turned_shells, open[0], open[1],
	       1000 * report.cell_m, (double)began_us / 1e6,
	       (double)(after.processor_us - before.processor_us) / 1e6,
	       (double)after.own_bytes / 1e6, report.parts, report.dropped_parts,
	       report.inner_share, report.sheet_share, closed[0], closed[1]);
	to = copy_of(&mesh);
	mesh_finish(&mesh);
	surface_index(&from);
	print_errors("distance", &to, &from);
	puts("}");
	nearest_destroy(from.nearest);
	free(from.positions);
	free(from.triangles);
	free(to.positions);
	free(to.triangles);
}

int main(int argc, char **argv)
{
	if (argc == 2 && strcmp(argv[1], "signs") == 0) {
		signs();
	} else if (argc == 6) {
		scan(argv);
	} else {
		fputs("bench_closed signs | NAME FILE UP METRES_PER_UNIT CELL_M\n", stderr);
		return 2;
	}
	return EXIT_SUCCESS;
}
