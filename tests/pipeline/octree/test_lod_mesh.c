#include "pipeline/octree/lod_mesh.h"

#include <errno.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/map.h"
#include "pipeline/octree/lod_polygon.h"
#include "tests/check.h"

/* ---- models: marching cubes over a function, on a grid */

typedef double (*shape)(double x, double y, double z); /* below 0: inside; from -1 to 1 */

struct grid {
	int side;
	double *values;
	struct lod_leaf *leaves;
	uint32_t leaf_count, vertex_count;
	struct lod_vertex *vertices;
	struct map on_edges;
};

static double value_at(const struct grid *grid, const int at[3])
{
	return grid->values[(at[2] * (grid->side + 1) + at[1]) * (grid->side + 1) + at[0]];
}

static uint32_t vertex_on(struct grid *grid, const int low[3], int axis)
{
	const map_key key = (map_key)(((low[2] * 4096ll + low[1]) * 4096ll + low[0]) * 4 + axis);
	uint64_t found = grid->on_edges.capacity ? map_get(&grid->on_edges, key) : MAP_NONE;

	if (found == MAP_NONE) {
		int high[3] = { low[0], low[1], low[2] };
		struct lod_vertex *vertex = &grid->vertices[grid->vertex_count];
		double a = value_at(grid, low), b;

		high[axis]++;
		b = value_at(grid, high);
		for (int k = 0; k < 3; k++)
			vertex->place[k] = low[k] * LOD_CUBE_STEPS;
		vertex->place[axis] += (int)fmin(255, fmax(1, 256 * a / (a - b)));
		memset(vertex->colour, 200, 4);
		found = grid->vertex_count++;
		CHECK(map_set(&grid->on_edges, key, found) == 0);
	}
	return (uint32_t)found;
}

static void add_leaf(struct grid *grid, const int cube[3])
{
	struct lod_leaf leaf = { 0 };

	for (int c = 0; c < 8; c++) {
		const int at[3] = { cube[0] + (c & 1), cube[1] + (c >> 1 & 1), cube[2] + (c >> 2) };

		leaf.inside |= (uint8_t)((value_at(grid, at) < 0) << c);
	}
	if (leaf.inside == 0 || leaf.inside == 255)
		return;
	for (int e = 0; e < CUBE_EDGES; e++) {
		const int c = cube_edge_corner(e);
		const int low[3] = { cube[0] + (c & 1), cube[1] + (c >> 1 & 1),
				     cube[2] + (c >> 2) };

		leaf.vertices[e] = LOD_NONE;
		if ((leaf.inside >> c & 1) != (leaf.inside >> (c | 1 << e / 4) & 1))
			leaf.vertices[e] = vertex_on(grid, low, e / 4);
	}
	for (int k = 0; k < 3; k++)
		leaf.cube[k] = (uint32_t)cube[k];
	grid->leaves[grid->leaf_count++] = leaf;
}

/* The corners at the border are outside. */
static struct lod_model make_model(shape of, int side)
{
	struct grid grid = { .side = side };
	const size_t corners = (size_t)(side + 1) * (size_t)(side + 1) * (size_t)(side + 1);
	struct lod_model model;
	int at[3];

	grid.values = malloc(corners * sizeof(*grid.values));
	grid.leaves = malloc(corners * sizeof(*grid.leaves));
	grid.vertices = malloc(3 * corners * sizeof(*grid.vertices));
	CHECK(grid.values && grid.leaves && grid.vertices);
	for (size_t i = 0; i < corners; i++) {
		const int n = side + 1, x = (int)i % n, y = (int)i / n % n, z = (int)i / n / n;
		const bool border =
			x == 0 || y == 0 || z == 0 || x == side || y == side || z == side;

		grid.values[i] =
			border ? 1 : of(2.0 * x / side - 1, 2.0 * y / side - 1, 2.0 * z / side - 1);
	}
	for (at[2] = 0; at[2] < side; at[2]++)
		for (at[1] = 0; at[1] < side; at[1]++)
			for (at[0] = 0; at[0] < side; at[0]++)
				add_leaf(&grid, at);
	CHECK(lod_model_create(&model, grid.leaves, grid.leaf_count, grid.vertices,
			       grid.vertex_count) == 0);
	free(grid.values);
	free(grid.leaves);
	map_finish(&grid.on_edges);
	return model;
}

static double ball(double x, double y, double z)
{
	return sqrt(x * x + y * y + z * z) - 0.7 - 0.1 * sin(9 * x) * cos(7 * y + 3 * z);
}

static double round_ball(double x, double y, double z)
{
	return sqrt(x * x + y * y + z * z) - 0.7;
}

/* Its sharp edges lie on no edges of cubes. */
static double turned_box(double x, double y, double z)
{
	const double u = 0.8 * x + 0.6 * y, v = 0.8 * y - 0.6 * x;
	const double p = 0.8 * u + 0.6 * z, q = 0.8 * z - 0.6 * u;

	return fmax(fabs(p), fmax(fabs(v), fabs(q))) - 0.5;
}

/* Cubes are in or out at random: every case of marching cubes, next to every other, with cavities,
 * pebbles and handles. */
static double noise(double x, double y, double z)
{
	(void)x;
	(void)y;
	(void)z;
	return (double)rand() / RAND_MAX - 0.5;
}

/* A ball full of holes, with flat walls on the planes of coarse nodes. */
static double sponge(double x, double y, double z)
{
	const double tube = fmin(hypot(sin(11 * x), sin(11 * y)), hypot(sin(11 * y), sin(11 * z)));

	return fmax(fmax(fabs(x), fmax(fabs(y), fabs(z))) - 0.75, 0.35 - tube);
}

/* ---- what every mesh must be */

struct edges {
	uint32_t open, crowded;
};

/* Counts edges that are not used once in each direction. */
static struct edges judge(const struct lod_mesh *mesh)
{
	struct edges edges = { 0, 0 };
	struct map counts = { 0 };
	size_t at = 0;
	map_key key;

	for (uint32_t t = 0; t < mesh->triangle_count; t++)
		for (int k = 0; k < 3; k++) {
			const uint32_t a = mesh->triangles[t][k],
				       b = mesh->triangles[t][(k + 1) % 3];
			const map_key edge = (map_key)a << 32 | b;
			const uint64_t old = counts.capacity ? map_get(&counts, edge) : MAP_NONE;

			CHECK(a != b && a < mesh->vertex_count && b < mesh->vertex_count);
			CHECK(map_set(&counts, edge, old == MAP_NONE ? 1 : old + 1) == 0);
		}
	while (map_next_key(&counts, &at, &key)) {
		const uint64_t there = map_get(&counts, key);
		const uint64_t back = map_get(&counts, (key & 0xffffffff) << 32 | key >> 32);

		edges.open += there != back;
		edges.crowded += there > 1;
	}
	map_finish(&counts);
	return edges;
}

static void check_budgets(const char *name, shape of, int side, int rounds)
{
	struct lod_model model = make_model(of, side);
	struct lod_mesh mesh = { 0 };
	const uint32_t finest = model.order.triangles[model.order.count];
	uint32_t crowded = 0, worst_percent = 100;

	srand(7);
	for (int i = 0; i < rounds; i++) {
		const double share = (double)rand() / RAND_MAX;
		const uint32_t budget =
			i == 0 ? finest : (uint32_t)(100 * pow(finest / 100.0, share));
		struct edges edges;

		CHECK(lod_mesh_make(&mesh, &model, budget) == 0);
		edges = judge(&mesh);
		if (edges.open > 0 || mesh.triangle_count > budget)
			fail_msg("%s: budget %u: %u triangles, %u open edges", name, budget,
				 mesh.triangle_count, edges.open);
		crowded += edges.crowded;
		if (100ull * mesh.triangle_count / budget < worst_percent)
			worst_percent = (uint32_t)(100ull * mesh.triangle_count / budget);
	}
	print_message("%s: finest %u triangles, %u nodes; %d budgets, least %u %% used, "
		      "%u crowded edges\n",
		      name, finest, model.tree.level_first[model.tree.level_count], rounds,
		      worst_percent, crowded);
	CHECK(worst_percent >= 98 && crowded == 0);
	lod_mesh_finish(&mesh);
	lod_model_finish(&model);
}

static void every_budget_is_watertight_and_nearly_used(void **state)
{
	(void)state;
	check_budgets("ball", ball, 64, 50);
	check_budgets("sponge", sponge, 64, 20);
}

static void random_signs_are_watertight(void **state)
{
	(void)state;
	srand(3);
	check_budgets("noise", noise, 16, 60);
}

/* Corners inside of a grid of 4 x 4 x 4 cubes, "xyz xyz ...". */
static const char *inside_corners;

static double listed(double x, double y, double z)
{
	char corner[4];

	for (int k = 0; k < 3; k++)
		corner[k] = (char)('2' + (int)lrint(2 * (k == 0 ? x : k == 1 ? y : z)));
	corner[3] = '\0';
	return strstr(inside_corners, corner) ? -1 : 1;
}

/* Two nodes that are not opened share a face whose edges are all split, with four or more crossings
 * on it. Both polygons need a diagonal in that face; once both took the same. */
static void two_nodes_never_have_the_same_diagonal(void **state)
{
	static const char *const sets[] = {
		"111 211 221 321 331 212 322 113 213 223 323 333",
		"211 221 321 231 112 212 312 122 132 232 332 113 133",
		"211 121 221 321 231 112 212 122 322 132 232 213 223 133",
	};
	(void)state;

	for (size_t i = 0; i < sizeof(sets) / sizeof(sets[0]); i++) {
		struct lod_mesh mesh = { 0 };
		struct lod_model model;

		inside_corners = sets[i];
		model = make_model(listed, 4);
		for (uint32_t budget = 1; budget <= 120; budget++) {
			struct edges edges;

			CHECK(lod_mesh_make(&mesh, &model, budget) == 0);
			edges = judge(&mesh);
			CHECK(mesh.triangle_count <= budget);
			CHECK(mesh.triangle_count ==
			      model.order.triangles[mesh.opened] + 2 * mesh.stars);
			CHECK(edges.open == 0 && edges.crowded == 0);
		}
		lod_mesh_finish(&mesh);
		lod_model_finish(&model);
	}
}

static double volume_of(const struct lod_mesh *mesh)
{
	double sum = 0;

	for (uint32_t t = 0; t < mesh->triangle_count; t++) {
		double p[3][3];

		for (int i = 0; i < 3; i++)
			for (int k = 0; k < 3; k++)
				p[i][k] = mesh->vertices[mesh->triangles[t][i]].place[k];
		for (int k = 0; k < 3; k++)
			sum += p[0][k] * (p[1][(k + 1) % 3] * p[2][(k + 2) % 3] -
					  p[1][(k + 2) % 3] * p[2][(k + 1) % 3]);
	}
	return sum / 6;
}

/* Corners on the surface alone would cut off what bulges, and sharp edges. */
static void coarse_meshes_keep_the_volume(void **state)
{
	static const struct {
		const char *name;
		shape of;
		uint32_t budget;
		double most_percent; /* with corners on the surface alone it would be six times that
				      */
	} cases[] = {
		{ "ball", round_ball, 200, 2 },
		{ "ball", round_ball, 1000, 0.3 },
		{ "box", turned_box, 200, 2 },
		{ "box", turned_box, 1000, 0.4 },
	};
	(void)state;

	for (size_t i = 0; i < sizeof(cases) / sizeof(cases[0]); i++) {
		struct lod_model model = make_model(cases[i].of, 64);
		struct lod_mesh mesh = { 0 };
		double finest, coarse;

		CHECK(lod_mesh_make(&mesh, &model, UINT32_MAX) == 0);
		finest = volume_of(&mesh);
		CHECK(lod_mesh_make(&mesh, &model, cases[i].budget) == 0);
		coarse = volume_of(&mesh);
		print_message("%s, %u triangles: %.2f %% of the volume is missing\n", cases[i].name,
			      mesh.triangle_count, 100 * (1 - coarse / finest));
		CHECK(100 * fabs(1 - coarse / finest) < cases[i].most_percent);
		lod_mesh_finish(&mesh);
		lod_model_finish(&model);
	}
}

/* The table says exactly how many triangles there are after each step. */
static void the_accumulation_table_is_exact(void **state)
{
	struct lod_model model = make_model(ball, 16);
	(void)state;

	for (uint32_t opened = 1; opened <= model.order.count; opened++) {
		uint32_t triangles = 0;

		for (uint32_t n = 1; n < model.tree.level_first[model.tree.level_count]; n++) {
			struct lod_polygons polygons;

			if (model.tree.nodes[n].number < opened ||
			    model.tree.nodes[model.tree.parents[n]].number >= opened)
				continue;
			lod_polygons_find(&polygons, &model.tree, &model.tree.nodes[n], opened);
			triangles += lod_polygons_triangles(&polygons);
		}
		CHECK(triangles == model.order.triangles[opened]);
	}
	lod_model_finish(&model);
}

/* Nodes that touch differ by at most one level, whatever is opened. */
static void neighbours_differ_by_one_level(void **state)
{
	struct lod_model model = make_model(ball, 32);
	const struct lod_tree *tree = &model.tree;
	(void)state;

	for (uint32_t level = 1; level < tree->level_count; level++)
		for (uint32_t n = tree->level_first[level]; n < tree->level_first[level + 1]; n++)
			for (int i = 0; i < 27; i++) {
				const int shift[3] = { i % 3 - 1, i / 3 % 3 - 1, i / 9 - 1 };
				const uint32_t other = lod_neighbour(tree, level, n, shift);

				if (other == LOD_NONE || !tree->nodes[n].child_mask)
					continue;
				/* n was opened after its neighbours were there */
				CHECK(tree->nodes[n].number >
				      tree->nodes[tree->parents[other]].number);
			}
	lod_model_finish(&model);
}

/* Parents take the signs of their children's corners, and their crossings. */
static void parents_follow_the_sign_rules(void **state)
{
	struct lod_model model = make_model(ball, 32);
	const struct lod_tree *tree = &model.tree;
	(void)state;

	for (uint32_t n = 0; n < tree->level_first[tree->level_count - 1]; n++) {
		const struct lod_node *node = &tree->nodes[n];

		for (int c = 0; c < 8; c++) {
			const struct lod_node *child = lod_child(tree, node, c);

			if (child)
				CHECK((child->inside >> c & 1) == (node->inside >> c & 1));
		}
		for (int e = 0; e < CUBE_EDGES; e++) {
			const int low = cube_edge_corner(e), high = low | 1 << e / 4;

			CHECK((node->vertices[e] != LOD_NONE) ==
			      ((node->inside >> low & 1) != (node->inside >> high & 1)));
		}
	}
	lod_model_finish(&model);
}

static void refuses_leaves_that_do_not_belong_together(void **state)
{
	struct lod_leaf leaves[2] = { { .cube = { 1, 2, 3 }, .inside = 1 },
				      { .cube = { 1, 2, 3 }, .inside = 1 } };
	struct lod_tree tree;
	(void)state;

	CHECK(lod_tree_build(&tree, leaves, 0) == -EINVAL);
	CHECK(lod_tree_build(&tree, leaves, 2) == -EINVAL);
	leaves[1].cube[0] = 1u << LOD_LEVELS_MAX;
	CHECK(lod_tree_build(&tree, leaves, 2) == -EFBIG && !tree.nodes);
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(every_budget_is_watertight_and_nearly_used),
		cmocka_unit_test(random_signs_are_watertight),
		cmocka_unit_test(two_nodes_never_have_the_same_diagonal),
		cmocka_unit_test(coarse_meshes_keep_the_volume),
		cmocka_unit_test(the_accumulation_table_is_exact),
		cmocka_unit_test(neighbours_differ_by_one_level),
		cmocka_unit_test(parents_follow_the_sign_rules),
		cmocka_unit_test(refuses_leaves_that_do_not_belong_together),
	};

	return cmocka_run_group_tests(tests, NULL, NULL);
}
