/* The pictures of scenery as bytes: docs/scenery.md. */
#ifndef GOPURA_FORMAT_SCENERY_TEXTURE_CODE_H
#define GOPURA_FORMAT_SCENERY_TEXTURE_CODE_H

#include "format/scenery.h"

/* Appends the pictures, which materials have them, also as normal maps if has_normals, and where
 * they lie on meshes. */
void scenery_put_textures(struct buffer *out, const struct scenery *scenery, bool has_normals);
/* Reads what scenery_put_textures wrote; the rest of the scenery must be there. Returns -EBADMSG
 * where there is no room for it, or -ENOMEM. */
must_check int scenery_get_textures(struct reader *in, struct scenery *scenery, bool has_normals);

/* Decodes the pictures into their rgba. Returns -EBADMSG if one is damaged or has another size, or
 * -ENOMEM. */
must_check int scenery_decode_textures(struct scenery *scenery);

#endif
