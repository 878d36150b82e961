/* Divides a surface into patches along its own geometry (paper P0 3.1). Triangles are sorted into
 * voxels. METIS halves the graph of the voxels until few triangles are left, then divides the graph
 * of those triangles, until no patch exceeds the limit. An edge of a graph has the weight (1 +
 * round(8 max(0, n . n'))) times the similarity of the colours, so that cuts follow creases and
 * changes of material. Deterministic. */
#ifndef GOPURA_PIPELINE_HIERARCHY_PARTITION_H
#define GOPURA_PIPELINE_HIERARCHY_PARTITION_H

#include <stdbool.h>

#include "pipeline/hierarchy/lattice_mesh.h"

#define PARTITION_NONE UINT32_MAX

struct partition_options {
	uint32_t voxel_triangles; /* N_v: voxels are refined until each holds fewer */
	uint32_t chunk_triangles; /* N_n: at most so many are divided triangle by triangle */
	uint32_t patch_triangles; /* N_l: maximum in a patch, 1 or more */
	bool binary;              /* only halve, and keep the tree of the halves */
	uint8_t fine_bits;        /* of the lattice */
};

/* A node of the binary tree covers the leaves first_leaf to first_leaf + leaf_count - 1. */
struct partition_node {
	uint32_t first_leaf, leaf_count;
	uint32_t children[2]; /* PARTITION_NONE: a leaf */
};

struct partition {
	uint32_t leaf_count;
	uint32_t *leaf_of; /* owned; the leaf of each triangle */
	uint32_t node_count;
	struct partition_node
		*nodes; /* owned; [0] is the root, children after parents; only with binary */
	uint32_t voxel_count;
};

/* Divides a surface. The arrays are borrowed for the call. *out is owned by the caller: end it with
 * partition_finish(). Returns -ENOMEM, or -EINVAL for a limit of zero or no triangles. On failure
 * *out is zeroed. */
must_check int partition_create(struct partition *out, const struct lattice_vertex *vertices,
				uint32_t vertex_count, uint32_t (*triangles)[3],
				uint32_t triangle_count, const struct partition_options *options);
/* Frees the arrays and zeroes the struct. NULL and zeroed are fine. */
void partition_finish(struct partition *partition);

#endif
