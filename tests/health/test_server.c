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

enum { BODY_BYTES_MAX = 132 << 10 };

static struct sockaddr_in address = { .sin_family = AF_INET };
static size_t answer_bytes = 3;
static int file = -1;
static uint64_t file_bytes;

/* "PATH " and as many bytes as the test wants; for /file, the file; for others, nothing. */
static void answer(void *data, const char *path, struct reply *reply)
{
	(void)data;
	if (strcmp(path, "/file") == 0) {
		reply->status = 200;
		reply->type = "text/csv";
		reply->file = dup(file);
		reply->file_bytes = file_bytes;
	} else if (strcmp(path, "/") == 0 || strcmp(path, "/ill") == 0) {
		reply->status = path[1] ? 503 : 200;
		reply->type = "text/plain";
		buffer_init(&reply->body, BODY_BYTES_MAX);
		buffer_put(&reply->body, path, strlen(path));
		buffer_put_u8(&reply->body, ' ');
		for (size_t i = 0; i < answer_bytes; i++)
			buffer_put_u8(&reply->body, 'x');
	}
}

struct running {
	int rc;
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
	const int listener = socket(AF_INET, SOCK_STREAM | SOCK_CLOEXEC, 0);
	address.sin_port = 0;
	address.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
	CHECK(bind(listener, (struct sockaddr *)&address, sizeof(address)) == 0);
	CHECK(listen(listener, 64) == 0);
	CHECK(getsockname(listener, (struct sockaddr *)&address, &size) == 0);
	server->options = (struct server_options){
		.listener = listener,
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
}

/* Connects from 127.0.0.HOST. */
static int connect_from(uint8_t host)
{
	struct sockaddr_in from = { .sin_family = AF_INET,
				    .sin_addr.s_addr = htonl(0x7f000000u | host) };
	int fd = socket(AF_INET, SOCK_STREAM | SOCK_CLOEXEC, 0);

	CHECK(bind(fd, (struct sockaddr *)&from, sizeof(from)) == 0);
	CHECK(connect(fd, (struct sockaddr *)&address, sizeof(address)) == 0);
	return fd;
}

static int connect_to_server(void)
{
	return connect_from(1);
}

static void send_text(int fd, const char *text)
{
	CHECK(send(fd, text, strlen(text), MSG_NOSIGNAL) == (ssize_t)strlen(text));
}

/* Requests a path from 127.0.0.HOST, with room for little of the answer. */
static int request_slowly(const char *path, uint8_t host)
{
	const int little = 4096;
	struct sockaddr_in from = { .sin_family = AF_INET,
				    .sin_addr.s_addr = htonl(0x7f000000u | host) };
	const int fd = socket(AF_INET, SOCK_STREAM | SOCK_CLOEXEC, 0);
	char text[64];

	CHECK(setsockopt(fd, SOL_SOCKET, SO_RCVBUF, &little, sizeof(little)) == 0);
	CHECK(bind(fd, (struct sockaddr *)&from, sizeof(from)) == 0);
	CHECK(connect(fd, (struct sockaddr *)&address, sizeof(address)) == 0);
	snprintf(text, sizeof(text), "GET %s HTTP/1.1\r\n\r\n", path);
	send_text(fd, text);
	return fd;
}

/* All until the server hangs up; how much. */
static size_t receive(int fd, char *text, size_t text_bytes)
{
	size_t size = 0;
	ssize_t more;

	while ((more = read(fd, text + size, text_bytes - 1 - size)) > 0)
		size += (size_t)more;
	text[size] = '\0';
	close(fd);
	return size;
}

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

/* Receives a whole answer; checks its status and returns its body, terminated. */
static const char *receive_answer(int fd, const char *status, char *text, size_t text_bytes)
{
	const char *body;

	receive(fd, text, text_bytes);
	CHECK(strncmp(text, "HTTP/1.1 ", 9) == 0 && strncmp(text + 9, status, strlen(status)) == 0);
	body = strstr(text, "\r\n\r\n");
	CHECK(body);
	return body + 4;
}

static void a_request_gets_its_answer_in_however_many_pieces(void **state)
{
	struct running server;
	char text[1024];
	int fd;

	(void)state;
	start(&server, 60000, 500);
	fd = connect_to_server();
	send_text(fd, "GET /i");
	usleep(20000);
	send_text(fd, "ll?now HTTP/1.1\r\n\r");
	send_text(fd, "\n");
	CHECK(strcmp(receive_answer(fd, "503 ", text, sizeof(text)), "/ill xxx") == 0);
	CHECK(strstr(text, "Content-Type: text/plain; charset=utf-8\r\n"));
	CHECK(strstr(text, "Cache-Control: no-store\r\n"));
	CHECK(strstr(text, "X-Content-Type-Options: nosniff\r\n"));
	CHECK(strstr(text,
		     "Content-Security-Policy: default-src 'none'; style-src 'unsafe-inline'\r\n"));
	CHECK(strstr(text, "Connection: close\r\n"));
	finish(&server);
}

static void a_head_request_gets_no_body(void **state)
{
	struct running server;
	char text[1024];
	int fd;

	(void)state;
	make_file(2000);
	start(&server, 60000, 500);
	fd = connect_to_server();
	send_text(fd, "HEAD / HTTP/1.1\r\n\r\n");
	CHECK(strcmp(receive_answer(fd, "200 ", text, sizeof(text)), "") == 0);
	CHECK(strstr(text, "Content-Length: 5\r\n"));
	fd = connect_to_server();
	send_text(fd, "HEAD /file HTTP/1.0\r\n\r\n");
	CHECK(strcmp(receive_answer(fd, "200 ", text, sizeof(text)), "") == 0);
	CHECK(strstr(text, "Content-Length: 2000\r\n"));
	finish(&server);
	drop_file();
}

static void refuses_what_it_does_not_serve(void **state)
{
	static const struct {
		const char *request, *status, *body;
	} cases[] = {
		{ "GET /none HTTP/1.1\r\n\r\n", "404 ", "404 Not Found\n" },
		{ "GET /../file HTTP/1.1\r\n\r\n", "404 ", "404 Not Found\n" },
		{ "POST / HTTP/1.1\r\nContent-Length: 3\r\n\r\nx=1", "405 ",
		  "405 Method Not Allowed\n" },
		{ "WELL / HTTP/1.1\r\n\r\n", "405 ", "405 Method Not Allowed\n" },
		{ "GET / HTTP/3.0\r\n\r\n", "505 ", NULL },
		{ "GET / FTP/1.1\r\n\r\n", "400 ", NULL },
	};
	struct running server;
	char text[2048];

	(void)state;
	start(&server, 60000, 500);
	for (size_t i = 0; i < ARRAY_COUNT(cases); i++) {
		int fd = connect_to_server();
		const char *body;

		send_text(fd, cases[i].request);
		body = receive_answer(fd, cases[i].status, text, sizeof(text));
		CHECK(!cases[i].body || strcmp(body, cases[i].body) == 0);
		CHECK(cases[i].status[2] != '5' || cases[i].status[0] != '4' ||
		      strstr(text, "Allow: GET, HEAD\r\n"));
	}
	finish(&server);
}

static void a_head_that_is_too_long_is_refused(void **state)
{
	static char much[20000];
	struct running server;
	char text[2048];
	int fd;

	(void)state;
	start(&server, 60000, 500);
	fd = connect_to_server();
	send_text(fd, "GET / HTTP/1.1\r\nA: ");
	memset(much, 'a', sizeof(much));
	CHECK(send(fd, much, sizeof(much), MSG_NOSIGNAL) == (ssize_t)sizeof(much));
	receive_answer(fd, "431 ", text, sizeof(text));
	finish(&server);
}

static void slow_clients_are_disconnected_and_others_are_served_meanwhile(void **state)
{
	struct running server;
	char text[1024];
	int slow[SERVER_CLIENTS_MAX + 4], fd;

	(void)state;
	start(&server, 300, 500);
	slow[0] = connect_to_server();
	send_text(slow[0], "GET / HT");
	fd = connect_to_server();
	send_text(fd, "GET / HTTP/1.1\r\n\r\n");
	CHECK(strcmp(receive_answer(fd, "200 ", text, sizeof(text)), "/ xxx") == 0);
	/* More than the server accepts: later ones wait until earlier ones are disconnected. */
	for (size_t i = 1; i < ARRAY_COUNT(slow); i++)
		slow[i] = connect_from((uint8_t)(1 + i % 5));
	fd = connect_from(9);
	send_text(fd, "GET /ill HTTP/1.1\r\n\r\n");
	CHECK(strcmp(receive_answer(fd, "503 ", text, sizeof(text)), "/ill xxx") == 0);
	for (size_t i = 0; i < ARRAY_COUNT(slow); i++)
		CHECK(receive(slow[i], text, sizeof(text)) == 0);
	finish(&server);
}

/* One address cannot take every place. */
static void connections_of_one_address_are_limited(void **state)
{
	int silent[SERVER_CLIENTS_PER_ADDRESS_MAX], fd;
	struct running server;
	char text[1024];

	(void)state;
	start(&server, 60000, 500);
	for (size_t i = 0; i < ARRAY_COUNT(silent); i++)
		silent[i] = connect_from(1);
	fd = connect_from(1);
	CHECK(receive(fd, text, sizeof(text)) == 0); /* closed without an answer */
	fd = connect_from(2);
	send_text(fd, "GET / HTTP/1.1\r\n\r\n");
	CHECK(strcmp(receive_answer(fd, "200 ", text, sizeof(text)), "/ xxx") == 0);
	for (size_t i = 0; i < ARRAY_COUNT(silent); i++)
		close(silent[i]);
	finish(&server);
}

static void who_does_not_read_the_answer_is_disconnected(void **state)
{
	static char text[300000];
	struct running server;
	int fd;

	(void)state;
	answer_bytes = 130000;
	start(&server, 300, 500);
	fd = request_slowly("/", 1);
	finish(&server); /* did not wait for us */
	close(fd);
	start(&server, 60000, 500);
	fd = connect_to_server();
	send_text(fd, "GET / HTTP/1.1\r\n\r\n");
	CHECK(strlen(receive_answer(fd, "200 ", text, sizeof(text))) == 130002);
	finish(&server);
	answer_bytes = 3;
}

static void an_answer_that_does_not_fit_is_not_sent(void **state)
{
	struct running server;
	char text[64];
	int fd;

	(void)state;
	answer_bytes = 10 << 20;
	start(&server, 60000, 500);
	fd = connect_to_server();
	send_text(fd, "GET / HTTP/1.1\r\n\r\n");
	CHECK(receive(fd, text, sizeof(text)) == 0);
	finish(&server);
	answer_bytes = 3;
}

/* ---- files */

/* Receives an answer with the file; each byte must be right. Returns the size of its body. */
static uint64_t receive_file(int fd)
{
	static uint8_t piece[1 << 16];
	char head[1024] = "";
	uint64_t at = 0;
	ssize_t size;

	for (size_t i = 0; i < sizeof(head) - 1 && !strstr(head, "\r\n\r\n"); i++)
		if (recv(fd, &head[i], 1, 0) != 1)
			break;
	CHECK(strncmp(head, "HTTP/1.1 200 OK\r\n", 17) == 0);
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
	start(&server, 60000, 500);
	CHECK(receive_file(request_slowly("/file", 1)) == file_bytes);
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

/* As many clients as there are places but one request a file and do not read it: no copy of it is
 * in memory, some are refused, and a request for something else is still served. */
static void slow_readers_of_a_file_take_no_memory_and_not_every_place(void **state)
{
	struct running server;
	int slow[SERVER_CLIENTS_MAX - 1], refused = 0, fd;
	char text[1024];
	long before_kib;

	(void)state;
	make_file(8 << 20);
	start(&server, 60000, 500);
	before_kib = resident_kib();
	for (size_t i = 0; i < ARRAY_COUNT(slow); i++)
		slow[i] = request_slowly("/file", (uint8_t)(1 + i % 5));
	fd = connect_from(9);
	send_text(fd, "GET / HTTP/1.1\r\n\r\n");
	CHECK(strcmp(receive_answer(fd, "200 ", text, sizeof(text)), "/ xxx") == 0);
	CHECK(resident_kib() - before_kib < 8 * 1024);
	for (size_t i = 0; i < ARRAY_COUNT(slow); i++) {
		CHECK(recv(slow[i], text, 13, MSG_WAITALL) == 13);
		refused += memcmp(text, "HTTP/1.1 503 ", 13) == 0;
		close(slow[i]);
	}
	CHECK(refused == (int)ARRAY_COUNT(slow) - SERVER_FILES_MAX);
	/* Their places are free again. */
	CHECK(receive_file(request_slowly("/file", 1)) == file_bytes);
	finish(&server);
	drop_file();
}

static void who_reads_a_file_too_slowly_is_disconnected(void **state)
{
	struct running server;
	int fd;

	(void)state;
	make_file(2 << 20);
	start(&server, 100, 500);
	server.options.file_bytes_per_s = 8 << 20;
	fd = request_slowly("/file", 1);
	finish(&server); /* did not wait for us */
	CHECK(receive_file(fd) < file_bytes);
	drop_file();
}

static void a_file_that_shrinks_ends_its_answer(void **state)
{
	struct running server;
	uint8_t first;
	int fd;

	(void)state;
	make_file(8 << 20);
	start(&server, 60000, 500);
	fd = request_slowly("/file", 1);
	CHECK(recv(fd, &first, 1, MSG_PEEK) == 1);
	CHECK(ftruncate(file, 1 << 20) == 0);
	CHECK(receive_file(fd) < file_bytes);
	fd = connect_to_server();
	send_text(fd, "GET /file HTTP/1.1\r\n\r\n");
	CHECK(receive_file(fd) == 1 << 20); /* announced longer than it is by now */
	finish(&server);
	drop_file();
}

/* ---- clients that mean no good */

/* Each byte comes in time, and the head never ends: the patience is for all of it. */
static void a_request_that_trickles_in_is_disconnected(void **state)
{
	struct running server;
	char text[64];
	int fd, sent;

	(void)state;
	start(&server, 300, 500);
	fd = connect_to_server();
	send_text(fd, "GET / HTTP/1.1\r\nA: ");
	for (sent = 0; sent < 1000 && send(fd, "a", 1, MSG_NOSIGNAL) == 1; sent++)
		usleep(20000);
	CHECK(sent < 1000);
	receive(fd, text, sizeof(text));
	CHECK(text[0] == '\0');
	finish(&server);
}

static void of_requests_in_a_row_the_first_is_answered(void **state)
{
	struct running server;
	char text[2048];
	int fd;

	(void)state;
	start(&server, 60000, 500);
	fd = connect_to_server();
	send_text(fd, "GET / HTTP/1.1\r\n\r\nGET /ill HTTP/1.1\r\n\r\nGET / HTTP/1.1\r\n\r\n");
	CHECK(strcmp(receive_answer(fd, "200 ", text, sizeof(text)), "/ xxx") == 0);
	finish(&server);
}

/* It would keep a place by sending for ever: the patience ends that too. */
static void who_sends_on_after_the_answer_is_disconnected(void **state)
{
	static char much[65536];
	struct running server;
	int fd;

	(void)state;
	start(&server, 300, 500);
	fd = connect_to_server();
	send_text(fd, "GET / HTTP/1.1\r\n\r\n");
	while (send(fd, much, sizeof(much), MSG_NOSIGNAL) > 0)
		;
	close(fd);
	finish(&server);
}

static void clients_that_vanish_are_no_matter(void **state)
{
	const struct linger at_once = { 1, 0 };
	struct running server;
	char text[1024];
	int fd;

	(void)state;
	start(&server, 60000, 500);
	for (int i = 0; i < 50; i++) {
		fd = connect_to_server();
		if (i % 3)
			send_text(fd, i % 3 == 1 ? "GET / HTTP/1.1\r\n\r\n" : "GET");
		setsockopt(fd, SOL_SOCKET, SO_LINGER, &at_once, sizeof(at_once));
		close(fd);
	}
	/* Until the server has noticed that they are gone, they may take all its places. */
	for (int i = 0; i < 100; i++) {
		fd = connect_to_server();
		send(fd, "GET / HTTP/1.1\r\n\r\n", 18, MSG_NOSIGNAL);
		if (receive(fd, text, sizeof(text)) > 0)
			break;
		usleep(20000);
	}
	CHECK(strncmp(text, "HTTP/1.1 200 ", 13) == 0);
	finish(&server);
}

static void what_is_no_listener_is_refused(void **state)
{
	struct server_options options = { .answer = answer, .patience_ms = 1000, .idle_ms = 1 };

	(void)state;
	options.listener = memfd_create("none", MFD_CLOEXEC);
	CHECK(server_run(&options) == -EINVAL); /* no rate for files */
	options.file_bytes_per_s = 1;
	CHECK(server_run(&options) == -EINVAL);
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(a_request_gets_its_answer_in_however_many_pieces),
		cmocka_unit_test(a_head_request_gets_no_body),
		cmocka_unit_test(refuses_what_it_does_not_serve),
		cmocka_unit_test(a_head_that_is_too_long_is_refused),
		cmocka_unit_test(slow_clients_are_disconnected_and_others_are_served_meanwhile),
		cmocka_unit_test(connections_of_one_address_are_limited),
		cmocka_unit_test(who_does_not_read_the_answer_is_disconnected),
		cmocka_unit_test(an_answer_that_does_not_fit_is_not_sent),
		cmocka_unit_test(a_file_of_many_megabytes_arrives_whole),
		cmocka_unit_test(slow_readers_of_a_file_take_no_memory_and_not_every_place),
		cmocka_unit_test(who_reads_a_file_too_slowly_is_disconnected),
		cmocka_unit_test(a_file_that_shrinks_ends_its_answer),
		cmocka_unit_test(a_request_that_trickles_in_is_disconnected),
		cmocka_unit_test(of_requests_in_a_row_the_first_is_answered),
		cmocka_unit_test(who_sends_on_after_the_answer_is_disconnected),
		cmocka_unit_test(clients_that_vanish_are_no_matter),
		cmocka_unit_test(what_is_no_listener_is_refused),
	};

	return cmocka_run_group_tests(tests, NULL, NULL);
}
