#include "ui/notice.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "tests/check.h"

enum { MOST = 32 };

static struct notice_item items[MOST];

static struct notice notice_of(uint32_t count, uint32_t dropped)
{
	for (uint32_t i = 0; i < MOST; i++)
		items[i] = (struct notice_item){
			.mark = "line 12",
			.text = "hours must be days and times such as Mo-Fr 09:00-18:00, Sa "
				"10:00-17:00, not 'nine to five'",
		};
	return (struct notice){
		.title = "gopura.conf has faults",
		.lead = "/efi/gopura.conf",
		.items = items,
		.count = count,
		.dropped = dropped,
		.foot = "Correct the file, then switch the terminal off and on.",
	};
}

/* The rows and columns that differ from bare paper, without the bar at the left. */
static void ink(const struct bitmap *bitmap, int *top, int *bottom, int *right)
{
	const int from = bitmap->width_px / 2;
	uint32_t paper;

	memcpy(&paper, bitmap->pixels + 4 * (size_t)(bitmap->width_px - 1), 4);
	*top = bitmap->height_px;
	*bottom = *right = -1;
	for (int y = 0; y < bitmap->height_px; y++)
		for (int x = from / 4; x < bitmap->width_px; x++) {
			uint32_t pixel;

			memcpy(&pixel,
			       bitmap->pixels + (size_t)y * (size_t)bitmap->stride_bytes +
				       4 * (size_t)x,
			       4);
			if (pixel == paper)
				continue;
			*top = y < *top ? y : *top;
			*bottom = y > *bottom ? y : *bottom;
			*right = x > *right ? x : *right;
		}
}

static void everything_stands_on_the_page_whatever_its_size(void **state)
{
	static const int sizes[][2] = { { 640, 360 },   { 360, 640 },   { 1280, 800 },
					{ 1920, 1080 }, { 1080, 1920 }, { 3840, 2160 } };

	(void)state;
	for (size_t i = 0; i < ARRAY_COUNT(sizes); i++)
		for (uint32_t count = 1; count <= MOST; count = count * 2 + 1) {
			struct notice notice = notice_of(count, 0);
			struct bitmap bitmap;
			uint32_t shown;
			int top, bottom, right;

			CHECK(notice_draw(&bitmap, &notice, 0, sizes[i][0], sizes[i][1], &shown) ==
			      0);
			ink(&bitmap, &top, &bottom, &right);
			CHECK(shown >= 1 && shown <= count);
			CHECK(top > 0 && bottom > top && bottom < sizes[i][1] - 1);
			CHECK(right < sizes[i][0] - 1);
			bitmap_finish(&bitmap);
		}
}

static void a_large_panel_shows_a_long_list_and_a_small_one_what_fits(void **state)
{
	struct notice notice = notice_of(15, 0);
	struct bitmap bitmap;
	uint32_t shown;

	(void)state;
	CHECK(notice_draw(&bitmap, &notice, 0, 1920, 1080, &shown) == 0 && shown == 15);
	bitmap_finish(&bitmap);
	CHECK(notice_draw(&bitmap, &notice, 0, 640, 360, &shown) == 0 && shown < 15);
	bitmap_finish(&bitmap);
}

static void few_faults_are_written_larger_than_many(void **state)
{
	struct bitmap bitmap[2];
	int height[2];

	(void)state;
	for (int i = 0; i < 2; i++) {
		struct notice notice = notice_of(i == 0 ? 1 : 12, 0);
		int top, bottom, right;

		CHECK(notice_draw(&bitmap[i], &notice, 0, 1280, 800, NULL) == 0);
		ink(&bitmap[i], &top, &bottom, &right);
		/* The title: rows from the first ink to the first bare row. */
		for (height[i] = 0; top + height[i] < bottom; height[i]++) {
			const unsigned char *row =
				bitmap[i].pixels +
				(size_t)(top + height[i]) * (size_t)bitmap[i].stride_bytes;
			bool bare = true;

			for (int x = 160; x < 1280; x++)
				bare = bare && memcmp(row + 4 * x, row + 4 * 1279, 4) == 0;
			if (bare)
				break;
		}
		bitmap_finish(&bitmap[i]);
	}
	if (height[0] <= height[1] || height[1] <= 5)
		fail_msg("titles of %d and %d pixels", height[0], height[1]);
}

/* 55 inches at 1920 x 1080 have 1.6 pixels a millimetre. */
static void letters_have_enough_pixels_where_those_are_large(void **state)
{
	struct notice notice = notice_of(20, 0);
	struct bitmap coarse, guessed;

	(void)state;
	CHECK(notice_draw(&coarse, &notice, 1.6f, 1920, 1080, NULL) == 0);
	CHECK(notice_draw(&guessed, &notice, 0, 1920, 1080, NULL) == 0);
	CHECK(memcmp(coarse.pixels, guessed.pixels, (size_t)coarse.stride_bytes * 1080) == 0);
	bitmap_finish(&coarse);
	CHECK(notice_draw(&coarse, &notice, 8, 1920, 1080, NULL) == 0);
	CHECK(memcmp(coarse.pixels, guessed.pixels, (size_t)coarse.stride_bytes * 1080) != 0);
	bitmap_finish(&coarse);
	bitmap_finish(&guessed);
}

static void refuses_sizes_that_are_none(void **state)
{
	struct notice notice = notice_of(1, 0);
	struct bitmap bitmap;

	(void)state;
	CHECK(notice_draw(&bitmap, &notice, 0, 0, 100, NULL) == -22);
	CHECK(bitmap.surface == NULL);
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(everything_stands_on_the_page_whatever_its_size),
		cmocka_unit_test(a_large_panel_shows_a_long_list_and_a_small_one_what_fits),
		cmocka_unit_test(few_faults_are_written_larger_than_many),
		cmocka_unit_test(letters_have_enough_pixels_where_those_are_large),
		cmocka_unit_test(refuses_sizes_that_are_none),
	};

	return cmocka_run_group_tests(tests, NULL, NULL);
}
