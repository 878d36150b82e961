/* A list of faces of a scan, as a part's region names them (docs/information.md): a text file of
 * numbers and ranges such as 17 or 20-31, separated by white space; # begins a comment. */
#ifndef GOPURA_PIPELINE_IMPORT_FACE_LIST_H
#define GOPURA_PIPELINE_IMPORT_FACE_LIST_H

#include "base/diagnostics.h"
#include "pipeline/import/mesh.h"

struct face_range {
	uint32_t first, last; /* both inclusive */
};

struct face_list {
	struct face_range *ranges; /* owned; ascending, neither overlapping nor touching */
	uint32_t count;
};

/* Reads the list. path is opened; name is used in messages. face_count: faces of the scan,
 * which are numbered from 0. The caller finishes *out; it is zeroed on failure. -EINVAL: not a
 * valid list; diagnostics names the file, the line and how to correct it. Others: the file cannot
 * be read. */
must_check int face_list_read(struct face_list *out, const char *path, const char *name,
			      uint32_t face_count, struct diagnostics *diagnostics);
void face_list_finish(struct face_list *list); /* NULL and zeroed are fine */

/* Finds the triangles of one scan of the mesh that come from these faces, in ascending order. *out
 * is owned by the caller (free). -ENOMEM. */
must_check int face_list_triangles(uint32_t **out, uint32_t *count, const struct face_list *list,
				   const struct mesh *mesh, uint32_t scan);

#endif
