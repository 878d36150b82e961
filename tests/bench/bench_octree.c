/* What meshes of the marching-cube octree cost and how far they lie from the finest surface:
 * bench_octree CELL FILE [UNIT], the side of a leaf cube in metres and an alignment of range
 * images, a range image or a mesh, and the metres of its unit (1). For each budget the time to make
 * the mesh and its distance, beside meshoptimizer's quadric simplification to as many triangles;
 * and whether 1000 random budgets are watertight. JSON to standard output; lengths in millimetres.
 */
#include <errno.h>
#include <meshoptimizer.h>

#include "base/clock.h"
#include "pipeline/import/alignment.h"
#include "pipeline/octree/budget_mesh.h"
#include "tests/bench/surface_error.h"

enum { RANDOM_BUDGETS = 1000, REPEATS = 5 };

static void load(struct mesh *mesh, struct budget_leaves *leaves, struct reconstruct_report *report,
		 double cell, const char *path, double unit)
{
	const double numbers[16] = { [0] = unit, [5] = unit, [10] = unit, [15] = 1 };
	const struct reconstruct_options options = {
		.cell = cell, .is_closed = true, .leaf = budget_leaf_add, .data = leaves
	};
	static struct reconstruct_scan scans[ALIGNMENT_SCANS_MAX];
	struct diagnostics diagnostics = { 0 };
	struct alignment alignment = { 0 };
	struct transform whole;
	int rc = 0;

	if (transform_set(&whole, numbers))
		need_ok(-EINVAL, "UNIT");
	if (alignment_is_named(path))
		rc = alignment_read(&alignment, path, &diagnostics);
	else
		scans[0] = (struct reconstruct_scan){ path, &whole };
	for (uint32_t i = 0; i < alignment.count; i++)
		scans[i] = (struct reconstruct_scan){ alignment.scans[i].path,
						      &alignment.scans[i].transform };
	if (rc == 0)
		rc = reconstruct(mesh, scans, alignment.count ? alignment.count : 1, &options,
				 report, &diagnostics);
	need_ok(rc, diagnostics_cause(&diagnostics, rc));
	alignment_finish(&alignment);
}

static struct surface surface_of(const struct mesh *mesh)
{
	return (struct surface){ .positions = mesh->positions,
				 .triangles = mesh->triangles,
				 .triangle_count = mesh->triangle_count };
}

static void print_quadric(const struct mesh *finest, uint32_t target, const struct surface *scan)
{
	uint32_t(*triangles)[3] = need(malloc(finest->triangle_count * sizeof(*triangles)));
	const int64_t began_us = clock_now_us();
	float error;
	const size_t indices = meshopt_simplify(
		(unsigned *)triangles, (const unsigned *)finest->triangles,
		3ul * finest->triangle_count, (const float *)finest->positions,
		finest->vertex_count, sizeof(finest->positions[0]), 3ul * target, 1e9f, 0, &error);
	struct surface surface = { .positions = finest->positions,
				   .triangles = triangles,
				   .triangle_count = (uint32_t)(indices / 3) };

	printf("\"quadric_ms\": %.1f, ", (double)(clock_now_us() - began_us) / 1e3);
	if (indices > 0)
		print_errors("quadric", &surface, scan);
	else
		printf("\"quadric\": null");
	free(triangles);
}

static void print_budget(struct lod_model *model, const struct reconstruct_report *report,
			 const struct mesh *finest, const struct surface *scan, uint32_t budget)
{
	struct lod_mesh made = { 0 };
	struct mesh mesh;
	struct surface surface;
	int64_t best_us = INT64_MAX;

	for (int i = 0; i < REPEATS; i++) {
		const int64_t began_us = clock_now_us();

		need_ok(lod_mesh_make(&made, model, budget), "mesh");
		if (clock_now_us() - began_us < best_us)
			best_us = clock_now_us() - began_us;
	}
	need_ok(budget_mesh_make(&mesh, model, report, false, budget), "mesh");
	surface = surface_of(&mesh);
	printf("  {\"budget\": %u, \"ms\": %.3f, \"opened\": %u, \"stars\": %u, ", budget,
	       (double)best_us / 1e3, made.opened, made.stars);
	print_errors("octree", &surface, scan);
	printf(", ");
	print_quadric(finest, mesh.triangle_count, scan);
	printf("}");
	mesh_finish(&mesh);
	lod_mesh_finish(&made);
}

struct edges {
	uint32_t *begin; /* of each vertex, where the ends of its edges begin; owned */
	uint32_t *ends;  /* owned */
};

/* Lists the edges that leave each vertex. */
static void list_edges(struct edges *edges, const struct lod_mesh *mesh)
{
	const size_t vertices = mesh->vertex_count, sides = 3ul * mesh->triangle_count;
	uint32_t *begin, *ends;

	free(edges->begin);
	free(edges->ends);
	begin = edges->begin = need(calloc(vertices + 2, sizeof(*begin)));
	ends = edges->ends = need(malloc((sides + 1) * sizeof(*ends)));
	for (size_t i = 0; i < sides; i++)
		begin[mesh->triangles[i / 3][i % 3] + 2]++;
	for (size_t v = 2; v < vertices + 2; v++)
		begin[v] += begin[v - 1];
	for (size_t i = 0; i < sides; i++)
		ends[begin[mesh->triangles[i / 3][i % 3] + 1]++] =
			mesh->triangles[i / 3][(i + 1) % 3];
}

static uint32_t times(const struct edges *edges, uint32_t from, uint32_t to)
{
	uint32_t count = 0;

	for (uint32_t i = edges->begin[from]; i < edges->begin[from + 1]; i++)
		count += edges->ends[i] == to;
	return count;
}

/* Counts directed edges that have no opposite, and the times that one is used again. */
static void judge(const struct lod_mesh *mesh, struct edges *edges, uint32_t *open,
		  uint32_t *crowded)
{
	list_edges(edges, mesh);
	for (uint32_t from = 0; from < mesh->vertex_count; from++)
		for (uint32_t i = edges->begin[from]; i < edges->begin[from + 1]; i++) {
			const uint32_t to = edges->ends[i];

			for (uint32_t k = edges->begin[from]; k < i; k++)
				if (edges->ends[k] == to) {
					++*crowded;
					break;
				}
			*open += times(edges, to, from) == 0;
		}
}

static void print_random(struct lod_model *model, uint32_t finest)
{
	struct lod_mesh mesh = { 0 };
	struct edges edges = { 0 };
	uint32_t open = 0, crowded = 0, over = 0;
	double least = 1;

	srand(1);
	for (int i = 0; i < RANDOM_BUDGETS; i++) {
		const double share = (double)rand() / RAND_MAX;
		const uint32_t budget = (uint32_t)(100 * pow(finest / 100.0, share));

		need_ok(lod_mesh_make(&mesh, model, budget), "mesh");
		judge(&mesh, &edges, &open, &crowded);
		over += mesh.triangle_count > budget;
		least = fmin(least, (double)mesh.triangle_count / budget);
	}
	printf("\"random_budgets\": %d, \"open_edges\": %u, \"crowded_edges\": %u, \"over\": %u, "
	       "\"least_used\": %.4f",
	       RANDOM_BUDGETS, open, crowded, over, least);
	free(edges.begin);
	free(edges.ends);
	lod_mesh_finish(&mesh);
}

int main(int argc, char **argv)
{
	static const uint32_t budgets[] = { 100,   300,    1000,   3000,   10000,
					    30000, 100000, 300000, 1000000 };
	struct budget_leaves leaves = { 0 };
	struct reconstruct_report report;
	struct lod_model model;
	struct surface scan;
	struct mesh finest;
	int64_t began_us;

	if (argc < 3)
		return EXIT_FAILURE;
	load(&finest, &leaves, &report, strtod(argv[1], NULL), argv[2],
	     argc > 3 ? strtod(argv[3], NULL) : 1);
	began_us = clock_now_us();
	need_ok(budget_model_create(&model, &leaves, &finest, &report), "octree");
	printf("{\"triangles\": %u, \"nodes\": %u, \"levels\": %u, \"octree_s\": %.2f,\n",
	       finest.triangle_count, model.tree.level_first[model.tree.level_count],
	       model.tree.level_count, (double)(clock_now_us() - began_us) / 1e6);
	print_random(&model, finest.triangle_count);
	printf(",\n\"budgets\": [");
	scan = surface_of(&finest);
	surface_index(&scan);
	for (size_t i = 0; i < ARRAY_COUNT(budgets) && budgets[i] < finest.triangle_count; i++) {
		printf(i > 0 ? ",\n" : "\n");
		print_budget(&model, &report, &finest, &scan, budgets[i]);
	}
	printf("]}\n");
	nearest_destroy(scan.nearest);
	lod_model_finish(&model);
	budget_leaves_finish(&leaves);
	mesh_finish(&finest);
	return EXIT_SUCCESS;
}
