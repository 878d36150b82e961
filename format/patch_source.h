/* The patches of a group as the patch encoder reads them: one mesh in which the vertices that
 * several patches share are one vertex, and whose triangles are found by their edges. Private to
 * format/. */
#ifndef GOPURA_FORMAT_PATCH_SOURCE_H
#define GOPURA_FORMAT_PATCH_SOURCE_H

#include <stdbool.h>

#include "base/compiler.h"
#include "format/patch_mesh.h"

#define SOURCE_NONE UINT32_MAX

struct patch_source {
	uint32_t patch_count, vertex_count, triangle_count;
	struct patch_vertex *vertices; /* owned */
	uint32_t (*triangles)[3];      /* owned; patch after patch */
	uint8_t *patches;              /* owned; the patch of each triangle */
	bool *coded;                   /* owned; for each triangle */
	/* owned; vertices that no triangle of their patch names, patch after patch */
	uint32_t *loose;
	uint32_t loose_count;
	/* owned; hash table of directed edges, as chains of 3 * triangle + corner */
	uint32_t *heads, *nexts;
	uint32_t mask;
};

/* The patches are borrowed for the call; their counts and indices must be in range. *out is owned
 * by the caller: end it with patch_source_finish, after a failure too. Returns -ENOMEM. */
must_check int patch_source_init(struct patch_source *out, const struct patch_mesh *patches,
				 uint32_t patch_count);
void patch_source_finish(struct patch_source *source);

/* Returns the first triangle that is not coded and has this directed edge, as 3 * triangle + the
 * corner at which the edge begins; SOURCE_NONE if there is none. */
uint32_t patch_source_find(struct patch_source *source, uint32_t from, uint32_t to);

#endif
