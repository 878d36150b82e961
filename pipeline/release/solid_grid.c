/* Fills a grid of bits near triangles, floods the rest from outside, and makes an octree of it. */
#include "pipeline/release/solid_grid.h"

#include <errno.h>
#include <math.h>
#include <stdlib.h>

#include "base/array.h"
#include "geometry/vec.h"

enum {
	RANGE_CELLS = 64, /* a range of fewer cells is tested cell by cell */
	MARGIN_CELLS = 2  /* free cells around the model and its room, where the flood begins */
};

struct solid_grid {
	struct solid_grid_options options;
	float low_m[3];
	int32_t count[3]; /* cells along each axis */
	int32_t ground;   /* cells below this one are lower than an eye may be */
	uint32_t depth;
	size_t row_words;  /* of each row along x; its bits past the last cell are near */
	uint64_t *near;    /* owned; a bit for each cell: a triangle is near */
	uint64_t *reached; /* owned; the flood came here */
	uint8_t *levels[SOLID_DEPTH_MAX + 1]; /* owned; states of cells of 2^level; [0] is unused */
};

static size_t words(const struct solid_grid *grid)
{
	return grid->row_words * (size_t)grid->count[1] * (size_t)grid->count[2];
}

static size_t index_of(const struct solid_grid *grid, int32_t x, int32_t y, int32_t z)
{
	return 64 * grid->row_words * ((size_t)z * (size_t)grid->count[1] + (size_t)y) + (size_t)x;
}

static bool has(const uint64_t *bits, size_t index)
{
	return bits[index / 64] >> index % 64 & 1;
}

static void set(uint64_t *bits, size_t index)
{
	bits[index / 64] |= UINT64_C(1) << index % 64;
}

int solid_grid_create(struct solid_grid **out, const struct solid_grid_options *options)
{
	struct solid_grid *grid = calloc(1, sizeof(*grid));
	const float around_m = options->room_m + MARGIN_CELLS * options->cell_m;
	double cells = 1;
	int32_t most = 2;

	*out = NULL;
	if (!grid)
		return -ENOMEM;
	grid->options = *options;
	for (int axis = 0; axis < 3; axis++) {
		const double side_m = (double)options->box_max_m[axis] -
				      (double)options->box_min_m[axis] + 2 * (double)around_m;
		const double along = ceil(side_m / (double)options->cell_m);

		if (!(along < 1 << SOLID_DEPTH_MAX)) {
			free(grid);
			return -EFBIG;
		}
		grid->low_m[axis] = options->box_min_m[axis] - around_m;
		grid->count[axis] = (int32_t)along;
		cells *= along;
		most = grid->count[axis] > most ? grid->count[axis] : most;
	}
	grid->row_words = ((size_t)grid->count[0] + 63) / 64;
	grid->depth = 32 - (uint32_t)__builtin_clz((uint32_t)most - 1);
	/* An eye stays above the lowest point, by its room. */
	grid->ground = (int32_t)((around_m + options->room_m) / options->cell_m);
	if (cells <= SOLID_GRID_CELLS_MAX) {
		grid->near = calloc(words(grid), sizeof(*grid->near));
		grid->reached = calloc(words(grid), sizeof(*grid->reached));
	}
	if (!grid->near || !grid->reached) {
		solid_grid_destroy(grid);
		return cells <= SOLID_GRID_CELLS_MAX ? -ENOMEM : -EFBIG;
	}
	for (int32_t z = 0; z < grid->count[2]; z++)
		for (int32_t y = 0; y < grid->count[1]; y++)
			for (size_t x = (size_t)grid->count[0]; x < 64 * grid->row_words; x++)
				set(grid->near, index_of(grid, 0, y, z) + x);
	*out = grid;
	return 0;
}

void solid_grid_destroy(struct solid_grid *grid)
{
	if (!grid)
		return;
	free(grid->near);
	free(grid->reached);
	for (uint32_t level = 0; level <= SOLID_DEPTH_MAX; level++)
		free(grid->levels[level]);
	free(grid);
}

/* ---- triangles */

struct triangle {
	float corner[3][3], edge[3][3], normal[3];
};

/* Separating axes: the triangle's plane, and its edges crossed with the box's. The sides of the box
 * are not tried, because the ranges of cells are those that the triangle's own box reaches. */
static bool meets(const struct triangle *t, const float centre[3], const float half[3])
{
	float corner[3][3];

	vec_sub(corner[0], t->corner[0], centre);
	if (fabsf(vec_dot(t->normal, corner[0])) > half[0] * fabsf(t->normal[0]) +
							   half[1] * fabsf(t->normal[1]) +
							   half[2] * fabsf(t->normal[2]))
		return false;
	vec_sub(corner[1], t->corner[1], centre);
	vec_sub(corner[2], t->corner[2], centre);
	for (int e = 0; e < 3; e++) {
		/* Both ends of an edge are at one place along what is perpendicular to it. */
		const float *on = corner[e], *off = corner[(e + 2) % 3];

		for (int x = 0; x < 3; x++) {
			const int y = (x + 1) % 3, z = (x + 2) % 3;
			const float u = t->edge[e][z], v = -t->edge[e][y];
			const float p = u * on[y] + v * on[z], q = u * off[y] + v * off[z];
			const float reach = half[y] * fabsf(u) + half[z] * fabsf(v);

			if (vec_least(p, q) > reach || vec_most(p, q) < -reach)
				return false;
		}
	}
	return true;
}

static bool range_meets(const struct solid_grid *grid, const struct triangle *triangle,
			const int32_t low[3], const int32_t end[3])
{
	const float cell_m = grid->options.cell_m;
	float centre[3], half[3];

	for (int axis = 0; axis < 3; axis++) {
		centre[axis] =
			grid->low_m[axis] + cell_m * ((float)low[axis] + (float)end[axis]) / 2;
		half[axis] = cell_m * (float)(end[axis] - low[axis]) / 2 + grid->options.room_m;
	}
	return meets(triangle, centre, half);
}

static void fill_cells(struct solid_grid *grid, const struct triangle *triangle,
		       const int32_t low[3], const int32_t end[3])
{
	for (int32_t z = low[2]; z < end[2]; z++)
		for (int32_t y = low[1]; y < end[1]; y++)
			for (int32_t x = low[0]; x < end[0]; x++) {
				const int32_t at[3] = { x, y, z };
				const int32_t next[3] = { x + 1, y + 1, z + 1 };
				const size_t index = index_of(grid, x, y, z);

				if (!has(grid->near, index) &&
				    range_meets(grid, triangle, at, next))
					set(grid->near, index);
			}
}

/* Halves a range that the triangle meets until it is small. */
static void fill_range(struct solid_grid *grid, const struct triangle *triangle,
		       const int32_t low[3], const int32_t end[3])
{
	const int32_t side[3] = { end[0] - low[0], end[1] - low[1], end[2] - low[2] };
	int32_t middle_low[3] = { low[0], low[1], low[2] };
	int32_t middle_end[3] = { end[0], end[1], end[2] };
	int longest = side[0] >= side[1] ? 0 : 1;

	if (side[0] <= 0 || side[1] <= 0 || side[2] <= 0)
		return;
	if ((int64_t)side[0] * side[1] * side[2] <= RANGE_CELLS) {
		fill_cells(grid, triangle, low, end);
		return;
	}
	if (!range_meets(grid, triangle, low, end))
		return;
	longest = side[2] > side[longest] ? 2 : longest;
	middle_low[longest] = middle_end[longest] = low[longest] + side[longest] / 2;
	fill_range(grid, triangle, low, middle_end);
	fill_range(grid, triangle, middle_low, end);
}

static int32_t cell_at(const struct solid_grid *grid, int axis, float at_m)
{
	const float at = (at_m - grid->low_m[axis]) / grid->options.cell_m;

	return at >= 0 ? at < (float)grid->count[axis] ? (int32_t)at : grid->count[axis] - 1 : 0;
}

void solid_grid_add(struct solid_grid *grid, const float corners_m[3][3])
{
	const float room_m = grid->options.room_m;
	struct triangle triangle;
	int32_t low[3], end[3];

	for (int i = 0; i < 3; i++) {
		vec_copy(triangle.corner[i], corners_m[i]);
		vec_sub(triangle.edge[i], corners_m[(i + 1) % 3], corners_m[i]);
	}
	vec_cross(triangle.normal, triangle.edge[0], triangle.edge[1]);
	for (int axis = 0; axis < 3; axis++) {
		const float a = corners_m[0][axis], b = corners_m[1][axis], c = corners_m[2][axis];

		low[axis] = cell_at(grid, axis, vec_least(a, vec_least(b, c)) - room_m);
		end[axis] = cell_at(grid, axis, vec_most(a, vec_most(b, c)) + room_m) + 1;
	}
	fill_range(grid, &triangle, low, end);
}

/* ---- what can be reached */

static bool is_open(const struct solid_grid *grid, const int32_t at[3])
{
	if (at[2] < grid->ground)
		return false;
	for (int axis = 0; axis < 3; axis++)
		if (at[axis] < 0 || at[axis] >= grid->count[axis])
			return false;
	return !has(grid->near, index_of(grid, at[0], at[1], at[2]));
}

/* Spreads bits to the next ones as far as `open` is set, upwards and downwards: each step doubles
 * how far. */
static uint64_t spread_up(uint64_t bits, uint64_t open)
{
	for (int step = 1; step < 64; step *= 2) {
		bits |= open & bits << step;
		open &= open << step;
	}
	return bits;
}

static uint64_t spread_down(uint64_t bits, uint64_t open)
{
	for (int step = 1; step < 64; step *= 2) {
		bits |= open & bits >> step;
		open &= open >> step;
	}
	return bits;
}

/* Reaches the cells of a row that are open and beside a cell that was reached, in the row or in the
 * four around it. Returns whether there were any. */
static bool reach_row(struct solid_grid *grid, int32_t y, int32_t z)
{
	const size_t row = index_of(grid, 0, y, z) / 64, line = grid->row_words;
	const size_t layer = line * (size_t)grid->count[1];
	uint64_t *reached = grid->reached + row, carry = 0, changed = 0;
	const uint64_t *near = grid->near + row;

	for (size_t w = 0; w < line; w++) {
		uint64_t bits = reached[w];

		bits |= y > 0 ? reached[w - line] : 0;
		bits |= y + 1 < grid->count[1] ? reached[w + line] : 0;
		bits |= z > grid->ground ? reached[w - layer] : 0;
		bits |= z + 1 < grid->count[2] ? reached[w + layer] : 0;
		bits = spread_up((bits | carry) & ~near[w], ~near[w]);
		carry = bits >> 63;
		changed |= bits ^ reached[w];
		reached[w] = bits;
	}
	carry = 0;
	for (size_t w = line; w-- > 0;) {
		const uint64_t bits = spread_down(reached[w] | (carry << 63 & ~near[w]), ~near[w]);

		carry = bits & 1;
		changed |= bits ^ reached[w];
		reached[w] = bits;
	}
	return changed != 0;
}

/* Reaches all that can be reached from what was, in sweeps over all rows, forth and back. */
static void flood(struct solid_grid *grid)
{
	bool changed = true;

	while (changed) {
		changed = false;
		for (int32_t z = grid->ground; z < grid->count[2]; z++)
			for (int32_t y = 0; y < grid->count[1]; y++)
				changed |= reach_row(grid, y, z);
		for (int32_t z = grid->count[2]; changed && z-- > grid->ground;)
			for (int32_t y = grid->count[1]; y-- > 0;)
				reach_row(grid, y, z);
	}
}

void solid_grid_open(struct solid_grid *grid, const float eye_m[3])
{
	/* How far from an eye its free cell may be: as far as its own room. */
	const int32_t most = (int32_t)ceilf(grid->options.room_m / grid->options.cell_m) + 1;
	int32_t place[3], best[3] = { -1, -1, -1 };
	int32_t nearest = INT32_MAX;

	for (int axis = 0; axis < 3; axis++) {
		place[axis] = cell_at(grid, axis, eye_m[axis]);
		if (eye_m[axis] < grid->low_m[axis] ||
		    eye_m[axis] >=
			    grid->low_m[axis] + grid->options.cell_m * (float)grid->count[axis])
			return; /* outside of the grid all is free */
	}
	for (int32_t dz = -most; dz <= most; dz++)
		for (int32_t dy = -most; dy <= most; dy++)
			for (int32_t dx = -most; dx <= most; dx++) {
				const int32_t at[3] = { place[0] + dx, place[1] + dy,
							place[2] + dz };
				const int32_t square = dx * dx + dy * dy + dz * dz;

				if (square >= nearest || !is_open(grid, at))
					continue;
				nearest = square;
				for (int axis = 0; axis < 3; axis++)
					best[axis] = at[axis];
			}
	if (nearest < INT32_MAX)
		set(grid->reached, index_of(grid, best[0], best[1], best[2]));
}

/* ---- the tree */

static int32_t count_at(const struct solid_grid *grid, uint32_t level, int axis)
{
	return (grid->count[axis] + (1 << level) - 1) >> level;
}

/* What is outside of the grid is free. */
static enum solid_state state_at(const struct solid_grid *grid, uint32_t level, const int32_t at[3])
{
	for (int axis = 0; axis < 3; axis++)
		if (at[axis] >= count_at(grid, level, axis))
			return SOLID_FREE;
	if (level == 0)
		return has(grid->reached, index_of(grid, at[0], at[1], at[2])) ? SOLID_FREE
									       : SOLID_FULL;
	return (enum solid_state)grid
		->levels[level][((size_t)at[2] * (size_t)count_at(grid, level, 1) + (size_t)at[1]) *
					(size_t)count_at(grid, level, 0) +
				(size_t)at[0]];
}

static uint32_t states_of(const struct solid_grid *grid, uint32_t level, const int32_t at[3])
{
	uint32_t states = 0;

	for (int child = 0; child < SOLID_CHILDREN; child++) {
		const int32_t place[3] = { 2 * at[0] + (child & 1), 2 * at[1] + (child >> 1 & 1),
					   2 * at[2] + (child >> 2 & 1) };

		states |= (uint32_t)state_at(grid, level - 1, place) << 2 * child;
	}
	return states;
}

/* Makes a row of level 1 from the four rows of cells below it, 32 pairs of cells at a time. */
static void make_first_row(const struct solid_grid *grid, int32_t y, int32_t z, uint8_t *out)
{
	const int32_t count = count_at(grid, 1, 0);

	for (int32_t x = 0; x < count; x += 32) {
		/* Cells outside of the grid are free, as if they were reached. */
		const int32_t left = grid->count[0] - 2 * x;
		const uint64_t outside = left < 64 ? UINT64_MAX << left : 0;
		uint64_t all = UINT64_MAX, any = outside;

		for (int row = 0; row < 4; row++) {
			const int32_t below_y = 2 * y + row % 2, below_z = 2 * z + row / 2;
			uint64_t bits = UINT64_MAX;

			if (below_y < grid->count[1] && below_z < grid->count[2])
				bits = grid->reached[index_of(grid, 2 * x, below_y, below_z) / 64] |
				       outside;
			all &= bits;
			any |= bits;
		}
		for (int32_t i = 0; i < 32 && x + i < count; i++)
			*out++ = (all >> 2 * i & 3) == 3   ? SOLID_FREE
				 : (any >> 2 * i & 3) == 0 ? SOLID_FULL
							   : SOLID_DIVIDED;
	}
}

static int make_level(struct solid_grid *grid, uint32_t level)
{
	const int32_t nx = count_at(grid, level, 0), ny = count_at(grid, level, 1);
	const int32_t nz = count_at(grid, level, 2);
	uint8_t *state = malloc((size_t)nx * (size_t)ny * (size_t)nz);

	grid->levels[level] = state;
	if (!state)
		return -ENOMEM;
	for (int32_t z = 0; z < nz; z++)
		for (int32_t y = 0; y < ny; y++) {
			if (level == 1) {
				make_first_row(grid, y, z, state);
				state += nx;
				continue;
			}
			for (int32_t x = 0; x < nx; x++) {
				const int32_t at[3] = { x, y, z };
				const uint32_t states = states_of(grid, level, at);

				*state++ = states == 0        ? SOLID_FREE
					   : states == 0x5555 ? SOLID_FULL
							      : SOLID_DIVIDED;
			}
		}
	return 0;
}

struct nodes {
	struct solid_node *list; /* owned, until the tree takes it */
	int32_t (*places)[3];    /* owned; of each, on its level */
	uint32_t count, room, place_room;
};

static int add_node(struct nodes *nodes, const int32_t place[3])
{
	if (nodes->count == SOLID_NODES_MAX)
		return -EFBIG;
	if (ARRAY_RESERVE(nodes->list, nodes->room, nodes->count + 1, UINT32_MAX) < 0 ||
	    ARRAY_RESERVE(nodes->places, nodes->place_room, nodes->count + 1, UINT32_MAX) < 0)
		return -ENOMEM;
	for (int axis = 0; axis < 3; axis++)
		nodes->places[nodes->count][axis] = place[axis];
	nodes->count++;
	return 0;
}

/* Adds the nodes level by level; those of the next are added while one is looked at. */
static int make_nodes(const struct solid_grid *grid, struct nodes *nodes)
{
	const int32_t root[3] = { 0, 0, 0 };
	int rc = add_node(nodes, root);
	uint32_t at = 0;

	for (uint32_t level = grid->depth; rc == 0 && level > 0; level--)
		for (const uint32_t end = nodes->count; rc == 0 && at < end; at++) {
			const int32_t *p = nodes->places[at];
			const int32_t place[3] = { p[0], p[1], p[2] };
			const uint32_t states = states_of(grid, level, place);

			nodes->list[at] = (struct solid_node){ .first = nodes->count,
							       .states = (uint16_t)states };
			for (int child = 0; rc == 0 && child < SOLID_CHILDREN; child++) {
				const int32_t below[3] = { 2 * place[0] + (child & 1),
							   2 * place[1] + (child >> 1 & 1),
							   2 * place[2] + (child >> 2 & 1) };

				if ((states >> 2 * child & 3) == SOLID_DIVIDED)
					rc = add_node(nodes, below);
			}
		}
	return rc;
}

int solid_grid_tree(struct solid_grid *grid, struct solid *out)
{
	struct nodes nodes = { 0 };
	int rc = 0;

	*out = (struct solid){ 0 };
	set(grid->reached, index_of(grid, 0, 0, grid->count[2] - 1));
	flood(grid);
	for (uint32_t level = 1; rc == 0 && level < grid->depth; level++)
		rc = make_level(grid, level);
	if (rc == 0)
		rc = make_nodes(grid, &nodes);
	free(nodes.places);
	if (rc < 0) {
		free(nodes.list);
		return rc;
	}
	*out = (struct solid){ .cell_m = grid->options.cell_m,
			       .room_m = grid->options.room_m,
			       .depth = grid->depth,
			       .node_count = nodes.count,
			       .nodes = nodes.list };
	vec_copy(out->low_m, grid->low_m);
	return 0;
}
