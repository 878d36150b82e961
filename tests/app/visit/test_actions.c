/* What taps on the overlay do to words, eye and tour, and what the back button undoes of it. */
#include "tests/app/visit/visit_fixture.h"

static void act(struct overlay_action action)
{
	actions_carry_out(&visit.actions, &action);
}

static void tap(enum overlay_action_kind kind)
{
	act((struct overlay_action){ .kind = kind, .part = -1 });
}

static bool eye_flies(void)
{
	return visit.eye.navigator.flight_left_ms > 0;
}

static void land(void)
{
	while (navigator_step(&visit.eye.navigator, 50, 1080))
		;
}

static uint32_t steps(void)
{
	return visit.back.way.count;
}

static void a_callout_opens_its_card_and_a_card_its_page(void **state)
{
	(void)state;
	act((struct overlay_action){ .kind = OVERLAY_OPEN_CARD, .part = 0 });
	CHECK(overlay_card(words()) == 0 && !eye_flies() && steps() == 1);
	act((struct overlay_action){ .kind = OVERLAY_OPEN_PAGE, .part = 0 });
	CHECK(overlay_page(words()) == 0 && overlay_card(words()) == -1 && eye_flies());
	CHECK(steps() == 2);
	tap(OVERLAY_BACK);
	CHECK(overlay_page(words()) == -1 && overlay_card(words()) == 0);
	tap(OVERLAY_BACK);
	CHECK(overlay_card(words()) == -1 && steps() == 0);
}

static void closing_a_page_centres_its_part_unless_the_eye_was_moved(void **state)
{
	(void)state;
	act((struct overlay_action){ .kind = OVERLAY_OPEN_PAGE, .part = 0 });
	land();
	tap(OVERLAY_CLOSE_PAGE);
	CHECK(overlay_page(words()) == -1 && eye_flies());
	act((struct overlay_action){ .kind = OVERLAY_OPEN_PAGE, .part = 0 });
	land();
	navigator_turn(&visit.eye.navigator, 50, 0, 1080);
	tap(OVERLAY_CLOSE_PAGE);
	CHECK(overlay_page(words()) == -1 && !eye_flies());
}

static void a_link_leads_to_page_card_or_tour(void **state)
{
	(void)state;
	write_tour("one", false);
	show_words();
	act((struct overlay_action){ .kind = OVERLAY_LINK, .link = "gate" });
	CHECK(overlay_page(words()) == 1);
	act((struct overlay_action){ .kind = OVERLAY_LINK, .link = "naga" }); /* it has no page */
	CHECK(overlay_page(words()) == 1 && overlay_card(words()) == 2);
	act((struct overlay_action){ .kind = OVERLAY_LINK, .link = "nowhere" });
	CHECK(overlay_page(words()) == 1);
	act((struct overlay_action){ .kind = OVERLAY_LINK, .link = "tour:one" });
	CHECK(overlay_page(words()) == -1 && tour_player_has_visitor(&visit.tours));
}

static void to_read_halts_a_tour_and_to_go_home_ends_it(void **state)
{
	static const enum overlay_action_kind halts[] = { OVERLAY_OPEN_CARD, OVERLAY_OPEN_PAGE,
							  OVERLAY_SEARCH, OVERLAY_HELP,
							  OVERLAY_FOUND };

	(void)state;
	write_tour("one", false);
	show_words();
	for (size_t i = 0; i < ARRAY_COUNT(halts); i++) {
		act((struct overlay_action){ .kind = OVERLAY_TOUR, .tour = 0 });
		CHECK(tour_runs(&visit.tours.tour));
		act((struct overlay_action){ .kind = halts[i], .part = 0 });
		CHECK(visit.tours.tour.state == TOUR_HALTED);
		tap(OVERLAY_TOUR_CLOSE);
		CHECK(visit.tours.tour.state == TOUR_OFF);
	}
	act((struct overlay_action){ .kind = OVERLAY_TOUR, .tour = 0 });
	tap(OVERLAY_LARGE); /* nothing to read */
	CHECK(tour_runs(&visit.tours.tour));
	tap(OVERLAY_HOME);
	CHECK(visit.tours.tour.state == TOUR_OFF && eye_flies());
}

static void the_tour_button_halts_and_goes_on(void **state)
{
	(void)state;
	write_tour("one", false);
	show_words();
	tap(OVERLAY_TOURS); /* the only one starts */
	CHECK(tour_runs(&visit.tours.tour) && steps() == 1);
	tap(OVERLAY_TOURS);
	CHECK(visit.tours.tour.state == TOUR_HALTED && steps() == 1);
	tap(OVERLAY_TOUR_PAUSE);
	CHECK(tour_runs(&visit.tours.tour));
}

static void the_search_is_a_step_only_when_it_opens(void **state)
{
	(void)state;
	tap(OVERLAY_SEARCH);
	CHECK(overlay_searching(words()) && steps() == 1);
	actions_press_key(&visit.actions, 0);
	CHECK(strlen(overlay_query(words())) > 0);
	tap(OVERLAY_SEARCH);
	CHECK(!overlay_searching(words()) && steps() == 1);
	tap(OVERLAY_SEARCH);
	act((struct overlay_action){ .kind = OVERLAY_FOUND, .part = 1 });
	CHECK(!overlay_searching(words()) && overlay_card(words()) == 1 && eye_flies());
}

/* Of two searches, each was left with a letter of its own. */
static void the_way_back_leads_to_what_was_typed_then(void **state)
{
	char typed[2][8];

	(void)state;
	for (int search = 0; search < 2; search++) {
		tap(OVERLAY_SEARCH);
		actions_press_key(&visit.actions, search);
		snprintf(typed[search], sizeof(typed[search]), "%s", overlay_query(words()));
		act((struct overlay_action){ .kind = OVERLAY_FOUND, .part = search });
		land();
	}
	CHECK(strcmp(typed[0], typed[1]) != 0);
	tap(OVERLAY_BACK);
	CHECK(overlay_searching(words()) && strcmp(overlay_query(words()), typed[1]) == 0);
	tap(OVERLAY_BACK);
	CHECK(!overlay_searching(words()) && overlay_card(words()) == 0);
	tap(OVERLAY_BACK);
	CHECK(overlay_searching(words()) && strcmp(overlay_query(words()), typed[0]) == 0);
}

static void a_language_is_set_and_counted(void **state)
{
	(void)state;
	act((struct overlay_action){ .kind = OVERLAY_LANGUAGE, .language = "km" });
	CHECK(strcmp(information_view_language(visit.shown.view), "km") == 0 && steps() == 0);
}

static void a_tool_is_switched_on_and_off(void **state)
{
	(void)state;
	tap(OVERLAY_LIGHT);
	CHECK(visit.tools.now.rake.on && !visit.tools.now.section.on && visit.anchors.to_test > 0);
	tap(OVERLAY_SECTION);
	CHECK(visit.tools.now.section.on);
	tap(OVERLAY_LIGHT);
	CHECK(!visit.tools.now.rake.on && visit.tools.now.section.on && steps() == 0);
}

static void comfort_and_help_are_switched(void **state)
{
	(void)state;
	CHECK(overlay_help(words()));
	tap(OVERLAY_HELP);
	CHECK(!overlay_help(words()));
	tap(OVERLAY_LARGE);
	CHECK(overlay_comfort(words()).large);
	tap(OVERLAY_LARGE);
	CHECK(!overlay_comfort(words()).large);
}

static void a_page_is_widened_and_put_back(void **state)
{
	(void)state;
	act((struct overlay_action){ .kind = OVERLAY_OPEN_PAGE, .part = 0 });
	tap(OVERLAY_WIDEN_PAGE);
	CHECK(overlay_page_is_wide(words()));
	tap(OVERLAY_WIDEN_PAGE);
	CHECK(!overlay_page_is_wide(words()));
}

static void what_is_swallowed_does_nothing(void **state)
{
	(void)state;
	act((struct overlay_action){ .kind = OVERLAY_OPEN_CARD, .part = 0 });
	tap(OVERLAY_SWALLOWED);
	tap(OVERLAY_NONE);
	CHECK(overlay_card(words()) == 0 && steps() == 1);
	tap(OVERLAY_CLOSE_CARD);
	CHECK(overlay_card(words()) == -1 && steps() == 1);
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		VISITED(a_callout_opens_its_card_and_a_card_its_page),
		VISITED(closing_a_page_centres_its_part_unless_the_eye_was_moved),
		VISITED(a_link_leads_to_page_card_or_tour),
		VISITED(to_read_halts_a_tour_and_to_go_home_ends_it),
		VISITED(the_tour_button_halts_and_goes_on),
		VISITED(the_search_is_a_step_only_when_it_opens),
		VISITED(the_way_back_leads_to_what_was_typed_then),
		VISITED(a_language_is_set_and_counted),
		VISITED(a_tool_is_switched_on_and_off),
		VISITED(comfort_and_help_are_switched),
		VISITED(a_page_is_widened_and_put_back),
		VISITED(what_is_swallowed_does_nothing),
	};

	return cmocka_run_group_tests(tests, NULL, NULL);
}
