#include "ui/safe_page.h"

#include <stdlib.h>
#include <string.h>

#include "tests/check.h"
#include "ui/bitmap.h"
#include "ui/translate.h"

static void draw(struct bitmap *bitmap, const struct safe_page *page, int64_t time_ms)
{
	cairo_t *context = bitmap_begin(bitmap);

	safe_page_draw(page, context, time_ms);
	bitmap_end(bitmap, context);
}

/* Pixels that differ by more than a shade. */
static int differences(const struct bitmap *a, const struct bitmap *b)
{
	int count = 0;

	for (int y = 0; y < a->height_px; y++)
		for (int x = 0; x < a->width_px * 4; x += 4) {
			const unsigned char *left = a->pixels + y * a->stride_bytes + x;
			const unsigned char *right = b->pixels + y * b->stride_bytes + x;

			count += abs(left[0] - right[0]) + abs(left[1] - right[1]) +
					 abs(left[2] - right[2]) >
				 24;
		}
	return count;
}

static bool frame_is_night(const struct bitmap *bitmap)
{
	const unsigned char *first = bitmap->pixels;

	for (int x = 0; x < bitmap->width_px; x++)
		if (memcmp(first, bitmap->pixels + x * 4, 4) != 0 ||
		    memcmp(first,
			   bitmap->pixels + (bitmap->height_px - 1) * bitmap->stride_bytes + x * 4,
			   4) != 0)
			return false;
	for (int y = 0; y < bitmap->height_px; y++) {
		const unsigned char *row = bitmap->pixels + y * bitmap->stride_bytes;

		if (memcmp(first, row, 4) != 0 ||
		    memcmp(first, row + (bitmap->width_px - 1) * 4, 4) != 0)
			return false;
	}
	return true;
}

static const struct {
	int width_px, height_px;
} panels[] = { { 1280, 720 }, { 720, 1280 }, { 800, 800 }, { 1024, 768 }, { 320, 240 } };

static void moves_all_the_time(void **state)
{
	struct bitmap before, after;
	struct safe_page page;

	(void)state;
	CHECK(bitmap_init(&before, 1280, 720) == 0 && bitmap_init(&after, 1280, 720) == 0);
	CHECK(safe_page_init(&page, 1280, 720) == 0);
	for (int64_t time_ms = 0; time_ms < 60000; time_ms += 3000) {
		draw(&before, &page, time_ms);
		draw(&after, &page, time_ms + 3000);
		CHECK(differences(&before, &after) > 1280 * 720 / 500);
	}
	safe_page_finish(&page);
	bitmap_finish(&before);
	bitmap_finish(&after);
}

/* Whatever drifts stays on the panel, whatever its shape. */
static void nothing_reaches_the_edge(void **state)
{
	(void)state;
	for (size_t i = 0; i < ARRAY_COUNT(panels); i++) {
		struct safe_page page;
		struct bitmap bitmap;

		CHECK(bitmap_init(&bitmap, panels[i].width_px, panels[i].height_px) == 0);
		CHECK(safe_page_init(&page, panels[i].width_px, panels[i].height_px) == 0);
		for (int64_t time_ms = 0; time_ms < 400000; time_ms += 23000) {
			draw(&bitmap, &page, time_ms);
			if (!frame_is_night(&bitmap))
				fail_msg("%d x %d at %lld ms", panels[i].width_px,
					 panels[i].height_px, (long long)time_ms);
		}
		safe_page_finish(&page);
		bitmap_finish(&bitmap);
	}
}

static void every_language_has_its_letters(void **state)
{
	struct safe_page page;

	(void)state;
	CHECK(safe_page_init(&page, 1280, 720) == 0);
	CHECK(page.line_count == SAFE_PAGE_LINES_MAX);
	safe_page_finish(&page);
}

/* As where all fonts are gone. */
static void draws_its_tower_without_words(void **state)
{
	struct bitmap bitmap, empty;
	struct safe_page page;

	(void)state;
	CHECK(bitmap_init(&bitmap, 320, 240) == 0 && bitmap_init(&empty, 320, 240) == 0);
	CHECK(safe_page_init(&page, 320, 240) == 0);
	while (page.line_count > 0)
		g_object_unref(page.lines[--page.line_count].layout);
	page.text_width_px = page.text_height_px = 0;
	draw(&bitmap, &page, 5000);
	CHECK(differences(&bitmap, &empty) > 320 * 240 / 20);
	safe_page_finish(&page);
	bitmap_finish(&bitmap);
	bitmap_finish(&empty);
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(moves_all_the_time),
		cmocka_unit_test(nothing_reaches_the_edge),
		cmocka_unit_test(every_language_has_its_letters),
		cmocka_unit_test(draws_its_tower_without_words),
	};

	if (translate_open(TEST_LOCALE) < 0)
		return 1;
	return cmocka_run_group_tests(tests, NULL, NULL);
}
