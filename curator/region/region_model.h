/* A region as a surface that can be drawn: each block of successive triangles of the scan that has
 * one of the region is a piece. Nothing is kept of it, so a change of the region shows at once. */
#ifndef GOPURA_CURATOR_REGION_REGION_MODEL_H
#define GOPURA_CURATOR_REGION_REGION_MODEL_H

#include "curator/region/region_set.h"
#include "curator/select/face_pick.h"
#include "pipeline/samples/model.h"

/* *out is owned by the caller (model_destroy); NULL on failure. All others are borrowed for its
 * lifetime; blocks are of the mesh. Its colours and normals mean nothing. -ENOMEM. */
must_check int region_model_create(struct model **out, const struct region_set *set,
				   const struct mesh *mesh, const struct face_blocks *blocks);

#endif
