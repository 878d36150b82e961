/* The triangles of a patch. */
#ifndef GOPURA_FORMAT_PATCH_MESH_H
#define GOPURA_FORMAT_PATCH_MESH_H

#include <stdint.h>

enum {
	PATCH_TRIANGLES_MAX = 4000,
	PATCH_VERTICES_MAX = 3 * PATCH_TRIANGLES_MAX,
};

struct patch_vertex {
	int32_t position[3]; /* a place of the lattice, see struct lattice */
	int8_t normal[2];    /* octahedral (format/normal.h), x and y in -127..127 */
	uint8_t colour[4];   /* sRGB; [3] is the share of open sky, 255 = all of it */
	uint8_t zero[2];     /* equal vertices are equal bytes */
};
_Static_assert(sizeof(struct patch_vertex) == 20, "no padding");

struct patch_mesh {
	uint32_t vertex_count, triangle_count;
	struct patch_vertex *vertices; /* owned */
	uint16_t *indices;             /* owned; 3 per triangle, counter-clockwise from outside */
};

#endif
