/* Recordings that curators send. */
#ifndef GOPURA_CURATOR_PAGES_SOUND_CHECK_H
#define GOPURA_CURATOR_PAGES_SOUND_CHECK_H

#include "base/bytes.h"
#include "base/diagnostics.h"

/* Decodes a file as spoken_sound_measure does, in a process of its own that can do nothing but
 * compute (pipeline/import/sandbox.h). -EBADMSG, -EFBIG: a terminal would not play it. -ENOMEM,
 * -ETIMEDOUT. With a diagnostic. */
must_check int sound_check(struct bytes file, struct diagnostics *diagnostics);

#endif
