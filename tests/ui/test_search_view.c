/* The search on every panel and in every language that has a keyboard: keys are large enough, say
 * what they show, and what is found can be read and tapped. With GOPURA_PICTURES=DIR set it leaves
 * its screens there. */
#include "ui/overlay.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "tests/check.h"
#include "tests/ui/compiled.h"
#include "tests/ui/places.h"
#include "ui/translate.h"

enum { PARTS = 12, LANGUAGES = 17 };

/* Those from the third on are written in other letters than Latin. */
static const char *const languages[LANGUAGES] = { "en", "fr", "de", "km", "ja", "ar",
						  "th", "hi", "ko", "ru", "uk", "el",
						  "he", "fa", "lo", "my", "ta" };
static const char *const titles[LANGUAGES] = {
	"The central tower", "La tour centrale", "Der Hauptturm",
	"ប្រាង្គកណ្តាល",        "中央塔",           "البرج المركزي",
	"ปรางค์ประธาน",       "मध्य शिखर",         "중앙 탑",
	"Центральная башня", "Центральна вежа",  "Ο κεντρικός πύργος",
	"המגדל המרכזי",      "برج مرکزی",        "ຫໍກາງ",
	"အလယ်မျှော်စင်",         "மைய கோபுரம்",
};
static const char *const captions[LANGUAGES] = {
	"The mountain at the middle of the world, in stone.",
	"La montagne au milieu du monde, en pierre.",
	"Der Berg in der Mitte der Welt, aus Stein.",
	"ភ្នំកណ្តាលពិភពលោក ធ្វើពីថ្ម។",
	"世界の中心の山を、石でかたどる。",
	"الجبل في وسط العالم، من الحجر.",
	"ภูเขากลางโลกที่สร้างด้วยหิน",
	"संसार के मध्य का पर्वत, पत्थर में।",
	"세계의 한가운데 있는 산을 돌로 지었다.",
	"Гора в центре мира, из камня.",
	"Гора в центрі світу, з каменю.",
	"Το βουνό στη μέση του κόσμου, από πέτρα.",
	"ההר שבמרכז העולם, מאבן.",
	"کوه میانهٔ جهان، از سنگ.",
	"ພູເຂົາກາງໂລກ ສ້າງດ້ວຍຫີນ.",
	"ကမ္ဘာ့အလယ်က တောင်၊ ကျောက်ဖြင့်။",
	"உலகின் நடுவில் உள்ள மலை, கல்லில்.",
};

static uint8_t pixels[8 * 8 * 4];
static struct picture thumbnail = { 8, 8, pixels };
static bool arrived = true;
static uint32_t asked;

static bool get_picture(void *data, const char *name, struct found_picture *out)
{
	(void)data;
	asked++;
	*out = (struct found_picture){ arrived ? &thumbnail : NULL, 8, 8 };
	return strcmp(name, "pictures/a.png") == 0;
}

static void give_parts(struct overlay *overlay, int language)
{
	struct overlay_part parts[PARTS];

	for (int i = 0; i < PARTS; i++)
		parts[i] = (struct overlay_part){ titles[language],
						  i % 3 == 2 ? "" : captions[language],
						  i % 4 == 3 ? "" : "pictures/a.png", true };
	CHECK(overlay_parts(overlay, parts, PARTS) == 0);
}

static struct overlay *open_overlay(int width_px, int height_px)
{
	const struct overlay_options options = { .width_px = width_px,
						 .height_px = height_px,
						 .languages = languages,
						 .language_count = LANGUAGES,
						 .picture = get_picture };
	struct overlay *overlay;

	for (size_t i = 0; i < sizeof(pixels); i++)
		pixels[i] = (uint8_t)(i % 4 == 3 ? 255 : 100 + i % 97);
	arrived = true;
	CHECK(overlay_create(&overlay, &options) == 0);
	give_parts(overlay, 0);
	return overlay;
}

static void settle(struct overlay *overlay)
{
	static int64_t now_ms = 1000;
	int frames = 0;

	while (overlay_update(overlay, now_ms += 20))
		CHECK(++frames < 500);
}

static struct bitmap screen(struct overlay *overlay, const char *name)
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
		snprintf(path, sizeof(path), "%s/search-%s-%dx%d.png", folder, name,
			 overlay->width_px, overlay->height_px);
		cairo_surface_write_to_png(bitmap.surface, path);
	}
	return bitmap;
}

/* The middle of a key, on the panel. */
static struct rect keyboard_place(const struct overlay *overlay)
{
	const struct screen now = overlay_screen(overlay);

	return search_view_keyboard(&overlay->search, &now);
}

static int row_px(const struct overlay *overlay)
{
	const struct screen now = overlay_screen(overlay);

	return search_view_row_px(&overlay->search, &now);
}

static int scroll_most(const struct overlay *overlay)
{
	const struct screen now = overlay_screen(overlay);

	return search_view_scroll_most(&overlay->search, &now);
}

static bool is_row(const struct overlay *overlay, uint32_t bitmap)
{
	for (uint32_t i = 0; i < SEARCH_ROWS; i++)
		if (overlay->search.rows[i].sprite.id == bitmap)
			return true;
	return false;
}

static struct overlay_action tap_key(const struct overlay *overlay, int key)
{
	const struct keyboard_key *k = &overlay->search.keyboard.keys[key];
	struct rect keys = keyboard_place(overlay);

	return overlay_tap(overlay, (float)(keys.x_px + k->x_px) + (float)k->width_px / 2,
			   (float)(keys.y_px + k->y_px) + (float)k->height_px / 2);
}

/* Taps the key of that letter as the app does; false: there is none. */
static bool type(struct overlay *overlay, const char *letter)
{
	for (int i = 0; i < (int)overlay->search.keyboard.key_count; i++) {
		const struct keyboard_key *key = &overlay->search.keyboard.keys[i];
		struct overlay_action action;

		if (key->kind != KEY_TEXT || strcmp(key->text, letter) != 0)
			continue;
		action = tap_key(overlay, i);
		CHECK(action.kind == OVERLAY_KEY && action.key == i);
		return overlay_press(overlay, action.key);
	}
	return false;
}

static int find_key(const struct overlay *overlay, enum keyboard_key_kind kind)
{
	for (int i = 0; i < (int)overlay->search.keyboard.key_count; i++)
		if (overlay->search.keyboard.keys[i].kind == kind)
			return i;
	return -1;
}

static const int sizes[][2] = { { 1920, 1080 }, { 1080, 1920 }, { 1280, 720 }, { 640, 360 },
				{ 360, 640 },   { 3840, 2160 }, { 800, 600 },  { 320, 320 } };

/* Whether it all lies on the panel, beside one another, and keys are as large as a finger. */
static void check_places(const struct overlay *overlay)
{
	struct rect all = search_place(overlay), rows = list_place(overlay);
	const struct keyboard *keyboard = &overlay->search.keyboard;
	struct rect bar;
	int target_px = theme_px(&overlay->theme, THEME_TARGET_MM);

	CHECK(all.x_px >= 0 && all.x_px + all.width_px <= overlay->width_px);
	CHECK(all.y_px >= 0 && all.y_px + all.height_px <= overlay->height_px);
	CHECK(rows.height_px >= theme_px(&overlay->theme, 17.9f));
	bar = bar_place(overlay);
	CHECK(bar.x_px + bar.width_px <= overlay->width_px || overlay->width_px == 320);
	CHECK(bar.x_px + bar.width_px <= all.x_px || bar.y_px >= all.y_px + all.height_px);
	for (uint32_t i = 0; i < keyboard->key_count; i++) {
		const struct keyboard_key *key = &keyboard->keys[i];

		CHECK(key->x_px >= 0 && key->x_px + key->width_px <= keyboard->width_px);
		CHECK(key->y_px >= 0 && key->y_px + key->height_px <= keyboard->height_px);
		CHECK(key->width_px >= target_px);
		CHECK(key->height_px >= target_px || overlay->width_px == 320);
		CHECK(keyboard_key_at(keyboard, (float)key->x_px + 1, (float)key->y_px + 1) ==
		      (int)i);
	}
}

static void shows_the_search_on_every_panel(void **state)
{
	(void)state;
	for (size_t s = 0; s < ARRAY_COUNT(sizes); s++) {
		struct overlay *overlay = open_overlay(sizes[s][0], sizes[s][1]);

		for (int language = 0; language < LANGUAGES; language++) {
			struct bitmap bitmap;

			overlay_language(overlay, languages[language]);
			give_parts(overlay, language);
			overlay_show_search(overlay, true);
			bitmap = screen(overlay, languages[language]);
			bitmap_finish(&bitmap);
			check_places(overlay);
			overlay_show_search(overlay, false);
			settle(overlay);
		}
		overlay_destroy(overlay);
	}
}

/* No key without a glyph: what cannot be drawn cannot be found on the keyboard. */
static void every_key_can_be_read(void **state)
{
	struct overlay *overlay = open_overlay(1920, 1080);

	(void)state;
	for (int language = 0; language < LANGUAGES; language++) {
		overlay_language(overlay, languages[language]);
		overlay_show_search(overlay, true);
		for (uint32_t i = 0; i < overlay->search.keyboard.key_count; i++) {
			PangoLayout *layout =
				theme_layout(&overlay->theme, TEXT_BODY,
					     overlay->search.keyboard.keys[i].text, -1);

			CHECK(pango_layout_get_unknown_glyphs_count(layout) == 0);
			g_object_unref(layout);
		}
		CHECK((find_key(overlay, KEY_LATIN) >= 0) == (language >= 3));
		CHECK(find_key(overlay, KEY_SPACE) >= 0 && find_key(overlay, KEY_BACKSPACE) >= 0);
		overlay_show_search(overlay, false);
	}
	overlay_destroy(overlay);
}

static void keys_write_into_the_field(void **state)
{
	static const struct {
		const char *language, *letters[12], *text;
	} cases[] = {
		{ "en", { "n", "a", "g", "a" }, "naga" },
		{ "km", { "ន", "ា", "គ" }, "នាគ" },
		{ "km", { "ប", "្", "រ" }, "ប្រ" },
		{ "ja", { "か", "\xe3\x82\x99", "は", "\xe3\x82\x9a" }, "がぱ" },
		{ "ar", { "ب", "ر", "ج" }, "برج" },
		{ "th", { "น", "า", "ค" }, "นาค" },
		{ "hi", { "न", "ा", "ग" }, "नाग" },
		{ "de", { "t", "u", "r", "m" }, "turm" },
		{ "ko", { "ㅇ", "ㅏ", "ㅇ", "ㅋ", "ㅗ", "ㄹ", "ㅡ" }, "앙코르" },
		{ "ko", { "ㄷ", "ㅏ", "ㄹ", "ㄱ", "ㅇ", "ㅣ" }, "닭이" },
		{ "ko", { "ㄷ", "ㅏ", "ㄹ", "ㄱ", "ㅣ" }, "달기" },
		{ "ko", { "ㅇ", "ㅗ", "ㅏ", "ㅇ", "ㄱ", "ㅜ", "ㅇ" }, "왕궁" },
		{ "ko", { "ㄲ", "ㅗ", "ㅊ" }, "꽃" },
		{ "ko", { "ㅎ", "ㅏ", "ㅃ", "ㅏ" }, "하빠" },
		{ "ru", { "б", "а", "ш", "н", "я" }, "башня" },
		{ "lo", { "ນ", "າ", "ກ" }, "ນາກ" },
		{ "my", { "န", "ဂ", "ါ", "း" }, "နဂါး" },
	};
	struct overlay *overlay = open_overlay(1920, 1080);

	(void)state;
	for (size_t i = 0; i < ARRAY_COUNT(cases); i++) {
		overlay_language(overlay, cases[i].language);
		overlay_show_search(overlay, true);
		CHECK(strcmp(overlay_query(overlay), "") == 0);
		for (size_t k = 0; k < 12 && cases[i].letters[k]; k++)
			CHECK(type(overlay, cases[i].letters[k]));
		if (strcmp(overlay_query(overlay), cases[i].text) != 0)
			fail_msg("%s: \"%s\"", cases[i].language, overlay_query(overlay));
		overlay_show_search(overlay, false);
	}
	overlay_destroy(overlay);
}

static void a_korean_syllable_loses_a_letter_at_a_time(void **state)
{
	static const char *const left[] = { "왕ㅇ", "왕", "와", "오", "ㅇ", "" };
	struct overlay *overlay = open_overlay(1920, 1080);

	(void)state;
	overlay_language(overlay, "ko");
	overlay_show_search(overlay, true);
	CHECK(type(overlay, "ㅇ") && type(overlay, "ㅗ") && type(overlay, "ㅏ") &&
	      type(overlay, "ㅇ") && type(overlay, "ㅇ") && type(overlay, "ㅣ"));
	CHECK(strcmp(overlay_query(overlay), "왕이") == 0);
	for (size_t i = 0; i < ARRAY_COUNT(left); i++) {
		CHECK(overlay_press(overlay, find_key(overlay, KEY_BACKSPACE)));
		CHECK(strcmp(overlay_query(overlay), left[i]) == 0);
	}
	overlay_destroy(overlay);
}

static void a_letter_is_taken_back_and_the_field_emptied(void **state)
{
	struct overlay *overlay = open_overlay(1920, 1080);
	struct rect all, rows;
	struct overlay_action action = { 0 };
	char before[SEARCH_QUERY_BYTES];

	(void)state;
	overlay_language(overlay, "km");
	overlay_show_search(overlay, true);
	CHECK(!overlay_press(overlay, find_key(overlay, KEY_BACKSPACE))); /* nothing to take */
	CHECK(!overlay_press(overlay, find_key(overlay, KEY_SPACE)));     /* nothing to part */
	CHECK(type(overlay, "ន") && type(overlay, "ា"));
	CHECK(overlay_press(overlay, find_key(overlay, KEY_BACKSPACE)));
	CHECK(strcmp(overlay_query(overlay), "ន") == 0);
	CHECK(overlay_press(overlay, find_key(overlay, KEY_SPACE)));
	CHECK(!overlay_press(overlay, find_key(overlay, KEY_SPACE))); /* one is enough */

	CHECK(!overlay_press(overlay, find_key(overlay, KEY_LATIN)));
	CHECK(overlay->search.keyboard.latin && type(overlay, "x"));
	CHECK(strcmp(overlay_query(overlay), "ន x") == 0);
	CHECK(!overlay_press(overlay, find_key(overlay, KEY_LATIN)) &&
	      !overlay->search.keyboard.latin);

	while (type(overlay, "ក")) /* until it is full */
		snprintf(before, sizeof(before), "%s", overlay_query(overlay));
	CHECK(strcmp(before, overlay_query(overlay)) == 0);
	CHECK(strlen(before) > SEARCH_QUERY_BYTES - 5);

	rows = list_place(overlay);
	all = search_place(overlay);
	for (int x = all.x_px; x < all.x_px + all.width_px && action.kind != OVERLAY_KEY; x += 4)
		action = overlay_tap(overlay, (float)x, (float)rows.y_px - 20);
	CHECK(action.kind == OVERLAY_KEY && action.key == OVERLAY_KEY_CLEAR);
	CHECK(overlay_press(overlay, action.key) && !*overlay_query(overlay));
	CHECK(overlay->search.found_count == PARTS); /* all again */
	overlay_destroy(overlay);
}

static void what_is_found_is_listed_and_tapped(void **state)
{
	static const uint32_t found[] = { 7, 2, 4, 99 };
	struct overlay *overlay = open_overlay(1920, 1080);
	struct rect rows;
	struct overlay_action action;
	struct bitmap bitmap;

	(void)state;
	overlay_show_search(overlay, true);
	settle(overlay);
	CHECK(overlay_searching(overlay) && overlay->search.found_count == PARTS);
	CHECK(overlay_scene_rect(overlay).width_px == 960);
	CHECK(type(overlay, "t"));
	overlay_found(overlay, found, 4); /* 99 is no part */
	bitmap = screen(overlay, "found");
	bitmap_finish(&bitmap);
	rows = list_place(overlay);
	for (int i = 0; i < 3; i++) {
		action = overlay_tap(overlay, (float)rows.x_px + 50,
				     (float)(rows.y_px + i * row_px(overlay)) + 9);
		CHECK(action.kind == OVERLAY_FOUND && action.part == (int)found[i]);
	}
	action = overlay_tap(overlay, (float)rows.x_px + 50,
			     (float)(rows.y_px + 3 * row_px(overlay)) + 9);
	CHECK(action.kind == OVERLAY_SWALLOWED); /* below the last */
	CHECK(overlay_covers(overlay, (float)rows.x_px + 5, (float)rows.y_px + 5));
	action = overlay_tap(overlay, (float)(rows.x_px + rows.width_px) - 20, 20);
	CHECK(action.kind == OVERLAY_SEARCH);

	overlay_found(overlay, NULL, 0);
	bitmap = screen(overlay, "nothing");
	bitmap_finish(&bitmap);
	CHECK(overlay->search.rows[0].part == -2); /* it says so */
	CHECK(overlay_tap(overlay, (float)rows.x_px + 50, (float)rows.y_px + 9).kind ==
	      OVERLAY_SWALLOWED);
	overlay_destroy(overlay);
}

/* Right-to-left: pictures and text stand at the right, and the control that empties at the left. */
static void arabic_begins_at_the_right(void **state)
{
	struct overlay *overlay = open_overlay(1920, 1080);
	struct rect all;
	struct bitmap bitmap;
	int left = 0, right = 0;

	(void)state;
	overlay_language(overlay, "ar");
	give_parts(overlay, 4);
	overlay_show_search(overlay, true);
	CHECK(type(overlay, "ب") && type(overlay, "ر"));
	bitmap = screen(overlay, "ar-typed");
	all = search_place(overlay);
	CHECK(overlay_tap(overlay, (float)all.x_px + 45, 40).kind == OVERLAY_KEY);
	for (int y = 10; y < 60; y++) { /* ink in either half of the field */
		const uint32_t *line =
			(const uint32_t *)(const void *)(bitmap.pixels +
							 (size_t)y * bitmap.stride_bytes);

		for (int x = all.x_px + 60; x < all.x_px + 725; x++)
			if ((line[x] & 0xff) < 0x60)
				*(x < all.x_px + 390 ? &left : &right) += 1;
	}
	CHECK(left == 0 && right > 50);
	bitmap_finish(&bitmap);
	overlay_destroy(overlay);
}

static void the_list_scrolls_and_stays_inside(void **state)
{
	struct overlay *overlay = open_overlay(1280, 720);
	struct overlay_layer layers[OVERLAY_LAYERS_MAX];
	struct rect rows;
	struct overlay_action action;
	uint32_t count;

	(void)state;
	overlay_show_search(overlay, true);
	settle(overlay);
	rows = list_place(overlay);
	CHECK(scroll_most(overlay) > 0);
	overlay_fling(overlay, -100000);
	settle(overlay);
	CHECK(overlay->search.scroll.px == (float)scroll_most(overlay));
	action = overlay_tap(overlay, (float)rows.x_px + 40,
			     (float)(rows.y_px + rows.height_px) - 4);
	CHECK(action.kind == OVERLAY_FOUND && action.part == PARTS - 1);
	overlay_scroll(overlay, 15);
	settle(overlay);
	count = overlay_layers(overlay, layers, OVERLAY_LAYERS_MAX);
	for (uint32_t i = 0; i < count; i++)
		if (is_row(overlay, layers[i].bitmap))
			CHECK(layers[i].corners_px[0][1] >= (float)rows.y_px &&
			      layers[i].corners_px[2][1] <= (float)(rows.y_px + rows.height_px));
	overlay_scroll(overlay, 100000);
	CHECK(overlay->search.scroll.px == 0);
	overlay_destroy(overlay);
}

static void page_card_and_search_take_turns(void **state)
{
	static const char page[] = "<p>A page.</p>";
	struct overlay *overlay = open_overlay(1280, 720);
	struct rect bar;
	struct overlay_action action = { 0 };

	(void)state;
	CHECK(overlay_show_page(overlay, 0, compiled(page), "") == 0);
	bar = bar_place(overlay);
	for (int x = bar.x_px; x < bar.x_px + bar.width_px && action.kind != OVERLAY_SEARCH; x += 9)
		action = overlay_tap(overlay, (float)x, (float)bar.y_px + 9);
	CHECK(action.kind == OVERLAY_SEARCH);
	overlay_show_search(overlay, true);
	CHECK(overlay_page(overlay) == -1 && overlay_searching(overlay));
	overlay_show_card(overlay, 1); /* a callout beside it */
	CHECK(overlay_searching(overlay));
	CHECK(overlay_show_page(overlay, 1, compiled(page), "") == 0);
	CHECK(!overlay_searching(overlay));
	settle(overlay);
	overlay_show_search(overlay, true);
	CHECK(overlay_parts(overlay, NULL, 0) == 0); /* another release */
	CHECK(!overlay_searching(overlay));
	overlay_show_search(overlay, true); /* nothing to find */
	CHECK(!overlay_searching(overlay));
	settle(overlay);
	overlay_destroy(overlay);
}

/* A picture that comes late is drawn into its row, which stays where it is. */
static void a_late_thumbnail_comes_into_its_row(void **state)
{
	struct overlay *overlay = open_overlay(1280, 720);
	struct bitmap before, after;

	(void)state;
	arrived = false;
	asked = 0;
	overlay_show_search(overlay, true);
	before = screen(overlay, "waiting");
	CHECK(asked > 0);
	arrived = true;
	overlay_picture_arrived(overlay, "pictures/other.png");
	CHECK(!overlay_update(overlay, 100000000));
	overlay_picture_arrived(overlay, "pictures/a.png");
	after = screen(overlay, "arrived");
	CHECK(memcmp(before.pixels, after.pixels,
		     (size_t)before.stride_bytes * (size_t)before.height_px) != 0);
	bitmap_finish(&before);
	bitmap_finish(&after);
	overlay_destroy(overlay);
}

/* Mapudungun is not Arabic, though both tags begin with "ar"; nor are Northern Kurdish Khmer, and
 * Hiligaynon Hindi. */
static void a_tag_is_read_to_its_end(void **state)
{
	static const struct {
		const char *tag, *first_key;
		bool from_right;
	} cases[] = { { "ar", "ض", true },     { "ar-EG", "ض", true }, { "arn", "q", false },
		      { "km-KH", "ក", false }, { "kmr", "q", false },  { "hil", "q", false } };

	(void)state;
	for (size_t i = 0; i < ARRAY_COUNT(cases); i++) {
		static struct keyboard keyboard;
		struct theme theme;

		CHECK(theme_init(&theme, 4, cases[i].tag) == 0);
		CHECK(theme_is_right_to_left(&theme) == cases[i].from_right);
		keyboard_layout(&keyboard, &theme, cases[i].tag, false, 800, 400);
		CHECK(strcmp(keyboard.keys[0].text, cases[i].first_key) == 0);
		theme_finish(&theme);
	}
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(shows_the_search_on_every_panel),
		cmocka_unit_test(every_key_can_be_read),
		cmocka_unit_test(keys_write_into_the_field),
		cmocka_unit_test(a_korean_syllable_loses_a_letter_at_a_time),
		cmocka_unit_test(a_letter_is_taken_back_and_the_field_emptied),
		cmocka_unit_test(what_is_found_is_listed_and_tapped),
		cmocka_unit_test(arabic_begins_at_the_right),
		cmocka_unit_test(a_tag_is_read_to_its_end),
		cmocka_unit_test(the_list_scrolls_and_stays_inside),
		cmocka_unit_test(page_card_and_search_take_turns),
		cmocka_unit_test(a_late_thumbnail_comes_into_its_row),
	};

	if (translate_open(TEST_LOCALE) < 0)
		return 1;
	return cmocka_run_group_tests(tests, NULL, NULL);
}
