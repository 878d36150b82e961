/* Divides labelled triangles into small ones and cuts them where the label value changes sign. */
#include "render/patches/part_area.h"

#include <errno.h>
#include <stdlib.h>
#include <string.h>

#include "base/array.h"

/* A corner of a small triangle: its position, and how far inside it is. */
struct corner {
	float at[3];
	int value;
};

/* Writes the point between a and b, on either side of the outline, where it crosses. */
static void cross(float out[3], const struct corner *a, const struct corner *b)
{
	/* Interpolate from the inner corner, so that neighbours agree bit for bit. */
	const struct corner *in = a->value > 0 ? a : b, *off = a->value > 0 ? b : a;
	float share = (float)in->value / (float)(in->value - off->value);

	for (int i = 0; i < 3; i++)
		out[i] = in->at[i] + share * (off->at[i] - in->at[i]);
}

static void add_triangle(struct part_area *area, const float a[3], const float b[3],
			 const float c[3])
{
	memcpy(area->within[area->within_count++], a, sizeof(*area->within));
	memcpy(area->within[area->within_count++], b, sizeof(*area->within));
	memcpy(area->within[area->within_count++], c, sizeof(*area->within));
}

/* Adds the inner area of a small triangle: at most two triangles. */
static bool add_small(struct part_area *area, const struct corner *corner[3])
{
	float ab[3], ac[3];
	int within = 0, alone = 0;

	for (int k = 0; k < 3; k++)
		within += corner[k]->value > 0;
	if (within == 0)
		return true;
	if (ARRAY_RESERVE(area->within, area->within_room, area->within_count + 6, UINT32_MAX) < 0)
		return false;
	if (within == 3) {
		add_triangle(area, corner[0]->at, corner[1]->at, corner[2]->at);
		return true;
	}
	/* Find the corner that is alone on its side. */
	while ((corner[alone]->value > 0) != (within == 1))
		alone++;
	const struct corner *a = corner[alone], *b = corner[(alone + 1) % 3],
			    *c = corner[(alone + 2) % 3];
	cross(ab, a, b);
	cross(ac, a, c);
	if (within == 1) {
		add_triangle(area, a->at, ab, ac);
	} else {
		add_triangle(area, ab, b->at, c->at);
		add_triangle(area, ab, c->at, ac);
	}
	return true;
}

static void place_corner(struct corner *out, float at[3][3], int level, const int8_t *values, int i,
			 int j)
{
	const float n = (float)(1 << level), v = (float)i / n, w = (float)j / n;

	out->value = values[label_value_at(level, i, j)];
	for (int x = 0; x < 3; x++)
		out->at[x] = at[0][x] + v * (at[1][x] - at[0][x]) + w * (at[2][x] - at[0][x]);
}

/* Divides a triangle that the outline crosses. */
static bool add_divided(struct part_area *area, const struct patch_bvh *bvh, uint32_t triangle,
			const int8_t *values, int level)
{
	const uint16_t *index = &bvh->indices[3 * triangle];
	float at[3][3];
	const int n = 1 << level;

	for (int k = 0; k < 3; k++)
		patch_bvh_corner(bvh, index[k], at[k]);
	for (int i = 0; i < n; i++)
		for (int j = 0; j < n - i; j++) {
			struct corner corner[4];
			const struct corner *up[3] = { &corner[0], &corner[1], &corner[2] };
			const struct corner *down[3] = { &corner[1], &corner[3], &corner[2] };

			place_corner(&corner[0], at, level, values, i, j);
			place_corner(&corner[1], at, level, values, i + 1, j);
			place_corner(&corner[2], at, level, values, i, j + 1);
			if (!add_small(area, up))
				return false;
			if (i + j + 2 > n)
				continue;
			place_corner(&corner[3], at, level, values, i + 1, j + 1);
			if (!add_small(area, down))
				return false;
		}
	return true;
}

static bool add_of(struct part_area *area, const struct patch_bvh *bvh, uint32_t triangle,
		   const struct label_group *labels, uint32_t patch, uint32_t part)
{
	const struct label_patch *of = &labels->patches[patch];
	const uint32_t known_as = bvh->order[triangle];
	uint32_t first, count;

	if (label_holds(labels, patch, known_as, part)) {
		if (ARRAY_RESERVE(area->whole, area->whole_room, area->whole_count + 3,
				  UINT32_MAX) < 0)
			return false;
		memcpy(&area->whole[area->whole_count], &bvh->indices[3 * triangle],
		       3 * sizeof(*area->whole));
		area->whole_count += 3;
		return true;
	}
	count = label_borders(of, known_as, &first);
	for (uint32_t b = first; b < first + count; b++)
		if (of->borders[b].part == part)
			return add_divided(area, bvh, triangle,
					   &labels->values[of->borders[b].first],
					   of->borders[b].level);
	return true;
}

int part_area_create(struct part_area *out, const struct patch_bvh *bvh,
		     const struct label_group *labels, uint32_t patch, uint32_t part)
{
	*out = (struct part_area){ 0 };
	for (uint32_t t = 0; t < labels->patches[patch].triangle_count; t++) {
		if (add_of(out, bvh, t, labels, patch, part))
			continue;
		part_area_finish(out);
		return -ENOMEM;
	}
	return 0;
}

void part_area_finish(struct part_area *area)
{
	free(area->whole);
	free(area->within);
	*area = (struct part_area){ 0 };
}
