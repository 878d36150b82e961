/* What a visit asks of the words and the eye. */
#include "tests/app/visit/visit_fixture.h"

static bool is_asked(void)
{
	return visit.visitor.presence.state == PRESENCE_ASKED;
}

static bool nobody_is_there(void)
{
	return visit.visitor.presence.state == PRESENCE_NOBODY;
}

static bool touches(enum touch_phase phase)
{
	return visitor_take_touch(&visit.visitor,
				  &(struct touch_event){ .phase = phase, .contact = 3 });
}

static bool taps(void)
{
	const bool down = touches(TOUCH_DOWN), up = touches(TOUCH_UP);

	return down || up;
}

/* Returns whether the eye stands elsewhere than before. */
static bool eye_was_led(void)
{
	static float before[3];
	const bool moved = memcmp(before, visit.eye.navigator.eye_m, sizeof(before)) != 0;

	memcpy(before, visit.eye.navigator.eye_m, sizeof(before));
	return moved;
}

static bool lead(void)
{
	return visitor_lead_eye(&visit.visitor, now_ms);
}

static void shows_the_model_round_while_nobody_is_there(void **state)
{
	(void)state;
	after(0);
	CHECK(!nobody_is_there() && visitor_wait_ms(&visit.visitor) == 60 * S);
	eye_was_led();
	CHECK(!lead() && !eye_was_led());
	after(60 * S);
	CHECK(nobody_is_there() && visit.redraw.wanted && visit.visitor.asked_s == -1);
	CHECK(!lead() && visit.eye.navigator.flight_left_ms > 0); /* it flies to the circle */
	after(60 * S);
	CHECK(!lead() && visit.eye.navigator.flight_left_ms > 0); /* for as long as it takes */
	visit.eye.navigator.flight_left_ms = 0;
	after(0);
	CHECK(!lead()); /* and rests on it */
	CHECK(visitor_wait_ms(&visit.visitor) > S);
	visit.redraw.wanted = false;
	after(ATTRACT_CAMERA_REST_MS + S / 2);
	CHECK(visit.redraw.wanted && visitor_wait_ms(&visit.visitor) == 0);
	CHECK(lead() && eye_was_led());
}

static void the_tour_for_nobody_takes_the_circles_place(void **state)
{
	(void)state;
	write_tour("round", true);
	show_words();
	after(60 * S);
	CHECK(nobody_is_there() && visit.tours.tour.loops);
	visit.eye.navigator.flight_left_ms = 0; /* the eye is there */
	CHECK(visitor_wait_ms(&visit.visitor) == 0);
	eye_was_led();
	lead();
	CHECK(eye_was_led() && visit.tours.tour.state == TOUR_FLYING);
	tour_player_on_release(&visit.tours, NULL); /* another release */
	after(0);
	CHECK(visit.tours.tour.loops);
	write_tour("one", false);
	show_words();
	tour_player_on_release(&visit.tours, NULL); /* one without */
	after(0);
	CHECK(!visit.tours.tour.loops && visitor_wait_ms(&visit.visitor) >= 0);
}

static void goes_round_the_next_release_as_soon_as_it_is_shown(void **state)
{
	static const struct exhibit none;
	const struct exhibit_change change = { &visit.shown, &none };
	const float *eye_m = visit.eye.navigator.eye_m;

	(void)state;
	write_tour("round", true);
	show_words();
	after(60 * S);
	CHECK(visit.tours.tour.loops);
	write_tour("one", false);
	show_words();
	for (int release = 1; release <= 2; release++) {
		visitor_on_release(&visit.visitor, &change);
		tour_player_on_release(&visit.tours, &change);
		for (int i = 0; i < 3; i++)
			visit.eye.navigator.options.box_max_m[i] = (float)(100 * release);
		after(0);
		CHECK(!lead() && visit.eye.navigator.flight_left_ms > 0);
		visit.eye.navigator.flight_left_ms = 0;
		lead();
		CHECK(visit.visitor.attract.axis_m[0] == (float)(50 * release));
		CHECK(memcmp(eye_m, visit.visitor.attract.eye_m, 3 * sizeof(*eye_m)) == 0);
	}
	after(3 * S);
	CHECK(visit.eye.navigator.flight_left_ms == 0); /* and has not begun anew */
}

static void a_touch_ends_the_tour_for_nobody(void **state)
{
	(void)state;
	write_tour("round", true);
	show_words();
	after(60 * S);
	CHECK(visit.tours.tour.loops);
	taps();
	CHECK(!lead() && visit.tours.tour.state == TOUR_OFF);
}

/* Nobody is asked while led about; who halted a tour reads; then nobody is there. */
static void a_tour_that_runs_is_somebody_and_ends_as_nobody(void **state)
{
	(void)state;
	write_tour("one", false);
	show_words();
	taps();
	tour_player_start(&visit.tours, 0);
	for (int s = 0; s < 300; s++) {
		after(S);
		CHECK(!is_asked() && !nobody_is_there());
	}
	tour_player_end(&visit.tours);
	after(59 * S);
	CHECK(!is_asked());
	after(S);
	CHECK(is_asked() && visit.visitor.asked_s == 15);
	after(15 * S);
	CHECK(nobody_is_there());
}

/* No frame is drawn then, so the tour would never end. */
static void a_tour_on_a_dark_panel_is_nobody(void **state)
{
	(void)state;
	write_tour("one", false);
	show_words();
	taps();
	tour_player_start(&visit.tours, 0);
	visit.is_dark = true;
	after(60 * S);
	after(15 * S);
	CHECK(nobody_is_there() && visit.tours.tour.state == TOUR_OFF && visit.ended == 1);
}

static void who_halted_a_tour_reads(void **state)
{
	(void)state;
	write_tour("one", false);
	show_words();
	taps();
	tour_player_start(&visit.tours, 0);
	tour_player_halt(&visit.tours);
	after(179 * S);
	CHECK(!is_asked());
	after(16 * S);
	CHECK(nobody_is_there() && visit.tours.tour.state == TOUR_OFF);
}

static void who_chooses_a_tour_reads(void **state)
{
	(void)state;
	write_tour("one", false);
	show_words();
	taps();
	back_note(&visit.back);
	overlay_show_tours(words(), true);
	CHECK(overlay_choosing(words()));
	after(179 * S);
	CHECK(!is_asked());
	after(16 * S);
	CHECK(nobody_is_there() && !overlay_choosing(words()) && visit.back.way.count == 0);
}

static void leaves_nothing_of_a_page_for_the_next(void **state)
{
	(void)state;
	CHECK(!taps());
	CHECK(information_view_open_page(visit.shown.view, 0));
	information_view_set_language(visit.shown.view, "km");
	overlay_set_comfort(words(), (struct overlay_comfort){ .large = true, .reach = true });
	after(180 * S);
	CHECK(is_asked() && visit.visitor.asked_s == 15 && overlay_page(words()) == 0);
	CHECK(visit.ended == 0);
	after(15 * S);
	CHECK(nobody_is_there() && overlay_page(words()) == -1 && visit.visitor.asked_s == -1);
	CHECK(strcmp(information_view_language(visit.shown.view), "en") == 0);
	CHECK(!overlay_comfort(words()).large && !overlay_comfort(words()).reach);
	CHECK(visit.ended == 1);
}

static void leaves_no_tools_for_the_next(void **state)
{
	(void)state;
	taps();
	tools_press(&visit.tools, OVERLAY_TOOL_LIGHT);
	tools_press(&visit.tools, OVERLAY_TOOL_SECTION);
	after(179 * S); /* looked at as long as a page */
	CHECK(!is_asked() && tools_are_used(&visit.tools));
	after(16 * S);
	CHECK(nobody_is_there() && !tools_are_used(&visit.tools));
}

static void leaves_no_search_for_the_next(void **state)
{
	(void)state;
	taps();
	overlay_show_search(words(), true);
	after(179 * S); /* a list is read as a page is */
	CHECK(!is_asked() && overlay_searching(words()));
	after(16 * S);
	CHECK(nobody_is_there() && !overlay_searching(words()));
}

static void begins_in_the_terminals_own_language(void **state)
{
	(void)state;
	begin_visitor("km", false);
	after(60 * S);
	CHECK(strcmp(information_view_language(visit.shown.view), "km") == 0);
}

static void an_answer_is_no_touch_of_the_model(void **state)
{
	(void)state;
	CHECK(!touches(TOUCH_DOWN) && !touches(TOUCH_MOVE) && !touches(TOUCH_UP));
	after(61 * S);
	CHECK(is_asked() && visit.visitor.asked_s == 14);
	CHECK(touches(TOUCH_DOWN));
	after(0);
	CHECK(!is_asked());
	CHECK(touches(TOUCH_MOVE) && touches(TOUCH_UP));
	CHECK(!touches(TOUCH_DOWN) && !touches(TOUCH_UP));
}

static void the_first_touch_already_counts(void **state)
{
	(void)state;
	after(60 * S);
	CHECK(nobody_is_there());
	CHECK(!touches(TOUCH_DOWN));
	after(0);
	CHECK(!nobody_is_there() && !lead());
}

static void what_lies_on_the_glass_keeps_nobody_for_ever(void **state)
{
	(void)state;
	CHECK(!touches(TOUCH_DOWN));
	after(179 * S);
	CHECK(!is_asked());
	after(S);
	CHECK(is_asked() && visit.visitor.asked_s == 15);
	after(15 * S);
	CHECK(nobody_is_there() && visit.ended == 1 && visit.visitor.down == 0);
}

static void a_finger_that_only_answered_does_not_read(void **state)
{
	(void)state;
	taps();
	after(60 * S);
	CHECK(is_asked() && touches(TOUCH_DOWN));
	after(60 * S);
	CHECK(is_asked());
}

static void tells_how_long_the_panel_is_somebodys(void **state)
{
	(void)state;
	CHECK(visitor_left_ms(&visit.visitor) == 0); /* nobody ever came */
	taps();
	CHECK(visitor_left_ms(&visit.visitor) == 75 * S);
	visit.shown.frame.patches = 0;
	CHECK(visitor_left_ms(&visit.visitor) == 0); /* nothing is to be seen */
}

static void another_release_is_in_the_visitors_language(void **state)
{
	struct exhibit before;
	const struct exhibit_change change = { &visit.shown, &before };

	(void)state;
	taps();
	information_view_set_language(visit.shown.view, "km");
	before = visit.shown;
	visit.shown.view = NULL;
	show_words();
	CHECK(overlay_help(words()));
	visitor_on_release(&visit.visitor, &change);
	CHECK(strcmp(information_view_language(visit.shown.view), "km") == 0);
	CHECK(!overlay_help(words()));
	information_view_destroy(before.view);
}

/* Returns the text of the counts on disk. */
static const char *counts(void)
{
	static struct buffer file;
	char path[100];

	buffer_finish(&file);
	buffer_init(&file, 1 << 16);
	snprintf(path, sizeof(path), "%s/visits.csv", folder);
	CHECK(buffer_read_file(&file, path) == 0);
	buffer_put(&file, "", 1);
	return (const char *)file.data;
}

static void counts_visits_and_writes_when_they_end(void **state)
{
	(void)state;
	taps();
	counting_part(&visit.counting, USAGE_PART, 0);
	after(74 * S);
	CHECK(!strstr(counts(), "tower"));
	after(S);
	CHECK(strstr(counts(), "visit") && strstr(counts(), "tower"));
}

static void pictures_of_views_have_no_visitors(void **state)
{
	(void)state;
	begin_visitor(NULL, true);
	visit.redraw.wanted = false;
	after(3600 * S);
	CHECK(!visit.redraw.wanted && visit.eye.navigator.flight_left_ms == 0);
	CHECK(visitor_wait_ms(&visit.visitor) == -1);
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		VISITED(shows_the_model_round_while_nobody_is_there),
		VISITED(the_tour_for_nobody_takes_the_circles_place),
		VISITED(goes_round_the_next_release_as_soon_as_it_is_shown),
		VISITED(a_touch_ends_the_tour_for_nobody),
		VISITED(a_tour_that_runs_is_somebody_and_ends_as_nobody),
		VISITED(a_tour_on_a_dark_panel_is_nobody),
		VISITED(who_halted_a_tour_reads),
		VISITED(who_chooses_a_tour_reads),
		VISITED(leaves_nothing_of_a_page_for_the_next),
		VISITED(leaves_no_tools_for_the_next),
		VISITED(leaves_no_search_for_the_next),
		VISITED(begins_in_the_terminals_own_language),
		VISITED(an_answer_is_no_touch_of_the_model),
		VISITED(the_first_touch_already_counts),
		VISITED(what_lies_on_the_glass_keeps_nobody_for_ever),
		VISITED(a_finger_that_only_answered_does_not_read),
		VISITED(tells_how_long_the_panel_is_somebodys),
		VISITED(another_release_is_in_the_visitors_language),
		VISITED(counts_visits_and_writes_when_they_end),
		VISITED(pictures_of_views_have_no_visitors),
	};

	return cmocka_run_group_tests(tests, NULL, NULL);
}
