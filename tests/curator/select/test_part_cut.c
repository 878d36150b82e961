#include "curator/select/part_cut.h"

#include <errno.h>
#include <math.h>

#include "base/compiler.h"
#include "tests/check.h"
#include "tests/curator/select/little_view.h"

/* Pixels on the wrong side of the square's border. */
static uint32_t wrong_pixels(const uint8_t *in_part)
{
	uint32_t count = 0;

	for (uint32_t at = 0; at < LITTLE_PIXELS; at++)
		count += in_part[at] != little_in_square(at % LITTLE_WIDTH, at / LITTLE_WIDTH);
	return count;
}

static uint32_t cut(struct view_image *image, uint8_t *marks)
{
	struct superpixels superpixels;
	uint8_t in_part[LITTLE_PIXELS];

	CHECK(superpixels_make(&superpixels, image) == 0);
	CHECK(part_cut(in_part, marks, image, &superpixels) == 0);
	superpixels_finish(&superpixels);
	return wrong_pixels(in_part);
}

/* A loop that is nowhere on the border, on one side of it or the other by up to seven pixels. */
static void a_careless_heavy_lasso_finds_the_border(void **state)
{
	static const float loop[][2] = { { 44, 46 }, { 56, 37 },  { 75, 45 }, { 96, 34 },
					 { 94, 60 }, { 106, 84 }, { 93, 93 }, { 70, 85 },
					 { 47, 96 }, { 55, 70 } };
	const struct stroke stroke = { loop, ARRAY_COUNT(loop), 18 };
	uint8_t marks[LITTLE_PIXELS];

	(void)state;
	for (int what = 0; what < 3; what++) {
		struct view_image image = little_view(what == 0 ? 1 : 0, what == 1, what == 2);

		CHECK(strokes_heavy_lasso(marks, LITTLE_WIDTH, LITTLE_HEIGHT, &stroke) == 0);
		const uint32_t wrong = cut(&image, marks);
		print_message("%s: %u pixels of %d are wrong\n",
			      what == 0   ? "depth"
			      : what == 1 ? "colour"
					  : "surface",
			      wrong, SQUARE_SIDE * SQUARE_SIDE);
		CHECK(wrong < SQUARE_SIDE * SQUARE_SIDE / 50);
		little_view_finish(&image);
	}
}

static void a_stroke_on_each_side_is_enough(void **state)
{
	static const float in[][2] = { { 60, 60 }, { 90, 70 } },
			   out[][2] = { { 20, 30 }, { 20, 100 }, { 140, 100 } };
	const struct stroke part = { in, 2, 3 }, rest = { out, 3, 3 };
	struct view_image image = little_view(1, false, false);
	uint8_t marks[LITTLE_PIXELS] = { 0 };

	(void)state;
	strokes_paint(marks, LITTLE_WIDTH, LITTLE_HEIGHT, &part, MARK_PART_SEED);
	strokes_paint(marks, LITTLE_WIDTH, LITTLE_HEIGHT, &rest, MARK_REST_SEED);
	CHECK(cut(&image, marks) < SQUARE_SIDE * SQUARE_SIDE / 50);
	little_view_finish(&image);
}

/* What a stroke says stays, whatever the picture looks like. */
static void strokes_are_obeyed(void **state)
{
	static const float in[][2] = { { 60, 60 }, { 140, 60 } },
			   out[][2] = { { 70, 80 }, { 80, 80 } };
	const struct stroke part = { in, 2, 5 }, rest = { out, 2, 5 };
	struct view_image image = little_view(1, true, true);
	struct superpixels superpixels;
	uint8_t marks[LITTLE_PIXELS] = { 0 };

	(void)state;
	strokes_paint(marks, LITTLE_WIDTH, LITTLE_HEIGHT, &part, MARK_PART_SEED);
	strokes_paint(marks, LITTLE_WIDTH, LITTLE_HEIGHT, &rest, MARK_REST_SEED);
	CHECK(superpixels_make(&superpixels, &image) == 0);
	CHECK(part_cut(marks, marks, &image, &superpixels) == 0); /* in place */
	CHECK(marks[60 * LITTLE_WIDTH + 139] == 1 && marks[60 * LITTLE_WIDTH + 61] == 1);
	CHECK(marks[80 * LITTLE_WIDTH + 75] == 0);
	CHECK(marks[2 * LITTLE_WIDTH + 75] == 0); /* the sky is never in a part */
	superpixels_finish(&superpixels);
	little_view_finish(&image);
}

static void without_the_part_there_is_nothing_to_find(void **state)
{
	static const float sky[][2] = { { 20, 3 }, { 140, 3 } };
	const struct stroke part = { sky, 2, 3 };
	struct view_image image = little_view(1, false, false);
	struct superpixels superpixels;
	uint8_t marks[LITTLE_PIXELS] = { 0 };

	(void)state;
	CHECK(superpixels_make(&superpixels, &image) == 0);
	CHECK(part_cut(marks, marks, &image, &superpixels) == -EINVAL);
	strokes_paint(marks, LITTLE_WIDTH, LITTLE_HEIGHT, &part, MARK_PART_SEED);
	CHECK(part_cut(marks, marks, &image, &superpixels) == -EINVAL);
	superpixels_finish(&superpixels);
	little_view_finish(&image);
}

/* Without a stroke for the rest, all that hangs together with the part is the part. */
static void only_the_part_is_known(void **state)
{
	struct view_image image = little_view(1, false, false);
	struct superpixels superpixels;
	uint8_t marks[LITTLE_PIXELS] = { 0 };

	(void)state;
	marks[60 * LITTLE_WIDTH + 70] = MARK_PART_SEED;
	CHECK(superpixels_make(&superpixels, &image) == 0);
	CHECK(part_cut(marks, marks, &image, &superpixels) == 0);
	CHECK(marks[60 * LITTLE_WIDTH + 70] == 1 && marks[80 * LITTLE_WIDTH + 90] == 1);
	superpixels_finish(&superpixels);
	little_view_finish(&image);
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(a_careless_heavy_lasso_finds_the_border),
		cmocka_unit_test(a_stroke_on_each_side_is_enough),
		cmocka_unit_test(strokes_are_obeyed),
		cmocka_unit_test(without_the_part_there_is_nothing_to_find),
		cmocka_unit_test(only_the_part_is_known),
	};

	return cmocka_run_group_tests(tests, NULL, NULL);
}
