/* A patch group object: the geometry of the patches of one group (see hierarchy.h).
 * docs/patch.md has the bytes. Vertices and indices go through meshoptimizer's codecs, then zstd.
 */
#ifndef GOPURA_FORMAT_PATCH_H
#define GOPURA_FORMAT_PATCH_H

#include "base/bytes.h"

enum {
	PATCH_TRIANGLES_MOST = 4000,
	PATCH_VERTICES_MOST = 3 * PATCH_TRIANGLES_MOST,
	GROUP_PATCHES_MOST = 64
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

/* Appends the object; the order of vertices and triangles is the caller's (cache-coherent). */
must_check int patch_group_encode(struct buffer *out, const struct patch_mesh *patches,
				  uint32_t patch_count);
/* Fills at most GROUP_PATCHES_MOST meshes. -EBADMSG for anything that encode cannot have written,
 * indices out of range included; then nothing is owned. */
must_check int patch_group_decode(struct patch_mesh patches[GROUP_PATCHES_MOST],
				  uint32_t *patch_count, struct bytes object);
void patch_mesh_finish(struct patch_mesh *mesh);
/* The nearest colour that so many bits tell (4 to 8); 0 and 255 stay. A group whose colours are all
 * of so many bits, or of fewer, takes fewer bytes. */
uint8_t patch_round_colour(uint8_t value, int bits);

/* Octahedral normals (Cigolle et al. 2014, "A survey of efficient representations for independent
 * unit vectors"). Decoding gives a unit vector. */
void normal_encode(int8_t out[2], const float normal[3]);
void normal_decode(float out[3], const int8_t normal[2]);

#endif
