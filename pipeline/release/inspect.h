/* Prints readable summaries of a release, or of a file of one, to `to`. */
#ifndef GOPURA_PIPELINE_RELEASE_INSPECT_H
#define GOPURA_PIPELINE_RELEASE_INSPECT_H

#include <stdio.h>

#include "pipeline/release/release_reader.h"

/* Summarises an object, locator, signed file or picture, recognised by its first bytes. Tiles have
 * no such bytes and are not recognised. Returns -EBADMSG if it is damaged or of no known form (a
 * line says so). */
must_check int inspect_bytes(FILE *to, struct bytes bytes);

#endif
