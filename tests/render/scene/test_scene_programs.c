/* New programs: a frame compiles as many as there is time for, and the picture is in the end what
 * it is where all were there at once. */
#include <unistd.h>

#include "base/clock.h"
#include "render/scene/scene_parts.h"
#include "tests/render/scene/little_stage.h"

enum { FRAMES_MAX = 1500, SLOW_US = 40000 };

static struct little_release *release;
static int64_t now_us = 1000000, look_us = 100; /* a look takes so long */

int64_t clock_now_us(void)
{
	return now_us += look_us;
}

int64_t clock_now_ms(void)
{
	return clock_now_us() / 1000;
}

/* Returns how many programs for images something was drawn with, with the raking light. */
static int drawn_programs(const struct stage *stage)
{
	int count = 0;

	for (int i = 0; i < SURFACE_PROGRAMS; i++)
		count += surface_faces(i) > 0 &&
			 stage->scene->surface.of[SURFACE_RAKE][i].is_drawn[false];
	return count;
}

/* Draws until all is settled. Returns the most programs that came in one frame. */
static int settle(struct stage *stage)
{
	int most = 0;

	for (int i = 0; i < FRAMES_MAX; i++) {
		const int before = drawn_programs(stage);

		now_us += 16000;
		draw_stage(stage, &usual_camera);
		if (drawn_programs(stage) - before > most)
			most = drawn_programs(stage) - before;
		if (stage->frame.settled)
			return most;
		(void)little_release_serve(release, stage->scene, 256);
		usleep(2000);
	}
	fail_msg("not settled");
	return 0;
}

/* Returns how many programs the raking light has, and in *most how many came in one frame. */
static int rake(struct stage *stage, int64_t us, int *most)
{
	const struct scene_tools tools = { .rake = { .on = true } };

	raise_stage(stage, release, SCENE_LUMIGRAPH);
	settle(stage);
	CHECK(drawn_programs(stage) == 0);
	scene_use(stage->scene, &tools);
	look_us = us;
	*most = settle(stage);
	look_us = 100;
	return drawn_programs(stage);
}

/* Edges lie elsewhere in their pixels after another number of frames. */
static double mean_difference(const uint8_t *a, const uint8_t *b)
{
	double sum = 0;

	for (int i = 0; i < 4 * PIXELS; i++)
		sum += abs(a[i] - b[i]);
	return sum / (4 * PIXELS);
}

static void a_frame_has_one_that_takes_long(void **state)
{
	static struct stage at_once, in_turn;
	int most, programs;

	(void)state;
	release = little_release_make(4);
	programs = rake(&at_once, 100, &most);
	CHECK(programs >= 2 && most == programs);
	CHECK(rake(&in_turn, SLOW_US, &most) == programs && most == 1);
	CHECK(mean_difference(in_turn.seen, at_once.seen) < 0.5);
	strike_stage(&in_turn);
	strike_stage(&at_once);
	little_release_free(release);
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(a_frame_has_one_that_takes_long),
	};

	return cmocka_run_group_tests(tests, NULL, NULL);
}
