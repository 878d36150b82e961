/* Adds polygons to a soup as triangles. Concave polygons are cut by ears: a corner whose
 * triangle holds no other corner is cut off, until three are left. */
#include "pipeline/scene/soup.h"

#include <errno.h>
#include <stdlib.h>
#include <string.h>

#include "base/array.h"
#include "geometry/vec.h"

/* Past these many tests of an ear or a point in it, for the whole soup, polygons become fans. */
#define POLYGON_STEPS_MAX (1ull << 28)

/* A matrix that mirrors turns the cofactors round. */
static void place_normal(float normal[3], const float m[16])
{
	float by[9], out[3];

	matrix_cofactors(by, m);
	for (int row = 0; row < 3; row++)
		out[row] = by[row] * normal[0] + by[3 + row] * normal[1] + by[6 + row] * normal[2];
	vec_scale(normal, vec_dot(&m[0], &by[0]) < 0 ? -1 : 1, out);
	vec_normalise(normal);
}

void soup_place(float out[3], const struct soup *soup, const float at[3])
{
	matrix_place(out, soup->place, at);
}

/* Adds the triangle of three corners, by their numbers. */
static int add_triangle(struct soup *soup, const struct soup_corner *of, uint32_t a, uint32_t b,
			uint32_t c)
{
	const uint32_t corners[3] = { a, soup->is_inside_out ? c : b, soup->is_inside_out ? b : c };
	struct soup_triangle *triangle;
	int rc = ARRAY_RESERVE(soup->triangles, soup->room, (uint64_t)soup->count + 1,
			       SOUP_TRIANGLES_MAX);

	if (rc == 0 && soup->keeps_sources)
		rc = ARRAY_RESERVE(soup->sources, soup->source_room, (uint64_t)soup->count + 1,
				   SOUP_TRIANGLES_MAX);
	if (rc < 0)
		return rc;
	for (int i = 0; i < 3 && soup->keeps_sources; i++)
		soup->sources[soup->count][i] = soup->from[corners[i]];
	triangle = &soup->triangles[soup->count++];
	for (int i = 0; i < 3; i++) {
		triangle->corners[i] = of[corners[i]];
		matrix_place(triangle->corners[i].position, soup->place, of[corners[i]].position);
		place_normal(triangle->corners[i].normal, soup->place);
	}
	triangle->texture = soup->texture;
	return 0;
}

/* ---- concave polygons, in their own plane */

struct polygon {
	const struct soup_corner *corners;
	uint32_t *left; /* numbers of the corners that are not cut off */
	uint32_t count;
	float (*flat)[2]; /* places in the plane, counter-clockwise */
};

/* Twice the area of a triangle; positive if it is counter-clockwise. */
static float area_of(const float a[2], const float b[2], const float c[2])
{
	return (b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0]);
}

/* Projects along the axis that the normal is nearest to (Newell's method). Returns false if the
 * polygon has no area. */
static bool flatten(struct polygon *polygon)
{
	float normal[3] = { 0 };
	int axis = 0, x, y;

	for (uint32_t i = 0; i < polygon->count; i++) {
		const float *a = polygon->corners[i].position;
		const float *b = polygon->corners[(i + 1) % polygon->count].position;

		for (int k = 0; k < 3; k++) {
			int u = (k + 1) % 3, v = (k + 2) % 3;

			normal[k] += (a[u] - b[u]) * (a[v] + b[v]);
		}
	}
	for (int k = 1; k < 3; k++)
		axis = fabsf(normal[k]) > fabsf(normal[axis]) ? k : axis;
	if (!(fabsf(normal[axis]) > 0))
		return false;
	x = (axis + 1) % 3;
	y = (axis + 2) % 3;
	for (uint32_t i = 0; i < polygon->count; i++) {
		const float *p = polygon->corners[i].position;

		polygon->flat[i][0] = normal[axis] > 0 ? p[x] : p[y];
		polygon->flat[i][1] = normal[axis] > 0 ? p[y] : p[x];
		polygon->left[i] = i;
	}
	return true;
}

static bool is_ear(const struct polygon *polygon, uint32_t at, uint64_t *steps)
{
	uint32_t count = polygon->count;
	uint32_t before = polygon->left[(at + count - 1) % count], tip = polygon->left[at];
	uint32_t after = polygon->left[(at + 1) % count];
	const float *a = polygon->flat[before], *b = polygon->flat[tip], *c = polygon->flat[after];

	++*steps;
	if (!(area_of(a, b, c) > 0))
		return false;
	*steps += count;
	for (uint32_t i = 0; i < count; i++) {
		const float *p = polygon->flat[polygon->left[i]];

		/* A corner at the same place is where a hole is joined to the outline. */
		if (memcmp(p, a, 8) == 0 || memcmp(p, b, 8) == 0 || memcmp(p, c, 8) == 0)
			continue;
		if (area_of(a, b, p) >= 0 && area_of(b, c, p) >= 0 && area_of(c, a, p) >= 0)
			return false;
	}
	return true;
}

/* Cuts off the corner `at` of what is left. */
static int cut(struct soup *soup, struct polygon *polygon, uint32_t at)
{
	uint32_t count = polygon->count--;
	int rc = add_triangle(soup, polygon->corners, polygon->left[(at + count - 1) % count],
			      polygon->left[at], polygon->left[(at + 1) % count]);

	memmove(&polygon->left[at], &polygon->left[at + 1],
		(count - at - 1) * sizeof(*polygon->left));
	return rc;
}

/* Makes a fan of what is left, around the corner before `at`. */
static int cut_fan(struct soup *soup, const struct polygon *polygon, uint32_t at)
{
	const uint32_t count = polygon->count, centre = at + count - 1;
	int rc = 0;

	for (uint32_t i = 1; i + 1 < count && rc == 0; i++)
		rc = add_triangle(soup, polygon->corners, polygon->left[centre % count],
				  polygon->left[(centre + i) % count],
				  polygon->left[(centre + i + 1) % count]);
	return rc;
}

static int cut_ears(struct soup *soup, struct polygon *polygon)
{
	uint32_t at = 0, failed = 0;
	int rc = 0;

	while (polygon->count >= 3 && rc == 0) {
		at %= polygon->count;
		if (soup->polygon_steps > POLYGON_STEPS_MAX)
			return cut_fan(soup, polygon, at);
		/* Where no corner is an ear, the outline crosses itself: any will do. */
		if (failed >= polygon->count || is_ear(polygon, at, &soup->polygon_steps)) {
			rc = cut(soup, polygon, at);
			failed = 0;
		} else {
			failed++;
			at++;
		}
	}
	return rc;
}

int soup_add(struct soup *soup, const struct soup_corner *corners, uint32_t count)
{
	struct polygon polygon = { .corners = corners, .count = count };
	int rc = 0;

	if (count < 3)
		return 0;
	if (count == 3)
		return add_triangle(soup, corners, 0, 1, 2);
	polygon.left = malloc(count * sizeof(*polygon.left));
	polygon.flat = malloc(count * sizeof(*polygon.flat));
	if (!polygon.left || !polygon.flat)
		rc = -ENOMEM;
	else if (flatten(&polygon))
		rc = cut_ears(soup, &polygon);
	free(polygon.left);
	free(polygon.flat);
	return rc;
}

void soup_finish(struct soup *soup)
{
	if (!soup)
		return;
	free(soup->triangles);
	free(soup->sources);
	*soup = (struct soup){ 0 };
}
