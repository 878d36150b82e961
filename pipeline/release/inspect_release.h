/* Prints readable summaries of a whole release, or of one object of it, to `to`. */
#ifndef GOPURA_PIPELINE_RELEASE_INSPECT_RELEASE_H
#define GOPURA_PIPELINE_RELEASE_INSPECT_RELEASE_H

#include "pipeline/release/release_reader.h"
#include <stdio.h>

/* Summarises a whole release: its signed file, its locator, its root page and the root's first
 * three children. Errors are printed to `to` as they occur. target, also below: which target of The
 * Update Framework is the release; NULL: release.json, of either form. */
must_check int inspect_release(FILE *to, struct release_reader *reader, const char *target);

/* Finds one object of the release, prints where it is, and summarises it. Returns -ENOENT if the
 * release has no such object. */
must_check int inspect_object(FILE *to, struct release_reader *reader, const char *target,
			      struct hash object);

#endif
