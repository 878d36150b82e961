/* Sends sd_notify messages to systemd, takes its signals to stop, and computes when the next
 * watchdog message is due. */
#include "base/service.h"

#include <errno.h>
#include <signal.h>
#include <stddef.h>
#include <sys/signalfd.h>
#include <systemd/sd-daemon.h>

#include "base/clock.h"

/* Do not unset the environment variables: WATCHDOG_PID says which process they are for. */
enum { KEEP = 0 };

static int64_t alive_ms; /* time of the last message */

int service_stop_fd(void)
{
	sigset_t signals;
	int fd;

	sigemptyset(&signals);
	sigaddset(&signals, SIGINT);
	sigaddset(&signals, SIGTERM);
	sigprocmask(SIG_BLOCK, &signals, NULL);
	fd = signalfd(-1, &signals, SFD_CLOEXEC | SFD_NONBLOCK);
	return fd < 0 ? -errno : fd;
}

void service_ready(void)
{
	sd_notify(KEEP, "READY=1");
	alive_ms = clock_now_ms();
}

int64_t service_due_ms(void)
{
	static int64_t every_ms = -1; /* read once, because the environment does not change */
	uint64_t period_us;

	if (every_ms < 0)
		every_ms =
			sd_watchdog_enabled(KEEP, &period_us) > 0 ? (int64_t)(period_us / 3000) : 0;
	return every_ms > 0 ? alive_ms + every_ms : INT64_MAX;
}

void service_alive(void)
{
	sd_notify(KEEP, "WATCHDOG=1");
	alive_ms = clock_now_ms();
}

void service_stopping(void)
{
	sd_notify(KEEP, "STOPPING=1");
}
