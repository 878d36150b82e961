/* The cone of directions in which the triangles of a patch face. */
#ifndef GOPURA_PIPELINE_HIERARCHY_NORMAL_CONE_H
#define GOPURA_PIPELINE_HIERARCHY_NORMAL_CONE_H

#include "format/hierarchy.h"
#include "format/patch_mesh.h"

/* Sets cone_axis and cone_cos of *out so that the cone holds the normals of all triangles of the
 * mesh. Uses the triangles' own normals, not those of vertices, since these decide which triangles
 * face the camera; one without area makes the cone a half space or more. */
void normal_cone_bound(struct hierarchy_patch *out, const struct patch_mesh *mesh);

#endif
