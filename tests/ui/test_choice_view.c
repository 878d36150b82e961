/* The choice of the site's states: where it stands, what its words answer, and when it gives way.
 * With GOPURA_PICTURES=DIR set it leaves its screens there. */
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "tests/check.h"
#include "ui/overlay.h"
#include "ui/overlay_layout.h"

static const char *const languages[] = { "en", "fr", "km", "ja" };
static const char *const titles[] = { "As found", "As built, with its wooden roof" };

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
	CHECK(overlay_parts(overlay, &part, 1) == 0);
	overlay_show_help(overlay, false);
	settle(overlay);
	return overlay;
}

static struct overlay_action tap_title(const struct overlay *overlay, unsigned title)
{
	const struct screen screen = overlay_screen(overlay);
	const struct rect rect = choice_view_rect(&overlay->choice, &screen);
	const float x = title == 0 ? (float)rect.x_px + 3 : (float)(rect.x_px + rect.width_px) - 3;

	return overlay_tap(overlay, x, (float)rect.y_px + (float)rect.height_px / 2);
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
	snprintf(path, sizeof(path), "%s/choice-%s.png", getenv("GOPURA_PICTURES"), name);
	CHECK(cairo_surface_write_to_png(surface, path) == CAIRO_STATUS_SUCCESS);
	cairo_destroy(context);
	cairo_surface_destroy(surface);
}

static void words_answer_a_finger_on_every_panel(void **state)
{
	static const int sizes[][2] = {
		{ 1280, 720 }, { 1920, 1080 }, { 1080, 1920 }, { 800, 480 }
	};

	(void)state;
	for (size_t i = 0; i < ARRAY_COUNT(sizes); i++) {
		struct overlay *overlay = open_overlay(sizes[i][0], sizes[i][1]);
		const struct screen screen = overlay_screen(overlay);
		struct rect rect;

		overlay_show_choice(overlay, titles, 2, 0);
		settle(overlay);
		rect = choice_view_rect(&overlay->choice, &screen);
		CHECK(rect.x_px >= 0 && rect.y_px >= 0 && !rect_meets(rect, screen.bar));
		CHECK(rect.height_px >= screen_px(&screen, THEME_TARGET_MM));
		CHECK(tap_title(overlay, 0).kind == OVERLAY_SWALLOWED); /* it is chosen */
		CHECK(tap_title(overlay, 1).kind == OVERLAY_CHOICE &&
		      tap_title(overlay, 1).choice == 1);
		CHECK(overlay_covers(overlay, (float)rect.x_px + 3, (float)rect.y_px + 3));
		overlay_show_choice(overlay, titles, 2, 1);
		CHECK(tap_title(overlay, 0).kind == OVERLAY_CHOICE &&
		      tap_title(overlay, 0).choice == 0);
		settle(overlay);
		if (i == 0)
			paint(overlay, "wide");
		if (i == 2)
			paint(overlay, "tall");
		overlay_destroy(overlay);
	}
}

static void one_state_is_no_choice(void **state)
{
	struct overlay *overlay = open_overlay(1280, 720);

	(void)state;
	overlay_show_choice(overlay, titles, 1, 0);
	settle(overlay);
	CHECK(tap_title(overlay, 0).kind == OVERLAY_NONE);
	overlay_destroy(overlay);
}

static void the_invitation_takes_its_place(void **state)
{
	struct overlay *overlay = open_overlay(1280, 720);

	(void)state;
	overlay_show_choice(overlay, titles, 2, 0);
	overlay_invite(overlay, true);
	settle(overlay);
	CHECK(tap_title(overlay, 1).kind == OVERLAY_NONE && overlay->choice.fade.alpha <= 0);
	overlay_invite(overlay, false);
	settle(overlay);
	CHECK(tap_title(overlay, 1).kind == OVERLAY_CHOICE && overlay->choice.fade.alpha >= 1);
	overlay_destroy(overlay);
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(words_answer_a_finger_on_every_panel),
		cmocka_unit_test(one_state_is_no_choice),
		cmocka_unit_test(the_invitation_takes_its_place),
	};

	return cmocka_run_group_tests(tests, NULL, NULL);
}
