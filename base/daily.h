/* A time span that repeats every day, such as "22:00-06:00", in local time by the TZ of the
 * process. */
#ifndef GOPURA_BASE_DAILY_H
#define GOPURA_BASE_DAILY_H

#include <stdbool.h>
#include <stdint.h>

#include "base/compiler.h"

struct daily {
	int from_min, until_min; /* minutes since midnight; equal: the whole day, as in { 0 } */
};

/* Parses HH:MM-HH:MM, from 00:00 to 24:00; the span passes midnight if its end is earlier than its
 * start. Returns 0 or -EINVAL. */
must_check int daily_parse(struct daily *out, const char *text);
/* Returns whether the span contains wall_s, in seconds since 1970. Its end is not part of it. */
bool daily_holds(const struct daily *daily, int64_t wall_s);

#endif
