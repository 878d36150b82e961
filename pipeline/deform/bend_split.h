/* Divides the triangles of a mesh where space will bend them: where the middle of an edge or of a
 * triangle would go elsewhere than flat triangles take it. An edge is divided for all its
 * triangles, also across the seams of textures, so no crack appears between neighbours; triangles
 * that stay flat are left as they are. */
#ifndef GOPURA_PIPELINE_DEFORM_BEND_SPLIT_H
#define GOPURA_PIPELINE_DEFORM_BEND_SPLIT_H

#include <stdint.h>

#include "pipeline/deform/warp.h"
#include "pipeline/import/mesh.h"

/* Divides the triangles, before they are moved. tolerance: how far a place may be from its triangle
 * afterwards, above 0. New vertices have the mean of their neighbours'
 * colours and texture coordinates; new triangles have the face number of the old one and follow at
 * the end. The mesh has at most one scan. triangles_max: more are refused with -EFBIG. jobs: number
 * of threads; the result does not depend on it. -EDOM: the tolerance cannot be met, because an edge
 * would be shorter than floats can divide. -ENOMEM, -ENOSPC. On failure the mesh is only
 * to be finished. */
must_check int bend_split(struct mesh *mesh, const struct warp *warp, double tolerance,
			  uint32_t triangles_max, uint32_t jobs);

#endif
