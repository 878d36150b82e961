/* The words of a spoken text and when they are said: the cues of a WebVTT file (W3C). Private to
 * pipeline/content. */
#ifndef GOPURA_PIPELINE_CONTENT_CUES_H
#define GOPURA_PIPELINE_CONTENT_CUES_H

#include "base/bytes.h"
#include "base/diagnostics.h"
#include "storage/info_spoken.h"

struct cues {
	struct info_cue *all; /* owned, and so are their texts */
	uint32_t count, room;
};

/* Reads the cues in the order of the file, which must be that of their times. Tags are left out,
 * lines of a cue are joined by spaces; comments, styles, regions and the places of cues are
 * skipped. file is named in diagnostics. Returns 0; -EINVAL after every fault was added; -ENOMEM.
 * The caller finishes *out, which is empty on failure. */
must_check int cues_read(struct cues *out, struct bytes text, const char *file,
			 struct diagnostics *diagnostics);
void cues_finish(struct cues *cues); /* NULL and zeroed are fine */

#endif
