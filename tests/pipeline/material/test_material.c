/* The stone and the substances in C against their GLSL twins on whatever GLES2 there is here. */
#include "pipeline/material/material.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "base/compiler.h"
#include "geometry/noise.h"
#include "geometry/substance.h"
#include "render/display/gl.h"
#include "render/display/headless.h"
#include "tests/check.h"

enum { SIDE = 64 };

/* A square of surface: a pixel x, y lies at origin + x * right + y * up. */
struct square {
	float origin[3], right[3], up[3], normal[3], footprint_m;
};

static const struct square squares[] = {
	{ { 3, -12, 5 }, { 0.013f, 0, 0 }, { 0, 0, 0.017f }, { 0, -1, 0 }, 0 },
	{ { 18.1f, -4, 0.1f }, { 0, 0.031f, 0 }, { 0, 0, 0.037f }, { 1, 0, 0 }, 0.01f },
	{ { -20, -20, 0 }, { 0.63f, 0, 0 }, { 0, 0.61f, 0 }, { 0, 0, 1 }, 0.3f },
	{ { -7, 6, 8.2f },
	  { 0.11f, 0.07f, 0 },
	  { -0.03f, 0.05f, 0.09f },
	  { 0.36f, -0.48f, 0.8f },
	  0 },
	{ { 400, -300, 20 }, { 0.25f, 0, 0 }, { 0, 0.25f, 0.5f }, { 0, -0.8f, 0.6f }, 0.05f },
};

static const char *const corner[] = { "corner", NULL };
static const char *const vertex[] = {
	"attribute vec2 corner;\nvoid main() { gl_Position = vec4(corner, 0.0, 1.0); }\n", NULL
};
static const char *const fragment[] = {
	"precision highp float;\nuniform vec3 origin, right, up, normal;\nuniform float footprint;\n",
	noise_glsl, material_glsl,
	"void main() {\n"
	"	vec2 at = floor(gl_FragCoord.xy);\n"
	"	vec3 p = (origin + at.x * right) + at.y * up;\n"
	"	gl_FragColor = vec4(material_colour(p, normal, footprint), 1.0);\n"
	"}\n",
	NULL
};

static void draw(GLuint program, const struct square *s)
{
	static const float strip[] = { -1, -1, 1, -1, -1, 1, 1, 1 };

	glUseProgram(program);
	glUniform3fv(glGetUniformLocation(program, "origin"), 1, s->origin);
	glUniform3fv(glGetUniformLocation(program, "right"), 1, s->right);
	glUniform3fv(glGetUniformLocation(program, "up"), 1, s->up);
	glUniform3fv(glGetUniformLocation(program, "normal"), 1, s->normal);
	glUniform1f(glGetUniformLocation(program, "footprint"), s->footprint_m);
	glBindBuffer(GL_ARRAY_BUFFER, 0);
	glVertexAttribPointer(0, 2, GL_FLOAT, GL_FALSE, 0, strip);
	glEnableVertexAttribArray(0);
	glDrawArrays(GL_TRIANGLE_STRIP, 0, 4);
}

/* substance: SUBSTANCE_NONE is the weathered stone. */
static void material_at(const struct square *s, enum substance_kind substance, int x, int y,
			float rgb[3])
{
	float p[3];

	for (int k = 0; k < 3; k++)
		p[k] = (s->origin[k] + (float)x * s->right[k]) + (float)y * s->up[k];
	if (substance == SUBSTANCE_NONE)
		material_colour(rgb, p, s->normal, s->footprint_m);
	else
		substance_colour(rgb, substance, p, s->footprint_m);
}

/* Of the pixels that differ by more than 2 of 255: rounding may move a joint by a pixel, no more.
 */
static int differing(const struct square *s, enum substance_kind substance, const uint8_t *rgba)
{
	int count = 0;

	for (int y = 0; y < SIDE; y++) {
		for (int x = 0; x < SIDE; x++) {
			const uint8_t *pixel = rgba + 4 * ((SIDE - 1 - y) * SIDE + x);
			float rgb[3], worst = 0;
			material_at(s, substance, x, y, rgb);
			for (int k = 0; k < 3; k++)
				worst = fmaxf(worst, fabsf(fminf(fmaxf(rgb[k], 0), 1) * 255 -
							   (float)pixel[k]));
			count += worst > 2;
		}
	}
	return count;
}

static void compare(const char *const *fragments, enum substance_kind substance,
		    size_t square_count)
{
	const struct gl_program_source source = { "stone", vertex, fragments, corner };
	uint8_t *rgba = malloc(4 * SIDE * SIDE);
	struct gl_target target;
	GLuint program;

	CHECK(rgba != NULL);
	CHECK(gl_program_build(&program, &source) == 0);
	CHECK(gl_target_create(&target, SIDE, SIDE) == 0);
	for (size_t i = 0; i < square_count; i++) {
		draw(program, &squares[i]);
		CHECK(gl_target_read(&target, rgba) == 0);
		int count = differing(&squares[i], substance, rgba);
		if (count > SIDE * SIDE / 100)
			fail_msg("%s, square %zu: %d of %d pixels differ",
				 substance_names[substance], i, count, SIDE * SIDE);
	}
	gl_target_destroy(&target);
	glDeleteProgram(program);
	free(rgba);
}

static void agrees_with_its_twin(void **state)
{
	struct headless *headless;
	(void)state;

	CHECK(headless_create(&headless) == 0);
	compare(fragment, SUBSTANCE_NONE, ARRAY_COUNT(squares));
	headless_destroy(headless);
}

/* The last square is too far away for their finest detail. */
static void substances_agree_with_their_twins(void **state)
{
	struct headless *headless;
	(void)state;

	CHECK(headless_create(&headless) == 0);
	for (int kind = SUBSTANCE_NONE + 1; kind < SUBSTANCE_KINDS; kind++) {
		char body[400];
		const char *const fragments[] = { fragment[0], noise_glsl, substance_glsl, body,
						  NULL };

		snprintf(body, sizeof(body),
			 "void main() {\n"
			 "	vec2 at = floor(gl_FragCoord.xy);\n"
			 "	vec3 p = (origin + at.x * right) + at.y * up;\n"
			 "	gl_FragColor = vec4(%s_colour(p.x, p.y, p.z, footprint), 1.0);\n"
			 "}\n",
			 substance_names[kind]);
		compare(fragments, (enum substance_kind)kind, ARRAY_COUNT(squares) - 1);
	}
	headless_destroy(headless);
}

/* With every number of places up to one more than vectors are wide. */
static void is_the_same_for_many_places_at_once(void **state)
{
	enum { COUNT = 33 };
	static float x[COUNT], y[COUNT], z[COUNT], nx[COUNT], ny[COUNT], nz[COUNT], size[COUNT];
	static float block[4][COUNT], detail[2][COUNT], rgb[3][COUNT];
	const struct material_blocks blocks = { block[0], block[1], block[2], block[3] };
	float *const colours[3] = { rgb[0], rgb[1], rgb[2] };

	(void)state;
	for (size_t i = 0; i < COUNT; i++) {
		const struct square *s = &squares[i % ARRAY_COUNT(squares)];

		x[i] = s->origin[0] + 0.37f * (float)i;
		y[i] = s->origin[1] + 0.11f * (float)i;
		z[i] = s->origin[2] + 0.05f * (float)i;
		nx[i] = s->normal[0];
		ny[i] = s->normal[1];
		nz[i] = s->normal[2];
		size[i] = s->footprint_m;
	}
	for (uint32_t count = 0; count <= COUNT; count++) {
		const struct material_places places = { count, x, y, z, nx, ny, nz, size };

		material_details(detail[0], &places, 23);
		material_details(detail[1], &places, 97);
		material_blocks(&blocks, &places);
		material_paints(colours, &places, &blocks, detail[0], detail[1]);
		for (uint32_t i = 0; i < count; i++) {
			float one[3];

			material_colour(one, (float[3]){ x[i], y[i], z[i] },
					(float[3]){ nx[i], ny[i], nz[i] }, size[i]);
			for (int c = 0; c < 3; c++)
				CHECK(memcmp(&one[c], &rgb[c][i], sizeof(float)) == 0);
		}
	}
}

static void is_a_colour_with_detail_down_to_a_centimetre(void **state)
{
	const struct square *wall = &squares[0];
	float near_sum = 0, coarse_sum = 0;

	(void)state;
	for (int i = 0; i < 400; i++) {
		float p[3] = { 3 + 0.05f * (float)i, -12, 5 }, q[3] = { p[0] + 0.01f, -12, 5 };
		float a[3], b[3];
		material_colour(a, p, wall->normal, 0);
		material_colour(b, q, wall->normal, 0);
		near_sum += fabsf(a[0] - b[0]);
		for (int k = 0; k < 3; k++)
			CHECK(a[k] >= -0.05f && a[k] <= 1.3f);
		material_colour(a, p, wall->normal, 0.5f);
		material_colour(b, q, wall->normal, 0.5f);
		coarse_sum += fabsf(a[0] - b[0]);
	}
	CHECK(near_sum > 400 * 0.01f);       /* a centimetre further is another colour */
	CHECK(coarse_sum < 0.4f * near_sum); /* but not for a pixel of half a metre */
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(agrees_with_its_twin),
		cmocka_unit_test(substances_agree_with_their_twins),
		cmocka_unit_test(is_the_same_for_many_places_at_once),
		cmocka_unit_test(is_a_colour_with_detail_down_to_a_centimetre),
	};

	return cmocka_run_group_tests(tests, NULL, NULL);
}
