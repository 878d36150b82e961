/* Orients the points of a range image by their neighbours on the grid. */
#include "pipeline/octree/range_grid.h"

#include <errno.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/spill.h"
#include "geometry/vec.h"

/* An edge longer than so many median distances crosses a step in depth. */
static const double step_edges = 5;
/* A surface seen at a flatter angle than this cosine is not trusted. */
static const float grazing = 0.1f;
/* Scanners err at the rim of what they see: that many cells from it weigh less. */
enum { RIM_CELLS = 3 };
/* Share of the variance that a plane must explain. */
static const double even = 0.9;

/* ---- lines of sight */

/* Sums for the least squares plane value = a column + b row + c. */
struct plane {
	double count, c, r, cc, cr, rr, v[3], cv[3], rv[3], vv[3];
};

static void plane_add(struct plane *p, double column, double row, const double at[3])
{
	p->count++;
	p->c += column;
	p->r += row;
	p->cc += column * column;
	p->cr += column * row;
	p->rr += row * row;
	for (int k = 0; k < 3; k++) {
		p->v[k] += at[k];
		p->cv[k] += column * at[k];
		p->rv[k] += row * at[k];
		p->vv[k] += at[k] * at[k];
	}
}

/* Returns the share of coordinate k's variance that the plane explains. */
static double explained(const struct plane *p, int k)
{
	const double n = p->count, cc = p->cc - p->c * p->c / n, rr = p->rr - p->r * p->r / n;
	const double cr = p->cr - p->c * p->r / n, cv = p->cv[k] - p->c * p->v[k] / n;
	const double rv = p->rv[k] - p->r * p->v[k] / n, vv = p->vv[k] - p->v[k] * p->v[k] / n;
	const double determinant = cc * rr - cr * cr;

	if (!(determinant > 0) || !(vv > 0))
		return 0;
	return ((cv * rr - rv * cr) * cv + (rv * cc - cv * cr) * rv) / determinant / vv;
}

enum range_sight range_grid_sight(const struct range_grid *grid, const struct range_point *points)
{
	double share[3], origin[3] = { 0 };
	struct plane plane = { 0 };
	int along = 0;

	for (uint64_t i = 0; i < (uint64_t)grid->columns * grid->rows; i++) {
		double place[3];

		spill_pass(i);
		if (grid->cells[i] == RANGE_NO_POINT)
			continue;
		/* Sums of squares far from the origin lose digits. */
		if (plane.count == 0)
			memcpy(origin, points[grid->cells[i]].at, sizeof(origin));
		for (int k = 0; k < 3; k++)
			place[k] = points[grid->cells[i]].at[k] - origin[k];
		plane_add(&plane, (double)(i % grid->columns), (double)(i / grid->columns), place);
	}
	for (int k = 0; k < 3; k++) {
		share[k] = plane.count > 2 ? explained(&plane, k) : 0;
		if (share[k] < share[along])
			along = k;
	}
	for (int k = 0; k < 3; k++)
		if (k != along && share[k] < even)
			return RANGE_SIGHT_ORIGIN;
	return (enum range_sight)(RANGE_SIGHT_PLUS_X + along);
}

/* ---- neighbours */

static uint32_t cell_at(const struct range_grid *grid, int64_t column, int64_t row)
{
	if (column < 0 || row < 0 || column >= grid->columns || row >= grid->rows)
		return RANGE_NO_POINT;
	return grid->cells[(uint64_t)row * grid->columns + (uint64_t)column];
}

static double distance(const struct range_point *a, const struct range_point *b)
{
	double sum = 0;

	for (int k = 0; k < 3; k++)
		sum += (a->at[k] - b->at[k]) * (a->at[k] - b->at[k]);
	return sqrt(sum);
}

static int compare_floats(const void *a, const void *b)
{
	const float x = *(const float *)a, y = *(const float *)b;

	return (x > y) - (x < y);
}

/* Finds the median distance to the next point in the row and in the column. */
static int median_spacing(double *out, const struct range_grid *grid,
			  const struct range_point *points)
{
	const uint64_t cells = (uint64_t)grid->columns * grid->rows, step = 1 + cells / 100000;
	float *lengths = malloc(2 * (cells / step + 1) * sizeof(*lengths));
	size_t count = 0;

	if (!lengths)
		return -ENOMEM;
	for (uint64_t i = 0; i < cells; i += step) {
		const int64_t column = (int64_t)(i % grid->columns),
			      row = (int64_t)(i / grid->columns);
		const uint32_t here = grid->cells[i];

		for (int k = 0; k < 2 && here != RANGE_NO_POINT; k++) {
			const uint32_t next = cell_at(grid, column + (k == 0), row + (k == 1));

			if (next != RANGE_NO_POINT)
				lengths[count++] = (float)distance(&points[here], &points[next]);
		}
	}
	qsort(lengths, count, sizeof(*lengths), compare_floats);
	*out = count > 0 ? (double)lengths[count / 2] : 0;
	free(lengths);
	return 0;
}

/* Adds the normal of the triangle of a point and two neighbours, of a length that is twice its
 * area. */
static bool add_triangle(double normal[3], float *farthest, const struct range_point *at,
			 const struct range_point *a, const struct range_point *b, double longest)
{
	const double first = distance(at, a), second = distance(at, b);
	double u[3], v[3], n[3], facing = 0;

	if (first > longest || second > longest || distance(a, b) > longest)
		return false;
	for (int k = 0; k < 3; k++) {
		u[k] = a->at[k] - at->at[k];
		v[k] = b->at[k] - at->at[k];
	}
	for (int k = 0; k < 3; k++) {
		n[k] = u[(k + 1) % 3] * v[(k + 2) % 3] - u[(k + 2) % 3] * v[(k + 1) % 3];
		facing += n[k] * (double)at->towards[k];
	}
	for (int k = 0; k < 3; k++)
		normal[k] += facing < 0 ? -n[k] : n[k];
	*farthest = fmaxf(*farthest, (float)fmax(first, second));
	return true;
}

/* Returns how near the rim of the seen part is: 1 .. RIM_CELLS + 1 cells. */
static int rim_distance(const struct range_grid *grid, int64_t column, int64_t row)
{
	for (int d = 1; d <= RIM_CELLS; d++)
		if (cell_at(grid, column - d, row) == RANGE_NO_POINT ||
		    cell_at(grid, column + d, row) == RANGE_NO_POINT ||
		    cell_at(grid, column, row - d) == RANGE_NO_POINT ||
		    cell_at(grid, column, row + d) == RANGE_NO_POINT)
			return d;
	return RIM_CELLS + 1;
}

static void orient(const struct range_grid *grid, struct range_point *points, uint64_t cell,
		   double longest)
{
	static const int8_t around[4][2] = { { 1, 0 }, { 0, 1 }, { -1, 0 }, { 0, -1 } };
	const int64_t column = (int64_t)(cell % grid->columns),
		      row = (int64_t)(cell / grid->columns);
	struct range_point *at = &points[grid->cells[cell]];
	double normal[3] = { 0 };
	float facing;
	bool any = false;

	at->spacing = 0;
	for (int i = 0; i < 4; i++) {
		const int8_t *to = around[i], *next = around[(i + 1) % 4];
		const uint32_t a = cell_at(grid, column + to[0], row + to[1]);
		const uint32_t b = cell_at(grid, column + next[0], row + next[1]);

		if (a != RANGE_NO_POINT && b != RANGE_NO_POINT)
			any |= add_triangle(normal, &at->spacing, at, &points[a], &points[b],
					    longest);
	}
	for (int k = 0; k < 3; k++)
		at->normal[k] = (float)(normal[k] / (longest * longest));
	facing = vec_normalise(at->normal) > 0 && any ? vec_dot(at->normal, at->towards) : 0;
	at->weight *= facing > grazing
			      ? facing * (float)rim_distance(grid, column, row) / (RIM_CELLS + 1)
			      : 0;
}

int range_grid_orient(double *spacing, const struct range_grid *grid, struct range_point *points,
		      uint32_t count)
{
	const int rc = median_spacing(spacing, grid, points);
	uint8_t *seen = rc == 0 ? calloc(count + (size_t)1, 1) : NULL;

	if (!seen)
		return rc < 0 ? rc : -ENOMEM;
	for (uint64_t i = 0; i < (uint64_t)grid->columns * grid->rows; i++) {
		const uint32_t point = grid->cells[i];

		spill_pass(i);
		if (point == RANGE_NO_POINT || seen[point])
			continue;
		seen[point] = 1;
		orient(grid, points, i, step_edges * *spacing);
	}
	for (uint32_t i = 0; i < count; i++)
		if (!seen[i])
			points[i].weight = 0;
	free(seen);
	return 0;
}
