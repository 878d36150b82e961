/* Writes a mesh with its textures as OBJ, MTL and PNG files, which gopura-content import reads. */
#ifndef GOPURA_PIPELINE_DEFORM_MESH_OBJ_H
#define GOPURA_PIPELINE_DEFORM_MESH_OBJ_H

#include "pipeline/import/mesh.h"

/* path ends with ".obj". Beside it, with its name: NAME.mtl, and NAME-N.png for each texture; one
 * of a single pixel is a colour in the MTL. Without textures it is the OBJ alone, with the colours
 * of its vertices. Each file appears when it is complete, the OBJ last. -EINVAL: the path has no
 * such end; -ENAMETOOLONG; or another negative errno. */
must_check int mesh_obj_write(const struct mesh *mesh, const char *path);

#endif
