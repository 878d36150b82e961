/* Reads a PLY scan into a mesh. Private to pipeline/import/import*.c. */
#ifndef GOPURA_PIPELINE_IMPORT_IMPORT_PLY_H
#define GOPURA_PIPELINE_IMPORT_IMPORT_PLY_H

#include "pipeline/import/import.h"

/* Reads a PLY. Like every reader, it gives the mesh in the file's unit and axes, with valid
 * indices, not repaired. It applies the transform, because places may have more digits in the file
 * than in a mesh. Errors as import_scan. */
must_check int import_ply(struct mesh *out, const char *path, const struct import_options *options,
			  struct import_report *report, struct diagnostics *diagnostics);
/* Reads only the header of a PLY, and refuses one that has no surface. Errors as import_scan. */
must_check int import_ply_check(const char *path, struct diagnostics *diagnostics);
/* import_is_points for a file that is a PLY; *points is set only if it is. */
bool import_ply_is_points(const char *path, uint64_t *points);
/* import_names_files for a file that is a PLY. */
must_check int import_ply_names_files(const char *path);

#endif
