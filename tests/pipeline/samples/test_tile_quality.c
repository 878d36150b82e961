/* Qualities of tiles by their feature points, and budgets that are met. */
#include <errno.h>
#include <string.h>

#include "pipeline/samples/tile_quality.h"
#include "tests/check.h"

enum { TILES = 60, SCALES = 4 };

static uint32_t counts[SCALES * TILES];

static void make_counts(void)
{
	for (uint32_t scale = 0; scale < SCALES; scale++)
		for (uint32_t tile = 0; tile < TILES; tile++)
			counts[scale * TILES + tile] = tile * 7 % 31 / (scale + 1);
}

/* Grows with the quality, and differs from tile to tile. */
static uint32_t bytes_of(void *user, uint32_t tile, uint8_t quality)
{
	(void)user;
	return 200 + (tile % 9 + 1) * quality * quality / 10;
}

static struct tile_budget_options options_of(double deviation, uint64_t budget)
{
	make_counts();
	return (struct tile_budget_options){ .features = { TILES, SCALES, counts },
					     .deviation = deviation,
					     .best = 90,
					     .worst = 20,
					     .budget_bytes = budget,
					     .tile_bytes = bytes_of };
}

static uint64_t sum(const uint8_t *qualities)
{
	uint64_t all = 0;

	for (uint32_t i = 0; i < TILES; i++)
		all += bytes_of(NULL, i, qualities[i]);
	return all;
}

static void more_features_mean_a_higher_quality(void **state)
{
	static const uint32_t few[] = { 0, 10, 5, 5 };
	const struct tile_features features = { 4, 1, few };
	uint8_t out[4];

	(void)state;
	tile_quality_set(out, &features, 1, 50, 40); /* n is 0, 1, 0.5 and 0.5, their mean 0.5 */
	CHECK(out[0] == 30 && out[1] == 70 && out[2] == 50 && out[3] == 50);
	tile_quality_set(out, &features, 1, 90, 40);
	CHECK(out[0] == 70 && out[1] == 100);
	tile_quality_set(out, &features, 1, 10, 40);
	CHECK(out[0] == 1 && out[1] == 30);
}

static void equal_counts_mean_equal_qualities(void **state)
{
	static const uint32_t equal[] = { 6, 6, 6 };
	const struct tile_features features = { 3, 1, equal };
	uint8_t out[3];

	(void)state;
	tile_quality_set(out, &features, 1, 61, 40);
	CHECK(out[0] == 61 && out[1] == 61 && out[2] == 61);
}

static void every_possible_budget_is_met_within_two_percent(void **state)
{
	static const double deviations[] = { 0, 20, 50 };
	uint8_t qualities[TILES];
	struct tile_budget_result result;

	(void)state;
	for (size_t i = 0; i < ARRAY_COUNT(deviations); i++)
		for (uint64_t budget = 50000; budget <= 200000; budget += 10000) {
			struct tile_budget_options options = options_of(deviations[i], budget);

			CHECK(tile_budget_meet(&result, qualities, &options) == 0);
			CHECK(result.total_bytes == sum(qualities));
			CHECK(result.total_bytes <= budget);
			CHECK(result.total_bytes * 100 >= budget * 98);
		}
}

static void less_bytes_mean_a_coarser_scale(void **state)
{
	uint8_t qualities[TILES];
	struct tile_budget_result rich, poor;
	struct tile_budget_options options = options_of(20, 200000);

	(void)state;
	CHECK(tile_budget_meet(&rich, qualities, &options) == 0);
	options.budget_bytes = 50000;
	CHECK(tile_budget_meet(&poor, qualities, &options) == 0);
	CHECK(poor.scale > rich.scale && poor.quality < rich.quality);
}

static void an_ample_budget_gets_the_best_quality(void **state)
{
	struct tile_budget_options options = options_of(0, UINT64_MAX);
	struct tile_budget_result result;
	uint8_t qualities[TILES];

	(void)state;
	CHECK(tile_budget_meet(&result, qualities, &options) == 0);
	CHECK(result.scale == 1);
	for (uint32_t i = 0; i < TILES; i++)
		CHECK(qualities[i] == 90);
}

static void an_impossible_budget_tells_the_least_possible(void **state)
{
	struct tile_budget_options options = options_of(20, 1000);
	struct tile_budget_result result;
	uint8_t qualities[TILES];
	uint64_t least;

	(void)state;
	CHECK(tile_budget_meet(&result, qualities, &options) == -E2BIG);
	least = result.total_bytes;
	CHECK(least == sum(qualities) && least > 1000);
	options.budget_bytes = least;
	CHECK(tile_budget_meet(&result, qualities, &options) == 0);
	CHECK(result.total_bytes == least);
	options.budget_bytes = least - 1;
	CHECK(tile_budget_meet(&result, qualities, &options) == -E2BIG);
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(more_features_mean_a_higher_quality),
		cmocka_unit_test(equal_counts_mean_equal_qualities),
		cmocka_unit_test(every_possible_budget_is_met_within_two_percent),
		cmocka_unit_test(less_bytes_mean_a_coarser_scale),
		cmocka_unit_test(an_ample_budget_gets_the_best_quality),
		cmocka_unit_test(an_impossible_budget_tells_the_least_possible),
	};

	return cmocka_run_group_tests(tests, NULL, NULL);
}
