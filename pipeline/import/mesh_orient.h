/* Corrects faces that show the wrong side. */
#ifndef GOPURA_PIPELINE_IMPORT_MESH_ORIENT_H
#define GOPURA_PIPELINE_IMPORT_MESH_ORIENT_H

#include "pipeline/import/mesh_edges.h"

/* Turns the faces that show another side than the larger part of the surface around them. edges are
 * those of mesh. Turning a face changes none of their ends. -ENOMEM, -ENOSPC. */
must_check int mesh_orient(struct mesh *mesh, const struct mesh_edges *edges,
			   uint32_t *turned_faces);

#endif
