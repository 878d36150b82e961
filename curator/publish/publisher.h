/* The publisher: another process than the web server, and on a museum's machine another user, who
 * alone can read the signing keys. Waits for request.json, runs gopura-content, and writes what
 * became of it (curator/publish/publish_files.h). Once a day it has signed anew what runs out: the
 * timestamp is valid for 30 days. Killed at any moment, it goes on where it was when it starts
 * again: building is idempotent, and going back is not done twice. */
#ifndef GOPURA_CURATOR_PUBLISH_PUBLISHER_H
#define GOPURA_CURATOR_PUBLISH_PUBLISHER_H

#include <stdbool.h>

#include "base/compiler.h"
#include "base/diagnostics.h"

/* All borrowed. */
struct publisher_options {
	const char *folder;  /* the content folder */
	const char *release; /* the release folder; made by the first build */
	const char *keys;    /* NULL: as gopura-content chooses */
	const char *program; /* gopura-content */
	const char *jobs;    /* its --jobs; NULL: all cores */
	bool once;           /* works off what waits, and ends */
};

/* Runs until SIGTERM or SIGINT, which also end a build that runs. -EBUSY: another one runs there;
 * errors of the disk; all with a diagnostic. With `once`, -EIO: the request failed. */
must_check int publisher_run(const struct publisher_options *options,
			     struct diagnostics *diagnostics);

#endif
