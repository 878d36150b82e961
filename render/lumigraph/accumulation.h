/* While the eye is at rest, frames shifted by fractions of a pixel accumulate into one anti-aliased
 * picture. What still changes (a fade, a finer patch) blends in with them instead of popping. */
#ifndef GOPURA_RENDER_LUMIGRAPH_ACCUMULATION_H
#define GOPURA_RENDER_LUMIGRAPH_ACCUMULATION_H

#include "render/display/gl.h"

enum {
	/* weight, in frames, of the previous picture while the scene changes and after */
	ACCUMULATION_STALE = 3,
	/* frames without a change until it is done; the previous picture then keeps a twentieth */
	ACCUMULATION_FRAMES = 12
};

struct accumulation {
	struct gl_target frame, sum;
	GLuint program;
	uint32_t count; /* frames since the eye came to rest */
	uint32_t same;  /* the latest of them that showed the same scene */
};

/* Allocates the sum for pictures of that size and, where draws is true, also the frame to draw
 * into; cheap where they exist. On failure (as gl_target_create) nothing is allocated, and the
 * caller draws without accumulation. */
must_check int accumulation_prepare(struct accumulation *accumulation, int width_px, int height_px,
				    bool draws);
/* Frees the GL objects; zeroed is fine. */
void accumulation_finish(struct accumulation *accumulation);
/* The eye moved: starts a new accumulation. */
void accumulation_break(struct accumulation *accumulation);
/* Writes the offset of the next frame, under a pixel; the weighted mean of the offsets in the sum
 * is zero. changed as for accumulation_add. */
void accumulation_offset(const struct accumulation *accumulation, bool changed, float *x_px,
			 float *y_px);
/* Adds accumulation->frame, which was just drawn, and shows the sum at the given place. changed:
 * the scene differs from that of the last frame. */
void accumulation_add(struct accumulation *accumulation, const struct gl_place *place,
		      bool changed);
/* Shows the sum at the given place as it is. */
void accumulation_show_sum(const struct accumulation *accumulation, const struct gl_place *place);
/* Shows accumulation->frame alone at the given place. */
void accumulation_show_frame(const struct accumulation *accumulation, const struct gl_place *place);
/* Returns whether enough frames of the same scene were added. */
bool accumulation_is_done(const struct accumulation *accumulation);
/* Frees memory when nothing is left to draw: accumulation->frame is no longer needed. A driver that
 * renders on the CPU keeps the inputs and the target of each pass until another pass replaces them.
 * Therefore the sum is drawn at the place as often as passes can be in flight. The shader compiler
 * is released as well. */
void accumulation_let_go(struct accumulation *accumulation, const struct gl_place *place);

#endif
