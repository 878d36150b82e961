#include <errno.h>
#include <netinet/in.h>
#include <pthread.h>
#include <signal.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/socket.h>
#include <unistd.h>

#include "health/server.h"
#include "tests/check.h"

static struct sockaddr_in address = { .sin_family = AF_INET };
static size_t answer_bytes = 3;

/* "STATUS PAGE" and as many bytes as the test wants. */
static void answer(void *data, int status, const struct request *request, struct buffer *out)
{
	char text[32];

	(void)data;
	snprintf(text, sizeof(text), "%d %d ", status, (int)request->page);
	buffer_put(out, text, strlen(text));
	for (size_t i = 0; i < answer_bytes; i++)
		buffer_put_u8(out, 'x');
}

struct running {
	int listener, rc;
	struct server_options options;
	pthread_t thread;
};

static void *serve(void *data)
{
	struct running *server = data;

	server->rc = server_run(&server->options);
	return NULL;
}

static void start(struct running *server, int64_t patience_ms, int64_t idle_ms)
{
	socklen_t size = sizeof(address);

	server->listener = socket(AF_INET, SOCK_STREAM | SOCK_CLOEXEC, 0);
	address.sin_port = 0;
	address.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
	CHECK(bind(server->listener, (struct sockaddr *)&address, sizeof(address)) == 0);
	CHECK(listen(server->listener, 64) == 0);
	CHECK(getsockname(server->listener, (struct sockaddr *)&address, &size) == 0);
	server->options = (struct server_options){
		.listeners = &server->listener,
		.listener_count = 1,
		.patience_ms = patience_ms,
		.idle_ms = idle_ms,
		.answer = answer,
	};
	pthread_create(&server->thread, NULL, serve, server);
}

/* It ends by itself, for nobody asks any more. */
static void finish(struct running *server)
{
	pthread_join(server->thread, NULL);
	CHECK(server->rc == 0);
	close(server->listener);
}

static int visit(void)
{
	int fd = socket(AF_INET, SOCK_STREAM | SOCK_CLOEXEC, 0);

	CHECK(connect(fd, (struct sockaddr *)&address, sizeof(address)) == 0);
	return fd;
}

static void say(int fd, const char *text)
{
	CHECK(send(fd, text, strlen(text), MSG_NOSIGNAL) == (ssize_t)strlen(text));
}

/* All until the server hangs up; how much. */
static size_t hear(int fd, char *text, size_t text_bytes)
{
	size_t size = 0;
	ssize_t more;

	while ((more = read(fd, text + size, text_bytes - 1 - size)) > 0)
		size += (size_t)more;
	text[size] = '\0';
	close(fd);
	return size;
}

static void a_request_gets_its_answer_in_however_many_pieces(void **state)
{
	struct running server;
	char text[64];
	int fd;

	(void)state;
	start(&server, 60000, 200);
	fd = visit();
	say(fd, "GET /me");
	usleep(20000);
	say(fd, "trics HTTP/1.1\r\n\r");
	say(fd, "\n");
	hear(fd, text, sizeof(text));
	CHECK(strcmp(text, "200 1 xxx") == 0);
	fd = visit();
	say(fd, "GET /none HTTP/1.1\r\n\r\n");
	hear(fd, text, sizeof(text));
	CHECK(strncmp(text, "404 ", 4) == 0);
	finish(&server);
}

/* More than the head may be: the answer arrives all the same, for what follows is read too. */
static void a_request_that_is_too_long_is_told_so(void **state)
{
	static char much[200000];
	struct running server;
	char text[64];
	int fd;

	(void)state;
	start(&server, 60000, 200);
	fd = visit();
	memset(much, 'a', sizeof(much));
	CHECK(send(fd, much, sizeof(much), MSG_NOSIGNAL) == (ssize_t)sizeof(much));
	shutdown(fd, SHUT_WR);
	hear(fd, text, sizeof(text));
	CHECK(strncmp(text, "431 ", 4) == 0);
	finish(&server);
}

static void slow_clients_are_cut_and_others_are_served_meanwhile(void **state)
{
	struct running server;
	char text[64];
	int slow[SERVER_CLIENTS_MOST + 4], fd;

	(void)state;
	start(&server, 300, 200);
	slow[0] = visit();
	say(slow[0], "GET / HT");
	fd = visit();
	say(fd, "GET / HTTP/1.1\r\n\r\n");
	hear(fd, text, sizeof(text));
	CHECK(strcmp(text, "200 0 xxx") == 0);
	/* More than there are places: who comes later waits until those before are cut. */
	for (size_t i = 1; i < ARRAY_COUNT(slow); i++)
		slow[i] = visit();
	fd = visit();
	say(fd, "GET /health HTTP/1.1\r\n\r\n");
	hear(fd, text, sizeof(text));
	CHECK(strcmp(text, "200 2 xxx") == 0);
	for (size_t i = 0; i < ARRAY_COUNT(slow); i++)
		CHECK(hear(slow[i], text, sizeof(text)) == 0);
	finish(&server);
}

static void who_does_not_take_the_answer_is_cut(void **state)
{
	static char text[300000];
	const int little = 4096;
	struct running server;
	size_t size;
	int fd;

	(void)state;
	answer_bytes = 250000;
	start(&server, 300, 200);
	fd = socket(AF_INET, SOCK_STREAM | SOCK_CLOEXEC, 0);
	setsockopt(fd, SOL_SOCKET, SO_RCVBUF, &little, sizeof(little));
	CHECK(connect(fd, (struct sockaddr *)&address, sizeof(address)) == 0);
	say(fd, "GET / HTTP/1.1\r\n\r\n");
	finish(&server); /* did not wait for us */
	close(fd);
	start(&server, 60000, 200);
	fd = visit();
	say(fd, "GET / HTTP/1.1\r\n\r\n");
	size = hear(fd, text, sizeof(text));
	CHECK(size == 250006);
	finish(&server);
	answer_bytes = 3;
}

static void an_answer_that_does_not_fit_is_none(void **state)
{
	struct running server;
	char text[64];
	int fd;

	(void)state;
	answer_bytes = 10 << 20;
	start(&server, 60000, 200);
	fd = visit();
	say(fd, "GET / HTTP/1.1\r\n\r\n");
	CHECK(hear(fd, text, sizeof(text)) == 0);
	finish(&server);
	answer_bytes = 3;
}

static void clients_that_vanish_are_no_matter(void **state)
{
	const struct linger at_once = { 1, 0 };
	struct running server;
	char text[64];
	int fd;

	(void)state;
	start(&server, 60000, 300);
	for (int i = 0; i < 50; i++) {
		fd = visit();
		if (i % 3)
			say(fd, i % 3 == 1 ? "GET / HTTP/1.1\r\n\r\n" : "GET");
		setsockopt(fd, SOL_SOCKET, SO_LINGER, &at_once, sizeof(at_once));
		close(fd);
	}
	fd = visit();
	say(fd, "GET / HTTP/1.1\r\n\r\n");
	hear(fd, text, sizeof(text));
	CHECK(strcmp(text, "200 0 xxx") == 0);
	finish(&server);
}

static void no_listener_is_an_error(void **state)
{
	const struct server_options options = { .answer = answer };

	(void)state;
	CHECK(server_run(&options) == -EINVAL);
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(a_request_gets_its_answer_in_however_many_pieces),
		cmocka_unit_test(a_request_that_is_too_long_is_told_so),
		cmocka_unit_test(slow_clients_are_cut_and_others_are_served_meanwhile),
		cmocka_unit_test(who_does_not_take_the_answer_is_cut),
		cmocka_unit_test(an_answer_that_does_not_fit_is_none),
		cmocka_unit_test(clients_that_vanish_are_no_matter),
		cmocka_unit_test(no_listener_is_an_error),
	};

	return cmocka_run_group_tests(tests, NULL, NULL);
}
