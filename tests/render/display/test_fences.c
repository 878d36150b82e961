/* The order in which fences are made, waited for and freed, with an EGL of the test's own; and
 * those of the real one. */
#include "render/display/fences.h"

#include <dlfcn.h>
#include <stdbool.h>
#include <stdint.h>
#include <stdio.h>
#include <string.h>

#include <EGL/egl.h>
#include <EGL/eglext.h>

#include "base/compiler.h"
#include "render/display/driver.h"
#include "render/display/gl.h"
#include "render/display/headless.h"
#include "tests/check.h"

static char calls[512];
static bool is_ours; /* fences are the test's own */

static void note(char what, EGLSyncKHR fence)
{
	const size_t size = strlen(calls);

	snprintf(calls + size, sizeof(calls) - size, "%c%d ", what, (int)(intptr_t)fence);
}

static EGLSyncKHR create_one(EGLDisplay display, EGLenum kind, const EGLint *with)
{
	static intptr_t last;

	(void)display;
	(void)kind;
	(void)with;
	note('+', (EGLSyncKHR)++last);
	return (EGLSyncKHR)last;
}

static EGLint wait_for_one(EGLDisplay display, EGLSyncKHR fence, EGLint flags, EGLTimeKHR most)
{
	(void)display;
	(void)flags;
	CHECK(most == EGL_FOREVER_KHR);
	note('=', fence);
	return EGL_CONDITION_SATISFIED_KHR;
}

static EGLBoolean destroy_one(EGLDisplay display, EGLSyncKHR fence)
{
	(void)display;
	note('-', fence);
	return EGL_TRUE;
}

/* Before libEGL's own. */
__eglMustCastToProperFunctionPointerType eglGetProcAddress(const char *name)
{
	static const struct {
		const char *name;
		__eglMustCastToProperFunctionPointerType function;
	} own[] = {
		{ "eglCreateSyncKHR", (__eglMustCastToProperFunctionPointerType)create_one },
		{ "eglDestroySyncKHR", (__eglMustCastToProperFunctionPointerType)destroy_one },
		{ "eglClientWaitSyncKHR", (__eglMustCastToProperFunctionPointerType)wait_for_one },
	};
	__eglMustCastToProperFunctionPointerType (*real)(const char *) =
		(__eglMustCastToProperFunctionPointerType(*)(const char *))dlsym(
			RTLD_NEXT, "eglGetProcAddress");

	for (size_t i = 0; is_ours && i < ARRAY_COUNT(own); i++)
		if (strcmp(name, own[i].name) == 0)
			return own[i].function;
	return real(name);
}

static int set_up(void **state)
{
	struct headless *headless;

	if (headless_create(&headless) < 0)
		return -1;
	*state = headless;
	return 0;
}

static int tear_down(void **state)
{
	headless_destroy(*state);
	return 0;
}

static bool is_software(void)
{
	return driver_is_software(eglGetCurrentDisplay());
}

static void a_fence_stays_until_a_later_one_has_passed(void **state)
{
	(void)state;
	if (!is_software())
		skip();
	is_ours = true;
	for (uint64_t n = 1; n <= 8; n++)
		CHECK(fences_add() == n);
	CHECK(strcmp(calls, "+1 +2 +3 +4 +5 +6 +7 +8 ") == 0);
	calls[0] = '\0';
	CHECK(fences_add() == 9 && fences_add() == 10);
	CHECK(strcmp(calls, "+9 =2 -1 +10 =3 -2 ") == 0);
	calls[0] = '\0';
	fences_wait(0);
	fences_wait(10);
	fences_wait(1); /* freed: the oldest that is left */
	CHECK(strcmp(calls, "=10 =3 ") == 0);
	calls[0] = '\0';
	fences_end();
	CHECK(strcmp(calls, "-10 -9 -8 -7 -6 -5 -4 -3 ") == 0);
	is_ours = false;
}

static void they_are_there_for_the_processor_alone(void **state)
{
	uint64_t number = 0;

	(void)state;
	for (int i = 0; i < 20; i++) {
		number = fences_add();
		fences_wait(number);
	}
	CHECK(number == (is_software() ? 20 : 0));
	CHECK(eglGetError() == EGL_SUCCESS);
	fences_end();
	fences_end();
	CHECK(fences_add() == (is_software() ? 1 : 0)); /* it begins anew */
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test_setup_teardown(a_fence_stays_until_a_later_one_has_passed, set_up,
						tear_down),
		cmocka_unit_test_setup_teardown(they_are_there_for_the_processor_alone, set_up,
						tear_down),
	};

	return cmocka_run_group_tests(tests, NULL, NULL);
}
