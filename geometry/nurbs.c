/* The recursion of Cox and de Boor for the basis functions, and sums of points by them. */
#include "geometry/nurbs.h"

#include <math.h>
#include <stddef.h>

const char *nurbs_axis_fault(const struct nurbs_axis *axis)
{
	double low, high;

	if (axis->order < 2 || axis->order > NURBS_ORDER_MAX)
		return "has an order that is not 2 to 12";
	if (axis->count < axis->order)
		return "has fewer control points than its order";
	for (uint32_t i = 1; i < axis->count + axis->order; i++)
		if (!(axis->knots[i] >= axis->knots[i - 1]))
			return "has knots that fall";
	for (uint32_t i = axis->order; i < axis->count; i++)
		if (!(axis->knots[i] > axis->knots[i - axis->order + 1]))
			return "has a knot that is there as often as the order, so it is torn";
	nurbs_axis_range(axis, &low, &high);
	return high > low ? NULL : "has no range between its knots";
}

void nurbs_even_knots(float *knots, uint32_t order, uint32_t count)
{
	for (uint32_t i = 0; i < count + order; i++)
		knots[i] = i < order   ? 0
			   : i < count ? (float)(i - order + 1)
				       : (float)(count - order + 1);
}

void nurbs_axis_range(const struct nurbs_axis *axis, double *low, double *high)
{
	*low = (double)axis->knots[axis->order - 1];
	*high = (double)axis->knots[axis->count];
}

/* Sets the order basis functions that are not 0 at t; returns the first one's point. */
static uint32_t find_basis(const struct nurbs_axis *axis, double t, double *basis)
{
	const uint32_t degree = axis->order - 1;
	uint32_t span = degree, end = axis->count;
	double low, high;

	nurbs_axis_range(axis, &low, &high);
	t = fmin(fmax(t, low), high);
	while (end - span > 1) { /* the last span that begins at or before t */
		const uint32_t middle = (span + end) / 2;

		if ((double)axis->knots[middle] <= t)
			span = middle;
		else
			end = middle;
	}
	while (span > degree && !(axis->knots[span + 1] > axis->knots[span]))
		span--;
	basis[0] = 1;
	for (uint32_t d = 1; d <= degree; d++) {
		double kept = 0;

		for (uint32_t i = 0; i < d; i++) {
			const double right = (double)axis->knots[span + 1 + i] - t;
			const double left = t - (double)axis->knots[span + 1 + i - d];
			const double share = basis[i] / (right + left);

			basis[i] = kept + right * share;
			kept = left * share;
		}
		basis[d] = kept;
	}
	return span - degree;
}

void nurbs_curve_place(const struct nurbs_curve *curve, double t, double *place)
{
	double basis[NURBS_ORDER_MAX], total = 0;
	const uint32_t first = find_basis(&curve->axis, t, basis);

	for (uint32_t k = 0; k < curve->width; k++)
		place[k] = 0;
	for (uint32_t i = 0; i < curve->axis.order; i++) {
		const size_t at = first + i;
		const double share = basis[i] * (curve->weights ? (double)curve->weights[at] : 1);

		total += share;
		for (uint32_t k = 0; k < curve->width; k++)
			place[k] += share * (double)curve->points[at * curve->width + k];
	}
	for (uint32_t k = 0; k < curve->width; k++)
		place[k] /= total;
}

void nurbs_surface_place(const struct nurbs_surface *surface, double u, double v, double place[3])
{
	double along_u[NURBS_ORDER_MAX], along_v[NURBS_ORDER_MAX], total = 0;
	const uint32_t first_u = find_basis(&surface->axes[0], u, along_u);
	const uint32_t first_v = find_basis(&surface->axes[1], v, along_v);

	place[0] = place[1] = place[2] = 0;
	for (uint32_t j = 0; j < surface->axes[1].order; j++)
		for (uint32_t i = 0; i < surface->axes[0].order; i++) {
			const size_t at =
				first_u + i + (size_t)(first_v + j) * surface->axes[0].count;
			const double share = along_u[i] * along_v[j] *
					     (surface->weights ? (double)surface->weights[at] : 1);

			total += share;
			for (int k = 0; k < 3; k++)
				place[k] += share * (double)surface->points[3 * at + k];
		}
	for (int k = 0; k < 3; k++)
		place[k] /= total;
}
