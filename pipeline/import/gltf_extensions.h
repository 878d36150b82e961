/* Extensions that a glTF file says one must know to read it. assimp 5.2 reads on without them and
 * gives places that are wrong. Private to the import. */
#ifndef GOPURA_PIPELINE_IMPORT_GLTF_EXTENSIONS_H
#define GOPURA_PIPELINE_IMPORT_GLTF_EXTENSIONS_H

#include "base/bytes.h"
#include "base/diagnostics.h"

/* Looks for extensionsRequired in the JSON of a glTF or GLB file (its whole bytes, or as many as
 * hold the JSON). Returns -ENOTSUP, and diagnostics names path, the extension and the command that
 * makes a file without it; 0 if nothing that matters is required, or the JSON cannot be found: its
 * reader will say why. */
must_check int gltf_extensions_check(struct bytes file, const char *path,
				     struct diagnostics *diagnostics);

#endif
