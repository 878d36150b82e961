/* A bounding volume hierarchy over the triangles of a mesh, for what a closed surface of it needs:
 * the generalised winding number (Jacobson et al. 2013), summed over the tree as far triangles
 * count together (Barill et al. 2018), the nearest triangle, and how often a ray meets the mesh.
 *
 * The winding number of a place is how often the surface goes around it: 1 inside a body, 0
 * outside, 2 where two bodies overlap, and in between, smoothly, near a hole. */
#ifndef GOPURA_PIPELINE_OCTREE_TRIANGLE_TREE_H
#define GOPURA_PIPELINE_OCTREE_TRIANGLE_TREE_H

#include <stdbool.h>

#include "geometry/bvh.h"
#include "pipeline/import/mesh.h"

/* The triangles of a node as seen from far away. */
struct triangle_moment {
	float centre[3]; /* weighted by area */
	float normal[3]; /* sum of the areas times the unit normals */
	float radius;    /* of a ball around centre with all of them */
};

struct triangle_tree {
	struct bvh_node *nodes;          /* owned */
	struct triangle_moment *moments; /* of each node; owned */
	uint32_t node_count, triangle_count;
	uint32_t *order;        /* number of each triangle in the mesh; owned */
	float (*corners)[3][3]; /* of each, in this order; owned */
	/* A node counts as one from so many times the radius of its moment on. */
	float far_radii;
};

/* A place on a triangle. */
struct triangle_place {
	uint32_t triangle; /* its number in the mesh */
	uint32_t at;       /* its number in the tree */
	float shares[3];   /* of its corners: 0 .. 1, together 1 */
	float distance;    /* from where it was looked for */
};

/* Builds the tree of a mesh with at least one triangle; the mesh is not needed afterwards. *out is
 * owned by the caller; zeroed on failure. -ENOMEM, -ENOSPC. */
must_check int triangle_tree_init(struct triangle_tree *out, const struct mesh *mesh);
void triangle_tree_finish(struct triangle_tree *tree); /* NULL and zeroed are fine */

/* Turns each triangle that has not 0 at its number of the mesh in `turned`. -ENOMEM, -ENOSPC: the
 * tree is only to be finished. */
must_check int triangle_tree_turn(struct triangle_tree *tree, const uint8_t *turned);

/* Returns the winding number, with an error of about 0.01. Any thread may call, as the two below.
 */
double triangle_tree_winding(const struct triangle_tree *tree, const float at[3]);
/* Finds the nearest place on a triangle that is nearer than `reach`; of triangles that share it, on
 * the one that faces `at` most. Returns false if there is
 * none; *out is then unchanged. */
bool triangle_tree_nearest(const struct triangle_tree *tree, const float at[3], float reach,
			   struct triangle_place *out);
/* Sets the unit normal of the triangle of a place, and the place itself. */
void triangle_tree_normal(const struct triangle_tree *tree, const struct triangle_place *place,
			  float normal[3], float at[3]);
/* Returns whether a place on one triangle is nearer than `reach`. */
bool triangle_is_near(const float (*corners)[3], const float at[3], float reach);
/* Counts the triangles that a ray meets, up to `most`. towards has no length of 0. */
uint32_t triangle_tree_crossings(const struct triangle_tree *tree, const float from[3],
				 const float towards[3], uint32_t most);

#endif
