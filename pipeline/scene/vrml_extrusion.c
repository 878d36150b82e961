/* Moves a cross-section along a spine (ISO/IEC 14772-1, 6.18). */
#include "pipeline/scene/vrml_extrusion.h"

#include <errno.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "geometry/vec.h"

/* A list of vectors, or the default. */
struct points {
	const float *at;
	uint32_t count;
};

/* Axes of the plane of a cross-section: across, along the spine, and up from it. */
struct frame {
	float x[3], y[3], z[3];
};

struct extrusion {
	struct soup *soup;
	const uint8_t *rgb;
	struct points section, spine, scales, turns;
	struct frame *frames; /* owned; of each point of the spine */
	bool is_ring;         /* the spine ends where it begins */
	bool is_closed;       /* so does the section */
};

static struct points points_of(const struct vrml_node *node, const char *field, uint32_t width,
			       const float *otherwise, uint32_t count)
{
	const struct vrml_value *value = vrml_get(node, field);

	if (!value || value->count < width)
		return (struct points){ otherwise, count };
	return (struct points){ value->floats, value->count / width };
}

/* What belongs to a point of the spine; where there are too few, the last is for the rest. */
static const float *item(const struct points *points, uint32_t i, uint32_t width)
{
	return points->at + (size_t)width * (i < points->count ? i : points->count - 1);
}

static bool same(const float *a, const float *b, uint32_t width)
{
	return memcmp(a, b, width * sizeof(*a)) == 0;
}

/* ---- frames */

static const float *spine_at(const struct extrusion *e, uint32_t i)
{
	return e->spine.at + 3 * (size_t)i;
}

/* The neighbours of a point of the spine; at an open end, the point itself for the missing one. */
static void neighbours(const struct extrusion *e, uint32_t i, const float **before,
		       const float **after)
{
	const uint32_t last = e->spine.count - 1;

	*before = spine_at(e, i > 0 ? i - 1 : e->is_ring ? last - 1 : 0);
	*after = spine_at(e, i < last ? i + 1 : e->is_ring ? 1 : last);
}

/* Sets y of each frame, and z where the spine bends there. Returns whether it bends anywhere. */
static bool find_directions(struct extrusion *e)
{
	bool bends = false;

	for (uint32_t i = 0; i < e->spine.count; i++) {
		struct frame *frame = &e->frames[i];
		const float *before, *after;
		float to[3], from[3];

		neighbours(e, i, &before, &after);
		vec_sub(frame->y, after, before);
		if (!(vec_normalise(frame->y) > 0)) {
			const float up[3] = { 0, 1, 0 };

			vec_copy(frame->y, i > 0 ? e->frames[i - 1].y : up);
		}
		vec_sub(to, after, spine_at(e, i));
		vec_sub(from, before, spine_at(e, i));
		vec_normalise(to);
		vec_normalise(from);
		vec_cross(frame->z, to, from);
		if (vec_length(frame->z) > 1e-5f)
			bends = true;
		else
			memset(frame->z, 0, sizeof(frame->z));
		vec_normalise(frame->z);
	}
	return bends;
}

/* Where the spine is straight, z is that of the point before, and at its beginning that of the
 * first bend; it does not turn over from one point to the next. */
static void complete_directions(struct extrusion *e)
{
	uint32_t first = 0;

	while (vec_length(e->frames[first].z) < 0.5f)
		first++;
	for (uint32_t i = 0; i < first; i++)
		vec_copy(e->frames[i].z, e->frames[first].z);
	for (uint32_t i = first + 1; i < e->spine.count; i++) {
		float *z = e->frames[i].z;
		const float *before = e->frames[i - 1].z;

		if (vec_length(z) < 0.5f)
			vec_copy(z, before);
		else if (vec_dot(z, before) < 0)
			for (int k = 0; k < 3; k++)
				z[k] = -z[k];
	}
}

/* Of a straight spine: the frame that the shortest turn from the y axis to the spine gives. */
static void find_straight(struct extrusion *e)
{
	const float up[3] = { 0, 1, 0 };

	for (uint32_t i = 0; i < e->spine.count; i++) {
		float *y = e->frames[i].y, *z = e->frames[i].z;
		const float forward[3] = { 0, 0, 1 }, c = y[1];
		float axis[3], cross[3], along;

		vec_cross(axis, up, y); /* of the turn; as long as its sine */
		vec_copy(z, forward);
		if (c < -0.9999f) {
			z[2] = -1; /* upside down: half a turn about x */
			continue;
		}
		/* Rodrigues' rotation of z; (1 - c) / sine^2 is 1 / (1 + c) */
		along = vec_dot(axis, forward) / (1 + c);
		vec_cross(cross, axis, forward);
		for (int k = 0; k < 3; k++)
			z[k] = forward[k] * c + cross[k] + axis[k] * along;
	}
}

static void find_frames(struct extrusion *e)
{
	if (find_directions(e))
		complete_directions(e);
	else
		find_straight(e);
	for (uint32_t i = 0; i < e->spine.count; i++) {
		struct frame *frame = &e->frames[i];

		vec_cross(frame->x, frame->y, frame->z);
		vec_normalise(frame->x);
		/* at a bend y and z need not be perpendicular */
		vec_cross(frame->z, frame->x, frame->y);
	}
}

/* ---- corners */

static void rotate(float p[3], const float rotation[4])
{
	float axis[3] = { rotation[0], rotation[1], rotation[2] }, cross[3], along;
	const float s = sinf(rotation[3]), c = cosf(rotation[3]);

	if (!(vec_normalise(axis) > 0))
		return;
	along = vec_dot(axis, p) * (1 - c);
	vec_cross(cross, axis, p);
	for (int k = 0; k < 3; k++)
		p[k] = p[k] * c + cross[k] * s + axis[k] * along;
}

static void set_corner(const struct extrusion *e, uint32_t i, uint32_t j, struct soup_corner *out)
{
	const struct frame *frame = &e->frames[i];
	const float *flat = e->section.at + 2 * (size_t)j, *scale = item(&e->scales, i, 2);
	float p[3] = { flat[0] * scale[0], 0, flat[1] * scale[1] };

	rotate(p, item(&e->turns, i, 4));
	*out = (struct soup_corner){ .uv = { (float)j / (float)(e->section.count - 1),
					     (float)i / (float)(e->spine.count - 1) } };
	memcpy(out->rgb, e->rgb, sizeof(out->rgb));
	for (int k = 0; k < 3; k++)
		out->position[k] = spine_at(e, i)[k] + p[0] * frame->x[k] + p[1] * frame->y[k] +
				   p[2] * frame->z[k];
}

/* Two triangles for each quad, since it need not be flat. */
static int add_sides(const struct extrusion *e)
{
	int rc = 0;

	for (uint32_t i = 0; i + 1 < e->spine.count && rc == 0; i++)
		for (uint32_t j = 0; j + 1 < e->section.count && rc == 0; j++) {
			struct soup_corner corners[4] = { 0 };

			set_corner(e, i, j, &corners[0]);
			set_corner(e, i, j + 1, &corners[1]);
			set_corner(e, i + 1, j + 1, &corners[2]);
			set_corner(e, i + 1, j, &corners[3]);
			rc = soup_add(e->soup, corners, 3);
			corners[1] = corners[0];
			if (rc == 0)
				rc = soup_add(e->soup, corners + 1, 3);
		}
	return rc;
}

/* A cap shows the picture once, as wide as the larger side of the section. */
static void place_picture(const struct extrusion *e, float low[2], float *size)
{
	float high[2] = { -INFINITY, -INFINITY };

	low[0] = low[1] = INFINITY;
	for (uint32_t i = 0; i < 2 * e->section.count; i++) {
		low[i % 2] = fminf(low[i % 2], e->section.at[i]);
		high[i % 2] = fmaxf(high[i % 2], e->section.at[i]);
	}
	*size = fmaxf(high[0] - low[0], high[1] - low[1]);
}

static int add_cap(const struct extrusion *e, bool is_end)
{
	const uint32_t count = e->section.count - e->is_closed;
	struct soup_corner *corners = calloc(count, sizeof(*corners));
	float low[2], size;
	int rc;

	if (!corners)
		return -ENOMEM;
	place_picture(e, low, &size);
	for (uint32_t j = 0; j < count; j++) {
		struct soup_corner *corner = &corners[is_end ? j : count - 1 - j];

		set_corner(e, is_end ? e->spine.count - 1 : 0, j, corner);
		for (uint32_t k = 0; k < 2; k++)
			corner->uv[k] = size > 0 ? (e->section.at[2 * j + k] - low[k]) / size : 0;
	}
	rc = soup_add(e->soup, corners, count);
	free(corners);
	return rc;
}

int vrml_extrusion_add(struct soup *soup, const struct vrml_node *extrusion, const uint8_t rgb[3])
{
	static const float square[] = { 1, 1, 1, -1, -1, -1, -1, 1, 1, 1 };
	static const float up[] = { 0, 0, 0, 0, 1, 0 }, one[] = { 1, 1 }, none[] = { 0, 0, 1, 0 };
	struct extrusion e = { .soup = soup, .rgb = rgb };
	int rc;

	e.section = points_of(extrusion, "crossSection", 2, square, 5);
	e.spine = points_of(extrusion, "spine", 3, up, 2);
	e.scales = points_of(extrusion, "scale", 2, one, 1);
	e.turns = points_of(extrusion, "orientation", 4, none, 1);
	if (e.section.count < 2 || e.spine.count < 2)
		return 0;
	e.is_ring = e.spine.count > 2 && same(e.spine.at, spine_at(&e, e.spine.count - 1), 3);
	e.is_closed = e.section.count > 2 &&
		      same(e.section.at, e.section.at + 2 * (size_t)(e.section.count - 1), 2);
	e.frames = calloc(e.spine.count, sizeof(*e.frames));
	if (!e.frames)
		return -ENOMEM;
	find_frames(&e);
	rc = add_sides(&e);
	/* the caps of a ring would be inside it */
	if (rc == 0 && !e.is_ring && vrml_get_integer(extrusion, "beginCap", 1))
		rc = add_cap(&e, false);
	if (rc == 0 && !e.is_ring && vrml_get_integer(extrusion, "endCap", 1))
		rc = add_cap(&e, true);
	free(e.frames);
	return rc;
}
