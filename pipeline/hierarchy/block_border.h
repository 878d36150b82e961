/* The vertices that triangles of several blocks share. Whoever owns the cell of such a vertex has
 * all its triangles at hand (block_split.h) and settles once for all blocks what it looks like. So
 * every block has it equal bit for bit. It is locked in the first stage of the build. */
#ifndef GOPURA_PIPELINE_HIERARCHY_BLOCK_BORDER_H
#define GOPURA_PIPELINE_HIERARCHY_BLOCK_BORDER_H

#include "geometry/substance.h"
#include "pipeline/hierarchy/block_split.h"
#include "pipeline/hierarchy/lattice_mesh.h"

/* How vertices get what the scan itself does not say. */
struct block_look {
	struct exposure *exposure;
	uint8_t plain_colour[3]; /* of scans without colours */
	bool is_stone;           /* use a material, not the scan's colours */
	enum substance_kind
		substance; /* which; SUBSTANCE_NONE: that of pipeline/material/material.h */
	float footprint_m; /* length of an edge, for the material */
};

/* Sets visibility and, for stone, colour of vertices from place and normal. */
void block_look_apply(const struct block_look *look, const struct lattice *lattice,
		      struct lattice_vertex *vertices, uint32_t count);

struct border_vertex {
	struct lattice_vertex vertex;
	uint32_t low, high; /* the first and the last block that use it */
};

struct block_border {
	struct border_vertex *vertices; /* owned; by blocks, in each by place */
	uint32_t *first; /* owned; for each block, and the number of all at the end */
	uint32_t block_count, vertex_room;
};

#define BORDER_NONE UINT32_MAX

/* Writes folder/border-LEAF: the vertices in the block's cells that others use. What is there
 * already is kept. Any process. Returns -ENOMEM or the errors of the disk. */
must_check int block_border_write(const struct block_scan *scan, const struct block_cells *cells,
				  const struct block_look *look, const char *folder,
				  uint32_t block);

/* Reads the files of all blocks. *out is owned by the caller; zeroed on failure. Returns -EBADMSG
 * if a file is damaged, -ENOMEM or the errors of the disk. */
must_check int block_border_read(struct block_border *out, const struct block_cells *cells,
				 const char *folder);
void block_border_finish(struct block_border *border); /* NULL and zeroed are fine */

/* Returns the number of the border vertex at a place, or BORDER_NONE. */
uint32_t block_border_find(const struct block_border *border, const struct block_cells *cells,
			   const struct lattice *lattice, const int32_t position[3]);

#endif
