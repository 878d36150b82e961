/* The governor over simulated boards: what a frame costs follows from the effort. */
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "render/scene/governor.h"
#include "tests/check.h"

enum { REFRESH_US = 16667, WHOLE = 300000 /* triangles in sight */ };

/* A board: the fixed time of a frame, that of all pixels at full size, of all triangles, of showing
 * a reference picture, and how much slower than usual it is now. */
struct board {
	float fixed_ms, pixels_ms, triangles_ms, warp_ms, slowness;
};

/* A visit of frames in a row, on simulated time. */
struct visit {
	struct governor governor;
	struct board board;
	float now_ms;
	uint32_t frames, scale_changes;
	float last_scale;
	uint32_t noise;
};

static void begin(struct visit *visit, struct board board)
{
	*visit = (struct visit){ .board = board, .last_scale = 1, .noise = 1 };
	governor_init(&visit->governor,
		      &(struct governor_bounds){ .scale_least = 0.5f, .refresh_us = REFRESH_US });
}

/* From -1 to 1; the same in each run. */
static float noise(struct visit *visit)
{
	visit->noise = visit->noise * 1664525u + 1013904223u;
	return (float)(visit->noise >> 8) / (float)(1 << 23) - 1;
}

static float frame(struct visit *visit)
{
	const struct scene_effort effort = governor_effort(&visit->governor);
	const struct board *b = &visit->board;
	const float area = effort.scale * effort.scale, faces = 0.4f + 0.15f * (float)effort.faces;
	const uint32_t triangles = effort.triangles < WHOLE ? effort.triangles : WHOLE;
	float ms = b->fixed_ms + (effort.share < 1 ? b->warp_ms : 0) +
		   effort.share * (b->pixels_ms * area * faces +
				   b->triangles_ms * (float)triangles / (float)WHOLE);

	ms *= b->slowness * (1 + 0.04f * noise(visit));
	governor_note(&visit->governor, (int64_t)(1000 * ms), triangles);
	visit->now_ms += fmaxf(ms, (float)governor_target_us(&visit->governor) / 1000);
	visit->frames++;
	visit->scale_changes += effort.scale != visit->last_scale;
	visit->last_scale = effort.scale;
	return ms;
}

/* Plays frames for so long, and returns the longest. */
static float play(struct visit *visit, float for_ms)
{
	const float until_ms = visit->now_ms + for_ms;
	float most = 0;

	while (visit->now_ms < until_ms)
		most = fmaxf(most, frame(visit));
	return most;
}

static const struct board strong = { 1, 4, 1, 1, 1 }, middling = { 4, 9, 3, 2, 1 },
			  weak = { 8, 30, 10, 3, 1 }, weakest = { 12, 200, 60, 10, 1 };

static void a_strong_board_draws_everything_at_the_panels_rate(void **state)
{
	struct visit visit;
	(void)state;
	begin(&visit, strong);
	play(&visit, 20000);
	CHECK(visit.scale_changes == 0 && visit.governor.divisor == 1);
	CHECK(governor_effort(&visit.governor).faces == scene_effort_full.faces);
}

static void a_weak_board_reaches_thirty_a_second_within_a_second(void **state)
{
	struct visit visit;
	(void)state;
	begin(&visit, weak);
	play(&visit, 1000);
	CHECK(governor_target_us(&visit.governor) == 2 * REFRESH_US);
	CHECK(play(&visit, 10000) < 1.1f * 2 * REFRESH_US / 1000);
}

/* Frames at rest, at full effort, have told what to expect. */
static void the_first_motion_begins_where_the_rest_lets_expect(void **state)
{
	static const struct board *const boards[] = { &strong, &middling, &weak, &weakest };
	(void)state;
	for (int i = 0; i < 4; i++) {
		struct visit visit;
		begin(&visit, *boards[i]);
		const struct board *b = &visit.board;
		const float whole_ms = b->fixed_ms + b->pixels_ms + b->triangles_ms;
		governor_note(&visit.governor, 1000, 0); /* the first frame, without anything */
		governor_expect(&visit.governor, 2000000, WHOLE); /* the first compiled programs */
		governor_expect(&visit.governor, (int64_t)(1000 * whole_ms), WHOLE);
		CHECK((visit.governor.level >= 1) == (boards[i] == &strong));
		for (int k = 0; k < 30; k++)
			CHECK(frame(&visit) < 1.3f * 2 * REFRESH_US / 1000);
		const struct governor before = visit.governor;
		governor_expect(&visit.governor, 2000000,
				WHOLE); /* and does not disturb it later */
		CHECK(memcmp(&before, &visit.governor, sizeof(before)) == 0);
	}
}

/* Its pictures take twice as long as a frame may, at the least effort. */
static void the_weakest_board_reaches_thirty_a_second_over_several_frames(void **state)
{
	struct visit visit;
	(void)state;
	begin(&visit, weakest);
	play(&visit, 2000);
	const float share = governor_effort(&visit.governor).share;
	CHECK(share < 0.8f && share > 0.2f);
	CHECK(play(&visit, 10000) < 1.1f * 2 * REFRESH_US / 1000);
}

static void the_scale_gives_way_before_faces_and_these_before_triangles(void **state)
{
	struct governor governor;
	struct scene_effort last = scene_effort_full;
	(void)state;
	governor_init(&governor, &(struct governor_bounds){ .scale_least = 0.5f });
	governor.whole = WHOLE;
	for (int i = 0; i < 185; i++) {
		governor.level = 1 - (float)i / 100;
		const struct scene_effort effort = governor_effort(&governor);
		CHECK(effort.scale <= last.scale && effort.triangles <= last.triangles);
		CHECK(effort.faces <= last.faces && effort.budget <= last.budget);
		CHECK(effort.faces == scene_effort_full.faces || effort.scale <= 0.5f);
		CHECK(effort.scale >= 0.5f || effort.share < 0.11f);
		CHECK(effort.triangles >= WHOLE || effort.faces == 1);
		CHECK(effort.budget == 1 || effort.triangles <= WHOLE / 5);
		CHECK(effort.share <= last.share && effort.share > 0.09f);
		CHECK(effort.share == 1 || effort.budget == 0.25f);
		last = effort;
	}
	CHECK(last.scale == 0.35f);
}

/* A core is taken away for ten seconds: everything takes twice as long. */
static void it_gives_way_within_300_ms_and_comes_back(void **state)
{
	struct visit visit;
	float before, gave_way_ms = 0;
	(void)state;
	begin(&visit, weak);
	play(&visit, 15000);
	before = governor_effort(&visit.governor).scale;
	visit.board.slowness = 1.7f;
	const float from_ms = visit.now_ms;
	for (uint32_t held = 0; held < 3 && gave_way_ms < 2000;) {
		held = frame(&visit) < 1.05f * 2 * REFRESH_US / 1000 ? held + 1 : 0;
		gave_way_ms = held == 1 ? visit.now_ms - from_ms : gave_way_ms;
	}
	CHECK(gave_way_ms > 0 && gave_way_ms <= 300);
	play(&visit, 10000);
	visit.board.slowness = 1;
	play(&visit, 12000);
	CHECK(fabsf(governor_effort(&visit.governor).scale - before) < 0.12f);
}

/* Thermal throttling: the clock falls by a third in steps over a minute, and rises again. */
static void a_slowing_clock_is_followed_without_late_frames(void **state)
{
	struct visit visit;
	(void)state;
	begin(&visit, middling);
	play(&visit, 10000);
	for (int i = -20; i <= 20; i++) {
		visit.board.slowness = 1.5f - 0.5f * (float)abs(i) / 20;
		play(&visit, 3000);
	}
	CHECK(play(&visit, 1000) < 1.05f * (float)governor_target_us(&visit.governor) / 1000);
}

static void under_a_steady_load_nothing_breathes(void **state)
{
	static const struct board *const boards[] = { &strong, &middling, &weak, &weakest };
	(void)state;
	for (int i = 0; i < 4; i++) {
		struct visit visit;
		begin(&visit, *boards[i]);
		play(&visit, 30000);
		const uint32_t changes = visit.scale_changes;
		play(&visit, 60000);
		CHECK(visit.scale_changes - changes <= 8);
	}
}

/* However long it was: its time is none in which frames were in time. */
static void one_long_frame_raises_nothing(void **state)
{
	struct visit visit;
	(void)state;
	begin(&visit, weak);
	for (int i = 0; i < 3; i++)
		governor_note(&visit.governor, 40000, WHOLE);
	governor_note(&visit.governor, 10000, WHOLE);
	const float before = visit.governor.level;
	CHECK(before < 1);
	governor_note(&visit.governor, 2000000, WHOLE);
	CHECK(visit.governor.level <= before);
}

/* A single late frame may have had more to do. What counts is the room in the others. */
static void it_rises_by_the_room_there_is_although_a_frame_is_late(void **state)
{
	struct visit visit;
	int rises = 0;

	(void)state;
	begin(&visit, weak);
	for (int i = 0; i < 3; i++)
		governor_note(&visit.governor, 50000, WHOLE);
	for (int i = 0; i < 13; i++) {
		const float before = visit.governor.level;

		governor_note(&visit.governor, i == 6 ? 60000 : 20000, WHOLE);
		rises += visit.governor.level > before + 0.1f;
	}
	assert_int_equal(rises, 1);
}

static void one_late_frame_changes_nothing(void **state)
{
	struct visit visit;
	(void)state;
	begin(&visit, strong);
	play(&visit, 1000);
	visit.board.slowness = 12;
	frame(&visit);
	visit.board.slowness = 1;
	play(&visit, 1000);
	CHECK(visit.scale_changes == 0 && visit.governor.divisor == 1);
}

static void a_bound_of_full_size_governs_nothing(void **state)
{
	struct governor governor;
	(void)state;
	governor_init(&governor, &(struct governor_bounds){ .scale_least = 1 });
	CHECK(governor_is_fixed(&governor));
	for (int i = 0; i < 100; i++)
		governor_note(&governor, 500000, WHOLE);
	CHECK(governor.level == 1 && governor_target_us(&governor) == REFRESH_US);
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(a_strong_board_draws_everything_at_the_panels_rate),
		cmocka_unit_test(a_weak_board_reaches_thirty_a_second_within_a_second),
		cmocka_unit_test(the_first_motion_begins_where_the_rest_lets_expect),
		cmocka_unit_test(the_weakest_board_reaches_thirty_a_second_over_several_frames),
		cmocka_unit_test(the_scale_gives_way_before_faces_and_these_before_triangles),
		cmocka_unit_test(it_gives_way_within_300_ms_and_comes_back),
		cmocka_unit_test(a_slowing_clock_is_followed_without_late_frames),
		cmocka_unit_test(under_a_steady_load_nothing_breathes),
		cmocka_unit_test(one_late_frame_changes_nothing),
		cmocka_unit_test(it_rises_by_the_room_there_is_although_a_frame_is_late),
		cmocka_unit_test(one_long_frame_raises_nothing),
		cmocka_unit_test(a_bound_of_full_size_governs_nothing),
	};
	return cmocka_run_group_tests(tests, NULL, NULL);
}
