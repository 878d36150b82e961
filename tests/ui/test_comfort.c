/* Large type, reach mode and what both rest on: contrasts, targets large enough for a finger, and
 * in reach mode everything that answers a finger in the lower third. With GOPURA_PICTURES=DIR set
 * it leaves its screens there. */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "tests/check.h"
#include "tests/ui/compiled.h"
#include "tests/ui/places.h"
#include "ui/overlay.h"
#include "ui/translate.h"

static const char *const languages[] = { "en", "fr", "km", "ja" };
static const char *const titles[] = { "Central tower", "Tour centrale", "ប្រាង្គកណ្ដាល", "中央塔" };
static const char *const captions[] = {
	"The mountain Meru at the middle of the world, built of sandstone in the twelfth century.",
	"Le mont Meru au centre du monde, bâti en grès au douzième siècle.",
	"ភ្នំព្រះសុមេរុនៅកណ្ដាលពិភពលោក សាងសង់ពីថ្មភក់ក្នុងសតវត្សទី១២។",
	"世界の中心にそびえる須弥山。十二世紀に砂岩で築かれた。",
};
static const char html[] =
	"<h1>Central tower</h1><p>The tower stands for <em>Mount Meru</em>, the axis of the world; "
	"see the <a href=\"part:gate\">east gopura</a>.</p><p>ប្រាសាទនេះតំណាងឱ្យ<em>ភ្នំព្រះសុមេរុ</em> "
	"ដែលជាអ័ក្សនៃពិភពលោក។</p><figure><img src=\"a.png\"><figcaption>At dawn</figcaption></figure>"
	"<p>Each face of the tower carries a false door. The mouldings repeat at every storey, "
	"smaller each time, so that the tower seems taller than it is.</p>"
	"<figure><img src=\"b.png\"><figcaption>At dusk</figcaption></figure><p>Restored.</p>";

enum { PARTS = 9 };

/* ---- contrast, by WCAG 2.2 */

static double linear(double c)
{
	return c <= 0.04045 ? c / 12.92 : pow((c + 0.055) / 1.055, 2.4);
}

static double luminance(struct colour c)
{
	return 0.2126 * linear(c.red) + 0.7152 * linear(c.green) + 0.0722 * linear(c.blue);
}

static double contrast(struct colour a, struct colour b)
{
	double x = luminance(a), y = luminance(b);

	return (fmax(x, y) + 0.05) / (fmin(x, y) + 0.05);
}

static struct colour mix(struct colour top, double alpha, struct colour below)
{
	return (struct colour){ top.red * alpha + below.red * (1 - alpha),
				top.green * alpha + below.green * (1 - alpha),
				top.blue * alpha + below.blue * (1 - alpha) };
}

static const struct colour white = { 1, 1, 1 }, black = { 0, 0, 0 }; /* stone at its extremes */

static void black_on_white_has_the_contrast_of_the_standard(void **state)
{
	(void)state;
	CHECK(fabs(contrast(black, white) - 21) < 1e-9);
	CHECK(fabs(contrast((struct colour){ 119 / 255.0, 119 / 255.0, 119 / 255.0 }, white) -
		   4.478) < 0.001); /* the grey that famously just fails */
}

/* A panel of 55 inches with 1920 pixels, and one of 24 inches. */
static void the_smallest_letters_have_pixels_on_any_panel(void **state)
{
	static const float widths_mm[] = { 1210, 530 };

	(void)state;
	for (size_t i = 0; i < ARRAY_COUNT(widths_mm); i++) {
		const float px_per_mm = theme_legible_px_per_mm(1920 / widths_mm[i]);
		struct theme theme;

		CHECK(theme_init(&theme, px_per_mm, "en") == 0);
		for (int style = 0; style < TEXT_STYLE_COUNT; style++)
			CHECK(theme_style_px(&theme, (enum text_style)style) >= 12);
		CHECK(px_per_mm >= 1920 / widths_mm[i] && px_per_mm < 4);
		theme_finish(&theme);
	}
	CHECK(theme_legible_px_per_mm(6) == 6);
}

static void every_text_stands_out_from_its_ground(void **state)
{
	const struct {
		const char *what;
		struct colour text, ground;
	} pairs[] = {
		{ "text", theme_ink, theme_paper },
		{ "text on a shade", theme_ink, theme_paper_shade },
		{ "soft text", theme_ink_soft, theme_paper },
		{ "the search's prompt", theme_ink_soft, theme_paper_shade },
		{ "a link", theme_accent, theme_paper },
		{ "a link on a shade", theme_accent, theme_paper_shade },
		{ "a button", theme_paper, theme_accent },
		{ "what is on, in the bar", theme_night, theme_night_text },
		{ "below a picture", theme_night_text, theme_night },
		{ "the bar over white", theme_night_text,
		  mix(theme_night, THEME_CHIP_ALPHA, white) },
		{ "the bar over black", theme_night_text,
		  mix(theme_night, THEME_CHIP_ALPHA, black) },
		{ "a label over white", theme_night_text,
		  mix(theme_night, THEME_LABEL_ALPHA, white) },
		{ "a label over black", theme_night_text,
		  mix(theme_night, THEME_LABEL_ALPHA, black) },
		{ "the chosen label over white", theme_night_text,
		  mix(theme_accent, THEME_CHOSEN_ALPHA, white) },
		{ "the chosen label over black", theme_night_text,
		  mix(theme_accent, THEME_CHOSEN_ALPHA, black) },
		{ "a picture's control over white", theme_night_text,
		  mix(theme_night, THEME_BUTTON_ALPHA, white) },
		{ "a line of the safe page that waits",
		  mix(theme_night_text, THEME_DIM_ALPHA, theme_night), theme_night },
	};

	(void)state;
	for (size_t i = 0; i < ARRAY_COUNT(pairs); i++) {
		double ratio = contrast(pairs[i].text, pairs[i].ground);

		printf("%5.2f %s\n", ratio, pairs[i].what);
		CHECK(ratio >= 4.5); /* of large type 3 would do */
	}
}

/* ---- screens */

static struct picture painted = { .width = 400, .height = 260 };

static bool get_picture(void *data, const char *name, struct found_picture *out)
{
	(void)data;
	(void)name;
	*out = (struct found_picture){ &painted, painted.width, painted.height };
	return true;
}

static int make_picture(void **state)
{
	(void)state;
	painted.rgba = malloc((size_t)painted.width * painted.height * 4);
	if (!painted.rgba)
		return -1;
	for (uint32_t i = 0; i < painted.width * painted.height; i++)
		memcpy(painted.rgba + (size_t)i * 4,
		       (const uint8_t[]){ (uint8_t)(150 + i % 40), 130, 104, 255 }, 4);
	return 0;
}

static int drop_picture(void **state)
{
	(void)state;
	picture_finish(&painted);
	return 0;
}

static void settle(struct overlay *overlay)
{
	static int64_t now_ms = 1000;
	int frames = 0;

	while (overlay_update(overlay, now_ms += 20))
		CHECK(++frames < 500);
}

static void give_anchors(struct overlay *overlay)
{
	struct rect scene = overlay_scene_rect(overlay);
	struct overlay_anchor anchors[PARTS] = { 0 };

	for (int i = 0; i < PARTS; i++) {
		float turn = (float)i * 2.4f, radius = 0.04f + 0.02f * (float)i;

		anchors[i].x_px =
			(float)scene.x_px + (float)scene.width_px * (0.5f + radius * cosf(turn));
		anchors[i].y_px =
			(float)scene.y_px + (float)scene.height_px * (0.45f + radius * sinf(turn));
		anchors[i].visible = true;
	}
	overlay_anchors(overlay, anchors, PARTS);
	settle(overlay);
}

static void set_language(struct overlay *overlay, int language)
{
	struct overlay_part parts[PARTS];

	for (int i = 0; i < PARTS; i++)
		parts[i] = (struct overlay_part){ titles[language], captions[language], "a.png",
						  true };
	overlay_language(overlay, languages[language]);
	CHECK(overlay_parts(overlay, parts, PARTS) == 0);
}

/* As many as there may be. */
static void set_tours(struct overlay *overlay, int language)
{
	struct overlay_tour tours[OVERLAY_TOURS_MAX];

	for (int i = 0; i < OVERLAY_TOURS_MAX; i++)
		tours[i] = (struct overlay_tour){ titles[language], captions[language],
						  i % 2 ? "a.png" : "" };
	CHECK(overlay_tours(overlay, tours, OVERLAY_TOURS_MAX) == 0);
}

static void show_tour(struct overlay *overlay, int language, bool paused)
{
	const struct overlay_tour_state state = { .tour = 1,
						  .stop = 2,
						  .stop_count = 7,
						  .caption = captions[language],
						  .paused = paused };

	overlay_show_tour(overlay, &state);
}

static struct overlay *open_overlay(int width_px, int height_px)
{
	const struct overlay_options options = { .width_px = width_px,
						 .height_px = height_px,
						 .languages = languages,
						 .language_count = ARRAY_COUNT(languages),
						 .picture = get_picture };
	struct overlay *overlay;

	CHECK(overlay_create(&overlay, &options) == 0);
	set_language(overlay, 0);
	overlay_show_help(overlay, false);
	overlay_offer_back(overlay, true);
	give_anchors(overlay);
	return overlay;
}

static void show_page(struct overlay *overlay)
{
	CHECK(overlay_show_page(overlay, 0, compiled(html), "© The museum") == 0);
}

static void paint(struct overlay *overlay, const char *screen)
{
	static const char *const modes[] = { "usual", "large", "reach", "both" };
	const char *folder = getenv("GOPURA_PICTURES");
	struct overlay_comfort comfort = overlay_comfort(overlay);
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
	snprintf(path, sizeof(path), "%s/comfort-%s-%s-%s-%dx%d.png", folder,
		 modes[comfort.large + 2 * comfort.reach], screen, overlay->theme.language,
		 overlay->width_px, overlay->height_px);
	cairo_surface_write_to_png(bitmap.surface, path);
	bitmap_finish(&bitmap);
}

/* ---- what answers a finger, by feeling the whole panel */

#ifdef __SANITIZE_ADDRESS__ /* the release build feels the same panels more finely */
enum { STEP_PX = 12 };
#else
enum { STEP_PX = 8 };
#endif
enum { CONTROLS_MAX = 200 };

struct control {
	struct overlay_action action;
	int left_px, top_px, right_px, bottom_px;
};

static bool is_same(const struct overlay_action *a, const struct overlay_action *b)
{
	return a->kind == b->kind && a->part == b->part && a->language == b->language &&
	       (a->kind != OVERLAY_TOUR || a->tour == b->tour) &&
	       (a->kind != OVERLAY_KEY || a->key == b->key) &&
	       (a->kind != OVERLAY_PICTURE || a->picture == b->picture);
}

static uint32_t feel(const struct overlay *overlay, struct control *controls)
{
	uint32_t count = 0, i = 0;

	for (int y = 0; y < overlay->height_px; y += STEP_PX) {
		for (int x = 0; x < overlay->width_px; x += STEP_PX) {
			struct overlay_action action = overlay_tap(overlay, (float)x, (float)y);

			if (action.kind == OVERLAY_NONE || action.kind == OVERLAY_SWALLOWED)
				continue;
			/* What answers alike in two places, such as the search's two, is two. */
			for (i = 0; i < count; i++)
				if (is_same(&controls[i].action, &action) &&
				    x <= controls[i].right_px + STEP_PX &&
				    x >= controls[i].left_px - 2 * STEP_PX &&
				    y <= controls[i].bottom_px + STEP_PX)
					break;
			if (i == count) {
				CHECK(count < CONTROLS_MAX);
				controls[count++] = (struct control){ action, x, y, x, y };
			}
			controls[i].left_px = x < controls[i].left_px ? x : controls[i].left_px;
			controls[i].right_px = x > controls[i].right_px ? x : controls[i].right_px;
			controls[i].bottom_px = y;
		}
	}
	return count;
}

/* From its middle, to the pixel. */
static int walk(const struct overlay *overlay, const struct control *c, int dx, int dy)
{
	int x = (c->left_px + c->right_px) / 2, y = (c->top_px + c->bottom_px) / 2, steps = 0;

	for (;; steps++, x += dx, y += dy) {
		struct overlay_action action = overlay_tap(overlay, (float)x, (float)y);

		if (x < 0 || y < 0 || x >= overlay->width_px || y >= overlay->height_px ||
		    !is_same(&action, &c->action))
			return steps;
	}
}

static bool has(const struct control *controls, uint32_t count, enum overlay_action_kind kind)
{
	for (uint32_t i = 0; i < count; i++)
		if (controls[i].action.kind == kind)
			return true;
	return false;
}

/* Rows and links may be half scrolled away; all else is as large as a finger. */
static bool may_be_cut(enum overlay_action_kind kind)
{
	return kind == OVERLAY_FOUND || kind == OVERLAY_LINK || kind == OVERLAY_PICTURE;
}

static void feel_all(struct overlay *overlay, const char *screen, enum overlay_action_kind expected)
{
	struct control controls[CONTROLS_MAX];
	int least_px = theme_px(&overlay->theme, THEME_TARGET_MM);
	uint32_t count;

	settle(overlay);
	paint(overlay, screen);
	count = feel(overlay, controls);
	CHECK(has(controls, count, OVERLAY_HOME) && has(controls, count, OVERLAY_HELP) &&
	      has(controls, count, OVERLAY_LANGUAGE) && has(controls, count, expected));
	for (uint32_t i = 0; i < count; i++) {
		const struct control *c = &controls[i];
		int wide_px = walk(overlay, c, 1, 0) + walk(overlay, c, -1, 0) - 1;
		int high_px = walk(overlay, c, 0, 1) + walk(overlay, c, 0, -1) - 1;
		bool large = wide_px >= least_px && high_px >= least_px;
		bool low = 3 * c->top_px >= 2 * overlay->height_px;

		if (overlay_comfort(overlay).reach && !low)
			printf("%s: action %d at %d, %d is too high\n", screen, (int)c->action.kind,
			       c->left_px, c->top_px);
		CHECK(low || !overlay_comfort(overlay).reach);
		if (!large && !may_be_cut(c->action.kind))
			printf("%s: action %d at %d, %d is %d x %d px\n", screen,
			       (int)c->action.kind, c->left_px, c->top_px, wide_px, high_px);
		CHECK(large || may_be_cut(c->action.kind));
	}
}

static const int sizes[][2] = { { 1280, 720 }, { 1920, 1080 }, { 1080, 1920 }, { 800, 1280 } };

static void every_target_is_9_mm_and_in_reach_mode_low(void **state)
{
	(void)state;
	for (size_t s = 0; s < ARRAY_COUNT(sizes); s++) {
		struct overlay *overlay = open_overlay(sizes[s][0], sizes[s][1]);

		for (int mode = 0; mode < 4; mode++) {
			overlay_set_comfort(overlay,
					    (struct overlay_comfort){ mode & 1, mode & 2 });
			CHECK(overlay_comfort(overlay).large == (mode & 1) &&
			      overlay_comfort(overlay).reach == ((mode & 2) != 0));
			for (int language = 0; language < 4; language += 2) {
				set_language(overlay, language);
				give_anchors(overlay);
				feel_all(overlay, "labels", OVERLAY_OPEN_CARD);
				overlay_show_card(overlay, 0);
				feel_all(overlay, "card", OVERLAY_CLOSE_CARD);
				overlay_show_search(overlay, true);
				feel_all(overlay, "search", OVERLAY_KEY);
				show_page(overlay);
				feel_all(overlay, "page", OVERLAY_CLOSE_PAGE);
				overlay_widen_page(overlay, true);
				feel_all(overlay, "page-wide", OVERLAY_CLOSE_PAGE);
				overlay_show_card(overlay, 1); /* by a link, beside the page */
				feel_all(overlay, "page-card", OVERLAY_CLOSE_CARD);
				overlay_show_card(overlay, -1);
				overlay_show_picture(overlay, 0);
				feel_all(overlay, "picture", OVERLAY_PICTURE);
				overlay_close_page(overlay);
				settle(overlay);
				overlay_show_help(overlay, true);
				feel_all(overlay, "help", OVERLAY_HELP);
				overlay_show_help(overlay, false);
				set_tours(overlay, language);
				overlay_show_tours(overlay, true);
				feel_all(overlay, "tours", OVERLAY_TOUR);
				overlay_show_tours(overlay, false);
				show_tour(overlay, language, false);
				feel_all(overlay, "tour", OVERLAY_TOUR_CLOSE);
				show_tour(overlay, language, true);
				feel_all(overlay, "tour-halted", OVERLAY_TOUR_PAUSE);
				overlay_show_tour(overlay, NULL);
				settle(overlay);
			}
		}
		overlay_destroy(overlay);
	}
}

/* Where the keyboard has many letters. */
static void keys_are_fingers_wide_in_every_mode_and_language(void **state)
{
	(void)state;
	for (size_t s = 0; s < ARRAY_COUNT(sizes); s++) {
		struct overlay *overlay = open_overlay(sizes[s][0], sizes[s][1]);
		int least_px = theme_px(&overlay->theme, THEME_TARGET_MM);

		for (int mode = 0; mode < 4; mode++) {
			overlay_set_comfort(overlay,
					    (struct overlay_comfort){ mode & 1, mode & 2 });
			for (int language = 0; language < 4; language++) {
				struct keyboard *keyboard = &overlay->search.keyboard;

				set_language(overlay, language);
				overlay_show_search(overlay, true);
				for (uint32_t i = 0; i < keyboard->key_count; i++)
					CHECK(keyboard->keys[i].width_px >= least_px &&
					      keyboard->keys[i].height_px >= least_px);
				CHECK(list_place(overlay).height_px >= least_px);
				overlay_show_search(overlay, false);
			}
		}
		overlay_destroy(overlay);
	}
}

static void the_bar_stays_where_it_is(void **state)
{
	struct overlay *overlay = open_overlay(1280, 720);
	struct bar_view before = overlay->bar;
	struct rect bar = bar_place(overlay);

	(void)state;
	for (int mode = 0; mode < 4; mode++) {
		struct rect now;

		overlay_set_comfort(overlay, (struct overlay_comfort){ mode & 1, mode & 2 });
		now = bar_place(overlay);
		CHECK(now.x_px == bar.x_px && now.y_px == bar.y_px &&
		      now.height_px == bar.height_px);
		CHECK(!overlay->bar.codes && now.x_px + now.width_px < 640);
		for (uint32_t i = 0; overlay->bar.buttons[i].kind != BAR_LANGUAGE; i++)
			CHECK(overlay->bar.buttons[i].kind == before.buttons[i].kind &&
			      overlay->bar.buttons[i].x_px == before.buttons[i].x_px);
	}
	overlay_destroy(overlay);
}

static void large_type_is_larger_and_keeps_the_place_that_is_read(void **state)
{
	struct overlay *overlay = open_overlay(1280, 720);
	int usual_px = theme_style_px(&overlay->theme, TEXT_BODY), height_px, large_px;
	float read;

	(void)state;
	show_page(overlay);
	settle(overlay);
	height_px = article_layout_height_px(overlay->page.article);
	overlay_scroll(overlay, -100);
	read = overlay->page.scroll.px / (float)height_px;
	overlay_set_comfort(overlay, (struct overlay_comfort){ .large = true });
	settle(overlay);
	CHECK(fabsf((float)theme_style_px(&overlay->theme, TEXT_BODY) -
		    THEME_LARGE_TYPE * (float)usual_px) < 1.5f);
	large_px = article_layout_height_px(overlay->page.article);
	CHECK(large_px > height_px);
	CHECK(fabsf(overlay->page.scroll.px /
			    (float)article_layout_height_px(overlay->page.article) -
		    read) < 0.001f);
	overlay_set_comfort(overlay, (struct overlay_comfort){ 0 });
	CHECK(article_layout_height_px(overlay->page.article) == height_px);
	overlay_set_comfort(overlay, (struct overlay_comfort){ .large = true });
	show_page(
		overlay); /* as a page is that opens so: no line is left as it was broken before */
	CHECK(article_layout_height_px(overlay->page.article) == large_px);
	overlay_destroy(overlay);
}

static void a_panel_within_reach_as_a_whole_has_no_reach_mode(void **state)
{
	static const int small[][2] = { { 640, 360 }, { 360, 640 }, { 320, 320 } };

	(void)state;
	for (size_t s = 0; s < ARRAY_COUNT(small); s++) {
		struct overlay *overlay = open_overlay(small[s][0], small[s][1]);
		struct control controls[CONTROLS_MAX];

		overlay_set_comfort(overlay, (struct overlay_comfort){ true, true });
		CHECK(overlay_comfort(overlay).large && !overlay_comfort(overlay).reach);
		give_anchors(overlay);
		CHECK(!has(controls, feel(overlay, controls), OVERLAY_REACH));
		CHECK(has(controls, feel(overlay, controls), OVERLAY_LARGE));
		overlay_destroy(overlay);
	}
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(black_on_white_has_the_contrast_of_the_standard),
		cmocka_unit_test(every_text_stands_out_from_its_ground),
		cmocka_unit_test(the_smallest_letters_have_pixels_on_any_panel),
		cmocka_unit_test(every_target_is_9_mm_and_in_reach_mode_low),
		cmocka_unit_test(keys_are_fingers_wide_in_every_mode_and_language),
		cmocka_unit_test(the_bar_stays_where_it_is),
		cmocka_unit_test(large_type_is_larger_and_keeps_the_place_that_is_read),
		cmocka_unit_test(a_panel_within_reach_as_a_whole_has_no_reach_mode),
	};

	if (translate_open(TEST_LOCALE) < 0)
		return 1;
	return cmocka_run_group_tests(tests, make_picture, drop_picture);
}
