/* A patch group object: the geometry of the patches of one group (see hierarchy.h).
 * docs/patch.md has the bytes. Vertices and indices go through meshoptimizer's codecs, then zstd.
 */
#ifndef GOPURA_FORMAT_PATCH_H
#define GOPURA_FORMAT_PATCH_H

#include "base/bytes.h"
#include "format/patch_mesh.h"

enum { GROUP_PATCHES_MAX = 64 };

/* Appends the object; the order of vertices and triangles is the caller's (cache-coherent). */
must_check int patch_group_encode(struct buffer *out, const struct patch_mesh *patches,
				  uint32_t patch_count);
/* Fills at most GROUP_PATCHES_MAX meshes. -EBADMSG for anything that encode cannot have written,
 * indices out of range included; then nothing is owned. */
must_check int patch_group_decode(struct patch_mesh patches[GROUP_PATCHES_MAX],
				  uint32_t *patch_count, struct bytes object);
void patch_mesh_finish(struct patch_mesh *mesh);
/* The nearest colour that so many bits tell (4 to 8); 0 and 255 stay. A group whose colours are all
 * of so many bits, or of fewer, takes fewer bytes. */
uint8_t patch_round_colour(uint8_t value, int bits);

#endif
