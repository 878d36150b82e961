/* The hint teaches by moving fingers, rests, and goes at once; and words that are read from the
 * right are seen, on the side where they begin. */
#include <math.h>
#include <string.h>

#include "tests/check.h"
#include "ui/hint.h"
#include "ui/overlay_state.h"
#include "ui/prompt.h"
#include "ui/translate.h"

enum { WIDTH = 400, STEP_MS = 16 };

static void fingers_at(const struct theme *theme, int64_t ms, float out[HINT_FINGERS][2])
{
	hint_fingers(theme, WIDTH, true, ms, out);
}

static float way(float a[HINT_FINGERS][2], float b[HINT_FINGERS][2], int finger)
{
	return hypotf(a[finger][0] - b[finger][0], a[finger][1] - b[finger][1]);
}

static void one_finger_turns_then_two_part_and_then_they_rest(void **state)
{
	float rest[HINT_FINGERS][2], before[HINT_FINGERS][2], now[HINT_FINGERS][2];
	float most[HINT_FINGERS] = { 0 }, left = 0, right = 0;
	struct theme theme;

	(void)state;
	CHECK(theme_init(&theme, 5, "en") == 0);
	fingers_at(&theme, HINT_MOVES_MS, rest);
	fingers_at(&theme, 0, before);
	for (int64_t ms = 0; ms < HINT_MOVES_MS + 1000; ms += STEP_MS) {
		fingers_at(&theme, ms, now);
		/* Never the one and the two at once. */
		CHECK(way(now, rest, 0) < 0.5f || way(now, rest, 1) < 0.5f);
		for (int i = 0; i < HINT_FINGERS; i++) {
			CHECK(way(now, before, i) < 5); /* nothing jumps */
			CHECK(ms < HINT_MOVES_MS || way(now, rest, i) == 0);
			most[i] = fmaxf(most[i], way(now, rest, i));
		}
		left = fminf(left, now[0][0] - rest[0][0]);
		right = fmaxf(right, now[0][0] - rest[0][0]);
		/* The two mirror each other. */
		CHECK(fabsf(now[1][0] + now[2][0] - rest[1][0] - rest[2][0]) < 0.01f);
		memcpy(before, now, sizeof(before));
	}
	CHECK(left < -10 && right > 10 && most[1] > 10 && most[2] > 10);
	CHECK(way(rest, rest, 0) == 0 && rest[0][0] < rest[1][0]);
	theme_set_language(&theme, "ar"); /* the first thing to do stands at the right */
	fingers_at(&theme, HINT_MOVES_MS, rest);
	CHECK(rest[0][0] > rest[2][0]);
	theme_finish(&theme);
}

static uint32_t fingers_shown(const struct overlay *overlay)
{
	struct overlay_layer layers[OVERLAY_LAYERS_MAX];
	uint32_t count = overlay_layers(overlay, layers, OVERLAY_LAYERS_MAX), fingers = 0;

	for (uint32_t i = 0; i < count; i++)
		fingers += layers[i].bitmap == BITMAP_FINGER;
	return fingers;
}

/* Milliseconds until nothing moves. */
static int64_t accumulation_after(struct overlay *overlay, int64_t *now_ms)
{
	const int64_t began_ms = *now_ms;

	while (overlay_update(overlay, *now_ms))
		*now_ms += STEP_MS;
	return *now_ms - began_ms;
}

static void the_hint_moves_a_while_goes_at_once_and_moves_anew(void **state)
{
	static const char *const languages[] = { "en", "ar" };
	const struct overlay_options options = {
		.width_px = 960, .height_px = 540, .languages = languages, .language_count = 2
	};
	struct overlay *overlay;
	int64_t now_ms = 1000, moved_ms;

	(void)state;
	CHECK(overlay_create(&overlay, &options) == 0);
	moved_ms = accumulation_after(overlay, &now_ms);
	CHECK(moved_ms >= HINT_MOVES_MS && moved_ms < HINT_MOVES_MS + 100);
	CHECK(fingers_shown(overlay) == HINT_FINGERS);
	overlay_show_help(overlay, false); /* what a visitor's first drag does */
	CHECK(accumulation_after(overlay, &now_ms) < 300 && fingers_shown(overlay) == 0);
	overlay_show_help(overlay, true);
	CHECK(accumulation_after(overlay, &now_ms) >= HINT_MOVES_MS);
	overlay_destroy(overlay);
}

/* Of the columns from..to, of the rows above `below`; what is as light, or dark, as text. */
static uint32_t text_pixels(const struct bitmap *bitmap, double from, double to, double below,
			    bool light)
{
	uint32_t count = 0;

	for (int y = 0; y < (int)(bitmap->height_px * below); y++)
		for (int x = (int)(bitmap->width_px * from); x < (int)(bitmap->width_px * to);
		     x++) {
			const uint8_t *p =
				bitmap->pixels + (size_t)y * bitmap->stride_bytes + 4 * (size_t)x;

			count += p[3] == 255 && (light ? p[0] > 200 : p[0] < 120);
		}
	return count;
}

static void words_that_are_read_from_the_right_are_seen(void **state)
{
	static const char *const both[] = { "en", "ar" };
	struct bitmap english, arabic;
	uint32_t without, with;
	struct theme theme;

	(void)state;
	CHECK(theme_init(&theme, 5, "ar") == 0);
	CHECK(prompt_draw_question(&arabic, &theme, 9, 900) == 0);
	CHECK(text_pixels(&arabic, 0.1, 0.9, 0.5, false) > 200);
	bitmap_finish(&arabic);
	CHECK(prompt_draw_invitation(&english, &theme, both, 1, 900) == 0);
	CHECK(prompt_draw_invitation(&arabic, &theme, both, 2, 900) == 0);
	without = text_pixels(&english, 0.35, 1, 1, true);
	with = text_pixels(&arabic, 0.35, 1, 1, true);
	CHECK(with > without + 100);
	bitmap_finish(&english);
	bitmap_finish(&arabic);
	theme_finish(&theme);
}

static void the_card_is_mirrored_with_its_language(void **state)
{
	const struct card card = { .title = "البرج", .caption = "حجر", .has_page = true };
	struct bitmap bitmap;
	struct theme theme;
	int width_px, height_px;

	(void)state;
	CHECK(theme_init(&theme, 5, "ar") == 0);
	card_size(&theme, 2000, &width_px, &height_px);
	CHECK(card_draw(&bitmap, &theme, &card, width_px, height_px) == 0);
	CHECK(card_closes(&theme, width_px, 20, 20));
	CHECK(!card_closes(&theme, width_px, (float)width_px - 20, 20));
	/* The title at the right, nothing but paper beside it. */
	CHECK(text_pixels(&bitmap, 0.6, 0.97, 0.4, false) > 100);
	CHECK(text_pixels(&bitmap, 0.2, 0.6, 0.4, false) == 0);
	bitmap_finish(&bitmap);
	theme_set_language(&theme, "en");
	CHECK(card_closes(&theme, width_px, (float)width_px - 20, 20));
	theme_finish(&theme);
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(one_finger_turns_then_two_part_and_then_they_rest),
		cmocka_unit_test(the_hint_moves_a_while_goes_at_once_and_moves_anew),
		cmocka_unit_test(words_that_are_read_from_the_right_are_seen),
		cmocka_unit_test(the_card_is_mirrored_with_its_language),
	};

	if (translate_open(TEST_LOCALE) < 0)
		return 1;
	return cmocka_run_group_tests(tests, NULL, NULL);
}
