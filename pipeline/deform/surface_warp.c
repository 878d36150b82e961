/* A grid of places of the surface, and where each lies in the plane. */
#include "pipeline/deform/surface_warp.h"

#include <errno.h>
#include <math.h>
#include <stdlib.h>

enum {
	GRID = 48, /* cells a side; even, so that the middle is a place of the grid */
	SIDE = GRID + 1,
	RELAXATIONS = 1000,
	COARSE = 4, /* every fourth place begins the search for the nearest one */
	NEWTON_STEPS = 12,
	SAMPLES = 4, /* a side of a cell, where its bounds are measured */
	RING_MAX = 8,
};

/* What is known of a cell of the grid. */
struct cell_bounds {
	double bends[2];        /* least and greatest curvature; above 0 towards the normal */
	double in_plane, along; /* least length of a step of one cell, in the plane and in space */
	bool is_sound;          /* it has normals, and is not turned over in the plane */
};

struct surface_warp {
	struct nurbs_surface surface; /* its arrays are borrowed */
	bool is_flattening;
	double low[2], high[2];       /* of u and v */
	double middle[3], axes[3][3]; /* the plane; the third axis is the normal */
	double size;                  /* of the surface */
	double places[SIDE][SIDE][3]; /* rows along v */
	double flat[SIDE][SIDE][2];
	struct cell_bounds bounds[GRID][GRID];
};

static double dot(const double a[3], const double b[3])
{
	return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

static double distance(const double *a, const double *b, int width)
{
	double sum = 0;

	for (int k = 0; k < width; k++)
		sum += (a[k] - b[k]) * (a[k] - b[k]);
	return sqrt(sum);
}

/* ---- the surface */

/* The place, and the derivatives along u and v where they are wanted. */
static void look(const struct surface_warp *w, const double at[2], double place[3],
		 double along[2][3])
{
	nurbs_surface_place(&w->surface, at[0], at[1], place);
	for (int k = 0; k < 2; k++) {
		const double step = (w->high[k] - w->low[k]) * 1e-4;
		double before[2] = { at[0], at[1] }, after[2] = { at[0], at[1] }, a[3], b[3];

		before[k] = fmax(at[k] - step, w->low[k]);
		after[k] = fmin(at[k] + step, w->high[k]);
		nurbs_surface_place(&w->surface, before[0], before[1], a);
		nurbs_surface_place(&w->surface, after[0], after[1], b);
		for (int c = 0; c < 3; c++)
			along[k][c] = (b[c] - a[c]) / (after[k] - before[k]);
	}
}

/* The second derivatives along u twice, along both, and along v twice. */
static void look_twice(const struct surface_warp *w, const double wanted[2], double second[3][3])
{
	double at[2], step[2], p[3][3][3];

	for (int k = 0; k < 2; k++) {
		step[k] = (w->high[k] - w->low[k]) * 1e-3;
		at[k] = fmin(fmax(wanted[k], w->low[k] + step[k]), w->high[k] - step[k]);
	}
	for (int j = 0; j < 3; j++)
		for (int i = 0; i < 3; i++)
			nurbs_surface_place(&w->surface, at[0] + (i - 1) * step[0],
					    at[1] + (j - 1) * step[1], p[j][i]);
	for (int k = 0; k < 3; k++) {
		second[0][k] = (p[1][2][k] - 2 * p[1][1][k] + p[1][0][k]) / (step[0] * step[0]);
		second[1][k] = (p[2][2][k] - p[2][0][k] - p[0][2][k] + p[0][0][k]) /
			       (4 * step[0] * step[1]);
		second[2][k] = (p[2][1][k] - 2 * p[1][1][k] + p[0][1][k]) / (step[1] * step[1]);
	}
}

/* Returns false where the surface has no normal. */
static bool find_normal(double along[2][3], double normal[3])
{
	double length;

	for (int k = 0; k < 3; k++) {
		const int a = (k + 1) % 3, b = (k + 2) % 3;

		normal[k] = along[0][a] * along[1][b] - along[0][b] * along[1][a];
	}
	length = sqrt(dot(normal, normal));
	for (int k = 0; k < 3; k++)
		normal[k] /= length;
	return length > 0;
}

static void grid_parameters(const struct surface_warp *w, double i, double j, double at[2])
{
	at[0] = w->low[0] + (w->high[0] - w->low[0]) * i / GRID;
	at[1] = w->low[1] + (w->high[1] - w->low[1]) * j / GRID;
}

/* ---- flattening */

/* Rows and columns at their length from the middle ones. Exact where both are straight in the
 * plane, as on a cylinder along its axis. */
static void begin_flat(struct surface_warp *w)
{
	const int middle = GRID / 2;

	for (int j = 0; j < SIDE; j++)
		for (int i = 0; i < SIDE; i++)
			w->flat[j][i][0] = w->flat[j][i][1] = 0;
	for (int n = 0; n < SIDE; n++)
		for (int step = 1; step <= middle; step++)
			for (int side = -1; side <= 1; side += 2) {
				const int to = middle + side * step, from = to - side;

				w->flat[n][to][0] =
					w->flat[n][from][0] +
					side * distance(w->places[n][to], w->places[n][from], 3);
				w->flat[to][n][1] =
					w->flat[from][n][1] +
					side * distance(w->places[to][n], w->places[from][n], 3);
			}
}

/* Moves two places of the grid in the plane half way to the distance that they have in space. */
static void relax(struct surface_warp *w, int i, int j, int k, int l)
{
	double *a = w->flat[j][i], *b = w->flat[l][k];
	const double wanted = distance(w->places[j][i], w->places[l][k], 3);
	const double is = distance(a, b, 2), share = is > 0 ? 0.25 * (is - wanted) / is : 0;

	for (int c = 0; c < 2; c++) {
		const double by = (b[c] - a[c]) * share;

		a[c] += by;
		b[c] -= by;
	}
}

/* Puts the middle back to the origin, and its row's direction along the first axis. */
static void align(struct surface_warp *w)
{
	const int m = GRID / 2;
	const double at[2] = { w->flat[m][m][0], w->flat[m][m][1] };
	const double x = w->flat[m][m + 1][0] - at[0], y = w->flat[m][m + 1][1] - at[1];
	const double length = sqrt(x * x + y * y), c = x / length, s = y / length;

	for (int j = 0; j < SIDE; j++)
		for (int i = 0; i < SIDE; i++) {
			const double dx = w->flat[j][i][0] - at[0], dy = w->flat[j][i][1] - at[1];

			w->flat[j][i][0] = c * dx + s * dy;
			w->flat[j][i][1] = c * dy - s * dx;
		}
}

static void flatten(struct surface_warp *w)
{
	begin_flat(w);
	for (int n = 0; n < RELAXATIONS; n++)
		for (int j = 0; j < SIDE; j++)
			for (int i = 0; i < SIDE; i++) {
				if (i < GRID)
					relax(w, i, j, i + 1, j);
				if (j < GRID)
					relax(w, i, j, i, j + 1);
				if (i < GRID && j < GRID) {
					relax(w, i, j, i + 1, j + 1);
					relax(w, i + 1, j, i, j + 1);
				}
			}
	align(w);
}

void surface_warp_stretch(const struct surface_warp *w, double *least, double *most)
{
	*least = INFINITY;
	*most = 0;
	for (int j = 0; j < GRID; j++)
		for (int i = 0; i < GRID; i++)
			for (int k = 1; k < 4; k++) {
				const int x = i + (k & 1), y = j + (k >> 1);
				const double is = distance(w->flat[j][i], w->flat[y][x], 2) /
						  distance(w->places[j][i], w->places[y][x], 3);

				*least = fmin(*least, is);
				*most = fmax(*most, is);
			}
}

/* Reads the plane's place of parameters, and its derivatives along the grid. */
static void read_flat(const struct surface_warp *w, const double cell[2], double flat[2],
		      double along[2][2])
{
	const int i = (int)fmin(cell[0], GRID - 1), j = (int)fmin(cell[1], GRID - 1);
	const double u = cell[0] - i, v = cell[1] - j;

	for (int c = 0; c < 2; c++) {
		const double a = w->flat[j][i][c], b = w->flat[j][i + 1][c];
		const double d = w->flat[j + 1][i][c], e = w->flat[j + 1][i + 1][c];

		flat[c] = (1 - v) * ((1 - u) * a + u * b) + v * ((1 - u) * d + u * e);
		along[0][c] = (1 - v) * (b - a) + v * (e - d);
		along[1][c] = (1 - u) * (d - a) + u * (e - b);
	}
}

/* ---- bounds */

/* The least length that a matrix of two columns gives a step: its least singular value. */
static double least_step(double aa, double ab, double bb)
{
	const double mean = (aa + bb) / 2, apart = (aa - bb) / 2;

	return sqrt(fmax(mean - sqrt(apart * apart + ab * ab), 0));
}

/* Sets the least and the greatest curvature of the surface. Returns false where it has no normal.
 */
static bool find_curvature(const struct surface_warp *w, const double at[2], double along[2][3],
			   double bends[2])
{
	double second[3][3], normal[3], n[3], aa, ab, bb, area, mean, product;

	if (!find_normal(along, normal))
		return false;
	look_twice(w, at, second);
	for (int k = 0; k < 3; k++)
		n[k] = dot(normal, second[k]);
	aa = dot(along[0], along[0]);
	ab = dot(along[0], along[1]);
	bb = dot(along[1], along[1]);
	area = aa * bb - ab * ab;
	mean = (aa * n[2] - 2 * ab * n[1] + bb * n[0]) / (2 * area);
	product = (n[0] * n[2] - n[1] * n[1]) / area;
	product = sqrt(fmax(mean * mean - product, 0));
	bends[0] = mean - product;
	bends[1] = mean + product;
	return isfinite(bends[0]) && isfinite(bends[1]);
}

/* Whether a cell keeps its sides in the plane: the area that a bilinear map gives changes evenly,
 * so its corners tell. */
static bool keeps_sides(const struct surface_warp *w, int i, int j)
{
	for (int corner = 0; corner < 4; corner++) {
		const int x = i + corner % 2, y = j + corner / 2;
		const double *a = w->flat[y][i], *b = w->flat[y][i + 1];
		const double *c = w->flat[j][x], *d = w->flat[j + 1][x];

		if (!((b[0] - a[0]) * (d[1] - c[1]) - (b[1] - a[1]) * (d[0] - c[0]) > 0))
			return false;
	}
	return true;
}

static void measure_place(const struct surface_warp *w, const double cell[2],
			  struct cell_bounds *out)
{
	double at[2], place[3], along[2][3], flat[2], slopes[2][2], bends[2] = { 0 };

	grid_parameters(w, cell[0], cell[1], at);
	look(w, at, place, along);
	read_flat(w, cell, flat, slopes);
	if (!find_curvature(w, at, along, bends))
		out->is_sound = false;
	for (int k = 0; k < 2; k++)
		for (int c = 0; c < 3; c++)
			along[k][c] *= (w->high[k] - w->low[k]) / GRID;
	out->along = fmin(out->along, least_step(dot(along[0], along[0]), dot(along[0], along[1]),
						 dot(along[1], along[1])));
	out->in_plane = fmin(out->in_plane,
			     least_step(slopes[0][0] * slopes[0][0] + slopes[0][1] * slopes[0][1],
					slopes[0][0] * slopes[1][0] + slopes[0][1] * slopes[1][1],
					slopes[1][0] * slopes[1][0] + slopes[1][1] * slopes[1][1]));
	if (!out->is_sound)
		return;
	out->bends[0] = fmin(out->bends[0], bends[0]);
	out->bends[1] = fmax(out->bends[1], bends[1]);
}

static void measure_bounds(struct surface_warp *w)
{
	for (int j = 0; j < GRID; j++)
		for (int i = 0; i < GRID; i++) {
			struct cell_bounds *out = &w->bounds[j][i];

			*out = (struct cell_bounds){ .bends = { INFINITY, -INFINITY },
						     .in_plane = INFINITY,
						     .along = INFINITY,
						     .is_sound = keeps_sides(w, i, j) };
			for (int n = 0; n < SAMPLES * SAMPLES; n++) {
				const double cell[2] = { i + (n % SAMPLES + 0.5) / SAMPLES,
							 j + (n / SAMPLES + 0.5) / SAMPLES };

				measure_place(w, cell, out);
			}
		}
}

int surface_warp_create(struct surface_warp **out, const struct nurbs_surface *surface,
			bool is_flattening)
{
	struct surface_warp *w = calloc(1, sizeof(*w));
	double along[2][3], at[2], length;

	*out = w;
	if (!w)
		return -ENOMEM;
	w->surface = *surface;
	w->is_flattening = is_flattening;
	for (int k = 0; k < 2; k++)
		nurbs_axis_range(&surface->axes[k], &w->low[k], &w->high[k]);
	for (int j = 0; j < SIDE; j++)
		for (int i = 0; i < SIDE; i++) {
			grid_parameters(w, i, j, at);
			nurbs_surface_place(surface, at[0], at[1], w->places[j][i]);
		}
	grid_parameters(w, GRID / 2, GRID / 2, at);
	look(w, at, w->middle, along);
	w->size = distance(w->places[0][0], w->places[GRID][GRID], 3) +
		  distance(w->places[0][GRID], w->places[GRID][0], 3);
	length = sqrt(dot(along[0], along[0]));
	if (!(length > 0) || !find_normal(along, w->axes[2])) {
		surface_warp_destroy(w);
		*out = NULL;
		return -EDOM;
	}
	for (int k = 0; k < 3; k++)
		w->axes[0][k] = along[0][k] / length;
	for (int k = 0; k < 3; k++) {
		const int a = (k + 1) % 3, b = (k + 2) % 3;

		w->axes[1][k] = w->axes[2][a] * w->axes[0][b] - w->axes[2][b] * w->axes[0][a];
	}
	flatten(w);
	measure_bounds(w);
	return 0;
}

void surface_warp_destroy(struct surface_warp *warp)
{
	free(warp);
}

/* ---- parameters and the plane */

/* Takes a step of Newton's method in the grid; cell stays in it. Returns the step's length. */
static double step_cell(double cell[2], double by_u, double by_v)
{
	const double before[2] = { cell[0], cell[1] };

	cell[0] = fmin(fmax(cell[0] + by_u, 0), GRID);
	cell[1] = fmin(fmax(cell[1] + by_v, 0), GRID);
	return fabs(cell[0] - before[0]) + fabs(cell[1] - before[1]);
}

/* Finds where the grid is at a place of the plane. */
static void find_in_plane(const struct surface_warp *w, const double wanted[2], double cell[2])
{
	double nearest = INFINITY;

	for (int j = 0; j < SIDE; j += COARSE)
		for (int i = 0; i < SIDE; i += COARSE)
			if (distance(w->flat[j][i], wanted, 2) < nearest) {
				nearest = distance(w->flat[j][i], wanted, 2);
				cell[0] = i;
				cell[1] = j;
			}
	for (int n = 0; n < NEWTON_STEPS; n++) {
		double flat[2], along[2][2], d[2], area;

		read_flat(w, cell, flat, along);
		d[0] = wanted[0] - flat[0];
		d[1] = wanted[1] - flat[1];
		area = along[0][0] * along[1][1] - along[0][1] * along[1][0];
		if (!(step_cell(cell, (d[0] * along[1][1] - d[1] * along[1][0]) / area,
				(d[1] * along[0][0] - d[0] * along[0][1]) / area) > 1e-12))
			return;
	}
}

/* Finds where the surface is nearest to a place. */
static void find_nearest(const struct surface_warp *w, const double wanted[3], double cell[2])
{
	double nearest = INFINITY;

	for (int j = 0; j < SIDE; j += COARSE)
		for (int i = 0; i < SIDE; i += COARSE)
			if (distance(w->places[j][i], wanted, 3) < nearest) {
				nearest = distance(w->places[j][i], wanted, 3);
				cell[0] = i;
				cell[1] = j;
			}
	for (int n = 0; n < NEWTON_STEPS; n++) {
		double at[2], place[3], along[2][3], second[3][3], d[3], uu, uv, vv, du, dv, area;

		grid_parameters(w, cell[0], cell[1], at);
		look(w, at, place, along);
		for (int k = 0; k < 3; k++)
			d[k] = wanted[k] - place[k];
		look_twice(w, at, second);
		uu = dot(along[0], along[0]) - dot(second[0], d);
		uv = dot(along[0], along[1]) - dot(second[1], d);
		vv = dot(along[1], along[1]) - dot(second[2], d);
		du = dot(along[0], d);
		dv = dot(along[1], d);
		area = uu * vv - uv * uv;
		if (!(uu > 0 && area > 0)) { /* beyond the centre of a curvature */
			uu = dot(along[0], along[0]);
			uv = dot(along[0], along[1]);
			vv = dot(along[1], along[1]);
			area = uu * vv - uv * uv;
		}
		if (!(step_cell(cell, (du * vv - dv * uv) / area * GRID / (w->high[0] - w->low[0]),
				(dv * uu - du * uv) / area * GRID / (w->high[1] - w->low[1])) >
		      1e-10))
			return;
	}
}

/* ---- the warp */

static void to_surface(const struct surface_warp *w, const double from[3], double to[3])
{
	double local[3], cell[2] = { 0, 0 }, at[2], along[2][3], normal[3];

	for (int k = 0; k < 3; k++) {
		local[k] = 0;
		for (int c = 0; c < 3; c++)
			local[k] += (from[c] - w->middle[c]) * w->axes[k][c];
	}
	find_in_plane(w, local, cell);
	grid_parameters(w, cell[0], cell[1], at);
	look(w, at, to, along);
	find_normal(along, normal);
	for (int k = 0; k < 3; k++)
		to[k] += local[2] * normal[k];
}

static void to_plane(const struct surface_warp *w, const double from[3], double to[3])
{
	double cell[2] = { 0, 0 }, at[2], place[3], along[2][3], normal[3], flat[2], slopes[2][2];
	double height = 0;

	find_nearest(w, from, cell);
	grid_parameters(w, cell[0], cell[1], at);
	look(w, at, place, along);
	find_normal(along, normal);
	for (int k = 0; k < 3; k++)
		height += (from[k] - place[k]) * normal[k];
	read_flat(w, cell, flat, slopes);
	for (int k = 0; k < 3; k++)
		to[k] = w->middle[k] + flat[0] * w->axes[0][k] + flat[1] * w->axes[1][k] +
			height * w->axes[2][k];
}

static void warp_place(const void *data, const double from[3], double to[3], double jacobian[3][3])
{
	const struct surface_warp *w = data;
	void (*const go)(const struct surface_warp *, const double[3], double[3]) =
		w->is_flattening ? to_plane : to_surface;
	const double step = w->size * 1e-5;

	go(w, from, to);
	for (int k = 0; k < 3 && jacobian; k++) {
		double near[3] = { from[0], from[1], from[2] }, before[3], after[3];

		near[k] = from[k] - step;
		go(w, near, before);
		near[k] = from[k] + step;
		go(w, near, after);
		for (int c = 0; c < 3; c++)
			jacobian[c][k] = (after[c] - before[c]) / (2 * step);
	}
}

static double warp_bound(const void *data, const double low[3], const double high[3], double *grain)
{
	const struct surface_warp *w = data;
	(void)low;
	(void)high;

	*grain = w->size / 16;
	return INFINITY;
}

/* Joins the bounds of the cells as far as `ring` from one. */
static struct cell_bounds join_bounds(const struct surface_warp *w, const double cell[2], int ring)
{
	struct cell_bounds out = { .bends = { INFINITY, -INFINITY },
				   .in_plane = INFINITY,
				   .along = INFINITY,
				   .is_sound = true };

	for (int j = (int)cell[1] - ring; j <= (int)cell[1] + ring; j++)
		for (int i = (int)cell[0] - ring; i <= (int)cell[0] + ring; i++) {
			const struct cell_bounds *one;

			if (i < 0 || j < 0 || i >= GRID || j >= GRID)
				continue;
			one = &w->bounds[j][i];
			out.bends[0] = fmin(out.bends[0], one->bends[0]);
			out.bends[1] = fmax(out.bends[1], one->bends[1]);
			out.in_plane = fmin(out.in_plane, one->in_plane);
			out.along = fmin(out.along, one->along);
			out.is_sound = out.is_sound && one->is_sound;
		}
	return out;
}

/* A triangle whose middle is over a place of the grid. */
struct over {
	double cell[2], radius;
	double heights[2]; /* over the surface, least and greatest */
};

/* Finds the triangle over the surface, or over the plane. Returns false beyond the rim. */
static bool find_over(const struct surface_warp *w, const double corners[3][3], struct over *out)
{
	double middle[3], on[3], at[2], along[2][3], normal[3], apart = 0, rest[3], height = 0;

	for (int k = 0; k < 3; k++)
		middle[k] = (corners[0][k] + corners[1][k] + corners[2][k]) / 3;
	out->radius = 0;
	for (int v = 0; v < 3; v++)
		out->radius = fmax(out->radius, distance(middle, corners[v], 3));
	if (w->is_flattening) {
		find_nearest(w, middle, out->cell);
		grid_parameters(w, out->cell[0], out->cell[1], at);
		look(w, at, on, along);
		if (!find_normal(along, normal))
			return false;
		for (int k = 0; k < 3; k++)
			height += (middle[k] - on[k]) * normal[k];
		for (int k = 0; k < 3; k++)
			rest[k] = middle[k] - on[k] - height * normal[k];
		apart = sqrt(dot(rest, rest));
	} else {
		double local[2] = { 0 }, flat[2], slopes[2][2];

		for (int c = 0; c < 3; c++) {
			height += (middle[c] - w->middle[c]) * w->axes[2][c];
			for (int k = 0; k < 2; k++)
				local[k] += (middle[c] - w->middle[c]) * w->axes[k][c];
		}
		find_in_plane(w, local, out->cell);
		read_flat(w, out->cell, flat, slopes);
		apart = distance(local, flat, 2);
	}
	/* No place in the triangle is higher or lower by more than its radius. */
	out->heights[0] = height - out->radius;
	out->heights[1] = height + out->radius;
	return apart < w->size * 1e-6;
}

/* Where the surface bends by c, space at a height h over it grows by 1 - h c: towards the centre of
 * the curvature it shrinks, and beyond that it is turned inside out. So a triangle is safe if that
 * is above a tenth for all heights and curvatures that it may meet: those of the cells that are no
 * farther than its radius from its middle. */
static bool warp_is_safe(const void *data, const double corners[3][3])
{
	static const double least = 0.1, care = 0.95;
	const struct surface_warp *w = data;
	struct over over;

	if (!find_over(w, corners, &over))
		return false;
	for (int ring = 1; ring <= RING_MAX; ring *= 2) {
		const struct cell_bounds bounds = join_bounds(w, over.cell, ring);
		double shrinks = 1, reach;

		if (!bounds.is_sound)
			return false;
		for (int n = 0; n < 4; n++)
			shrinks =
				fmin(shrinks, 1 - over.heights[n % 2] * bounds.bends[n / 2] / care);
		if (!(shrinks > least))
			return false;
		reach = over.radius / care /
			(w->is_flattening ? shrinks * bounds.along : bounds.in_plane);
		if (reach <= ring)
			return over.cell[0] >= reach && over.cell[0] + reach <= GRID &&
			       over.cell[1] >= reach && over.cell[1] + reach <= GRID;
	}
	return false;
}

struct warp surface_warp_of(const struct surface_warp *warp)
{
	return (struct warp){ warp_place, warp_bound, warp_is_safe, warp };
}

void surface_warp_nearest(const struct surface_warp *w, const double place[3], uint32_t point[2])
{
	double on[3] = { place[0], place[1], place[2] }, nearest = INFINITY;

	if (!w->is_flattening)
		to_surface(w, place, on);
	for (uint32_t i = 0; i < w->surface.axes[0].count * w->surface.axes[1].count; i++) {
		const float *p = w->surface.points + 3 * (size_t)i;
		const double at[3] = { (double)p[0], (double)p[1], (double)p[2] };

		if (distance(at, on, 3) < nearest) {
			nearest = distance(at, on, 3);
			point[0] = i % w->surface.axes[0].count;
			point[1] = i / w->surface.axes[0].count;
		}
	}
}
