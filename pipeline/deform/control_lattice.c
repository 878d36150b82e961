/* Uniform cubic B-splines in three dimensions. */
#include "pipeline/deform/control_lattice.h"

#include <errno.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

static size_t points_along(const struct control_lattice *lattice, int axis)
{
	return lattice->cells[axis] + 3;
}

static double cell_side(const struct control_lattice *lattice, int axis)
{
	return (lattice->high[axis] - lattice->low[axis]) / lattice->cells[axis];
}

static size_t point_index(const struct control_lattice *lattice, size_t i, size_t j, size_t k)
{
	return i + points_along(lattice, 0) * (j + points_along(lattice, 1) * k);
}

int control_lattice_init(struct control_lattice *out, const double low[3], const double high[3],
			 const uint32_t cells[3])
{
	*out = (struct control_lattice){ 0 };
	for (int k = 0; k < 3; k++) {
		out->low[k] = low[k];
		out->high[k] = high[k];
		out->cells[k] = cells[k];
	}
	out->moves = calloc(points_along(out, 0) * points_along(out, 1) * points_along(out, 2),
			    sizeof(*out->moves));
	if (out->moves)
		return 0;
	*out = (struct control_lattice){ 0 };
	return -ENOMEM;
}

void control_lattice_finish(struct control_lattice *lattice)
{
	free(lattice->moves);
	free(lattice->strength);
	*lattice = (struct control_lattice){ 0 };
}

double *control_lattice_move(const struct control_lattice *lattice, const int point[3])
{
	return lattice->moves[point_index(lattice, (size_t)(point[0] + 1), (size_t)(point[1] + 1),
					  (size_t)(point[2] + 1))];
}

void control_lattice_point(const struct control_lattice *lattice, const int point[3],
			   double place[3])
{
	const double *by = control_lattice_move(lattice, point);

	for (int k = 0; k < 3; k++)
		place[k] = lattice->low[k] + point[k] * cell_side(lattice, k) + by[k];
}

/* ---- refinement */

/* Doubles the cells along one axis by the rule of Lane and Riesenfeld: a point on an old one is
 * (1 6 1) / 8 of it and its neighbours, a point between two is their mean. */
static void refine_line(const double (*from)[3], size_t from_step, double (*to)[3], size_t to_step,
			uint32_t cells)
{
	for (size_t j = 0; j < 2 * (size_t)cells + 3; j++) {
		/* Index 0 is point -1, so even indexes are points between two old ones. */
		const double(*a)[3] = from + (j / 2) * from_step;

		for (int c = 0; c < 3; c++)
			to[j * to_step][c] =
				j % 2 == 0
					? (a[0][c] + a[from_step][c]) / 2
					: (a[0][c] + 6 * a[from_step][c] + a[2 * from_step][c]) / 8;
	}
}

static int refine_axis(struct control_lattice *lattice, int axis)
{
	struct control_lattice finer;
	uint32_t cells[3] = { lattice->cells[0], lattice->cells[1], lattice->cells[2] };
	const int a = (axis + 1) % 3, b = (axis + 2) % 3;
	size_t step[3], finer_step[3];
	int rc;

	cells[axis] *= 2;
	rc = control_lattice_init(&finer, lattice->low, lattice->high, cells);
	if (rc < 0)
		return rc;
	for (int k = 0; k < 3; k++) {
		step[k] = point_index(lattice, k == 0, k == 1, k == 2);
		finer_step[k] = point_index(&finer, k == 0, k == 1, k == 2);
	}
	for (size_t i = 0; i < points_along(lattice, a); i++)
		for (size_t j = 0; j < points_along(lattice, b); j++)
			refine_line(lattice->moves + i * step[a] + j * step[b], step[axis],
				    finer.moves + i * finer_step[a] + j * finer_step[b],
				    finer_step[axis], lattice->cells[axis]);
	control_lattice_finish(lattice);
	*lattice = finer;
	return 0;
}

int control_lattice_refine(struct control_lattice *lattice)
{
	struct control_lattice finer;
	int rc = 0;

	for (int k = 0; k < 3; k++)
		if (lattice->cells[k] > LATTICE_CELLS_MAX / 2)
			return -EFBIG;
	rc = control_lattice_init(&finer, lattice->low, lattice->high, lattice->cells);
	if (rc < 0)
		return rc;
	memcpy(finer.moves, lattice->moves,
	       points_along(lattice, 0) * points_along(lattice, 1) * points_along(lattice, 2) *
		       sizeof(*finer.moves));
	for (int k = 0; k < 3 && rc == 0; k++)
		rc = refine_axis(&finer, k);
	if (rc < 0) {
		control_lattice_finish(&finer);
		return rc;
	}
	control_lattice_finish(lattice);
	*lattice = finer;
	return 0;
}

/* ---- evaluation */

/* Where a place is along one axis: the first of the four points that reach it, their weights, and
 * the derivatives of these. */
struct place_along {
	size_t first;
	double weights[4], slopes[4];
};

static void find_along(const struct control_lattice *lattice, int axis, double at,
		       struct place_along *out)
{
	const uint32_t cells = lattice->cells[axis];
	const double side = cell_side(lattice, axis);
	const double inside = fmin(fmax(at, lattice->low[axis]), lattice->high[axis]);
	const double t = (inside - lattice->low[axis]) / side;
	const double cell = fmin(floor(t), cells - 1), u = t - cell, v = 1 - u;
	/* Beyond the box the movement does not change. */
	const double slope = inside < at || inside > at ? 0 : 1 / (2 * side);

	out->first = (size_t)cell;
	out->weights[0] = v * v * v / 6;
	out->weights[1] = (4 - 6 * u * u + 3 * u * u * u) / 6;
	out->weights[2] = (4 - 6 * v * v + 3 * v * v * v) / 6;
	out->weights[3] = u * u * u / 6;
	out->slopes[0] = -v * v * slope;
	out->slopes[1] = (3 * u * u - 4 * u) * slope;
	out->slopes[2] = (4 * v - 3 * v * v) * slope;
	out->slopes[3] = u * u * slope;
}

void control_lattice_displace(const struct control_lattice *lattice, const double place[3],
			      double by[3], double gradient[3][3])
{
	struct place_along x, y, z;
	double sums[4][3] = { { 0 } }; /* the movement, and its derivatives along each axis */

	find_along(lattice, 0, place[0], &x);
	find_along(lattice, 1, place[1], &y);
	find_along(lattice, 2, place[2], &z);
	for (size_t k = 0; k < 4; k++)
		for (size_t j = 0; j < 4; j++) {
			const double(*row)[3] =
				lattice->moves +
				point_index(lattice, x.first, y.first + j, z.first + k);
			const double weight = y.weights[j] * z.weights[k];
			const double along_y = y.slopes[j] * z.weights[k];
			const double along_z = y.weights[j] * z.slopes[k];

			for (int c = 0; c < 3; c++) {
				double sum = 0, slope = 0;

				for (int i = 0; i < 4; i++) {
					sum += x.weights[i] * row[i][c];
					slope += x.slopes[i] * row[i][c];
				}
				sums[0][c] += weight * sum;
				sums[1][c] += weight * slope;
				sums[2][c] += along_y * sum;
				sums[3][c] += along_z * sum;
			}
		}
	for (int c = 0; c < 3; c++) {
		by[c] = sums[0][c];
		for (int k = 0; k < 3 && gradient; k++)
			gradient[c][k] = sums[1 + k][c];
	}
}

double control_lattice_weight(const struct control_lattice *lattice, const int point[3],
			      const double place[3])
{
	double weight = 1;

	for (int k = 0; k < 3; k++) {
		struct place_along along;
		size_t index;

		find_along(lattice, k, place[k], &along);
		index = (size_t)(point[k] + 1) - along.first;
		weight *= index < 4 ? along.weights[index] : 0;
	}
	return weight;
}

/* ---- bounds */

static double length3(const double a[3])
{
	return sqrt(a[0] * a[0] + a[1] * a[1] + a[2] * a[2]);
}

/* Returns the length of a difference of moves: along axis a once and along axis b once. */
static double second_difference(const double (*at)[3], size_t step_a, size_t step_b)
{
	double d[3];

	for (int c = 0; c < 3; c++)
		d[c] = at[step_a + step_b][c] - at[step_a][c] - at[step_b][c] + at[0][c];
	return length3(d);
}

/* A derivative of a B-spline is a mean of the differences of its points, so the largest difference
 * among the 64 points that reach a cell bounds it there. */
static struct lattice_cell measure_cell(const struct control_lattice *lattice, size_t first)
{
	struct lattice_cell out = { 0, 0 };
	size_t step[3];
	double most[3][3] = { { 0 } };

	for (int k = 0; k < 3; k++)
		step[k] = point_index(lattice, k == 0, k == 1, k == 2);
	for (size_t p = 0; p < 64; p++) {
		const size_t at[3] = { p % 4, p / 4 % 4, p / 16 };
		const double(*move)[3] = lattice->moves + first + at[0] * step[0] +
					 at[1] * step[1] + at[2] * step[2];

		out.reach = fmax(out.reach, length3(*move));
		for (int a = 0; a < 3; a++)
			for (int b = a; b < 3; b++)
				if (at[a] < (a == b ? 2 : 3) && at[b] < 3)
					most[a][b] =
						fmax(most[a][b],
						     second_difference(move, step[a], step[b]));
	}
	for (int a = 0; a < 3; a++)
		for (int b = a; b < 3; b++)
			out.bend += (a == b ? 1 : 2) * most[a][b] /
				    (cell_side(lattice, a) * cell_side(lattice, b));
	return out;
}

int control_lattice_ready(struct control_lattice *lattice)
{
	const uint32_t *cells = lattice->cells;
	size_t n = 0;

	lattice->strength =
		malloc((size_t)cells[0] * cells[1] * cells[2] * sizeof(*lattice->strength));
	if (!lattice->strength)
		return -ENOMEM;
	for (size_t k = 0; k < cells[2]; k++)
		for (size_t j = 0; j < cells[1]; j++)
			for (size_t i = 0; i < cells[0]; i++)
				lattice->strength[n++] =
					measure_cell(lattice, point_index(lattice, i, j, k));
	return 0;
}

struct lattice_cell control_lattice_strength(const struct control_lattice *lattice,
					     const double low[3], const double high[3])
{
	struct lattice_cell out = { 0, 0 };
	size_t from[3], to[3];
	int crosses = 0;

	for (int k = 0; k < 3; k++) {
		const double a = (low[k] - lattice->low[k]) / cell_side(lattice, k);
		const double b = (high[k] - lattice->low[k]) / cell_side(lattice, k);
		const double last = lattice->cells[k] - 1;

		from[k] = (size_t)fmin(fmax(floor(a), 0), last);
		to[k] = (size_t)fmin(fmax(floor(b), 0), last);
		crosses |= (low[k] < lattice->low[k] && high[k] > lattice->low[k]) ||
			   (low[k] < lattice->high[k] && high[k] > lattice->high[k]);
	}
	for (size_t k = from[2]; k <= to[2]; k++)
		for (size_t j = from[1]; j <= to[1]; j++)
			for (size_t i = from[0]; i <= to[0]; i++) {
				const struct lattice_cell *cell =
					&lattice->strength[i + lattice->cells[0] *
								       (j + lattice->cells[1] * k)];

				out.reach = fmax(out.reach, cell->reach);
				out.bend = fmax(out.bend, cell->bend);
			}
	/* There is a crease where the box ends. */
	if (crosses && out.reach > 0)
		out.bend = INFINITY;
	return out;
}
