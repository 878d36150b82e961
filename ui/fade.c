/* Moves the alpha of something that appears or disappears. */
#include "ui/fade.h"

#include <math.h>

bool fade_advance(struct fade *fade, int64_t step_ms)
{
	float target = fade->on ? 1 : 0, step = (float)step_ms / FADE_MS;

	if (fade->alpha == target)
		return false;
	fade->alpha = fade->on ? fminf(fade->alpha + step, 1) : fmaxf(fade->alpha - step, 0);
	return fade->alpha != target;
}

float fade_eased(const struct fade *fade)
{
	return fade->alpha * (2 - fade->alpha);
}
