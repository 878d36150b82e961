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
/* Adds another quadric. */
void quadric_add(struct quadric *quadric, const struct quadric *other);
/* Returns the value of the quadric at a point, 0 or more. */
double quadric_at(const struct quadric *quadric, const double point[3]);
/* Sets out to the minimum of the quadric. If the minimum is a line or a plane, the point on it
 * close to near is chosen. */
void quadric_least(double out[3], const struct quadric *quadric, const double near[3]);

#endif
