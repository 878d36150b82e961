/* The timer of GPU time on the driver at hand; without the extension it says nothing. */
#include "render/display/gpu_timer.h"
#include "render/display/headless.h"
#include "tests/check.h"

enum { SIDE_PX = 256, FRAMES = 3 * GPU_TIMER_QUERIES };

struct world {
	struct headless *headless;
	struct gl_target target;
	struct gpu_timer timer;
};

static int set_up(void **state)
{
	static struct world world;
	world = (struct world){ 0 };
	*state = &world;
	if (headless_create(&world.headless) < 0 ||
	    gl_target_create(&world.target, SIDE_PX, SIDE_PX) < 0)
		return -1;
	gpu_timer_init(&world.timer);
	return 0;
}

static int tear_down(void **state)
{
	struct world *world = *state;
	gpu_timer_finish(&world->timer);
	gl_target_destroy(&world->target);
	headless_destroy(world->headless);
	return 0;
}

static void frame(struct world *world)
{
	gpu_timer_begin(&world->timer);
	glClear(GL_COLOR_BUFFER_BIT | GL_DEPTH_BUFFER_BIT);
	gpu_timer_end(&world->timer);
}

static void a_finished_frame_has_a_time_once(void **state)
{
	struct world *world = *state;
	CHECK(gpu_timer_take_us(&world->timer) == 0);
	frame(world);
	glFinish();
	const int64_t spent_us = gpu_timer_take_us(&world->timer);
	CHECK(spent_us >= 0 && spent_us <= 1000000);
	CHECK(gpu_timer_take_us(&world->timer) == 0);
	CHECK(world->timer.begun == world->timer.taken);
	CHECK(world->timer.begun == (world->timer.known ? 1u : 0u));
	CHECK(gl_check("the test") == 0);
}

/* As with a GPU that is far behind. */
static void frames_that_nobody_asks_about_are_not_queried_without_end(void **state)
{
	struct world *world = *state;
	for (int i = 0; i < FRAMES; i++)
		frame(world);
	CHECK(world->timer.begun <= GPU_TIMER_QUERIES);
	glFinish();
	CHECK(gpu_timer_take_us(&world->timer) >= 0);
	CHECK(world->timer.taken == world->timer.begun);
	frame(world);
	CHECK(world->timer.begun == (world->timer.known ? GPU_TIMER_QUERIES + 1u : 0u));
	CHECK(gl_check("the test") == 0);
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test_setup_teardown(a_finished_frame_has_a_time_once, set_up,
						tear_down),
		cmocka_unit_test_setup_teardown(
			frames_that_nobody_asks_about_are_not_queried_without_end, set_up,
			tear_down),
	};
	return cmocka_run_group_tests(tests, NULL, NULL);
}
