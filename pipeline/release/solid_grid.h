/* Makes the octree of where an eye may be (format/solid.h) from the triangles of a model. A grid of
 * equal cells around the model is filled near the triangles; what no way leads to from outside, or
 * from a place where an eye is known to be, is filled too. So the inside of a wall is full even
 * where the scan has only its two faces. One bit a cell. */
#ifndef GOPURA_PIPELINE_RELEASE_SOLID_GRID_H
#define GOPURA_PIPELINE_RELEASE_SOLID_GRID_H

#include "format/solid.h"

enum { SOLID_GRID_CELLS_MAX = 1 << 28 };

struct solid_grid_options {
	float box_min_m[3], box_max_m[3]; /* holds all triangles; z is up */
	float cell_m;                     /* above 0 */
	float room_m; /* how far from every triangle an eye stays, along each axis */
};

struct solid_grid;

/* *out is owned by the caller; NULL on failure. Returns -EFBIG if there were more than
 * SOLID_GRID_CELLS_MAX cells or the tree were deeper than SOLID_DEPTH_MAX, or -ENOMEM. */
must_check int solid_grid_create(struct solid_grid **out, const struct solid_grid_options *options);
void solid_grid_destroy(struct solid_grid *grid); /* NULL is fine */
/* Fills the cells that are within room_m of a triangle. What is outside of the box is left out. */
void solid_grid_add(struct solid_grid *grid, const float corners_m[3][3]);
/* Marks a place where an eye is known to be, such as the first view: the free cell nearest to it is
 * not filled, nor what can be reached from there. Call it after the last triangle. */
void solid_grid_open(struct solid_grid *grid, const float eye_m[3]);
/* Fills what cannot be reached and makes the tree; nothing may be added afterwards. The caller ends
 * *out with solid_finish(). Returns -EFBIG if it had more than SOLID_NODES_MAX nodes, or -ENOMEM.
 */
must_check int solid_grid_tree(struct solid_grid *grid, struct solid *out);

#endif
