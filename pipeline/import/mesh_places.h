/* Which vertices of a mesh are one. */
#ifndef GOPURA_PIPELINE_IMPORT_MESH_PLACES_H
#define GOPURA_PIPELINE_IMPORT_MESH_PLACES_H

#include "pipeline/import/mesh.h"

/* Of each vertex the first one at the same place. Owned by the caller; NULL: no memory. */
uint32_t *mesh_places(const struct mesh *mesh);
/* The same, of equal place, colour and texture coordinates. */
uint32_t *mesh_equals(const struct mesh *mesh);

#endif
