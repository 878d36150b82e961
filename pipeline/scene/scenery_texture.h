/* Makes a picture into one that a terminal puts on surfaces: with sides that are powers of two,
 * which GLES2 needs to repeat it and to have smaller ones of it, as a JPEG. Private to
 * pipeline/scene. */
#ifndef GOPURA_PIPELINE_SCENE_SCENERY_TEXTURE_H
#define GOPURA_PIPELINE_SCENE_SCENERY_TEXTURE_H

#include "format/hash.h"
#include "format/picture.h"
#include "format/scenery.h"

/* What tells pictures apart. */
struct scenery_source {
	struct hash pixels;
	uint32_t width, height;
	bool repeats;
	bool is_map; /* a normal map, kept with more care */
};
struct scenery_source scenery_source_of(const struct picture *picture, bool repeats, bool is_map);
bool scenery_source_equals(const struct scenery_source *a, const struct scenery_source *b);

/* The caller ends *out with scenery_finish() of what it is put into. Each side becomes the nearest
 * power of two, halved until there are at most texels_most pixels (at least 1). Transparency is
 * left out. -ENOMEM, or -EFBIG. */
must_check int scenery_texture_make(struct scenery_texture *out, const struct picture *picture,
				    bool repeats, bool is_map, uint32_t texels_most);

#endif
