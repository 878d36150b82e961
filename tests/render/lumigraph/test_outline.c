/* The line around a part, found in masks of a known shape. */
#include <stdlib.h>
#include <string.h>

#include "render/display/headless.h"
#include "render/lumigraph/outline.h"
#include "tests/check.h"

/* No multiples of four, so that the blurred masks reach beyond the picture. */
enum { WIDTH = 322, HEIGHT = 243 };

struct rectangle {
	int x, y, width, height;
};

struct stage {
	struct headless *headless;
	struct gl_target picture;
	struct outline outline;
	uint8_t *rgba;
};

static void raise_stage(struct stage *stage)
{
	memset(stage, 0, sizeof(*stage));
	CHECK(headless_create(&stage->headless) == 0);
	CHECK(gl_target_create(&stage->picture, WIDTH, HEIGHT) == 0);
	CHECK(outline_init(&stage->outline) == 0);
	stage->rgba = malloc(4 * WIDTH * HEIGHT);
	CHECK(stage->rgba);
}

static void strike_stage(struct stage *stage)
{
	free(stage->rgba);
	outline_finish(&stage->outline);
	gl_target_destroy(&stage->picture);
	CHECK(gl_check("the test") == 0);
	headless_destroy(stage->headless);
}

static void fill(const struct rectangle *at, float shade)
{
	glScissor(at->x, at->y, at->width, at->height);
	glClearColor(shade, shade, shade, 1);
	glClear(GL_COLOR_BUFFER_BIT);
}

/* Draws the line around a part with openings over a black picture. */
static void draw(struct stage *stage, const struct rectangle *part,
		 const struct rectangle *openings, size_t count)
{
	struct outline *outline = &stage->outline;

	outline->low[0] = 2 * (float)part->x / WIDTH - 1;
	outline->low[1] = 2 * (float)part->y / HEIGHT - 1;
	outline->high[0] = 2 * (float)(part->x + part->width) / WIDTH - 1;
	outline->high[1] = 2 * (float)(part->y + part->height) / HEIGHT - 1;
	CHECK(outline_begin(outline, &stage->picture, WIDTH, HEIGHT) == 0);
	fill(part, 1);
	for (size_t i = 0; i < count; i++)
		fill(&openings[i], 0);
	outline_end(outline);

	gl_target_bind(&stage->picture);
	glClearColor(0, 0, 0, 1);
	glClear(GL_COLOR_BUFFER_BIT);
	const struct gl_place place = { .framebuffer = stage->picture.framebuffer };
	outline_draw(outline, &place, WIDTH, HEIGHT);
	CHECK(gl_target_read(&stage->picture, stage->rgba) == 0);
}

/* Returns how many pixels of a rectangle are the line's. Rows count from the bottom, as GL's. */
static int count_line(const struct stage *stage, const struct rectangle *at)
{
	int count = 0;

	for (int y = at->y; y < at->y + at->height; y++)
		for (int x = at->x; x < at->x + at->width; x++)
			count += stage->rgba[4 * ((HEIGHT - 1 - y) * WIDTH + x)] > 128;
	return count;
}

static const struct rectangle part = { 41, 30, 240, 181 };

static void the_line_is_even(void **state)
{
	struct stage stage;

	(void)state;
	raise_stage(&stage);
	/* wherever the border lies between the pixels of the smaller masks */
	for (int by = 0; by < 4; by++) {
		const struct rectangle here = { part.x + by, part.y + by, part.width, part.height };

		draw(&stage, &here, NULL, 0);
		for (int y = here.y + 20; y < here.y + here.height - 20; y++) {
			const int left = count_line(&stage, &(struct rectangle){ 0, y, 160, 1 });
			const int right =
				count_line(&stage, &(struct rectangle){ 160, y, WIDTH - 160, 1 });

			assert_in_range(left, 4, 6);
			assert_in_range(right, 4, 6);
		}
		for (int x = here.x + 20; x < here.x + here.width - 20; x++) {
			const int low = count_line(&stage, &(struct rectangle){ x, 0, 1, 120 });

			assert_in_range(low, 4, 6);
		}
	}
	strike_stage(&stage);
}

/* A line on both sides would fill it. */
static void narrow_openings_have_no_line(void **state)
{
	static const struct rectangle openings[] = {
		{ 90, 60, 9, 90 },   /* a slit */
		{ 130, 90, 12, 12 }, /* a hole */
		{ 200, 60, 10, 11 },
		{ 240, 171, 9, 40 }, /* a notch that opens upwards */
	};
	static const struct rectangle inside = { 55, 45, 212, 152 };
	static const struct rectangle mouth = { 230, 198, 30, 20 };
	struct stage stage;

	(void)state;
	raise_stage(&stage);
	draw(&stage, &part, openings, sizeof(openings) / sizeof(openings[0]));
	assert_int_equal(count_line(&stage, &inside), 0);
	/* The notch is closed: the line runs across it. */
	for (int x = mouth.x; x < mouth.x + mouth.width; x++) {
		const struct rectangle column = { x, mouth.y, 1, mouth.height };

		assert_in_range(count_line(&stage, &column), 3, 10);
	}
	strike_stage(&stage);
}

static void wide_openings_have_a_line(void **state)
{
	static const struct rectangle openings[] = { { 90, 60, 24, 90 }, { 160, 90, 30, 30 } };
	struct stage stage;

	(void)state;
	raise_stage(&stage);
	draw(&stage, &part, openings, 2);
	for (size_t i = 0; i < 2; i++) {
		const struct rectangle *o = &openings[i];
		const int middle = o->y + o->height / 2;
		const struct rectangle row = { o->x - 10, middle, o->width + 20, 1 };
		const struct rectangle within = { o->x + o->width / 2 - 4, middle, 8, 1 };

		assert_in_range(count_line(&stage, &row), 8, 12);
		assert_int_equal(count_line(&stage, &within), 0);
	}
	strike_stage(&stage);
}

/* A smaller part after a larger one. */
static void nothing_of_the_frame_before_stays(void **state)
{
	static const struct rectangle small = { 150, 100, 30, 30 };
	struct stage stage;

	(void)state;
	raise_stage(&stage);
	draw(&stage, &part, NULL, 0);
	draw(&stage, &small, NULL, 0);
	const struct rectangle all = { 0, 0, WIDTH, HEIGHT }, around = { 140, 90, 50, 50 };
	assert_int_equal(count_line(&stage, &all), count_line(&stage, &around));
	assert_true(count_line(&stage, &around) > 300);
	strike_stage(&stage);
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(the_line_is_even),
		cmocka_unit_test(narrow_openings_have_no_line),
		cmocka_unit_test(wide_openings_have_a_line),
		cmocka_unit_test(nothing_of_the_frame_before_stays),
	};

	return cmocka_run_group_tests(tests, NULL, NULL);
}
