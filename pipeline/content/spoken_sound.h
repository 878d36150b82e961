/* Judges recordings of spoken texts: complete Ogg Opus files that every terminal plays
 * (docs/sound.md). */
#ifndef GOPURA_PIPELINE_CONTENT_SPOKEN_SOUND_H
#define GOPURA_PIPELINE_CONTENT_SPOKEN_SOUND_H

#include <stdbool.h>

#include "base/bytes.h"

enum { CUES_FILE_BYTES_MAX = 256 << 10 }; /* of its words (pipeline/content/cues.h) */

/* Decodes a file to its end, so that a terminal finds no fault in it, and measures it; skims: looks
 * at its pages only, for a check while somebody waits. *duration_ms is 1 to INFO_SPOKEN_MS_MAX.
 * -EBADMSG: it is not complete, or no Opus, or of more than two channels. -EFBIG: it is longer. */
must_check int spoken_sound_measure(struct bytes file, bool skims, uint32_t *duration_ms);

#endif
