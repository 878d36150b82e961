/* The outline of a part: a bold line of constant width around everything that is seen of it, and a
 * slight tint inside, as in Okamoto et al., Fig. 4. Whatever ends the part in the picture (its own
 * border, its silhouette, or something in front of it) is one and the same line, because it is
 * found in the picture: visible pixels of the part are drawn white into a mask, and the line lies
 * where the mask changes. Openings and notches narrower than about 15 pixels are closed before
 * (a dilation, then an erosion): two lines would leave nothing of them but a blot. */
#ifndef GOPURA_RENDER_LUMIGRAPH_OUTLINE_H
#define GOPURA_RENDER_LUMIGRAPH_OUTLINE_H

#include "geometry/view.h"
#include "render/display/gl.h"

struct outline_program {
	GLuint program;
	GLint step, scale, closed_scale, range;
};

struct outline {
	struct outline_program line, blur, mean;
	/* Absent until a part is marked: the mask, as large as the picture; what the line is found
	 * in, at half the size of what is shown; two in which openings are closed, at a quarter. */
	struct gl_target mask, soft, closed, aside;
	int width_px, height_px; /* of what is shown */
	float low[2], high[2];   /* the rectangle that may hold the part, in clip space, -1..1 */
};

/* Builds the programs; needs a current GL context, as everything here. Errors as gl_program_build;
 * then call outline_finish. */
must_check int outline_init(struct outline *outline);
void outline_finish(struct outline *outline); /* Frees everything; zeroed is fine. */
/* Frees the masks; the next outline_begin makes them again. */
void outline_let_go(struct outline *outline);

/* Starts a new frame, which has no pixel of the part yet. */
void outline_clear(struct outline *outline);
/* The part may be visible inside this sphere. */
void outline_include(struct outline *outline, const struct view *view, const float centre_m[3],
		     float radius_m);
/* Returns whether no sphere was included. */
bool outline_is_empty(const struct outline *outline);

/* Binds the mask, with the depth of the picture that was just drawn and will be shown at that size,
 * which may be larger. Then draw the part white, and call outline_end. On failure (as
 * gl_target_create) nothing is bound. */
must_check int outline_begin(struct outline *outline, const struct gl_target *picture, int width_px,
			     int height_px);
/* Restores the GL state that the scene expects, but another framebuffer is bound. */
void outline_end(struct outline *outline);
/* Draws line and tint over the picture, shown at that size; keeps its alpha. */
void outline_draw(const struct outline *outline, const struct gl_place *place, int width_px,
		  int height_px);

#endif
