/* Reads VRML97 scans (pipeline/scene/vrml.h). Private to pipeline/import/import*.c. */
#ifndef GOPURA_PIPELINE_IMPORT_IMPORT_VRML_H
#define GOPURA_PIPELINE_IMPORT_IMPORT_VRML_H

#include "pipeline/import/import.h"

/* Reads the surface of a scene at rest, with the same result as import_foreign. Every corner has a
 * vertex of its own. Errors as import_scan. */
must_check int import_vrml(struct mesh *out, const char *path, const struct import_options *options,
			   struct import_report *report, struct diagnostics *diagnostics);

#endif
