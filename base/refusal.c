/* Records the latest refusal with its time. */
#include "base/refusal.h"

#include <stdio.h>

#include "base/clock.h"

void refusal_note(struct refusal *refusal, const char *what, const char *why)
{
	if (!refusal)
		return;
	refusal->count++;
	refusal->at_s = clock_wall_s();
	snprintf(refusal->what, sizeof(refusal->what), "%s", what);
	snprintf(refusal->why, sizeof(refusal->why), "%s", why);
}
