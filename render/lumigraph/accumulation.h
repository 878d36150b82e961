/* While the eye rests, frames moved by parts of a pixel flow into one anti-aliased picture; what
 * still changes (a fade, a finer patch) flows in with them instead of popping. */
#ifndef GOPURA_RENDER_LUMIGRAPH_ACCUMULATION_H
#define GOPURA_RENDER_LUMIGRAPH_ACCUMULATION_H

#include "render/display/gl.h"

enum {
	REST_WINDOW = 6, /* frames that what was before counts for, while the scene changes */
	REST_STALE = 3,  /* and once it does not */
	REST_FRAMES = 12 /* without a change: what was before has a twentieth left */
};

struct rest {
	struct gl_target frame, sum;
	GLuint program;
	uint32_t count; /* frames since the eye came to rest */
	uint32_t same;  /* of them the last that showed the same scene */
};

/* Room for the sum of pictures of that size and, where another is to be drawn, for that; cheap when
 * it is there. On failure pictures are drawn plainly. */
must_check int rest_prepare(struct rest *rest, int width_px, int height_px, bool draws);
void rest_finish(struct rest *rest);
void rest_break(struct rest *rest); /* the eye moved: begin anew */
/* How far the next frame is moved, under a pixel; in the sum the mean is none. changed as for
 * rest_add. */
void rest_offset(const struct rest *rest, bool changed, float *x_px, float *y_px);
/* Adds rest->frame, which was just drawn, and shows the sum at the place given. changed: the
 * scene is not what it was. */
void rest_add(struct rest *rest, const struct gl_place *place, bool changed);
bool rest_is_done(const struct rest *rest);
/* When nothing is left to draw: rest->frame is not needed any more, and a driver that draws with
 * the processor keeps what each pass was made of, and drew into, until another takes its place. So
 * the sum is shown at the place as often as passes can be in flight. The compiler of shaders
 * is let go as well. */
void rest_let_go(struct rest *rest, const struct gl_place *place);

#endif
