/* What lies between the parts that were seen: a coarse grid over the whole model. Lines of sight
 * make its cells free; where nobody looked, the sign is that of a membrane (Laplace's equation)
 * between the seen surface, free space and the outside of the box, so that holes close smoothly.
 * Compare Curless and Levoy 1996 (free, surface, unseen) and Davis et al. 2002 (diffusion). */
#ifndef GOPURA_PIPELINE_OCTREE_COARSE_FILL_H
#define GOPURA_PIPELINE_OCTREE_COARSE_FILL_H

#include "pipeline/octree/corner_field.h"

enum { COARSE_CORNERS_MAX = 24 << 20 };

struct coarse_fill {
	int shift;           /* a coarse cell is 1 << shift leaf cubes wide; at least 2 */
	int32_t low[3];      /* corner of the field where the grid begins */
	uint32_t corners[3]; /* on each axis */
	/* Of each cell, numbered by its lowest corner; owned. */
	uint8_t *looks; /* how many lines of sight pass; 255: or more */
	uint8_t *taken; /* 1: it has points */
	float *values;  /* of each coarse corner after coarse_fill_solve, -1 .. 1; below 0: inside;
			   owned */
};

/* Prepares a grid around the box, in corners of the field, and a margin. -ENOMEM. */
must_check int coarse_fill_init(struct coarse_fill *fill, const int32_t low[3],
				const int32_t high[3]);
void coarse_fill_finish(struct coarse_fill *fill); /* NULL and zeroed are fine */

/* Marks the cells with points, and those between them and the scanner. */
void coarse_fill_look(struct coarse_fill *fill, const struct corner_field *field,
		      const struct range_scan *scan);
/* Returns whether a scan saw through the coarse cell that holds this corner of the field. */
bool coarse_fill_is_free(const struct coarse_fill *fill, const int32_t corner[3]);

/* Solves for the values, after all scans. -ENOMEM. */
must_check int coarse_fill_solve(struct coarse_fill *fill, const struct corner_field *field);
/* Returns the value at a corner of the field, by linear interpolation; 1 outside the grid. */
float coarse_fill_at(const struct coarse_fill *fill, const int32_t corner[3]);

#endif
