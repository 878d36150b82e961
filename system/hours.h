/* Opening hours of a week, as people write them, and what the clock says of them. Pure: no clock is
 * read and no file but the time zone's.
 *
 *   Mo-Fr 09:00-18:00, Sa 10:00-17:00     Sunday is closed
 *   Mo,We-Fr 9:00-12:00, 14:00-18:00      more times of the same days
 *   Fr-Sa 18:00-02:00                     over midnight: also Saturday and Sunday morning
 *   08:30-24:00                           every day
 *
 * Days are English, two letters or more; a semicolon does as well as a comma. */
#ifndef GOPURA_SYSTEM_HOURS_H
#define GOPURA_SYSTEM_HOURS_H

#include <stdbool.h>
#include <stdint.h>
#include <time.h>

#include "base/compiler.h"

enum { HOURS_MINUTES = 7 * 24 * 60 };

struct hours {
	uint8_t open[HOURS_MINUTES / 8]; /* a bit a minute, from Sunday 00:00 as tm_wday counts */
};

/* false: text is none; *out is undefined. */
must_check bool hours_parse(struct hours *out, const char *text);
/* Every minute of the week. */
void hours_always(struct hours *out);

/* local: as localtime_r gives it. */
bool hours_open_at(const struct hours *hours, const struct tm *local);
/* Minutes, rounded up, until it opens or closes next, in the process's time zone: when so many have
 * passed since now, it has. Days on which the clocks change count as they are, an hour shorter or
 * longer. -1: never. */
int hours_change_min(const struct hours *hours, time_t now);

#endif
