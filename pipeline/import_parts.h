/* What the sources of import share. Private to pipeline/import*.c. */
#ifndef GOPURA_PIPELINE_IMPORT_PARTS_H
#define GOPURA_PIPELINE_IMPORT_PARTS_H

#include "base/bytes.h"
#include "pipeline/import.h"

/* Readers give the mesh in the file's unit and axes, indices in range, not repaired. */
must_check int import_ply(struct mesh *out, const char *path, struct import_report *report,
			  struct fault *fault);

struct import_foreign_format {
	bool is_linear;     /* its colours are linear light, not sRGB */
	bool has_materials; /* assimp makes up a grey one for the others */
};

must_check int import_foreign(struct mesh *out, const char *path,
			      struct import_foreign_format format,
			      const struct import_options *options, struct import_report *report,
			      struct fault *fault);

/* The picture that a scan names. Looked for beside the scan: as named where that stays within the
 * scan's folder, else by its last component (exporters like to write C:\Users\...). A picture that
 * is missing or damaged is tolerated: a warning, and one pixel of the plain colour. -ENOMEM. */
must_check int import_texture(struct mesh_texture *out, const char *scan_path, const char *name,
			      const uint8_t plain[3], struct import_report *report);
/* The same for a picture that lies in the scan itself. */
must_check int import_texture_bytes(struct mesh_texture *out, const char *scan_path,
				    const char *name, struct bytes file, const uint8_t plain[3],
				    struct import_report *report);
must_check int import_texture_plain(struct mesh_texture *out, const uint8_t plain[3]);

#endif
