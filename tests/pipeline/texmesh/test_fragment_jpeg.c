#include "pipeline/texmesh/fragment_jpeg.h"

#include <errno.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "format/picture.h"
#include "tests/check.h"

enum { FRAGMENT_PX = 64, BEST = 95 };

/* ---- pictures: noise in octaves, so that every quality has something to leave out */

static uint32_t scramble(uint32_t x)
{
	x = (x ^ x >> 16) * 0x7feb352du;
	x = (x ^ x >> 15) * 0x846ca68bu;
	return x ^ x >> 16;
}

static double lattice(uint32_t x, uint32_t y, uint32_t salt)
{
	return scramble(x + scramble(y + scramble(salt))) / 4294967296.0 - 0.5;
}

static double smooth_noise(uint32_t x, uint32_t y, uint32_t cell, uint32_t salt)
{
	uint32_t i = x / cell, j = y / cell;
	double u = (double)(x % cell) / cell, v = (double)(y % cell) / cell;

	return (1 - v) * ((1 - u) * lattice(i, j, salt) + u * lattice(i + 1, j, salt)) +
	       v * ((1 - u) * lattice(i, j + 1, salt) + u * lattice(i + 1, j + 1, salt));
}

static uint8_t *make_rgb(uint32_t width, uint32_t height)
{
	uint8_t *rgb = malloc((size_t)width * height * 3);

	for (uint32_t i = 0; i < width * height; i++)
		for (uint32_t channel = 0; channel < 3; channel++) {
			uint32_t x = i % width, y = i / width;
			double value = 128 + 30 * smooth_noise(x, y, 61, 7 + channel);

			for (uint32_t cell = 32; cell > 0; cell /= 2)
				value += (6 + cell) * smooth_noise(x, y, cell, cell);
			rgb[3 * i + channel] = (uint8_t)fmin(255, fmax(0, value));
		}
	return rgb;
}

struct stage {
	uint8_t *rgb;
	uint32_t width, height, count;
	struct fragment_jpeg *jpeg;
	uint8_t *qualities;
	struct buffer file;
	struct picture shown; /* the file, decoded */
};

static struct stage stage_make_with(uint32_t width, uint32_t height, const bool *used, uint8_t best)
{
	struct stage stage = { .rgb = make_rgb(width, height), .width = width, .height = height };

	CHECK(fragment_jpeg_create(&stage.jpeg, stage.rgb, width, height, FRAGMENT_PX, used,
				   best) == 0);
	stage.count = fragment_jpeg_count(stage.jpeg);
	stage.qualities = malloc(stage.count);
	memset(stage.qualities, BEST, stage.count);
	buffer_init(&stage.file, 1 << 24);
	return stage;
}

static struct stage stage_make(uint32_t width, uint32_t height, const bool *used)
{
	return stage_make_with(width, height, used, BEST);
}

static void stage_write(struct stage *stage)
{
	buffer_clear(&stage->file);
	picture_finish(&stage->shown);
	CHECK(fragment_jpeg_write(stage->jpeg, stage->qualities, &stage->file) == 0);
	CHECK(picture_decode(&stage->shown, buffer_bytes(&stage->file)) == 0);
	CHECK(stage->shown.width == stage->width && stage->shown.height == stage->height);
}

static void stage_write_all_at(struct stage *stage, uint8_t quality)
{
	memset(stage->qualities, quality, stage->count);
	stage_write(stage);
}

static uint32_t stage_estimate(const struct stage *stage)
{
	uint32_t sum = 0;

	for (uint32_t i = 0; i < stage->count; i++)
		sum += fragment_jpeg_bytes(stage->jpeg, i, stage->qualities[i]);
	return sum;
}

/* Mean square difference from the picture that was compressed. */
static double stage_error(const struct stage *stage)
{
	double sum = 0;
	size_t pixels = (size_t)stage->width * stage->height;

	for (size_t i = 0; i < pixels; i++)
		for (int channel = 0; channel < 3; channel++) {
			double d = (double)stage->shown.rgba[4 * i + channel] -
				   stage->rgb[3 * i + channel];

			sum += d * d;
		}
	return sum / (double)pixels / 3;
}

static void stage_finish(struct stage *stage)
{
	fragment_jpeg_destroy(stage->jpeg);
	picture_finish(&stage->shown);
	buffer_finish(&stage->file);
	free(stage->qualities);
	free(stage->rgb);
}

/* ---- the file */

static void is_the_plain_file_at_the_best_quality(void **state)
{
	static const uint8_t bests[] = { 30, 60, 90, BEST };
	struct picture plain = { .width = 200, .height = 136, .rgba = malloc(200 * 136 * 4) };

	(void)state;
	for (size_t i = 0; i < ARRAY_COUNT(bests); i++) {
		struct stage stage = stage_make_with(200, 136, NULL, bests[i]);
		struct picture back;
		struct buffer file;

		for (int k = 0; k < 200 * 136; k++) {
			memcpy(plain.rgba + 4 * k, stage.rgb + 3 * k, 3);
			plain.rgba[4 * k + 3] = 255;
		}
		buffer_init(&file, 1 << 24);
		CHECK(picture_encode_jpeg(&file, &plain, bests[i]) == 0);
		CHECK(picture_decode(&back, buffer_bytes(&file)) == 0);
		CHECK(stage.count == 4 * 3);
		stage_write(&stage); /* at 95, which is taken for the best */
		CHECK(memcmp(stage.shown.rgba, back.rgba, 200 * 136 * 4) == 0);
		CHECK(bests[i] < BEST || stage_error(&stage) < 16);
		CHECK(fragment_jpeg_bytes(stage.jpeg, 0, BEST) ==
		      fragment_jpeg_bytes(stage.jpeg, 0, bests[i]));
		buffer_finish(&file);
		picture_finish(&back);
		stage_finish(&stage);
	}
	picture_finish(&plain);
}

static bool is_within(uint32_t x, uint32_t from, uint32_t to, uint32_t border)
{
	return x + border >= from && x < to + border;
}

static void changes_only_the_pixels_of_a_coarse_fragment(void **state)
{
	struct stage stage = stage_make(200, 136, NULL);
	struct picture fine;
	size_t fine_bytes;
	uint32_t changed = 0;

	(void)state;
	stage_write(&stage);
	fine = stage.shown;
	fine_bytes = stage.file.size;
	stage.shown = (struct picture){ 0 };
	stage.qualities[5] = 20; /* column 1, row 1 */
	stage_write(&stage);
	for (uint32_t i = 0; i < 200 * 136; i++) {
		if (memcmp(fine.rgba + 4 * i, stage.shown.rgba + 4 * i, 4) == 0)
			continue;
		changed++;
		CHECK(is_within(i % 200, 64, 128, 1) && is_within(i / 200, 64, 128, 1));
	}
	CHECK(changed > 64 * 64 / 2);
	CHECK(stage.file.size < fine_bytes - fine_bytes / 20);
	picture_finish(&fine);
	stage_finish(&stage);
}

static void a_lower_quality_has_more_error_and_fewer_bytes(void **state)
{
	static const uint8_t falling[] = { 95, 90, 80, 60, 40, 20, 10, 5 };
	struct stage stage = stage_make(256, 256, NULL);
	size_t bytes = SIZE_MAX;
	double error = 0;

	(void)state;
	for (size_t i = 0; i < sizeof(falling); i++) {
		stage_write_all_at(&stage, falling[i]);
		CHECK(stage.file.size < bytes - (i > 0 ? bytes / 20 : 0));
		CHECK(stage_error(&stage) > error);
		bytes = stage.file.size;
		error = stage_error(&stage);
	}
	stage_finish(&stage);
}

/* What was written before must not be in what is written next; and a file is appended. */
static void writes_again_from_the_best_quality(void **state)
{
	struct stage stage = stage_make(200, 136, NULL);
	struct buffer first;

	(void)state;
	stage_write(&stage);
	first = stage.file;
	buffer_init(&stage.file, 1 << 24);
	memset(stage.rgb, 0, 200 * 136 * 3);
	stage_write_all_at(&stage, 3);
	stage_write_all_at(&stage, 255); /* as 95 */
	CHECK(bytes_equal(buffer_bytes(&first), buffer_bytes(&stage.file)));
	CHECK(fragment_jpeg_write(stage.jpeg, stage.qualities, &stage.file) == 0);
	CHECK(stage.file.size == 2 * first.size);
	CHECK(memcmp(stage.file.data + first.size, first.data, first.size) == 0);
	buffer_finish(&first);
	stage_finish(&stage);
}

static void says_when_the_buffer_is_full(void **state)
{
	struct stage stage = stage_make(512, 512, NULL);
	struct buffer small;

	(void)state;
	buffer_init(&small, 1 << 15); /* some is written before it is full */
	stage_write(&stage);
	CHECK(stage.file.size > 1 << 15);
	buffer_put_u8(&small, 1);
	CHECK(fragment_jpeg_write(stage.jpeg, stage.qualities, &small) == -EFBIG);
	CHECK(small.size == 1);
	buffer_finish(&small);
	stage_finish(&stage);
}

/* The largest coefficients, rounded up, must not be more than a JPEG can hold. */
static void takes_the_hardest_contrasts(void **state)
{
	enum { SIDE = 48 };
	uint8_t rgb[SIDE * SIDE * 3];
	struct fragment_jpeg *jpeg;
	struct buffer file;
	struct picture back;

	(void)state;
	for (uint32_t shape = 0; shape < 6; shape++) {
		uint32_t shift = shape / 2;
		bool stripes = shape % 2;

		for (uint32_t i = 0; i < SIDE * SIDE; i++)
			memset(rgb + 3 * i,
			       ((i % SIDE >> shift ^ (stripes ? 0 : i / SIDE >> shift)) & 1) * 255,
			       3);
		CHECK(fragment_jpeg_create(&jpeg, rgb, SIDE, SIDE, 16, NULL,
					   FRAGMENT_JPEG_QUALITY_MOST) == 0);
		for (uint8_t quality = 1; quality <= BEST; quality++) {
			uint8_t qualities[9];

			memset(qualities, quality, sizeof(qualities));
			buffer_init(&file, 1 << 20);
			CHECK(fragment_jpeg_write(jpeg, qualities, &file) == 0);
			CHECK(picture_decode(&back, buffer_bytes(&file)) == 0);
			picture_finish(&back);
			buffer_finish(&file);
		}
		fragment_jpeg_destroy(jpeg);
	}
}

static void takes_every_size_around_a_fragment(void **state)
{
	static const uint32_t sides[] = { 1, 7, 8, 9, 16, 17, 63, 64, 65, 72, 129 };

	(void)state;
	for (size_t i = 0; i < ARRAY_COUNT(sides); i++)
		for (size_t j = 0; j < ARRAY_COUNT(sides); j++) {
			struct stage stage = stage_make(sides[i], sides[j], NULL);

			CHECK(stage.count == ((sides[i] + 63) / 64) * ((sides[j] + 63) / 64));
			stage_write(&stage);
			CHECK(stage_error(&stage) < 40);
			stage_write_all_at(&stage, 30);
			CHECK(fragment_jpeg_bytes(stage.jpeg, stage.count - 1, 30) > 0);
			stage_finish(&stage);
		}
}

/* ---- fragments that are not used */

static void unused_fragments_take_little(void **state)
{
	bool used[64];
	struct stage stage, rest;
	size_t bytes;

	(void)state;
	for (int i = 0; i < 64; i++)
		used[i] = i % 8 < 4;
	stage = stage_make(512, 512, used);
	stage_write(&stage);
	for (uint32_t i = 0; i < stage.count; i++)
		CHECK(used[i] || fragment_jpeg_bytes(stage.jpeg, i, BEST) < 32);
	/* The used half alone is no more than a tenth smaller. */
	rest = stage_make(256, 512, NULL);
	stage_write(&rest);
	bytes = rest.file.size;
	CHECK(stage.file.size < bytes + bytes / 10);
	/* Their quality is of no account, and what is used is as in the whole picture. */
	stage.qualities[7] = 1;
	bytes = stage.file.size;
	stage_write(&stage);
	CHECK(stage.file.size == bytes);
	stage_finish(&rest);
	rest = stage_make(512, 512, NULL);
	stage_write(&rest);
	for (uint32_t i = 0; i < 512 * 512; i++)
		if (i % 512 < 255)
			CHECK(memcmp(stage.shown.rgba + 4 * i, rest.shown.rgba + 4 * i, 4) == 0);
	/* An unused block repeats the one before it, here far from grey, up to the end of the row.
	 */
	for (uint32_t y = 8; y < 512; y += 64)
		CHECK(memcmp(stage.shown.rgba + 4 * (y * 512 + 300),
			     stage.shown.rgba + 4 * (y * 512 + 508), 3) == 0 &&
		      stage.shown.rgba[4 * (y * 512 + 300)] != 128);
	stage_finish(&rest);
	stage_finish(&stage);
}

static void a_picture_without_used_fragments_is_grey(void **state)
{
	bool used[4] = { false };
	struct stage stage = stage_make(128, 128, used);

	(void)state;
	stage_write(&stage);
	CHECK(stage.file.size < 1000);
	for (int i = 0; i < 128 * 128; i++)
		CHECK(stage.shown.rgba[4 * i] == 128);
	stage_finish(&stage);
}

/* ---- the estimate */

static void check_estimate(const struct stage *stage, double share)
{
	double headers = 700, real = (double)stage->file.size;

	CHECK(stage_estimate(stage) < real * (1 + share));
	CHECK(stage_estimate(stage) + headers > real * (1 - share));
}

static void estimates_near_the_real_size(void **state)
{
	static const uint8_t qualities[] = { 95, 92, 90, 86, 78, 65, 55, 33, 20, 12, 8, 4, 1 };
	struct stage stage = stage_make(512, 512, NULL);

	(void)state;
	for (size_t i = 0; i < sizeof(qualities); i++) {
		stage_write_all_at(&stage, qualities[i]);
		check_estimate(&stage, 0.07);
	}
	for (uint32_t i = 0; i < stage.count; i++)
		stage.qualities[i] = (uint8_t)(1 + scramble(i) % BEST);
	stage_write(&stage);
	check_estimate(&stage, 0.15);
	stage_finish(&stage);
}

static void estimates_what_a_fragment_adds(void **state)
{
	struct stage stage = stage_make(512, 512, NULL);
	size_t fine_bytes;
	int real, estimated;

	(void)state;
	stage_write(&stage);
	fine_bytes = stage.file.size;
	stage.qualities[27] = 30;
	stage_write(&stage);
	real = (int)(fine_bytes - stage.file.size);
	estimated = (int)(fragment_jpeg_bytes(stage.jpeg, 27, BEST) -
			  fragment_jpeg_bytes(stage.jpeg, 27, 30));
	CHECK(abs(real - estimated) < real / 4);
	stage_finish(&stage);
}

static void never_estimates_fewer_bytes_at_a_higher_quality(void **state)
{
	struct stage stage = stage_make(200, 136, NULL);

	(void)state;
	for (uint32_t i = 0; i < stage.count; i++) {
		for (uint8_t quality = 1; quality <= BEST; quality++)
			CHECK(fragment_jpeg_bytes(stage.jpeg, i, quality) >=
			      fragment_jpeg_bytes(stage.jpeg, i, quality - 1));
		CHECK(fragment_jpeg_bytes(stage.jpeg, i, BEST) >
		      2 * fragment_jpeg_bytes(stage.jpeg, i, 10));
		CHECK(fragment_jpeg_bytes(stage.jpeg, i, 255) ==
		      fragment_jpeg_bytes(stage.jpeg, i, BEST));
	}
	stage_finish(&stage);
}

/* ---- sizes */

static void refuses_sizes_that_it_cannot_take(void **state)
{
	static const uint32_t bad[][3] = {
		{ 0, 1, 16 }, { 1, 0, 16 }, { 16385, 1, 16 }, { 1, 16385, 16 },
		{ 1, 1, 0 },  { 1, 1, 8 },  { 1, 1, 24 },
	};
	const uint8_t rgb[3] = { 0 };
	struct fragment_jpeg *jpeg;

	(void)state;
	for (size_t i = 0; i < ARRAY_COUNT(bad); i++) {
		jpeg = (struct fragment_jpeg *)&rgb;
		CHECK(fragment_jpeg_create(&jpeg, rgb, bad[i][0], bad[i][1], bad[i][2], NULL, 95) ==
		      -EINVAL);
		CHECK(jpeg == NULL);
	}
	CHECK(fragment_jpeg_create(&jpeg, rgb, 1, 1, 16, NULL, 0) == -EINVAL);
	CHECK(fragment_jpeg_create(&jpeg, rgb, 1, 1, 16, NULL, 96) == -EINVAL);
	CHECK(fragment_jpeg_create(&jpeg, rgb, 1, 1, UINT32_MAX - 15, NULL, 95) == 0);
	CHECK(fragment_jpeg_count(jpeg) == 1);
	fragment_jpeg_destroy(jpeg);
	fragment_jpeg_destroy(NULL);
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(is_the_plain_file_at_the_best_quality),
		cmocka_unit_test(changes_only_the_pixels_of_a_coarse_fragment),
		cmocka_unit_test(a_lower_quality_has_more_error_and_fewer_bytes),
		cmocka_unit_test(writes_again_from_the_best_quality),
		cmocka_unit_test(says_when_the_buffer_is_full),
		cmocka_unit_test(takes_the_hardest_contrasts),
		cmocka_unit_test(takes_every_size_around_a_fragment),
		cmocka_unit_test(unused_fragments_take_little),
		cmocka_unit_test(a_picture_without_used_fragments_is_grey),
		cmocka_unit_test(estimates_near_the_real_size),
		cmocka_unit_test(estimates_what_a_fragment_adds),
		cmocka_unit_test(never_estimates_fewer_bytes_at_a_higher_quality),
		cmocka_unit_test(refuses_sizes_that_it_cannot_take),
	};

	return cmocka_run_group_tests(tests, NULL, NULL);
}
