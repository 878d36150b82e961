/* Something that fades in while it is on, and out while it is off. */
#ifndef GOPURA_UI_FADE_H
#define GOPURA_UI_FADE_H

#include <stdbool.h>
#include <stdint.h>

enum { FADE_MS = 180 };

struct fade {
	float alpha; /* grows and shrinks evenly, 0..1; drawn with fade_eased */
	bool on;
};

/* Advances a fade by step_ms. Returns true if it still moves. */
bool fade_advance(struct fade *fade, int64_t step_ms);
/* Returns the alpha to draw with. It slows down at the end, so that nothing stops abruptly. */
float fade_eased(const struct fade *fade);

#endif
