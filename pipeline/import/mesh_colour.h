/* Vertex colours of a textured mesh: coarse patches have no room for a picture. */
#ifndef GOPURA_PIPELINE_IMPORT_MESH_COLOUR_H
#define GOPURA_PIPELINE_IMPORT_MESH_COLOUR_H

#include "pipeline/import/mesh.h"

/* Each vertex gets the mean of the textures over the faces around its place, the near parts
 * counting more: what a coarse patch shows is then the picture without its grain, and no vertex
 * takes the colour between two charts of an atlas. Vertices at one place get one colour. The open
 * share of the sky stays. -ENOMEM. A mesh without textures stays as it is. */
must_check int mesh_colours_from_textures(struct mesh *mesh);

#endif
