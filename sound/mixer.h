/* Opens the mixer of ALSA's default card: cards are muted after a start. */
#ifndef GOPURA_SOUND_MIXER_H
#define GOPURA_SOUND_MIXER_H

/* Turns on every playback control of the card, and sets it to 0 dB, or to four fifths of its range
 * if it does not tell. How loud it is is then decided by the samples alone. A card without a mixer
 * is left as it is. */
void mixer_open_up(void);

#endif
