/* Makes meshes from the octree by looking up what was computed before. */
#include "pipeline/octree/lod_mesh.h"

#include <errno.h>
#include <stdlib.h>
#include <string.h>

#include "base/array.h"
#include "pipeline/octree/lod_place.h"
#include "pipeline/octree/lod_polygon.h"

struct making {
	struct lod_mesh *mesh;
	struct lod_model *model;
	uint32_t spare; /* triangles that may be added to those of the cut */
};

/* ---- vertices and triangles */

static int add_vertex(struct lod_mesh *mesh, const struct lod_vertex *vertex, uint32_t *out)
{
	int rc = ARRAY_RESERVE(mesh->vertices, mesh->vertex_room, mesh->vertex_count + 1ull,
			       LOD_NONE - 1);

	if (rc < 0)
		return rc;
	mesh->vertices[mesh->vertex_count] = *vertex;
	*out = mesh->vertex_count++;
	return 0;
}

static int number_of(struct making *making, uint32_t vertex, uint32_t *out)
{
	struct lod_model *model = making->model;
	int rc = 0;

	if (model->drawn[vertex] != model->round) {
		rc = add_vertex(making->mesh, &model->vertices[vertex], &model->numbers[vertex]);
		if (rc == 0)
			model->drawn[vertex] = model->round;
	}
	*out = model->numbers[vertex];
	return rc;
}

static int add_triangle(struct lod_mesh *mesh, uint32_t a, uint32_t b, uint32_t c)
{
	int rc = ARRAY_RESERVE(mesh->triangles, mesh->triangle_room, mesh->triangle_count + 1ull,
			       LOD_NONE - 1);

	if (rc == 0) {
		uint32_t *triangle = mesh->triangles[mesh->triangle_count++];

		triangle[0] = a;
		triangle[1] = b;
		triangle[2] = c;
	}
	return rc;
}

/* ---- polygons */

/* Cuts a polygon from the point in its middle. */
static int add_star(struct making *making, const uint32_t *corners, uint32_t n)
{
	struct lod_vertex middle = { { 0 }, { 0 } };
	int64_t place[3] = { 0 };
	uint32_t colour[4] = { 0 }, centre = 0;
	int rc;

	for (uint32_t i = 0; i < n; i++) {
		const struct lod_vertex *vertex = &making->mesh->vertices[corners[i]];

		for (int k = 0; k < 3; k++)
			place[k] += vertex->place[k];
		for (int k = 0; k < 4; k++)
			colour[k] += vertex->colour[k];
	}
	for (int k = 0; k < 3; k++)
		middle.place[k] = (int32_t)(place[k] / n);
	for (int k = 0; k < 4; k++)
		middle.colour[k] = (uint8_t)(colour[k] / n);
	rc = add_vertex(making->mesh, &middle, &centre);
	for (uint32_t i = 0; i < n && rc == 0; i++)
		rc = add_triangle(making->mesh, corners[i], corners[(i + 1) % n], centre);
	return rc;
}

static int add_polygon(struct making *making, const struct lod_polygons *polygons, uint32_t i)
{
	const uint32_t begin = i > 0 ? polygons->ends[i - 1] : 0, n = polygons->ends[i] - begin;
	uint8_t triangles[LOD_SEGMENTS_MAX][3];
	uint32_t numbers[LOD_SEGMENTS_MAX], count;
	int rc = 0;

	for (uint32_t k = 0; k < n && rc == 0; k++)
		rc = number_of(making, polygons->corners[begin + k], &numbers[k]);
	if (rc < 0)
		return rc;
	count = lod_polygon_cut(triangles, polygons, i);
	if (count == 0)
		return add_star(making, numbers, n);
	if (making->spare >= 2) { /* it has two triangles more as a star */
		making->spare -= 2;
		making->mesh->stars++;
		return add_star(making, numbers, n);
	}
	for (uint32_t t = 0; t < count && rc == 0; t++)
		rc = add_triangle(making->mesh, numbers[triangles[t][0] - begin],
				  numbers[triangles[t][1] - begin],
				  numbers[triangles[t][2] - begin]);
	return rc;
}

static int add_node(struct making *making, const struct lod_node *node)
{
	struct lod_polygons polygons;
	int rc = 0;

	lod_polygons_find(&polygons, &making->model->tree, node, making->mesh->opened);
	for (uint32_t i = 0; i < polygons.count && rc == 0; i++)
		rc = add_polygon(making, &polygons, i);
	return rc;
}

/* ---- the whole */

int lod_mesh_make(struct lod_mesh *out, struct lod_model *model, uint32_t budget)
{
	const struct lod_order *order = &model->order;
	const struct lod_tree *tree = &model->tree;
	struct making making = { out, model, 0 };
	int rc = 0;

	out->vertex_count = out->triangle_count = out->stars = 0;
	out->opened = lod_order_find(order, budget);
	if (order->triangles[out->opened] <= budget && out->opened < order->count)
		making.spare = budget - order->triangles[out->opened];
	model->round++;
	if (out->opened == 0)
		return order->triangles[0] <= budget ? add_node(&making, &tree->nodes[0]) : 0;
	for (uint32_t i = out->opened; i-- > 0 && rc == 0;) {
		const struct lod_node *node = &tree->nodes[order->nodes[i]];
		const int children = __builtin_popcount(node->child_mask);

		for (int c = 0; c < children && rc == 0; c++) {
			const struct lod_node *child =
				&tree->nodes[node->first_child + (uint32_t)c];

			if (child->number >= out->opened)
				rc = add_node(&making, child);
		}
	}
	return rc;
}

void lod_mesh_finish(struct lod_mesh *mesh)
{
	if (!mesh)
		return;
	free(mesh->vertices);
	free(mesh->triangles);
	*mesh = (struct lod_mesh){ 0 };
}

int lod_model_create(struct lod_model *out, struct lod_leaf *leaves, uint32_t leaf_count,
		     struct lod_vertex *vertices, uint32_t vertex_count)
{
	float *gains = NULL;
	int rc;

	*out = (struct lod_model){ .vertices = vertices, .vertex_count = vertex_count };
	rc = lod_tree_build(&out->tree, leaves, leaf_count);
	if (rc == 0)
		rc = lod_place(&gains, &out->tree, &out->vertices, &out->vertex_count);
	if (rc == 0)
		rc = lod_order_make(&out->order, &out->tree, gains);
	free(gains);
	if (rc == 0) {
		out->numbers = malloc((out->vertex_count + (size_t)1) * sizeof(*out->numbers));
		out->drawn = calloc(out->vertex_count + (size_t)1, sizeof(*out->drawn));
		rc = out->numbers && out->drawn ? 0 : -ENOMEM;
	}
	if (rc < 0)
		lod_model_finish(out);
	return rc;
}

void lod_model_finish(struct lod_model *model)
{
	if (!model)
		return;
	lod_tree_finish(&model->tree);
	lod_order_finish(&model->order);
	free(model->vertices);
	free(model->numbers);
	free(model->drawn);
	*model = (struct lod_model){ 0 };
}
