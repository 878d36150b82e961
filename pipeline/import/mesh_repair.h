/* What scans bring that later stages should not have to know about. */
#ifndef GOPURA_PIPELINE_IMPORT_MESH_REPAIR_H
#define GOPURA_PIPELINE_IMPORT_MESH_REPAIR_H

#include "pipeline/import/mesh.h"

struct mesh_repairs {
	uint32_t lost_faces;         /* dropped: a corner is not finite */
	uint32_t degenerate_faces;   /* dropped: two corners at one place */
	uint32_t merged_vertices;    /* equal in place, colour and uv to an earlier one */
	uint32_t unused_vertices;    /* removed: no face uses them (any more) */
	uint32_t border_edges;       /* of one face only: the scan is open there; tolerated */
	uint32_t non_manifold_edges; /* of three faces or more; tolerated */
	uint32_t turned_faces;       /* turned to the side that the larger part around them shows */
	uint32_t turned_edges;       /* of two faces that still show opposite sides; tolerated */
};

/* Repairs mesh in place; the order of what remains does not change. Edges are judged by place, so
 * that a seam of the texture is no border; they are not counted past 2^31 vertices. Indices must be
 * below vertex_count. -ENOMEM. */
must_check int mesh_repair(struct mesh *mesh, struct mesh_repairs *repairs);

#endif
