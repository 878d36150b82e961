/* A patch group object: the geometry of the patches of one group (see hierarchy.h). docs/patch.md
 * describes the bytes. Vertices that patches of the group share are stored once. Connectivity
 * (connectivity.h) and the differences of vertices from predictions (predict.h) go through an
 * adaptive entropy coder (symbol_coder.h). */
#ifndef GOPURA_FORMAT_PATCH_H
#define GOPURA_FORMAT_PATCH_H

#include "base/bytes.h"
#include "format/patch_mesh.h"

enum { GROUP_PATCHES_MAX = 64 };

/* Appends the object. Returns -EINVAL if a count, an index or a position is out of range, -ENOMEM
 * or the error of out. */
must_check int patch_group_encode(struct buffer *out, const struct patch_mesh *patches,
				  uint32_t patch_count);
/* Fills at most GROUP_PATCHES_MAX meshes, owned by the caller: end each with patch_mesh_finish().
 * They have the vertices and triangles that were encoded, bit for bit, but in the order of the
 * codec: triangles as they grow over the patch, each from any of its corners, and vertices as the
 * triangles first name them, then those that none names. Returns -EBADMSG if the object is damaged,
 * too short, too long or of another version, or -ENOMEM. On failure nothing is owned. */
must_check int patch_group_decode(struct patch_mesh patches[GROUP_PATCHES_MAX],
				  uint32_t *patch_count, struct bytes object);
/* Frees the arrays and zeroes the struct. NULL and zeroed are fine. */
void patch_mesh_finish(struct patch_mesh *mesh);
/* Returns the nearest value that bits bits can express (4 to 8); 0 and 255 stay. A group takes
 * fewer bytes if all its colours need at most so many bits. */
uint8_t patch_round_colour(uint8_t value, int bits);
/* The same for a component of a normal; -127, 0 and 127 stay. */
int8_t patch_round_normal(int8_t value, int bits);

#endif
