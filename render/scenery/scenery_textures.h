/* The pictures of scenery as textures, and where they lie on meshes. */
#ifndef GOPURA_RENDER_SCENERY_SCENERY_TEXTURES_H
#define GOPURA_RENDER_SCENERY_SCENERY_TEXTURES_H

#include "format/scenery.h"
#include "render/display/gl.h"

/* Zeroed is empty. */
struct scenery_textures {
	GLuint *names; /* owned; 0: it could not be uploaded, so it is not shown */
	uint32_t count;
	GLuint uvs;     /* of all meshes that have a picture */
	size_t *offset; /* owned: of each mesh in it, in bytes */
};

/* Uploads where pictures lie; without pictures it costs nothing. -ENOMEM, or as gl_check. */
must_check int scenery_textures_load(struct scenery_textures *textures,
				     const struct scenery *scenery);
/* Uploads the next picture, if one is left, and frees its rgba. Returns whether none was left. */
bool scenery_textures_next(struct scenery_textures *textures, struct scenery *scenery);
/* Returns the bytes that the pictures have on the GPU. */
uint64_t scenery_textures_bytes(const struct scenery *scenery);
/* Sets attribute 3 to where the pictures lie on a mesh, and binds the picture to unit 1, the normal
 * map to unit 2. The buffer of attributes is another one afterwards. */
void scenery_textures_bind(const struct scenery_textures *textures, const struct scenery *scenery,
			   uint32_t mesh);
void scenery_textures_finish(struct scenery_textures *textures); /* zeroed is fine */

#endif
