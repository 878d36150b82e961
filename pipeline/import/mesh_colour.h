/* Vertex colours of a textured mesh, because coarse patches have no room for a picture. */
#ifndef GOPURA_PIPELINE_IMPORT_MESH_COLOUR_H
#define GOPURA_PIPELINE_IMPORT_MESH_COLOUR_H

#include "pipeline/import/mesh.h"

/* Gives each vertex the mean of the textures over the faces around it, with more weight for near
 * parts. So a coarse patch shows the picture without its fine grain, and no vertex takes its colour
 * from the gap between two charts of an atlas. Vertices at one place get the same colour. The open
 * share of the sky is kept. A mesh without textures is unchanged. jobs: number of threads that look
 * for them. -ENOMEM, -ENOSPC. */
must_check int mesh_colours_from_textures(struct mesh *mesh, uint32_t jobs);

#endif
