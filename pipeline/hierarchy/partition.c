/* Partitions a surface into patches: builds the dual graphs of triangles and voxels and divides
 * them. */
#include "pipeline/hierarchy/partition.h"

#include <errno.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/array.h"
#include "base/map.h"
#include "pipeline/hierarchy/graph.h"

enum { NORMAL_WEIGHT = 8, JOIN_WEIGHT = 1, LEVELS_MAX = 10 };

/* The properties of a triangle or voxel that determine the weight of an edge. */
struct look {
	float normal[3]; /* area-weighted sum; a unit vector after look_settle */
	float colour[3]; /* sum; the mean after look_settle */
	float centre[3]; /* likewise, coarse steps */
	uint32_t triangle_count;
};

struct splitter {
	const struct lattice_vertex *vertices;
	uint32_t (*triangles)[3];
	uint32_t triangle_count;
	struct partition_options options;
	struct partition *out;
	uint32_t node_room;
	uint32_t *local_of; /* for each vertex, its index in the current set of triangles */
	/* The voxels: triangles of voxel v are items[first[v]] to items[first[v + 1] - 1]. */
	uint32_t *voxel_of, *first, *items, voxel_count;
	struct look *looks;
	struct graph graph; /* graph of all voxels */
	uint32_t *node_of;  /* for each voxel, its index in the current set */
};

static void look_add(struct look *look, const struct splitter *splitter, uint32_t t)
{
	const struct lattice_vertex *corner[3];
	const float coarse = 1.0f / (float)(1 << splitter->options.fine_bits);
	float u[3], v[3];

	for (int c = 0; c < 3; c++)
		corner[c] = &splitter->vertices[splitter->triangles[t][c]];
	for (int i = 0; i < 3; i++) {
		u[i] = (float)(corner[1]->position[i] - corner[0]->position[i]);
		v[i] = (float)(corner[2]->position[i] - corner[0]->position[i]);
		for (int c = 0; c < 3; c++) {
			look->centre[i] += coarse * (float)corner[c]->position[i] / 3.0f;
			look->colour[i] += (float)corner[c]->colour[i] / 3.0f;
		}
	}
	for (int i = 0; i < 3; i++)
		look->normal[i] +=
			u[(i + 1) % 3] * v[(i + 2) % 3] - u[(i + 2) % 3] * v[(i + 1) % 3];
	look->triangle_count++;
}

static void look_settle(struct look *look)
{
	float length = sqrtf(look->normal[0] * look->normal[0] + look->normal[1] * look->normal[1] +
			     look->normal[2] * look->normal[2]);

	for (int i = 0; i < 3; i++) {
		look->normal[i] = length > 0.0f ? look->normal[i] / length : 0.0f;
		look->colour[i] /= (float)look->triangle_count;
		look->centre[i] /= (float)look->triangle_count;
	}
}

static int32_t edge_weight(const struct look *a, const struct look *b)
{
	float dot = 0.0f, difference = 0.0f, likeness;

	for (int i = 0; i < 3; i++) {
		dot += a->normal[i] * b->normal[i];
		difference += fabsf(a->colour[i] - b->colour[i]);
	}
	likeness = 1.0f - fminf(1.0f, difference / 384.0f);
	dot = 1.0f + roundf(NORMAL_WEIGHT * fmaxf(0.0f, dot));
	return (int32_t)fmaxf(1.0f, roundf(dot * likeness));
}

static int add_node(struct splitter *splitter, uint32_t *index)
{
	struct partition *out = splitter->out;
	int rc = ARRAY_RESERVE(out->nodes, splitter->node_room, out->node_count + 1, UINT32_MAX);

	if (rc < 0)
		return rc;
	*index = out->node_count++;
	out->nodes[*index] = (struct partition_node){
		.first_leaf = out->leaf_count,
		.children = { PARTITION_NONE, PARTITION_NONE },
	};
	return 0;
}

/* ---- triangles */

/* Adds the edges of the dual graph of some triangles; local holds their renamed corners. */
static int add_dual_edges(struct graph *graph, uint32_t (*local)[3], uint32_t count,
			  uint32_t vertex_count, const struct look *looks)
{
	struct incidence incidence;
	int rc = incidence_create(&incidence, local, count, vertex_count);

	for (uint32_t t = 0; rc == 0 && t < count; t++)
		for (int corner = 0; rc == 0 && corner < 3; corner++) {
			uint32_t a = local[t][corner], b = local[t][(corner + 1) % 3];

			for (uint32_t i = incidence.first[a]; i < incidence.first[a + 1]; i++) {
				uint32_t other = incidence.items[i];

				if (other <= t || (local[other][0] != b && local[other][1] != b &&
						   local[other][2] != b))
					continue;
				rc = graph_add(graph, t, other,
					       edge_weight(&looks[t], &looks[other]));
				if (rc < 0)
					break;
			}
		}
	incidence_finish(&incidence);
	return rc;
}

static uint32_t rename_corners(uint32_t (*local)[3], struct splitter *splitter, const uint32_t *set,
			       uint32_t count)
{
	uint32_t vertex_count = 0;

	for (uint32_t i = 0; i < count; i++)
		for (int corner = 0; corner < 3; corner++) {
			uint32_t *name = &splitter->local_of[splitter->triangles[set[i]][corner]];

			if (*name == PARTITION_NONE)
				*name = vertex_count++;
			local[i][corner] = *name;
		}
	for (uint32_t i = 0; i < count; i++)
		for (int corner = 0; corner < 3; corner++)
			splitter->local_of[splitter->triangles[set[i]][corner]] = PARTITION_NONE;
	return vertex_count;
}

static int divide_triangles(uint32_t *labels, struct splitter *splitter, const uint32_t *set,
			    uint32_t count, uint32_t part_count, const float *shares)
{
	uint32_t(*local)[3] = malloc(count * sizeof(*local));
	struct look *looks = calloc(count, sizeof(*looks));
	float(*centres)[3] = malloc(count * sizeof(*centres));
	struct graph graph = { 0 };
	int rc = local && looks && centres ? graph_init(&graph, count) : -ENOMEM;

	for (uint32_t i = 0; rc == 0 && i < count; i++) {
		look_add(&looks[i], splitter, set[i]);
		look_settle(&looks[i]);
		memcpy(centres[i], looks[i].centre, sizeof(*centres));
	}
	if (rc == 0)
		rc = add_dual_edges(&graph, local, count,
				    rename_corners(local, splitter, set, count), looks);
	if (rc == 0)
		rc = graph_connect(&graph, centres, JOIN_WEIGHT);
	if (rc == 0)
		rc = graph_divide(labels, &graph, part_count, shares);
	graph_finish(&graph);
	free(local);
	free(looks);
	free(centres);
	return rc;
}

/* Sorts the set by label, keeping the order within one; starts has part_count + 1 entries. */
static int sort_by_label(uint32_t *set, uint32_t count, const uint32_t *labels, uint32_t *starts,
			 uint32_t part_count)
{
	uint32_t *sorted = malloc((count + 1) * sizeof(*sorted));

	if (!sorted)
		return -ENOMEM;
	memset(starts, 0, (part_count + 1) * sizeof(*starts));
	for (uint32_t i = 0; i < count; i++)
		starts[labels[i] + 1]++;
	for (uint32_t p = 0; p < part_count; p++)
		starts[p + 1] += starts[p];
	for (uint32_t i = 0; i < count; i++)
		sorted[starts[labels[i]]++] = set[i];
	for (uint32_t p = part_count; p > 0; p--)
		starts[p] = starts[p - 1];
	starts[0] = 0;
	memcpy(set, sorted, count * sizeof(*sorted));
	free(sorted);
	return 0;
}

/* The number of leaves, chosen so that each stays below the limit although METIS balances only to
 * some percent. */
static uint32_t leaves_for(const struct splitter *splitter, uint32_t triangle_count)
{
	double most = 0.94 * splitter->options.patch_triangles;
	double leaves = ceil(triangle_count / (most < 1.0 ? 1.0 : most));

	return leaves < 2.0 ? 2 : (uint32_t)leaves;
}

static void share_by_leaves(float shares[2], uint32_t leaves)
{
	shares[0] = (float)(leaves / 2) / (float)leaves;
	shares[1] = 1.0f - shares[0];
}

static int split_triangles(struct splitter *splitter, uint32_t *set, uint32_t count, uint32_t *node)
{
	uint32_t leaves = leaves_for(splitter, count);
	uint32_t part_count = splitter->options.binary ? 2 : leaves;
	uint32_t *labels, *starts, part;
	float shares[2];
	int rc = splitter->options.binary ? add_node(splitter, node) : 0;

	if (rc < 0)
		return rc;
	if (count <= splitter->options.patch_triangles) {
		for (uint32_t i = 0; i < count; i++)
			splitter->out->leaf_of[set[i]] = splitter->out->leaf_count;
		splitter->out->leaf_count++;
		if (splitter->options.binary)
			splitter->out->nodes[*node].leaf_count = 1;
		return 0;
	}
	labels = malloc(count * sizeof(*labels));
	starts = malloc((part_count + 1) * sizeof(*starts));
	share_by_leaves(shares, leaves);
	rc = labels && starts ? divide_triangles(labels, splitter, set, count, part_count, shares)
			      : -ENOMEM;
	if (rc == 0)
		rc = sort_by_label(set, count, labels, starts, part_count);
	free(labels);
	for (uint32_t p = 0; rc == 0 && p < part_count; p++) {
		rc = split_triangles(splitter, set + starts[p], starts[p + 1] - starts[p], &part);
		if (rc == 0 && splitter->options.binary)
			splitter->out->nodes[*node].children[p] = part;
	}
	if (rc == 0 && splitter->options.binary)
		splitter->out->nodes[*node].leaf_count =
			splitter->out->leaf_count - splitter->out->nodes[*node].first_leaf;
	free(starts);
	return rc;
}

/* ---- voxels */

static uint64_t cell_at(const struct splitter *splitter, uint32_t vertex, int level)
{
	const int32_t *position = splitter->vertices[vertex].position;
	const int down = LATTICE_BITS + splitter->options.fine_bits - level;
	uint64_t cell = 0;

	for (int i = 0; i < 3; i++)
		cell = cell << 16 | (uint64_t)(position[i] >> down);
	return cell;
}

/* The voxel that holds most of the triangle's corners; if all differ, the first corner's. */
static uint64_t voxel_of_triangle(const struct splitter *splitter, uint32_t t, int level)
{
	uint64_t cells[3];

	for (int corner = 0; corner < 3; corner++)
		cells[corner] = cell_at(splitter, splitter->triangles[t][corner], level);
	return cells[1] == cells[2] ? cells[1] : cells[0];
}

/* Voxels are numbered in the order in which triangles meet them. */
static int number_voxels(struct splitter *splitter, int level, uint32_t *fullest)
{
	uint32_t *fill = calloc(splitter->triangle_count + 1, sizeof(*fill));
	struct map voxel_of_cell = { 0 };
	int rc = fill ? 0 : -ENOMEM;

	splitter->voxel_count = *fullest = 0;
	for (uint32_t t = 0; rc == 0 && t < splitter->triangle_count; t++) {
		const uint64_t cell = voxel_of_triangle(splitter, t, level);
		uint64_t voxel = map_get(&voxel_of_cell, cell);

		if (voxel == MAP_NONE) {
			voxel = splitter->voxel_count++;
			rc = map_set(&voxel_of_cell, cell, voxel);
		}
		splitter->voxel_of[t] = (uint32_t)voxel;
		if (++fill[voxel] > *fullest)
			*fullest = fill[voxel];
	}
	map_finish(&voxel_of_cell);
	free(fill);
	return rc;
}

/* Refines until each voxel holds fewer triangles than required, or until refining gains little. */
static int sort_into_voxels(struct splitter *splitter)
{
	uint32_t fullest;
	int rc = 0;

	for (int level = 1; level <= LEVELS_MAX; level++) {
		rc = number_voxels(splitter, level, &fullest);
		if (rc < 0 || fullest < splitter->options.voxel_triangles ||
		    splitter->voxel_count > splitter->triangle_count / 8)
			break;
	}
	if (rc < 0)
		return rc;
	splitter->first = calloc((size_t)splitter->voxel_count + 2, sizeof(*splitter->first));
	splitter->items = malloc((splitter->triangle_count + 1) * sizeof(*splitter->items));
	splitter->looks = calloc(splitter->voxel_count, sizeof(*splitter->looks));
	splitter->node_of = malloc(splitter->voxel_count * sizeof(*splitter->node_of));
	if (!splitter->first || !splitter->items || !splitter->looks || !splitter->node_of)
		return -ENOMEM;
	for (uint32_t t = 0; t < splitter->triangle_count; t++) {
		splitter->first[splitter->voxel_of[t] + 2]++;
		look_add(&splitter->looks[splitter->voxel_of[t]], splitter, t);
	}
	for (uint32_t v = 2; v < splitter->voxel_count + 2; v++)
		splitter->first[v] += splitter->first[v - 1];
	for (uint32_t t = 0; t < splitter->triangle_count; t++)
		splitter->items[splitter->first[splitter->voxel_of[t] + 1]++] = t;
	for (uint32_t v = 0; v < splitter->voxel_count; v++)
		look_settle(&splitter->looks[v]);
	return 0;
}

/* Adds an edge between voxels for each edge between triangles in two voxels. */
static int connect_voxels(struct splitter *splitter, uint32_t vertex_count)
{
	struct incidence incidence;
	int rc = incidence_create(&incidence, splitter->triangles, splitter->triangle_count,
				  vertex_count);

	for (uint32_t t = 0; rc == 0 && t < splitter->triangle_count; t++)
		for (int corner = 0; rc == 0 && corner < 3; corner++) {
			uint32_t a = splitter->triangles[t][corner];
			uint32_t b = splitter->triangles[t][(corner + 1) % 3];

			for (uint32_t i = incidence.first[a]; i < incidence.first[a + 1]; i++) {
				uint32_t other = incidence.items[i], from = splitter->voxel_of[t];
				uint32_t to = splitter->voxel_of[other];
				const uint32_t *corners = splitter->triangles[other];

				if (other <= t || from == to ||
				    (corners[0] != b && corners[1] != b && corners[2] != b))
					continue;
				rc = graph_add(
					&splitter->graph, from, to,
					edge_weight(&splitter->looks[from], &splitter->looks[to]));
				if (rc < 0)
					break;
			}
		}
	incidence_finish(&incidence);
	return rc;
}

/* Makes the subgraph of the voxels in a set. */
static int graph_of_set(struct graph *out, struct splitter *splitter, const uint32_t *set,
			uint32_t count)
{
	float(*centres)[3] = malloc(count * sizeof(*centres));
	int rc = centres ? graph_init(out, count) : -ENOMEM;

	for (uint32_t v = 0; v < splitter->voxel_count; v++)
		splitter->node_of[v] = PARTITION_NONE;
	for (uint32_t i = 0; rc == 0 && i < count; i++) {
		splitter->node_of[set[i]] = i;
		out->node_weights[i] = (int32_t)splitter->looks[set[i]].triangle_count;
		memcpy(centres[i], splitter->looks[set[i]].centre, sizeof(*centres));
	}
	for (size_t e = 0; rc == 0 && e < splitter->graph.edge_count; e++) {
		const struct graph_edge *edge = &splitter->graph.edges[e];
		uint32_t a = splitter->node_of[edge->a], b = splitter->node_of[edge->b];

		if (a != PARTITION_NONE && b != PARTITION_NONE)
			rc = graph_add(out, a, b, edge->weight);
	}
	if (rc == 0)
		rc = graph_connect(out, centres, JOIN_WEIGHT);
	free(centres);
	return rc;
}

static uint32_t triangles_in(const struct splitter *splitter, const uint32_t *set, uint32_t count)
{
	uint32_t sum = 0;

	for (uint32_t i = 0; i < count; i++)
		sum += splitter->looks[set[i]].triangle_count;
	return sum;
}

static int release_triangles(struct splitter *splitter, const uint32_t *set, uint32_t count,
			     uint32_t *node)
{
	uint32_t *released = malloc((triangles_in(splitter, set, count) + 1) * sizeof(*released));
	uint32_t released_count = 0;
	int rc;

	if (!released)
		return -ENOMEM;
	for (uint32_t i = 0; i < count; i++)
		for (uint32_t k = splitter->first[set[i]]; k < splitter->first[set[i] + 1]; k++)
			released[released_count++] = splitter->items[k];
	rc = split_triangles(splitter, released, released_count, node);
	free(released);
	return rc;
}

static int split_voxels(struct splitter *splitter, uint32_t *set, uint32_t count, uint32_t *node)
{
	uint32_t triangle_count = triangles_in(splitter, set, count);
	uint32_t *labels, starts[3], child;
	struct graph graph = { 0 };
	float shares[2];
	int rc;

	if (count < 2 || triangle_count <= splitter->options.chunk_triangles ||
	    triangle_count <= splitter->options.patch_triangles)
		return release_triangles(splitter, set, count, node);
	rc = splitter->options.binary ? add_node(splitter, node) : 0;
	labels = malloc(count * sizeof(*labels));
	share_by_leaves(shares, leaves_for(splitter, triangle_count));
	if (rc == 0)
		rc = labels ? graph_of_set(&graph, splitter, set, count) : -ENOMEM;
	if (rc == 0)
		rc = graph_divide(labels, &graph, 2, shares);
	graph_finish(&graph);
	if (rc == 0)
		rc = sort_by_label(set, count, labels, starts, 2);
	free(labels);
	for (uint32_t p = 0; rc == 0 && p < 2; p++) {
		rc = split_voxels(splitter, set + starts[p], starts[p + 1] - starts[p], &child);
		if (rc == 0 && splitter->options.binary)
			splitter->out->nodes[*node].children[p] = child;
	}
	if (rc == 0 && splitter->options.binary)
		splitter->out->nodes[*node].leaf_count =
			splitter->out->leaf_count - splitter->out->nodes[*node].first_leaf;
	return rc;
}

static int split_all(struct splitter *splitter, uint32_t vertex_count)
{
	uint32_t count = splitter->triangle_count, root;
	uint32_t *set = malloc((count + 1) * sizeof(*set));
	int rc = set ? 0 : -ENOMEM;

	for (uint32_t i = 0; rc == 0 && i < count; i++)
		set[i] = i;
	if (rc == 0 && count <= splitter->options.chunk_triangles) {
		rc = split_triangles(splitter, set, count, &root);
	} else if (rc == 0) {
		rc = sort_into_voxels(splitter);
		if (rc == 0)
			rc = graph_init(&splitter->graph, splitter->voxel_count);
		if (rc == 0)
			rc = connect_voxels(splitter, vertex_count);
		if (rc == 0)
			rc = split_voxels(splitter, set, splitter->voxel_count, &root);
	}
	free(set);
	return rc;
}

int partition_create(struct partition *out, const struct lattice_vertex *vertices,
		     uint32_t vertex_count, uint32_t (*triangles)[3], uint32_t triangle_count,
		     const struct partition_options *options)
{
	struct splitter splitter = {
		.vertices = vertices,
		.triangles = triangles,
		.triangle_count = triangle_count,
		.options = *options,
		.out = out,
		.local_of = malloc((vertex_count + 1) * sizeof(*splitter.local_of)),
		.voxel_of = malloc((triangle_count + 1) * sizeof(*splitter.voxel_of)),
	};
	int rc = options->patch_triangles && options->voxel_triangles && triangle_count ? 0
											: -EINVAL;

	*out = (struct partition){ 0 };
	out->leaf_of = malloc((triangle_count + 1) * sizeof(*out->leaf_of));
	if (rc == 0 && (!splitter.local_of || !splitter.voxel_of || !out->leaf_of))
		rc = -ENOMEM;
	for (uint32_t v = 0; rc == 0 && v < vertex_count; v++)
		splitter.local_of[v] = PARTITION_NONE;
	if (rc == 0)
		rc = split_all(&splitter, vertex_count);
	out->voxel_count = splitter.voxel_count;
	graph_finish(&splitter.graph);
	free(splitter.local_of);
	free(splitter.voxel_of);
	free(splitter.first);
	free(splitter.items);
	free(splitter.looks);
	free(splitter.node_of);
	if (rc < 0)
		partition_finish(out);
	return rc;
}

void partition_finish(struct partition *partition)
{
	if (!partition)
		return;
	free(partition->leaf_of);
	free(partition->nodes);
	*partition = (struct partition){ 0 };
}
