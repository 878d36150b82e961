/* Where the whole picture lies on the panel over the hours, so that lines that never change (a
 * page's frame, a callout's edge) do not burn into one row of pixels. Pure. */
#ifndef GOPURA_RENDER_DISPLAY_SHIFT_H
#define GOPURA_RENDER_DISPLAY_SHIFT_H

#include <stdint.h>

enum {
	SHIFT_MOST_PX = 4, /* each way: less than a frame around a panel hides */
	SHIFT_STEP_MS = 40000,
};

/* One pixel a step, over every place within SHIFT_MOST_PX and back, an hour and three quarters in
 * all. time_ms counts from anywhere. */
void shift_at(int64_t time_ms, int shift_px[2]);

#endif
