/* When the page about gopura.conf is shown, and how it goes; its quads are counted, not drawn. */
#include "app/modes/setup_page.h"

#include <errno.h>
#include <string.h>

#include "base/clock.h"
#include "tests/check.h"

enum { S = 1000 };

static int64_t now_ms;
static int drawn, dropped;
static float last_alpha;

int64_t clock_now_ms(void)
{
	return now_ms;
}

void quads_begin(struct quads *quads, const int shift_px[2], int width_px, int height_px,
		 int rotation_deg)
{
	(void)quads;
	CHECK(shift_px[0] == 0 && shift_px[1] == 0);
	CHECK(width_px == 1920 && height_px == 1080 && rotation_deg == 90);
}

int quads_upload(struct quads *quads, const struct quads_pixels *pixels)
{
	(void)quads;
	CHECK(pixels->width_px == 1080 && pixels->height_px == 1920 && pixels->bgra);
	return 0;
}

void quads_draw(struct quads *quads, uint32_t id, const float corners_px[4][2],
		const float source[4], float alpha)
{
	(void)quads, (void)id, (void)source;
	CHECK(corners_px[2][0] == 1080 && corners_px[2][1] == 1920);
	drawn++;
	last_alpha = alpha;
}

void quads_end(struct quads *quads)
{
	(void)quads;
}

void quads_drop(struct quads *quads, uint32_t id)
{
	(void)quads, (void)id;
	dropped++;
}

static const struct viewport viewport = {
	.panel_width_px = 1920, .panel_height_px = 1080, .rotation_deg = 90, .px_per_mm = 4
};
static struct redraw redraw;
static struct setup_page page;
static struct options options;
static struct provision provision;

static int set_up(void **state)
{
	(void)state;
	now_ms = 1000000;
	drawn = dropped = 0;
	redraw.wanted = false;
	options = (struct options){ .conf_paths = { "/efi/gopura.conf" }, .conf_count = 1 };
	provision = (struct provision){ .path = NULL };
	setup_page_init(&page, &viewport, &redraw);
	return 0;
}

static int tear_down(void **state)
{
	(void)state;
	setup_page_finish(&page);
	return 0;
}

/* Draws a frame; returns whether the page was part of it. */
static bool frame(bool pictured)
{
	const int before = drawn;

	redraw.wanted = false;
	CHECK(setup_page_draw(&page, NULL, pictured, now_ms) == 0);
	return drawn > before;
}

static void nothing_is_said_where_all_is_well(void **state)
{
	(void)state;
	options.trust_path = "1.json";
	provision.path = "/efi/gopura.conf";
	CHECK(setup_page_show(&page, &options, &provision, false) == 0);
	CHECK(!setup_page_covers(&page) && !frame(true));
	CHECK(setup_page_wait_ms(&page, true) == -1);
}

static void a_missing_file_is_said_until_the_terminal_is_restarted(void **state)
{
	(void)state;
	CHECK(setup_page_show(&page, &options, &provision, false) == 0);
	CHECK(setup_page_covers(&page) && frame(false));
	now_ms += 3600 * S;
	CHECK(frame(false) && last_alpha == 1 && setup_page_covers(&page));
	CHECK(setup_page_wait_ms(&page, false) == -1 && !redraw.wanted);
}

static void a_missing_file_is_no_matter_where_a_release_is_stored(void **state)
{
	(void)state;
	CHECK(setup_page_show(&page, &options, &provision, true) == 0);
	CHECK(!setup_page_covers(&page));
}

static void a_file_that_names_no_release_is_a_fault(void **state)
{
	(void)state;
	provision.path = "/efi/gopura.conf";
	CHECK(setup_page_show(&page, &options, &provision, false) == 0);
	CHECK(provision.diagnostics.count == 1 && setup_page_covers(&page));
}

static void faults_make_way_for_the_model_after_half_a_minute(void **state)
{
	(void)state;
	provision.path = "/efi/gopura.conf";
	diagnostics_add(&provision.diagnostics, -EINVAL, NULL, 3, "[panel] rotation is 45");
	CHECK(setup_page_show(&page, &options, &provision, true) == 0);
	CHECK(frame(true) && last_alpha == 1);
	CHECK(setup_page_wait_ms(&page, true) == 30 * S);
	now_ms += 29 * S;
	CHECK(frame(true) && setup_page_covers(&page));
	now_ms += 1 * S;
	CHECK(setup_page_wait_ms(&page, true) == 0);
	CHECK(frame(true) && !setup_page_covers(&page) && redraw.wanted); /* touch counts again */
	now_ms += 300;
	CHECK(frame(true) && last_alpha == 0.5f);
	now_ms += 300;
	CHECK(!frame(true) && dropped == 1 && !page.bitmap.surface);
	CHECK(!frame(true) && dropped == 1);
}

int main(void)
{
#define CASE(name) cmocka_unit_test_setup_teardown(name, set_up, tear_down)
	const struct CMUnitTest tests[] = {
		CASE(nothing_is_said_where_all_is_well),
		CASE(a_missing_file_is_said_until_the_terminal_is_restarted),
		CASE(a_missing_file_is_no_matter_where_a_release_is_stored),
		CASE(a_file_that_names_no_release_is_a_fault),
		CASE(faults_make_way_for_the_model_after_half_a_minute),
	};

	return cmocka_run_group_tests(tests, NULL, NULL);
}
