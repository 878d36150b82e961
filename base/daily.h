/* A time of day that comes back every day, as "22:00-06:00": local time, as the TZ of the process
 * has it. Pure. */
#ifndef GOPURA_BASE_DAILY_H
#define GOPURA_BASE_DAILY_H

#include <stdbool.h>
#include <stdint.h>

#include "base/compiler.h"

struct daily {
	int from_min, until_min; /* minutes of the day; equal: always, as in { 0 } */
};

/* HH:MM-HH:MM, from 00:00 to 24:00; past midnight where the end is earlier. -EINVAL. */
must_check int daily_parse(struct daily *out, const char *text);
/* wall_s: seconds since 1970. The end itself is outside. */
bool daily_holds(const struct daily *daily, int64_t wall_s);

#endif
