/* The edges of a mesh by place, each with its faces. Private to the repair of meshes. */
#ifndef GOPURA_PIPELINE_IMPORT_MESH_EDGES_H
#define GOPURA_PIPELINE_IMPORT_MESH_EDGES_H

#include <stdbool.h>

#include "pipeline/import/mesh.h"

struct mesh_edge {
	uint32_t ends[2];    /* the first vertices at its places */
	uint32_t face_count; /* 1: border; 2: as it should be */
	uint32_t faces[2];   /* the second only where face_count > 1 */
	bool turned;         /* of two faces, which show opposite sides */
};

struct mesh_edges {
	uint32_t vertex_count;
	uint64_t *start; /* of the items of each vertex, and the end; owned */
	uint64_t *items; /* an edge of a face, filed under its lower end, sorted; owned:
			  * other end << 33 | runs to it << 32 | face */
};

/* Vertices below 2^31. -ENOMEM, then *out is zeroed. */
must_check int mesh_edges_init(struct mesh_edges *out, const struct mesh *mesh);
void mesh_edges_finish(struct mesh_edges *edges); /* NULL and zeroed are fine */

/* Each edge once, in a fixed order. */
void mesh_edges_each(const struct mesh_edges *edges,
		     void (*visit)(void *data, const struct mesh_edge *edge), void *data);

#endif
