/* Reads the release of The Update Framework as a terminal would: by the client workflow, over a
 * release_reader, with nothing stored but the first root. */
#ifndef GOPURA_PIPELINE_RELEASE_TUF_READING_H
#define GOPURA_PIPELINE_RELEASE_TUF_READING_H

#include "format/metadata.h"
#include "pipeline/release/release_reader.h"
#include "tuf/workflow.h"

struct tuf_reading {
	struct tuf_client client; /* what was accepted */
	char why[512];            /* after a failure, for people */
};

/* root: the first one, trusted; empty: the release's own tuf/1.root.json. target: NULL:
 * "release.json". now_s as for struct verify_options. Appends release.json to *file and decodes it
 * into *out, unless NULL. Returns 0; -ENOENT: no root or no target; or as tuf_client_refresh; why
 * is set. tuf_reading_finish frees *reading, also after a failure. */
must_check int tuf_reading_release(struct tuf_reading *reading, struct release_reader *reader,
				   struct bytes root, const char *target, int64_t now_s,
				   struct release *out, struct buffer *file);
void tuf_reading_finish(struct tuf_reading *reading);

#endif
