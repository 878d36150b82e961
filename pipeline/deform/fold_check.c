/* Judges triangles by what is known for sure, or by the derivatives in their middle and a bound of
 * how much these change. */
#include "pipeline/deform/fold_check.h"

#include <errno.h>
#include <math.h>
#include <stdbool.h>
#include <stdlib.h>
#include <string.h>

#include "base/parallel.h"
#include "base/spill.h"

enum { RANGE_TRIANGLES = 1 << 14, DEPTH_MAX = 6 };

struct search {
	const struct mesh *mesh;
	const struct warp *warp;
	struct found *ranges; /* of each range of triangles; owned */
};

struct found {
	bool is_there;
	double place[3];
};

static double determinant(double j[3][3])
{
	return j[0][0] * (j[1][1] * j[2][2] - j[1][2] * j[2][1]) -
	       j[0][1] * (j[1][0] * j[2][2] - j[1][2] * j[2][0]) +
	       j[0][2] * (j[1][0] * j[2][1] - j[1][1] * j[2][0]);
}

double fold_growth(const struct warp *warp, const double from[3], double to[3])
{
	double jacobian[3][3];

	warp->place(warp->data, from, to, jacobian);
	return determinant(jacobian);
}

/* Returns how much the derivatives may change, as an operator, before they are singular: at least
 * this. The least singular value is the determinant over the product of the other two, and that is
 * at most half the sum of all squares. Not above 0: it is folded here. */
static double margin_at(const struct warp *warp, const double at[3])
{
	double jacobian[3][3], to[3], squares = 0, grows;

	warp->place(warp->data, at, to, jacobian);
	grows = determinant(jacobian);
	for (int i = 0; i < 9; i++)
		squares += jacobian[i / 3][i % 3] * jacobian[i / 3][i % 3];
	/* Written so that what is not a number is folded. */
	return grows > FOLD_GROWTH_LEAST ? 2 * grows / squares : 0;
}

static void middle_of(double out[3], const double a[3], const double b[3])
{
	for (int k = 0; k < 3; k++)
		out[k] = (a[k] + b[k]) / 2;
}

static double distance(const double a[3], const double b[3])
{
	return sqrt((a[0] - b[0]) * (a[0] - b[0]) + (a[1] - b[1]) * (a[1] - b[1]) +
		    (a[2] - b[2]) * (a[2] - b[2]));
}

/* Returns the bound of the second derivative within a triangle. */
static double bound_of(const struct warp *warp, const double corners[3][3])
{
	double low[3], high[3], grain;

	for (int k = 0; k < 3; k++) {
		low[k] = fmin(corners[0][k], fmin(corners[1][k], corners[2][k]));
		high[k] = fmax(corners[0][k], fmax(corners[1][k], corners[2][k]));
	}
	return warp->bound(warp->data, low, high, &grain);
}

static bool folds(const struct warp *warp, const double corners[3][3], int depth, double place[3]);

/* Judges the four parts of a triangle. */
static bool part_folds(const struct warp *warp, const double c[3][3], int depth, double place[3])
{
	double m[3][3]; /* m[k] is between corner k and the next */

	for (int k = 0; k < 3; k++)
		middle_of(m[k], c[k], c[(k + 1) % 3]);
	for (int k = 0; k < 3; k++) {
		double part[3][3];

		memcpy(part[0], c[k], sizeof(part[0]));
		memcpy(part[1], m[k], sizeof(part[1]));
		memcpy(part[2], m[(k + 2) % 3], sizeof(part[2]));
		if (folds(warp, (const double(*)[3])part, depth, place))
			return true;
	}
	return folds(warp, (const double(*)[3])m, depth, place);
}

static bool folds(const struct warp *warp, const double corners[3][3], int depth, double place[3])
{
	double middle[3], radius = 0, margin;

	if (warp->is_safe && warp->is_safe(warp->data, corners))
		return false;
	for (int k = 0; k < 3; k++)
		middle[k] = (corners[0][k] + corners[1][k] + corners[2][k]) / 3;
	for (int v = 0; v < 3; v++)
		radius = fmax(radius, distance(middle, corners[v]));
	margin = margin_at(warp, middle);
	memcpy(place, middle, sizeof(middle));
	if (!(margin > 0))
		return true;
	if (!warp->is_safe && margin > bound_of(warp, corners) * radius)
		return false;
	return depth > 0 && part_folds(warp, corners, depth - 1, place);
}

static int check_range(void *user, uint32_t first, uint32_t after, uint32_t worker)
{
	const struct search *s = user;
	struct found *found = &s->ranges[first / RANGE_TRIANGLES];
	(void)worker;

	for (uint32_t t = first; t < after && !found->is_there; t++) {
		double corners[3][3];

		for (int v = 0; v < 3; v++)
			for (int k = 0; k < 3; k++)
				corners[v][k] =
					(double)s->mesh->positions[s->mesh->triangles[t][v]][k];
		found->is_there =
			folds(s->warp, (const double(*)[3])corners, DEPTH_MAX, found->place);
		spill_pass(t);
	}
	return 0;
}

int fold_find(double place[3], const struct mesh *mesh, const struct warp *warp, uint32_t jobs)
{
	const uint32_t count = mesh->triangle_count;
	const uint32_t ranges = (count + RANGE_TRIANGLES - 1) / RANGE_TRIANGLES;
	struct search s = { mesh, warp, calloc((size_t)ranges + 1, sizeof(*s.ranges)) };
	int rc =
		s.ranges ? parallel_ranges(jobs, count, RANGE_TRIANGLES, check_range, &s) : -ENOMEM;

	for (uint32_t i = 0; i < ranges && rc == 0; i++)
		if (s.ranges[i].is_there) {
			memcpy(place, s.ranges[i].place, sizeof(s.ranges[i].place));
			rc = 1;
		}
	free(s.ranges);
	return rc;
}
