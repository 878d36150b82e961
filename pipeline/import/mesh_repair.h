/* Repairs defects of scans, so that later stages need not handle them. */
#ifndef GOPURA_PIPELINE_IMPORT_MESH_REPAIR_H
#define GOPURA_PIPELINE_IMPORT_MESH_REPAIR_H

#include "pipeline/import/mesh.h"

enum mesh_fault { MESH_FAULT_BORDER, MESH_FAULT_NON_MANIFOLD, MESH_FAULT_TURNED, MESH_FAULTS };

/* Where a fault is that was counted: the middle of an edge. */
struct mesh_fault_place {
	enum mesh_fault kind;
	float place_m[3];
};

enum { MESH_FAULT_PLACES_MAX = 1024 };

struct mesh_repairs {
	uint32_t lost_faces;         /* dropped: a corner is not finite */
	uint32_t degenerate_faces;   /* dropped: two corners at the same place */
	uint32_t merged_vertices;    /* same place, colour and uv as an earlier one */
	uint32_t unused_vertices;    /* removed: no face uses them (any more) */
	uint32_t border_edges;       /* of one face only: the scan is open there; tolerated */
	uint32_t non_manifold_edges; /* of three or more faces; tolerated */
	uint32_t turned_faces; /* turned to match the larger part of the surface around them */
	uint32_t turned_edges; /* of two faces that still disagree; tolerated */
	/* Every place_step-th of these edges. */
	uint32_t place_count, place_step;
	struct mesh_fault_place places[MESH_FAULT_PLACES_MAX];
};

/* Repairs mesh in place and keeps the order of what remains. Edges are compared by place, so a
 * texture seam is not a border. Edges are not examined from 2^31 vertices on. Indices must be below
 * vertex_count. jobs: number of threads; the result does not depend on it. *repairs gets the
 * counts. -ENOMEM, -ENOSPC. */
must_check int mesh_repair(struct mesh *mesh, uint32_t jobs, struct mesh_repairs *repairs);

#endif
