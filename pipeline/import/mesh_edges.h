/* The edges of a mesh, each with its faces. Vertices at the same place count as one. Private to the
 * mesh repair. */
#ifndef GOPURA_PIPELINE_IMPORT_MESH_EDGES_H
#define GOPURA_PIPELINE_IMPORT_MESH_EDGES_H

#include <stdatomic.h>
#include <stdbool.h>

#include "pipeline/import/mesh.h"

struct mesh_edge {
	uint32_t ends[2];    /* for each end, the first vertex at that place */
	uint32_t face_count; /* 1: border; 2: normal; more: non-manifold */
	uint32_t faces[2];   /* the second one only if face_count > 1 */
	bool turned;         /* the edge has two faces, and they are oriented oppositely */
};

struct mesh_edges {
	const struct mesh *mesh; /* borrowed */
	uint32_t *place;         /* of mesh_places; owned */
	uint32_t jobs;
	/* how many edges have their lower end among each EDGES_BIN vertices; owned */
	atomic_uint *bins;
	/* lowest and highest lower end of the edges of each EDGES_BLOCK faces; owned */
	uint32_t (*bounds)[2];
};

/* Prepares to go through the edges of mesh, which must have fewer than 2^31 vertices. It must stay,
 * and only the order of a face's corners may change. jobs: number of threads. -ENOMEM, -ENOSPC;
 * then *out is zeroed. */
must_check int mesh_edges_init(struct mesh_edges *out, const struct mesh *mesh, uint32_t jobs);
/* The same, if it is known which vertices are at one place. place: of mesh_places; taken, even on
 * failure. */
must_check int mesh_edges_init_placed(struct mesh_edges *out, const struct mesh *mesh,
				      uint32_t *place, uint32_t jobs);
void mesh_edges_finish(struct mesh_edges *edges); /* NULL and zeroed are fine */

/* Calls visit once for each edge, in an order that only depends on the mesh; one call at a time,
 * but from several threads. Takes memory for a part of the edges at a time. -ENOMEM. */
must_check int mesh_edges_each(const struct mesh_edges *edges,
			       void (*visit)(void *data, const struct mesh_edge *edge), void *data);

#endif
