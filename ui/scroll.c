/* Moves a scroll position, by fingers and by itself. */
#include "ui/scroll.h"

#include <math.h>

enum { SLOWDOWN_MS = 350, LEAST_PX_PER_S = 20 };

void scroll_by(struct scroll *scroll, int most_px, float by_px)
{
	float to_px = scroll->px + by_px;

	scroll->px = fminf(fmaxf(to_px, 0), (float)most_px);
	if (scroll->px != to_px)
		scroll->px_per_s = 0;
}

bool scroll_advance(struct scroll *scroll, int most_px, int64_t step_ms)
{
	if (scroll->px_per_s == 0)
		return false;
	scroll_by(scroll, most_px, scroll->px_per_s * (float)step_ms / 1000);
	scroll->px_per_s *= expf(-(float)step_ms / SLOWDOWN_MS);
	if (fabsf(scroll->px_per_s) < LEAST_PX_PER_S)
		scroll->px_per_s = 0;
	return scroll->px_per_s != 0;
}
