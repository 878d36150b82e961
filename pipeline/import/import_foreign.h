/* Reads scans with assimp in a sandbox. Private to pipeline/import/import*.c. */
#ifndef GOPURA_PIPELINE_IMPORT_IMPORT_FOREIGN_H
#define GOPURA_PIPELINE_IMPORT_IMPORT_FOREIGN_H

#include "pipeline/import/import.h"

struct import_foreign_format {
	const char *extension; /* the extension by which assimp recognises it, such as ".obj" */
	bool is_linear;        /* colours are linear light, not sRGB */
	bool has_materials;    /* false: ignore the grey material that assimp adds */
};

/* Reads a scan with assimp in a sandbox, with the same result as import_ply but for the transform,
 * which is not applied. Also -ETIMEDOUT,
 * -ENOMEM, -EBADMSG as sandbox_run. */
must_check int import_foreign(struct mesh *out, const char *path,
			      struct import_foreign_format format,
			      const struct import_options *options, struct import_report *report,
			      struct diagnostics *diagnostics);

#endif
