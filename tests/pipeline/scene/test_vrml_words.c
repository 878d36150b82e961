/* Points, lines and texts of a scene as triangles. */
#include <errno.h>
#include <math.h>
#include <stdio.h>
#include <string.h>

#include "geometry/vec.h"
#include "pipeline/scene/vrml_surface.h"
#include "tests/check.h"

#define HEAD "#VRML V2.0 utf8\n"

static int make(struct vrml_surface *out, const char *text, struct diagnostics *diagnostics)
{
	const struct bytes bytes = { (const uint8_t *)text, strlen(text) };
	const struct vrml_options options = { 0 };
	struct diagnostics warnings = { 0 };
	struct vrml *scene;
	int rc;

	CHECK(vrml_read(&scene, bytes, "a.wrl", &options, diagnostics, &warnings) == 0);
	rc = vrml_surface_make(out, scene, diagnostics);
	vrml_destroy(scene);
	return rc;
}

struct extent {
	float low[3], high[3], area; /* area: of the triangles seen from +z */
};

static struct extent measure(const char *text)
{
	struct extent out = { { INFINITY, INFINITY, INFINITY },
			      { -INFINITY, -INFINITY, -INFINITY },
			      0 };
	struct diagnostics diagnostics = { 0 };
	struct vrml_surface surface;

	if (make(&surface, text, &diagnostics) != 0)
		fail_msg("%s", diagnostics.first.text);
	for (uint32_t i = 0; i < surface.soup.count; i++) {
		const struct soup_corner *c = surface.soup.triangles[i].corners;

		for (int corner = 0; corner < 3; corner++)
			for (int k = 0; k < 3; k++) {
				out.low[k] = fminf(out.low[k], c[corner].position[k]);
				out.high[k] = fmaxf(out.high[k], c[corner].position[k]);
			}
		out.area += ((c[1].position[0] - c[0].position[0]) *
				     (c[2].position[1] - c[0].position[1]) -
			     (c[2].position[0] - c[0].position[0]) *
				     (c[1].position[1] - c[0].position[1])) /
			    2;
	}
	vrml_surface_finish(&surface);
	return out;
}

/* The volume that the surface encloses is positive: its faces look outwards. */
static float volume_of(const struct vrml_surface *surface)
{
	float sum = 0;

	for (uint32_t i = 0; i < surface->soup.count; i++) {
		const struct soup_corner *c = surface->soup.triangles[i].corners;
		float cross[3];

		vec_cross(cross, c[1].position, c[2].position);
		sum += vec_dot(c[0].position, cross) / 6;
	}
	return sum;
}

static void points_are_octahedra(void **state)
{
	struct diagnostics diagnostics = { 0 };
	struct vrml_surface surface;
	const float half = 0.004f * 5;

	(void)state;
	CHECK(make(&surface,
		   HEAD "Shape { geometry PointSet {\n"
			"  coord Coordinate { point [ 0 0 0, 3 4 0 ] }\n"
			"  color Color { color [ 1 0 0, 0 0 1 ] } } }",
		   &diagnostics) == 0);
	CHECK(surface.soup.count == 16);
	CHECK(surface.soup.triangles[0].corners[0].rgb[0] == 255);
	CHECK(surface.soup.triangles[15].corners[0].rgb[2] == 255);
	CHECK(fabsf(volume_of(&surface) / (2 * 4 * half * half * half / 3) - 1) < 1e-3f);
	vrml_surface_finish(&surface);
}

static void lines_are_bars_with_their_colours(void **state)
{
	struct diagnostics diagnostics = { 0 };
	struct vrml_surface surface;

	(void)state;
	CHECK(make(&surface,
		   HEAD "Shape { geometry IndexedLineSet {\n"
			"  coord Coordinate { point [ 0 0 0, 3 0 0, 3 4 0 ] }\n"
			"  coordIndex [ 0 1 2 -1 2 0 ] colorPerVertex FALSE\n"
			"  color Color { color [ 1 0 0, 0 1 0 ] } } }",
		   &diagnostics) == 0);
	CHECK(surface.soup.count == 3 * 6);
	CHECK(surface.soup.triangles[11].corners[0].rgb[0] == 255);
	CHECK(surface.soup.triangles[12].corners[0].rgb[1] == 255);
	/* Bars of 3, 4 and 5 m; the area of a triangle in a circle of 0.01 m. The open ends of a
	 * bar through the origin enclose nothing with it, those of the others little. */
	CHECK(volume_of(&surface) > 0);
	vrml_surface_finish(&surface);
	CHECK(make(&surface,
		   HEAD "\nShape { geometry IndexedLineSet {\n"
			"  coord Coordinate { point [ 0 0 0, 1 0 0 ] } coordIndex [ 0 2 ] } }",
		   &diagnostics) == -EBADMSG);
	CHECK(strstr(diagnostics.first.text, "a.wrl:3: coordIndex names point 2, and there are 2"));
}

#define TEXT(fields, style)                                                                        \
	HEAD "Shape { geometry Text { " fields " fontStyle FontStyle { " style " } } }"

static void letters_have_the_size_and_the_place_that_the_style_says(void **state)
{
	const struct extent one = measure(TEXT("string \"HI\"", "size 2 family \"SANS\""));
	const struct extent two = measure(TEXT("string [ \"HI\" \"HI\" ]", "size 2 family \"SANS\" "
									   "spacing 1.5"));
	const struct extent middle =
		measure(TEXT("string \"HI\"", "size 2 family \"SANS\" justify \"MIDDLE\""));
	const struct extent end =
		measure(TEXT("string \"HI\"", "size 2 family \"SANS\" justify \"END\""));
	const struct extent wide = measure(TEXT("string \"HI\" length 10", "size 2"));
	const struct extent small = measure(TEXT("string \"HIHIHI\" maxExtent 1", "size 2"));

	(void)state;
	/* Capitals stand on the baseline and are some 0.7 of the size tall; all faces +z. */
	CHECK(fabsf(one.low[1]) < 0.05f && one.high[1] > 1.2f && one.high[1] < 1.7f);
	CHECK(one.low[0] >= 0 && one.low[0] < 0.5f && one.high[0] > 1 && one.high[0] < 3);
	CHECK(one.low[2] == 0 && one.high[2] == 0 && one.area > 0.5f);
	/* The second line is 2 * 1.5 below the first. */
	CHECK(fabsf(two.low[1] - one.low[1] + 3) < 1e-3f && two.high[1] == one.high[1]);
	CHECK(fabsf(two.area / one.area - 2) < 1e-3f);
	CHECK(fabsf(middle.low[0] + middle.high[0]) < 0.2f && end.high[0] <= 0.01f);
	CHECK(wide.high[0] > 8 && wide.high[0] <= 10 && small.high[0] <= 1);
}

/* An O has a hole: it covers less than a filled one, and what it goes around is open. */
static void letters_have_their_holes(void **state)
{
	const struct extent o = measure(TEXT("string \"O\"", "size 1 family \"SANS\""));
	const float box = (o.high[0] - o.low[0]) * (o.high[1] - o.low[1]);

	(void)state;
	CHECK(o.area > 0.15f * box && o.area < 0.55f * box);
}

static void what_is_no_text_is_named(void **state)
{
	static const struct {
		const char *text, *words;
	} cases[] = {
		{ TEXT("string \"\xff\"", ""), "a.wrl:2: Text has a string that is not UTF-8" },
		{ TEXT("string \"a\"", "size -1"), "a.wrl:2: Text has a size that is not above 0" },
	};

	(void)state;
	for (size_t i = 0; i < ARRAY_COUNT(cases); i++) {
		struct diagnostics diagnostics = { 0 };
		struct vrml_surface surface;

		CHECK(make(&surface, cases[i].text, &diagnostics) == -EBADMSG);
		if (!strstr(diagnostics.first.text, cases[i].words))
			fail_msg("case %zu: %s", i, diagnostics.first.text);
	}
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(points_are_octahedra),
		cmocka_unit_test(lines_are_bars_with_their_colours),
		cmocka_unit_test(letters_have_the_size_and_the_place_that_the_style_says),
		cmocka_unit_test(letters_have_their_holes),
		cmocka_unit_test(what_is_no_text_is_named),
	};

	return cmocka_run_group_tests(tests, NULL, NULL);
}
