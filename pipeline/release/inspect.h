/* Readable summaries of what a release, or a file of one, holds. Prints to `to`. */
#ifndef GOPURA_PIPELINE_RELEASE_INSPECT_H
#define GOPURA_PIPELINE_RELEASE_INSPECT_H

#include <stdio.h>

#include "pipeline/release/release_reader.h"

/* Any object, locator, signed file, picture or master file, told by its first bytes. -EBADMSG: it
 * is damaged, or none of these (a line says so). */
must_check int inspect_bytes(FILE *to, struct bytes bytes);

/* A release as a whole: what is current, and its pages down to the bricks. Errors are printed to
 * `to` as they are met. */
must_check int inspect_release(FILE *to, struct release_reader *reader);

/* Finds one object of the release, says where it hangs and lies, and summarises it. -ENOENT: the
 * release has no such object. */
must_check int inspect_object(FILE *to, struct release_reader *reader, struct hash object);

#endif
