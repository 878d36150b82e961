/* A mesh in memory as import gives it: metres, z up, counter-clockwise from outside. */
#ifndef GOPURA_PIPELINE_MESH_H
#define GOPURA_PIPELINE_MESH_H

#include "base/compiler.h"

#include <stdint.h>

/* sRGB, row 0 on top, 3 bytes a pixel. */
struct mesh_texture {
	uint32_t width, height;
	uint8_t *rgb; /* owned */
};

struct mesh {
	uint32_t vertex_count, triangle_count;
	float (*positions)[3];
	uint8_t (*colours)[4]; /* sRGB and open sky (255: all); NULL: the scan has none */
	float (*uvs)[2];       /* v = 0 at the picture's bottom; NULL: no texture. A vertex with
				* two places in the picture is two vertices. */
	uint32_t (*triangles)[3];
	uint16_t *materials; /* index of the texture of each triangle; NULL: no texture */
	uint32_t texture_count;
	struct mesh_texture *textures;
};

void mesh_finish(struct mesh *mesh); /* frees what it owns, zeroes; NULL is fine */

#endif
