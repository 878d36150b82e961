/* Polygons become triangles, also those of so many corners that looking for ears has no end. */
#include "pipeline/scene/soup.h"

#include <math.h>
#include <stdlib.h>

#include "tests/check.h"

/* Past this no ears are looked for. */
static const uint64_t many_steps = UINT64_C(1) << 40;

static const struct soup unmoved = {
	.place = { [0] = 1, [5] = 1, [10] = 1, [15] = 1 },
	.texture = SOUP_NO_TEXTURE,
};

/* Overlaps count twice. */
static double area_of(const struct soup *soup)
{
	double sum = 0;

	for (uint32_t i = 0; i < soup->count; i++) {
		const struct soup_corner *c = soup->triangles[i].corners;

		sum += fabs(((double)c[1].position[0] - c[0].position[0]) *
				    ((double)c[2].position[1] - c[0].position[1]) -
			    ((double)c[1].position[1] - c[0].position[1]) *
				    ((double)c[2].position[0] - c[0].position[0]));
	}
	return sum / 2;
}

/* A circle: cutting its corners one at a time moved all others each time, for hours. */
static void cuts_a_polygon_of_a_million_corners(void **state)
{
	enum { CORNERS = 1000000 };
	struct soup_corner *corners = calloc(CORNERS, sizeof(*corners));
	struct soup soup = unmoved;

	(void)state;
	CHECK(corners);
	for (int i = 0; i < CORNERS; i++) {
		corners[i].position[0] = (float)cos(i * 2 * M_PI / CORNERS);
		corners[i].position[1] = (float)sin(i * 2 * M_PI / CORNERS);
	}
	soup.polygon_steps = many_steps;
	CHECK(soup_add(&soup, corners, CORNERS) == 0);
	CHECK(soup.count == CORNERS - 2);
	CHECK(fabs(area_of(&soup) - M_PI) < 1e-4);
	soup_finish(&soup);
	free(corners);
}

/* A dart whose first corner is no ear: its ears have its area, and the fan overlaps itself. */
static void looks_for_ears_while_there_is_time(void **state)
{
	static const float dart[4][2] = { { 4, 2 }, { 0, 4 }, { 1, 2 }, { 0, 0 } };
	struct soup_corner corners[4] = { 0 };
	struct soup soup = unmoved;

	(void)state;
	for (int i = 0; i < 4; i++)
		for (int k = 0; k < 2; k++)
			corners[i].position[k] = dart[i][k];
	CHECK(soup_add(&soup, corners, 4) == 0);
	CHECK(soup.count == 2 && fabs(area_of(&soup) - 6) < 1e-6);
	soup.count = 0;
	soup.polygon_steps = many_steps;
	CHECK(soup_add(&soup, corners, 4) == 0);
	CHECK(soup.count == 2 && fabs(area_of(&soup) - 10) < 1e-6);
	soup_finish(&soup);
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(cuts_a_polygon_of_a_million_corners),
		cmocka_unit_test(looks_for_ears_while_there_is_time),
	};

	return cmocka_run_group_tests(tests, NULL, NULL);
}
