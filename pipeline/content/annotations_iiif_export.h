/* Makes a IIIF manifest of a content folder: its scans are painted into a scene, its parts are
 * comments. docs/iiif.md has the format. Private to pipeline/content/annotations*.c. */
#ifndef GOPURA_PIPELINE_CONTENT_ANNOTATIONS_IIIF_EXPORT_H
#define GOPURA_PIPELINE_CONTENT_ANNOTATIONS_IIIF_EXPORT_H

#include <cjson/cJSON.h>

#include "pipeline/content/draft.h"

/* json is the folder's parts.json, which draft was read from; base is where the files will be
 * published, with or without a slash at its end; model is the file that is painted in place of the
 * scans (metres, y up), NULL: the scans. What a manifest cannot say is added to the draft's
 * diagnostics as warnings. *out is owned by the caller; NULL on failure. -EINVAL: the folder's
 * temple.ini has faults, which were added to the diagnostics. -ENOMEM. */
must_check int annotations_iiif_make(cJSON **out, const struct draft *draft, const cJSON *json,
				     const char *base, const char *model);

#endif
