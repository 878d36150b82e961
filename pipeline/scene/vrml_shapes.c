/* Boxes, bodies of revolution and grids. Sets of faces are vrml_faces.c, extrusions
 * vrml_extrusion.c. */
#include "pipeline/scene/vrml_shapes.h"

#include <errno.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "geometry/vec.h"
#include "pipeline/scene/vrml_extrusion.h"
#include "pipeline/scene/vrml_faces.h"
#include "pipeline/scene/vrml_lines.h"
#include "pipeline/scene/vrml_nurbs.h"
#include "pipeline/scene/vrml_words.h"

#define TURN 6.2831853f

enum { ROUND = 48, BANDS = 24, GRID_MAX = 1 << 24 };

struct shaping {
	struct soup *soup;
	const struct vrml_node *node;
	const uint8_t *rgb;
	struct diagnostics *diagnostics;
};

static struct soup_corner corner_at(const struct shaping *shaping, float x, float y, float z,
				    float u, float v)
{
	struct soup_corner corner = { .position = { x, y, z }, .uv = { u, v } };

	memcpy(corner.rgb, shaping->rgb, 3);
	return corner;
}

/* ---- bodies */

static int add_box(const struct shaping *shaping)
{
	/* for each face, the signs of its four corners, from the lower left, counter-clockwise */
	static const int8_t faces[6][4][3] = {
		{ { -1, -1, 1 }, { 1, -1, 1 }, { 1, 1, 1 }, { -1, 1, 1 } },
		{ { 1, -1, -1 }, { -1, -1, -1 }, { -1, 1, -1 }, { 1, 1, -1 } },
		{ { 1, -1, 1 }, { 1, -1, -1 }, { 1, 1, -1 }, { 1, 1, 1 } },
		{ { -1, -1, -1 }, { -1, -1, 1 }, { -1, 1, 1 }, { -1, 1, -1 } },
		{ { -1, 1, 1 }, { 1, 1, 1 }, { 1, 1, -1 }, { -1, 1, -1 } },
		{ { -1, -1, -1 }, { 1, -1, -1 }, { 1, -1, 1 }, { -1, -1, 1 } },
	};
	float size[3];
	int rc = 0;

	vrml_get_floats(size, shaping->node, "size", 3, (const float[3]){ 2, 2, 2 });
	for (int face = 0; face < 6 && rc == 0; face++) {
		struct soup_corner corners[4] = { 0 };

		for (int i = 0; i < 4; i++) {
			const int8_t *sign = faces[face][i];

			corners[i] =
				corner_at(shaping, size[0] / 2 * sign[0], size[1] / 2 * sign[1],
					  size[2] / 2 * sign[2], i == 1 || i == 2, i >= 2);
		}
		rc = soup_add(shaping->soup, corners, 4);
	}
	return rc;
}

/* A ring of a body of revolution about y. */
struct ring {
	float radius, y, v;
};

/* The first corner is at the back; they go counter-clockwise seen from above. */
static struct soup_corner ring_corner(const struct shaping *shaping, struct ring ring, int i)
{
	float angle = TURN * (float)(i % ROUND) / ROUND;

	return corner_at(shaping, -ring.radius * sinf(angle), ring.y, -ring.radius * cosf(angle),
			 (float)i / ROUND, ring.v);
}

/* Adds the band between two rings, the lower one first. A ring may be a point. */
static int add_band(const struct shaping *shaping, struct ring low, struct ring high)
{
	int rc = 0;

	for (int i = 0; i < ROUND && rc == 0; i++) {
		struct soup_corner corners[4] = { 0 };
		uint32_t count = 0;

		corners[count++] = ring_corner(shaping, low, i);
		if (low.radius > 0)
			corners[count++] = ring_corner(shaping, low, i + 1);
		corners[count++] = ring_corner(shaping, high, i + 1);
		if (high.radius > 0)
			corners[count++] = ring_corner(shaping, high, i);
		rc = soup_add(shaping->soup, corners, count);
	}
	return rc;
}

static int add_disc(const struct shaping *shaping, struct ring ring, bool is_top)
{
	struct soup_corner corners[ROUND] = { 0 };

	for (int i = 0; i < ROUND; i++) {
		struct soup_corner *corner = &corners[is_top ? i : ROUND - 1 - i];

		*corner = ring_corner(shaping, ring, i);
		corner->uv[0] = 0.5f + corner->position[0] / (2 * ring.radius);
		corner->uv[1] = 0.5f + (is_top ? -1 : 1) * corner->position[2] / (2 * ring.radius);
	}
	return soup_add(shaping->soup, corners, ROUND);
}

static int add_sphere(const struct shaping *shaping)
{
	float radius = vrml_get_float(shaping->node, "radius", 1);
	int rc = 0;

	for (int i = 0; i < BANDS && rc == 0; i++) {
		struct ring rings[2];

		for (int k = 0; k < 2; k++) {
			float share = (float)(i + k) / BANDS, angle = TURN / 2 * share;
			bool is_pole = i + k == 0 || i + k == BANDS;

			rings[k] = (struct ring){ is_pole ? 0 : radius * sinf(angle),
						  -radius * cosf(angle), share };
		}
		rc = add_band(shaping, rings[0], rings[1]);
	}
	return rc;
}

static int add_cylinder(const struct shaping *shaping)
{
	float radius = vrml_get_float(shaping->node, "radius", 1);
	float height = vrml_get_float(shaping->node, "height", 2);
	struct ring low = { radius, -height / 2, 0 }, high = { radius, height / 2, 1 };
	int rc = 0;

	if (vrml_get_integer(shaping->node, "side", 1))
		rc = add_band(shaping, low, high);
	if (rc == 0 && vrml_get_integer(shaping->node, "bottom", 1))
		rc = add_disc(shaping, low, false);
	if (rc == 0 && vrml_get_integer(shaping->node, "top", 1))
		rc = add_disc(shaping, high, true);
	return rc;
}

static int add_cone(const struct shaping *shaping)
{
	float radius = vrml_get_float(shaping->node, "bottomRadius", 1);
	float height = vrml_get_float(shaping->node, "height", 2);
	struct ring low = { radius, -height / 2, 0 }, tip = { 0, height / 2, 1 };
	int rc = 0;

	if (vrml_get_integer(shaping->node, "side", 1))
		rc = add_band(shaping, low, tip);
	if (rc == 0 && vrml_get_integer(shaping->node, "bottom", 1))
		rc = add_disc(shaping, low, false);
	return rc;
}

/* ---- grids of heights */

static void colour_of(uint8_t rgb[3], const struct vrml_value *colours, uint64_t index)
{
	if (!colours || 3 * index + 2 >= colours->count)
		return;
	vrml_colour(rgb, colours->floats + 3 * index);
}

static int add_grid(const struct shaping *shaping)
{
	const struct vrml_node *node = shaping->node;
	const struct vrml_node *color = vrml_get_node(node, "color");
	const struct vrml_node *texture = vrml_get_node(node, "texCoord");
	const struct vrml_value *colours = vrml_member(color, "Color", "color");
	const struct vrml_value *uvs = vrml_member(texture, "TextureCoordinate", "point");
	const struct vrml_value *heights = vrml_get(node, "height");
	bool per_vertex = vrml_get_integer(node, "colorPerVertex", 1) != 0;
	int64_t columns = vrml_get_integer(node, "xDimension", 0);
	int64_t rows = vrml_get_integer(node, "zDimension", 0);
	float x_step = vrml_get_float(node, "xSpacing", 1);
	float z_step = vrml_get_float(node, "zSpacing", 1);
	int rc = 0;

	if (columns < 0 || rows < 0 || columns > GRID_MAX || rows > GRID_MAX ||
	    columns * rows > (heights ? heights->count : 0))
		return diagnostics_add(shaping->diagnostics, -EBADMSG, node->file, node->line,
				       "ElevationGrid has %u heights for %lld x %lld; correct "
				       "xDimension and zDimension",
				       heights ? heights->count : 0, (long long)columns,
				       (long long)rows);
	for (int64_t j = 0; j + 1 < rows && rc == 0; j++)
		for (int64_t i = 0; i + 1 < columns && rc == 0; i++) {
			static const int8_t steps[4][2] = {
				{ 0, 0 }, { 0, 1 }, { 1, 1 }, { 1, 0 }
			};
			struct soup_corner corners[4] = { 0 };

			for (int k = 0; k < 4; k++) {
				int64_t x = i + steps[k][0], z = j + steps[k][1];
				uint64_t at = (uint64_t)(x + z * columns);

				corners[k] = corner_at(shaping, x_step * (float)x,
						       heights->floats[at], z_step * (float)z,
						       (float)x / (float)(columns - 1),
						       (float)z / (float)(rows - 1));
				colour_of(corners[k].rgb, colours,
					  per_vertex ? at : (uint64_t)(i + j * (columns - 1)));
				if (uvs && 2 * at + 1 < uvs->count)
					memcpy(corners[k].uv, uvs->floats + 2 * at, 8);
			}
			rc = soup_add(shaping->soup, corners, 3);
			corners[1] = corners[0]; /* two triangles: a quad need not be flat */
			if (rc == 0)
				rc = soup_add(shaping->soup, corners + 1, 3);
		}
	return rc;
}

static int add_extrusion(const struct shaping *shaping)
{
	return vrml_extrusion_add(shaping->soup, shaping->node, shaping->rgb);
}

static int add_nurbs(const struct shaping *shaping)
{
	return vrml_nurbs_add(shaping->soup, shaping->node, shaping->rgb, shaping->diagnostics);
}

static const struct {
	const char *name;
	int (*add)(const struct shaping *shaping);
} bodies[] = {
	{ "Box", add_box },
	{ "Sphere", add_sphere },
	{ "Cone", add_cone },
	{ "Cylinder", add_cylinder },
	{ "ElevationGrid", add_grid },
	{ "Extrusion", add_extrusion },
	{ "NurbsSurface", add_nurbs },
	{ "TrimmedSurface", add_nurbs },
};

static const struct {
	const char *name;
	int (*add)(struct soup *soup, const struct vrml_node *node, const uint8_t rgb[3],
		   struct diagnostics *diagnostics);
} sets[] = {
	{ "IndexedFaceSet", vrml_faces_add },
	{ "IndexedLineSet", vrml_lines_add },
	{ "PointSet", vrml_points_add },
	{ "Text", vrml_words_add },
};

static int add_any(const struct shaping *shaping)
{
	const char *name = shaping->node->type->name;

	for (size_t i = 0; i < ARRAY_COUNT(bodies); i++)
		if (strcmp(name, bodies[i].name) == 0) {
			int rc = bodies[i].add(shaping);

			return rc < 0 ? rc : 1;
		}
	for (size_t i = 0; i < ARRAY_COUNT(sets); i++)
		if (strcmp(name, sets[i].name) == 0)
			return sets[i].add(shaping->soup, shaping->node, shaping->rgb,
					   shaping->diagnostics);
	return 0;
}

int vrml_shape_add(struct soup *soup, const struct vrml_node *geometry, const uint8_t rgb[3],
		   bool is_mirrored, struct diagnostics *diagnostics)
{
	const struct shaping shaping = { soup, geometry, rgb, diagnostics };
	bool is_clockwise = vrml_field_named(geometry->type, "ccw", 3) >= 0 &&
			    vrml_get_integer(geometry, "ccw", 1) == 0;
	int rc;

	soup->is_inside_out = is_mirrored != is_clockwise;
	rc = add_any(&shaping);
	if (rc == -EFBIG)
		return diagnostics_add(diagnostics, rc, geometry->file, geometry->line,
				       "the scene has over %d triangles; split it",
				       SOUP_TRIANGLES_MAX);
	if (rc == -ENOMEM)
		return diagnostics_add(diagnostics, rc, geometry->file, geometry->line,
				       "too large for this machine's memory");
	return rc;
}
