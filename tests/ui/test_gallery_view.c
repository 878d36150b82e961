/* A page's pictures over the whole panel: which opens, how fingers move it, what closes it. With
 * GOPURA_PICTURES=DIR set it leaves its screens there. */
#include "ui/overlay.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "tests/check.h"
#include "tests/ui/compiled.h"
#include "tests/ui/places.h"
#include "ui/translate.h"

static const char *const languages[] = { "en", "ja" };
static const char page[] =
	"<h1>Tower</h1><figure><img src=\"pictures/wide.png\"><figcaption>From the east, at dawn."
	"</figcaption></figure><p>Text <a href=\"part:a\">and a link</a>.</p>"
	"<img src=\"pictures/tall.png\"><p>More.</p><img src=\"pictures/wide.png\">";

static struct picture wide, tall;
static bool arrived;

static void paint(struct picture *picture, uint32_t width, uint32_t height)
{
	*picture = (struct picture){ width, height, malloc((size_t)width * height * 4) };
	for (size_t i = 0; i < (size_t)width * height; i++) {
		uint8_t *p = picture->rgba + 4 * i;

		p[0] = (uint8_t)(120 + (i % width) * 100 / width);
		p[1] = (uint8_t)(110 + (i / width) * 100 / height);
		p[2] = (uint8_t)((i % width / 20 + i / width / 20) % 2 ? 90 : 130);
		p[3] = 255;
	}
}

static bool get_picture(void *data, const char *name, struct found_picture *out)
{
	const struct picture *picture = strstr(name, "wide") ? &wide : &tall;

	(void)data;
	*out = (struct found_picture){ arrived ? picture : NULL, picture->width, picture->height };
	return true;
}

static int set_up(void **state)
{
	(void)state;
	paint(&wide, 640, 420);
	paint(&tall, 300, 900);
	arrived = true;
	return 0;
}

static int tear_down(void **state)
{
	(void)state;
	picture_finish(&wide);
	picture_finish(&tall);
	return 0;
}

static void settle(struct overlay *overlay)
{
	static int64_t now_ms = 1000;
	int frames = 0;

	while (overlay_update(overlay, now_ms += 20))
		CHECK(++frames < 500);
}

static struct overlay *open_page(int width_px, int height_px)
{
	const struct overlay_options options = { .width_px = width_px,
						 .height_px = height_px,
						 .languages = languages,
						 .language_count = 2,
						 .picture = get_picture };
	const struct overlay_part part = { "Tower", "", "", true };
	struct overlay *overlay;

	CHECK(overlay_create(&overlay, &options) == 0);
	CHECK(overlay_parts(overlay, &part, 1) == 0);
	CHECK(overlay_show_page(overlay, 0, compiled(page), "") == 0);
	settle(overlay);
	return overlay;
}

static void screen(struct overlay *overlay, const char *name)
{
	const char *folder = getenv("GOPURA_PICTURES");
	struct bitmap bitmap;
	cairo_t *context;
	char path[300];

	settle(overlay);
	CHECK(bitmap_init(&bitmap, overlay->width_px, overlay->height_px) == 0);
	context = bitmap_begin(&bitmap);
	cairo_set_source_rgb(context, 0.55, 0.52, 0.47);
	cairo_paint(context);
	overlay_paint(overlay, context);
	bitmap_end(&bitmap, context);
	if (folder) {
		snprintf(path, sizeof(path), "%s/gallery-%s-%dx%d.png", folder, name,
			 overlay->width_px, overlay->height_px);
		cairo_surface_write_to_png(bitmap.surface, path);
	}
	bitmap_finish(&bitmap);
}

static struct rect gallery_rect(const struct overlay *overlay)
{
	const struct screen now = overlay_screen(overlay);

	return gallery_view_rect(&now);
}

static bool place_of(const struct overlay *overlay, int picture, float place_px[4])
{
	const struct screen now = overlay_screen(overlay);

	return gallery_view_place(&overlay->gallery, &now, picture, place_px);
}

static struct overlay_action tap_button(const struct overlay *overlay,
					enum gallery_view_button button)
{
	const struct screen now = overlay_screen(overlay);
	struct rect rect = gallery_view_button(&now, button);

	return overlay_tap(overlay, (float)rect.x_px + (float)rect.width_px / 2,
			   (float)rect.y_px + (float)rect.height_px / 2);
}

static void a_tap_on_a_figure_opens_it(void **state)
{
	struct overlay *overlay = open_page(1920, 1080);
	struct rect view = page_window(overlay);
	struct overlay_action action = { 0 };

	(void)state;
	for (int y = view.y_px; y < view.y_px + view.height_px && action.kind != OVERLAY_PICTURE;
	     y += 10)
		action = overlay_tap(overlay, (float)(view.x_px + view.width_px / 2), (float)y);
	CHECK(action.kind == OVERLAY_PICTURE && action.picture == 0);
	overlay_show_picture(overlay, action.picture);
	CHECK(overlay_picture(overlay) == 0 && overlay_covers(overlay, 5, 5));
	CHECK(overlay_tap(overlay, 700, 500).kind == OVERLAY_SWALLOWED);
	CHECK(tap_button(overlay, GALLERY_BACK).kind == OVERLAY_SWALLOWED); /* it is the first */
	action = tap_button(overlay, GALLERY_ON);
	CHECK(action.kind == OVERLAY_PICTURE && action.picture == 1);
	action = tap_button(overlay, GALLERY_CLOSE);
	CHECK(action.kind == OVERLAY_PICTURE && action.picture == -1);
	overlay_show_picture(overlay, -1);
	CHECK(overlay_picture(overlay) == -1 && !overlay_covers(overlay, 5, 5));
	CHECK(overlay_page(overlay) == 0); /* it stays */
	overlay_show_picture(overlay, 3);
	CHECK(overlay_picture(overlay) == -1); /* there are three */
	settle(overlay);
	overlay_destroy(overlay);
}

static void fits_every_panel(void **state)
{
	static const int sizes[][2] = {
		{ 1920, 1080 }, { 1080, 1920 }, { 640, 360 }, { 320, 320 }
	};

	(void)state;
	for (size_t s = 0; s < ARRAY_COUNT(sizes); s++) {
		struct overlay *overlay = open_page(sizes[s][0], sizes[s][1]);
		struct rect view = gallery_rect(overlay);

		for (int picture = 0; picture < 3; picture++) {
			float place[4];

			overlay_show_picture(overlay, picture);
			screen(overlay, picture == 0 ? "wide" : picture == 1 ? "tall" : "last");
			CHECK(place_of(overlay, picture, place));
			CHECK(place[0] >= (float)view.x_px - 1 && place[1] >= (float)view.y_px - 1);
			CHECK(place[0] + place[2] <= (float)(view.x_px + view.width_px) + 1);
			CHECK(place[1] + place[3] <= (float)(view.y_px + view.height_px) + 1);
			CHECK(fabsf(place[2] / place[3] -
				    (picture == 1 ? 300.f / 900 : 640.f / 420)) < 0.02f);
		}
		overlay_destroy(overlay);
	}
}

static void a_pinch_zooms_about_the_fingers(void **state)
{
	struct overlay *overlay = open_page(1920, 1080);
	struct rect view = gallery_rect(overlay);
	float before[4], after[4], at_x, at_y;

	(void)state;
	overlay_show_picture(overlay, 0);
	settle(overlay);
	CHECK(place_of(overlay, 0, before));
	at_x = before[0] + before[2] * 0.4f;
	at_y = before[1] + before[3] * 0.6f;
	overlay_picture_pinch(overlay, at_x, at_y, 2, 0, 0);
	CHECK(place_of(overlay, 0, after));
	CHECK(fabsf(after[2] - 2 * before[2]) < 1);
	CHECK(fabsf((at_x - after[0]) / after[2] - 0.4f) < 0.01f);
	CHECK(fabsf((at_y - after[1]) / after[3] - 0.6f) < 0.01f);
	screen(overlay, "zoomed");

	overlay_picture_drag(overlay, 100000, 100000); /* no further than its edge */
	CHECK(place_of(overlay, 0, after));
	CHECK(after[0] <= (float)view.x_px + 1 && after[1] <= (float)view.y_px + 1);
	overlay_picture_drag_end(overlay, 90000);
	CHECK(overlay_picture(overlay) == 0); /* zoomed: it moves and does not turn */

	overlay_picture_pinch(overlay, at_x, at_y, 1000, 0, 0);
	CHECK(overlay->gallery.zoom < 5);
	overlay_picture_pinch(overlay, at_x, at_y, 0.0001f, 0, 0);
	CHECK(place_of(overlay, 0, after));
	CHECK(fabsf(after[0] - before[0]) < 1 && fabsf(after[2] - before[2]) < 1);
	overlay_picture_double_tap(overlay, at_x, at_y);
	CHECK(overlay->gallery.zoom > 2);
	overlay_picture_double_tap(overlay, at_x, at_y);
	CHECK(overlay->gallery.zoom == 1);
	overlay_destroy(overlay);
}

static void a_swipe_brings_the_next_and_ends_at_the_last(void **state)
{
	struct overlay *overlay = open_page(1920, 1080);

	(void)state;
	overlay_show_picture(overlay, 0);
	settle(overlay);
	overlay_picture_drag(overlay, -100, 3); /* too little, too slow */
	overlay_picture_drag_end(overlay, -50);
	CHECK(overlay_picture(overlay) == 0);
	settle(overlay);
	CHECK(overlay->gallery.swipe_px == 0);

	overlay_picture_drag(overlay, -100, 0);
	overlay_picture_drag_end(overlay, -1500); /* flicked */
	CHECK(overlay_picture(overlay) == 1);
	CHECK(overlay->gallery.swipe_px > 1700); /* it goes on from where the finger left it */
	settle(overlay);
	overlay_picture_drag(overlay, -600, 0); /* far, and then held */
	overlay_picture_drag_end(overlay, 0);
	CHECK(overlay_picture(overlay) == 2);
	settle(overlay);
	overlay_picture_drag(overlay, -900, 0);
	CHECK(overlay->gallery.swipe_px > -400); /* it resists */
	overlay_picture_drag_end(overlay, -5000);
	CHECK(overlay_picture(overlay) == 2);
	settle(overlay);
	overlay_picture_drag(overlay, 700, 0);
	overlay_picture_drag_end(overlay, 10);
	CHECK(overlay_picture(overlay) == 1);
	settle(overlay);
	overlay_destroy(overlay);
}

static void a_late_picture_fades_in(void **state)
{
	struct overlay *overlay;
	float place[4];

	(void)state;
	arrived = false;
	overlay = open_page(1280, 720);
	overlay_show_picture(overlay, 1);
	settle(overlay);
	CHECK(!place_of(overlay, 1, place));
	overlay_picture_pinch(overlay, 9, 9, 3, 0, 0); /* nothing to zoom */
	CHECK(overlay->gallery.zoom == 1);
	arrived = true;
	overlay_picture_arrived(overlay, "pictures/tall.png");
	settle(overlay);
	CHECK(place_of(overlay, 1, place));
	CHECK(!place_of(overlay, 0, place)); /* the others are not here yet */
	overlay_destroy(overlay);
}

static void what_closes_the_page_closes_its_pictures(void **state)
{
	struct overlay *overlay = open_page(1280, 720);

	(void)state;
	overlay_show_picture(overlay, 0);
	overlay_close_page(overlay);
	CHECK(overlay_picture(overlay) == -1);
	settle(overlay);
	CHECK(!overlay->page.article);
	overlay_show_picture(overlay, 0);
	CHECK(overlay_picture(overlay) == -1); /* of no page */
	CHECK(overlay_show_page(overlay, 0, compiled(page), "") == 0);
	overlay_show_picture(overlay, 2);
	CHECK(overlay_show_page(overlay, 0, compiled(page), "") ==
	      0); /* in another language, say */
	CHECK(overlay_picture(overlay) == -1);
	overlay_show_picture(overlay, 1);
	overlay_show_search(overlay, true);
	CHECK(overlay_picture(overlay) == -1);
	settle(overlay);
	overlay_destroy(overlay);
}

#define WITH_PICTURES(claim) cmocka_unit_test_setup_teardown(claim, set_up, tear_down)

int main(void)
{
	const struct CMUnitTest tests[] = {
		WITH_PICTURES(a_tap_on_a_figure_opens_it),
		WITH_PICTURES(fits_every_panel),
		WITH_PICTURES(a_pinch_zooms_about_the_fingers),
		WITH_PICTURES(a_swipe_brings_the_next_and_ends_at_the_last),
		WITH_PICTURES(a_late_picture_fades_in),
		WITH_PICTURES(what_closes_the_page_closes_its_pictures),
	};

	if (translate_open(TEST_LOCALE) < 0)
		return 1;
	return cmocka_run_group_tests(tests, NULL, NULL);
}
