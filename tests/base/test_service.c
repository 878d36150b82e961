#include <errno.h>
#include <signal.h>
#include <stddef.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/signalfd.h>
#include <sys/socket.h>
#include <sys/un.h>
#include <unistd.h>

#include "base/clock.h"
#include "base/compiler.h"
#include "base/service.h"
#include "tests/check.h"

static int manager = -1;

/* A service manager that waits three seconds for this program. */
static int be_managed(void **state)
{
	struct sockaddr_un address = { .sun_family = AF_UNIX };
	char number[32];

	(void)state;
	/* An abstract name: nothing is left behind. */
	snprintf(address.sun_path + 1, sizeof(address.sun_path) - 1, "gopura-test-%d", getpid());
	manager = socket(AF_UNIX, SOCK_DGRAM | SOCK_CLOEXEC | SOCK_NONBLOCK, 0);
	if (bind(manager, (struct sockaddr *)&address,
		 (socklen_t)(offsetof(struct sockaddr_un, sun_path) + 1 +
			     strlen(address.sun_path + 1))) < 0)
		return -1;
	address.sun_path[0] = '@';
	snprintf(number, sizeof(number), "%d", getpid());
	setenv("NOTIFY_SOCKET", address.sun_path, 1);
	setenv("WATCHDOG_USEC", "3000000", 1);
	setenv("WATCHDOG_PID", number, 1);
	return 0;
}

static int leave(void **state)
{
	(void)state;
	return close(manager);
}

static bool heard(const char *expected)
{
	char text[256];
	ssize_t size = recv(manager, text, sizeof(text), 0);

	return size == (ssize_t)strlen(expected) && memcmp(text, expected, (size_t)size) == 0;
}

static void the_manager_hears_what_is_said_and_is_due_after_a_third(void **state)
{
	int64_t before_ms = clock_now_ms();

	(void)state;
	service_ready();
	CHECK(heard("READY=1"));
	CHECK(service_due_ms() >= before_ms + 1000 && service_due_ms() <= clock_now_ms() + 1000);
	before_ms = service_due_ms();
	usleep(20000);
	service_alive();
	CHECK(heard("WATCHDOG=1"));
	CHECK(service_due_ms() >= before_ms + 20);
	service_stopping();
	CHECK(heard("STOPPING=1"));
	CHECK(recv(manager, &before_ms, 1, 0) < 0 && errno == EAGAIN);
}

static void a_signal_to_stop_is_read_and_ends_nothing(void **state)
{
	static const int signals[] = { SIGTERM, SIGINT };
	const int fd = service_stop_fd();
	struct signalfd_siginfo info;

	(void)state;
	CHECK(fd >= 0);
	CHECK(read(fd, &info, sizeof(info)) == -1 && errno == EAGAIN);
	for (size_t i = 0; i < ARRAY_COUNT(signals); i++) {
		CHECK(raise(signals[i]) == 0);
		CHECK(read(fd, &info, sizeof(info)) == sizeof(info));
		CHECK(info.ssi_signo == (uint32_t)signals[i]);
	}
	close(fd);
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(the_manager_hears_what_is_said_and_is_due_after_a_third),
		cmocka_unit_test(a_signal_to_stop_is_read_and_ends_nothing),
	};

	return cmocka_run_group_tests(tests, be_managed, leave);
}
