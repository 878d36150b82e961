/* Reads the system's clocks, and judges whether the wall clock can be trusted. */
#include "base/clock.h"

#include <stdio.h>
#include <stdlib.h>
#include <sys/timex.h>
#include <time.h>
#include <unistd.h>

static int64_t read_us(clockid_t id)
{
	struct timespec now;

	clock_gettime(id, &now);
	return (int64_t)now.tv_sec * 1000000 + now.tv_nsec / 1000;
}

int64_t clock_now_us(void)
{
	return read_us(CLOCK_MONOTONIC);
}

int64_t clock_now_ms(void)
{
	return clock_now_us() / 1000;
}

int64_t clock_thread_us(void)
{
	return read_us(CLOCK_THREAD_CPUTIME_ID);
}

int64_t clock_wall_s(void)
{
	return read_us(CLOCK_REALTIME) / 1000000;
}

bool clock_wall_is_set(void)
{
	struct timex state = { .modes = 0 };

	/* A sandbox that forbids setting the clock may forbid adjtimex too; then the file that
	 * systemd's time service creates tells. */
	if (adjtimex(&state) < 0)
		return access("/run/systemd/timesync/synchronized", F_OK) == 0;
	return !(state.status & STA_UNSYNC);
}

bool clock_agrees(const char *battery_s, int64_t system_s)
{
	char *end;
	const long long battery = strtoll(battery_s, &end, 10);

	/* Less than a day of difference may be a time zone; a clock with an empty battery is years
	 * wrong. */
	return end != battery_s && llabs(battery - (long long)system_s) < 24 * 3600;
}

bool clock_wall_is_plausible(void)
{
	char text[32] = "";
	FILE *file = fopen("/sys/class/rtc/rtc0/since_epoch", "re");

	if (file) {
		if (!fgets(text, sizeof(text), file))
			text[0] = '\0';
		fclose(file);
	}
	return clock_wall_is_set() || clock_agrees(text, clock_wall_s());
}
