/* The menu of tours lists them on as much room as there is, and a tap chooses one. */
#include "tests/ui/views.h"
#include "ui/tours_view.h"

static const struct overlay_tour list[OVERLAY_TOURS_MAX] = {
	{ "A", "Walls", "" }, { "B", "", "" }, { "C", "", "" }, { "D", "", "" },
	{ "E", "", "" },      { "F", "", "" }, { "G", "", "" }, { "H", "", "" },
};

/* Returns how far down the column at x_px a tap chooses that tour. */
static int tall_px(const struct tours_view *view, const struct screen *screen, int tour, int x_px)
{
	int count = 0;

	for (int y = 0; y < screen->height_px; y++) {
		const struct overlay_action action =
			tours_view_tap(view, screen, (float)x_px, (float)y);

		count += action.kind == OVERLAY_TOUR && action.tour == tour;
	}
	return count;
}

/* Every tour is 9 mm tall or more, in the left half of the menu or in the right one. */
static void feel(const struct tours_view *view, const struct screen *screen)
{
	const struct rect rect = tours_view_rect(view, screen);

	CHECK(rect.y_px >= 0 && rect.y_px + rect.height_px <= screen->bar.y_px);
	for (int i = 0; i < (int)view->count; i++) {
		const int left = tall_px(view, screen, i, rect.x_px + rect.width_px / 4);
		const int right = tall_px(view, screen, i, rect.x_px + rect.width_px * 3 / 4);

		CHECK((left > right ? left : right) >= screen_px(screen, THEME_TARGET_MM));
	}
}

static void every_tour_can_be_tapped_and_the_cross_closes(void **state)
{
	struct theme theme;
	const struct screen screen = make_screen(&theme, "en");
	struct tours_view view;
	uint32_t next_id = 0;

	(void)state;
	tours_view_init(&view, &next_id);
	CHECK(!tours_view_show(&view, true)); /* there are none */
	for (uint32_t count = 1; count <= OVERLAY_TOURS_MAX; count += 7) {
		struct rect rect;

		CHECK(tours_view_set(&view, list, count) == 0);
		CHECK(tours_view_show(&view, true));
		rect = tours_view_rect(&view, &screen);
		feel(&view, &screen);
		CHECK(tours_view_tap(&view, &screen, (float)(rect.x_px + rect.width_px) - 3,
				     (float)rect.y_px + 3)
			      .kind == OVERLAY_TOURS);
	}
	CHECK(tours_view_set(&view, list, OVERLAY_TOURS_MAX + 1) == -1);
	CHECK(view.count == OVERLAY_TOURS_MAX && view.fade.on); /* nothing changed */
	CHECK(tours_view_set(&view, list, 2) == 0 && !view.fade.on);
	tours_view_finish(&view);
	theme_finish(&theme);
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(every_tour_can_be_tapped_and_the_cross_closes),
	};

	return cmocka_run_group_tests(tests, NULL, NULL);
}
