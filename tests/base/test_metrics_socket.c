#include <errno.h>
#include <poll.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/socket.h>
#include <sys/stat.h>
#include <sys/un.h>
#include <unistd.h>

#include "base/metrics_socket.h"
#include "tests/check.h"

static char folder[] = "/tmp/gopura-figures-XXXXXX";
static char path[64];
static size_t padding; /* bytes that the program tells besides */

static void tell(void *data, struct buffer *out)
{
	metrics_gauge(out, "gopura_test_answer", "Of all.", *(double *)data);
	for (size_t i = 0; i < padding; i++)
		buffer_put_u8(out, '\n');
}

static struct metrics_socket *offer(double *answer)
{
	const struct metrics_socket_options options = { path, "gopura_test", tell, answer };
	struct metrics_socket *metrics;

	CHECK(metrics_socket_create(&metrics, &options) == 0);
	return metrics;
}

static int visit(void)
{
	struct sockaddr_un address = { .sun_family = AF_UNIX };
	int fd = socket(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC, 0);

	memcpy(address.sun_path, path, strlen(path) + 1);
	CHECK(connect(fd, (struct sockaddr *)&address, sizeof(address)) == 0);
	return fd;
}

static bool is_wanted(const struct metrics_socket *metrics)
{
	struct pollfd poll_fd = { .fd = metrics_socket_fd(metrics), .events = POLLIN };

	return poll(&poll_fd, 1, 0) == 1;
}

/* All that comes, until the other side hangs up. */
static struct bytes hear(int fd, char *text, size_t most)
{
	size_t size = 0;
	ssize_t more;

	while ((more = read(fd, text + size, most - size)) > 0)
		size += (size_t)more;
	CHECK(more == 0);
	close(fd);
	return (struct bytes){ (uint8_t *)text, size };
}

static double figure(struct bytes text, const char *name)
{
	double value = -1;

	CHECK(metrics_find(text, name, &value));
	return value;
}

static int begin(void **state)
{
	(void)state;
	if (!mkdtemp(folder))
		return -1;
	snprintf(path, sizeof(path), "%s/figures", folder);
	return 0;
}

static int end(void **state)
{
	char starts[80];

	(void)state;
	snprintf(starts, sizeof(starts), "%s.starts", path);
	unlink(starts);
	return rmdir(folder); /* the socket itself must be gone */
}

static void whoever_connects_gets_the_figures_and_is_let_go(void **state)
{
	double answer = 42;
	struct metrics_socket *metrics = offer(&answer);
	static char text[METRICS_BYTES_MAX];
	struct bytes heard;
	struct stat info;
	int fd;

	(void)state;
	CHECK(stat(path, &info) == 0 && (info.st_mode & 0777) == 0666);
	CHECK(!is_wanted(metrics));
	fd = visit();
	CHECK(is_wanted(metrics));
	metrics_socket_dispatch(metrics);
	CHECK(!is_wanted(metrics));
	heard = hear(fd, text, sizeof(text));
	CHECK(metrics_valid(heard, "gopura_test_"));
	CHECK(figure(heard, "gopura_test_answer") == 42);
	CHECK(figure(heard, "gopura_test_uptime_seconds") >= 0);
	CHECK(figure(heard, "gopura_test_resident_bytes") > 0);
	CHECK(figure(heard, "gopura_test_starts_total") == 1);
	answer = 43;
	fd = visit();
	metrics_socket_dispatch(metrics);
	CHECK(figure(hear(fd, text, sizeof(text)), "gopura_test_answer") == 43);
	metrics_socket_destroy(metrics);
}

static void starts_are_counted_from_one_program_to_the_next(void **state)
{
	double answer = 0;
	static char text[METRICS_BYTES_MAX];
	double before = 0;

	(void)state;
	for (int i = 0; i < 3; i++) {
		struct metrics_socket *metrics = offer(&answer);
		const int fd = visit();
		double starts;

		metrics_socket_dispatch(metrics);
		starts = figure(hear(fd, text, sizeof(text)), "gopura_test_starts_total");
		CHECK(i == 0 || starts == before + 1);
		before = starts;
		metrics_socket_destroy(metrics);
	}
}

/* Who connects and reads nothing, or is gone at once: neither is waited for. */
static void nobody_is_waited_for(void **state)
{
	double answer = 1;
	struct metrics_socket *metrics = offer(&answer);
	static char text[METRICS_BYTES_MAX];
	int slow[8];

	(void)state;
	metrics_socket_dispatch(metrics); /* nobody is there */
	close(visit());
	metrics_socket_dispatch(metrics);
	for (int i = 0; i < 8; i++)
		slow[i] = visit();
	for (int i = 0; i < 8; i++)
		metrics_socket_dispatch(metrics);
	CHECK(!is_wanted(metrics));
	for (int i = 0; i < 8; i++)
		CHECK(figure(hear(slow[i], text, sizeof(text)), "gopura_test_answer") == 1);
	metrics_socket_destroy(metrics);
}

static void too_much_is_not_told_in_part(void **state)
{
	double answer = 1;
	struct metrics_socket *metrics = offer(&answer);
	static char text[METRICS_BYTES_MAX];
	int fd = visit();

	(void)state;
	padding = METRICS_BYTES_MAX;
	metrics_socket_dispatch(metrics);
	CHECK(hear(fd, text, sizeof(text)).size == 0);
	padding = 0;
	fd = visit();
	metrics_socket_dispatch(metrics);
	CHECK(hear(fd, text, sizeof(text)).size > 0);
	metrics_socket_destroy(metrics);
}

static void a_socket_left_behind_is_replaced_and_a_bad_place_is_an_error(void **state)
{
	double answer = 1;
	struct metrics_socket *first = offer(&answer), *second = offer(&answer);
	struct metrics_socket_options options = { "/nowhere/figures", "gopura_test", tell,
						  &answer };
	static char text[METRICS_BYTES_MAX], name[200];
	struct metrics_socket *none = second;
	int fd = visit();

	(void)state;
	metrics_socket_dispatch(second);
	CHECK(hear(fd, text, sizeof(text)).size > 0);
	CHECK(metrics_socket_create(&none, &options) == -ENOENT && !none);
	memset(name, 'x', sizeof(name) - 1);
	options.path = name;
	CHECK(metrics_socket_create(&none, &options) == -ENAMETOOLONG && !none);
	CHECK(metrics_socket_fd(NULL) == -1);
	metrics_socket_destroy(NULL);
	metrics_socket_destroy(first);
	metrics_socket_destroy(second);
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(whoever_connects_gets_the_figures_and_is_let_go),
		cmocka_unit_test(starts_are_counted_from_one_program_to_the_next),
		cmocka_unit_test(nobody_is_waited_for),
		cmocka_unit_test(too_much_is_not_told_in_part),
		cmocka_unit_test(a_socket_left_behind_is_replaced_and_a_bad_place_is_an_error),
	};

	return cmocka_run_group_tests(tests, begin, end);
}
