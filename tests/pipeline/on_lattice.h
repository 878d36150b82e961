/* Puts a whole mesh on the lattice of its own box, open edges included. */
#ifndef GOPURA_TESTS_PIPELINE_ON_LATTICE_H
#define GOPURA_TESTS_PIPELINE_ON_LATTICE_H

#include "pipeline/hierarchy/lattice_mesh.h"

static inline int on_lattice(struct lattice_mesh *out, struct lattice_counts *counts,
			     const struct mesh *mesh)
{
	static const uint8_t grey[3] = { 128, 128, 128 };
	float low[3], high[3];
	struct lattice lattice;
	int rc;

	mesh_box(mesh, low, high);
	rc = lattice_of_box(&lattice, low, high, LATTICE_STEP_MAX_M);
	if (rc == 0)
		rc = lattice_mesh_create(out, counts, mesh, &lattice, grey);
	return rc < 0 ? rc : lattice_mesh_find_borders(out, counts, NULL);
}

#endif
