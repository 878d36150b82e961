/* Feature points of a scan's surface: its vertices, each with the last scale that it survives to,
 * found in range images from around the model (pipeline/samples/scale_space.h; Cheng and Boulanger,
 * "Scale-Space 3D TexMesh Simplification", paper P2, section 3). The paper's scanner makes one
 * range image; a scan of any shape is seen from fourteen sides instead, and a vertex counts as
 * where it survives longest. */
#ifndef GOPURA_PIPELINE_TEXMESH_VERTEX_SCALES_H
#define GOPURA_PIPELINE_TEXMESH_VERTEX_SCALES_H

#include "pipeline/texmesh/reduced_mesh.h"

enum { VERTEX_SCALES = 4 }; /* sigma is 1, 2, 4 and 8 pixels of a range image of 512 */

/* Sets out, vertex_count numbers, to 0 (no feature point, or not seen) .. VERTEX_SCALES. scan: the
 * mesh that the copy was made of. Returns -ENOMEM, -ENOSPC. */
must_check int vertex_scales_find(uint8_t *out, const struct reduced_mesh *copy,
				  const struct mesh *scan);

#endif
