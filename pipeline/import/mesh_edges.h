/* The edges of a mesh, each with its faces. Vertices at the same place count as one. Private to the
 * mesh repair. */
#ifndef GOPURA_PIPELINE_IMPORT_MESH_EDGES_H
#define GOPURA_PIPELINE_IMPORT_MESH_EDGES_H

#include <stdbool.h>

#include "pipeline/import/mesh.h"

struct mesh_edge {
	uint32_t ends[2];    /* for each end, the first vertex at that place */
	uint32_t face_count; /* 1: border; 2: normal; more: non-manifold */
	uint32_t faces[2];   /* the second one only if face_count > 1 */
	bool turned;         /* the edge has two faces, and they are oriented oppositely */
};

struct mesh_edges {
	uint32_t vertex_count;
	uint64_t *start; /* index of the first item of each vertex, and the end; owned */
	/* one per edge of a face, stored under its lower end, sorted; owned: other end << 33 |
	 * (runs from lower to other) << 32 | face */
	uint64_t *items;
};

/* Collects the edges; mesh is only read. It must have fewer than 2^31 vertices. -ENOMEM; then *out
 * is zeroed. */
must_check int mesh_edges_init(struct mesh_edges *out, const struct mesh *mesh);
void mesh_edges_finish(struct mesh_edges *edges); /* NULL and zeroed are fine */

/* Calls visit once for each edge, in a fixed order. */
void mesh_edges_each(const struct mesh_edges *edges,
		     void (*visit)(void *data, const struct mesh_edge *edge), void *data);

#endif
