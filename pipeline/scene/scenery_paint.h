/* Puts a picture on a surface as colours of corners: triangles are divided evenly until the picture
 * shows, within a budget. Private to pipeline/scene. */
#ifndef GOPURA_PIPELINE_SCENE_SCENERY_PAINT_H
#define GOPURA_PIPELINE_SCENE_SCENERY_PAINT_H

#include "format/picture.h"
#include "pipeline/scene/soup.h"

/* A picture that was made smaller for a surface. */
struct scenery_paint {
	struct picture picture; /* owned */
	uint32_t pieces;        /* of each edge; a triangle becomes pieces * pieces */
};

/* Chooses how finely triangles are divided so that there are at most `most`, unless there were
 * before, and makes the picture as coarse as that. -ENOMEM. */
must_check int scenery_paint_init(struct scenery_paint *out, const struct picture *picture,
				  const struct soup_triangle *triangles, uint32_t count,
				  uint32_t most);
/* Multiplies the colour by that of the picture at a place, which repeats; v = 0 is its bottom. */
void scenery_paint_colour(const struct scenery_paint *paint, const float uv[2], uint8_t rgb[3]);
void scenery_paint_finish(struct scenery_paint *paint); /* zeroed is fine */

#endif
