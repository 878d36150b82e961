/* A patch's triangles as they lie on the GPU. */
#ifndef GOPURA_FORMAT_PATCH_MESH_H
#define GOPURA_FORMAT_PATCH_MESH_H

#include <stdint.h>

enum {
	PATCH_TRIANGLES_MAX = 4000,
	PATCH_VERTICES_MAX = 3 * PATCH_TRIANGLES_MAX,
};

/* As uploaded to the GPU: 12 bytes. */
struct patch_vertex {
	uint16_t position[3]; /* on the model's lattice */
	int8_t normal[2];     /* octahedral, unit vector, x and y in -127..127 */
	uint8_t colour[4];    /* sRGB; [3] is the share of the sky that is open, 255 = all */
};
_Static_assert(sizeof(struct patch_vertex) == 12, "one layout on GPU and wire");

struct patch_mesh {
	uint32_t vertex_count, triangle_count;
	struct patch_vertex *vertices; /* owned */
	uint16_t *indices;             /* owned; 3 a triangle, counter-clockwise from outside */
};

#endif
