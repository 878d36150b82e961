/* Opens the mixer of ALSA's default card: cards are muted after a start. */
#ifndef GOPURA_SOUND_MIXER_H
#define GOPURA_SOUND_MIXER_H

#include <stdbool.h>

/* Turns on every playback control of the card, and sets it to 0 dB, or to four fifths of its range
 * if it does not tell. How loud it is is then decided by the samples alone. Controls of inputs are
 * left as they are, and so is a card without a mixer. */
void mixer_open_up(void);
/* Returns whether a control of that name passes an input on to the output, as "Front Mic" does: it
 * would make a microphone heard in the hall. */
bool mixer_is_input(const char *name);

#endif
