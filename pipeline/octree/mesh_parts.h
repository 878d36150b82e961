/* The connected parts of a mesh. */
#ifndef GOPURA_PIPELINE_OCTREE_MESH_PARTS_H
#define GOPURA_PIPELINE_OCTREE_MESH_PARTS_H

#include <stdbool.h>

#include "pipeline/import/mesh.h"

/* Counts the parts: triangles that share a vertex belong to one part, and so does a vertex alone.
 * -ENOMEM, -ENOSPC. */
must_check int mesh_parts_count(const struct mesh *mesh, uint32_t *out);
/* Sets *out to the first vertex of each vertex's part; owned by the caller (spill_free). -ENOMEM,
 * -ENOSPC. */
must_check int mesh_parts_find(const struct mesh *mesh, uint32_t **out);
/* Removes the parts that have less than a share of the triangles of the largest one, with their
 * vertices; with_cavities: also those that enclose a volume below 0, which is for closed meshes.
 * The order of what stays is kept. The mesh has no textures, faces or materials. *dropped: how many
 * parts. -ENOMEM, -ENOSPC: nothing changed. */
must_check int mesh_parts_drop(struct mesh *mesh, double share, bool with_cavities,
			       uint32_t *dropped);

#endif
