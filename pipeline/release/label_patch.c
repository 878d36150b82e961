/* Labels the triangles of a patch group: finds which parts contain each triangle, and samples the
 * triangles that an outline crosses. */
#include "pipeline/release/label_patch.h"

#include <errno.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/array.h"
#include "format/normal.h"
#include "geometry/vec.h"

enum { SAMPLES_MAX = ((1 << LABEL_LEVEL_MAX) + 1) * ((1 << LABEL_LEVEL_MAX) + 2) / 2 };

/* The group being built, and the current triangle. */
struct writer {
	struct label_group *out;
	const struct label_source *source;
	const struct lattice *lattice;
	float cell_m;
	uint32_t *
		part_of; /* for each part of the source, its number in this group plus one; owned */
	uint32_t set_room, member_room, border_room, value_room;
	/* The current triangle: */
	float corner[3][3], normal[3][3], centre[3], radius_m, longest_m;
	uint16_t own[LABEL_PARTS_MAX]; /* the parts that contain it completely */
	uint32_t own_count;
	int level; /* level of its samples; 0: not sampled yet */
	struct nearest_place samples[SAMPLES_MAX];
};

/* ---- the current triangle */

static void place_triangle(struct writer *w, const struct patch_mesh *patch, uint32_t t)
{
	w->level = 0;
	w->own_count = 0;
	w->radius_m = w->longest_m = 0;
	memset(w->centre, 0, sizeof(w->centre));
	for (int k = 0; k < 3; k++) {
		const struct patch_vertex *v =
			&patch->vertices[patch->indices[3 * t + (uint32_t)k]];
		double at[3];

		lattice_metres(at, w->lattice, v->position);
		for (int i = 0; i < 3; i++) {
			w->corner[k][i] = (float)at[i];
			w->centre[i] += w->corner[k][i] / 3;
		}
		normal_decode(w->normal[k], v->normal);
	}
	for (int k = 0; k < 3; k++) {
		w->radius_m = fmaxf(w->radius_m, vec_distance(w->centre, w->corner[k]));
		w->longest_m =
			fmaxf(w->longest_m, vec_distance(w->corner[k], w->corner[(k + 1) % 3]));
	}
}

/* Interpolates between corners in a fixed order, so that triangles that share an edge get the same
 * bits on it. */
static void mix(float out[3], float at[3][3], const int weight[3], int n)
{
	int order[3] = { 0, 1, 2 };

	for (int a = 0; a < 2; a++)
		for (int b = a + 1; b < 3; b++)
			if (memcmp(at[order[a]], at[order[b]], sizeof(at[0])) > 0) {
				int kept = order[a];

				order[a] = order[b];
				order[b] = kept;
			}
	memset(out, 0, 3 * sizeof(*out));
	for (int a = 0; a < 3; a++)
		for (int i = 0; i < 3; i++)
			if (weight[order[a]] > 0)
				out[i] += at[order[a]][i] * (float)weight[order[a]] / (float)n;
}

static void take_samples(struct writer *w)
{
	int level = LABEL_LEVEL_MIN, n;

	while (level < LABEL_LEVEL_MAX && w->longest_m > w->cell_m * (float)(1 << level))
		level++;
	n = 1 << level;
	for (int i = 0; i <= n; i++)
		for (int j = 0; j <= n - i; j++) {
			const int weight[3] = { n - i - j, i, j };
			float at[3], normal[3];

			mix(at, w->corner, weight, n);
			mix(normal, w->normal, weight, n);
			label_source_place(w->source, at, normal, w->cell_m,
					   &w->samples[label_value_at(level, i, j)]);
		}
	w->level = level;
}

/* ---- its labels */

/* Returns the number of a part in this group; adds the part if needed. */
static uint16_t number_part(struct writer *w, uint32_t part)
{
	const struct label_source_part *from = label_source_part(w->source, part);
	struct label_group *group = w->out;

	if (!w->part_of[part]) {
		struct label_part *to = &group->parts[group->part_count];

		memcpy(to->id, from->id, strlen(from->id) + 1);
		to->area_m2 = from->area_m2;
		w->part_of[part] = ++group->part_count;
	}
	return (uint16_t)(w->part_of[part] - 1);
}

static int by_number(const void *a, const void *b)
{
	return *(const uint16_t *)a - *(const uint16_t *)b;
}

/* Finds the set of the parts that contain the triangle, or adds it. */
static int number_set(struct writer *w, uint16_t *out)
{
	struct label_group *group = w->out;
	struct label_set *set;
	int rc;

	qsort(w->own, w->own_count, sizeof(*w->own), by_number);
	for (uint32_t s = 0; s < group->set_count; s++) {
		set = &group->sets[s];
		*out = (uint16_t)s;
		if (set->count == w->own_count &&
		    (set->count == 0 || memcmp(&group->members[set->first], w->own,
					       w->own_count * sizeof(*w->own)) == 0))
			return 0;
	}
	rc = ARRAY_RESERVE(group->sets, w->set_room, group->set_count + 1, LABEL_SETS_MAX);
	if (rc == 0)
		rc = ARRAY_RESERVE(group->members, w->member_room,
				   group->member_count + w->own_count, UINT32_MAX);
	if (rc < 0)
		return rc;
	group->sets[group->set_count] = (struct label_set){ group->member_count, w->own_count };
	memcpy(&group->members[group->member_count], w->own, w->own_count * sizeof(*w->own));
	group->member_count += w->own_count;
	*out = (uint16_t)group->set_count++;
	return 0;
}

/* Quantises metres to an odd number, so that no corner lies on the outline itself. */
static int8_t value_of(float within_m, float cell_m)
{
	float steps = floorf(within_m / cell_m * LABEL_VALUE_MAX / 2);

	steps = fminf(fmaxf(steps, -(LABEL_VALUE_MAX + 1) / 2), LABEL_VALUE_MAX / 2);
	return (int8_t)(2 * (int)steps + 1);
}

static int add_border(struct writer *w, struct label_patch *patch, uint32_t triangle, uint16_t part,
		      const int8_t *values)
{
	struct label_group *group = w->out;
	uint32_t count = label_values(w->level);
	int rc = ARRAY_RESERVE(patch->borders, w->border_room, patch->border_count + 1, UINT32_MAX);

	if (rc == 0)
		rc = ARRAY_RESERVE(group->values, w->value_room, group->value_count + count,
				   UINT32_MAX);
	if (rc < 0)
		return rc;
	patch->borders[patch->border_count++] = (struct label_border){
		.triangle = (uint16_t)triangle,
		.part = part,
		.level = (uint8_t)w->level,
		.first = group->value_count,
	};
	memcpy(&group->values[group->value_count], values, count);
	group->value_count += count;
	return 0;
}

/* Labels the triangle for one part that is near it. */
static int label_part(struct writer *w, struct label_patch *patch, uint32_t triangle, uint32_t part)
{
	int8_t values[SAMPLES_MAX];
	uint32_t count, within = 0;
	float cell_m, inset_m = 0;

	if (w->level == 0)
		take_samples(w);
	count = label_values(w->level);
	cell_m = w->longest_m / (float)(1 << w->level);
	/* If the surface ends where the part ends, nothing lies outside the part. So the outline is
	 * moved slightly inwards. */
	if (label_source_part(w->source, part)->triangles)
		inset_m = fminf(cell_m, w->cell_m) / 4;
	for (uint32_t i = 0; i < count; i++) {
		values[i] = value_of(
			label_source_within(w->source, part, &w->samples[i], 2 * cell_m) - inset_m,
			cell_m);
		within += values[i] > 0;
	}
	if (within == 0)
		return 0;
	if (within < count)
		return add_border(w, patch, triangle, number_part(w, part), values);
	w->own[w->own_count++] = number_part(w, part);
	return 0;
}

static int by_triangle(const void *a, const void *b)
{
	const struct label_border *left = a, *right = b;

	if (left->triangle != right->triangle)
		return left->triangle - right->triangle;
	return left->part - right->part;
}

/* Sorts the borders of a patch. They were added in the order of the source's parts, but the group
 * numbers its parts differently. */
static int sort_borders(struct label_group *group, struct label_patch *patch, uint32_t first_value)
{
	uint32_t count = group->value_count - first_value, next = first_value;
	int8_t *sorted = malloc(count + 1);

	if (!sorted)
		return -ENOMEM;
	if (patch->border_count > 0)
		qsort(patch->borders, patch->border_count, sizeof(*patch->borders), by_triangle);
	for (uint32_t b = 0; b < patch->border_count; b++) {
		uint32_t own = label_values(patch->borders[b].level);

		memcpy(&sorted[next - first_value], &group->values[patch->borders[b].first], own);
		patch->borders[b].first = next;
		next += own;
	}
	if (count > 0)
		memcpy(&group->values[first_value], sorted, count);
	free(sorted);
	return 0;
}

/* If the whole triangle is on one side of a part, one sample decides. Otherwise it is sampled at
 * the resolution of outlines. */
static int label_triangle(struct writer *w, struct label_patch *patch,
			  const struct patch_mesh *mesh, uint32_t t, const uint32_t *near,
			  uint32_t near_count)
{
	struct nearest_place middle = { .distance_m = -1 };
	float normal[3] = { 0 };
	int rc = 0;

	place_triangle(w, mesh, t);
	for (int k = 0; k < 3; k++)
		vec_add_scaled(normal, normal, 1, w->normal[k]);
	for (uint32_t i = 0; rc == 0 && i < near_count; i++) {
		const struct label_source_part *part = label_source_part(w->source, near[i]);
		float reach, within;

		if (middle.distance_m < 0)
			label_source_place(w->source, w->centre, normal, w->cell_m, &middle);
		reach = w->radius_m + 2 * middle.distance_m + w->cell_m;
		if (vec_distance(middle.at_m, part->centre_m) > part->radius_m + reach)
			continue;
		within = label_source_within(w->source, near[i], &middle, reach);
		if (fabsf(within) < reach)
			rc = label_part(w, patch, t, near[i]);
		else if (within > 0)
			w->own[w->own_count++] = number_part(w, near[i]);
	}
	return rc < 0 ? rc : number_set(w, &patch->sets[t]);
}

/* Lists the parts that a patch may intersect. Returns how many. The patch's surface may be off the
 * scan by about the size of its triangles, which is small compared with the patch: a quarter of its
 * size is plenty. */
static uint32_t list_near(const struct writer *w, const struct patch_mesh *mesh, uint32_t *near)
{
	float low[3] = { INFINITY, INFINITY, INFINITY };
	float high[3] = { -INFINITY, -INFINITY, -INFINITY }, centre[3], diagonal[3];
	uint32_t count = 0;

	for (uint32_t v = 0; v < mesh->vertex_count; v++) {
		double at[3];

		lattice_metres(at, w->lattice, mesh->vertices[v].position);
		for (int i = 0; i < 3; i++) {
			low[i] = fminf(low[i], (float)at[i]);
			high[i] = fmaxf(high[i], (float)at[i]);
		}
	}
	for (int i = 0; i < 3; i++)
		centre[i] = (low[i] + high[i]) / 2;
	vec_sub(diagonal, high, low);
	for (uint32_t p = 0; p < label_source_part_count(w->source); p++) {
		const struct label_source_part *part = label_source_part(w->source, p);

		if (vec_distance(centre, part->centre_m) <=
		    part->radius_m + 0.75f * vec_length(diagonal) + w->cell_m)
			near[count++] = p;
	}
	return count;
}

static int label_patch(struct writer *w, struct label_patch *patch, const struct patch_mesh *mesh,
		       uint32_t *near)
{
	uint32_t near_count = list_near(w, mesh, near), first_value = w->out->value_count;
	int rc = 0;

	patch->triangle_count = mesh->triangle_count;
	patch->sets = calloc(mesh->triangle_count + 1, sizeof(*patch->sets));
	if (!patch->sets)
		return -ENOMEM;
	w->border_room = 0;
	for (uint32_t t = 0; rc == 0 && near_count > 0 && t < mesh->triangle_count; t++)
		rc = label_triangle(w, patch, mesh, t, near, near_count);
	return rc < 0 ? rc : sort_borders(w->out, patch, first_value);
}

int label_patch_group(struct label_group *out, const struct label_source *source,
		      const struct lattice *lattice, const struct patch_mesh *patches,
		      uint32_t patch_count, float cell_m)
{
	uint32_t parts = label_source_part_count(source);
	struct writer *w = calloc(1, sizeof(*w));
	uint32_t *near = calloc(parts + 1, sizeof(*near));
	int rc = -ENOMEM;

	*out = (struct label_group){ 0 };
	out->parts = calloc(parts + 1, sizeof(*out->parts));
	out->patches = calloc(patch_count + 1, sizeof(*out->patches));
	if (w && near && out->parts && out->patches) {
		*w = (struct writer){
			.out = out, .source = source, .lattice = lattice, .cell_m = cell_m
		};
		w->part_of = calloc(parts + 1, sizeof(*w->part_of));
		rc = w->part_of ? ARRAY_RESERVE(out->sets, w->set_room, 1, LABEL_SETS_MAX)
				: -ENOMEM;
	}
	if (rc == 0) {
		out->sets[0] = (struct label_set){ 0 };
		out->set_count = 1;
		out->patch_count = patch_count;
	}
	for (uint32_t p = 0; rc == 0 && p < patch_count; p++)
		rc = label_patch(w, &out->patches[p], &patches[p], near);
	if (w)
		free(w->part_of);
	free(w);
	free(near);
	if (rc < 0)
		label_group_finish(out);
	return rc;
}
