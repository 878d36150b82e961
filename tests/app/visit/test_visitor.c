/* What a visit asks of the words and the eye. */
#include <stdio.h>
#include <string.h>

#include "app/kiosk.h"
#include "base/clock.h"
#include "tests/check.h"

enum { S = 1000 };

/* The rest of the kiosk, as visitor.c sees and leaves it. */
static struct {
	int64_t now_ms;
	int card, page, asked_s, flights, looks, redraws, led;
	int counted[USAGE_TOUR + 1], written;
	bool invites, searches, chooses, chooses_language, has_tour;
	struct overlay_comfort comfort;
	char language[8];
} world;

static struct kiosk kiosk;
static int some_thing; /* for pointers that nobody looks behind */

int64_t clock_now_ms(void)
{
	return world.now_ms;
}

void kiosk_redraw(struct kiosk *of)
{
	(void)of;
	world.redraws++;
}

struct overlay *information_view_overlay(struct information_view *view)
{
	return (struct overlay *)view;
}

const struct info *information_view_info(const struct information_view *view)
{
	return (const struct info *)view;
}

const char *info_language(const struct info *info, uint32_t index)
{
	(void)info;
	CHECK(index == 0);
	return "km";
}

void information_view_set_language(struct information_view *view, const char *language)
{
	(void)view;
	snprintf(world.language, sizeof(world.language), "%s", language);
}

int overlay_card(const struct overlay *overlay)
{
	(void)overlay;
	return world.card;
}

int overlay_page(const struct overlay *overlay)
{
	(void)overlay;
	return world.page;
}

void overlay_close_page(struct overlay *overlay)
{
	(void)overlay;
	world.page = -1;
}

void overlay_show_card(struct overlay *overlay, int part)
{
	(void)overlay;
	world.card = part;
}

bool overlay_searching(const struct overlay *overlay)
{
	(void)overlay;
	return world.searches;
}

void overlay_show_search(struct overlay *overlay, bool on)
{
	(void)overlay;
	world.searches = on;
}

void overlay_show_tours(struct overlay *overlay, bool on)
{
	(void)overlay;
	world.chooses = on;
}

bool overlay_choosing(const struct overlay *overlay)
{
	(void)overlay;
	return world.chooses;
}

void overlay_show_languages(struct overlay *overlay, bool on)
{
	(void)overlay;
	world.chooses_language = on;
}

bool overlay_choosing_language(const struct overlay *overlay)
{
	(void)overlay;
	return world.chooses_language;
}

bool tour_player_go_round(struct kiosk *of)
{
	if (world.has_tour) {
		of->tour.state = TOUR_FLYING;
		of->tour.loops = true;
	}
	return world.has_tour;
}

void tour_player_end(struct kiosk *of)
{
	of->tour.state = TOUR_OFF;
	of->tour.loops = false;
}

void tools_end(struct kiosk *of)
{
	of->tools.now.rake.on = of->tools.now.section.on = false;
}

void back_forget(struct kiosk *of)
{
	of->way_back.count = 0;
}

bool tour_player_leads_eye(struct kiosk *of, int64_t now_ms)
{
	CHECK(of == &kiosk && now_ms == world.now_ms);
	world.led++;
	return true;
}

void tour_player_say(struct kiosk *of)
{
	(void)of;
}

bool tour_runs(const struct tour *tour)
{
	return tour->state == TOUR_COMING || tour->state == TOUR_FLYING;
}

int tour_wait_ms(const struct tour *tour, int64_t now_ms)
{
	(void)now_ms;
	return tour->state == TOUR_FLYING ? 0 : -1;
}

void overlay_set_comfort(struct overlay *overlay, struct overlay_comfort comfort)
{
	(void)overlay;
	world.comfort = comfort;
}

struct overlay_comfort overlay_comfort(const struct overlay *overlay)
{
	(void)overlay;
	return world.comfort;
}

void overlay_invite(struct overlay *overlay, bool on)
{
	(void)overlay;
	world.invites = on;
}

void overlay_ask(struct overlay *overlay, int seconds_left)
{
	(void)overlay;
	world.asked_s = seconds_left;
}

void navigator_fly(struct navigator *nav, const float eye_m[3], const float target_m[3],
		   float duration_ms)
{
	(void)nav, (void)eye_m, (void)target_m;
	CHECK(duration_ms > 0);
	world.flights++;
}

void navigator_look(struct navigator *nav, const float eye_m[3], const float target_m[3])
{
	(void)nav, (void)eye_m, (void)target_m;
	world.looks++;
}

const char *information_view_language(const struct information_view *view)
{
	(void)view;
	return world.language;
}

const struct info_part *info_part(const struct info *info, uint32_t part)
{
	static const struct info_part gate = { .id = "gate" };

	(void)info, (void)part;
	return &gate;
}

bool clock_wall_is_set(void)
{
	return true;
}

bool clock_wall_is_plausible(void)
{
	return true;
}

int64_t clock_wall_s(void)
{
	return 1795953600;
}

void usage_add(struct usage *usage, enum usage_kind kind, const char *what, const char *language,
	       int64_t now_s)
{
	CHECK(usage == (struct usage *)&some_thing && now_s == 1795953600);
	CHECK(strcmp(what, kind == USAGE_PART ? "gate" : "") == 0 && language == world.language);
	world.counted[kind]++;
}

void usage_write(struct usage *usage)
{
	(void)usage;
	world.written++;
}

static int set_up(void **state)
{
	(void)state;
	memset(&world, 0, sizeof(world));
	memset(&kiosk, 0, sizeof(kiosk));
	world.now_ms = 1000000;
	world.card = world.page = world.asked_s = -1;
	snprintf(world.language, sizeof(world.language), "fr");
	kiosk.shown.view = (struct information_view *)&some_thing;
	kiosk.shown.frame.patches = 9;
	kiosk.usage = (struct usage *)&some_thing;
	kiosk.navigator_ready = true;
	kiosk.navigator.options = (struct navigator_options){
		.box_max_m = { 10, 10, 10 },
		.home_eye_m = { 5, -40, 5 },
	};
	presence_init(&kiosk.presence, 60, world.now_ms);
	return 0;
}

static void after(int64_t ms)
{
	world.now_ms += ms;
	visitor_watch(&kiosk);
}

static bool touches(enum touch_phase phase)
{
	return visitor_takes_touch(&kiosk, &(struct touch_event){ .phase = phase, .contact = 3 });
}

static void shows_the_model_round_while_nobody_is_there(void **state)
{
	(void)state;
	after(0);
	CHECK(!world.invites && visitor_wait_ms(&kiosk) == 60 * S);
	CHECK(!visitor_leads_eye(&kiosk, world.now_ms) && world.looks == 0);
	after(60 * S);
	CHECK(world.invites && world.flights == 1 && world.asked_s == -1 && world.redraws > 0);
	CHECK(!visitor_leads_eye(&kiosk, world.now_ms) && world.looks == 0); /* it flies there */
	after(3 * S);
	CHECK(!visitor_leads_eye(&kiosk, world.now_ms) && world.looks == 1); /* and rests */
	CHECK(visitor_wait_ms(&kiosk) > S);
	world.redraws = 0;
	after(ATTRACT_CAMERA_REST_MS);
	CHECK(world.redraws == 1 && visitor_wait_ms(&kiosk) == 0);
	CHECK(visitor_leads_eye(&kiosk, world.now_ms));
}

static void the_tour_for_nobody_takes_the_circles_place(void **state)
{
	(void)state;
	world.has_tour = true;
	after(60 * S);
	CHECK(world.invites && world.flights == 0 && kiosk.tour.loops);
	CHECK(visitor_leads_eye(&kiosk, world.now_ms) && world.led == 1 && world.looks == 0);
	CHECK(visitor_wait_ms(&kiosk) == 0);
	tour_player_end(&kiosk); /* another release */
	after(0);
	CHECK(kiosk.tour.loops);
	tour_player_end(&kiosk);
	world.has_tour = false; /* one without */
	after(0);
	CHECK(!kiosk.tour.loops && visitor_wait_ms(&kiosk) >= 0);
}

/* Nobody is asked while led about; who halted a tour reads; then nobody is there. */
static void a_tour_that_runs_is_somebody_and_ends_as_nobody(void **state)
{
	(void)state;
	touches(TOUCH_DOWN);
	kiosk.tour.state = TOUR_FLYING;
	for (int s = 0; s < 300; s++) {
		after(S);
		CHECK(world.asked_s == -1 && !world.invites);
	}
	tour_player_end(&kiosk);
	after(59 * S);
	CHECK(world.asked_s == -1);
	after(S);
	CHECK(world.asked_s == 15);
	after(15 * S);
	CHECK(world.invites);
	set_up(NULL);
	touches(TOUCH_DOWN);
	kiosk.tour.state = TOUR_HALTED;
	after(179 * S);
	CHECK(world.asked_s == -1);
	after(16 * S);
	CHECK(world.invites && kiosk.tour.state == TOUR_OFF);
	set_up(NULL);
	touches(TOUCH_DOWN);
	world.chooses = true; /* from the menu */
	kiosk.way_back.count = 3;
	world.chooses_language = true;
	after(179 * S);
	CHECK(world.asked_s == -1);
	after(16 * S);
	CHECK(world.invites && !world.chooses && !world.chooses_language);
	CHECK(kiosk.way_back.count == 0);
}

static void leaves_nothing_of_a_visitor_for_the_next(void **state)
{
	(void)state;
	CHECK(!touches(TOUCH_DOWN) && !touches(TOUCH_UP));
	world.page = 4;
	world.comfort = (struct overlay_comfort){ .large = true, .reach = true };
	after(180 * S);
	CHECK(world.asked_s == 15 && world.page == 4 && !world.invites);
	after(15 * S);
	CHECK(world.invites && world.page == -1 && world.asked_s == -1);
	CHECK(strcmp(world.language, "km") == 0);
	CHECK(!world.comfort.large && !world.comfort.reach);
	set_up(NULL);
	touches(TOUCH_DOWN);
	kiosk.tools.now.section.on = kiosk.tools.now.rake.on = true; /* looked at as long */
	after(179 * S);
	CHECK(world.asked_s == -1 && kiosk.tools.now.section.on);
	after(16 * S);
	CHECK(!kiosk.tools.now.section.on && !kiosk.tools.now.rake.on && world.invites);
	set_up(NULL);
	touches(TOUCH_DOWN);
	world.searches = true; /* a list is read as a page is */
	after(179 * S);
	CHECK(world.asked_s == -1 && world.searches);
	after(16 * S);
	CHECK(!world.searches && world.invites);
	set_up(NULL);
	kiosk.options.language = "ja"; /* the terminal's own */
	after(60 * S);
	CHECK(strcmp(world.language, "ja") == 0);
}

static void an_answer_is_no_touch_of_the_model(void **state)
{
	(void)state;
	CHECK(!touches(TOUCH_DOWN) && !touches(TOUCH_MOVE) && !touches(TOUCH_UP));
	after(61 * S);
	CHECK(world.asked_s == 14);
	CHECK(touches(TOUCH_DOWN));
	after(0);
	CHECK(world.asked_s == -1);
	CHECK(touches(TOUCH_MOVE) && touches(TOUCH_UP));
	CHECK(!touches(TOUCH_DOWN) && !touches(TOUCH_UP));
}

static void the_first_touch_already_counts(void **state)
{
	(void)state;
	after(60 * S);
	CHECK(world.invites);
	CHECK(!touches(TOUCH_DOWN));
	after(0);
	CHECK(!world.invites && !visitor_leads_eye(&kiosk, world.now_ms));
}

static void what_lies_on_the_glass_keeps_nobody_for_ever(void **state)
{
	(void)state;
	CHECK(!touches(TOUCH_DOWN));
	kiosk.gestures.fingers[3].down = true;
	after(179 * S);
	CHECK(world.asked_s == -1);
	after(S);
	CHECK(world.asked_s == 15);
	after(15 * S);
	CHECK(world.invites && !kiosk.gestures.fingers[3].down);
}

static void tells_how_long_the_panel_is_somebodys(void **state)
{
	(void)state;
	CHECK(visitor_left_ms(&kiosk) == 0); /* nobody ever came */
	touches(TOUCH_DOWN);
	CHECK(visitor_left_ms(&kiosk) == 75 * S);
	kiosk.shown.frame.patches = 0;
	CHECK(visitor_left_ms(&kiosk) == 0); /* nothing is to be seen */
}

static void counts_visits_and_writes_when_they_end(void **state)
{
	(void)state;
	touches(TOUCH_DOWN);
	touches(TOUCH_UP);
	counting_part(&kiosk, USAGE_PART, 0);
	CHECK(world.counted[USAGE_VISIT] == 1 && world.counted[USAGE_PART] == 1);
	after(74 * S);
	CHECK(world.written == 0);
	after(S);
	CHECK(world.written == 1);
	touches(TOUCH_DOWN);
	CHECK(world.counted[USAGE_VISIT] == 2);
}

static void pictures_of_views_have_no_visitors(void **state)
{
	(void)state;
	kiosk.options.views_path = "views.txt";
	after(3600 * S);
	CHECK(world.redraws == 0 && world.flights == 0 && visitor_wait_ms(&kiosk) == -1);
}

#define VISITED(test) cmocka_unit_test_setup(test, set_up)

int main(void)
{
	const struct CMUnitTest tests[] = {
		VISITED(shows_the_model_round_while_nobody_is_there),
		VISITED(the_tour_for_nobody_takes_the_circles_place),
		VISITED(a_tour_that_runs_is_somebody_and_ends_as_nobody),
		VISITED(leaves_nothing_of_a_visitor_for_the_next),
		VISITED(an_answer_is_no_touch_of_the_model),
		VISITED(the_first_touch_already_counts),
		VISITED(what_lies_on_the_glass_keeps_nobody_for_ever),
		VISITED(tells_how_long_the_panel_is_somebodys),
		VISITED(counts_visits_and_writes_when_they_end),
		VISITED(pictures_of_views_have_no_visitors),
	};

	return cmocka_run_group_tests(tests, NULL, NULL);
}
