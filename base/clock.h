/* The one source of time. Tests replace these functions at link time; pass no old "now" down. */
#ifndef GOPURA_BASE_CLOCK_H
#define GOPURA_BASE_CLOCK_H

#include <stdbool.h>
#include <stdint.h>

/* Monotonic; the zero is arbitrary. */
int64_t clock_now_ms(void);
/* The same clock, microseconds. */
int64_t clock_now_us(void);

/* CPU time of the calling thread. */
int64_t clock_thread_us(void);

/* Seconds since 1970 by the wall clock, which may be wrong: see storage/state.h for the floor. */
int64_t clock_wall_s(void);
/* The kernel was told the time by somebody who knows it (NTP): expiry may be judged. */
bool clock_wall_is_set(void);
/* The time of day may be believed although nobody on the network confirmed it: a clock with a
 * battery runs in this machine, and says the same. */
bool clock_wall_is_plausible(void);
/* What such a clock says (seconds since 1970 as text) against what the system says. Pure. */
bool clock_agrees(const char *battery_s, int64_t system_s);

#endif
