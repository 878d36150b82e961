/* Adds jittered frames to a sum by blending with falling weights, and draws the sum. */
#include "render/lumigraph/accumulation.h"

#include <string.h>

/* As many passes as can be in flight: visibility pass, depths, picture, sum, overlay. More would
 * only delay the panel. */
enum { PASSES_MAX = 6 };

static int prepare_sum(struct accumulation *accumulation, int width_px, int height_px)
{
	if (accumulation->sum.framebuffer && accumulation->sum.width_px == width_px &&
	    accumulation->sum.height_px == height_px)
		return 0;
	accumulation_finish(accumulation);
	int rc = gl_copy_build(&accumulation->program);
	return rc < 0 ? rc : gl_target_create_flat(&accumulation->sum, width_px, height_px);
}

int accumulation_prepare(struct accumulation *accumulation, int width_px, int height_px, bool draws)
{
	int rc = prepare_sum(accumulation, width_px, height_px);
	if (rc == 0 && draws && !accumulation->frame.framebuffer)
		rc = gl_target_create(&accumulation->frame, width_px, height_px);
	if (rc < 0)
		accumulation_finish(accumulation);
	return rc;
}

void accumulation_finish(struct accumulation *accumulation)
{
	gl_target_destroy(&accumulation->frame);
	gl_target_destroy(&accumulation->sum);
	if (accumulation->program)
		glDeleteProgram(accumulation->program);
	memset(accumulation, 0, sizeof(*accumulation));
}

void accumulation_break(struct accumulation *accumulation)
{
	accumulation->count = accumulation->same = 0;
}

/* The Halton sequence in bases 2 and 3. */
static float halton(uint32_t index, uint32_t base)
{
	float value = 0, digit = 1;
	for (; index > 0; index /= base) {
		digit /= (float)base;
		value += digit * (float)(index % base);
	}
	return value;
}

/* Returns the mean of the last frames' offsets with their weights in the sum. */
static float mean_of_halton(uint32_t base)
{
	float sum = 0, weights = 0;
	for (uint32_t i = 0; i < ACCUMULATION_FRAMES; i++) {
		float weight = (float)(i + ACCUMULATION_STALE + 1);
		sum += weight * halton(i + 1, base);
		weights += weight;
	}
	return sum / weights;
}

void accumulation_offset(const struct accumulation *accumulation, bool changed, float *x_px,
			 float *y_px)
{
	/* The last frames have the same offsets whenever they began, so one scene always gives one
	 * picture. */
	uint32_t index =
		(changed ? accumulation->count : accumulation->same) % ACCUMULATION_FRAMES + 1;
	*x_px = halton(index, 2) - mean_of_halton(2);
	*y_px = halton(index, 3) - mean_of_halton(3);
}

void accumulation_add(struct accumulation *accumulation, const struct gl_place *place, bool changed)
{
	if (changed)
		accumulation->same = 0;
	if (!accumulation_is_done(accumulation)) {
		uint32_t before = accumulation->same + ACCUMULATION_STALE;
		before = accumulation->count < before ? accumulation->count : before;
		accumulation->count++;
		accumulation->same++;
		gl_target_bind(&accumulation->sum);
		glEnable(GL_BLEND);
		/* Frame n has weight n: the previous picture fades out soon, and 8 bits per channel
		 * still resolve the last frames. */
		glBlendColor(0, 0, 0, 2.0f / (float)(before + 2));
		glBlendFunc(GL_CONSTANT_ALPHA, GL_ONE_MINUS_CONSTANT_ALPHA);
		gl_copy_draw(accumulation->program, accumulation->frame.colour);
		glDisable(GL_BLEND);
	}
	accumulation_show_sum(accumulation, place);
}

void accumulation_show_sum(const struct accumulation *accumulation, const struct gl_place *place)
{
	gl_place_bind(place, accumulation->sum.width_px, accumulation->sum.height_px);
	gl_copy_draw(accumulation->program, accumulation->sum.colour);
}

void accumulation_show_frame(const struct accumulation *accumulation, const struct gl_place *place)
{
	gl_place_bind(place, accumulation->frame.width_px, accumulation->frame.height_px);
	gl_copy_draw(accumulation->program, accumulation->frame.colour);
}

bool accumulation_is_done(const struct accumulation *accumulation)
{
	return accumulation->same >= ACCUMULATION_FRAMES;
}

void accumulation_let_go(struct accumulation *accumulation, const struct gl_place *place)
{
	if (!accumulation->frame.framebuffer)
		return;
	gl_target_destroy(&accumulation->frame);
	gl_place_bind(place, accumulation->sum.width_px, accumulation->sum.height_px);
	/* Full-size passes, so that none ends before all have begun. */
	for (int i = 0; i < PASSES_MAX; i++) {
		gl_copy_draw(accumulation->program, accumulation->sum.colour);
		glFlush();
	}
	gl_finish();
	glReleaseShaderCompiler(); /* not needed until the next scene */
}
