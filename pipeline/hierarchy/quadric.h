/* The sum of squared distances to planes, weighted by area (Garland and Heckbert 1997).
 * Lattice steps. */
#ifndef GOPURA_PIPELINE_HIERARCHY_QUADRIC_H
#define GOPURA_PIPELINE_HIERARCHY_QUADRIC_H

struct quadric {
	double xx, xy, xz, yy, yz, zz; /* the matrix */
	double x, y, z;                /* the vector */
	double constant;
	double weight; /* sum of the planes' weights */
};

/* The plane through point with a unit normal. */
void quadric_add_plane(struct quadric *quadric, const double normal[3], const double point[3],
		       double weight);
void quadric_add(struct quadric *quadric, const struct quadric *other);
/* Zero or more, up to rounding. */
double quadric_at(const struct quadric *quadric, const double point[3]);
/* Where the quadric is least; where that is a line or a plane, near to near. */
void quadric_least(double out[3], const struct quadric *quadric, const double near[3]);

#endif
