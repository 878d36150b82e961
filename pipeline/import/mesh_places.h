/* Finds vertices of a mesh that are equal. */
#ifndef GOPURA_PIPELINE_IMPORT_MESH_PLACES_H
#define GOPURA_PIPELINE_IMPORT_MESH_PLACES_H

#include "pipeline/import/mesh.h"

/* (*out)[i] is the first vertex at the same place as vertex i. *out is NULL if no two vertices are
 * at one place; otherwise it is owned by the caller (spill_free). jobs: number of threads. -ENOMEM;
 * -ENOSPC: the disk is full; then *out is NULL too. */
must_check int mesh_places(uint32_t **out, const struct mesh *mesh, uint32_t jobs);
/* The same for vertices with equal place, colour and texture coordinates. place: as mesh_places
 * gives it; borrowed. *out is place itself if all vertices at one place are equal. */
must_check int mesh_equals(uint32_t **out, const struct mesh *mesh, uint32_t *place, uint32_t jobs);

#endif
