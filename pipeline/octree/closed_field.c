/* Marks the corners that are wanted, works their distances out, and goes on where the sign
 * changes. */
#include "pipeline/octree/closed_field.h"

#include <errno.h>
#include <math.h>
#include <stdlib.h>

#include "base/array.h"
#include "base/parallel.h"
#include "base/progress.h"
#include "base/spill.h"
#include "geometry/vec.h"

/* Weights of corners: asked for; worked out in this round; and before. */
static const float wanted = -1, fresh = 0.5f, known = 1;
/* A triangle may cross a cube whose middle is nearer, in cells: half the cube's diagonal. */
static const float cross_reach = 0.8661f;
/* A triangle in the side of a cube crosses the cubes on both sides of it. */
static const float touch = 0.01f;
/* Triangles are cut until their edges are no longer, in cells. */
static const float cut_edge = 3;

/* How thick a sheet becomes, backwards, in cells: as little as cubes can show. */
static const float sheet_cells = 1.5f;
/* A place is behind a triangle if the way to it is not farther from the normal. */
static const float behind_cosine = 0.7f;

enum { RANGE_BLOCKS = 8 };

struct filling {
	struct corner_field *field;
	const struct triangle_tree *tree;
	uint32_t *blocks; /* that have wanted corners; owned */
	uint32_t block_count, room;
	uint8_t *listed; /* of each block of the field: it is among these; owned */
	uint32_t listed_room;
	uint64_t wanted_count; /* corners so far */
	struct progress *progress;
};

/* ---- what is wanted */

static int list_block(struct filling *filling, uint32_t block)
{
	int rc = 0;

	if (block >= filling->listed_room) {
		const uint32_t room = block + block / 2 + 1024;

		rc = SPILL_RESIZE(filling->listed, filling->listed_room, room);
		if (rc < 0)
			return rc;
		filling->listed_room = room;
	}
	if (filling->listed[block])
		return 0;
	rc = ARRAY_RESERVE(filling->blocks, filling->room, filling->block_count + 1,
			   FIELD_BLOCKS_MAX);
	if (rc == 0) {
		filling->listed[block] = 1;
		filling->blocks[filling->block_count++] = block;
	}
	return rc;
}

/* Asks for the corners of the cube at `cube`. */
static int want_cube(struct filling *filling, const int32_t cube[3])
{
	int rc = 0;

	for (int i = 0; i < 8 && rc == 0; i++) {
		const int32_t at[3] = { cube[0] + (i & 1), cube[1] + (i >> 1 & 1),
					cube[2] + (i >> 2) };
		struct field_corner *corner;
		uint32_t block;

		rc = corner_field_want(filling->field, at, &block, &corner);
		if (rc < 0 || corner->weight != 0)
			continue;
		corner->weight = wanted;
		filling->wanted_count++;
		rc = list_block(filling, block);
	}
	return rc;
}

static float edge_squared(const float a[3], const float b[3])
{
	float edge[3];

	vec_sub(edge, b, a);
	return vec_dot(edge, edge);
}

/* Asks for the cubes that a triangle, in cells, may cross. */
static int want_around(struct filling *filling, const float (*corners)[3])
{
	int32_t low[3], high[3], cube[3];
	int rc = 0;

	for (int k = 0; k < 3; k++) {
		low[k] = (int32_t)floorf(
			vec_least(corners[0][k], vec_least(corners[1][k], corners[2][k])) - touch);
		high[k] = (int32_t)floorf(
			vec_most(corners[0][k], vec_most(corners[1][k], corners[2][k])) + touch);
	}
	for (cube[2] = low[2]; cube[2] <= high[2]; cube[2]++)
		for (cube[1] = low[1]; cube[1] <= high[1]; cube[1]++)
			for (cube[0] = low[0]; cube[0] <= high[0] && rc == 0; cube[0]++) {
				const float middle[3] = { (float)cube[0] + 0.5f,
							  (float)cube[1] + 0.5f,
							  (float)cube[2] + 0.5f };

				if (triangle_is_near(corners, middle, cross_reach))
					rc = want_cube(filling, cube);
			}
	return rc;
}

/* The same, after cutting the triangle in two at its longest edge while that is long. */
static int want_triangle(struct filling *filling, const float (*corners)[3])
{
	float halves[2][3][3];
	float longest = 0;
	int edge = 0, rc = 0;

	for (int i = 0; i < 3; i++) {
		const float squared = edge_squared(corners[i], corners[(i + 1) % 3]);

		if (squared > longest) {
			longest = squared;
			edge = i;
		}
	}
	if (!(longest > cut_edge * cut_edge))
		return want_around(filling, corners);
	for (int half = 0; half < 2 && rc == 0; half++) {
		for (int i = 0; i < 3; i++)
			vec_copy(halves[half][i], corners[i]);
		vec_mix(halves[half][half ? edge : (edge + 1) % 3], corners[edge],
			corners[(edge + 1) % 3], 0.5f);
		rc = want_triangle(filling, (const float(*)[3])halves[half]);
	}
	return rc;
}

static int want_mesh(struct filling *filling)
{
	const struct corner_field *field = filling->field;
	const struct triangle_tree *tree = filling->tree;
	int rc = 0;

	for (uint32_t t = 0; t < tree->triangle_count && rc == 0; t++) {
		float corners[3][3];

		for (int i = 0; i < 3; i++)
			for (int k = 0; k < 3; k++)
				corners[i][k] = (float)(((double)tree->corners[t][i][k] -
							 field->origin[k]) /
							field->cell);
		rc = want_triangle(filling, (const float(*)[3])corners);
		spill_pass(t);
	}
	return rc;
}

/* ---- distances */

static void place_of(float out[3], const struct corner_field *field, uint32_t block, int32_t i)
{
	const int32_t in[3] = { i % FIELD_BLOCK_SIDE, i / FIELD_BLOCK_SIDE % FIELD_BLOCK_SIDE,
				i / FIELD_BLOCK_SIDE / FIELD_BLOCK_SIDE };

	for (int k = 0; k < 3; k++)
		out[k] =
			(float)(field->origin[k] +
				field->cell * (field->blocks[block][k] * FIELD_BLOCK_SIDE + in[k]));
}

/* Returns whether a place is behind the nearest place of a triangle. Beside the rim of a sheet
 * nothing is behind it. */
static bool is_behind(const struct filling *filling, const float at[3],
		      const struct triangle_place *place)
{
	float normal[3], off[3];

	triangle_tree_normal(filling->tree, place, normal, off);
	vec_sub(off, off, at);
	return vec_dot(off, normal) > behind_cosine * place->distance;
}

/* Returns how far a place is outside the box of the mesh, in cells; below 0: inside. */
static float outside_box(const struct filling *filling, const float at[3])
{
	const struct bvh_node *box = &filling->tree->nodes[0];
	float most = -INFINITY;

	for (int k = 0; k < 3; k++)
		most = vec_most(most, vec_most(box->low[k] - at[k], at[k] - box->high[k]));
	return most / (float)filling->field->cell;
}

/* An edge that a triangle crosses has both ends within a cell of it. Where the sign changes farther
 * away, in a hole, the winding number itself says where, but not outside the box: below the ground
 * nothing is known. Just behind a triangle is matter, even if it encloses nothing. */
static float value_at(const struct filling *filling, const float at[3])
{
	const double outside = 0.5 - triangle_tree_winding(filling->tree, at);
	const float cell = (float)filling->field->cell;
	float value = (float)fmax(-1, fmin(1, 2 * outside)), distance;
	struct triangle_place place;
	const bool is_near =
		triangle_tree_nearest(filling->tree, at, (sheet_cells + 1) * cell, &place);

	distance = is_near ? place.distance / cell : INFINITY;
	if (distance < 1)
		value = copysignf(distance, (float)outside);
	value = fmaxf(value, fminf(1, outside_box(filling, at)));
	if (value >= 0 && is_near && is_behind(filling, at, &place))
		value = fminf(value, fmaxf(-distance, distance - sheet_cells));
	return value;
}

static int work_out(void *user, uint32_t first, uint32_t after, uint32_t worker)
{
	const struct filling *filling = user;

	(void)worker;
	for (uint32_t b = first; b < after; b++) {
		const uint32_t block = filling->blocks[b];
		uint32_t done = 0;

		for (int32_t i = 0; i < FIELD_BLOCK_CORNERS; i++) {
			struct field_corner *corner = &filling->field->corners[block][i];
			float at[3];

			if (corner->weight != wanted)
				continue;
			place_of(at, filling->field, block, i);
			corner->weight = fresh;
			corner->sum = fresh * value_at(filling, at);
			done++;
		}
		progress_add(filling->progress, done);
	}
	spill_breathe();
	return 0;
}

/* ---- where the sign changes */

static const struct field_corner *corner_at(const struct corner_field *field, const int32_t at[3])
{
	const int32_t mask = FIELD_BLOCK_SIDE - 1;
	int32_t block[3];
	uint32_t found;

	for (int k = 0; k < 3; k++)
		block[k] = at[k] >> FIELD_BLOCK_SHIFT;
	found = corner_field_find(field, block);
	return found == UINT32_MAX
		       ? NULL
		       : &field->corners[found]
					[((at[2] & mask) * FIELD_BLOCK_SIDE + (at[1] & mask)) *
						 FIELD_BLOCK_SIDE +
					 (at[0] & mask)];
}

/* Asks for the four cubes around the edge from at to its neighbour along axis, the higher one if
 * step is 1. */
static int want_edge(struct filling *filling, const int32_t at[3], int axis, int32_t step)
{
	const int b = (axis + 1) % 3, c = (axis + 2) % 3;
	int rc = 0;

	for (int i = 0; i < 4 && rc == 0; i++) {
		int32_t cube[3];

		cube[axis] = at[axis] - (step < 0);
		cube[b] = at[b] - (i & 1);
		cube[c] = at[c] - (i >> 1);
		rc = want_cube(filling, cube);
	}
	return rc;
}

/* Looks at the six neighbours of a corner that was just worked out. */
static int follow_corner(struct filling *filling, const int32_t at[3], bool is_inside)
{
	int rc = 0;

	for (int i = 0; i < 6 && rc == 0; i++) {
		const int32_t step = i % 2 ? 1 : -1;
		const struct field_corner *other;
		int32_t next[3] = { at[0], at[1], at[2] };

		next[i / 2] += step;
		other = corner_at(filling->field, next);
		if (other && other->weight > 0 && (other->sum < 0) != is_inside)
			rc = want_edge(filling, at, i / 2, step);
	}
	return rc;
}

/* Ends the round of these blocks, and asks for what the next one needs. */
static int follow(struct filling *filling, const uint32_t *blocks, uint32_t count)
{
	struct corner_field *field = filling->field;
	int rc = 0;

	for (uint32_t b = 0; b < count && rc == 0; b++) {
		for (int32_t i = 0; i < FIELD_BLOCK_CORNERS && rc == 0; i++) {
			const int32_t in[3] = { i % FIELD_BLOCK_SIDE,
						i / FIELD_BLOCK_SIDE % FIELD_BLOCK_SIDE,
						i / FIELD_BLOCK_SIDE / FIELD_BLOCK_SIDE };
			struct field_corner *corner = &field->corners[blocks[b]][i];
			int32_t at[3];

			if (corner->weight != fresh)
				continue;
			corner->sum *= known / fresh;
			corner->weight = known;
			for (int k = 0; k < 3; k++)
				at[k] = field->blocks[blocks[b]][k] * FIELD_BLOCK_SIDE + in[k];
			rc = follow_corner(filling, at, corner->sum < 0);
		}
		spill_pass(b * 64ull);
	}
	return rc;
}

static int round_of(struct filling *filling)
{
	const uint32_t count = filling->block_count;
	uint32_t *blocks = filling->blocks;
	int rc = parallel_ranges(parallel_cores(), count, RANGE_BLOCKS, work_out, filling);

	for (uint32_t b = 0; b < count; b++)
		filling->listed[blocks[b]] = 0;
	filling->blocks = NULL;
	filling->block_count = filling->room = 0;
	if (rc == 0)
		rc = follow(filling, blocks, count);
	free(blocks);
	return rc;
}

int closed_field_fill(struct corner_field *field, const struct triangle_tree *tree)
{
	struct filling filling = { .field = field, .tree = tree };
	int rc = want_mesh(&filling);

	filling.progress = progress_start("closing", "corners", filling.wanted_count);
	while (rc == 0 && filling.block_count > 0) {
		progress_set_total(filling.progress, filling.wanted_count);
		rc = round_of(&filling);
	}
	progress_end(filling.progress);
	free(filling.blocks);
	spill_free(filling.listed);
	return rc;
}
