/* The scenes of a content folder: scenes.json, and the files in scenes/ that it names. See
 * docs/scenery.md. */
#ifndef GOPURA_PIPELINE_CONTENT_SCENES_H
#define GOPURA_PIPELINE_CONTENT_SCENES_H

#include "format/scenery.h"
#include "pipeline/content/content.h"

/* Reads and checks all of it. Zeroed if there is no scenes.json; the caller ends it with
 * scenery_finish. Every fault and every warning is added to diagnostics. Returns -EINVAL if there
 * were faults, -ENOMEM, or the error of reading scenes.json; *out is then zeroed. */
must_check int scenes_read(struct scenery *out, const struct content *content,
			   struct diagnostics *diagnostics);

#endif
