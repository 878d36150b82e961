/* Configurations of an EGL that is played. */
#include "render/display/context.h"

#include <stdint.h>

#include "tests/check.h"

enum { MOST = 300, WANTED_VISUAL = 42, OTHER_VISUAL = 41 };

static struct {
	int count, depth_bits; /* of all */
	int wanted_at;         /* the first with the visual that is wanted */
} egl;

EGLBoolean eglChooseConfig(EGLDisplay display, const EGLint *wanted, EGLConfig *configs,
			   EGLint most, EGLint *count)
{
	int depth_bits = 0;

	(void)display;
	for (; *wanted != EGL_NONE; wanted += 2)
		if (wanted[0] == EGL_DEPTH_SIZE)
			depth_bits = wanted[1];
	*count = depth_bits <= egl.depth_bits ? egl.count : 0;
	if (configs && *count > most)
		*count = most;
	for (int i = 0; configs && i < *count; i++)
		configs[i] = (EGLConfig)(intptr_t)(i + 1);
	return EGL_TRUE;
}

EGLBoolean eglGetConfigAttrib(EGLDisplay display, EGLConfig config, EGLint attribute, EGLint *value)
{
	(void)display;
	CHECK(attribute == EGL_NATIVE_VISUAL_ID);
	*value = (intptr_t)config - 1 >= egl.wanted_at ? WANTED_VISUAL : OTHER_VISUAL;
	return EGL_TRUE;
}

static int number_of(EGLConfig config)
{
	return (int)(intptr_t)config - 1;
}

/* Those with ten bits a channel and with several samples come first. */
static void finds_one_behind_many(void **state)
{
	(void)state;
	egl.count = MOST;
	egl.depth_bits = 24;
	egl.wanted_at = MOST - 1;
	CHECK(number_of(context_config(NULL, WANTED_VISUAL, 24)) == MOST - 1);
	egl.wanted_at = 3;
	CHECK(number_of(context_config(NULL, WANTED_VISUAL, 24)) == 3);
	egl.wanted_at = MOST;
	CHECK(!context_config(NULL, WANTED_VISUAL, 24));
	egl.count = 0;
	CHECK(!context_config(NULL, WANTED_VISUAL, 24));
}

static void takes_the_depth_that_there_is(void **state)
{
	(void)state;
	egl.count = 1;
	egl.wanted_at = egl.depth_bits = 0;
	CHECK(context_config(NULL, WANTED_VISUAL, 24));
	egl.depth_bits = 16;
	CHECK(context_config(NULL, WANTED_VISUAL, 24));
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(finds_one_behind_many),
		cmocka_unit_test(takes_the_depth_that_there_is),
	};

	return cmocka_run_group_tests(tests, NULL, NULL);
}
