/* Points and lines as bodies whose size follows from the extent of their set. */
#include "pipeline/scene/vrml_lines.h"

#include <errno.h>
#include <math.h>
#include <string.h>

#include "geometry/vec.h"
#include "pipeline/scene/vrml_faces.h"

/* Half the width, as a share of the diagonal of the set's box. */
#define LINE_SHARE  0.002f
#define POINT_SHARE 0.004f

struct set {
	struct soup *soup;
	const struct vrml_node *node;
	const struct vrml_value *points, *colours; /* points not NULL; colours or NULL */
	const uint8_t *rgb;
	float half; /* of the width */
};

/* Reads what both have. Returns false if there is nothing to draw. */
static bool begin(struct set *set, struct soup *soup, const struct vrml_node *node,
		  const uint8_t rgb[3], float share)
{
	float low[3], high[3];

	*set = (struct set){ .soup = soup, .node = node, .rgb = rgb };
	set->points = vrml_member(vrml_get_node(node, "coord"), "Coordinate", "point");
	set->colours = vrml_member(vrml_get_node(node, "color"), "Color", "color");
	if (!set->points || set->points->count < 3)
		return false;
	for (int k = 0; k < 3; k++) {
		low[k] = high[k] = set->points->floats[k];
		for (uint32_t i = (uint32_t)k; i < set->points->count; i += 3) {
			low[k] = fminf(low[k], set->points->floats[i]);
			high[k] = fmaxf(high[k], set->points->floats[i]);
		}
	}
	set->half = share * vec_distance(low, high);
	if (!(set->half > 0))
		set->half = share; /* one point alone: as if the box were a unit */
	return isfinite(set->half);
}

static void set_colour(const struct set *set, uint8_t rgb[3], uint32_t at)
{
	memcpy(rgb, set->rgb, 3);
	if (set->colours && at < set->colours->count / 3)
		vrml_colour(rgb, &set->colours->floats[3 * at]);
}

/* ---- points */

static int add_point(const struct set *set, uint32_t at)
{
	struct soup_corner corner = { 0 };
	int rc = 0;

	set_colour(set, corner.rgb, at);
	for (int face = 0; face < 8 && rc == 0; face++) {
		struct soup_corner corners[3] = { corner, corner, corner };
		const bool is_odd = (face & 1) ^ (face >> 1 & 1) ^ (face >> 2 & 1);

		for (int k = 0; k < 3; k++) {
			/* A face with an odd number of negative axes turns the other way. */
			const int axis = is_odd && k > 0 ? 3 - k : k;

			vec_copy(corners[k].position, &set->points->floats[3 * at]);
			corners[k].position[axis] += face >> axis & 1 ? -set->half : set->half;
		}
		rc = soup_add(set->soup, corners, 3);
	}
	return rc;
}

int vrml_points_add(struct soup *soup, const struct vrml_node *points, const uint8_t rgb[3],
		    struct diagnostics *diagnostics)
{
	struct set set;
	int rc = 1;

	(void)diagnostics;
	if (!begin(&set, soup, points, rgb, POINT_SHARE))
		return 1;
	for (uint32_t i = 0; i < set.points->count / 3 && rc >= 0; i++)
		rc = add_point(&set, i);
	return rc < 0 ? rc : 1;
}

/* ---- lines */

/* Sets two directions that are at right angles to a line and to each other. */
static void set_sides(float u[3], float v[3], const float along[3])
{
	float other[3] = { 0 };
	int least = 0;

	for (int k = 1; k < 3; k++)
		if (fabsf(along[k]) < fabsf(along[least]))
			least = k;
	other[least] = 1;
	vec_cross(u, along, other);
	vec_normalise(u);
	vec_cross(v, along, u);
}

static int add_bar(const struct set *set, const float *from, const float *to,
		   const uint8_t from_rgb[3], const uint8_t to_rgb[3])
{
	static const float places[3][2] = { { 1, 0 },
					    { -0.5f, 0.8660254f },
					    { -0.5f, -0.8660254f } };
	struct soup_corner ring[2][3] = { 0 };
	float along[3], u[3], v[3];
	int rc = 0;

	vec_sub(along, to, from);
	if (!(vec_normalise(along) > 0))
		return 0;
	set_sides(u, v, along);
	for (int end = 0; end < 2; end++)
		for (int i = 0; i < 3; i++) {
			struct soup_corner *corner = &ring[end][i];

			vec_copy(corner->position, end ? to : from);
			vec_add_scaled(corner->position, corner->position, places[i][0] * set->half,
				       u);
			vec_add_scaled(corner->position, corner->position, places[i][1] * set->half,
				       v);
			memcpy(corner->rgb, end ? to_rgb : from_rgb, 3);
		}
	for (int i = 0; i < 3 && rc == 0; i++) {
		const int next = (i + 1) % 3;
		const struct soup_corner side[4] = { ring[0][i], ring[0][next], ring[1][next],
						     ring[1][i] };

		rc = soup_add(set->soup, side, 3);
		if (rc == 0)
			rc = soup_add(set->soup,
				      (const struct soup_corner[3]){ side[0], side[2], side[3] },
				      3);
	}
	return rc;
}

struct lines {
	struct set set;
	const struct vrml_value *indices, *colour_indices; /* colour_indices or NULL */
	bool colour_per_vertex;
};

/* Which colour a place of a line has. */
static uint32_t colour_of(const struct lines *lines, uint32_t place, uint32_t line)
{
	const uint32_t at = lines->colour_per_vertex ? place : line;

	if (lines->colour_indices)
		return at < lines->colour_indices->count && lines->colour_indices->integers[at] >= 0
			       ? (uint32_t)lines->colour_indices->integers[at]
			       : 0;
	return lines->colour_per_vertex ? (uint32_t)lines->indices->integers[place] : line;
}

static int add_piece(const struct lines *lines, uint32_t place, uint32_t line,
		     struct diagnostics *diagnostics)
{
	const struct set *set = &lines->set;
	const int32_t from = lines->indices->integers[place];
	const int32_t to = lines->indices->integers[place + 1];
	const int32_t count = (int32_t)(set->points->count / 3);
	uint8_t rgb[2][3];

	if (from < 0 || to < 0)
		return 0;
	if (from >= count || to >= count)
		return diagnostics_add(diagnostics, -EBADMSG, set->node->file, set->node->line,
				       "coordIndex names point %d, and there are %d; correct it",
				       from >= count ? from : to, count);
	set_colour(set, rgb[0], colour_of(lines, place, line));
	set_colour(set, rgb[1], colour_of(lines, place + 1, line));
	return add_bar(set, &set->points->floats[3 * from], &set->points->floats[3 * to], rgb[0],
		       rgb[1]);
}

int vrml_lines_add(struct soup *soup, const struct vrml_node *node, const uint8_t rgb[3],
		   struct diagnostics *diagnostics)
{
	struct lines lines = { .indices = vrml_get(node, "coordIndex"),
			       .colour_indices = vrml_get(node, "colorIndex"),
			       .colour_per_vertex = vrml_get_integer(node, "colorPerVertex", 1) };
	uint32_t line = 0;
	int rc = 0;

	if (!begin(&lines.set, soup, node, rgb, LINE_SHARE) || !lines.indices)
		return 1;
	if (lines.colour_indices && lines.colour_indices->count == 0)
		lines.colour_indices = NULL;
	for (uint32_t i = 0; i + 1 < lines.indices->count && rc == 0; i++) {
		line += lines.indices->integers[i] < 0;
		rc = add_piece(&lines, i, line, diagnostics);
	}
	return rc < 0 ? rc : 1;
}
