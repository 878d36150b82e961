/* Walks through the octree of where an eye may be: along rays from cell to cell, and outwards from
 * a point to the nearest free cell. */
#include "geometry/solid_space.h"

#include <math.h>

#include "geometry/vec.h"

#define INSET 0.01 /* of a smallest cell: how far inside of a free cell the nearest point is */

/* Converts metres to smallest cells from the root's corner. */
static void to_cells(const struct solid *solid, const float point_m[3], double out[3])
{
	for (int axis = 0; axis < 3; axis++)
		out[axis] = ((double)point_m[axis] - (double)solid->low_m[axis]) /
			    (double)solid->cell_m;
}

static double within(double value, double least, double most)
{
	return value < least ? least : value > most ? most : value;
}

bool solid_is_free(const struct solid *solid, const float point_m[3])
{
	const double side = 1 << solid->depth;
	struct solid_cell cell;
	double point[3];
	int32_t place[3];

	to_cells(solid, point_m, point);
	for (int axis = 0; axis < 3; axis++) {
		if (!(point[axis] >= 0 && point[axis] < side))
			return true;
		place[axis] = (int32_t)point[axis];
	}
	solid_find(solid, place, &cell);
	return cell.state == SOLID_FREE;
}

/* ---- rays */

struct ray {
	double from[3], direction[3]; /* in cells */
	int32_t place[3];             /* the smallest cell where it is */
	double at;                    /* how far it is */
	int axis;                     /* along which it came into its cell; -1: it began there */
};

/* Moves the ray to where it enters the root cell. Returns false if it misses. */
static bool ray_enter(struct ray *ray, double side)
{
	double leaves = INFINITY;

	ray->at = 0;
	ray->axis = -1;
	for (int axis = 0; axis < 3; axis++) {
		const double from = ray->from[axis], d = ray->direction[axis];
		double in, out;

		if (fabs(d) < 1e-12) {
			if (!(from >= 0 && from < side))
				return false;
			continue;
		}
		in = ((d > 0 ? 0 : side) - from) / d;
		out = ((d > 0 ? side : 0) - from) / d;
		if (in > ray->at) {
			ray->at = in;
			ray->axis = axis;
		}
		leaves = fmin(leaves, out);
	}
	if (!(ray->at < leaves))
		return false;
	for (int axis = 0; axis < 3; axis++)
		ray->place[axis] = (int32_t)within(
			floor(ray->from[axis] + ray->at * ray->direction[axis]), 0, side - 1);
	return true;
}

/* Moves the ray out of a cell into the next one. Returns false if it leaves the root cell. */
static bool ray_next(struct ray *ray, const struct solid_cell *cell, double side)
{
	double least = INFINITY;
	int32_t next;

	for (int axis = 0; axis < 3; axis++) {
		const double d = ray->direction[axis];
		double out;

		if (fabs(d) < 1e-12)
			continue;
		out = ((d > 0 ? cell->low[axis] + cell->side : cell->low[axis]) - ray->from[axis]) /
		      d;
		if (out < least) {
			least = out;
			ray->axis = axis;
		}
	}
	ray->at = fmax(ray->at, least);
	for (int axis = 0; axis < 3; axis++)
		ray->place[axis] =
			(int32_t)within(floor(ray->from[axis] + ray->at * ray->direction[axis]),
					cell->low[axis], cell->low[axis] + cell->side - 1);
	next = ray->direction[ray->axis] > 0 ? cell->low[ray->axis] + cell->side
					     : cell->low[ray->axis] - 1;
	ray->place[ray->axis] = next;
	return next >= 0 && next < side;
}

float solid_reach(const struct solid *solid, const float from_m[3], const float direction[3],
		  float most_m, int *axis)
{
	const double side = 1 << solid->depth, most = (double)most_m / (double)solid->cell_m;
	struct ray ray;
	bool inside;

	if (axis)
		*axis = -1;
	to_cells(solid, from_m, ray.from);
	for (int i = 0; i < 3; i++) {
		ray.direction[i] = (double)direction[i];
		if (!isfinite(ray.from[i]) || !isfinite(ray.direction[i]))
			return 0;
	}
	/* Asked apart, because a ray that begins in a side of the root may miss it. */
	if (!solid_is_free(solid, from_m))
		return 0;
	if (vec_dot(direction, direction) < 0.5f)
		return INFINITY;
	inside = ray_enter(&ray, side);
	while (inside && ray.at <= most) {
		struct solid_cell cell;

		solid_find(solid, ray.place, &cell);
		if (cell.state == SOLID_FULL) {
			if (axis)
				*axis = ray.axis;
			return (float)(ray.at * (double)solid->cell_m);
		}
		inside = ray_next(&ray, &cell, side);
	}
	return INFINITY;
}

bool solid_way_is_free(const struct solid *solid, const float from_m[3], const float to_m[3])
{
	float way[3], length;

	vec_sub(way, to_m, from_m);
	length = vec_normalise(way);
	return isinf(solid_reach(solid, from_m, way, length, NULL)) && solid_is_free(solid, to_m);
}

/* ---- the nearest free point */

struct nearest {
	const struct solid *solid;
	double point[3]; /* in cells */
	double square;   /* of the distance to the nearest so far */
	double found[3];
	bool is_found;
};

static double square_to_box(const double point[3], const int32_t low[3], int32_t side,
			    double nearest[3])
{
	double sum = 0;

	for (int axis = 0; axis < 3; axis++) {
		nearest[axis] = within(point[axis], low[axis] + INSET, low[axis] + side - INSET);
		sum += (point[axis] - nearest[axis]) * (point[axis] - nearest[axis]);
	}
	return sum;
}

static void search(struct nearest *nearest, uint32_t at, const int32_t low[3], int32_t side)
{
	const struct solid_node *node = &nearest->solid->nodes[at];
	const int32_t half = side / 2;
	uint32_t first = 0;

	/* The child on the point's side of each middle comes first: the others are then mostly
	 * farther than what it found. */
	for (uint32_t axis = 0; axis < 3; axis++)
		first |= (uint32_t)(nearest->point[axis] >= low[axis] + half) << axis;
	for (uint32_t i = 0; i < SOLID_CHILDREN; i++) {
		const uint32_t child = i ^ first;
		const enum solid_state state = solid_child_state(node, child);
		int32_t corner[3];
		double place[3], square;

		if (state == SOLID_FULL)
			continue;
		for (uint32_t axis = 0; axis < 3; axis++)
			corner[axis] = low[axis] + (child >> axis & 1 ? half : 0);
		square = square_to_box(nearest->point, corner, half, place);
		if (square >= nearest->square)
			continue;
		if (state == SOLID_DIVIDED) {
			search(nearest, solid_child_node(node, child), corner, half);
			continue;
		}
		nearest->square = square;
		nearest->is_found = true;
		for (int axis = 0; axis < 3; axis++)
			nearest->found[axis] = place[axis];
	}
}

bool solid_nearest_free(const struct solid *solid, const float point_m[3], float most_m,
			float out_m[3])
{
	const double most = (double)most_m / (double)solid->cell_m;
	struct nearest nearest = { .solid = solid, .square = most * most };
	const int32_t low[3] = { 0, 0, 0 };

	vec_copy(out_m, point_m);
	if (solid_is_free(solid, point_m))
		return true;
	to_cells(solid, point_m, nearest.point);
	search(&nearest, 0, low, 1 << solid->depth);
	for (int axis = 0; nearest.is_found && axis < 3; axis++)
		out_m[axis] = (float)(nearest.found[axis] * (double)solid->cell_m +
				      (double)solid->low_m[axis]);
	return nearest.is_found;
}
