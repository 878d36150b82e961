/* Reads a file as scenery: what stands beside the scans and may move (format/scenery.h). */
#ifndef GOPURA_PIPELINE_IMPORT_IMPORT_SCENERY_H
#define GOPURA_PIPELINE_IMPORT_IMPORT_SCENERY_H

#include "pipeline/import/import.h"
#include "pipeline/scene/scenery_maker.h"

/* Adds the file at path below a new node of the layer, or of none (SCENERY_NONE). Axes and unit are
 * those of options. What is left out is a diagnostic in warnings. Returns a negative errno with a
 * diagnostic that names file, place and cure. */
must_check int import_scenery(struct scenery_maker *maker, const char *path, uint32_t layer,
			      const struct import_options *options, struct diagnostics *diagnostics,
			      struct diagnostics *warnings);

#endif
