/* Weekly opening hours, as people write them. Pure functions: no clock is read, and no file except
 * the time zone's.
 *
 *   Mo-Fr 09:00-18:00, Sa 10:00-17:00     Sunday is closed
 *   Mo,We-Fr 9:00-12:00, 14:00-18:00      two periods on the same days
 *   Fr-Sa 18:00-02:00                     past midnight: into Saturday and Sunday morning
 *   08:30-24:00                           every day
 *
 * Days are in English, with two letters or more. A semicolon may replace a comma. */
#ifndef GOPURA_SYSTEM_HOURS_H
#define GOPURA_SYSTEM_HOURS_H

#include <stdbool.h>
#include <stdint.h>
#include <time.h>

#include "base/compiler.h"

enum { HOURS_MINUTES = 7 * 24 * 60 };

struct hours {
	/* one bit per minute, starting Sunday 00:00 as in tm_wday */
	uint8_t open[HOURS_MINUTES / 8];
};

/* Returns false if text is not valid; *out is then undefined. */
must_check bool hours_parse(struct hours *out, const char *text);
/* Sets every minute of the week. */
void hours_always(struct hours *out);

/* Returns whether it is open at this time. local: as returned by localtime_r. */
bool hours_open_at(const struct hours *hours, const struct tm *local);
/* Returns the minutes, rounded up, until it next opens or closes, counted from now in the process's
 * time zone. Days on which the clocks change count with their real length. -1: never. */
int hours_change_min(const struct hours *hours, time_t now);

#endif
