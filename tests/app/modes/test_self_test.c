/* The self-test on a panel that refuses its first picture, as one does whose modes are read again.
 */
#include "app/modes/self_test.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "render/display/display.h"
#include "tests/check.h"

static int presents, refuses;
static bool is_stale;

int __wrap_display_present(struct display *display);
bool __wrap_display_ready(const struct display *display);
bool __wrap_display_take_stale(struct display *display);

int __wrap_display_present(struct display *display)
{
	(void)display;
	is_stale = ++presents <= refuses;
	return 0;
}

/* also after a refusal, to be tried again */
bool __wrap_display_ready(const struct display *display)
{
	(void)display;
	return true;
}

bool __wrap_display_take_stale(struct display *display)
{
	const bool was = is_stale;

	(void)display;
	is_stale = false;
	return was;
}

static void test_panel(int refused)
{
	char folder[] = "/tmp/self_test.XXXXXX", path[64];
	struct options options = {
		.display = DISPLAY_HEADLESS, .width_px = 64, .height_px = 64, .state_dir = folder
	};

	CHECK(mkdtemp(folder));
	presents = 0;
	refuses = refused;
	CHECK(self_test_run(&options) == SELF_TEST_STATUS_SETTINGS); /* a trust root is missing */
	snprintf(path, sizeof(path), "%s/touch.seen", folder);
	unlink(path);
	CHECK(rmdir(folder) == 0);
}

static void a_picture_that_was_refused_is_presented_again(void **state)
{
	(void)state;
	test_panel(0);
	CHECK(presents == 1);
	test_panel(2);
	CHECK(presents == 3);
}

int main(void)
{
	const struct CMUnitTest tests[] = { cmocka_unit_test(
		a_picture_that_was_refused_is_presented_again) };

	return cmocka_run_group_tests(tests, NULL, NULL);
}
