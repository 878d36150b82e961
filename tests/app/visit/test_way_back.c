/* Steps and the way back over them: to the last place that is another one. */
#include "app/visit/way_back.h"

#include "tests/check.h"

static struct place place_at(float x_m, int card, int page)
{
	return (struct place){
		.eye_m = { x_m, 0, 0 }, .target_m = { x_m, 5, 0 }, .card = card, .page = page
	};
}

static void leads_back_step_by_step(void **state)
{
	const struct place start = place_at(0, -1, -1), card = place_at(0, 3, -1);
	const struct place page = place_at(8, -1, 3), other = place_at(20, -1, 4);
	struct way_back way = { 0 };
	struct place back;

	(void)state;
	CHECK(!way_back_take(&way, &start, 0.1f, &back));
	way_back_note(&way, &start);
	way_back_note(&way, &card);
	way_back_note(&way, &page);
	CHECK(way_back_take(&way, &other, 0.1f, &back) && back.page == 3 && back.eye_m[0] == 8);
	CHECK(way_back_take(&way, &page, 0.1f, &back) && back.card == 3 && back.page == -1);
	CHECK(way_back_take(&way, &card, 0.1f, &back) && back.card == -1);
	CHECK(!way_back_take(&way, &start, 0.1f, &back));
}

/* What the visitor has undone by other means is no step any more. */
static void a_place_that_is_here_is_passed_over(void **state)
{
	const struct place start = place_at(0, -1, -1), near_start = place_at(0.05f, -1, -1);
	struct place turned = place_at(0, -1, -1), back;
	struct way_back way = { 0 };

	(void)state;
	way_back_note(&way, &start);
	way_back_note(&way, &near_start);
	CHECK(!way_back_take(&way, &start, 0.1f, &back));
	turned.target_m[0] = 1; /* 11 degrees */
	way_back_note(&way, &turned);
	CHECK(way_back_take(&way, &start, 0.1f, &back) && back.target_m[0] == 1);
	turned = start;
	turned.searching = true;
	way_back_note(&way, &turned);
	CHECK(way_back_take(&way, &start, 0.1f, &back) && back.searching);
	turned = start;
	turned.on_tour = true;
	way_back_note(&way, &turned);
	CHECK(way_back_take(&way, &start, 0.1f, &back) && back.on_tour);
	way_back_note(&way, &start);
	way_back_note(&way, &turned);
	turned.eye_m[0] = 50; /* a tour leads the eye: what was open there counts */
	CHECK(way_back_take(&way, &turned, 0.1f, &back) && !back.on_tour);
}

static void the_oldest_steps_are_forgotten(void **state)
{
	const struct place here = place_at(-1, -1, -1);
	struct way_back way = { 0 };
	struct place back;

	(void)state;
	for (int i = 0; i < 3 * WAY_BACK_MAX; i++) {
		const struct place step = place_at((float)i, -1, -1);

		way_back_note(&way, &step);
	}
	for (int i = 3 * WAY_BACK_MAX - 1; i >= 2 * WAY_BACK_MAX; i--)
		CHECK(way_back_take(&way, &here, 0.1f, &back) && back.eye_m[0] == (float)i);
	CHECK(!way_back_take(&way, &here, 0.1f, &back));
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(leads_back_step_by_step),
		cmocka_unit_test(a_place_that_is_here_is_passed_over),
		cmocka_unit_test(the_oldest_steps_are_forgotten),
	};

	return cmocka_run_group_tests(tests, NULL, NULL);
}
