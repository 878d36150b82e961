/* Counts refusals and records the last one with its time. */
#include "base/metrics_refusal.h"

#include <stdio.h>

#include "base/clock.h"

void metrics_refusal_note(struct metrics_refusal *refusal, const char *what, const char *why)
{
	if (!refusal)
		return;
	refusal->count++;
	refusal->at_s = clock_wall_s();
	snprintf(refusal->what, sizeof(refusal->what), "%s", what);
	snprintf(refusal->why, sizeof(refusal->why), "%s", why);
}
