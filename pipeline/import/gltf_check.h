/* What assimp 5.2 would read wrong of a glTF file without a word: it does not know the extensions
 * that a file says one must know, and it takes texture coordinates for floats. Private to the
 * import. */
#ifndef GOPURA_PIPELINE_IMPORT_GLTF_CHECK_H
#define GOPURA_PIPELINE_IMPORT_GLTF_CHECK_H

#include "base/bytes.h"
#include "base/diagnostics.h"

/* Looks for extensionsRequired in the JSON of a glTF or GLB file (its whole bytes, or as many as
 * hold the JSON). Returns -ENOTSUP, and diagnostics names path, the extension and the command that
 * makes a file without it; 0 if nothing that matters is required, or the JSON cannot be found: its
 * reader will say why. */
must_check int gltf_check_extensions(struct bytes file, const char *path,
				     struct diagnostics *diagnostics);
/* Looks for texture coordinates of 8 or 16 bits, likewise. Also -ENOMEM. */
must_check int gltf_check_coordinates(struct bytes file, const char *path,
				      struct diagnostics *diagnostics);

#endif
