/* Turns the comments of a IIIF manifest into W3C annotations such as annotations_import reads.
 * docs/iiif.md has the rules. Private to pipeline/content/annotations*.c. */
#ifndef GOPURA_PIPELINE_CONTENT_ANNOTATIONS_IIIF_IMPORT_H
#define GOPURA_PIPELINE_CONTENT_ANNOTATIONS_IIIF_IMPORT_H

#include <cjson/cJSON.h>

#include "base/json_text.h"
#include "pipeline/content/annotations_import.h"

struct annotations_comments {
	cJSON *items;    /* owned; annotations in metres with z up */
	unsigned *lines; /* owned; of each item in the manifest */
	uint32_t skipped_count;
};

/* Converts the manifest. What of it has no place among parts is added to options->diagnostics as
 * warnings. *out is owned by the caller; it is zeroed on failure. -EINVAL: faults were added to the
 * diagnostics. -ENOMEM. */
must_check int annotations_iiif_convert(struct annotations_comments *out,
					const struct json_text *json,
					const struct annotations_import_options *options,
					const char *language);

#endif
