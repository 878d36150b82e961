/* NURBS of VRML97's amendment: spheres and cylinders are exact, nothing is open between neighbours,
 * trimmed surfaces have the area that is left. */
#include "geometry/nurbs.h"

#include <errno.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "pipeline/scene/vrml_surface.h"
#include "tests/check.h"

#define HEAD "#VRML V2.0 utf8\n"
#define S    0.70710678118654752

/* The circle of 9 points, which is exact. */
static const double circle[9][3] = { { 1, 0, 1 },  { 1, 1, S },  { 0, 1, 1 },
				     { -1, 1, S }, { -1, 0, 1 }, { -1, -1, S },
				     { 0, -1, 1 }, { 1, -1, S }, { 1, 0, 1 } };
#define CIRCLE_KNOTS "0 0 0 .25 .25 .5 .5 .75 .75 1 1 1"

static void append(char *text, size_t size, const char *format, ...) printf_like(3, 4);

static void append(char *text, size_t size, const char *format, ...)
{
	const size_t used = strlen(text);
	va_list args;

	va_start(args, format);
	CHECK(vsnprintf(text + used, size - used, format, args) < (int)(size - used));
	va_end(args);
}

/* Turns a profile of radius, height and weight about the y axis. */
static void append_turned(char *text, size_t size, const double profile[][3], int count,
			  const char *knots, int order)
{
	append(text, size,
	       "Shape { geometry NurbsSurface { uDimension 9 vDimension %d uOrder 3 vOrder %d "
	       "uKnot [ " CIRCLE_KNOTS " ] vKnot [ %s ] controlPoint [",
	       count, order, knots);
	for (int j = 0; j < count; j++)
		for (int i = 0; i < 9; i++)
			append(text, size, " %.9g %.9g %.9g,", profile[j][0] * circle[i][0],
			       profile[j][1], -profile[j][0] * circle[i][1]);
	append(text, size, " ] weight [");
	for (int j = 0; j < count; j++)
		for (int i = 0; i < 9; i++)
			append(text, size, " %.9g", profile[j][2] * circle[i][2]);
	append(text, size, " ] } }\n");
}

static int make(struct vrml_surface *out, const char *text, struct diagnostics *diagnostics)
{
	const struct bytes bytes = { (const uint8_t *)text, strlen(text) };
	const struct vrml_options options = { 0 };
	struct diagnostics warnings = { 0 };
	struct vrml *scene;
	int rc = vrml_read(&scene, bytes, "a.wrl", &options, diagnostics, &warnings);

	*out = (struct vrml_surface){ 0 };
	if (rc == 0)
		rc = vrml_surface_make(out, scene, diagnostics);
	vrml_destroy(scene);
	return rc;
}

static struct vrml_surface made(const char *text)
{
	struct diagnostics diagnostics = { 0 };
	struct vrml_surface surface;

	if (make(&surface, text, &diagnostics) < 0)
		fail_msg("%s", diagnostics.first.text);
	return surface;
}

struct edge {
	float low[3], high[3];
};

static int compare_edges(const void *a, const void *b)
{
	return memcmp(a, b, sizeof(struct edge));
}

/* Returns the length of all edges that not just two triangles have, at exactly the same place. */
static double open_length(const struct soup *soup)
{
	const size_t count = (size_t)soup->count * 3;
	struct edge *edges = calloc(count, sizeof(*edges));
	double length = 0;

	CHECK(edges != NULL);
	for (size_t i = 0; i < count; i++) {
		const struct soup_corner *c = soup->triangles[i / 3].corners;
		float p[2][3];

		for (int end = 0; end < 2; end++)
			for (int k = 0; k < 3; k++) /* there is no -0 */
				p[end][k] = c[(i + (size_t)end) % 3].position[k] + 0.0f;
		const bool turned = memcmp(p[0], p[1], sizeof(p[0])) > 0;

		memcpy(edges[i].low, p[turned], sizeof(p[0]));
		memcpy(edges[i].high, p[!turned], sizeof(p[0]));
	}
	qsort(edges, count, sizeof(*edges), compare_edges);
	for (size_t i = 0, end; i < count; i = end) {
		double sum = 0;

		for (end = i; end < count && compare_edges(&edges[i], &edges[end]) == 0; end++)
			continue;
		for (int k = 0; k < 3; k++)
			sum += pow((double)(edges[i].high[k] - edges[i].low[k]), 2);
		length += end - i == 2 ? 0 : sqrt(sum);
	}
	free(edges);
	return length;
}

static double volume_and_area(const struct soup *soup, double *area)
{
	double volume = 0;

	*area = 0;
	for (uint32_t i = 0; i < soup->count; i++) {
		const struct soup_corner *c = soup->triangles[i].corners;
		double u[3], v[3], cross[3];

		for (int k = 0; k < 3; k++) {
			u[k] = (double)(c[1].position[k] - c[0].position[k]);
			v[k] = (double)(c[2].position[k] - c[0].position[k]);
		}
		for (int k = 0; k < 3; k++)
			cross[k] =
				u[(k + 1) % 3] * v[(k + 2) % 3] - u[(k + 2) % 3] * v[(k + 1) % 3];
		for (int k = 0; k < 3; k++)
			volume += (double)c[0].position[k] * cross[k] / 6;
		*area += sqrt(cross[0] * cross[0] + cross[1] * cross[1] + cross[2] * cross[2]) / 2;
	}
	return volume;
}

static const double half_circle[5][3] = {
	{ 0, -1, 1 }, { 1, -1, S }, { 1, 0, 1 }, { 1, 1, S }, { 0, 1, 1 }
};

static void a_sphere_is_exact_and_closed(void **state)
{
	char text[8192] = HEAD;
	struct vrml_surface surface;
	double worst = 0, volume, area;
	(void)state;

	append_turned(text, sizeof(text), half_circle, 5, "0 0 0 .5 .5 1 1 1", 3);
	surface = made(text);
	for (uint32_t i = 0; i < surface.soup.count; i++)
		for (int v = 0; v < 3; v++) {
			const float *p = surface.soup.triangles[i].corners[v].position;

			worst = fmax(
				worst,
				fabs(sqrt((double)(p[0] * p[0] + p[1] * p[1] + p[2] * p[2])) - 1));
		}
	volume = volume_and_area(&surface.soup, &area);
	print_message("sphere: %u triangles, radius off by %.1e, volume %.4f, open %.4f\n",
		      surface.soup.count, worst, volume, open_length(&surface.soup));
	CHECK(worst < 1e-6);
	CHECK(fabs(volume / (4 / 3.0 * M_PI) - 1) < 0.01);
	CHECK(open_length(&surface.soup) == 0);
	CHECK(surface.soup.count < 20000);
	vrml_surface_finish(&surface);
}

/* A cylinder of two surfaces, a dome on top, and a cone below: they share circles. */
static void neighbours_meet_without_a_crack(void **state)
{
	static const double low[2][3] = { { 1, -2, 1 }, { 1, -1, 1 } };
	static const double high[2][3] = { { 1, -1, 1 }, { 1, 0, 1 } };
	static const double dome[3][3] = { { 1, 0, 1 }, { 1, 1, S }, { 0, 1, 1 } };
	static const double cone[2][3] = { { 0, -4, 1 }, { 1, -2, 1 } };
	char text[16384] = HEAD;
	struct vrml_surface surface;
	double volume, area;
	(void)state;

	append_turned(text, sizeof(text), low, 2, "0 0 1 1", 2);
	append_turned(text, sizeof(text), high, 2, "0 0 1 1", 2);
	append_turned(text, sizeof(text), dome, 3, "0 0 0 1 1 1", 3);
	append_turned(text, sizeof(text), cone, 2, "0 0 1 1", 2);
	surface = made(text);
	volume = volume_and_area(&surface.soup, &area);
	print_message("%u triangles, volume %.4f, open %.4f\n", surface.soup.count, volume,
		      open_length(&surface.soup));
	CHECK(open_length(&surface.soup) == 0);
	CHECK(fabs(volume / ((2 + 2 / 3.0 + 2 / 3.0) * M_PI) - 1) < 0.01);
	vrml_surface_finish(&surface);
}

/* A square of 2 x 2 with a round hole of radius 0.5 and a square one of 0.4 x 0.4. */
static void trimming_leaves_the_rest(void **state)
{
	char text[4096] = HEAD
		"NurbsGroup { children Shape { geometry TrimmedSurface { surface NurbsSurface {"
		" uDimension 2 vDimension 2 uOrder 2 vOrder 2 uKnot [ 0 0 2 2 ]"
		" controlPoint [ 0 0 0, 2 0 0, 0 2 0, 2 2 0 ] vKnot [ 0 0 2 2 ] }"
		" trimmingContour [ Contour2D { children Polyline2D { point ["
		" 0 0, 2 0, 2 2, 0 2, 0 0 ] } } Contour2D { children Polyline2D { point ["
		" 1.5 1.5, 1.5 1.9, 1.9 1.9, 1.9 1.5 ] } } Contour2D { children NurbsCurve2D {"
		" knot [ " CIRCLE_KNOTS " ] weight [";
	struct vrml_surface surface;
	double area;
	(void)state;

	for (int i = 0; i < 9; i++)
		append(text, sizeof(text), " %.9g", circle[i][2]);
	append(text, sizeof(text), " ] controlPoint [");
	for (int i = 0; i < 9; i++)
		append(text, sizeof(text), " %.9g %.9g,", 0.8 + 0.5 * circle[i][0],
		       0.9 + 0.5 * circle[i][1]);
	append(text, sizeof(text), " ] } } ] } } }");
	surface = made(text);
	volume_and_area(&surface.soup, &area);
	print_message("%u triangles, area %.4f, open %.4f\n", surface.soup.count, area,
		      open_length(&surface.soup));
	CHECK(fabs(area - (4 - 0.16 - M_PI / 4)) < 0.002);
	CHECK(fabs(open_length(&surface.soup) - (8 + 1.6 + M_PI)) < 0.01);
	for (uint32_t i = 0; i < surface.soup.count; i++) /* they all look to +z */
		CHECK(surface.soup.triangles[i].corners[0].uv[0] <= 1);
	vrml_surface_finish(&surface);
}

/* Points of a cubic Bezier curve; knots that are not given are even. */
static void curves_are_where_they_should_be(void **state)
{
	static const float points[] = { 0, 0, 1, 2, 3, 2, 4, 0 };
	static const float knots[] = { 0, 0, 0, 0, 1, 1, 1, 1 };
	const struct nurbs_curve curve = { { 4, 4, knots }, 2, points, NULL };
	struct vrml_surface surface;
	double place[2], area;
	(void)state;

	for (int i = -1; i <= 11; i++) {
		const double t = fmin(fmax(i / 10.0, 0), 1), s = 1 - t;

		nurbs_curve_place(&curve, i / 10.0, place);
		CHECK(fabs(place[0] - (3 * s * s * t + 9 * s * t * t + 4 * t * t * t)) < 1e-12);
		CHECK(fabs(place[1] - (6 * s * s * t + 6 * s * t * t)) < 1e-12);
	}
	surface =
		made(HEAD "Shape { geometry NurbsSurface { uDimension 3 vDimension 3 controlPoint ["
			  " 0 0 0, 1 0 0, 2 0 0, 0 1 0, 1 1 0, 2 1 0, 0 2 0, 1 2 0, 2 2 0 ] } }");
	volume_and_area(&surface.soup, &area);
	CHECK(fabs(area - 4) < 1e-5 && surface.soup.count == 2);
	vrml_surface_finish(&surface);
}

/* Its edges seem straight where the parts of one bend: corners in one line of the parameters were
 * divided for ever. */
static void a_surface_with_kinks_has_an_end(void **state)
{
	struct vrml_surface surface;

	(void)state;
	surface = made(
		HEAD
		"Shape { geometry NurbsSurface { uDimension 4 vDimension 3\n"
		"uOrder 2 vOrder 2 uKnot [ 0 0 .3 .6 1 1 ] vKnot [ 0 0 .5 1 1 ] controlPoint [\n"
		"0 0 0, 1 0 0, 2 0 2, 3 0 0, 0 0 1, 1 2 1, 2 0 1, 3 0 1,\n"
		"0 0 2, 1 0 2, 2 0 2, 3 0 2 ] } }\n");
	CHECK(surface.soup.count < 10000);
	/* no more than its border, but for an edge that several slivers share */
	CHECK(fabs(open_length(&surface.soup) - (1 + 2 * sqrt(5) + 3 + 2 * 2)) < 0.3);
	vrml_surface_finish(&surface);
}

static void faults_are_refused_with_the_line(void **state)
{
#define PLANE "uDimension 2 vDimension 2 controlPoint [ 0 0 0, 1 0 0, 0 1 0, 1 1 0 ] "
#define FLAT  PLANE "uOrder 2 vOrder 2 "
#define TRIM(inner)                                                                                \
	"TrimmedSurface { surface NurbsSurface { " FLAT "} trimmingContour [ " inner " ] }"
	static const struct {
		const char *geometry, *says;
	} cases[] = {
		{ "NurbsSurface { }", "control points" },
		{ "NurbsSurface { uDimension 65536 vDimension 65537 controlPoint [ 0 0 0 ] }",
		  "correct uDimension" },
		{ "NurbsSurface { " PLANE "}", "an order is 2 to 12" },
		{ "NurbsSurface { " PLANE "uOrder 13 vOrder 2 }", "an order is 2 to 12" },
		{ "NurbsSurface { " PLANE "uOrder -1 vOrder 2 }", "an order is 2 to 12" },
		{ "NurbsSurface { " FLAT "uKnot [ 0 0 1 ] }", "wrong number of knots" },
		{ "NurbsSurface { " FLAT "vKnot [ 0 1 0 1 ] }", "knots that fall" },
		{ "NurbsSurface { " FLAT "vKnot [ 0 1 1 2 ] }", "no range" },
		{ "NurbsSurface { " FLAT "weight [ 1 1 1 ] }", "wrong number of weights" },
		{ "NurbsSurface { " FLAT "weight [ 1 1 1 0 ] }", "not above 0" },
		{ "TrimmedSurface { }", "no NurbsSurface" },
		{ TRIM("Contour2D { children Polyline2D { point [ 0 0, 2 0, 0 1 ] } }"),
		  "beyond the surface's knots" },
		{ TRIM("Contour2D { children NurbsCurve2D { controlPoint [ 0 0, 1 0 ] } }"),
		  "an order is 2 to 12" },
		{ TRIM("Contour2D { children Box { } }"), "no part of a contour" },
	};
	(void)state;

	for (size_t i = 0; i < ARRAY_COUNT(cases); i++) {
		struct diagnostics diagnostics = { 0 };
		struct vrml_surface surface;
		char text[1024];

		snprintf(text, sizeof(text), HEAD "Shape {\ngeometry %s }", cases[i].geometry);
		CHECK(make(&surface, text, &diagnostics) == -EBADMSG);
		if (!strstr(diagnostics.first.text, cases[i].says) ||
		    strncmp(diagnostics.first.text, "a.wrl:3: ", 9) != 0)
			fail_msg("case %zu: %s", i, diagnostics.first.text);
		vrml_surface_finish(&surface);
	}
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(a_sphere_is_exact_and_closed),
		cmocka_unit_test(neighbours_meet_without_a_crack),
		cmocka_unit_test(trimming_leaves_the_rest),
		cmocka_unit_test(curves_are_where_they_should_be),
		cmocka_unit_test(a_surface_with_kinks_has_an_end),
		cmocka_unit_test(faults_are_refused_with_the_line),
	};
	return cmocka_run_group_tests(tests, NULL, NULL);
}
