/* The box of the tour that runs: another stop redraws it, other words fade in, a tap pauses. */
#include "tests/ui/views.h"
#include "ui/tour_player_view.h"

static void settle(struct tour_player_view *view, const struct screen *screen)
{
	while (tour_player_view_update(view, screen, view->runs, "Walls", 16))
		;
}

static void it_follows_the_tour_and_pauses(void **state)
{
	struct theme theme;
	const struct screen screen = make_screen(&theme, "en");
	struct overlay_tour_state tour = { .stop_count = 3, .caption = "The outer wall." };
	struct tour_player_view view;
	uint32_t next_id = 0, drawn;
	struct rect rect;

	(void)state;
	tour_player_view_init(&view, &next_id);
	CHECK(tour_player_view_set(&view, &tour));
	settle(&view, &screen);
	rect = tour_player_view_rect(&view, &screen);
	CHECK(view.fade.alpha == 1 && rect.y_px + rect.height_px <= screen.bar.y_px);
	drawn = view.sprite.revision;
	CHECK(!tour_player_view_set(&view, &tour)); /* as it was */
	settle(&view, &screen);
	CHECK(view.sprite.revision == drawn);
	tour.stop = 1;
	CHECK(!tour_player_view_set(&view, &tour)); /* the same size */
	settle(&view, &screen);
	CHECK(view.sprite.revision == drawn + 1);
	CHECK(tour_player_view_tap(&view, &screen, middle_x(rect), middle_y(rect)).kind ==
	      OVERLAY_SWALLOWED);
	tour.paused = true; /* then it goes on by a tap anywhere */
	tour_player_view_set(&view, &tour);
	CHECK(tour_player_view_tap(&view, &screen, middle_x(rect), middle_y(rect)).kind ==
	      OVERLAY_TOUR_PAUSE);
	CHECK(tour_player_view_tap(&view, &screen, (float)(rect.x_px + rect.width_px) - 3,
				   (float)rect.y_px + 3)
		      .kind == OVERLAY_TOUR_CLOSE);
	tour.caption = "The inner wall.";
	CHECK(tour_player_view_set(&view, &tour) && view.fade.alpha == 0);
	CHECK(tour_player_view_set(&view, NULL) && !view.runs);
	tour_player_view_finish(&view);
	theme_finish(&theme);
}

/* A caption is as long as its author likes; the same words do not fade in again. */
static void long_words_come_to_rest(void **state)
{
	char words[3000];
	struct theme theme;
	const struct screen screen = make_screen(&theme, "en");
	const struct overlay_tour_state tour = { .stop_count = 3, .caption = words };
	struct tour_player_view view;
	uint32_t next_id = 0;

	(void)state;
	for (size_t i = 0; i + 1 < sizeof(words); i++)
		words[i] = i % 8 == 7 ? ' ' : 'a';
	words[sizeof(words) - 1] = 0;
	tour_player_view_init(&view, &next_id);
	CHECK(tour_player_view_set(&view, &tour));
	settle(&view, &screen);
	CHECK(!tour_player_view_set(&view, &tour) && view.fade.alpha == 1);
	words[sizeof(words) - 2] = 'b'; /* other words, at their end */
	CHECK(tour_player_view_set(&view, &tour));
	tour_player_view_finish(&view);
	theme_finish(&theme);
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(it_follows_the_tour_and_pauses),
		cmocka_unit_test(long_words_come_to_rest),
	};

	return cmocka_run_group_tests(tests, NULL, NULL);
}
