/* Quadric error metrics: sums of plane distances as a symmetric 3x3 matrix, a vector and a
 * constant. */
#include "pipeline/hierarchy/quadric.h"

/* Share of the matrix's trace: how strongly a flat direction is held near the guess. */
#define HOLD 1e-3

void quadric_add_plane(struct quadric *quadric, const double normal[3], const double point[3],
		       double weight)
{
	double x = normal[0], y = normal[1], z = normal[2];
	double offset = -(x * point[0] + y * point[1] + z * point[2]);

	quadric->xx += weight * x * x;
	quadric->xy += weight * x * y;
	quadric->xz += weight * x * z;
	quadric->yy += weight * y * y;
	quadric->yz += weight * y * z;
	quadric->zz += weight * z * z;
	quadric->x += weight * x * offset;
	quadric->y += weight * y * offset;
	quadric->z += weight * z * offset;
	quadric->constant += weight * offset * offset;
	quadric->weight += weight;
}

void quadric_least(double out[3], const struct quadric *q, const double near[3])
{
	double hold = HOLD * (q->xx + q->yy + q->zz) + 1e-9;
	double xx = q->xx + hold, yy = q->yy + hold, zz = q->zz + hold;
	double x = hold * near[0] - q->x, y = hold * near[1] - q->y, z = hold * near[2] - q->z;
	/* Cofactors of the symmetric matrix; the added hold makes it positive definite. */
	double cxx = yy * zz - q->yz * q->yz, cxy = q->xz * q->yz - q->xy * zz;
	double cxz = q->xy * q->yz - q->xz * yy, cyy = xx * zz - q->xz * q->xz;
	double cyz = q->xy * q->xz - xx * q->yz, czz = xx * yy - q->xy * q->xy;
	double determinant = xx * cxx + q->xy * cxy + q->xz * cxz;

	out[0] = (cxx * x + cxy * y + cxz * z) / determinant;
	out[1] = (cxy * x + cyy * y + cyz * z) / determinant;
	out[2] = (cxz * x + cyz * y + czz * z) / determinant;
}
