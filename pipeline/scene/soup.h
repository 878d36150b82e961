/* The surface of a scene: its triangles in one place, with colours and textures. */
#ifndef GOPURA_PIPELINE_SCENE_SOUP_H
#define GOPURA_PIPELINE_SCENE_SOUP_H

#include <stdbool.h>
#include <stdint.h>

#include "base/compiler.h"

enum { SOUP_TRIANGLES_MAX = 1 << 24 };

#define SOUP_NO_TEXTURE UINT32_MAX

struct soup_corner {
	float position[3];
	float normal[3]; /* that the file gives; 0 0 0: none */
	float uv[2];     /* v = 0 at the bottom of the picture */
	uint8_t rgb[3];
};

struct soup_triangle {
	struct soup_corner corners[3]; /* counter-clockwise seen from outside */
	uint32_t texture;              /* or SOUP_NO_TEXTURE */
};

struct soup {
	struct soup_triangle *triangles; /* owned */
	uint32_t count, room;
	/* The state of what is added: */
	float place[16];        /* column-major; from the shape to the scene */
	bool is_inside_out;     /* the shape's faces are clockwise, or place mirrors, not both */
	uint32_t texture;       /* or SOUP_NO_TEXTURE */
	uint64_t polygon_steps; /* spent on concave faces */
	/* For a surface that bends: the number of the file's point at each corner, triangle by
	 * triangle. */
	bool keeps_sources;
	uint32_t (*sources)[3]; /* owned */
	uint32_t source_room;
	const uint32_t *from; /* borrowed; of the corners that are added next */
};

/* Adds a polygon of the shape, with its corners in order; they may be concave, but lie in about one
 * plane. Four and more corners without an area give nothing. Returns 0; -EFBIG: over
 * SOUP_TRIANGLES_MAX; -ENOMEM. */
must_check int soup_add(struct soup *soup, const struct soup_corner *corners, uint32_t count);
/* Puts a place of the shape where the scene has it. */
void soup_place(float out[3], const struct soup *soup, const float at[3]);
void soup_finish(struct soup *soup); /* NULL is fine */

#endif
