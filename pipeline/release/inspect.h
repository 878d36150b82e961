/* Prints readable summaries of a release, or of a file of one, to `to`. */
#ifndef GOPURA_PIPELINE_RELEASE_INSPECT_H
#define GOPURA_PIPELINE_RELEASE_INSPECT_H

#include <stdio.h>

#include "pipeline/release/release_reader.h"

/* Summarises an object, locator, signed file or picture, recognised by its first bytes. Tiles have
 * no such bytes and are not recognised. Returns -EBADMSG if it is damaged or of no known form (a
 * line says so). */
must_check int inspect_bytes(FILE *to, struct bytes bytes);

/* Summarises a whole release: its signed file, its locator, its root page and the root's first
 * three children. Errors are printed to `to` as they occur. */
must_check int inspect_release(FILE *to, struct release_reader *reader);

/* Finds one object of the release, prints where it is, and summarises it. Returns -ENOENT if the
 * release has no such object. */
must_check int inspect_object(FILE *to, struct release_reader *reader, struct hash object);

#endif
