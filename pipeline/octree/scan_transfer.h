/* What a surface that was made of a scan takes over from it: colours, and which face each triangle
 * stands for, so that lists of faces still mean the same stone. */
#ifndef GOPURA_PIPELINE_OCTREE_SCAN_TRANSFER_H
#define GOPURA_PIPELINE_OCTREE_SCAN_TRANSFER_H

#include "pipeline/octree/triangle_tree.h"

/* Gives each vertex of out, which has places and triangles only, the colour of the nearest place of
 * the scan; of its pictures the mean over a square of cell_m. Gives each triangle the scan and the
 * number of the face that is nearest to its middle, and orders triangles by scans. out has no
 * textures then. tree is that of the scan. -ENOMEM, -ENOSPC: out is only to be finished. */
must_check int scan_transfer(struct mesh *out, const struct mesh *scan,
			     const struct triangle_tree *tree, float cell_m);

#endif
