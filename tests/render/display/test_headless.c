/* The headless context, the GL helpers, and the light function on the GPU against its C twin. */
#include <errno.h>
#include <math.h>
#include <stdlib.h>

#include "geometry/light.h"
#include "render/display/gl.h"
#include "render/display/headless.h"
#include "tests/check.h"

static const char *const no_parts[] = { NULL };
static const char *const corner[] = { "corner", NULL };
static const char *const plain_vertex[] = {
	"attribute vec2 corner; varying vec2 at;\n"
	"void main() { at = corner; gl_Position = vec4(corner, 0.0, 1.0); }\n",
	NULL
};

static int start(void **state)
{
	return headless_create((struct headless **)state);
}

static int stop(void **state)
{
	headless_destroy(*state);
	return 0;
}

static void draw_all(GLuint program)
{
	static const float strip[] = { -1, -1, 1, -1, -1, 1, 1, 1 };

	glUseProgram(program);
	glBindBuffer(GL_ARRAY_BUFFER, 0);
	glVertexAttribPointer(0, 2, GL_FLOAT, GL_FALSE, 0, strip);
	glEnableVertexAttribArray(0);
	glDrawArrays(GL_TRIANGLE_STRIP, 0, 4);
}

static void draws_and_reads_with_the_top_first(void **state)
{
	static const char *const fragment[] = {
		"precision highp float; varying vec2 at;\n",
		"void main() { gl_FragColor = vec4(at * 0.5 + 0.5, 1.0, 0.5); }\n", NULL
	};
	const struct gl_program_source source = { "ramp", plain_vertex, fragment, corner };
	struct gl_target target;
	GLuint program;
	uint8_t *rgba = malloc(64 * 32 * 4);

	(void)state;
	CHECK(gl_target_create(&target, 64, 32) == 0);
	CHECK(gl_program_build(&program, &source) == 0);
	draw_all(program);
	CHECK(gl_target_read(&target, rgba) == 0);
	for (int y = 0; y < 32; y++) {
		for (int x = 0; x < 64; x++) {
			const uint8_t *p = rgba + 4 * (y * 64 + x);

			CHECK(abs(p[0] - (int)(255 * (x + 0.5) / 64 + 0.5)) <= 1);
			CHECK(abs(p[1] - (int)(255 * (31.5 - y) / 32 + 0.5)) <= 1);
			CHECK(p[2] == 255 && (p[3] == 127 || p[3] == 128));
		}
	}
	glDeleteProgram(program);
	gl_target_destroy(&target);
	free(rgba);
}

static void lights_as_its_twin_in_c(void **state)
{
	static const char *const fragment[] = {
		"precision highp float; uniform vec3 normal; uniform vec3 sun; uniform float open;\n",
		light_glsl,
		"void main() { gl_FragColor = vec4(light(normal, open, sun) * 0.5); }\n", NULL
	};
	const struct gl_program_source source = { "light", plain_vertex, fragment, corner };
	const float sun[3] = { 0.48f, -0.6f, 0.64f };
	struct gl_target target;
	GLuint program;

	(void)state;
	CHECK(gl_target_create(&target, 1, 1) == 0);
	CHECK(gl_program_build(&program, &source) == 0);
	for (int i = 0; i < 60; i++) {
		float z = (float)i / 30 - 1, r = sqrtf(1 - z * z), a = (float)i;
		float normal[3] = { r * cosf(a), r * sinf(a), z }, open = (float)(i % 7) / 6;
		uint8_t rgba[4];

		glUseProgram(program);
		glUniform3fv(glGetUniformLocation(program, "normal"), 1, normal);
		glUniform3fv(glGetUniformLocation(program, "sun"), 1, sun);
		glUniform1f(glGetUniformLocation(program, "open"), open);
		draw_all(program);
		CHECK(gl_target_read(&target, rgba) == 0);
		CHECK(fabsf((float)rgba[0] - 127.5f * light_at(normal, open, sun)) < 0.6f);
	}
	glDeleteProgram(program);
	gl_target_destroy(&target);
}

static void refuses_bad_shaders(void **state)
{
	static const char *const broken[] = { "void main() { gl_FragColor = nothing; }\n", NULL };
	const struct gl_program_source source = { "broken", plain_vertex, broken, corner };
	const struct gl_program_source empty = { "empty", no_parts, no_parts, corner };
	GLuint program = 1;

	(void)state;
	CHECK(gl_program_build(&program, &source) == -EINVAL && program == 0);
	CHECK(gl_program_build(&program, &empty) == -EINVAL && program == 0);
	CHECK(glGetError() == GL_NO_ERROR);
}

static void refuses_more_than_every_board_has(void **state)
{
	static const char *const nine_units[] = {
		"precision mediump float; uniform sampler2D t[9]; varying vec2 at;\n"
		"void main() { gl_FragColor = texture2D(t[0], at) + texture2D(t[1], at)\n"
		" + texture2D(t[2], at) + texture2D(t[3], at) + texture2D(t[4], at)\n"
		" + texture2D(t[5], at) + texture2D(t[6], at) + texture2D(t[7], at)\n"
		" + texture2D(t[8], at); }\n",
		NULL
	};
	static const char *const much[] = {
		"precision mediump float; uniform vec4 v[17]; varying vec2 at;\n"
		"void main() { gl_FragColor = v[0] + v[16] * at.x; }\n",
		NULL
	};
	const struct gl_program_source nine = { "nine", plain_vertex, nine_units, corner };
	const struct gl_program_source large = { "large", plain_vertex, much, corner };
	struct gl_texture_options odd = { .width_px = 100,
					  .height_px = 64,
					  .format = GL_RGB,
					  .filter = GL_LINEAR,
					  .mipmaps = true };
	GLuint out;

	(void)state;
	CHECK(gl_program_build(&out, &nine) == -E2BIG);
	CHECK(gl_program_build(&out, &large) == -E2BIG);
	CHECK(gl_texture_create(&out, &odd) == -EINVAL);
	odd.mipmaps = false;
	CHECK(gl_texture_create(&out, &odd) == 0);
	glDeleteTextures(1, &out);
	odd.width_px = GL_LIMIT_TEXTURE_PX + 1;
	CHECK(gl_texture_create(&out, &odd) == -EINVAL);
}

static void reports_errors_once(void **state)
{
	(void)state;
	glEnable(0xdead);
	CHECK(gl_check("enabling nonsense") == -EIO);
	CHECK(gl_check("doing nothing") == 0);
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(draws_and_reads_with_the_top_first),
		cmocka_unit_test(lights_as_its_twin_in_c),
		cmocka_unit_test(refuses_bad_shaders),
		cmocka_unit_test(refuses_more_than_every_board_has),
		cmocka_unit_test(reports_errors_once),
	};

	return cmocka_run_group_tests(tests, start, stop);
}
