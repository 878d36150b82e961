/* Draws the surface through the leaf cubes: marching cubes with crossing ratios instead of
 * midpoints (paper P1, section 4.2), block by block. */
#ifndef GOPURA_PIPELINE_OCTREE_CUBE_SURFACE_H
#define GOPURA_PIPELINE_OCTREE_CUBE_SURFACE_H

#include "pipeline/import/mesh.h"
#include "pipeline/octree/coarse_fill.h"
#include "pipeline/octree/cube_table.h"

struct cube_surface_options {
	/* Every corner has a sign: of what was seen, else of fill's membrane, so that no edge is
	 * open. Otherwise only cubes whose eight corners were seen are drawn. */
	bool is_closed;
	/* Called for each cube that the surface crosses, with the vertices on its crossed edges;
	 * the order is that of blocks. A negative result ends the work. NULL: not wanted. */
	int (*leaf)(void *data, const int32_t cube[3], uint8_t inside,
		    const uint32_t vertices[CUBE_EDGES]);
	void *data; /* for leaf */
};

/* *out is owned by the caller (mesh_finish); it is zeroed on failure. Places are in the unit of the
 * files, triangles counter-clockwise seen from outside; colours if the field has them. -ENOMEM,
 * -ENOSPC; -EFBIG: beyond 32-bit counts; what leaf returned. */
must_check int cube_surface_draw(struct mesh *out, const struct corner_field *field,
				 const struct coarse_fill *fill,
				 const struct cube_surface_options *options);

#endif
