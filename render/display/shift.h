/* Pixel shift: moves the whole picture slowly over the panel, so that lines that never change (the
 * frame of a page, the edge of a callout) do not burn in. Pure function. */
#ifndef GOPURA_RENDER_DISPLAY_SHIFT_H
#define GOPURA_RENDER_DISPLAY_SHIFT_H

#include <stdint.h>

enum {
	SHIFT_MOST_PX = 4, /* in each direction; less than the bezel of a panel hides */
	SHIFT_STEP_MS = 40000,
};

/* Writes the offset of the picture at a time. It moves one pixel per step, over every position
 * within SHIFT_MOST_PX and back, in 108 minutes. time_ms may count from any start, and must not be
 * negative. */
void shift_at(int64_t time_ms, int shift_px[2]);

#endif
