/* What is measured: how it is written, what of it answers a finger, and where it stands. With
 * GOPURA_PICTURES=DIR set it leaves its screens there. */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "tests/check.h"
#include "tests/ui/places.h"
#include "ui/overlay.h"
#include "ui/translate.h"

static const char *const languages[] = { "en", "de", "km", "ja" };

static void settle(struct overlay *overlay)
{
	static int64_t now_ms = 1000;
	int frames = 0;

	while (overlay_update(overlay, now_ms += 20))
		CHECK(++frames < 500);
}

static struct overlay *open_overlay(int width_px, int height_px)
{
	const struct overlay_options options = { .width_px = width_px,
						 .height_px = height_px,
						 .languages = languages,
						 .language_count = ARRAY_COUNT(languages) };
	const struct overlay_part part = { "Gate", "Of stone.", "", true };
	struct overlay *overlay;

	CHECK(overlay_create(&overlay, &options) == 0);
	overlay_offer_tools(overlay, OVERLAY_TOOL_MEASURE);
	CHECK(overlay_parts(overlay, &part, 1) == 0);
	overlay_show_help(overlay, false);
	settle(overlay);
	return overlay;
}

/* The ends stand at these shares of the panel. */
static void show(struct overlay *overlay, unsigned count, float x, float y)
{
	const float w = (float)overlay->width_px, h = (float)overlay->height_px;
	const struct overlay_tools state = { .on = OVERLAY_TOOL_MEASURE,
					     .measure = { .count = count,
							  .in_sight = { true, true },
							  .at_px = { { 0.3f * w, 0.3f * h },
								     { x * w, y * h } },
							  .length_m = 12.3456f,
							  .error_m = 0.012f } };

	overlay_show_tools(overlay, &state);
	settle(overlay);
}

static void paint(const struct overlay *overlay, const char *name)
{
	char path[512];
	cairo_surface_t *surface;
	cairo_t *context;

	if (!getenv("GOPURA_PICTURES"))
		return;
	surface = cairo_image_surface_create(CAIRO_FORMAT_ARGB32, overlay->width_px,
					     overlay->height_px);
	context = cairo_create(surface);
	cairo_set_source_rgb(context, 0.5, 0.55, 0.5);
	cairo_paint(context);
	overlay_paint(overlay, context);
	snprintf(path, sizeof(path), "%s/measure-%s-%d.png", getenv("GOPURA_PICTURES"), name,
		 overlay->width_px);
	CHECK(cairo_surface_write_to_png(surface, path) == CAIRO_STATUS_SUCCESS);
	cairo_destroy(context);
	cairo_surface_destroy(surface);
}

static void a_length_has_no_digits_below_its_error(void **state)
{
	static const struct {
		const char *language;
		float length_m, error_m;
		const char *text;
	} cases[] = {
		{ "en", 12.3456f, 0.012f, "12.35 m ± 2 cm" },
		{ "de", 12.3456f, 0.012f, "12,35 m ± 2 cm" },
		{ "en", 12.3456f, 0.2f, "12.3 m ± 20 cm" },
		{ "en", 12.3456f, 3, "12 m ± 3 m" },
		{ "en", 1234, 96, "1200 m ± 100 m" },
		{ "en", 0.3456f, 0.0071f, "34.6 cm ± 8 mm" },
		{ "en", 0.3456f, 0.0098f, "35 cm ± 1 cm" },
		{ "en", 0.00346f, 0.00014f, "3.5 mm ± 0.2 mm" },
		{ "km", 0.00346f, 0.00014f, "3,5 mm ± 0,2 mm" },
		{ "en", 2, 0, "2.0000 m ± 0.1 mm" },
		{ "en", 0, 0.01f, "0 mm ± 1 cm" },
		{ "en", 0.9999f, 0.001f, "1.000 m ± 1 mm" },
	};
	char text[100];

	(void)state;
	for (size_t i = 0; i < ARRAY_COUNT(cases); i++) {
		measure_view_text(text, sizeof(text), cases[i].language, cases[i].length_m,
				  cases[i].error_m);
		if (strcmp(text, cases[i].text) != 0)
			fail_msg("%g, %g: %s, not %s", (double)cases[i].length_m,
				 (double)cases[i].error_m, text, cases[i].text);
	}
}

static void it_says_what_to_touch_next(void **state)
{
	struct overlay *overlay = open_overlay(1280, 720);

	(void)state;
	show(overlay, 0, 0, 0);
	CHECK(strcmp(overlay->measure.text, "Touch two places on the model") == 0);
	show(overlay, 1, 0, 0);
	CHECK(strcmp(overlay->measure.text, "Touch the second place") == 0);
	overlay_language(overlay, "de");
	show(overlay, 1, 0, 0);
	CHECK(strcmp(overlay->measure.text, "Die zweite Stelle berühren") == 0);
	show(overlay, 2, 0.6f, 0.5f);
	CHECK(strcmp(overlay->measure.text, "12,35 m ± 2 cm") == 0);
	overlay_destroy(overlay);
}

/* Every end that is in sight has a knob of 9 mm beside it, on the panel wherever the end is. */
static void a_knob_answers_and_does_not_cover_its_end(void **state)
{
	static const int sizes[][2] = {
		{ 1280, 720 }, { 1920, 1080 }, { 1080, 1920 }, { 800, 1280 }
	};
	static const float places[][2] = { { 0.6f, 0.5f }, { 0.95f, 0.97f }, { 0.7f, 0.02f } };

	(void)state;
	for (size_t s = 0; s < ARRAY_COUNT(sizes); s++)
		for (size_t p = 0; p < ARRAY_COUNT(places); p++) {
			struct overlay *overlay = open_overlay(sizes[s][0], sizes[s][1]);
			const int target_px = theme_px(&overlay->theme, THEME_TARGET_MM);
			const float at[2] = { places[p][0] * (float)sizes[s][0],
					      places[p][1] * (float)sizes[s][1] };
			int top = overlay->height_px, bottom = -1, found = 0;

			show(overlay, 2, places[p][0], places[p][1]);
			paint(overlay, p == 0 ? "both" : p == 1 ? "low" : "high");
			for (int y = 0; y < overlay->height_px; y++)
				if (overlay_handle_at(overlay, at[0], (float)y) ==
				    OVERLAY_HANDLE_TO) {
					top = y < top ? y : top;
					bottom = y;
					found++;
				}
			CHECK(found == bottom - top + 1 && found >= target_px - 1);
			CHECK(overlay_handle_at(overlay, at[0], at[1]) == OVERLAY_HANDLE_NONE);
			show(overlay, 1, places[p][0], places[p][1]);
			for (int y = 0; y < overlay->height_px; y += 8)
				CHECK(overlay_handle_at(overlay, at[0], (float)y) ==
				      OVERLAY_HANDLE_NONE);
			overlay_destroy(overlay);
		}
}

static void what_is_open_is_touched_first(void **state)
{
	struct overlay *overlay = open_overlay(1280, 720);
	const struct rect card = card_place(overlay);
	const float x = (float)card.x_px + (float)card.width_px / 2;
	const float y = (float)card.y_px + (float)card.height_px / 2;
	struct overlay_tools off = { 0 };

	(void)state;
	show(overlay, 2, x / 1280, y / 720 - 0.0625f);
	CHECK(overlay_handle_at(overlay, x, y) == OVERLAY_HANDLE_TO);
	overlay_show_card(overlay, 0);
	settle(overlay);
	CHECK(overlay_handle_at(overlay, x, y) == OVERLAY_HANDLE_NONE);
	overlay_show_card(overlay, -1);
	settle(overlay);
	CHECK(overlay_handle_at(overlay, x, y) == OVERLAY_HANDLE_TO);
	overlay_show_tools(overlay, &off);
	settle(overlay);
	CHECK(overlay_handle_at(overlay, x, y) == OVERLAY_HANDLE_NONE);
	overlay_destroy(overlay);
}

/* Words are drawn once, and an eye that moves draws nothing anew. */
static void a_line_that_moves_is_not_drawn_anew(void **state)
{
	struct overlay *overlay = open_overlay(1280, 720);

	(void)state;
	show(overlay, 2, 0.6f, 0.5f);
	const uint32_t words = overlay->measure.words.revision,
		       line = overlay->measure.line.revision;

	CHECK(words > 0 && line > 0);
	for (int i = 0; i < 20; i++)
		show(overlay, 2, 0.6f + 0.01f * (float)i, 0.5f);
	CHECK(overlay->measure.words.revision == words && overlay->measure.line.revision == line);
	overlay_destroy(overlay);
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(a_length_has_no_digits_below_its_error),
		cmocka_unit_test(it_says_what_to_touch_next),
		cmocka_unit_test(a_knob_answers_and_does_not_cover_its_end),
		cmocka_unit_test(what_is_open_is_touched_first),
		cmocka_unit_test(a_line_that_moves_is_not_drawn_anew),
	};

	if (translate_open(TEST_LOCALE) < 0)
		return 1;
	return cmocka_run_group_tests(tests, NULL, NULL);
}
