/* The triangles of a patch in the layout that the GPU uses. */
#ifndef GOPURA_FORMAT_PATCH_MESH_H
#define GOPURA_FORMAT_PATCH_MESH_H

#include <stdint.h>

enum {
	PATCH_TRIANGLES_MAX = 4000,
	PATCH_VERTICES_MAX = 3 * PATCH_TRIANGLES_MAX,
};

/* As uploaded to the GPU: 12 bytes. */
struct patch_vertex {
	uint16_t position[3]; /* lattice coordinates, see struct lattice */
	int8_t normal[2];     /* octahedral (format/normal.h), x and y in -127..127 */
	uint8_t colour[4];    /* sRGB; [3] is the share of open sky, 255 = all of it */
};
_Static_assert(sizeof(struct patch_vertex) == 12, "one layout on GPU and wire");

struct patch_mesh {
	uint32_t vertex_count, triangle_count;
	struct patch_vertex *vertices; /* owned */
	uint16_t *indices;             /* owned; 3 per triangle, counter-clockwise from outside */
};

#endif
