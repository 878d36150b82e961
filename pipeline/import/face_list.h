/* A list of faces of a scan, as a part's region names them (docs/information.md): a text file of
 * numbers and ranges, 17 or 20-31, apart by spaces or lines; # begins a comment. */
#ifndef GOPURA_PIPELINE_IMPORT_FACE_LIST_H
#define GOPURA_PIPELINE_IMPORT_FACE_LIST_H

#include "base/fault.h"
#include "pipeline/import/mesh.h"

struct face_range {
	uint32_t first, last; /* both belong to it */
};

struct face_list {
	struct face_range *ranges; /* owned; ascending, apart from one another */
	uint32_t count;
};

/* path as it is opened, name as faults tell it. face_count: of the scan, whose faces are numbered
 * from 0. *out is finished by the caller; zeroed on failure. -EINVAL: no such list; fault names
 * file, line and cure. */
must_check int face_list_read(struct face_list *out, const char *path, const char *name,
			      uint32_t face_count, struct fault *fault);
void face_list_finish(struct face_list *list); /* NULL and zeroed are fine */

/* The triangles of a scan of the mesh that come from these faces, ascending. *out is owned by the
 * caller (free). -ENOMEM. */
must_check int face_list_triangles(uint32_t **out, uint32_t *count, const struct face_list *list,
				   const struct mesh *mesh, uint32_t scan);

#endif
