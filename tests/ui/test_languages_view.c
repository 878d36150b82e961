/* The menu of languages: many of them, on every panel, each within a finger's reach. With
 * GOPURA_PICTURES=DIR set it leaves its screens there. */
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "tests/check.h"
#include "tests/ui/compiled.h"
#include "tests/ui/places.h"
#include "ui/endonym.h"
#include "ui/overlay.h"
#include "ui/translate.h"

static const char *const languages[] = {
	"en",      "km",      "ja", "fr", "de", "es", "it", "pt-BR", "nl", "pl", "ru",
	"zh-Hans", "zh-Hant", "ko", "vi", "th", "lo", "my", "hi",    "ar", "he", "fa",
	"tr",      "id",      "el", "uk", "ta", "ms", "cs", "sk",    "hu", "ro", "sl",
	"hr",      "sv",      "da", "nb", "fi", "et", "lv", "lt",    "is",
};
enum { MANY = ARRAY_COUNT(languages), PARTS = 3, STEP_PX = 4 };

static const int sizes[][2] = { { 1920, 1080 }, { 1080, 1920 }, { 3840, 2160 }, { 1280, 720 },
				{ 800, 600 },   { 640, 360 },   { 360, 640 } };

static struct overlay *open_overlay(int width_px, int height_px, uint32_t language_count)
{
	const struct overlay_part part = { "The central tower", "In stone.", "", true };
	const struct overlay_part parts[PARTS] = { part, part, part };
	const struct overlay_options options = { .width_px = width_px,
						 .height_px = height_px,
						 .languages = languages,
						 .language_count = language_count };
	struct overlay *overlay;

	CHECK(overlay_create(&overlay, &options) == 0);
	CHECK(overlay_parts(overlay, parts, PARTS) == 0);
	return overlay;
}

static void settle(struct overlay *overlay)
{
	static int64_t now_ms = 1000;
	int frames = 0;

	while (overlay_update(overlay, now_ms += 20))
		CHECK(++frames < 500);
}

static void leave_picture(struct overlay *overlay, const char *name)
{
	const char *folder = getenv("GOPURA_PICTURES");
	struct bitmap bitmap;
	cairo_t *context;
	char path[300];

	settle(overlay);
	if (!folder)
		return;
	CHECK(bitmap_init(&bitmap, overlay->width_px, overlay->height_px) == 0);
	context = bitmap_begin(&bitmap);
	cairo_set_source_rgb(context, 0.55, 0.52, 0.47);
	cairo_paint(context);
	overlay_paint(overlay, context);
	bitmap_end(&bitmap, context);
	snprintf(path, sizeof(path), "%s/languages-%s-%dx%d.png", folder, name, overlay->width_px,
		 overlay->height_px);
	cairo_surface_write_to_png(bitmap.surface, path);
	bitmap_finish(&bitmap);
}

/* The bar's button for all of them; NULL: they stand there themselves. */
static const struct bar_view_button *menu_button(const struct overlay *overlay)
{
	for (uint32_t i = 0; i < overlay->bar.button_count; i++)
		if (overlay->bar.buttons[i].kind == BAR_LANGUAGES)
			return &overlay->bar.buttons[i];
	return NULL;
}

static struct overlay_action tap_button(const struct overlay *overlay)
{
	const struct rect bar = bar_place(overlay);
	const struct bar_view_button *button = menu_button(overlay);

	CHECK(button);
	return overlay_tap(overlay, (float)(bar.x_px + button->x_px) + (float)button->width_px / 2,
			   (float)bar.y_px + (float)bar.height_px / 2);
}

static struct rect menu_rect(const struct overlay *overlay)
{
	const struct screen screen = overlay_screen(overlay);

	return languages_view_rect(&screen, &overlay->languages);
}

/* Where the fingers that choose each language come down: as large as a finger, and each once. */
static void check_cells(const struct overlay *overlay)
{
	const struct screen screen = overlay_screen(overlay);
	const struct rect all = languages_view_rect(&screen, &overlay->languages);
	const int target_px = theme_px(&overlay->theme, THEME_TARGET_MM);
	const int least_px = target_px - STEP_PX; /* by so much less than it is */
	uint32_t felt[MANY] = { 0 };

	CHECK(all.x_px >= 0 && all.x_px + all.width_px <= overlay->width_px);
	CHECK(all.y_px >= screen_reach_top(&screen));
	CHECK(all.y_px + all.height_px <= bar_place(overlay).y_px);
	for (int y = all.y_px; y < all.y_px + all.height_px; y += STEP_PX)
		for (int x = all.x_px; x < all.x_px + all.width_px; x += STEP_PX) {
			const struct overlay_action action =
				overlay_tap(overlay, (float)x, (float)y);

			CHECK(overlay_covers(overlay, (float)x, (float)y));
			if (action.kind != OVERLAY_LANGUAGE)
				continue;
			for (uint32_t i = 0; i < overlay->languages.count; i++)
				felt[i] += strcmp(languages[i], action.language) == 0;
		}
	for (uint32_t i = 0; i < overlay->languages.count; i++) {
		if ((int)i == overlay->languages.current)
			CHECK(felt[i] == 0);
		else if (felt[i] * STEP_PX * STEP_PX < (uint32_t)(least_px * least_px))
			fail_msg("%dx%d: %s is too small", overlay->width_px, overlay->height_px,
				 languages[i]);
	}
}

static void many_languages_are_a_menu_on_every_panel(void **state)
{
	(void)state;
	for (size_t s = 0; s < ARRAY_COUNT(sizes); s++) {
		struct overlay *overlay = open_overlay(sizes[s][0], sizes[s][1], MANY);

		for (int mode = 0; mode < 4; mode++) {
			overlay_set_comfort(overlay, (struct overlay_comfort){ .large = mode & 1,
									       .reach = mode & 2 });
			if (overlay_comfort(overlay).reach != (mode >= 2))
				continue; /* a panel that is small enough */
			CHECK(tap_button(overlay).kind == OVERLAY_LANGUAGES);
			overlay_show_languages(overlay, true);
			leave_picture(overlay, mode == 0 ? "many" : mode == 1 ? "large" : "reach");
			check_cells(overlay);
			overlay_show_languages(overlay, false);
			settle(overlay);
		}
		overlay_destroy(overlay);
	}
}

static void a_language_closes_the_menu_and_nothing_else(void **state)
{
	static const char html[] = "<h1>Central tower</h1><p>In stone.</p>";
	struct overlay *overlay = open_overlay(1280, 720, 14);
	const struct overlay_part part = { "Zentralturm", "Aus Stein.", "", true };
	const struct overlay_part parts[PARTS] = { part, part, part };
	struct rect all;

	(void)state;
	CHECK(overlay_show_page(overlay, 0, compiled(html), "") == 0);
	overlay_show_languages(overlay, true);
	leave_picture(overlay, "page");
	CHECK(overlay_choosing_language(overlay) && overlay_page(overlay) == 0);
	all = menu_rect(overlay);
	check_cells(overlay);
	/* Beside it: it closes, and the page's own control is not meant. */
	CHECK(overlay_tap(overlay, 1270, 10).kind == OVERLAY_LANGUAGES);
	CHECK(overlay_tap(overlay, (float)all.x_px - 2, (float)all.y_px).kind == OVERLAY_LANGUAGES);
	overlay_language(overlay, "de");
	CHECK(overlay_parts(overlay, parts, PARTS) == 0);
	settle(overlay);
	CHECK(!overlay_choosing_language(overlay) && overlay_page(overlay) == 0);
	CHECK(overlay->languages_view.fade.alpha == 0);
	overlay_destroy(overlay);
}

static void few_languages_stand_on_the_bar(void **state)
{
	struct overlay *overlay = open_overlay(1920, 1080, 8);

	(void)state;
	CHECK(!menu_button(overlay));
	overlay_show_languages(overlay, true); /* there is none */
	CHECK(!overlay_choosing_language(overlay));
	overlay_destroy(overlay);

	overlay = open_overlay(360, 640, 8); /* no room for them */
	CHECK(menu_button(overlay));
	overlay_destroy(overlay);

	overlay = open_overlay(1920, 1080, 1);
	CHECK(!menu_button(overlay));
	overlay_destroy(overlay);
}

static void every_language_is_invited(void **state)
{
	(void)state;
	for (size_t s = 0; s < ARRAY_COUNT(sizes); s++) {
		struct overlay *overlay = open_overlay(sizes[s][0], sizes[s][1], 25);
		struct rect rect;

		overlay_invite(overlay, true);
		leave_picture(overlay, "invited");
		rect = invitation_place(overlay);
		CHECK(rect.x_px >= 0 && rect.x_px + rect.width_px <= overlay->width_px);
		CHECK(rect.y_px >= 0 && rect.y_px + rect.height_px <= overlay->height_px);
		overlay_destroy(overlay);
	}
}

static void a_language_says_its_own_name(void **state)
{
	(void)state;
	for (size_t i = 0; i < MANY; i++) {
		if (strcmp(ui_endonym(languages[i]), languages[i]) == 0)
			fail_msg("%s has no name", languages[i]);
		for (size_t k = 0; k < i; k++)
			CHECK(strcmp(ui_endonym(languages[i]), ui_endonym(languages[k])) != 0);
	}
	CHECK(strcmp(ui_endonym("xx"), "xx") == 0);
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(many_languages_are_a_menu_on_every_panel),
		cmocka_unit_test(a_language_closes_the_menu_and_nothing_else),
		cmocka_unit_test(few_languages_stand_on_the_bar),
		cmocka_unit_test(every_language_is_invited),
		cmocka_unit_test(a_language_says_its_own_name),
	};

	if (translate_open(TEST_LOCALE) < 0)
		return 1;
	return cmocka_run_group_tests(tests, NULL, NULL);
}
