/* The only reader of the scan's mesh: finds its lattice, counts its triangles in cells, sorts them
 * into the files of the blocks, and gives the mesh of a part of them. The mesh may be a mapped file
 * of any size; processes take pieces of it in turn, so little of it is in memory at a time. */
#ifndef GOPURA_PIPELINE_HIERARCHY_BLOCK_SPLIT_H
#define GOPURA_PIPELINE_HIERARCHY_BLOCK_SPLIT_H

#include "base/processes.h"
#include "format/root_page.h"
#include "pipeline/hierarchy/block_cells.h"
#include "pipeline/hierarchy/exposure.h"
#include "pipeline/import/mesh.h"

struct block_scan {
	const struct mesh *mesh; /* borrowed */
	struct lattice lattice;
	float box_min_m[3], box_max_m[3];
	uint32_t jobs; /* processes at a time */
	struct shard shard;
};

/* Finds box and lattice. Returns -EINVAL if a position is not finite or there is no extent, or the
 * errors of processes_run. */
must_check int block_scan_init(struct block_scan *scan, const struct mesh *mesh, double step_max_m,
			       uint32_t jobs);

/* Adds every triangle to the counts (zeroed shared memory) and to the exposure. *edge_steps is the
 * sum of the lengths of the triangles' first edges, along all axes. Returns -EINVAL if a triangle
 * names a vertex that does not exist, or the errors of processes_run. */
must_check int block_scan_count(const struct block_scan *scan, struct block_counts *counts,
				struct exposure *exposure, uint64_t *edge_steps);

/* Writes the files folder/split-N, each with a piece of the scan sorted by blocks; what is there
 * already is kept. Returns the errors of the disk or of processes_run. */
must_check int block_split(const struct block_scan *scan, const struct block_cells *cells,
			   const char *folder);

/* The triangles of a block, as indices of the scan's vertices, in the scan's order. First its own;
 * then those of other blocks that have a corner in its cells, so that every vertex in its cells has
 * all its triangles here. */
struct block_triangles {
	uint32_t (*items)[3]; /* owned */
	uint32_t own_count, count;
};

/* *out is owned by the caller; zeroed on failure. Returns the errors of the disk, or -ENOMEM. */
must_check int block_triangles_read(struct block_triangles *out, const struct block_scan *scan,
				    const struct block_cells *cells, const char *folder,
				    uint32_t block);
void block_triangles_finish(struct block_triangles *triangles); /* NULL and zeroed are fine */

/* Puts the corners of a triangle on the lattice. */
void block_corners(int32_t out[3][3], const struct block_scan *scan, const uint32_t triangle[3]);

/* Copies some triangles with their vertices: positions and colours, in the scan's order. *out is
 * owned by the caller: end it with mesh_finish(). Returns -ENOMEM. */
must_check int block_mesh(struct mesh *out, const struct block_scan *scan, uint32_t (*triangles)[3],
			  uint32_t count);

#endif
