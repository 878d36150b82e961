/* For LD_PRELOAD: a clock that can be set forward, for programs that are to
 * live through a year in an hour (tests/tools/museum_year.py). GOPURA_CLOCK
 * names a file of struct shared, which all programs map; who writes there moves
 * the time of all of them at once. Time runs as ever between two such moves.
 *
 * A wait that a move ends must end: waits are cut into pieces of WAIT_MS, and
 * timers are set anew after a move. What sleeps without a wait that is known
 * here sleeps in real time.
 *
 * Counts what is written to regular files, for the wear of a card.
 * GOPURA_LEAK_BYTES, of the program that GOPURA_LEAK_IN names: so much memory
 * is lost in each virtual hour, to see that it is found. */
#include <errno.h>
#include <fcntl.h>
#include <malloc.h>
#include <poll.h>
#include <stdatomic.h>
#include <stdbool.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>
#include <sys/epoll.h>
#include <sys/mman.h>
#include <sys/stat.h>
#include <sys/syscall.h>
#include <sys/time.h>
#include <sys/timerfd.h>
#include <sys/timex.h>
#include <sys/uio.h>
#include <time.h>
#include <unistd.h>

enum { WAIT_MS = 5, FDS_MAX = 1024, PROGRAMS = 4, PAGE = 4096 };

#define SECOND ((int64_t)1000000000)

/* museum_year.py knows this layout. */
struct shared {
	_Atomic int64_t monotonic_ns, wall_ns; /* ahead of the real clocks */
	_Atomic uint64_t moves;
	_Atomic uint64_t trims; /* when it rises, malloc gives back what is free, to be measured */
	struct {
		_Atomic uint64_t bytes, pages, syncs; /* pages: of 4 KiB that the writes touched */
	} written[PROGRAMS];                          /* kiosk, fetch, health, others */
};

static struct shared *shared;
static unsigned program;
static _Atomic uint64_t moves_seen;
static struct {
	_Atomic int64_t due_ns; /* virtual, by its clock; 0: not set */
	_Atomic int64_t interval_ns;
	_Atomic int clock;
} timers[FDS_MAX];
static uint64_t leak_bytes;
static void *volatile leaked;

__attribute__((constructor)) static void set_up(void)
{
	static const char *const names[] = { "gopura-kiosk", "gopura-fetch", "gopura-health" };
	const char *path = getenv("GOPURA_CLOCK"), *leak = getenv("GOPURA_LEAK_BYTES");
	const char *leak_in = getenv("GOPURA_LEAK_IN");
	const int fd = path ? open(path, O_RDWR | O_CLOEXEC) : -1;
	void *map = fd < 0 ? MAP_FAILED
			   : mmap(NULL, sizeof(*shared), PROT_READ | PROT_WRITE, MAP_SHARED, fd, 0);

	if (fd >= 0)
		close(fd);
	while (program < PROGRAMS - 1 && strcmp(program_invocation_short_name, names[program]) != 0)
		program++;
	if (map != MAP_FAILED)
		shared = map;
	if (leak && leak_in && strcmp(program_invocation_short_name, leak_in) == 0)
		leak_bytes = strtoull(leak, NULL, 10);
}

/* ---- what time it is */

static int64_t ahead_ns(clockid_t clock)
{
	switch (clock) {
	case CLOCK_MONOTONIC:
	case CLOCK_MONOTONIC_COARSE:
	case CLOCK_MONOTONIC_RAW:
	case CLOCK_BOOTTIME:
		return shared ? shared->monotonic_ns : 0;
	case CLOCK_REALTIME:
	case CLOCK_REALTIME_COARSE:
		return shared ? shared->wall_ns : 0;
	default:
		return 0;
	}
}

static int64_t now_ns(clockid_t clock)
{
	struct timespec now;

	syscall(SYS_clock_gettime, clock, &now);
	return now.tv_sec * SECOND + now.tv_nsec + ahead_ns(clock);
}

int clock_gettime(clockid_t clock, struct timespec *out)
{
	const int rc = (int)syscall(SYS_clock_gettime, clock, out);
	int64_t ns;

	if (rc == 0 && ahead_ns(clock) != 0) {
		ns = out->tv_sec * SECOND + out->tv_nsec + ahead_ns(clock);
		out->tv_sec = ns / SECOND;
		out->tv_nsec = ns % SECOND;
	}
	return rc;
}

time_t time(time_t *out)
{
	const time_t now = now_ns(CLOCK_REALTIME) / SECOND;

	if (out)
		*out = now;
	return now;
}

int gettimeofday(struct timeval *restrict out, void *restrict zone)
{
	const int64_t ns = now_ns(CLOCK_REALTIME);

	(void)zone;
	out->tv_sec = ns / SECOND;
	out->tv_usec = ns % SECOND / 1000;
	return 0;
}

int adjtimex(struct timex *state)
{
	memset(state, 0, sizeof(*state));
	return TIME_OK;
}

/* ---- timers */

static int set_real(int fd, int64_t in_ns, int64_t interval_ns)
{
	const struct itimerspec value = {
		.it_value = { in_ns / SECOND, in_ns % SECOND },
		.it_interval = { interval_ns / SECOND, interval_ns % SECOND },
	};

	return (int)syscall(SYS_timerfd_settime, fd, 0, &value, NULL);
}

int timerfd_create(int clock, int flags)
{
	const int fd = (int)syscall(SYS_timerfd_create, clock, flags);

	if (fd >= 0 && fd < FDS_MAX) {
		timers[fd].clock = clock;
		timers[fd].due_ns = 0;
	}
	return fd;
}

int timerfd_settime(int fd, int flags, const struct itimerspec *value, struct itimerspec *old)
{
	const int64_t at = value->it_value.tv_sec * SECOND + value->it_value.tv_nsec;
	const int64_t every = value->it_interval.tv_sec * SECOND + value->it_interval.tv_nsec;
	int64_t due, left;

	if (!shared || fd < 0 || fd >= FDS_MAX || at == 0) {
		if (fd >= 0 && fd < FDS_MAX)
			timers[fd].due_ns = 0;
		return (int)syscall(SYS_timerfd_settime, fd, flags, value, old);
	}
	due = flags & TFD_TIMER_ABSTIME ? at : now_ns(timers[fd].clock) + at;
	timers[fd].due_ns = due;
	timers[fd].interval_ns = every;
	left = due - now_ns(timers[fd].clock);
	return set_real(fd, left > 0 ? left : 1, every);
}

/* After a move: what is still to come comes earlier. A timer that has gone off
 * stays so. */
static void follow_moves(void)
{
	uint64_t seen = moves_seen;
	const uint64_t moves = shared ? shared->moves : seen;

	if (seen == moves || !atomic_compare_exchange_strong(&moves_seen, &seen, moves))
		return;
	for (int fd = 0; fd < FDS_MAX; fd++) {
		struct itimerspec now;
		int64_t left;

		if (timers[fd].due_ns == 0 || syscall(SYS_timerfd_gettime, fd, &now) < 0 ||
		    (now.it_value.tv_sec == 0 && now.it_value.tv_nsec == 0))
			continue;
		left = timers[fd].due_ns - now_ns(timers[fd].clock);
		set_real(fd, left > 0 ? left : 1, timers[fd].interval_ns);
	}
}

static void trim(void)
{
	static _Atomic uint64_t trims;
	uint64_t seen = trims;
	const uint64_t now = shared ? shared->trims : seen;

	if (seen != now && atomic_compare_exchange_strong(&trims, &seen, now))
		malloc_trim(0);
}

static void leak(void)
{
	static _Atomic int64_t hour;
	int64_t now = now_ns(CLOCK_MONOTONIC) / SECOND / 3600, before = hour;

	if (leak_bytes > 0 && now > before && atomic_compare_exchange_strong(&hour, &before, now)) {
		void **kept = malloc(leak_bytes + sizeof(*kept));

		if (kept) {
			memset(kept, 1, leak_bytes + sizeof(*kept));
			*kept = leaked; /* or the compiler would leave the memory out */
			leaked = kept;
		}
	}
}

/* ---- waits */

/* Returns how long to wait in real time, at most: 0 once the virtual deadline
 * has passed. */
static int piece_ms(int64_t until_ns)
{
	const int64_t left_ms = (until_ns - now_ns(CLOCK_MONOTONIC) + 999999) / 1000000;

	follow_moves();
	trim();
	leak();
	return left_ms <= 0 ? 0 : left_ms < WAIT_MS ? (int)left_ms : WAIT_MS;
}

static int64_t until_ns(int timeout_ms)
{
	return timeout_ms < 0 ? INT64_MAX / 2
			      : now_ns(CLOCK_MONOTONIC) + (int64_t)timeout_ms * 1000000;
}

int epoll_wait(int epoll, struct epoll_event *events, int most, int timeout_ms)
{
	const int64_t until = until_ns(timeout_ms);

	for (;;) {
		const int wait_ms = piece_ms(until);
		const int got =
			(int)syscall(SYS_epoll_pwait, epoll, events, most, wait_ms, NULL, 8);

		if (got != 0 || wait_ms == 0)
			return got;
	}
}

int poll(struct pollfd *fds, nfds_t count, int timeout_ms)
{
	const int64_t until = until_ns(timeout_ms);

	for (;;) {
		const int wait_ms = piece_ms(until);
		const struct timespec wait = { .tv_nsec = wait_ms * 1000000l };
		const int got = (int)syscall(SYS_ppoll, fds, count, &wait, NULL, 8);

		if (got != 0 || wait_ms == 0)
			return got;
	}
}

/* ---- what is written */

static void count(int fd, ssize_t size, int64_t at)
{
	struct stat status;
	const int saved = errno;

	if (shared && size > 0 && fstat(fd, &status) == 0 && S_ISREG(status.st_mode)) {
		const int64_t from = at >= 0 ? at : lseek(fd, 0, SEEK_CUR) - size;

		shared->written[program].bytes += (uint64_t)size;
		shared->written[program].pages +=
			(uint64_t)((from + size + PAGE - 1) / PAGE - from / PAGE);
	}
	errno = saved;
}

ssize_t write(int fd, const void *data, size_t size)
{
	const ssize_t put = syscall(SYS_write, fd, data, size);

	count(fd, put, -1);
	return put;
}

ssize_t pwrite(int fd, const void *data, size_t size, off_t at)
{
	const ssize_t put = syscall(SYS_pwrite64, fd, data, size, at);

	count(fd, put, at);
	return put;
}

ssize_t pwrite64(int fd, const void *data, size_t size, off_t at)
{
	return pwrite(fd, data, size, at);
}

ssize_t writev(int fd, const struct iovec *pieces, int pieces_count)
{
	const ssize_t put = syscall(SYS_writev, fd, pieces, pieces_count);

	count(fd, put, -1);
	return put;
}

int fsync(int fd)
{
	if (shared)
		shared->written[program].syncs++;
	return (int)syscall(SYS_fsync, fd);
}

int fdatasync(int fd)
{
	if (shared)
		shared->written[program].syncs++;
	return (int)syscall(SYS_fdatasync, fd);
}
