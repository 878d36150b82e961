/* Substances: many places at once are the same as each alone; they keep their mean as they go far;
 * and the cache of a substance gives what the substance gives, computes nothing twice, and stays in
 * its budget.
 */
#include "tests/bench/cache_cube.h"

#include <math.h>
#include <stdio.h>

#include "tests/check.h"

enum { SIDE_PX = 160 };

/* A floor of 4 m seen at a slant: near pixels are small, far ones large. */
static void floor_place(int x, int y, float at[3], float *footprint_m)
{
	const float depth = 1 + 3.0f * (float)y / SIDE_PX;

	at[0] = ((float)x / SIDE_PX - 0.5f) * depth;
	at[1] = depth - 2.5f;
	at[2] = 0.1f * at[0];
	*footprint_m = depth / SIDE_PX;
}

/* Compares a picture of a cache with the function: peak signal to noise, decibel. */
static double agreement_db(struct cache_cube *cache, enum substance_kind kind)
{
	double sum = 0;

	for (int y = 0; y < SIDE_PX; y++)
		for (int x = 0; x < SIDE_PX; x++) {
			float at[3], footprint_m, a[3], b[3];

			floor_place(x, y, at, &footprint_m);
			cache_cube_colour(cache, a, at, footprint_m);
			substance_colour(b, kind, at, footprint_m);
			for (int k = 0; k < 3; k++)
				sum += (double)(a[k] - b[k]) * (double)(a[k] - b[k]);
		}
	return -10 * log10(sum / (3.0 * SIDE_PX * SIDE_PX));
}

static struct cache_cube_options options_of(enum substance_kind kind)
{
	return (struct cache_cube_options){ .kind = kind,
					    .low_m = { -4, -4, -4 },
					    .side_m = 8,
					    .level_least = 3,
					    .level_most = 13,
					    .budget_bytes = 1 << 30 };
}

static void shows_what_the_function_does_within_40_db(void **state)
{
	(void)state;
	for (int kind = SUBSTANCE_NONE + 1; kind < SUBSTANCE_KINDS; kind++) {
		const struct cache_cube_options options = options_of((enum substance_kind)kind);
		struct cache_cube_counts first, second;
		struct cache_cube *cache;
		double db;

		CHECK(cache_cube_create(&cache, &options) == 0);
		db = agreement_db(cache, options.kind);
		first = cache_cube_counts(cache);
		print_message("%s: %.1f dB, %.1f MB\n", substance_names[kind], db,
			      (double)first.cell_bytes / 1e6);
		CHECK(db > 40);
		CHECK(agreement_db(cache, options.kind) == db);
		second = cache_cube_counts(cache);
		CHECK(second.computed == first.computed && first.computed > 10000);
		cache_cube_destroy(cache);
	}
}

static void stays_within_its_budget(void **state)
{
	struct cache_cube_options options = options_of(SUBSTANCE_MARBLE);
	struct cache_cube *cache;
	struct cache_cube_counts counts;
	(void)state;

	options.budget_bytes = 100000;
	CHECK(cache_cube_create(&cache, &options) == 0);
	CHECK(agreement_db(cache, SUBSTANCE_MARBLE) > 40);
	counts = cache_cube_counts(cache);
	CHECK(counts.cell_bytes <= 100000 && counts.cell_bytes > 0 && counts.forgotten > 0);
	cache_cube_destroy(cache);
}

/* With every number of places up to one more than vectors are wide. */
static void is_the_same_for_many_places_at_once(void **state)
{
	enum { COUNT = 33 };
	float at[3][COUNT], size[COUNT], rgb[3][COUNT], one[3];
	const float *const places[3] = { at[0], at[1], at[2] };
	float *const colours[3] = { rgb[0], rgb[1], rgb[2] };
	(void)state;

	for (int i = 0; i < COUNT; i++) {
		for (int k = 0; k < 3; k++)
			at[k][i] = (float)((7919 * (i + 1) * (k + 3)) % 977) * 0.031f - 15;
		size[i] = 0.002f * (float)(i % 9);
	}
	for (int kind = SUBSTANCE_NONE + 1; kind < SUBSTANCE_KINDS; kind++)
		for (uint32_t count = 1; count <= COUNT; count++) {
			substance_colours(colours, (enum substance_kind)kind, places, size, count);
			for (uint32_t i = 0; i < count; i++) {
				const float place[3] = { at[0][i], at[1][i], at[2][i] };

				substance_colour(one, (enum substance_kind)kind, place, size[i]);
				for (int k = 0; k < 3; k++)
					CHECK(fabsf(one[k] - rgb[k][i]) < 1e-5f);
			}
		}
}

/* The mean over a floor does not depend on how coarse its pixels are. */
static void keeps_its_mean_from_afar(void **state)
{
	(void)state;
	for (int kind = SUBSTANCE_NONE + 1; kind < SUBSTANCE_KINDS; kind++) {
		double mean[2] = { 0, 0 };

		for (int i = 0; i < 60000; i++)
			for (int far = 0; far < 2; far++) {
				const float at[3] = { (float)(i % 251) * 0.0717f,
						      (float)(i % 241) * 0.0523f,
						      (float)(i % 239) * 0.0391f };
				float rgb[3];

				substance_colour(rgb, (enum substance_kind)kind, at,
						 far ? 2.0f : 0);
				mean[far] += (double)(rgb[0] + rgb[1] + rgb[2]) / 180000;
			}
		print_message("%s: %.3f near, %.3f far\n", substance_names[kind], mean[0], mean[1]);
		CHECK(fabs(mean[0] - mean[1]) < 0.04);
	}
}

static void has_names(void **state)
{
	(void)state;
	for (int kind = 0; kind < SUBSTANCE_KINDS; kind++)
		CHECK(substance_named(substance_names[kind]) == (enum substance_kind)kind);
	CHECK(substance_named("granite") == SUBSTANCE_KINDS &&
	      substance_named("") == SUBSTANCE_KINDS);
}

/* Outside of the cubes nothing is kept; at their very border it is. */
static void answers_everywhere(void **state)
{
	static const float places[][3] = {
		{ 4, 4, 4 }, { -4, -4, -4 }, { 5, 0, 0 }, { NAN, 0, 0 }
	};
	struct cache_cube_options options = options_of(SUBSTANCE_SANDSTONE);
	struct cache_cube *cache;
	(void)state;

	options.level_most = options.level_least = 5; /* a single cube */
	CHECK(cache_cube_create(&cache, &options) == 0);
	for (size_t i = 0; i < ARRAY_COUNT(places); i++) {
		float rgb[3];

		cache_cube_colour(cache, rgb, places[i], 0);
		CHECK((cache_cube_counts(cache).cells > 0) == true);
		CHECK(i == 3 || (rgb[0] > 0.1f && rgb[0] < 1.01f));
	}
	CHECK(cache_cube_counts(cache).cells == 2);
	CHECK(cache_cube_fill(cache) == 0 && cache_cube_counts(cache).computed == 1u << 15);
	cache_cube_destroy(cache);
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(has_names),
		cmocka_unit_test(is_the_same_for_many_places_at_once),
		cmocka_unit_test(keeps_its_mean_from_afar),
		cmocka_unit_test(shows_what_the_function_does_within_40_db),
		cmocka_unit_test(stays_within_its_budget),
		cmocka_unit_test(answers_everywhere),
	};
	return cmocka_run_group_tests(tests, NULL, NULL);
}
