/* How space is deformed: what the steps of a deformation have in common. */
#ifndef GOPURA_PIPELINE_DEFORM_WARP_H
#define GOPURA_PIPELINE_DEFORM_WARP_H

#include <stdbool.h>

struct warp {
	/* Computes where a place goes, and the derivatives of that: jacobian[i][k] is the change of
	 * to[i] along axis k; NULL: not wanted. The same place always goes to the same bits. Any
	 * thread. */
	void (*place)(const void *data, const double from[3], double to[3], double jacobian[3][3]);
	/* Returns a bound of the second derivative in a box, along any direction; INFINITY: there
	 * is none. *grain gets the length of an edge that is short enough to be judged by the
	 * places at its quarters. Any thread. */
	double (*bound)(const void *data, const double low[3], const double high[3], double *grain);
	/* Returns whether nothing folds within a triangle, for sure; false: that is not known. Any
	 * thread. NULL: bound tells. */
	bool (*is_safe)(const void *data, const double corners[3][3]);
	const void *data; /* borrowed */
};

#endif
