/* Marks what was looked through, and solves for the sign of what nobody saw. */
#include "pipeline/octree/coarse_fill.h"

#include <errno.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/spill.h"

enum { MARGIN = 2 /* coarse cells around the box */, LOOKS_FREE = 3, SWEEPS_MAX = 600 };

/* Weights of what is known, where that of each of the six neighbours is 1. */
static const float weight_seen = 16, weight_free = 2;
/* A distance of so many leaf cubes and more counts 1. */
static const float distance_full = 1.5f;
static const float change_small = 1e-4f;
/* Leaf cubes around a point that are not free. */
static const double taken_around = 1.75;

static size_t corner_count(const struct coarse_fill *fill)
{
	return (size_t)fill->corners[0] * fill->corners[1] * fill->corners[2];
}

static size_t index_of(const struct coarse_fill *fill, const int32_t at[3])
{
	return ((size_t)at[2] * fill->corners[1] + (size_t)at[1]) * fill->corners[0] +
	       (size_t)at[0];
}

int coarse_fill_init(struct coarse_fill *fill, const int32_t low[3], const int32_t high[3])
{
	*fill = (struct coarse_fill){ .shift = 1 };
	do {
		fill->shift++;
		for (int k = 0; k < 3; k++) {
			const int32_t cells =
				(high[k] >> fill->shift) - (low[k] >> fill->shift) + 1;

			fill->low[k] = ((low[k] >> fill->shift) - MARGIN) * (1 << fill->shift);
			fill->corners[k] = (uint32_t)cells + 2 * MARGIN + 1;
		}
	} while ((double)fill->corners[0] * fill->corners[1] * fill->corners[2] >
		 COARSE_CORNERS_MAX);
	fill->looks = calloc(corner_count(fill), 1);
	fill->taken = calloc(corner_count(fill), 1);
	return fill->looks && fill->taken ? 0 : -ENOMEM;
}

void coarse_fill_finish(struct coarse_fill *fill)
{
	if (!fill)
		return;
	free(fill->looks);
	free(fill->taken);
	free(fill->values);
	*fill = (struct coarse_fill){ 0 };
}

/* ---- lines of sight */

/* Steps through the cells from a place along a direction to the edge of the grid (Amanatides and
 * Woo 1987). Places are in coarse cells. */
static void look(struct coarse_fill *fill, const double from[3], const float towards[3])
{
	double next[3], step[3];
	int32_t cell[3];

	for (int k = 0; k < 3; k++) {
		const double direction = (double)towards[k];

		cell[k] = (int32_t)floor(from[k]);
		step[k] = fabs(direction) > 1e-9 ? 1 / fabs(direction) : 1e30;
		next[k] = (direction > 0 ? cell[k] + 1 - from[k] : from[k] - cell[k]) * step[k];
	}
	for (;;) {
		int k = next[0] < next[1] ? 0 : 1;
		size_t index;

		for (int i = 0; i < 3; i++)
			if (cell[i] < 0 || cell[i] >= (int32_t)fill->corners[i] - 1)
				return;
		index = index_of(fill, cell);
		fill->looks[index] += fill->looks[index] < UINT8_MAX;
		if (next[2] < next[k])
			k = 2;
		next[k] += step[k];
		cell[k] += towards[k] > 0 ? 1 : -1;
	}
}

/* Marks the cells within reach of a point: the surface may pass through them without another one.
 */
static void take(struct coarse_fill *fill, const double from[3])
{
	const double reach = taken_around / (1 << fill->shift);
	int32_t cell[3];

	for (int i = 0; i < 8; i++) {
		bool is_in = true;

		for (int k = 0; k < 3; k++) {
			cell[k] = (int32_t)floor(from[k] + (i >> k & 1 ? reach : -reach));
			is_in &= cell[k] >= 0 && cell[k] < (int32_t)fill->corners[k] - 1;
		}
		if (is_in)
			fill->taken[index_of(fill, cell)] = 1;
	}
}

void coarse_fill_look(struct coarse_fill *fill, const struct corner_field *field,
		      const struct range_scan *scan)
{
	const double side = 1 << fill->shift;
	/* two lines or more through each cell are enough */
	const double ratio = scan->spacing > 0 ? side * field->cell / scan->spacing : 1;
	const uint32_t every = ratio > 8 ? (uint32_t)(ratio * ratio / 64) + 1 : 1;

	for (uint32_t i = 0; i < scan->count; i++) {
		const struct range_point *point = &scan->points[i];
		double from[3];
		bool known = false;

		spill_pass(i);
		for (int k = 0; k < 3; k++) {
			from[k] = ((point->at[k] - field->origin[k]) / field->cell - fill->low[k]) /
				  side;
			known |= point->towards[k] != 0;
		}
		take(fill, from);
		if (!known || i % every != 0)
			continue;
		for (int k = 0; k < 3; k++)
			from[k] += 1.5 * (double)point->towards[k];
		look(fill, from, point->towards);
	}
}

static bool is_free(const struct coarse_fill *fill, size_t cell)
{
	return fill->looks[cell] >= LOOKS_FREE && !fill->taken[cell];
}

bool coarse_fill_is_free(const struct coarse_fill *fill, const int32_t corner[3])
{
	int32_t cell[3];

	for (int k = 0; k < 3; k++) {
		cell[k] = (corner[k] - fill->low[k]) >> fill->shift;
		if (cell[k] < 0 || cell[k] >= (int32_t)fill->corners[k] - 1)
			return false;
	}
	return is_free(fill, index_of(fill, cell));
}

/* ---- the membrane */

struct seeds {
	float *sum, *weight; /* of each coarse corner */
};

/* Adds a known corner of the field to the eight coarse ones around it. */
static void add_seed(const struct coarse_fill *fill, struct seeds *seeds, const int32_t corner[3],
		     float value)
{
	const float side = (float)(1 << fill->shift);
	int32_t cell[3], at[3];
	float share[3];

	for (int k = 0; k < 3; k++) {
		cell[k] = (corner[k] - fill->low[k]) >> fill->shift;
		share[k] = (float)(corner[k] - fill->low[k]) / side - (float)cell[k];
		if (cell[k] < 0 || cell[k] >= (int32_t)fill->corners[k] - 1)
			return;
	}
	for (int i = 0; i < 8; i++) {
		float weight = 1;
		size_t index;

		for (int k = 0; k < 3; k++) {
			at[k] = cell[k] + (i >> k & 1);
			weight *= i >> k & 1 ? share[k] : 1 - share[k];
		}
		index = index_of(fill, at);
		seeds->sum[index] += weight * value;
		seeds->weight[index] += weight;
	}
}

static void add_field(const struct coarse_fill *fill, struct seeds *seeds,
		      const struct corner_field *field)
{
	for (uint32_t b = 0; b < field->block_count; b++) {
		for (int32_t i = 0; i < FIELD_BLOCK_CORNERS; i++) {
			const struct field_corner *corner = &field->corners[b][i];
			const int32_t in[3] = { i % FIELD_BLOCK_SIDE,
						i / FIELD_BLOCK_SIDE % FIELD_BLOCK_SIDE,
						i / FIELD_BLOCK_SIDE / FIELD_BLOCK_SIDE };
			int32_t at[3];
			float value;

			if (!(corner->weight > 0))
				continue;
			for (int k = 0; k < 3; k++)
				at[k] = field->blocks[b][k] * FIELD_BLOCK_SIDE + in[k];
			value = corner->sum / corner->weight / distance_full;
			add_seed(fill, seeds, at, fmaxf(-1, fminf(1, value)));
		}
		spill_pass(b * 16ull);
	}
}

/* Turns the sums into weighted values, and adds the free corners and the outside. */
static void settle(const struct coarse_fill *fill, struct seeds *seeds)
{
	const int32_t n[3] = { (int32_t)fill->corners[0], (int32_t)fill->corners[1],
			       (int32_t)fill->corners[2] };
	int32_t at[3];

	for (at[2] = 0; at[2] < n[2]; at[2]++)
		for (at[1] = 0; at[1] < n[1]; at[1]++)
			for (at[0] = 0; at[0] < n[0]; at[0]++) {
				const size_t i = index_of(fill, at);
				bool outside = false, free_around = true;

				for (int k = 0; k < 3; k++)
					outside |= at[k] == 0 || at[k] == n[k] - 1;
				for (int c = 0; c < 8 && !outside && free_around; c++) {
					const int32_t cell[3] = { at[0] - (c & 1),
								  at[1] - (c >> 1 & 1),
								  at[2] - (c >> 2) };

					free_around = is_free(fill, index_of(fill, cell));
				}
				if (seeds->weight[i] > 0) {
					const float weight =
						weight_seen * fminf(1, seeds->weight[i]);

					seeds->sum[i] *= weight / seeds->weight[i];
					seeds->weight[i] = weight;
				} else if (free_around && !outside) {
					seeds->sum[i] = seeds->weight[i] = weight_free;
				}
				fill->values[i] = outside ? 1 : 0;
				if (seeds->weight[i] > 0 && !outside)
					fill->values[i] = seeds->sum[i] / seeds->weight[i];
			}
}

/* One sweep of successive over-relaxation. Returns the largest change. */
static float sweep(struct coarse_fill *fill, const struct seeds *seeds, float factor)
{
	const size_t row = fill->corners[0], layer = row * fill->corners[1];
	float *u = fill->values, largest = 0;

	for (uint32_t z = 1; z + 1 < fill->corners[2]; z++)
		for (uint32_t y = 1; y + 1 < fill->corners[1]; y++) {
			size_t i = z * layer + y * row + 1;

			for (uint32_t x = 1; x + 1 < fill->corners[0]; x++, i++) {
				const float around = u[i - 1] + u[i + 1] + u[i - row] + u[i + row] +
						     u[i - layer] + u[i + layer];
				const float wanted =
					(around + seeds->sum[i]) / (6 + seeds->weight[i]);
				const float change = factor * (wanted - u[i]);

				u[i] += change;
				largest = fmaxf(largest, fabsf(change));
			}
		}
	return largest;
}

int coarse_fill_solve(struct coarse_fill *fill, const struct corner_field *field)
{
	const size_t count = corner_count(fill);
	struct seeds seeds = { calloc(count, sizeof(float)), calloc(count, sizeof(float)) };
	uint32_t longest = 0;
	float factor;

	fill->values = calloc(count, sizeof(float));
	if (!fill->values || !seeds.sum || !seeds.weight) {
		free(seeds.sum);
		free(seeds.weight);
		return -ENOMEM;
	}
	add_field(fill, &seeds, field);
	settle(fill, &seeds);
	for (int k = 0; k < 3; k++)
		longest = fill->corners[k] > longest ? fill->corners[k] : longest;
	/* the best factor for an empty box of this size */
	factor = 2 / (1 + sinf(3.14159265f / (float)longest));
	for (int i = 0; i < SWEEPS_MAX && sweep(fill, &seeds, factor) > change_small; i++)
		;
	free(seeds.sum);
	free(seeds.weight);
	return 0;
}

float coarse_fill_at(const struct coarse_fill *fill, const int32_t corner[3])
{
	const float side = (float)(1 << fill->shift);
	int32_t cell[3], at[3];
	float share[3], sum = 0;

	for (int k = 0; k < 3; k++) {
		cell[k] = (corner[k] - fill->low[k]) >> fill->shift;
		if (cell[k] < 0 || cell[k] >= (int32_t)fill->corners[k] - 1)
			return 1;
		share[k] = (float)(corner[k] - fill->low[k]) / side - (float)cell[k];
	}
	for (int i = 0; i < 8; i++) {
		float weight = 1;

		for (int k = 0; k < 3; k++) {
			at[k] = cell[k] + (i >> k & 1);
			weight *= i >> k & 1 ? share[k] : 1 - share[k];
		}
		sum += weight * fill->values[index_of(fill, at)];
	}
	return sum;
}
