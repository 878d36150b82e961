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
	figures_gauge(out, "gopura_test_answer", "Of all.", *(double *)data);
	for (size_t i = 0; i < padding; i++)
		buffer_put_u8(out, '\n');
}

static struct figures_socket *offer(double *answer)
{
	const struct figures_socket_options options = { path, "gopura_test", tell, answer };
	struct figures_socket *figures;

	CHECK(figures_socket_create(&figures, &options) == 0);
	return figures;
}

static int visit(void)
{
	struct sockaddr_un address = { .sun_family = AF_UNIX };
	int fd = socket(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC, 0);

	memcpy(address.sun_path, path, strlen(path) + 1);
	CHECK(connect(fd, (struct sockaddr *)&address, sizeof(address)) == 0);
	return fd;
}

static bool is_wanted(const struct figures_socket *figures)
{
	struct pollfd poll_fd = { .fd = figures_socket_fd(figures), .events = POLLIN };

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

	CHECK(figures_find(text, name, &value));
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
	struct figures_socket *figures = offer(&answer);
	static char text[FIGURES_BYTES_MOST];
	struct bytes heard;
	struct stat info;
	int fd;

	(void)state;
	CHECK(stat(path, &info) == 0 && (info.st_mode & 0777) == 0666);
	CHECK(!is_wanted(figures));
	fd = visit();
	CHECK(is_wanted(figures));
	figures_socket_dispatch(figures);
	CHECK(!is_wanted(figures));
	heard = hear(fd, text, sizeof(text));
	CHECK(figures_valid(heard, "gopura_test_"));
	CHECK(figure(heard, "gopura_test_answer") == 42);
	CHECK(figure(heard, "gopura_test_uptime_seconds") >= 0);
	CHECK(figure(heard, "gopura_test_resident_bytes") > 0);
	CHECK(figure(heard, "gopura_test_starts_total") == 1);
	answer = 43;
	fd = visit();
	figures_socket_dispatch(figures);
	CHECK(figure(hear(fd, text, sizeof(text)), "gopura_test_answer") == 43);
	figures_socket_destroy(figures);
}

static void starts_are_counted_from_one_program_to_the_next(void **state)
{
	double answer = 0;
	static char text[FIGURES_BYTES_MOST];
	double before = 0;

	(void)state;
	for (int i = 0; i < 3; i++) {
		struct figures_socket *figures = offer(&answer);
		const int fd = visit();
		double starts;

		figures_socket_dispatch(figures);
		starts = figure(hear(fd, text, sizeof(text)), "gopura_test_starts_total");
		CHECK(i == 0 || starts == before + 1);
		before = starts;
		figures_socket_destroy(figures);
	}
}

/* Who connects and reads nothing, or is gone at once: neither is waited for. */
static void nobody_is_waited_for(void **state)
{
	double answer = 1;
	struct figures_socket *figures = offer(&answer);
	static char text[FIGURES_BYTES_MOST];
	int slow[8];

	(void)state;
	figures_socket_dispatch(figures); /* nobody is there */
	close(visit());
	figures_socket_dispatch(figures);
	for (int i = 0; i < 8; i++)
		slow[i] = visit();
	for (int i = 0; i < 8; i++)
		figures_socket_dispatch(figures);
	CHECK(!is_wanted(figures));
	for (int i = 0; i < 8; i++)
		CHECK(figure(hear(slow[i], text, sizeof(text)), "gopura_test_answer") == 1);
	figures_socket_destroy(figures);
}

static void too_much_is_not_told_in_part(void **state)
{
	double answer = 1;
	struct figures_socket *figures = offer(&answer);
	static char text[FIGURES_BYTES_MOST];
	int fd = visit();

	(void)state;
	padding = FIGURES_BYTES_MOST;
	figures_socket_dispatch(figures);
	CHECK(hear(fd, text, sizeof(text)).size == 0);
	padding = 0;
	fd = visit();
	figures_socket_dispatch(figures);
	CHECK(hear(fd, text, sizeof(text)).size > 0);
	figures_socket_destroy(figures);
}

static void a_socket_left_behind_is_replaced_and_a_bad_place_is_an_error(void **state)
{
	double answer = 1;
	struct figures_socket *first = offer(&answer), *second = offer(&answer);
	struct figures_socket_options options = { "/nowhere/figures", "gopura_test", tell,
						  &answer };
	static char text[FIGURES_BYTES_MOST], name[200];
	struct figures_socket *none = second;
	int fd = visit();

	(void)state;
	figures_socket_dispatch(second);
	CHECK(hear(fd, text, sizeof(text)).size > 0);
	CHECK(figures_socket_create(&none, &options) == -ENOENT && !none);
	memset(name, 'x', sizeof(name) - 1);
	options.path = name;
	CHECK(figures_socket_create(&none, &options) == -ENAMETOOLONG && !none);
	CHECK(figures_socket_fd(NULL) == -1);
	figures_socket_destroy(NULL);
	figures_socket_destroy(first);
	figures_socket_destroy(second);
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
