#include "render/display/drm_mode.h"

#include "tests/check.h"

static const drmModeModeInfo of_a_panel[] = {
	{ .hdisplay = 1920, .vdisplay = 1080, .vrefresh = 60, .type = DRM_MODE_TYPE_DRIVER },
	{ .hdisplay = 1920,
	  .vdisplay = 1080,
	  .vrefresh = 50,
	  .flags = DRM_MODE_FLAG_INTERLACE,
	  .type = DRM_MODE_TYPE_DRIVER },
	{ .hdisplay = 1920, .vdisplay = 1080, .vrefresh = 30, .type = DRM_MODE_TYPE_DRIVER },
	{ .hdisplay = 1280,
	  .vdisplay = 800,
	  .vrefresh = 60,
	  .type = DRM_MODE_TYPE_DRIVER | DRM_MODE_TYPE_PREFERRED },
	{ .hdisplay = 1280, .vdisplay = 720, .vrefresh = 60, .type = DRM_MODE_TYPE_DRIVER },
};

static drmModeModeInfo chosen;

static enum drm_mode_reason choose(int count, bool has_edid, int width, int height, int hz)
{
	const struct drm_mode_wish wish = { width, height, hz };

	return drm_mode_choose(&chosen, of_a_panel, count, has_edid, &wish);
}

static bool is(int width, int height, int hz)
{
	return chosen.hdisplay == width && chosen.vdisplay == height &&
	       chosen.vrefresh == (uint32_t)hz;
}

static void takes_what_the_panel_prefers(void **state)
{
	(void)state;
	CHECK(choose(5, true, 0, 0, 0) == DRM_MODE_PREFERRED && is(1280, 800, 60));
	CHECK(choose(3, true, 0, 0, 0) == DRM_MODE_PREFERRED && is(1920, 1080, 60));
}

static void takes_the_size_asked_for(void **state)
{
	(void)state;
	CHECK(choose(5, true, 1920, 1080, 0) == DRM_MODE_AS_WISHED && is(1920, 1080, 60));
	CHECK(choose(5, true, 1280, 720, 60) == DRM_MODE_AS_WISHED && is(1280, 720, 60));
}

static void takes_the_nearest_rate_and_says_so(void **state)
{
	(void)state;
	CHECK(choose(5, true, 1920, 1080, 30) == DRM_MODE_AS_WISHED && is(1920, 1080, 30));
	CHECK(choose(5, true, 1920, 1080, 59) == DRM_MODE_AS_WISHED && is(1920, 1080, 60));
	CHECK(choose(5, true, 1920, 1080, 75) == DRM_MODE_OTHER_RATE && is(1920, 1080, 60));
}

static void takes_interlaced_modes_last(void **state)
{
	(void)state;
	CHECK(choose(5, true, 1920, 1080, 50) == DRM_MODE_OTHER_RATE && is(1920, 1080, 60));
}

static void believes_a_panel_that_tells_its_modes(void **state)
{
	(void)state;
	CHECK(choose(5, true, 1024, 600, 0) == DRM_MODE_UNKNOWN && is(1280, 800, 60));
}

static void believes_the_engineer_where_the_panel_is_mute(void **state)
{
	(void)state;
	CHECK(choose(5, false, 1024, 600, 0) == DRM_MODE_MADE && is(1024, 600, 60));
	CHECK(choose(0, false, 1080, 1920, 50) == DRM_MODE_MADE && is(1080, 1920, 50));
}

static void falls_back_where_nobody_says_anything(void **state)
{
	(void)state;
	CHECK(choose(0, false, 0, 0, 0) == DRM_MODE_MADE && is(1024, 768, 60));
	CHECK(choose(0, true, 640, 480, 0) == DRM_MODE_MADE && is(1024, 768, 60));
}

/* The timings that VESA's own table has for reduced blanking. */
static void makes_vesas_timings(void **state)
{
	(void)state;
	drm_mode_make(&chosen, 1920, 1080, 60);
	CHECK(chosen.clock == 138500 && chosen.htotal == 2080 && chosen.vtotal == 1111);
	CHECK(chosen.hsync_start == 1968 && chosen.hsync_end == 2000);
	CHECK(chosen.vsync_start == 1083 && chosen.vsync_end == 1088);
	drm_mode_make(&chosen, 1280, 800, 0);
	CHECK(chosen.clock == 71000 && chosen.htotal == 1440 && chosen.vtotal == 823);
	CHECK(chosen.vsync_start == 803 && chosen.vsync_end == 809);
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(takes_what_the_panel_prefers),
		cmocka_unit_test(takes_the_size_asked_for),
		cmocka_unit_test(takes_the_nearest_rate_and_says_so),
		cmocka_unit_test(takes_interlaced_modes_last),
		cmocka_unit_test(believes_a_panel_that_tells_its_modes),
		cmocka_unit_test(believes_the_engineer_where_the_panel_is_mute),
		cmocka_unit_test(falls_back_where_nobody_says_anything),
		cmocka_unit_test(makes_vesas_timings),
	};

	return cmocka_run_group_tests(tests, NULL, NULL);
}
