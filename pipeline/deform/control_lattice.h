/* A lattice of control points around a model, for free-form deformation (paper 003, appendix C.2):
 * moving a point moves the space around it. The lattice is a uniform cubic B-spline in three
 * dimensions. It holds how far each point was moved, not where it is: with no point moved, places
 * stay the same bits. A box of n cells along an axis has n + 3 points on it, numbered from -1 (one
 * cell before the box) to n + 1; 0 to n lie on the box's grid. */
#ifndef GOPURA_PIPELINE_DEFORM_CONTROL_LATTICE_H
#define GOPURA_PIPELINE_DEFORM_CONTROL_LATTICE_H

#include <stdint.h>

#include "base/compiler.h"

enum { LATTICE_CELLS_MAX = 64 }; /* along an axis */

struct control_lattice {
	double low[3], high[3]; /* the box; high is above low */
	uint32_t cells[3];      /* along each axis, 1 to LATTICE_CELLS_MAX */
	double (*moves)[3];     /* of each point, x fastest; owned */
	/* Of each cell, x fastest; owned; NULL before control_lattice_ready. */
	struct lattice_cell *strength;
};

struct lattice_cell {
	double reach; /* no place in it moves farther */
	double bend;  /* no second derivative in it is larger, in any direction */
};

/* Makes a lattice whose points are not moved. low, high and cells must be in range. -ENOMEM: *out
 * is zeroed. */
must_check int control_lattice_init(struct control_lattice *out, const double low[3],
				    const double high[3], const uint32_t cells[3]);
/* Frees everything and zeroes the lattice. Zeroed is fine. */
void control_lattice_finish(struct control_lattice *lattice);

/* Divides every cell into eight, as an octree does; places move as before. -EFBIG: an axis would
 * have more than LATTICE_CELLS_MAX cells; -ENOMEM. On failure nothing changed. */
must_check int control_lattice_refine(struct control_lattice *lattice);

/* Returns how far a point was moved, to be read and changed; borrowed. Each number is from -1 to
 * cells + 1. */
double *control_lattice_move(const struct control_lattice *lattice, const int point[3]);
/* Computes where a point is now. */
void control_lattice_point(const struct control_lattice *lattice, const int point[3],
			   double place[3]);
/* Returns the weight that a point has at a place, 0 to 1. */
double control_lattice_weight(const struct control_lattice *lattice, const int point[3],
			      const double place[3]);

/* Prepares control_lattice_strength; no point may be moved after it. -ENOMEM. */
must_check int control_lattice_ready(struct control_lattice *lattice);
/* Computes bounds for all places in a box. */
struct lattice_cell control_lattice_strength(const struct control_lattice *lattice,
					     const double low[3], const double high[3]);

/* Computes how far a place moves, and the derivatives of that: gradient[i][k] is the change of
 * by[i] along axis k; NULL: not wanted. Beyond the box, the movement is that of the nearest place
 * in it. Any thread. */
void control_lattice_displace(const struct control_lattice *lattice, const double place[3],
			      double by[3], double gradient[3][3]);

#endif
