/* Runs assimp inside the sandbox. Private to pipeline/import/import*.c. */
#ifndef GOPURA_PIPELINE_IMPORT_IMPORT_SCENE_H
#define GOPURA_PIPELINE_IMPORT_IMPORT_SCENE_H

#include "base/diagnostics.h"

struct aiScene;

/* Runs assimp in the sandbox. The parent opens all files: seen_path stands for the scan, other
 * names are as the scan gives them. The scene is borrowed until the process ends. NULL: diagnostics
 * says why. warning names a file that the scan names and that is missing. */
const struct aiScene *import_scene(const char *seen_path, const char *format_name,
				   struct diagnostics *warning, struct diagnostics *diagnostics);

#endif
