/* The question is readable, stands in the middle or low, and is drawn once a second. */
#include <math.h>

#include "tests/ui/views.h"
#include "ui/question_view.h"
#include "ui/translate.h"

static void it_stands_in_the_middle_and_in_reach_mode_low(void **state)
{
	struct theme theme;
	struct screen screen = make_screen(&theme, "ar");
	struct question_view view;
	uint32_t next_id = 0;
	struct rect rect;

	(void)state;
	question_view_init(&view, &next_id);
	question_view_ask(&view, 9);
	while (question_view_update(&view, &screen, 16))
		;
	/* Words that are read from the right are seen too. */
	CHECK(text_pixels(&view.sprite.bitmap, 0.1, 0.9, 0.5, false) > 200);
	rect = question_view_rect(&view, &screen);
	CHECK(fabsf(middle_x(rect) - 500) < 1 && fabsf(middle_y(rect) - 300) < 1);
	screen.reach = true;
	CHECK(question_view_rect(&view, &screen).y_px > rect.y_px);
	question_view_finish(&view);
	theme_finish(&theme);
}

static void it_is_drawn_when_its_seconds_change(void **state)
{
	struct theme theme;
	const struct screen screen = make_screen(&theme, "en");
	struct question_view view;
	uint32_t next_id = 0;

	(void)state;
	question_view_init(&view, &next_id);
	question_view_update(&view, &screen, 16);
	CHECK(view.sprite.revision == 0); /* it does not ask */
	for (int left = 3; left >= 0; left--) {
		question_view_ask(&view, left);
		question_view_update(&view, &screen, 16);
		question_view_ask(&view, left);
		question_view_update(&view, &screen, 16);
		CHECK(view.sprite.revision == (uint32_t)(4 - left));
	}
	question_view_ask(&view, -1);
	CHECK(!view.fade.on);
	question_view_finish(&view);
	theme_finish(&theme);
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(it_stands_in_the_middle_and_in_reach_mode_low),
		cmocka_unit_test(it_is_drawn_when_its_seconds_change),
	};

	if (translate_open(TEST_LOCALE) < 0)
		return 1;
	return cmocka_run_group_tests(tests, NULL, NULL);
}
