/* Bitmaps as textures, without a panel. */
#include "render/display/quads.h"

#include <errno.h>
#include <stdlib.h>

#include "render/display/gl.h"
#include "render/display/headless.h"
#include "tests/check.h"

static int start(void **state)
{
	return headless_create((struct headless **)state);
}

static int stop(void **state)
{
	headless_destroy(*state);
	return 0;
}

/* The head of a page over a wall of panels is as wide as the wall. */
static void takes_what_is_as_wide_as_the_panel(void **state)
{
	enum { WIDE_PX = 5120, HIGH_PX = 3 };
	uint8_t *bgra = calloc(WIDE_PX * HIGH_PX, 4);
	const struct quads_pixels pixels = { .revision = 1,
					     .width_px = WIDE_PX,
					     .height_px = HIGH_PX,
					     .stride_bytes = WIDE_PX * 4,
					     .bgra = bgra };
	struct quads *quads;
	GLint most = 0;

	(void)state;
	CHECK(bgra && quads_create(&quads) == 0);
	glGetIntegerv(GL_MAX_TEXTURE_SIZE, &most);
	CHECK(quads_upload(quads, &pixels) == (most >= WIDE_PX ? 0 : -EIO));
	quads_destroy(quads);
	free(bgra);
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test_setup_teardown(takes_what_is_as_wide_as_the_panel, start, stop),
	};

	return cmocka_run_group_tests(tests, NULL, NULL);
}
