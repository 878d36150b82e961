/* Writes a mesh as a binary PLY, which gopura-content import reads. */
#ifndef GOPURA_PIPELINE_OCTREE_MESH_PLY_H
#define GOPURA_PIPELINE_OCTREE_MESH_PLY_H

#include "pipeline/import/mesh.h"

/* Places are written as they are; colours if the mesh has them. The file appears when it is
 * complete. A negative errno. */
must_check int mesh_ply_write(const struct mesh *mesh, const char *path);

#endif
