/* A patch group object: the geometry of the patches of one group (see hierarchy.h). docs/patch.md
 * describes the bytes. Indices go through meshoptimizer's index codec; vertices are stored as
 * differences from a prediction (predict.h). All streams are then compressed with zstd. */
#ifndef GOPURA_FORMAT_PATCH_H
#define GOPURA_FORMAT_PATCH_H

#include "base/bytes.h"
#include "format/patch_mesh.h"

enum { GROUP_PATCHES_MAX = 64 };

/* What the encoder is to care for. */
enum patch_effort {
	PATCH_FAST, /* for what stays at home: a few percent more bytes in a fifth of the time */
	PATCH_SMALL /* for what is published */
};

/* Appends the object. The caller chooses the order of vertices and triangles (cache-coherent). The
 * decoder may return a triangle with its corners rotated. Returns -EINVAL if a count, an index
 * or a position is out of range, -ENOMEM or the error of out. */
must_check int patch_group_encode(struct buffer *out, const struct patch_mesh *patches,
				  uint32_t patch_count, enum patch_effort effort);
/* Fills at most GROUP_PATCHES_MAX meshes, owned by the caller: end each with patch_mesh_finish().
 * Returns -EBADMSG for anything that the encoder cannot have written, indices out of range
 * included, or -ENOMEM. On failure nothing is owned. */
must_check int patch_group_decode(struct patch_mesh patches[GROUP_PATCHES_MAX],
				  uint32_t *patch_count, struct bytes object);
/* Frees the arrays and zeroes the struct. NULL and zeroed are fine. */
void patch_mesh_finish(struct patch_mesh *mesh);
/* Returns the nearest value that bits bits can express (4 to 8); 0 and 255 stay. A group takes
 * fewer bytes if all its colours need at most so many bits. */
uint8_t patch_round_colour(uint8_t value, int bits);

#endif
