/* While the eye rests, frames moved by parts of a pixel add up to an anti-aliased picture; what
 * still changes (a fade, a finer patch) flows in instead of popping. */
#ifndef GOPURA_RENDER_REST_H
#define GOPURA_RENDER_REST_H

#include "render/gl.h"

enum { REST_FRAMES = 8 };

struct rest {
	struct gl_target frame, sum;
	GLuint program;
	uint32_t count; /* frames in the sum */
};

/* Room for pictures of that size; cheap when it is there. On failure pictures are drawn plainly. */
must_check int rest_prepare(struct rest *rest, int width_px, int height_px);
void rest_finish(struct rest *rest);
void rest_break(struct rest *rest); /* the eye moved: begin anew */
/* Where the next frame lies within its pixel, -0.5..0.5. */
void rest_offset(const struct rest *rest, float *x_px, float *y_px);
/* Adds rest->frame, which was just drawn, and shows the sum in the framebuffer given. changed: the
 * scene is not what it was; then old frames lose weight. */
void rest_add(struct rest *rest, GLuint framebuffer, bool changed);
bool rest_is_done(const struct rest *rest);

#endif
