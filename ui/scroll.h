/* How far something is scrolled, and how a fling carries on. */
#ifndef GOPURA_UI_SCROLL_H
#define GOPURA_UI_SCROLL_H

#include <stdbool.h>
#include <stdint.h>

struct scroll {
	float px;       /* how much is above the window */
	float px_per_s; /* of a fling that goes on by itself; 0: none */
};

/* Scrolls by by_px, between 0 and most_px. At an end, a fling stops. */
void scroll_by(struct scroll *scroll, int most_px, float by_px);
/* Advances a fling by step_ms. Returns true if it goes on. */
bool scroll_advance(struct scroll *scroll, int most_px, int64_t step_ms);

#endif
