/* Keeps the mask of the marked part, and draws the line around it. */
#include "render/lumigraph/outline.h"

#include <math.h>
#include <string.h>

enum {
	LINE_PX = 4,            /* no pixel of the line is farther from the part */
	MASK_PX = LINE_PX + 36, /* no pixel of the mask that the line depends on */
	/* Pixels of what is shown to a pixel of the two blurred masks, in each direction. */
	SOFT_PX = 2,
	CLOSED_PX = 4,
};

/* The mean of four points of a mask, of which a range is spread to 0..1. */
static const char mean_fragment[] =
	"uniform sampler2D u_mask;\n"
	"uniform FINE vec2 u_step;\n" /* from the middle to the points */
	"uniform FINE vec2 u_scale;\n"
	"uniform vec2 u_range;\n"
	"varying FINE vec2 v_at;\n"
	"void main() {\n"
	"	FINE vec2 at = v_at * u_scale;\n"
	"	FINE vec2 down = u_step, up = vec2(u_step.x, -u_step.y);\n"
	"	float mean = 0.25 * (texture2D(u_mask, at - down).r + texture2D(u_mask, at + down).r +\n"
	"			     texture2D(u_mask, at - up).r + texture2D(u_mask, at + up).r);\n"
	"	mean = (mean - u_range.x) / (u_range.y - u_range.x);\n"
	"	gl_FragColor = vec4(clamp(mean, 0.0, 1.0));\n"
	"}\n";

/* What closes narrow openings, at a quarter of the size. Where the share of the part around a pixel
 * is over a tenth the part grows, by about five pixels, and where it is then over nine tenths it
 * shrinks by a little more: a straight border ends inside the line of the mask itself. */
static const struct outline_step {
	float step_px;
	float range[2];
} reduce = { 1, { 0, 1 } }, grow = { 5, { 0.06f, 0.14f } }, shrink = { 5, { 0.92f, 0.99f } },
  soften = { 1, { 0.1f, 0.95f } };

/* Blurs the mask to half the size of what is shown by a kernel that is close to a Gaussian, and
 * adds what was closed. Where the mask has that size itself, each of the 16 points lies between
 * four pixels, whose mean it is. */
static const char soft_fragment[] =
	"uniform sampler2D u_mask, u_closed;\n"
	"uniform FINE vec2 u_step;\n" /* from a pixel of what is shown to the next */
	"uniform FINE vec2 u_scale, u_closed_scale;\n"
	"varying FINE vec2 v_at;\n"
	"vec4 row(FINE float y) {\n"
	"	FINE vec2 at = v_at * u_scale + vec2(0.0, y) * u_step;\n"
	"	FINE vec2 near = vec2(u_step.x, 0.0), far = 3.0 * near;\n"
	"	return vec4(texture2D(u_mask, at - far).r, texture2D(u_mask, at - near).r,\n"
	"		    texture2D(u_mask, at + near).r, texture2D(u_mask, at + far).r);\n"
	"}\n"
	"void main() {\n"
	"	const vec4 weights = vec4(0.118, 0.382, 0.382, 0.118);\n"
	"	vec4 sum = 0.382 * (row(-1.0) + row(1.0)) + 0.118 * (row(-3.0) + row(3.0));\n"
	"	float closed = texture2D(u_closed, v_at * u_closed_scale).r;\n"
	"	gl_FragColor = vec4(max(dot(sum, weights), closed));\n"
	"}\n";

/* The blur's standard deviation is 1.95 pixels. On a straight border the share of the
 * part is a half, 2.2 pixels from it 0.13, 2.85 pixels from it 0.07, in any direction. A speck of a
 * pixel reaches 0.04 and has no line. */
static const char line_fragment[] =
	"uniform sampler2D u_mask;\n"
	"uniform FINE vec2 u_scale;\n"
	"varying FINE vec2 v_at;\n"
	"void main() {\n"
	"	float within = texture2D(u_mask, v_at * u_scale).r;\n"
	"	float line = smoothstep(0.07, 0.13, min(within, 1.0 - within));\n"
	"	gl_FragColor = vec4(1.0, 0.78, 0.25, max(line, within > 0.5 ? 0.14 : 0.0));\n"
	"}\n";

static int build(struct outline_program *out, const char *name, const char *fragment)
{
	const struct gl_program_source source = {
		.name = name,
		.vertex = (const char *const[]){ gl_square_vertex, NULL },
		.fragment = (const char *const[]){ gl_fine_fragment, fragment, NULL },
		.attributes = gl_square_attributes,
	};
	int rc = gl_program_build(&out->program, &source);
	if (rc < 0)
		return rc;
	glUseProgram(out->program);
	glUniform1i(glGetUniformLocation(out->program, "u_mask"), 0);
	glUniform1i(glGetUniformLocation(out->program, "u_closed"), 1);
	out->step = glGetUniformLocation(out->program, "u_step");
	out->range = glGetUniformLocation(out->program, "u_range");
	out->scale = glGetUniformLocation(out->program, "u_scale");
	out->closed_scale = glGetUniformLocation(out->program, "u_closed_scale");
	return 0;
}

int outline_init(struct outline *outline)
{
	memset(outline, 0, sizeof(*outline));
	outline_clear(outline);
	int rc = build(&outline->line, "outline", line_fragment);
	if (rc == 0)
		rc = build(&outline->blur, "outline blur", soft_fragment);
	return rc < 0 ? rc : build(&outline->mean, "outline mean", mean_fragment);
}

void outline_let_go(struct outline *outline)
{
	gl_target_destroy(&outline->mask);
	gl_target_destroy(&outline->soft);
	gl_target_destroy(&outline->closed);
	gl_target_destroy(&outline->aside);
}

void outline_finish(struct outline *outline)
{
	outline_let_go(outline);
	struct outline_program *programs[] = { &outline->line, &outline->blur, &outline->mean };
	for (int i = 0; i < 3; i++)
		if (programs[i]->program)
			glDeleteProgram(programs[i]->program);
	memset(outline, 0, sizeof(*outline));
}

/* ---- where the part may be */

void outline_clear(struct outline *outline)
{
	for (int k = 0; k < 2; k++) {
		outline->low[k] = 1;
		outline->high[k] = -1;
	}
}

bool outline_is_empty(const struct outline *outline)
{
	return outline->low[0] >= outline->high[0] || outline->low[1] >= outline->high[1];
}

void outline_include(struct outline *outline, const struct view *view, const float centre_m[3],
		     float radius_m)
{
	const float *clip = view->clip, *eye = view->eye_m;
	const float to[3] = { centre_m[0] - eye[0], centre_m[1] - eye[1], centre_m[2] - eye[2] };
	const float w = clip[3] * to[0] + clip[7] * to[1] + clip[11] * to[2] + clip[15];
	for (int k = 0; k < 2; k++) {
		float x =
			clip[k] * to[0] + clip[4 + k] * to[1] + clip[8 + k] * to[2] + clip[12 + k];
		float scale = hypotf(hypotf(clip[k], clip[4 + k]), clip[8 + k]);
		float reach = 2;
		if (w > 1.01f * radius_m)
			reach = radius_m * (scale + fabsf(x / w)) / (w - radius_m);
		float low = w > 1.01f * radius_m ? x / w - reach : -1;
		float high = w > 1.01f * radius_m ? x / w + reach : 1;
		outline->low[k] = fmaxf(-1, fminf(outline->low[k], low));
		outline->high[k] = fminf(1, fmaxf(outline->high[k], high));
	}
}

/* Limits drawing to the rectangle, enlarged by margin_px, of a picture at a place. */
static void limit(const struct outline *outline, const struct gl_place *place, int width_px,
		  int height_px, int margin_px)
{
	const int size[2] = { width_px, height_px };
	int low[2], high[2];
	for (int k = 0; k < 2; k++) {
		low[k] = (int)floorf((outline->low[k] / 2 + 0.5f) * (float)size[k]) - margin_px;
		high[k] = (int)ceilf((outline->high[k] / 2 + 0.5f) * (float)size[k]) + margin_px;
		low[k] = low[k] > 0 ? low[k] : 0;
		high[k] = high[k] < size[k] ? high[k] : size[k];
	}
	glEnable(GL_SCISSOR_TEST);
	glScissor(place->x_px + low[0], place->y_px + low[1], high[0] - low[0], high[1] - low[1]);
}

/* ---- the mask */

static int create_linear(struct gl_target *out, int width_px, int height_px)
{
	int rc = gl_target_create_flat(out, width_px, height_px);
	if (rc == 0)
		gl_target_smooth(out);
	return rc;
}

static int create_share(const struct outline *outline, struct gl_target *out, int share_px)
{
	return create_linear(out, (outline->width_px + share_px - 1) / share_px,
			     (outline->height_px + share_px - 1) / share_px);
}

static int prepare_masks(struct outline *outline, const struct gl_target *picture, int width_px,
			 int height_px)
{
	if (outline->mask.framebuffer && outline->mask.width_px == picture->width_px &&
	    outline->mask.height_px == picture->height_px && outline->width_px == width_px &&
	    outline->height_px == height_px)
		return 0;
	outline_let_go(outline);
	outline->width_px = width_px;
	outline->height_px = height_px;
	int rc = create_linear(&outline->mask, picture->width_px, picture->height_px);
	if (rc == 0)
		rc = create_share(outline, &outline->soft, SOFT_PX);
	if (rc == 0)
		rc = create_share(outline, &outline->closed, CLOSED_PX);
	if (rc == 0)
		rc = create_share(outline, &outline->aside, CLOSED_PX);
	if (rc < 0)
		outline_let_go(outline);
	return rc;
}

int outline_begin(struct outline *outline, const struct gl_target *picture, int width_px,
		  int height_px)
{
	int rc = prepare_masks(outline, picture, width_px, height_px);
	if (rc < 0)
		return rc;
	gl_target_bind(&outline->mask);
	if (picture->depths)
		glFramebufferTexture2D(GL_FRAMEBUFFER, GL_DEPTH_ATTACHMENT, GL_TEXTURE_2D,
				       picture->depths, 0);
	else
		glFramebufferRenderbuffer(GL_FRAMEBUFFER, GL_DEPTH_ATTACHMENT, GL_RENDERBUFFER,
					  picture->depth);
	const struct gl_place all = { .framebuffer = outline->mask.framebuffer };
	limit(outline, &all, picture->width_px, picture->height_px, MASK_PX);
	glClearColor(0, 0, 0, 0);
	glClear(GL_COLOR_BUFFER_BIT);
	glEnable(GL_DEPTH_TEST);
	glDepthFunc(GL_LEQUAL);
	glDepthMask(GL_FALSE);
	return 0;
}

static void draw_square(GLuint texture)
{
	gl_bind_texture(0, texture);
	glDisableVertexAttribArray(1);
	glDisableVertexAttribArray(2);
	gl_draw_square();
}

/* How much of what is shown a mask covers; the blurred ones may reach beyond it. */
static void find_extent(const struct outline *outline, const struct gl_target *mask, float out[2])
{
	const int share_px = mask == &outline->soft ? SOFT_PX : CLOSED_PX;
	const bool whole = mask == &outline->mask;
	out[0] = (float)(whole ? outline->width_px : share_px * mask->width_px);
	out[1] = (float)(whole ? outline->height_px : share_px * mask->height_px);
}

/* Sets the factor from coordinates of what covers an extent to those of a mask. */
static void set_scale(const struct outline *outline, GLint uniform, const float extent[2],
		      const struct gl_target *mask)
{
	float covered[2];
	find_extent(outline, mask, covered);
	glUniform2f(uniform, extent[0] / covered[0], extent[1] / covered[1]);
}

/* Draws into to what a program makes of from. */
static void make(const struct outline *outline, const struct outline_program *program,
		 const struct gl_target *from, const struct gl_target *to, float step_px)
{
	const struct gl_place all = { .framebuffer = to->framebuffer };
	float read[2], written[2];
	find_extent(outline, from, read);
	find_extent(outline, to, written);
	gl_target_bind(to);
	limit(outline, &all, to->width_px, to->height_px,
	      MASK_PX / (to == &outline->soft ? SOFT_PX : CLOSED_PX));
	glUniform2f(program->step, step_px / read[0], step_px / read[1]);
	set_scale(outline, program->scale, written, from);
	draw_square(from->colour);
}

static void close_openings(const struct outline *outline)
{
	const struct gl_target *closed = &outline->closed, *aside = &outline->aside;
	const struct {
		const struct gl_target *from, *to;
		const struct outline_step *step;
	} turns[] = { { &outline->mask, aside, &reduce },
		      { aside, closed, &grow },
		      { closed, aside, &shrink },
		      { aside, closed, &soften } };
	glUseProgram(outline->mean.program);
	for (size_t i = 0; i < sizeof(turns) / sizeof(turns[0]); i++) {
		const float *range = turns[i].step->range;
		glUniform2f(outline->mean.range, range[0], range[1]);
		make(outline, &outline->mean, turns[i].from, turns[i].to, turns[i].step->step_px);
	}
}

static void blur(const struct outline *outline)
{
	float written[2];
	find_extent(outline, &outline->soft, written);
	glUseProgram(outline->blur.program);
	set_scale(outline, outline->blur.closed_scale, written, &outline->closed);
	gl_bind_texture(1, outline->closed.colour);
	make(outline, &outline->blur, &outline->mask, &outline->soft, 1);
}

void outline_end(struct outline *outline)
{
	/* The picture's depth may be freed before the mask. */
	glFramebufferRenderbuffer(GL_FRAMEBUFFER, GL_DEPTH_ATTACHMENT, GL_RENDERBUFFER, 0);
	glDepthMask(GL_TRUE);
	glDepthFunc(GL_LESS);
	glDisable(GL_DEPTH_TEST);
	close_openings(outline);
	blur(outline);
	glEnable(GL_DEPTH_TEST);
	glDisable(GL_SCISSOR_TEST);
}

void outline_draw(const struct outline *outline, const struct gl_place *place, int width_px,
		  int height_px)
{
	if (outline_is_empty(outline) || !outline->mask.framebuffer)
		return;
	const float shown[2] = { (float)outline->width_px, (float)outline->height_px };
	gl_place_bind(place, width_px, height_px);
	limit(outline, place, width_px, height_px, LINE_PX);
	glDisable(GL_DEPTH_TEST);
	glEnable(GL_BLEND);
	/* Keep the alpha (coverage) that the surface wrote. */
	glBlendFuncSeparate(GL_SRC_ALPHA, GL_ONE_MINUS_SRC_ALPHA, GL_ZERO, GL_ONE);
	glUseProgram(outline->line.program);
	set_scale(outline, outline->line.scale, shown, &outline->soft);
	draw_square(outline->soft.colour);
	glDisable(GL_BLEND);
	glDisable(GL_SCISSOR_TEST);
	glEnable(GL_DEPTH_TEST);
}
