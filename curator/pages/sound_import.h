/* Recordings that curators send. */
#ifndef GOPURA_CURATOR_PAGES_SOUND_IMPORT_H
#define GOPURA_CURATOR_PAGES_SOUND_IMPORT_H

#include "base/bytes.h"
#include "base/diagnostics.h"

/* Copies the sound of an Ogg Opus file, bit by bit, and nothing else of it: no comments, no
 * picture, no other streams, nothing between its pages. What is left is decoded to its end
 * (spoken_sound_measure). Both happen in a process of its own that can do nothing but compute
 * (pipeline/import/sandbox.h). Appends the result. -EBADMSG, -EFBIG: a terminal would not play it.
 * -ENOMEM, -ETIMEDOUT. With a diagnostic. */
must_check int sound_import(struct buffer *out, struct bytes file, struct diagnostics *diagnostics);

/* Copies the sound in this process, without decoding it, for sound_import and tests. -EBADMSG: it
 * is no Ogg Opus (RFC 7845). */
must_check int sound_import_copy(struct buffer *out, struct bytes file);

#endif
