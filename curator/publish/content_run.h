/* Runs gopura-content as a child, whose output goes to a log in DIR/.curator/publish. */
#ifndef GOPURA_CURATOR_PUBLISH_CONTENT_RUN_H
#define GOPURA_CURATOR_PUBLISH_CONTENT_RUN_H

#include "curator/publish/publish_files.h"

/* All borrowed. */
struct content_run_options {
	const char *program, *folder, *release;
	const char *keys, *jobs; /* NULL: not given */
	bool renew;              /* publish --renew */
	uint64_t sequence;       /* otherwise: above 0: publish --sequence; 0: build */
	const char *comment;     /* "": none */
	int stop_fd;             /* readable: the child is to end */
};

/* Waits for the child, which dies with us. -EIO: it failed, and message says why, in one line of
 * UTF-8; -ECANCELED: stop_fd became readable, and the child has ended. */
must_check int content_run(const struct content_run_options *options,
			   char message[PUBLISH_MESSAGE_BYTES]);

#endif
