#include <errno.h>
#include <netinet/in.h>
#include <pthread.h>
#include <signal.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/mman.h>
#include <sys/socket.h>
#include <unistd.h>

#include "health/server.h"
#include "tests/check.h"

static struct sockaddr_in address = { .sin_family = AF_INET };
static size_t answer_bytes = 3;
static int file = -1;
static uint64_t file_bytes;

/* "STATUS PAGE" and as many bytes as the test wants; to REQUEST_VISITS, the file. */
static void answer(void *data, int status, const struct request *request, struct reply *reply)
{
	char text[32];

	(void)data;
	snprintf(text, sizeof(text), "%d %d ", status, (int)request->page);
	buffer_put(&reply->text, text, strlen(text));
	for (size_t i = 0; i < answer_bytes; i++)
		buffer_put_u8(&reply->text, 'x');
	if (status != 200 || request->page != REQUEST_VISITS)
		return;
	buffer_clear(&reply->text);
	reply->file = dup(file);
	reply->file_bytes = file_bytes;
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
		.file_bytes_per_s = 1 << 20,
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

/* Asks for path and has room for little of the answer. */
static int presence_slowly(const char *path)
{
	const int little = 4096, fd = socket(AF_INET, SOCK_STREAM | SOCK_CLOEXEC, 0);
	char text[64];

	CHECK(setsockopt(fd, SOL_SOCKET, SO_RCVBUF, &little, sizeof(little)) == 0);
	CHECK(connect(fd, (struct sockaddr *)&address, sizeof(address)) == 0);
	snprintf(text, sizeof(text), "GET %s HTTP/1.1\r\n\r\n", path);
	say(fd, text);
	return fd;
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
	int slow[SERVER_CLIENTS_MAX + 4], fd;

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
	struct running server;
	size_t size;
	int fd;

	(void)state;
	answer_bytes = 130000;
	start(&server, 300, 200);
	fd = presence_slowly("/");
	finish(&server); /* did not wait for us */
	close(fd);
	start(&server, 60000, 200);
	fd = visit();
	say(fd, "GET / HTTP/1.1\r\n\r\n");
	size = hear(fd, text, sizeof(text));
	CHECK(size == 130006);
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

/* ---- files */

static uint8_t pattern(uint64_t at)
{
	return (uint8_t)((at * 2654435761u) >> 16);
}

static void make_file(uint64_t bytes)
{
	static uint8_t piece[1 << 16];

	file = memfd_create("file", MFD_CLOEXEC);
	CHECK(file >= 0);
	for (uint64_t at = 0; at < bytes; at += sizeof(piece)) {
		for (size_t i = 0; i < sizeof(piece); i++)
			piece[i] = pattern(at + i);
		CHECK(write(file, piece, sizeof(piece)) == (ssize_t)sizeof(piece));
	}
	file_bytes = bytes;
}

static void drop_file(void)
{
	close(file);
	file = -1;
}

/* How much comes until the server hangs up; each byte must be the file's. */
static uint64_t hear_file(int fd)
{
	static uint8_t piece[1 << 16];
	uint64_t at = 0;
	ssize_t size;

	while ((size = read(fd, piece, sizeof(piece))) > 0)
		for (ssize_t i = 0; i < size; i++)
			CHECK(piece[i] == pattern(at++));
	close(fd);
	return at;
}

static void a_file_of_many_megabytes_arrives_whole(void **state)
{
	struct running server;

	(void)state;
	make_file(20 << 20);
	start(&server, 60000, 200);
	CHECK(hear_file(presence_slowly("/visits.csv")) == file_bytes);
	finish(&server);
	drop_file();
}

static long resident_kib(void)
{
	FILE *status = fopen("/proc/self/status", "re");
	char line[128];
	long kib = -1;

	CHECK(status);
	while (fgets(line, sizeof(line), status))
		if (sscanf(line, "VmRSS: %ld", &kib) == 1)
			break;
	fclose(status);
	CHECK(kib > 0);
	return kib;
}

/* As many as there are places ask for a file and do not read it: no copy of it is in memory, some
 * are refused, and who asks for something else is still served. */
static void slow_readers_of_a_file_take_no_memory_and_not_every_place(void **state)
{
	struct running server;
	int slow[SERVER_CLIENTS_MAX - 1], refused = 0, fd;
	char text[64];
	long before_kib;

	(void)state;
	make_file(8 << 20);
	start(&server, 60000, 200);
	before_kib = resident_kib();
	for (size_t i = 0; i < ARRAY_COUNT(slow); i++)
		slow[i] = presence_slowly("/visits.csv");
	fd = visit();
	say(fd, "GET /health HTTP/1.1\r\n\r\n");
	hear(fd, text, sizeof(text));
	CHECK(strcmp(text, "200 2 xxx") == 0);
	CHECK(resident_kib() - before_kib < 8 * 1024);
	for (size_t i = 0; i < ARRAY_COUNT(slow); i++) {
		CHECK(recv(slow[i], text, 4, MSG_WAITALL) == 4);
		refused += memcmp(text, "503 ", 4) == 0;
		close(slow[i]);
	}
	CHECK(refused == (int)ARRAY_COUNT(slow) - SERVER_FILES_MAX);
	/* Their places are free again. */
	CHECK(hear_file(presence_slowly("/visits.csv")) == file_bytes);
	finish(&server);
	drop_file();
}

static void who_reads_a_file_too_slowly_is_cut(void **state)
{
	struct running server;
	int fd;

	(void)state;
	make_file(2 << 20);
	start(&server, 100, 200);
	server.options.file_bytes_per_s = 8 << 20;
	fd = presence_slowly("/visits.csv");
	finish(&server); /* did not wait for us */
	CHECK(hear_file(fd) < file_bytes);
	drop_file();
}

static void a_file_that_shrinks_ends_its_answer(void **state)
{
	struct running server;
	uint8_t first;
	int fd;

	(void)state;
	make_file(8 << 20);
	start(&server, 60000, 200);
	fd = presence_slowly("/visits.csv");
	CHECK(recv(fd, &first, 1, MSG_PEEK) == 1);
	CHECK(ftruncate(file, 1 << 20) == 0);
	CHECK(hear_file(fd) < file_bytes);
	fd = visit();
	say(fd, "GET /visits.csv HTTP/1.1\r\n\r\n");
	CHECK(hear_file(fd) == 1 << 20); /* announced longer than it is by now */
	finish(&server);
	drop_file();
}

/* ---- clients that mean no good */

/* Each byte comes in time, and the head never ends: the patience is for all of it. */
static void a_request_that_trickles_in_is_cut(void **state)
{
	struct running server;
	char text[64];
	int fd, sent;

	(void)state;
	start(&server, 300, 200);
	fd = visit();
	say(fd, "GET / HTTP/1.1\r\nA: ");
	for (sent = 0; sent < 1000 && send(fd, "a", 1, MSG_NOSIGNAL) == 1; sent++)
		usleep(20000);
	CHECK(sent < 1000);
	hear(fd, text, sizeof(text));
	CHECK(text[0] == '\0');
	finish(&server);
}

static void of_requests_in_a_row_the_first_is_answered(void **state)
{
	struct running server;
	char text[64];
	int fd;

	(void)state;
	start(&server, 60000, 200);
	fd = visit();
	for (int i = 0; i < 1000; i++)
		say(fd, "GET /metrics HTTP/1.1\r\n\r\nGET /health HTTP/1.1\r\n\r\n");
	shutdown(fd, SHUT_WR);
	hear(fd, text, sizeof(text));
	CHECK(strcmp(text, "200 1 xxx") == 0);
	finish(&server);
}

/* It would keep a place by sending for ever: the patience ends that too. */
static void who_talks_on_after_the_answer_is_cut(void **state)
{
	static char much[65536];
	struct running server;
	int fd;

	(void)state;
	start(&server, 300, 200);
	fd = visit();
	say(fd, "GET / HTTP/1.1\r\n\r\n");
	while (send(fd, much, sizeof(much), MSG_NOSIGNAL) > 0)
		;
	close(fd);
	finish(&server);
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
	const struct server_options options = { .answer = answer, .file_bytes_per_s = 1 };

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
		cmocka_unit_test(a_file_of_many_megabytes_arrives_whole),
		cmocka_unit_test(slow_readers_of_a_file_take_no_memory_and_not_every_place),
		cmocka_unit_test(who_reads_a_file_too_slowly_is_cut),
		cmocka_unit_test(a_file_that_shrinks_ends_its_answer),
		cmocka_unit_test(a_request_that_trickles_in_is_cut),
		cmocka_unit_test(of_requests_in_a_row_the_first_is_answered),
		cmocka_unit_test(who_talks_on_after_the_answer_is_cut),
		cmocka_unit_test(clients_that_vanish_are_no_matter),
		cmocka_unit_test(no_listener_is_an_error),
	};

	return cmocka_run_group_tests(tests, NULL, NULL);
}
