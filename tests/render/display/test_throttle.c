/* What a driver that draws on the processor keeps of triangles that it has not drawn yet. */
#include "render/display/throttle.h"

#include <fcntl.h>
#include <stdio.h>
#include <stdlib.h>
#include <unistd.h>

#include "render/display/driver.h"
#include "render/display/gl.h"
#include "render/display/headless.h"
#include "tests/check.h"

enum { SIDE_PX = 1024, DRAW_TRIANGLES = 2000, DRAWS = 200, MOST_KIB = 16 << 10 };

struct world {
	struct headless *headless;
	struct gl_target target;
	GLuint program, vertices;
	struct throttle throttle;
};

/* Six varyings, as a surface of four faces has nearly; slow to colour. */
static const char *const vertex[] = {
	"attribute vec2 corner;\n"
	"varying vec4 a, b, c, d, e, f;\n"
	"void main() {\n"
	"	a = corner.xyxy; b = a + 0.1; c = a + 0.2; d = a + 0.3; e = a + 0.4; f = a + 0.5;\n"
	"	gl_Position = vec4(corner, 0.0, 1.0);\n"
	"}\n",
	NULL
};
static const char *const fragment[] = {
	gl_fine_fragment,
	"varying vec4 a, b, c, d, e, f;\n"
	"void main() { gl_FragColor = sin(a) * cos(b) + sin(c) * cos(d) + sin(e) * cos(f); }\n",
	NULL
};
static const char *const attributes[] = { "corner", NULL };

/* Triangles of some 16 x 16 pixels, all over the target. */
static int make_triangles(GLuint *out)
{
	float *corners = malloc(DRAW_TRIANGLES * 6 * sizeof(*corners));
	if (!corners)
		return -1;
	for (int i = 0; i < DRAW_TRIANGLES; i++) {
		const float x = -1 + 2.0f * (float)(i % 50) / 50;
		const float y = -1 + 2.0f * (float)(i / 50) / 40;
		const float at[] = { x, y, x + 0.04f, y, x, y + 0.04f };
		for (int k = 0; k < 6; k++)
			corners[6 * i + k] = at[k];
	}
	glGenBuffers(1, out);
	glBindBuffer(GL_ARRAY_BUFFER, *out);
	glBufferData(GL_ARRAY_BUFFER, DRAW_TRIANGLES * 6 * sizeof(*corners), corners,
		     GL_STATIC_DRAW);
	free(corners);
	return 0;
}

static int set_up(void **state)
{
	static struct world world;
	const struct gl_program_source source = { "test", vertex, fragment, attributes };
	world = (struct world){ 0 };
	*state = &world;
	if (headless_create(&world.headless) < 0 ||
	    gl_target_create(&world.target, SIDE_PX, SIDE_PX) < 0 ||
	    gl_program_build(&world.program, &source) < 0)
		return -1;
	return make_triangles(&world.vertices);
}

static int tear_down(void **state)
{
	struct world *world = *state;
	glDeleteProgram(world->program);
	glDeleteBuffers(1, &world->vertices);
	gl_target_destroy(&world->target);
	headless_destroy(world->headless);
	return 0;
}

static void draw(struct world *world, int draws)
{
	gl_target_bind(&world->target);
	glUseProgram(world->program);
	glBindBuffer(GL_ARRAY_BUFFER, world->vertices);
	glVertexAttribPointer(0, 2, GL_FLOAT, GL_FALSE, 0, NULL);
	glEnableVertexAttribArray(0);
	for (int i = 0; i < draws; i++) {
		glDrawArrays(GL_TRIANGLES, 0, 3 * DRAW_TRIANGLES);
		throttle_count(&world->throttle, DRAW_TRIANGLES);
	}
	glFinish();
}

/* Returns the most memory since forget_most in KiB, or -1. */
static long most_kib(void)
{
	char line[128];
	long kib = -1;
	FILE *status = fopen("/proc/self/status", "re");
	while (status && fgets(line, sizeof(line), status))
		if (sscanf(line, "VmHWM: %ld", &kib) == 1)
			break;
	if (status)
		fclose(status);
	return kib;
}

static void forget_most(void)
{
	const int fd = open("/proc/self/clear_refs", O_WRONLY | O_CLOEXEC);
	CHECK(fd >= 0);
	CHECK(write(fd, "5", 1) == 1);
	close(fd);
}

static void only_two_parts_wait_in_memory(void **state)
{
	struct world *world = *state;
	if (!driver_is_software(eglGetCurrentDisplay()))
		skip();
	draw(world, 4); /* buffers, programs, threads */
	forget_most();
	const long before = most_kib();
	draw(world, DRAWS);
	const long grown = most_kib() - before;
	if (grown > MOST_KIB)
		print_message("%ld KiB more\n", grown);
	CHECK(before > 0 && grown <= MOST_KIB);
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test_setup_teardown(only_two_parts_wait_in_memory, set_up, tear_down),
	};
	return cmocka_run_group_tests(tests, NULL, NULL);
}
