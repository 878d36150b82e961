#include "pipeline/samples/tile_choice.h"

#include <errno.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "tests/check.h"
#include "tests/pipeline/samples/tile_of.h"

enum { POINTS = 20, TILES = 5, ALL = POINTS * TILES, CHOICES = 3, SCALES = 2 };

static char dir[64];
static const struct hash key = { { 7 } };
static const struct sample_grid plain = { .spacing_m = { 1, 1, 1 },
					  .count = { POINTS, 1, 1 },
					  .level_count = 2,
					  .choice_count = CHOICES,
					  .qualities = { 20, 60, 90 } };

static int make_dir(void **state)
{
	(void)state;
	snprintf(dir, sizeof(dir), "/tmp/gopura-choice-XXXXXX");
	return mkdtemp(dir) ? 0 : -1;
}

static int remove_dir(void **state)
{
	char command[128];

	(void)state;
	snprintf(command, sizeof(command), "rm -rf %s", dir);
	return system(command);
}

/* Bytes of a tile, numbered through, at a quality. Tile 3 takes fewer at its best than in the
 * middle. */
static uint32_t size_of(uint32_t tile, uint32_t choice)
{
	static const uint32_t factors[CHOICES] = { 10, 20, 45 };

	return tile == 3 && choice == 1 ? 9000 : factors[choice] * (5 + tile % 7);
}

/* What it loses; with more bytes it is less. */
static uint32_t loss_of(uint32_t tile, uint32_t choice)
{
	static const uint32_t losses[CHOICES] = { 90000, 40000, 10000 };

	return tile % 3 == 0 ? 0 : losses[choice] * (tile == 50 ? 10 : 1);
}

static struct samples_store *fill(const struct sample_grid *grid)
{
	static const uint16_t places[TILES] = { 0, 1, 2, 3, 4 };
	static uint8_t bytes[9000];
	struct samples_store *store;

	CHECK(samples_store_begin(dir, grid, key) == 0);
	for (uint32_t x = 0; x < POINTS; x++) {
		uint32_t features[TILES][SAMPLE_SCALES_MAX] = { 0 };
		uint32_t losses[TILES * SAMPLE_CHOICES_MAX] = { 0 };
		const uint16_t windows[TILES] = { 4, 4, 4, 4, 4 };
		struct bytes objects[TILES * CHOICES];
		struct sample_face face = {
			.face = 2,
			.level_count = 2,
			.coverage = 1,
			.near_m = 1,
			.far_m = 2,
			.tile_count = TILES,
			.tiles = places,
			.objects = objects,
			.windows = windows,
			.losses = losses,
			.features = (const uint32_t(*)[SAMPLE_SCALES_MAX])features
		};

		for (uint32_t i = 0; i < TILES; i++) {
			for (uint32_t c = 0; c < CHOICES; c++)
				losses[i * SAMPLE_CHOICES_MAX + c] = loss_of(x * TILES + i, c);
			for (uint32_t c = 0; c < CHOICES; c++)
				objects[i * CHOICES + c] =
					(struct bytes){ bytes, size_of(x * TILES + i, c) };
			features[i][0] = 1000 * x; /* points with a high x are relief */
			features[i][1] = 100 * x;
		}
		CHECK(samples_store_put(dir, key, grid, SAMPLE_RENDERED, (uint32_t[3]){ x, 0, 0 },
					&face, 1) == 0);
	}
	CHECK(samples_store_open(&store, dir) == 0);
	return store;
}

/* Of the tiles that the store now gives. */
static uint64_t bytes_given(struct samples_store *store)
{
	struct sample_face face;
	uint64_t bytes = 0;

	samples_store_rewind(store);
	while (samples_store_next(store, &face) == 1)
		for (uint32_t i = 0; i < face.tile_count; i++)
			bytes += tile_of(&face, i).size;
	return bytes;
}

static void meets_budgets(enum tile_choice_rule rule)
{
	struct samples_store *store = fill(&plain);
	struct tile_choice least, choice;

	CHECK(tile_choice_make(&least, store, rule, NULL, 0) == 0);
	CHECK(least.tile_count == ALL && least.bytes == least.least_bytes);
	CHECK(least.counts[0] == ALL);
	for (uint64_t budget = least.bytes; budget <= least.most_bytes + 500; budget += 61) {
		CHECK(tile_choice_make(&choice, store, rule, NULL, budget) == 0);
		CHECK(choice.bytes <= budget);
		CHECK(choice.bytes * 100 >= budget * 98 || choice.bytes == choice.most_bytes ||
		      budget < least.bytes + 400);
		CHECK(choice.counts[0] + choice.counts[1] + choice.counts[2] == ALL);
		CHECK(samples_store_choose(store, choice.choices, choice.tile_count) == 0);
		CHECK(bytes_given(store) == choice.bytes);
		tile_choice_finish(&choice);
	}
	CHECK(tile_choice_make(&choice, store, rule, NULL, least.bytes - 1) == -E2BIG);
	CHECK(choice.least_bytes == least.bytes);
	tile_choice_finish(&choice);
	tile_choice_finish(&least);
	samples_store_close(store);
}

static void budgets_are_met(void **state)
{
	(void)state;
	meets_budgets(TILE_CHOICE_QUALITY);
	meets_budgets(TILE_CHOICE_GAIN);
}

/* Every third tile loses nothing at its lowest quality: bytes are for the others, of which one with
 * ten times the loss comes first. */
static void bytes_go_where_they_gain(void **state)
{
	struct samples_store *store = fill(&plain);
	struct tile_choice gain, alike;
	uint32_t raised;

	(void)state;
	for (uint64_t budget = 9500; budget <= 24000; budget += 1450) {
		CHECK(tile_choice_make(&gain, store, TILE_CHOICE_GAIN, NULL, budget) == 0);
		CHECK(tile_choice_make(&alike, store, TILE_CHOICE_QUALITY, NULL, budget) == 0);
		CHECK(gain.similarity > alike.similarity);
		CHECK(gain.choices[50] > 0);
		/* but for a few with which the last bytes are used */
		raised = 0;
		for (uint32_t i = 0; i < ALL; i += 3)
			raised += gain.choices[i] > 0;
		CHECK(raised <= 3);
		tile_choice_finish(&gain);
		tile_choice_finish(&alike);
	}
	samples_store_close(store);
}

/* What is hardly ever shown waits; and the mean similarity is of what is shown. */
static void bytes_go_where_the_weight_is(void **state)
{
	struct samples_store *store = fill(&plain);
	struct tile_choice weighted, alike;
	float weights[ALL];
	uint32_t sums[2] = { 0 };

	(void)state;
	for (uint32_t i = 0; i < ALL; i++)
		weights[i] = i < ALL / 2 ? 0.01f : 1;
	CHECK(tile_choice_make(&weighted, store, TILE_CHOICE_GAIN, weights, 14000) == 0);
	CHECK(tile_choice_make(&alike, store, TILE_CHOICE_GAIN, NULL, 14000) == 0);
	for (uint32_t i = 0; i < ALL; i++)
		sums[i / (ALL / 2)] += weighted.choices[i];
	CHECK(sums[1] > 4 * sums[0]);
	CHECK(weighted.similarity > alike.similarity);
	tile_choice_finish(&weighted);
	tile_choice_finish(&alike);
	/* Weights of one size change nothing. */
	for (uint32_t i = 0; i < ALL; i++)
		weights[i] = 0.5f;
	CHECK(tile_choice_make(&weighted, store, TILE_CHOICE_GAIN, weights, 14000) == 0);
	CHECK(tile_choice_make(&alike, store, TILE_CHOICE_GAIN, NULL, 14000) == 0);
	CHECK(memcmp(weighted.choices, alike.choices, ALL) == 0);
	CHECK(weighted.similarity == alike.similarity);
	tile_choice_finish(&weighted);
	tile_choice_finish(&alike);
	samples_store_close(store);
}

/* A better tile of fewer bytes is taken in place of a worse one. */
static void nothing_worse_costs_more(void **state)
{
	struct samples_store *store = fill(&plain);
	struct tile_choice choice;

	(void)state;
	for (uint64_t budget = 10000; budget < 40000; budget += 777) {
		CHECK(tile_choice_make(&choice, store, TILE_CHOICE_QUALITY, NULL, budget) == 0);
		CHECK(choice.choices[3] != 1);
		tile_choice_finish(&choice);
	}
	samples_store_close(store);
}

/* Half of the tiles are one better than the rest: not those of one side. */
static void what_is_left_is_spread_over_all(void **state)
{
	struct samples_store *store = fill(&plain);
	struct tile_choice choice;
	uint32_t better[2] = { 0 };

	(void)state;
	CHECK(tile_choice_make(&choice, store, TILE_CHOICE_QUALITY, NULL, 12000) == 0);
	for (uint32_t i = 0; i < ALL; i++)
		better[i / (ALL / 2)] += choice.choices[i] > 0;
	CHECK(better[0] > ALL / 8 && better[1] > ALL / 8);
	CHECK(better[0] + better[1] < ALL);
	CHECK(better[0] < better[1] + ALL / 8 && better[1] < better[0] + ALL / 8);
	tile_choice_finish(&choice);
	samples_store_close(store);
}

static void relief_gets_more(void **state)
{
	struct sample_grid grid = plain;
	struct samples_store *store;
	struct tile_choice choice;

	(void)state;
	grid.scale_count = SCALES;
	store = fill(&grid);
	for (uint64_t budget = 12000; budget <= 26000; budget += 14000) {
		uint32_t sums[2] = { 0 };

		CHECK(tile_choice_make(&choice, store, TILE_CHOICE_QUALITY, NULL, budget) == 0);
		CHECK(choice.bytes <= budget && choice.bytes * 100 >= budget * 98);
		for (uint32_t i = 0; i < ALL; i++)
			sums[i / (ALL / 2)] += choice.choices[i];
		CHECK(sums[1] > sums[0] + ALL / 5);
		tile_choice_finish(&choice);
	}
	samples_store_close(store);
}

static void the_choice_is_kept_until_samples_change(void **state)
{
	struct samples_store *store = fill(&plain);
	struct tile_choice choice;
	struct sample_grid other = plain;

	(void)state;
	CHECK(tile_choice_make(&choice, store, TILE_CHOICE_QUALITY, NULL, 15000) == 0);
	CHECK(samples_store_choose(store, choice.choices, choice.tile_count) == 0);
	CHECK(samples_store_keep_choice(store) == 0);
	samples_store_close(store);
	CHECK(samples_store_open(&store, dir) == 0);
	CHECK(bytes_given(store) == choice.bytes);
	CHECK(choice.bytes < choice.most_bytes);
	samples_store_close(store);
	/* Samples of another key: the best tiles again. */
	CHECK(samples_store_begin(dir, &other, (struct hash){ { 8 } }) == 0);
	CHECK(samples_store_open(&store, dir) == -ENOENT);
	tile_choice_finish(&choice);
}

static void a_store_without_a_choice_is_refused(void **state)
{
	struct sample_grid grid = plain;
	struct samples_store *store;
	struct tile_choice choice;

	(void)state;
	grid.choice_count = 1;
	store = fill(&grid);
	CHECK(tile_choice_make(&choice, store, TILE_CHOICE_QUALITY, NULL, 10000) == -EINVAL);
	CHECK(bytes_given(store) > 0);
	samples_store_close(store);
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(budgets_are_met),
		cmocka_unit_test(bytes_go_where_they_gain),
		cmocka_unit_test(bytes_go_where_the_weight_is),
		cmocka_unit_test(nothing_worse_costs_more),
		cmocka_unit_test(what_is_left_is_spread_over_all),
		cmocka_unit_test(relief_gets_more),
		cmocka_unit_test(the_choice_is_kept_until_samples_change),
		cmocka_unit_test(a_store_without_a_choice_is_refused),
	};

	return cmocka_run_group_tests(tests, make_dir, remove_dir);
}
