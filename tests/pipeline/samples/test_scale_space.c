/* Feature points of range images whose answers are known. */
#include <errno.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "pipeline/samples/scale_space.h"
#include "tests/check.h"

enum { WIDTH = 96, HEIGHT = 64, MIDDLE = WIDTH / 2, BORDER = 12 };

static const struct scale_space_options four_scales = { .scale_count = 4,
							.sigma_px = { 1, 2, 3, 4 },
							.step_share = 0.002f };

static float texels[WIDTH * HEIGHT];
static const struct range_image image = { WIDTH, HEIGHT, texels };

/* A number of 0 .. 1 for each n, always the same. */
static float random_share(uint32_t n)
{
	n = (n ^ 61) ^ (n >> 16);
	n *= 9;
	n ^= n >> 4;
	n *= 0x27d4eb2d;
	n ^= n >> 15;
	return (float)(n & 0xffff) / 65535.0f;
}

static void make_plane(void)
{
	for (uint32_t y = 0; y < HEIGHT; y++)
		for (uint32_t x = 0; x < WIDTH; x++)
			texels[y * WIDTH + x] = 0.2f + 0.003f * (float)x - 0.001f * (float)y;
}

/* A wall one metre away on the left and 1.25 m away on the right. */
static void make_step(void)
{
	for (uint32_t i = 0; i < WIDTH * HEIGHT; i++)
		texels[i] = i % WIDTH < MIDDLE ? 1 : 0.8f;
}

static void hide_a_third(void)
{
	for (uint32_t i = 0; i < WIDTH * HEIGHT; i++)
		if (random_share(i) < 0.33f)
			texels[i] = 0;
}

static struct scale_map map_of(const struct scale_space_options *options)
{
	struct scale_map map;

	CHECK(scale_map_make(&map, &image, options) == 0);
	return map;
}

/* Counts the features that survive at least to a scale, in columns from .. end - 1. */
static uint32_t count(const struct scale_map *map, uint32_t scale, uint32_t from, uint32_t end)
{
	uint32_t found = 0;

	for (uint32_t y = 0; y < HEIGHT; y++)
		for (uint32_t x = from; x < end; x++)
			found += map->scales[y * WIDTH + x] >= scale;
	return found;
}

static void a_slanted_plane_has_no_feature(void **state)
{
	struct scale_map map;

	(void)state;
	make_plane();
	map = map_of(&four_scales);
	CHECK(count(&map, 1, 0, WIDTH) == 0);
	scale_map_finish(&map);
}

/* A mean of the seen texels alone would bend the plane beside every hole. */
static void a_plane_with_holes_has_no_feature(void **state)
{
	struct scale_map map;

	(void)state;
	make_plane();
	hide_a_third();
	for (uint32_t y = 20; y < 44; y++) /* and a large one */
		memset(texels + y * WIDTH + 30, 0, 30 * sizeof(*texels));
	map = map_of(&four_scales);
	CHECK(count(&map, 1, 0, WIDTH) == 0);
	scale_map_finish(&map);
}

static void a_step_survives_every_scale_at_its_place(void **state)
{
	struct scale_map map;

	(void)state;
	make_step();
	map = map_of(&four_scales);
	CHECK(count(&map, 1, 0, MIDDLE - 1) == 0);
	CHECK(count(&map, 1, MIDDLE + 1, WIDTH) == 0);
	/* one in each row, but for the first and the last, whose Laplacian is not known */
	for (uint32_t y = 1; y + 1 < HEIGHT; y++)
		CHECK((map.scales[y * WIDTH + MIDDLE - 1] == 4) !=
		      (map.scales[y * WIDTH + MIDDLE] == 4));
	CHECK(count(&map, 1, 0, WIDTH) == HEIGHT - 2);
	scale_map_finish(&map);
}

static void a_step_is_found_between_holes(void **state)
{
	const struct scale_space_options coarse = { 1, { 3 }, 0.02f };
	struct scale_map map;
	uint32_t near_step;

	(void)state;
	make_step();
	hide_a_third();
	map = map_of(&coarse);
	near_step = count(&map, 1, MIDDLE - 3, MIDDLE + 3);
	CHECK(near_step > HEIGHT / 2);
	CHECK(count(&map, 1, 0, WIDTH) == near_step);
	scale_map_finish(&map);
}

static void a_step_below_the_threshold_is_none(void **state)
{
	struct scale_space_options high = four_scales;
	struct scale_map map;

	(void)state;
	make_step();
	high.step_share = 0.5f;
	map = map_of(&high);
	CHECK(count(&map, 1, 0, WIDTH) == 0);
	scale_map_finish(&map);
}

/* Grooves every 16 texels on the right half, noise everywhere. */
static void noise_fades_and_a_carved_relief_stays(void **state)
{
	const struct scale_space_options fine = { 2, { 1, 4 }, 0.005f };
	struct scale_map map;
	uint32_t rows = HEIGHT - 2 * BORDER, noise, grooves = 0;

	(void)state;
	for (uint32_t i = 0; i < WIDTH * HEIGHT; i++) {
		float x = (float)(i % WIDTH);

		texels[i] = 1 + 0.02f * (random_share(i) - 0.5f);
		if (x > MIDDLE)
			texels[i] += 0.05f * sinf((x - MIDDLE) * (float)M_PI / 8);
	}
	map = map_of(&fine);
	noise = count(&map, 1, BORDER, MIDDLE - BORDER);
	CHECK(noise > rows * (MIDDLE - 2 * BORDER) / 4);
	CHECK(count(&map, 2, BORDER, MIDDLE - BORDER) < noise / 10);
	/* the sine is zero at 56, 64, 72 and 80 */
	for (uint32_t y = BORDER; y < HEIGHT - BORDER; y++)
		for (uint32_t zero = MIDDLE + 8; zero <= MIDDLE + 32; zero += 8) {
			const uint8_t *at = map.scales + y * WIDTH + zero;

			grooves += at[-1] == 2 || at[0] == 2 || at[1] == 2;
		}
	CHECK(grooves > rows * 4 * 95 / 100);
	scale_map_finish(&map);
}

static void the_queue_gives_the_longest_surviving_first(void **state)
{
	uint8_t scales[12] = { 0, 2, 1, 3, 0, 3, 1, 2, 2, 0, 1, 3 };
	static const uint32_t expected[9] = { 3, 5, 11, 1, 7, 8, 2, 6, 10 };
	const struct scale_map map = { 4, 3, 3, scales };
	struct feature_queue queue;
	uint32_t point, n = 0;

	(void)state;
	CHECK(feature_queue_make(&queue, &map) == 0);
	CHECK(queue.counts[3] == 3 && queue.counts[2] == 6 && queue.counts[1] == 9);
	for (uint32_t scale = 4; scale > 0; scale--) {
		while (feature_queue_pop(&queue, scale, &point)) {
			CHECK(n < 9 && point == expected[n]);
			n++;
		}
		CHECK(n == queue.counts[scale]);
	}
	feature_queue_finish(&queue);
}

static void a_map_without_features_makes_an_empty_queue(void **state)
{
	uint8_t scales[4] = { 0 };
	const struct scale_map map = { 2, 2, SCALE_SPACE_SCALES_MAX, scales };
	struct feature_queue queue;
	uint32_t point;

	(void)state;
	CHECK(feature_queue_make(&queue, &map) == 0);
	CHECK(!feature_queue_pop(&queue, 1, &point));
	feature_queue_finish(&queue);
}

static void refuses_options_out_of_range(void **state)
{
	static const struct scale_space_options wrong[] = {
		{ 0, { 1 }, 0.1f },    { SCALE_SPACE_SCALES_MAX + 1, { 1 }, 0.1f },
		{ 2, { 2, 2 }, 0.1f }, { 1, { 0 }, 0.1f },
		{ 1, { 33 }, 0.1f },   { 1, { 1 }, 0 },
		{ 1, { NAN }, 0.1f },
	};
	struct scale_map map;
	struct range_image empty = image;

	(void)state;
	make_step();
	for (size_t i = 0; i < ARRAY_COUNT(wrong); i++)
		CHECK(scale_map_make(&map, &image, &wrong[i]) == -EINVAL && !map.scales);
	empty.height_px = 0;
	CHECK(scale_map_make(&map, &empty, &four_scales) == -EINVAL);
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(a_slanted_plane_has_no_feature),
		cmocka_unit_test(a_plane_with_holes_has_no_feature),
		cmocka_unit_test(a_step_survives_every_scale_at_its_place),
		cmocka_unit_test(a_step_is_found_between_holes),
		cmocka_unit_test(a_step_below_the_threshold_is_none),
		cmocka_unit_test(noise_fades_and_a_carved_relief_stays),
		cmocka_unit_test(the_queue_gives_the_longest_surviving_first),
		cmocka_unit_test(a_map_without_features_makes_an_empty_queue),
		cmocka_unit_test(refuses_options_out_of_range),
	};

	return cmocka_run_group_tests(tests, NULL, NULL);
}
