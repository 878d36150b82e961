#include <math.h>
#include <string.h>

#include "render/patches/dissolve.h"
#include "tests/check.h"
#include "tests/render/patches/little_hierarchy.h"

struct world {
	struct cut cut;
	struct dissolve dissolve;
	uint8_t loaded[4];
};

static int set_up(void **state)
{
	static struct world world;
	memset(&world, 0, sizeof(world));
	*state = &world;
	return cut_init(&world.cut, &hierarchy) < 0 ||
	       dissolve_init(&world.dissolve, &world.cut) < 0;
}

static int tear_down(void **state)
{
	struct world *world = *state;
	dissolve_finish(&world->dissolve);
	cut_finish(&world->cut);
	return 0;
}

/* What is shown and loaded, as bits a group. */
static void set(struct world *world, unsigned shown, unsigned loaded)
{
	for (unsigned g = 0; g < 4; g++) {
		world->cut.shown[g] = shown >> g & 1;
		world->loaded[g] = loaded >> g & 1;
	}
}

static void step(struct world *world, float ms)
{
	dissolve_step(&world->dissolve, world->loaded, ms);
}

static bool draws_at(const struct world *world, uint32_t patch, float u)
{
	struct dissolve_range range = dissolve_range(&world->dissolve, patch);
	return u >= range.low && u < range.high;
}

/* Every pixel shows a valid cut: of the patches over one another exactly one. */
static void check_whole(const struct world *world)
{
	for (float u = 0.01f; u < 1; u += 0.02f) {
		bool refined[4];
		for (uint32_t g = 0; g < 4; g++)
			refined[g] = u < world->dissolve.share[g];
		CHECK(refined[0]);
		CHECK(!refined[3] || (refined[1] && refined[2]));
		for (uint32_t p = 0; p < 8; p++) {
			uint32_t finer = patches[p].finer;
			bool shows = refined[patches[p].group] &&
				     (finer == HIERARCHY_NONE || !refined[finer]);
			CHECK(draws_at(world, p, u) == shows);
		}
	}
}

static void the_coarsest_is_there_at_once(void **state)
{
	struct world *world = *state;
	set(world, 1, 1);
	step(world, 0);
	CHECK(dissolve_is_whole(dissolve_range(&world->dissolve, 0)));
	CHECK(!world->dissolve.moving);
	check_whole(world);
}

static void the_coarsest_dissolves_in_where_something_else_is_shown(void **state)
{
	struct world *world = *state;
	float last = 0;
	set(world, 15, 15);
	world->dissolve.root = ROOT_HELD;
	step(world, 50);
	CHECK(world->dissolve.share[0] <= 0 && world->dissolve.share[3] <= 0);
	CHECK(!world->dissolve.moving); /* a line that is down needs no frames */
	world->dissolve.root = ROOT_APPEARS;
	/* The images of any group of the cut are waited for. */
	dissolve_hold(&world->dissolve, 2);
	step(world, 50);
	CHECK(world->dissolve.share[0] <= 0);
	for (int ms = 0; ms < DISSOLVE_MS; ms += 10) {
		step(world, 10);
		CHECK(world->dissolve.share[0] > last);
		CHECK(world->dissolve.share[0] - last < 0.05f);
		/* Never the root's own patches: they may be coarser than what is replaced. */
		CHECK(!dissolve_draws(dissolve_range(&world->dissolve, 0)));
		last = world->dissolve.share[0];
	}
	step(world, 10);
	CHECK(world->dissolve.share[0] >= 1 && !world->dissolve.moving);
	check_whole(world);
}

static void what_comes_covers_what_goes_pixel_by_pixel(void **state)
{
	struct world *world = *state;
	float last = 0;
	set(world, 1, 1);
	step(world, 0);
	set(world, 15, 15);
	for (int ms = 0; ms < DISSOLVE_MS; ms += 10) {
		step(world, 10);
		CHECK(world->dissolve.share[3] >= last);
		CHECK(world->dissolve.share[3] - last < 0.05f);
		last = world->dissolve.share[3];
		check_whole(world);
	}
	step(world, 10);
	CHECK(!world->dissolve.moving);
	CHECK(dissolve_is_whole(dissolve_range(&world->dissolve, 6)));
	CHECK(!dissolve_draws(dissolve_range(&world->dissolve, 0)));
}

static void a_cut_that_changes_its_mind_stays_whole(void **state)
{
	struct world *world = *state;
	static const unsigned cuts[] = { 1, 3, 7, 15, 7, 1, 15, 5, 1 };
	for (int i = 0; i < 9; i++) {
		set(world, cuts[i], 15);
		for (int k = 0; k < 7; k++) {
			step(world, 11);
			check_whole(world);
		}
	}
	for (int ms = 0; ms <= DISSOLVE_MS; ms += 50)
		step(world, 50);
	CHECK(!world->dissolve.moving);
	CHECK(world->dissolve.share[1] <= 0);
}

static void what_is_unloaded_is_gone_with_all_that_stood_on_it(void **state)
{
	struct world *world = *state;
	set(world, 15, 15);
	step(world, 10 * DISSOLVE_MS);
	CHECK(draws_at(world, 6, 0.5f));
	set(world, 5, 5);
	step(world, 1);
	CHECK(world->dissolve.share[1] <= 0 && world->dissolve.share[3] <= 0);
	check_whole(world);
}

static void the_unready_waits_but_not_for_ever(void **state)
{
	struct world *world = *state;
	int waited = 0;
	set(world, 3, 15);
	for (; waited < 2 * DISSOLVE_WAIT_MS && world->dissolve.share[1] <= 0; waited += 10) {
		dissolve_hold(&world->dissolve, 1);
		step(world, 10);
		CHECK(world->dissolve.moving);
	}
	CHECK(waited >= DISSOLVE_WAIT_MS && waited < DISSOLVE_WAIT_MS + 30);
	/* Once it shows nothing holds it. */
	float share = world->dissolve.share[1];
	dissolve_hold(&world->dissolve, 1);
	step(world, 10);
	CHECK(world->dissolve.share[1] > share);
	/* And who is ready does not wait. */
	set(world, 7, 15);
	step(world, 10);
	CHECK(world->dissolve.share[2] > 0);
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test_setup_teardown(the_coarsest_is_there_at_once, set_up, tear_down),
		cmocka_unit_test_setup_teardown(
			the_coarsest_dissolves_in_where_something_else_is_shown, set_up, tear_down),
		cmocka_unit_test_setup_teardown(what_comes_covers_what_goes_pixel_by_pixel, set_up,
						tear_down),
		cmocka_unit_test_setup_teardown(a_cut_that_changes_its_mind_stays_whole, set_up,
						tear_down),
		cmocka_unit_test_setup_teardown(what_is_unloaded_is_gone_with_all_that_stood_on_it,
						set_up, tear_down),
		cmocka_unit_test_setup_teardown(the_unready_waits_but_not_for_ever, set_up,
						tear_down),
	};
	return cmocka_run_group_tests(tests, NULL, NULL);
}
