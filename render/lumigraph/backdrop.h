/* The images of a vantage point as a picture of the whole surroundings: from that point they are
 * right without any mesh, so they are shown where the mesh is not here yet. Needs highp in
 * fragments. */
#ifndef GOPURA_RENDER_LUMIGRAPH_BACKDROP_H
#define GOPURA_RENDER_LUMIGRAPH_BACKDROP_H

#include "geometry/view.h"
#include "render/lumigraph/tiles.h"

struct backdrop {
	GLuint program; /* 0: not built yet */
	GLint clip, forward, right, up, place, sky;
	bool lacks; /* the program cannot be built */
};

/* Draws the resident tiles of the point's six faces over the bound picture, around the eye; sky:
 * their background, sRGB; share: 0..1, of them in the picture. Depth stays as it is. */
void backdrop_draw(struct backdrop *backdrop, const struct tiles *tiles, const struct view *view,
		   const uint8_t sky[3], uint32_t point, float share);
/* Frees all GL objects; zeroed is fine. */
void backdrop_finish(struct backdrop *backdrop);

#endif
