/* Decodes the pictures that a scan names. Private to pipeline/import/import*.c. */
#ifndef GOPURA_PIPELINE_IMPORT_IMPORT_TEXTURE_H
#define GOPURA_PIPELINE_IMPORT_IMPORT_TEXTURE_H

#include "base/bytes.h"
#include "pipeline/import/import.h"
#include "pipeline/import/import_files.h"

/* Decodes a picture that the scan names. A missing, outside or damaged picture is tolerated: a
 * warning, and one pixel of the plain colour. *out is owned by the caller. -ENOMEM. */
must_check int import_texture(struct mesh_texture *out, struct import_files *files,
			      const char *name, const uint8_t plain[3],
			      struct import_report *report);
/* The same for a picture embedded in the scan. */
must_check int import_texture_bytes(struct mesh_texture *out, const char *scan_path,
				    const char *name, struct bytes file, const uint8_t plain[3],
				    struct import_report *report);
/* Makes a texture of one pixel of the plain colour; owned by the caller. -ENOMEM. */
must_check int import_texture_plain(struct mesh_texture *out, const uint8_t plain[3]);

#endif
