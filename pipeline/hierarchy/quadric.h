/* Quadrics: the sum of squared distances to planes, weighted by area (Garland and Heckbert 1997).
 * Lengths are in lattice steps. */
#ifndef GOPURA_PIPELINE_HIERARCHY_QUADRIC_H
#define GOPURA_PIPELINE_HIERARCHY_QUADRIC_H

struct quadric {
	double xx, xy, xz, yy, yz, zz; /* the matrix */
	double x, y, z;                /* the vector */
	double constant;
	double weight; /* sum of the planes' weights */
};

/* Adds the plane through point with a unit normal. */
void quadric_add_plane(struct quadric *quadric, const double normal[3], const double point[3],
		       double weight);
/* Sets out to the minimum of the quadric. If the minimum is a line or a plane, the point on it
 * close to near is chosen. */
void quadric_least(double out[3], const struct quadric *quadric, const double near[3]);

/* Adds another quadric. */
static inline void quadric_add(struct quadric *quadric, const struct quadric *other)
{
	quadric->xx += other->xx;
	quadric->xy += other->xy;
	quadric->xz += other->xz;
	quadric->yy += other->yy;
	quadric->yz += other->yz;
	quadric->zz += other->zz;
	quadric->x += other->x;
	quadric->y += other->y;
	quadric->z += other->z;
	quadric->constant += other->constant;
	quadric->weight += other->weight;
}

/* Returns the value of the quadric at a point, 0 or more. */
static inline double quadric_at(const struct quadric *q, const double point[3])
{
	double x = point[0], y = point[1], z = point[2];
	double value = x * (q->xx * x + 2.0 * (q->xy * y + q->xz * z + q->x)) +
		       y * (q->yy * y + 2.0 * (q->yz * z + q->y)) + z * (q->zz * z + 2.0 * q->z) +
		       q->constant;

	return value > 0.0 ? value : 0.0;
}

#endif
