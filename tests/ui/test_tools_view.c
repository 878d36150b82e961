/* The tools' controls: where the bar has them, what of them answers a finger, and what they leave
 * to the rest. With GOPURA_PICTURES=DIR set it leaves its screens there. */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "tests/check.h"
#include "tests/ui/compiled.h"
#include "tests/ui/places.h"
#include "ui/overlay.h"
#include "ui/translate.h"

enum { PARTS = 9, BOTH = OVERLAY_TOOL_LIGHT | OVERLAY_TOOL_SECTION, STEP_PX = 4 };

static const char *const languages[] = { "en", "fr", "km", "ja" };
static const int sizes[][2] = { { 1280, 720 }, { 1920, 1080 }, { 1080, 1920 }, { 800, 1280 } };

static void settle(struct overlay *overlay)
{
	static int64_t now_ms = 1000;
	int frames = 0;

	while (overlay_update(overlay, now_ms += 20))
		CHECK(++frames < 500);
}

static void show(struct overlay *overlay, unsigned on)
{
	overlay_show_tools(overlay, &(struct overlay_tools){ .on = on,
							     .light_at = { -0.6f, 0.5f },
							     .turn_rad = 2.4f,
							     .push = 0.3f });
	settle(overlay);
}

static struct overlay *open_overlay(int width_px, int height_px, unsigned tools)
{
	const struct overlay_options options = { .width_px = width_px,
						 .height_px = height_px,
						 .languages = languages,
						 .language_count = ARRAY_COUNT(languages) };
	struct overlay_anchor anchors[PARTS];
	struct overlay_part parts[PARTS];
	struct overlay *overlay;

	CHECK(overlay_create(&overlay, &options) == 0);
	overlay_offer_tools(overlay, tools);
	for (int i = 0; i < PARTS; i++) {
		const float turn = (float)i * 2.4f, radius = 0.04f + 0.02f * (float)i;

		parts[i] = (struct overlay_part){ "A part of the temple", "Of stone.", "", true };
		anchors[i] = (struct overlay_anchor){
			.x_px = (float)width_px * (0.5f + radius * cosf(turn)),
			.y_px = (float)height_px * (0.45f + radius * sinf(turn)),
			.visible = true,
			.size_px = (float)height_px / 4,
		};
	}
	CHECK(overlay_parts(overlay, parts, PARTS) == 0);
	overlay_show_help(overlay, false);
	overlay_anchors(overlay, anchors, PARTS);
	settle(overlay);
	return overlay;
}

static void paint(struct overlay *overlay, const char *screen)
{
	const char *folder = getenv("GOPURA_PICTURES");
	const struct overlay_comfort comfort = overlay_comfort(overlay);
	struct bitmap bitmap;
	cairo_t *context;
	char path[300];

	if (!folder)
		return;
	CHECK(bitmap_init(&bitmap, overlay->width_px, overlay->height_px) == 0);
	context = bitmap_begin(&bitmap);
	cairo_set_source_rgb(context, 0.55, 0.52, 0.47);
	cairo_paint(context);
	overlay_paint(overlay, context);
	bitmap_end(&bitmap, context);
	snprintf(path, sizeof(path), "%s/tools-%s-%d-%s-%dx%d.png", folder, screen,
		 comfort.large + 2 * comfort.reach, overlay->theme.language, overlay->width_px,
		 overlay->height_px);
	cairo_surface_write_to_png(bitmap.surface, path);
	bitmap_finish(&bitmap);
}

static const struct bar_view_button *button_of(const struct overlay *overlay,
					       enum bar_view_button_kind kind)
{
	for (uint32_t i = 0; i < overlay->bar.button_count; i++)
		if (overlay->bar.buttons[i].kind == kind)
			return &overlay->bar.buttons[i];
	return NULL;
}

static enum overlay_action_kind tap_button(const struct overlay *overlay,
					   enum bar_view_button_kind kind)
{
	const struct bar_view_button *button = button_of(overlay, kind);
	const struct rect bar = bar_place(overlay);

	return overlay_tap(overlay, (float)(bar.x_px + button->x_px) + (float)button->width_px / 2,
			   (float)bar.y_px + (float)bar.height_px / 2)
		.kind;
}

static void the_bar_has_the_tools_of_the_content_and_no_others(void **state)
{
	(void)state;
	for (unsigned tools = 0; tools <= BOTH; tools++) {
		struct overlay *overlay = open_overlay(1280, 720, tools);
		const int target_px = theme_px(&overlay->theme, THEME_TARGET_MM);
		const struct bar_view before = overlay->bar;

		CHECK(!!button_of(overlay, BAR_LIGHT) == !!(tools & OVERLAY_TOOL_LIGHT));
		CHECK(!!button_of(overlay, BAR_SECTION) == !!(tools & OVERLAY_TOOL_SECTION));
		CHECK(overlay_tools_offered(overlay) == tools);
		if (tools & OVERLAY_TOOL_LIGHT)
			CHECK(tap_button(overlay, BAR_LIGHT) == OVERLAY_LIGHT &&
			      button_of(overlay, BAR_LIGHT)->width_px >= target_px);
		if (tools & OVERLAY_TOOL_SECTION)
			CHECK(tap_button(overlay, BAR_SECTION) == OVERLAY_SECTION &&
			      button_of(overlay, BAR_SECTION)->width_px >= target_px);
		for (int mode = 0; mode < 8; mode++) { /* always in the same place */
			overlay_set_comfort(overlay,
					    (struct overlay_comfort){ mode & 1, mode & 2 });
			overlay_language(overlay, languages[mode / 2]);
			show(overlay, mode & 1 ? tools : 0);
			for (uint32_t i = 0; before.buttons[i].kind != BAR_LANGUAGE; i++)
				CHECK(overlay->bar.buttons[i].kind == before.buttons[i].kind &&
				      overlay->bar.buttons[i].x_px == before.buttons[i].x_px);
		}
		overlay_destroy(overlay);
	}
}

static void a_panel_too_small_for_them_goes_without(void **state)
{
	struct overlay *overlay = open_overlay(320, 320, BOTH);

	(void)state;
	CHECK(overlay_tools_offered(overlay) == 0 && !button_of(overlay, BAR_LIGHT));
	show(overlay, BOTH);
	for (int y = 0; y < 320; y += STEP_PX)
		for (int x = 0; x < 320; x += STEP_PX)
			CHECK(overlay_handle_at(overlay, (float)x, (float)y) ==
			      OVERLAY_HANDLE_NONE);
	overlay_destroy(overlay);
}

struct felt {
	int left, top, right, bottom;
	int run; /* the longest without a gap across */
};

/* Where handles are, found in steps that are smaller than any of them. */
static struct rect handles_rect(const struct overlay *overlay)
{
	int left = overlay->width_px, top = overlay->height_px, right = 0, bottom = 0;

	for (int y = 0; y < overlay->height_px; y += STEP_PX)
		for (int x = 0; x < overlay->width_px; x += STEP_PX) {
			if (overlay_handle_at(overlay, (float)x, (float)y) == OVERLAY_HANDLE_NONE)
				continue;
			left = x - STEP_PX < left ? x - STEP_PX : left;
			top = y - STEP_PX < top ? y - STEP_PX : top;
			right = x + STEP_PX > right ? x + STEP_PX : right;
			bottom = y + STEP_PX > bottom ? y + STEP_PX : bottom;
		}
	return (struct rect){ left, top, right - left, bottom - top };
}

static void feel(const struct overlay *overlay, struct felt felt[4])
{
	const struct rect where = handles_rect(overlay);

	for (int i = 0; i < 4; i++)
		felt[i] = (struct felt){ 1 << 20, 1 << 20, -1, -1, 0 };
	for (int y = where.y_px; y < where.y_px + where.height_px; y++) {
		int before = OVERLAY_HANDLE_NONE, run = 0;

		for (int x = where.x_px; x < where.x_px + where.width_px; x++) {
			const int at = (int)overlay_handle_at(overlay, (float)x, (float)y);
			struct felt *f = &felt[at];

			run = at == before ? run + 1 : 1;
			before = at;
			f->run = run > f->run ? run : f->run;
			f->left = x < f->left ? x : f->left;
			f->top = y < f->top ? y : f->top;
			f->right = x > f->right ? x : f->right;
			f->bottom = y > f->bottom ? y : f->bottom;
			if (at != OVERLAY_HANDLE_NONE) /* and it is nobody else's */
				CHECK(overlay_tap(overlay, (float)x, (float)y).kind ==
					      OVERLAY_SWALLOWED &&
				      overlay_covers(overlay, (float)x, (float)y));
		}
	}
}

static void every_handle_is_9_mm_and_in_reach_mode_low(void **state)
{
	(void)state;
	for (size_t s = 0; s < ARRAY_COUNT(sizes); s++) {
		struct overlay *overlay = open_overlay(sizes[s][0], sizes[s][1], BOTH);
		const int target_px = theme_px(&overlay->theme, THEME_TARGET_MM);

		for (int mode = 0; mode < 4; mode++) {
			const bool reach = mode & 2;
			struct felt felt[4];

			overlay_set_comfort(overlay,
					    (struct overlay_comfort){ mode & 1, mode & 2 });
			overlay_language(overlay, languages[mode]);
			show(overlay, BOTH);
			paint(overlay, "both");
			feel(overlay, felt);
			const struct screen now = overlay_screen(overlay);
			const struct tools_view_obstacles obstacles =
				overlay_obstacles(overlay, &now);

			for (int handle = 1; handle < 4; handle++) {
				const struct felt *f = &felt[handle];

				CHECK(f->run >= target_px && f->bottom - f->top >= target_px);
				if (overlay_comfort(overlay).reach)
					CHECK(3 * f->top >= 2 * overlay->height_px);
			}
			CHECK(reach == overlay_comfort(overlay).reach);
			/* The turn's ring is a finger wide wherever it is grasped. */
			CHECK((felt[OVERLAY_HANDLE_TURN].bottom -
			       felt[OVERLAY_HANDLE_PUSH].bottom) >= target_px - 1);
			for (uint32_t i = 0; i < CALLOUT_LABELS; i++) {
				const struct callouts_view_label *label =
					&overlay->callouts.labels[i];

				if (label->part >= 0 && label->fade.on)
					CHECK(label->place.y_px + callouts_view_row_px(&now) <=
						      tools_view_top(&overlay->tools, &now,
								     &obstacles) ||
					      label->place.x_px + label->place.width_px <=
						      tools_view_left(&overlay->tools, &now,
								      &obstacles));
			}
		}
		overlay_destroy(overlay);
	}
}

static void a_finger_on_the_ring_is_where_the_knob_comes_to(void **state)
{
	struct overlay *overlay = open_overlay(1280, 720, BOTH);
	const struct screen now = overlay_screen(overlay);
	struct tools_view_knobs knobs;
	float at[2];

	(void)state;
	show(overlay, BOTH);
	tools_view_knobs(&overlay->tools, &now, &knobs);
	CHECK(overlay_handle_at(overlay, knobs.light[0], knobs.light[1]) == OVERLAY_HANDLE_LIGHT);
	overlay_handle_place(overlay, OVERLAY_HANDLE_LIGHT, knobs.light[0], knobs.light[1], at);
	CHECK(fabsf(at[0] + 0.6f) < 1e-4f && fabsf(at[1] - 0.5f) < 1e-4f);
	CHECK(overlay_handle_at(overlay, knobs.turn[0], knobs.turn[1]) == OVERLAY_HANDLE_TURN);
	overlay_handle_place(overlay, OVERLAY_HANDLE_TURN, knobs.turn[0], knobs.turn[1], at);
	CHECK(fabsf(hypotf(at[0], at[1]) - 1) < 1e-4f &&
	      fabsf(atan2f(-at[0], at[1]) - 2.4f) < 1e-4f);
	CHECK(overlay_handle_at(overlay, knobs.push[0], knobs.push[1]) == OVERLAY_HANDLE_PUSH);
	overlay_handle_place(overlay, OVERLAY_HANDLE_PUSH, knobs.push[0], knobs.push[1], at);
	CHECK(fabsf(hypotf(at[0], at[1]) - 0.3f) < 1e-4f);
	overlay_destroy(overlay);
}

static bool shows(const struct overlay *overlay, int tool)
{
	const struct screen now = overlay_screen(overlay);
	const struct tools_view_obstacles obstacles = overlay_obstacles(overlay, &now);

	return tools_view_shows(&overlay->tools, &now, &obstacles, tool);
}

static void what_is_read_comes_before_what_is_held(void **state)
{
	static const char html[] = "<h1>A tower</h1><p>Of stone.</p>";
	struct overlay *wide = open_overlay(1920, 1080, BOTH);
	struct overlay *narrow = open_overlay(800, 1280, BOTH);
	struct screen now;
	struct rect rect;

	(void)state;
	show(wide, BOTH);
	show(narrow, BOTH);
	CHECK(shows(narrow, 0) && shows(narrow, 1));
	overlay_show_card(narrow, 0);
	CHECK(!shows(narrow, 0)); /* the card has that place; the light stays on */
	overlay_show_card(narrow, -1);
	CHECK(shows(narrow, 0));
	CHECK(overlay_show_page(wide, 0, compiled(html), "") == 0);
	settle(wide);
	now = overlay_screen(wide);
	rect = tools_view_rect(&wide->tools, &now, 0);
	CHECK(shows(wide, 0) && rect.x_px + rect.width_px <= wide->width_px / 2);
	paint(wide, "page");
	overlay_ask(wide, 9); /* whoever asks takes every touch */
	CHECK(overlay_handle_at(wide, (float)rect.x_px + (float)rect.width_px / 2,
				(float)rect.y_px + (float)rect.height_px / 2) ==
	      OVERLAY_HANDLE_NONE);
	overlay_destroy(wide);
	overlay_destroy(narrow);
}

static void tools_at_rest_cost_no_frame(void **state)
{
	struct overlay *overlay = open_overlay(1280, 720, BOTH);

	(void)state;
	show(overlay, BOTH);
	const uint32_t drawn = overlay->tools.discs[0].revision;

	CHECK(drawn > 0);
	for (int i = 0; i < 20; i++) { /* a knob moves without being drawn anew */
		overlay_show_tools(overlay,
				   &(struct overlay_tools){ .on = BOTH, .push = (float)i / 20 });
		CHECK(!overlay_update(overlay, 100000 + 20 * i));
	}
	CHECK(overlay->tools.discs[0].revision == drawn);
	overlay_destroy(overlay);
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(the_bar_has_the_tools_of_the_content_and_no_others),
		cmocka_unit_test(a_panel_too_small_for_them_goes_without),
		cmocka_unit_test(every_handle_is_9_mm_and_in_reach_mode_low),
		cmocka_unit_test(a_finger_on_the_ring_is_where_the_knob_comes_to),
		cmocka_unit_test(what_is_read_comes_before_what_is_held),
		cmocka_unit_test(tools_at_rest_cost_no_frame),
	};

	if (translate_open(TEST_LOCALE) < 0)
		return 1;
	return cmocka_run_group_tests(tests, NULL, NULL);
}
