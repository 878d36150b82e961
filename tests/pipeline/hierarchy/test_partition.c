#include "pipeline/hierarchy/partition.h"

#include <errno.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "pipeline/hierarchy/graph.h"
#include "tests/check.h"
#include "tests/pipeline/on_lattice.h"
#include "tests/pipeline/shapes.h"

static struct lattice_mesh lattice_mesh_of(struct mesh mesh)
{
	struct lattice_mesh out;
	struct lattice_counts counts;

	CHECK(on_lattice(&out, &counts, &mesh) == 0);
	mesh_finish(&mesh);
	return out;
}

static struct partition divide(const struct lattice_mesh *mesh,
			       const struct partition_options *options)
{
	struct partition partition;

	CHECK(partition_create(&partition, mesh->vertices, mesh->vertex_count, mesh->triangles,
			       mesh->triangle_count, options) == 0);
	return partition;
}

/* Every triangle in one leaf, no leaf empty or above the limit; returns the smallest. */
static uint32_t check_leaves(const struct partition *partition, const struct lattice_mesh *mesh,
			     uint32_t most)
{
	uint32_t *counts = calloc(partition->leaf_count, sizeof(*counts)), least = UINT32_MAX;

	for (uint32_t t = 0; t < mesh->triangle_count; t++) {
		CHECK(partition->leaf_of[t] < partition->leaf_count);
		counts[partition->leaf_of[t]]++;
	}
	for (uint32_t leaf = 0; leaf < partition->leaf_count; leaf++) {
		CHECK(counts[leaf] >= 1 && counts[leaf] <= most);
		least = counts[leaf] < least ? counts[leaf] : least;
	}
	free(counts);
	return least;
}

static void leaves_are_within_the_limit_and_few(void **state)
{
	static const struct partition_options options[] = {
		{ 64, UINT32_MAX, 500, false, 0 }, /* triangle by triangle */
		{ 64, 4000, 500, false, 0 },       /* by voxels first */
		{ 64, 1, 500, false, 0 },          /* voxels to the end */
		{ 64, 4000, 500, true, 0 },
	};
	struct lattice_mesh mesh = lattice_mesh_of(shape_temple(60));

	(void)state;
	for (size_t i = 0; i < ARRAY_COUNT(options); i++) {
		struct partition partition = divide(&mesh, &options[i]);

		check_leaves(&partition, &mesh, 500);
		CHECK(partition.leaf_count < 2 * mesh.triangle_count / 500);
		CHECK((partition.voxel_count > 0) == (options[i].chunk_triangles != UINT32_MAX));
		partition_finish(&partition);
	}
	lattice_mesh_finish(&mesh);
}

static void the_tree_covers_the_leaves_in_order(void **state)
{
	const struct partition_options options = { 64, 3000, 300, true, 0 };
	struct lattice_mesh mesh = lattice_mesh_of(shape_relief(70));
	struct partition partition = divide(&mesh, &options);

	(void)state;
	check_leaves(&partition, &mesh, 300);
	CHECK(partition.node_count == 2 * partition.leaf_count - 1);
	CHECK(partition.nodes[0].first_leaf == 0);
	CHECK(partition.nodes[0].leaf_count == partition.leaf_count);
	for (uint32_t n = 0; n < partition.node_count; n++) {
		const struct partition_node *node = &partition.nodes[n], *left, *right;

		if (node->children[0] == PARTITION_NONE) {
			CHECK(node->leaf_count == 1 && node->children[1] == PARTITION_NONE);
			continue;
		}
		CHECK(node->children[0] > n && node->children[1] > n);
		left = &partition.nodes[node->children[0]];
		right = &partition.nodes[node->children[1]];
		CHECK(left->first_leaf == node->first_leaf);
		CHECK(right->first_leaf == left->first_leaf + left->leaf_count);
		CHECK(left->leaf_count + right->leaf_count == node->leaf_count);
	}
	partition_finish(&partition);
	lattice_mesh_finish(&mesh);
}

/* A roof of two slopes, the ridge not in the middle. */
static struct mesh roof(uint32_t n, uint32_t ridge)
{
	struct mesh mesh = shape_relief(n);

	for (uint32_t v = 0; v < mesh.vertex_count; v++) {
		float x = (float)(v % (n + 1)), away = fabsf(x - (float)ridge);

		mesh.positions[v][0] = x;
		mesh.positions[v][1] = (float)(v / (n + 1));
		mesh.positions[v][2] = -2.0f * away;
		memset(mesh.colours[v], 128, 3);
	}
	return mesh;
}

static void the_cut_follows_the_ridge(void **state)
{
	const uint32_t n = 40, ridge = 20;
	struct mesh source = roof(n, ridge);
	struct lattice_mesh mesh = lattice_mesh_of(source);
	const struct partition_options options = { 64, UINT32_MAX, mesh.triangle_count * 3 / 5,
						   true, 0 };
	struct partition partition = divide(&mesh, &options);
	uint32_t wrong = 0, left_leaf = UINT32_MAX;
	float middle = 65535.0f * (float)ridge / (float)n;

	(void)state;
	CHECK(partition.leaf_count == 2);
	for (uint32_t t = 0; t < mesh.triangle_count; t++) {
		float x = 0.0f;

		for (int c = 0; c < 3; c++)
			x += mesh.vertices[mesh.triangles[t][c]].position[0] / 3.0f;
		if (left_leaf == UINT32_MAX && x < middle / 2.0f)
			left_leaf = partition.leaf_of[t];
		wrong += left_leaf != UINT32_MAX &&
			 (x < middle) != (partition.leaf_of[t] == left_leaf);
	}
	CHECK(wrong < mesh.triangle_count / 20);
	partition_finish(&partition);
	lattice_mesh_finish(&mesh);
}

static void loose_stones_stay_together_where_they_are_near(void **state)
{
	const struct partition_options options = { 64, UINT32_MAX, 240, false, 0 };
	struct lattice_mesh mesh = lattice_mesh_of(shape_stones(400));
	struct partition partition = divide(&mesh, &options);
	double spread = 0.0;

	(void)state;
	check_leaves(&partition, &mesh, 240);
	for (uint32_t leaf = 0; leaf < partition.leaf_count; leaf++) {
		double low = 65535.0, high = 0.0;

		for (uint32_t t = 0; t < mesh.triangle_count; t++) {
			double y = mesh.vertices[mesh.triangles[t][0]].position[1];

			if (partition.leaf_of[t] != leaf)
				continue;
			low = fmin(low, y);
			high = fmax(high, y);
		}
		spread += (high - low) / partition.leaf_count;
	}
	/* The stones cover 40 by 10; a leaf of 20 near ones is some 5 high, of any ones 10. */
	CHECK(spread < 65535.0 / 40.0 * 7.0);
	partition_finish(&partition);
	lattice_mesh_finish(&mesh);
}

static void refuses_limits_of_zero(void **state)
{
	const struct partition_options options = { 64, 100, 0, false, 0 };
	struct lattice_mesh mesh = lattice_mesh_of(shape_relief(8));
	struct partition partition;

	(void)state;
	CHECK(partition_create(&partition, mesh.vertices, mesh.vertex_count, mesh.triangles,
			       mesh.triangle_count, &options) == -EINVAL);
	CHECK(!partition.leaf_of && !partition.nodes);
	lattice_mesh_finish(&mesh);
}

static void a_graph_falls_apart_at_its_weakest(void **state)
{
	struct graph graph;
	uint32_t labels[40];

	(void)state;
	CHECK(graph_init(&graph, 40) == 0);
	for (uint32_t i = 0; i < 40; i++)
		for (uint32_t j = i + 1; j < 40; j++)
			if (i / 10 == j / 10)
				CHECK(graph_add(&graph, i, j, 5) == 0);
	for (uint32_t i = 9; i + 1 < 40; i += 10)
		CHECK(graph_add(&graph, i, i + 1, 1) == 0);
	CHECK(graph_divide(labels, &graph, 4, NULL) == 0);
	for (uint32_t i = 0; i < 40; i++)
		CHECK(labels[i] < 4 && labels[i] == labels[i / 10 * 10]);
	graph_finish(&graph);
}

static struct mesh two_triangles_and_rubbish(void)
{
	struct mesh mesh;

	shape_room(&mesh, 8, 8);
	shape_vertex(&mesh, 0.0f, 0.0f, 0.0f);
	shape_vertex(&mesh, 1.0f, 0.0f, 0.0f);
	shape_vertex(&mesh, 0.0f, 1.0f, 0.0f);
	shape_vertex(&mesh, 1.0f, 1.0f, 0.0f);
	shape_vertex(&mesh, 1.0f, 0.000001f, 0.0f); /* at the place of vertex 1 */
	shape_triangle(&mesh, 0, 1, 2);
	shape_triangle(&mesh, 2, 4, 3);
	shape_triangle(&mesh, 1, 2, 0); /* the first again */
	shape_triangle(&mesh, 0, 2, 1); /* and from its other side */
	shape_triangle(&mesh, 1, 4, 2); /* two corners at one place */
	return mesh;
}

static void the_lattice_merges_drops_and_counts(void **state)
{
	struct mesh mesh = two_triangles_and_rubbish();
	struct lattice_mesh out;
	struct lattice_counts counts;

	(void)state;
	CHECK(on_lattice(&out, &counts, &mesh) == 0);
	CHECK(out.vertex_count == 4 && out.triangle_count == 2);
	CHECK(counts.merged_vertices == 1 && counts.degenerate_triangles == 1);
	CHECK(counts.duplicate_triangles == 2 && counts.border_edges == 4);
	CHECK(counts.crowded_edges == 0);
	CHECK(out.vertices[3].position[0] == 65535 && out.vertices[3].position[1] == 65535);
	CHECK(fabs(out.lattice.step_m * 65535.0 - 1.0) < 1e-9);
	for (uint32_t v = 0; v < 4; v++)
		CHECK(out.vertices[v].border && out.vertices[v].normal[2] > 0.999f);
	lattice_mesh_finish(&out);
	mesh_finish(&mesh);
}

/* At 65 m a step is a millimetre; from there on it halves where it would be larger. */
static void the_lattice_of_a_large_site_keeps_a_millimetre(void **state)
{
	static const struct {
		float size_m;
		double step_max_m;
		uint8_t fine_bits;
	} sites[] = {
		{ 1e-3f, 0.001, 0 }, { 42, 0.001, 0 },   { 65, 0.001, 0 },    { 66, 0.001, 1 },
		{ 100, 0.001, 1 },   { 1000, 0.001, 4 }, { 1000, 0.016, 0 },  { 1000, 0.002, 3 },
		{ 10, 0.0001, 1 },   { 5e4f, 0.001, 8 }, { 1e9f, 1e-300, 8 },
	};
	const float low[3] = { -1, -2, -3 };

	(void)state;
	for (size_t i = 0; i < sizeof(sites) / sizeof(*sites); i++) {
		const float size = sites[i].size_m;
		const float high[3] = { -1, -2 + size, -3 + size / 3 };
		const double longest = (double)high[1] - low[1];
		struct lattice lattice, again;
		int32_t place[3];
		uint16_t coarse[3];

		CHECK(lattice_of_box(&lattice, low, high, sites[i].step_max_m) == 0);
		CHECK(lattice.fine_bits == sites[i].fine_bits);
		CHECK(fabs(lattice.step_m * lattice_last(&lattice) - longest) < 1e-9 * longest);
		again = lattice;
		lattice_fit(&again, low, high);
		CHECK(again.fine_bits == lattice.fine_bits);
		lattice_place(place, &lattice, high);
		CHECK(place[1] == lattice_last(&lattice) && place[0] == 0);
		lattice_coarse(coarse, &lattice, place);
		CHECK(coarse[1] == 65535);
	}
}

static void the_lattice_counts_crowded_edges(void **state)
{
	struct mesh mesh = two_triangles_and_rubbish();
	struct lattice_mesh out;
	struct lattice_counts counts;

	(void)state;
	mesh.triangle_count = 2;
	shape_vertex(&mesh, 0.0f, 0.0f, 1.0f);
	shape_triangle(&mesh, 1, 2, 5); /* a fin on the edge that the two share */
	CHECK(on_lattice(&out, &counts, &mesh) == 0);
	CHECK(out.triangle_count == 3 && counts.crowded_edges == 1);
	lattice_mesh_finish(&out);
	mesh_finish(&mesh);
}

static void the_lattice_refuses_what_has_no_extent(void **state)
{
	struct mesh mesh = two_triangles_and_rubbish();
	struct lattice_mesh out;
	struct lattice_counts counts;

	(void)state;
	memset(mesh.positions, 0, mesh.vertex_count * sizeof(*mesh.positions));
	CHECK(on_lattice(&out, &counts, &mesh) == -EINVAL);
	mesh_finish(&mesh);
}

/* A square of nodes, one of which weighs as much as all the others: what METIS cannot divide, it
 * complains about on standard output. */
static void a_node_heavier_than_a_part_is_no_trouble(void **state)
{
	enum { SIDE = 33, NODES = SIDE * SIDE, PARTS = 15 };
	uint32_t *labels = malloc(NODES * sizeof(*labels)), counts[PARTS] = { 0 };
	FILE *said = tmpfile();
	int standard_output;
	struct graph graph;

	(void)state;
	CHECK(graph_init(&graph, NODES) == 0);
	for (uint32_t i = 0; i < NODES; i++) {
		if (i % SIDE + 1 < SIDE)
			CHECK(graph_add(&graph, i, i + 1, 1) == 0);
		if (i + SIDE < NODES)
			CHECK(graph_add(&graph, i, i + SIDE, 1) == 0);
	}
	graph.node_weights[NODES / 2] = NODES;
	CHECK(said && fflush(stdout) == 0);
	standard_output = dup(STDOUT_FILENO);
	CHECK(dup2(fileno(said), STDOUT_FILENO) >= 0);
	CHECK(graph_divide(labels, &graph, PARTS, NULL) == 0);
	fflush(stdout);
	CHECK(dup2(standard_output, STDOUT_FILENO) >= 0);
	CHECK(fseek(said, 0, SEEK_END) == 0 && ftell(said) == 0);
	for (uint32_t i = 0; i < NODES; i++)
		counts[labels[i]]++;
	for (uint32_t part = 0; part < PARTS; part++)
		CHECK(counts[part] > 0 && counts[part] < NODES / 4);
	close(standard_output);
	fclose(said);
	graph_finish(&graph);
	free(labels);
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(leaves_are_within_the_limit_and_few),
		cmocka_unit_test(the_tree_covers_the_leaves_in_order),
		cmocka_unit_test(the_cut_follows_the_ridge),
		cmocka_unit_test(loose_stones_stay_together_where_they_are_near),
		cmocka_unit_test(refuses_limits_of_zero),
		cmocka_unit_test(a_graph_falls_apart_at_its_weakest),
		cmocka_unit_test(a_node_heavier_than_a_part_is_no_trouble),
		cmocka_unit_test(the_lattice_merges_drops_and_counts),
		cmocka_unit_test(the_lattice_of_a_large_site_keeps_a_millimetre),
		cmocka_unit_test(the_lattice_counts_crowded_edges),
		cmocka_unit_test(the_lattice_refuses_what_has_no_extent),
	};

	return cmocka_run_group_tests(tests, NULL, NULL);
}
