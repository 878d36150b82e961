/* While the eye rests, frames moved by parts of a pixel flow into one anti-aliased picture; what
 * still changes (a fade, a finer patch) flows in with them instead of popping. */
#ifndef GOPURA_RENDER_LUMIGRAPH_ACCUMULATION_H
#define GOPURA_RENDER_LUMIGRAPH_ACCUMULATION_H

#include "render/display/gl.h"

enum {
	ACCUMULATION_WINDOW =
		6, /* frames that what was before counts for, while the scene changes */
	ACCUMULATION_STALE = 3,  /* and once it does not */
	ACCUMULATION_FRAMES = 12 /* without a change: what was before has a twentieth left */
};

struct accumulation {
	struct gl_target frame, sum;
	GLuint program;
	uint32_t count; /* frames since the eye came to rest */
	uint32_t same;  /* of them the last that showed the same scene */
};

/* Room for the sum of pictures of that size and, where another is to be drawn, for that; cheap when
 * it is there. On failure pictures are drawn plainly. */
must_check int accumulation_prepare(struct accumulation *accumulation, int width_px, int height_px,
				    bool draws);
void accumulation_finish(struct accumulation *accumulation);
void accumulation_break(struct accumulation *accumulation); /* the eye moved: begin anew */
/* How far the next frame is moved, under a pixel; in the sum the mean is none. changed as for
 * accumulation_add. */
void accumulation_offset(const struct accumulation *accumulation, bool changed, float *x_px,
			 float *y_px);
/* Adds rest->frame, which was just drawn, and shows the sum at the place given. changed: the
 * scene is not what it was. */
void accumulation_add(struct accumulation *accumulation, const struct gl_place *place,
		      bool changed);
bool accumulation_is_done(const struct accumulation *accumulation);
/* When nothing is left to draw: rest->frame is not needed any more, and a driver that draws with
 * the processor keeps what each pass was made of, and drew into, until another takes its place. So
 * the sum is shown at the place as often as passes can be in flight. The compiler of shaders
 * is let go as well. */
void accumulation_let_go(struct accumulation *accumulation, const struct gl_place *place);

#endif
