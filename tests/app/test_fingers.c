/* What two quick taps do on controls and on the model. */
#include "app/fingers.h"

#include "tests/app/visit/visit_fixture.h"
#include "tests/ui/places.h"

/* The rest of the clock, whose other functions are the fixture's. */
int64_t clock_now_us(void)
{
	return now_ms * 1000;
}

int64_t clock_thread_us(void)
{
	return 0;
}

bool clock_agrees(const char *battery_s, int64_t system_s)
{
	(void)battery_s, (void)system_s;
	return true;
}

/* The tower is everywhere. */
bool __wrap_scene_pick(struct scene *scene, const struct camera *camera, float x_px, float y_px,
		       float point_m[3]);
bool __wrap_scene_pick(struct scene *scene, const struct camera *camera, float x_px, float y_px,
		       float point_m[3])
{
	(void)scene, (void)camera, (void)x_px, (void)y_px;
	memset(point_m, 0, 3 * sizeof(*point_m));
	return true;
}

const char *__wrap_scene_part(struct scene *scene, const struct camera *camera, float x_px,
			      float y_px);
const char *__wrap_scene_part(struct scene *scene, const struct camera *camera, float x_px,
			      float y_px)
{
	(void)scene, (void)camera, (void)x_px, (void)y_px;
	return "tower";
}

static struct fingers fingers;
static struct panel panel;
static struct setup_page setup_page;
static int64_t at_us;

static int begin(void **state)
{
	const int rc = begin_visit(state);

	fingers_init(&fingers, &(struct fingers_env){ .panel = &panel,
						      .setup_page = &setup_page,
						      .visitor = &visit.visitor,
						      .tools = &visit.tools,
						      .actions = &visit.actions,
						      .shown = &visit.shown,
						      .eye = &visit.eye,
						      .tours = &visit.tours,
						      .viewport = &visit.viewport,
						      .redraw = &visit.redraw });
	overlay_show_help(words(), false);
	at_us += 10 * S * 1000;
	return rc;
}

static void touch(enum touch_phase phase, float x_px, float y_px)
{
	at_us += 100000;
	fingers_on_touch(&fingers,
			 &(struct touch_event){
				 .phase = phase, .x_px = x_px, .y_px = y_px, .time_us = at_us });
}

static void tap(float x_px, float y_px)
{
	touch(TOUCH_DOWN, x_px, y_px);
	touch(TOUCH_UP, x_px, y_px);
}

static void tap_twice(float x_px, float y_px)
{
	tap(x_px, y_px);
	tap(x_px, y_px);
}

static struct rect button_place(enum bar_view_button_kind kind)
{
	const struct bar_view *bar = &words()->bar;
	const struct rect place = bar_place(words());
	uint32_t i = 0;

	while (bar->buttons[i].kind != kind)
		i++;
	return (struct rect){ place.x_px + bar->buttons[i].x_px, place.y_px,
			      bar->buttons[i].width_px, place.height_px };
}

static void tap_button_twice(enum bar_view_button_kind kind)
{
	const struct rect place = button_place(kind);

	tap_twice((float)(place.x_px + place.width_px / 2),
		  (float)(place.y_px + place.height_px / 2));
}

static void two_taps_on_the_model_open_a_page(void **state)
{
	(void)state;
	tap_twice(960, 300);
	CHECK(overlay_page(words()) == 0);
}

static void what_closes_opens_nothing_below(void **state)
{
	struct rect card;

	(void)state;
	overlay_show_card(words(), 0);
	card = card_place(words());
	tap_twice((float)(card.x_px + card.width_px - 12), (float)(card.y_px + 12));
	CHECK(overlay_card(words()) == -1 && overlay_page(words()) == -1);
}

static void what_is_switched_stays(void **state)
{
	(void)state;
	tap_button_twice(BAR_SEARCH);
	CHECK(overlay_searching(words()));
	tap_button_twice(BAR_LARGE);
	CHECK(overlay_comfort(words()).large);
}

static void back_counts_each_tap(void **state)
{
	(void)state;
	actions_carry_out(&visit.actions,
			  &(struct overlay_action){ .kind = OVERLAY_OPEN_CARD, .part = 0 });
	actions_carry_out(&visit.actions,
			  &(struct overlay_action){ .kind = OVERLAY_OPEN_PAGE, .part = 0 });
	overlay_offer_back(words(), true);
	tap_button_twice(BAR_BACK);
	CHECK(overlay_page(words()) == -1 && overlay_card(words()) == -1);
}

/* Back leads nowhere yet, and the next control is beside it. */
static void who_missed_a_control_taps_again(void **state)
{
	const struct rect back = button_place(BAR_BACK), help = button_place(BAR_HELP);
	const float y_px = (float)(back.y_px + back.height_px / 2);

	(void)state;
	CHECK(back.x_px + back.width_px <= help.x_px);
	tap((float)(back.x_px + back.width_px - 2), y_px);
	tap((float)(help.x_px + 2), y_px);
	CHECK(overlay_help(words()));
}

#define TOUCHED(test) cmocka_unit_test_setup_teardown(test, begin, end_visit)

int main(void)
{
	const struct CMUnitTest tests[] = {
		TOUCHED(two_taps_on_the_model_open_a_page),
		TOUCHED(what_closes_opens_nothing_below),
		TOUCHED(what_is_switched_stays),
		TOUCHED(back_counts_each_tap),
		TOUCHED(who_missed_a_control_taps_again),
	};

	return cmocka_run_group_tests(tests, NULL, NULL);
}
