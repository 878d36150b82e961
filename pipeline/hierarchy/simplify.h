/* Reduces triangles by collapsing edges in the order of their quadric error (Garland and Heckbert
 * 1997, "Surface simplification using quadric error metrics"), on the lattice: a new vertex is at
 * the minimum of the quadrics, rounded to a lattice point. Locked vertices stay unchanged, bit for
 * bit. Open edges keep their line: their vertices may be removed but never move. Nothing folds
 * over. A part that closes up on itself (the last four triangles of a pebble) vanishes.
 *
 * Every collapse maps the surface onto itself with all locked vertices fixed. So the border that
 * two groups share stays shared, whatever happens inside either of them. Deterministic. */
#ifndef GOPURA_PIPELINE_HIERARCHY_SIMPLIFY_H
#define GOPURA_PIPELINE_HIERARCHY_SIMPLIFY_H

#include "pipeline/hierarchy/lattice_mesh.h"

struct simplify_surface {
	uint32_t vertex_count, triangle_count;
	struct lattice_vertex *vertices;
	uint8_t *locked; /* for each vertex; 1: it must stay */
	uint32_t (*triangles)[3];
	uint8_t fine_bits; /* of the lattice */
};

struct simplify_result {
	/* The error of the surface: the largest distance of a new vertex from the planes it
	 * represents (root of the area-weighted mean square), weighted by visibility (`seen` of
	 * their vertices, pipeline/hierarchy/exposure.h); lattice steps. */
	double error_steps;
	/* The loss of the costliest collapse: squared distance times visible area, lattice steps to
	 * the fourth power. */
	double loss_steps4;
	uint32_t collapse_count;
};

/* Simplifies in place, until at most target_triangles are left or no edge can be collapsed without
 * an error above error_most_steps (INFINITY: no limit). Remaining triangles move to the front.
 * Vertices keep their index; those that moved are changed. At least one triangle stays. Returns
 * -ENOMEM; the surface is then unusable. */
must_check int simplify(struct simplify_surface *surface, uint32_t target_triangles,
			double error_most_steps, struct simplify_result *result);

#endif
