/* Finds vertices of a mesh that are equal. */
#ifndef GOPURA_PIPELINE_IMPORT_MESH_PLACES_H
#define GOPURA_PIPELINE_IMPORT_MESH_PLACES_H

#include "pipeline/import/mesh.h"

/* Returns, for each vertex, the first vertex at the same place. Owned by the caller
 * (spill_free). NULL: no memory or no room on the disk, as errno says. */
uint32_t *mesh_places(const struct mesh *mesh);
/* The same for vertices with equal place, colour and texture coordinates. */
uint32_t *mesh_equals(const struct mesh *mesh);

#endif
