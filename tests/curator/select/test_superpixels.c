#include "curator/select/superpixels.h"

#include <math.h>

#include "tests/check.h"
#include "tests/curator/select/little_view.h"

/* Of how many superpixels lie on both sides of the square's border, and how many there are. */
static void check_borders(struct view_image *image)
{
	struct superpixels made;
	uint32_t *inside, both = 0, shown = 0, total = 0;

	CHECK(superpixels_make(&made, image) == 0);
	inside = calloc(made.count, sizeof(*inside));
	for (uint32_t at = 0; at < LITTLE_PIXELS; at++) {
		const uint32_t its = made.of_pixel[at];

		CHECK((its == SUPERPIXEL_NONE) == (image->inverse_m[at] <= 0));
		if (its == SUPERPIXEL_NONE)
			continue;
		CHECK(its < made.count);
		shown++;
		inside[its] += little_in_square(at % LITTLE_WIDTH, at / LITTLE_WIDTH);
	}
	for (uint32_t n = 0; n < made.count; n++) {
		const uint32_t most = made.all[n].pixel_count;

		CHECK(most > 0);
		total += most;
		/* a pixel or two along a side may belong to the other */
		both += inside[n] > most / 4 && inside[n] < most - most / 4;
	}
	CHECK(total == shown);
	CHECK(made.count > 150 && made.count < 400); /* a marker in each 8 x 8 pixels */
	CHECK(both < 4);
	for (uint32_t n = 0; n < made.border_count; n++) {
		const struct superpixel_border *border = &made.borders[n];
		const float cost = superpixel_border_cost(&made, border);

		CHECK(border->a < border->b && border->b < made.count && border->length_px > 0);
		CHECK(cost > 0 && cost <= 1);
		/* expensive within the wall, cheap where the square ends */
		const bool a_in = 2 * inside[border->a] > made.all[border->a].pixel_count,
			   b_in = 2 * inside[border->b] > made.all[border->b].pixel_count;
		if (a_in != b_in)
			CHECK(cost < 0.6f);
		else if (inside[border->a] == 0 && inside[border->b] == 0)
			CHECK(cost > 0.8f);
	}
	free(inside);
	superpixels_finish(&made);
}

static void they_end_where_depth_colour_or_surface_change(void **state)
{
	(void)state;
	for (int what = 0; what < 3; what++) {
		struct view_image image = little_view(what == 0 ? 1 : 0, what == 1, what == 2);

		check_borders(&image);
		little_view_finish(&image);
	}
}

static void what_stands_alone_has_its_own(void **state)
{
	struct view_image image = little_view(0, false, false);
	struct superpixels made;

	(void)state;
	memset(image.inverse_m, 0, LITTLE_PIXELS * sizeof(*image.inverse_m));
	image.inverse_m[0] = 1; /* a corner that no marker is in */
	image.inverse_m[LITTLE_PIXELS - 1] = 1;
	CHECK(superpixels_make(&made, &image) == 0);
	CHECK(made.count == 2 && made.border_count == 0);
	CHECK(made.of_pixel[0] != made.of_pixel[LITTLE_PIXELS - 1]);
	superpixels_finish(&made);
	image.inverse_m[0] = image.inverse_m[LITTLE_PIXELS - 1] = 0;
	CHECK(superpixels_make(&made, &image) == 0);
	CHECK(made.count == 0);
	superpixels_finish(&made);
	little_view_finish(&image);
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(they_end_where_depth_colour_or_surface_change),
		cmocka_unit_test(what_stands_alone_has_its_own),
	};

	return cmocka_run_group_tests(tests, NULL, NULL);
}
