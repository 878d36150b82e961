/* The only source of time. Tests replace these functions at link time. Do not pass an old "now"
 * down; ask again. */
#ifndef GOPURA_BASE_CLOCK_H
#define GOPURA_BASE_CLOCK_H

#include <stdbool.h>
#include <stdint.h>

/* Returns monotonic time in milliseconds, from an arbitrary zero. */
int64_t clock_now_ms(void);
/* Returns the same clock in microseconds. */
int64_t clock_now_us(void);

/* Returns the earlier of two timeouts in milliseconds; -1 means none. */
static inline int clock_sooner_ms(int a_ms, int b_ms)
{
	if (a_ms < 0 || b_ms < 0)
		return a_ms < 0 ? b_ms : a_ms;
	return a_ms < b_ms ? a_ms : b_ms;
}

/* Returns the CPU time of the calling thread, in microseconds. */
int64_t clock_thread_us(void);

/* Returns the wall clock in seconds since 1970. It may be wrong: storage/state.h keeps a floor for
 * it. */
int64_t clock_wall_s(void);
/* Returns whether the clock was set from the network (NTP), so that expiry may be judged. */
bool clock_wall_is_set(void);
/* Returns whether the time of day may be trusted even if the network has not confirmed it: the
 * clock is set, or a battery-backed clock in this machine agrees with it. */
bool clock_wall_is_plausible(void);
/* Returns whether a battery-backed clock (battery_s: seconds since 1970 as text) and the system's
 * clock differ by less than a day. Pure. */
bool clock_agrees(const char *battery_s, int64_t system_s);

#endif
