/* Plays a spoken text: Opus in Ogg, by libopusfile, to ALSA's default device. Decoding and the
 * device have a thread of their own, which is started with the first text, so a terminal that never
 * speaks pays nothing, and whoever asks never waits for the device. docs/sound.md. */
#ifndef GOPURA_SOUND_SPEAKER_H
#define GOPURA_SOUND_SPEAKER_H

#include <stdbool.h>

#include "base/bytes.h"

struct speaker;

enum { SPEAKER_LOUDNESS_MAX = 100 };

struct speaker_state {
	bool speaks;    /* from speaker_start to the end of the text, speaker_stop or a fault */
	bool failed;    /* the device or the text did not work; logged. Until the next start */
	uint32_t at_ms; /* what is heard now */
};

/* loudness: 1 to SPEAKER_LOUDNESS_MAX. *out is owned by the caller; NULL on failure. -ENOMEM. */
must_check int speaker_create(struct speaker **out, uint32_t loudness);
/* Ends what is spoken, and waits for the thread, at most about a fifth of a second. NULL is fine.
 */
void speaker_destroy(struct speaker *speaker);

/* Begins a text, in place of what is spoken. opus is copied. -ENOMEM, or the errno of
 * pthread_create. A fault of text or device shows later, in the state. */
must_check int speaker_start(struct speaker *speaker, struct bytes opus);
/* Ends what is spoken. It is silent within a fifth of a second. */
void speaker_stop(struct speaker *speaker);
/* Returns what it does now. NULL is fine: nothing. */
struct speaker_state speaker_state(struct speaker *speaker);

#endif
