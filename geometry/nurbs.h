/* Curves and surfaces of NURBS (paper 003, appendix A); Bezier ones are those with one span. No
 * state, any thread. */
#ifndef GOPURA_GEOMETRY_NURBS_H
#define GOPURA_GEOMETRY_NURBS_H

#include <stdint.h>

enum { NURBS_ORDER_MAX = 12 };

/* One direction of control points. */
struct nurbs_axis {
	uint32_t order;     /* 2: straight from point to point; 3: quadratic; to NURBS_ORDER_MAX */
	uint32_t count;     /* of points, order at least */
	const float *knots; /* count + order of them; borrowed */
};

struct nurbs_curve {
	struct nurbs_axis axis;
	uint32_t width;       /* coordinates of a point, 2 or 3 */
	const float *points;  /* borrowed */
	const float *weights; /* of each point, above 0; borrowed; NULL: all 1 */
};

struct nurbs_surface {
	struct nurbs_axis axes[2]; /* u, v */
	const float *points;       /* three coordinates each, u fastest; borrowed */
	const float *weights;      /* as of a curve */
};

/* Returns what is wrong with an axis as a phrase such as "has knots that fall"; NULL: nothing. */
const char *nurbs_axis_fault(const struct nurbs_axis *axis);
/* Sets count + order knots, so that a curve begins and ends in its first and last point and its
 * spans are alike. */
void nurbs_even_knots(float *knots, uint32_t order, uint32_t count);
/* Sets the range of the parameter. */
void nurbs_axis_range(const struct nurbs_axis *axis, double *low, double *high);

/* Compute the place at a parameter, which is clamped to its range. The axes must have no fault. */
void nurbs_curve_place(const struct nurbs_curve *curve, double t, double *place);
void nurbs_surface_place(const struct nurbs_surface *surface, double u, double v, double place[3]);

#endif
