/* Parses a daily time span such as 22:00-06:00, and tests whether a moment lies in it. */
#include "base/daily.h"

#include <errno.h>
#include <stdio.h>
#include <string.h>
#include <time.h>

enum { DAY_MIN = 24 * 60 };

int daily_parse(struct daily *out, const char *text)
{
	int hours[2], minutes[2];
	char end;

	/* Every position must hold a digit or the given sign: no signs, no spaces, nothing left
	 * out. */
	if (strlen(text) != 11 || strspn(text, "0123456789:-") != 11 ||
	    sscanf(text, "%2d:%2d-%2d:%2d%c", &hours[0], &minutes[0], &hours[1], &minutes[1],
		   &end) != 4)
		return -EINVAL;
	for (int i = 0; i < 2; i++) {
		const int at = hours[i] * 60 + minutes[i];

		if (hours[i] < 0 || minutes[i] < 0 || minutes[i] > 59 || at > DAY_MIN)
			return -EINVAL;
		*(i == 0 ? &out->from_min : &out->until_min) = at;
	}
	return 0;
}

bool daily_holds(const struct daily *daily, int64_t wall_s)
{
	const time_t now = (time_t)wall_s;
	struct tm local;
	int at;

	if (daily->from_min == daily->until_min || !localtime_r(&now, &local))
		return true;
	at = local.tm_hour * 60 + local.tm_min;
	if (daily->from_min < daily->until_min)
		return at >= daily->from_min && at < daily->until_min;
	return at >= daily->from_min || at < daily->until_min;
}
