/* The help teaches by moving fingers, rests, and goes at once. */
#include <math.h>
#include <string.h>

#include "tests/ui/views.h"
#include "ui/help_view.h"
#include "ui/translate.h"

enum { WIDTH = 400, STEP_MS = 16 };

static void fingers_at(const struct theme *theme, int64_t ms, float out[HELP_FINGERS][2])
{
	help_view_fingers(theme, WIDTH, true, ms, out);
}

static float way(float a[HELP_FINGERS][2], float b[HELP_FINGERS][2], int finger)
{
	return hypotf(a[finger][0] - b[finger][0], a[finger][1] - b[finger][1]);
}

static void one_finger_turns_then_two_part_and_then_they_rest(void **state)
{
	float rest[HELP_FINGERS][2], before[HELP_FINGERS][2], now[HELP_FINGERS][2];
	float most[HELP_FINGERS] = { 0 }, left = 0, right = 0;
	struct theme theme;

	(void)state;
	CHECK(theme_init(&theme, 5, "en") == 0);
	fingers_at(&theme, HELP_MOVES_MS, rest);
	fingers_at(&theme, 0, before);
	for (int64_t ms = 0; ms < HELP_MOVES_MS + 1000; ms += STEP_MS) {
		fingers_at(&theme, ms, now);
		/* Never the one and the two at once. */
		CHECK(way(now, rest, 0) < 0.5f || way(now, rest, 1) < 0.5f);
		for (int i = 0; i < HELP_FINGERS; i++) {
			CHECK(way(now, before, i) < 5); /* nothing jumps */
			CHECK(ms < HELP_MOVES_MS || way(now, rest, i) == 0);
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
	fingers_at(&theme, HELP_MOVES_MS, rest);
	CHECK(rest[0][0] > rest[2][0]);
	theme_finish(&theme);
}

static uint32_t fingers_shown(const struct help_view *view, const struct screen *screen)
{
	struct overlay_layer list[VIEW_LAYERS_MAX];
	struct layers layers = { .list = list, .most = VIEW_LAYERS_MAX };
	uint32_t fingers = 0;

	help_view_layers(view, screen, true, &layers);
	for (uint32_t i = 0; i < layers.count; i++)
		fingers += list[i].bitmap == view->finger.id;
	return fingers;
}

/* Milliseconds until nothing moves. */
static int64_t moves_ms(struct help_view *view, const struct screen *screen)
{
	int64_t ms = 0;

	while (help_view_update(view, screen, true, STEP_MS))
		ms += STEP_MS;
	return ms;
}

static void the_help_moves_a_while_goes_at_once_and_moves_anew(void **state)
{
	struct theme theme;
	const struct screen screen = make_screen(&theme, "en");
	struct help_view view;
	uint32_t next_id = 7;
	int64_t moved_ms;

	(void)state;
	help_view_init(&view, &theme, &next_id);
	CHECK(next_id == 9);
	moved_ms = moves_ms(&view, &screen);
	CHECK(moved_ms >= HELP_MOVES_MS - STEP_MS && moved_ms < HELP_MOVES_MS + 100);
	CHECK(fingers_shown(&view, &screen) == HELP_FINGERS);
	CHECK(help_view_show(&view, false)); /* what a visitor's first drag does */
	CHECK(!help_view_show(&view, false));
	CHECK(moves_ms(&view, &screen) < 300 && fingers_shown(&view, &screen) == 0);
	CHECK(help_view_show(&view, true));
	CHECK(moves_ms(&view, &screen) >= HELP_MOVES_MS - STEP_MS);
	help_view_finish(&view);
	theme_finish(&theme);
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(one_finger_turns_then_two_part_and_then_they_rest),
		cmocka_unit_test(the_help_moves_a_while_goes_at_once_and_moves_anew),
	};

	if (translate_open(TEST_LOCALE) < 0)
		return 1;
	return cmocka_run_group_tests(tests, NULL, NULL);
}
