#include "render/lumigraph/accumulation.h"

#include <string.h>

/* As many as are in flight: census, depths, picture, sum, words. More only delay the panel. */
enum { PASSES_MOST = 6 };

static const char square_fragment[] = "precision mediump float;\n"
				      "uniform sampler2D u_picture;\n"
				      "varying vec2 v_at;\n"
				      "void main() {\n"
				      "	gl_FragColor = texture2D(u_picture, v_at);\n"
				      "}\n";

static int build(struct rest *rest)
{
	const struct gl_program_source source = {
		.name = "rest",
		.vertex = (const char *const[]){ gl_square_vertex, NULL },
		.fragment = (const char *const[]){ square_fragment, NULL },
		.attributes = gl_square_attributes,
	};
	int rc = gl_program_build(&rest->program, &source);
	if (rc < 0)
		return rc;
	glUseProgram(rest->program);
	glUniform1i(glGetUniformLocation(rest->program, "u_picture"), 0);
	return 0;
}

static int prepare_sum(struct rest *rest, int width_px, int height_px)
{
	if (rest->sum.framebuffer && rest->sum.width_px == width_px &&
	    rest->sum.height_px == height_px)
		return 0;
	rest_finish(rest);
	int rc = build(rest);
	return rc < 0 ? rc : gl_target_create_flat(&rest->sum, width_px, height_px);
}

int rest_prepare(struct rest *rest, int width_px, int height_px, bool draws)
{
	int rc = prepare_sum(rest, width_px, height_px);
	if (rc == 0 && draws && !rest->frame.framebuffer)
		rc = gl_target_create(&rest->frame, width_px, height_px);
	if (rc < 0)
		rest_finish(rest);
	return rc;
}

void rest_finish(struct rest *rest)
{
	gl_target_destroy(&rest->frame);
	gl_target_destroy(&rest->sum);
	if (rest->program)
		glDeleteProgram(rest->program);
	memset(rest, 0, sizeof(*rest));
}

void rest_break(struct rest *rest)
{
	rest->count = rest->same = 0;
}

/* Halton's sequence in bases 2 and 3. */
static float halton(uint32_t index, uint32_t base)
{
	float value = 0, digit = 1;
	for (; index > 0; index /= base) {
		digit /= (float)base;
		value += digit * (float)(index % base);
	}
	return value;
}

/* Of the last frames, as they weigh in the sum. */
static float mean_of_halton(uint32_t base)
{
	float sum = 0, weights = 0;
	for (uint32_t i = 0; i < REST_FRAMES; i++) {
		float weight = (float)(i + REST_STALE + 1);
		sum += weight * halton(i + 1, base);
		weights += weight;
	}
	return sum / weights;
}

void rest_offset(const struct rest *rest, bool changed, float *x_px, float *y_px)
{
	/* The last frames lie alike whenever they began, so one scene has one picture. */
	uint32_t index = (changed ? rest->count : rest->same) % REST_FRAMES + 1;
	*x_px = halton(index, 2) - mean_of_halton(2);
	*y_px = halton(index, 3) - mean_of_halton(3);
}

static void draw_square(const struct rest *rest, GLuint texture)
{
	glUseProgram(rest->program);
	gl_bind_texture(0, texture);
	glDisableVertexAttribArray(1);
	glDisableVertexAttribArray(2);
	gl_draw_square();
}

void rest_add(struct rest *rest, const struct gl_place *place, bool changed)
{
	if (changed)
		rest->same = 0;
	if (!rest_is_done(rest)) {
		uint32_t before = changed ? REST_WINDOW : rest->same + REST_STALE;
		before = rest->count < before ? rest->count : before;
		rest->count++;
		rest->same++;
		gl_target_bind(&rest->sum);
		glDisable(GL_DEPTH_TEST);
		glEnable(GL_BLEND);
		/* Frame n weighs n: what the picture was is soon forgotten, and eight bits do not
		 * swallow the last frames. */
		glBlendColor(0, 0, 0, 2.0f / (float)(before + 2));
		glBlendFunc(GL_CONSTANT_ALPHA, GL_ONE_MINUS_CONSTANT_ALPHA);
		draw_square(rest, rest->frame.colour);
		glDisable(GL_BLEND);
	}
	gl_place_bind(place, rest->sum.width_px, rest->sum.height_px);
	glDisable(GL_DEPTH_TEST);
	draw_square(rest, rest->sum.colour);
}

bool rest_is_done(const struct rest *rest)
{
	return rest->same >= REST_FRAMES;
}

void rest_let_go(struct rest *rest, const struct gl_place *place)
{
	if (!rest->frame.framebuffer)
		return;
	gl_target_destroy(&rest->frame);
	gl_place_bind(place, rest->sum.width_px, rest->sum.height_px);
	glDisable(GL_DEPTH_TEST);
	/* Large ones, so that none is done before all have begun. */
	for (int i = 0; i < PASSES_MOST; i++) {
		draw_square(rest, rest->sum.colour);
		glFlush();
	}
	glFinish();
	glReleaseShaderCompiler(); /* of no use until the next scene */
}
