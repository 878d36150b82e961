/* Converts the parts of a content folder to W3C Web Annotations (JSON-LD) with Dublin Core terms,
 * for exchange with other tools, and back. docs/annotations.md has the format. Used by the
 * publisher. */
#ifndef GOPURA_PIPELINE_CONTENT_ANNOTATIONS_H
#define GOPURA_PIPELINE_CONTENT_ANNOTATIONS_H

#include "pipeline/content/info_build.h"

enum { ANNOTATIONS_BYTES_MAX = 256 << 20 }; /* size limit of a file */

struct annotations {
	/* the file's text */
	struct buffer json;
	/* number of annotations */
	uint32_t count;
	/* owned; files that must lie beside the JSON file, such as "pictures/gate.jpg" */
	char **pictures;
	uint32_t picture_count;
};

/* Frees the contents. NULL and zeroed are fine. */
void annotations_finish(struct annotations *annotations);

#endif
