/* Fewer triangles by collapsing edges in the order of their quadric error (Garland and Heckbert
 * 1997, "Surface simplification using quadric error metrics"), on the lattice: a new vertex is
 * where the quadrics are least, rounded to a lattice point. Locked vertices stay as they are bit
 * for bit; open edges keep their line, and their vertices are only ever left out, never moved.
 * Nothing folds over. What closes up on itself (the last four triangles of a pebble) vanishes.
 *
 * Every collapse maps the surface onto itself with all locked vertices fixed, so the border that
 * two groups share stays shared whatever happens inside either of them. Deterministic. */
#ifndef GOPURA_PIPELINE_HIERARCHY_SIMPLIFY_H
#define GOPURA_PIPELINE_HIERARCHY_SIMPLIFY_H

#include "pipeline/hierarchy/lattice_mesh.h"

struct surface {
	uint32_t vertex_count, triangle_count;
	struct lattice_vertex *vertices;
	uint8_t *locked; /* of each vertex: 1 stays */
	uint32_t (*triangles)[3];
};

struct simplify_result {
	/* What the surface is wrong by: the largest distance (root of the mean square, weighted by
	 * area) of a new vertex from the planes it stands for, as far as they are seen (`seen` of
	 * their vertices, pipeline/hierarchy/exposure.h); lattice steps. */
	double error_steps;
	/* What the costliest collapse lost: squared distance times area that is seen, lattice steps
	 * to the fourth. */
	double loss_steps4;
	uint32_t collapse_count;
};

/* In place until at most target_triangles are left, or no edge may be collapsed without an error
 * above error_most_steps (INFINITY: whatever it takes): the triangles that are left move to the
 * front, vertices keep their index and are changed where they moved. At least one triangle stays.
 * -ENOMEM: the surface is then of no use. */
must_check int simplify(struct surface *surface, uint32_t target_triangles, double error_most_steps,
			struct simplify_result *result);

#endif
