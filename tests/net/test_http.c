/* Requests against a small server inside the test that answers as no good server would. */
#include "net/http.h"

#include <arpa/inet.h>
#include <dlfcn.h>
#include <errno.h>
#include <netdb.h>
#include <netinet/tcp.h>
#include <poll.h>
#include <pthread.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/socket.h>
#include <time.h>
#include <unistd.h>

#include "base/clock.h"
#include "tests/check.h"

static const char letters[] = "abcdefghijklmnopqrstuvwxyz";

/* What the server sends for a path, byte for byte; then it closes. */
static const struct script {
	const char *path, *answer;
	enum {
		ENDS,
		STALLS,   /* nothing more comes, until the client gives up */
		TRICKLES, /* a byte now and then, for 25 s */
	} then;
} scripts[] = {
	{ "/whole",
	  "HTTP/1.1 200 OK\r\nETag:  \"v1\" \r\nContent-Length: 26\r\n\r\n"
	  "abcdefghijklmnopqrstuvwxyz",
	  ENDS },
	{ "/range",
	  "HTTP/1.1 206 Partial\r\nContent-Range: bytes 3-7/26\r\n"
	  "Content-Length: 5\r\n\r\ndefgh",
	  ENDS },
	{ "/other-range",
	  "HTTP/1.1 206 Partial\r\nContent-Range: bytes 4-8/26\r\n"
	  "Content-Length: 5\r\n\r\nefghi",
	  ENDS },
	{ "/no-range", "HTTP/1.1 206 Partial\r\nContent-Length: 5\r\n\r\ndefgh", ENDS },
	{ "/too-much",
	  "HTTP/1.1 206 Partial\r\nContent-Range: bytes 3-7/26\r\n"
	  "Content-Length: 9\r\n\r\ndefghijkl",
	  ENDS },
	{ "/cut",
	  "HTTP/1.1 206 Partial\r\nContent-Range: bytes 3-7/26\r\n"
	  "Content-Length: 5\r\n\r\nde",
	  ENDS },
	{ "/not-modified", "HTTP/1.1 304 Not Modified\r\nETag: \"v1\"\r\n\r\n", ENDS },
	{ "/absent", "HTTP/1.1 404 Not Found\r\nContent-Length: 7\r\n\r\nabsent!", ENDS },
	{ "/absent-at-length",
	  "HTTP/1.1 404 Not Found\r\nContent-Length: 40\r\n\r\n"
	  "absent, as this page tells at its length",
	  ENDS },
	{ "/announced", "HTTP/1.1 200 OK\r\nContent-Length: 31\r\n\r\n", STALLS },
	{ "/ill", "HTTP/1.1 503 Ill\r\nContent-Length: 4\r\n\r\nill!", ENDS },
	{ "/round", "HTTP/1.1 302 Found\r\nLocation: /round\r\nContent-Length: 0\r\n\r\n", ENDS },
	{ "/to-a-file",
	  "HTTP/1.1 302 Found\r\nLocation: file:///etc/passwd\r\n"
	  "Content-Length: 0\r\n\r\n",
	  ENDS },
	{ "/rubbish", "I am no web server\r\n\r\n", ENDS },
	{ "/stall", "HTTP/1.1 200 OK\r\nContent-Length: 26\r\n\r\nabc", STALLS },
	{ "/trickle", "HTTP/1.1 200 OK\r\nContent-Length: 30\r\n\r\nabc", TRICKLES },
};

static struct {
	int listener, port;
	pthread_t thread;
	char request[2048]; /* the last one */
} server;

/* Another port of the same machine; only counts who comes. */
static struct {
	int listener, port;
	pthread_t thread;
	_Atomic int requests;
} neighbour;

static const struct script *script_for(const char *request)
{
	for (size_t i = 0; i < ARRAY_COUNT(scripts); i++) {
		size_t length = strlen(scripts[i].path);

		if (strncmp(request, "GET ", 4) == 0 &&
		    strncmp(request + 4, scripts[i].path, length) == 0 &&
		    request[4 + length] == ' ')
			return &scripts[i];
	}
	return NULL;
}

static void trickle(int fd)
{
	const struct timespec pause = { .tv_nsec = 500000000 };

	for (int i = 0; i < 50 && send(fd, "x", 1, MSG_NOSIGNAL) == 1; i++)
		nanosleep(&pause, NULL);
}

/* "/to/PLACE" redirects to http://PLACE, "/far" on and on. */
static bool redirect(int fd)
{
	char place[256], answer[512];

	if (sscanf(server.request, "GET /to/%255[^ ] ", place) != 1)
		return false;
	snprintf(answer, sizeof(answer),
		 "HTTP/1.1 302 Found\r\nLocation: http://%s\r\nContent-Length: 3\r\n\r\nfar",
		 place);
	return write(fd, answer, strlen(answer)) > 0;
}

/* Headers without end, until the client has enough. */
static bool send_headers(int fd)
{
	static const char begin[] = "HTTP/1.1 200 OK\r\n";
	char line[1002];
	bool open = true;

	if (strncmp(server.request, "GET /headers ", 13) != 0)
		return false;
	memset(line, 'x', sizeof(line));
	memcpy(line, "X-More: ", 8);
	memcpy(line + sizeof(line) - 2, "\r\n", 2);
	send(fd, begin, sizeof(begin) - 1, MSG_NOSIGNAL);
	for (int i = 0; i < 100000 && open; i++)
		open = send(fd, line, sizeof(line), MSG_NOSIGNAL) > 0;
	CHECK(!open);
	return true;
}

static void serve_one(int fd)
{
	const struct script *script;
	size_t used = 0;
	ssize_t got;

	do {
		got = read(fd, server.request + used, sizeof(server.request) - 1 - used);
		used += got > 0 ? (size_t)got : 0;
		server.request[used] = '\0';
	} while (got > 0 && !strstr(server.request, "\r\n\r\n"));
	script = redirect(fd) || send_headers(fd) ? NULL : script_for(server.request);
	if (script && write(fd, script->answer, strlen(script->answer)) > 0 &&
	    script->then == STALLS)
		while (read(fd, server.request, 1) > 0)
			;
	if (script && script->then == TRICKLES)
		trickle(fd);
	close(fd);
}

static void *serve(void *unused)
{
	int fd;

	while ((fd = accept(server.listener, NULL, NULL)) >= 0)
		serve_one(fd);
	return unused;
}

static void *count_requests(void *unused)
{
	static const char answer[] = "HTTP/1.1 200 OK\r\nContent-Length: 5\r\n\r\nother";
	char request[2048];
	int fd;

	while ((fd = accept(neighbour.listener, NULL, NULL)) >= 0) {
		neighbour.requests++;
		if (read(fd, request, sizeof(request)) > 0)
			send(fd, answer, sizeof(answer) - 1, MSG_NOSIGNAL);
		close(fd);
	}
	return unused;
}

static int listen_on_loopback(int *port)
{
	struct sockaddr_in address = { .sin_family = AF_INET };
	socklen_t size = sizeof(address);
	int fd = socket(AF_INET, SOCK_STREAM | SOCK_CLOEXEC, 0);

	address.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
	CHECK(bind(fd, (struct sockaddr *)&address, size) == 0);
	CHECK(listen(fd, 8) == 0);
	CHECK(getsockname(fd, (struct sockaddr *)&address, &size) == 0);
	*port = ntohs(address.sin_port);
	return fd;
}

static int begin_server(void **state)
{
	(void)state;
	server.listener = listen_on_loopback(&server.port);
	neighbour.listener = listen_on_loopback(&neighbour.port);
	CHECK(pthread_create(&neighbour.thread, NULL, count_requests, NULL) == 0);
	return pthread_create(&server.thread, NULL, serve, NULL);
}

static int end_server(void **state)
{
	(void)state;
	shutdown(server.listener, SHUT_RDWR);
	pthread_join(server.thread, NULL);
	close(server.listener);
	shutdown(neighbour.listener, SHUT_RDWR);
	pthread_join(neighbour.thread, NULL);
	close(neighbour.listener);
	return 0;
}

#define SWALLOWED "swallowed.example"

static struct {
	_Atomic bool asked, may_answer, answered;
} names;

/* In place of the C library's: libcurl calls it on a thread of its own. */
int getaddrinfo(const char *name, const char *service, const struct addrinfo *hints,
		struct addrinfo **out)
{
	int (*real)(const char *, const char *, const struct addrinfo *, struct addrinfo **);

	if (strcmp(name, SWALLOWED) != 0) {
		*(void **)&real = dlsym(RTLD_NEXT, "getaddrinfo");
		return real(name, service, hints, out);
	}
	names.asked = true;
	for (int i = 0; i < 300 && !names.may_answer; i++)
		poll(NULL, 0, 10);
	names.answered = true;
	return EAI_AGAIN;
}

/* TCP_USER_TIMEOUT of the connection to the server, as of the last piece. */
static unsigned dead_after_ms;

static void look_at_connection(void)
{
	for (int fd = 3; fd < 64; fd++) {
		struct sockaddr_in peer = {
			0
		}; /* of another kind of socket only the family comes */
		socklen_t size = sizeof(peer), number = sizeof(dead_after_ms);

		if (getpeername(fd, (struct sockaddr *)&peer, &size) == 0 &&
		    peer.sin_family == AF_INET && ntohs(peer.sin_port) == server.port)
			CHECK(getsockopt(fd, IPPROTO_TCP, TCP_USER_TIMEOUT, &dead_after_ms,
					 &number) == 0);
	}
}

struct outcome {
	char why[128];
	char body[64], etag[64];
	size_t size;
	bool ended, not_modified;
	int rc;
	uint64_t received_bytes;
};

static bool on_piece(void *data, struct bytes piece)
{
	struct outcome *outcome = data;

	CHECK(outcome->size + piece.size < sizeof(outcome->body));
	memcpy(outcome->body + outcome->size, piece.data, piece.size);
	outcome->size += piece.size;
	look_at_connection();
	return true;
}

static void on_done(void *data, const struct http_result *result)
{
	struct outcome *outcome = data;

	CHECK(!outcome->ended && result->why[0]);
	outcome->ended = true;
	outcome->rc = result->rc;
	outcome->not_modified = result->not_modified;
	snprintf(outcome->etag, sizeof(outcome->etag), "%s", result->etag);
	snprintf(outcome->why, sizeof(outcome->why), "%s", result->why);
}

static struct outcome fetch_with(const struct http_options *options, const char *path,
				 uint64_t first, uint64_t size, const char *etag)
{
	struct outcome outcome = { .rc = 1 };
	struct http_get ask = { .path = path,
				.first = first,
				.size = size,
				.ceiling = 30,
				.etag = etag,
				.receive = on_piece,
				.done = on_done,
				.data = &outcome };
	int64_t until_ms = clock_now_ms() + 20000;
	struct http_request *request;
	struct http *http;

	CHECK(http_create(&http, options) == 0);
	CHECK(http_get(http, &ask, &request) == 0);
	while (!outcome.ended && clock_now_ms() < until_ms) {
		struct pollfd ready = { .fd = http_fd(http), .events = POLLIN };

		if (poll(&ready, 1, 1000) > 0)
			CHECK(http_dispatch(http) == 0);
	}
	CHECK(outcome.ended);
	outcome.received_bytes = http_received_bytes(http);
	http_destroy(http);
	return outcome;
}

static struct outcome fetch_from(const char *url, const char *path, uint64_t first, uint64_t size,
				 const char *etag)
{
	const struct http_options options = { .url = url, .stall_s = 1 };

	return fetch_with(&options, path, first, size, etag);
}

static struct outcome fetch(const char *path, uint64_t first, uint64_t size)
{
	char url[64];

	snprintf(url, sizeof(url), "http://127.0.0.1:%d/", server.port);
	return fetch_from(url, path, first, size, NULL);
}

static bool gave(const struct outcome *outcome, const char *text)
{
	return outcome->rc == 0 && outcome->size == strlen(text) &&
	       memcmp(outcome->body, text, outcome->size) == 0;
}

static void downloads_files_and_ranges(void **state)
{
	struct outcome outcome = fetch("whole", 0, 0);

	(void)state;
	CHECK(gave(&outcome, letters) && strcmp(outcome.etag, "\"v1\"") == 0);
	CHECK(outcome.received_bytes >= 26 + 50); /* headers too */
	outcome = fetch("range", 3, 5);
	CHECK(gave(&outcome, "defgh"));
	CHECK(strstr(server.request, "Range: bytes=3-7\r\n"));
}

static void finds_the_range_in_a_whole_file(void **state)
{
	struct outcome outcome = fetch("whole", 3, 5);

	(void)state;
	CHECK(gave(&outcome, "defgh"));
	outcome = fetch("whole", 24, 5); /* it ends before */
	CHECK(gave(&outcome, "yz"));
}

static void refuses_another_range_than_it_asked_for(void **state)
{
	struct outcome outcome = fetch("other-range", 3, 5);

	(void)state;
	CHECK(outcome.rc == -EBADMSG && outcome.size == 0);
	outcome = fetch("no-range", 3, 5);
	CHECK(outcome.rc == -EBADMSG && outcome.size == 0);
}

static void takes_no_byte_past_what_it_asked_for(void **state)
{
	struct outcome outcome = fetch("too-much", 3, 5);

	(void)state;
	CHECK(outcome.size == 5);
}

static void refuses_a_file_past_the_ceiling(void **state)
{
	char folder[] = "/tmp/gopura-http-XXXXXX", path[64];
	struct outcome outcome;

	(void)state;
	CHECK(mkdtemp(folder));
	snprintf(path, sizeof(path), "%s/large", folder);
	CHECK(bytes_write_file(
		      (struct bytes){ (const uint8_t *)"0123456789012345678901234567890", 31 },
		      path) == 0);
	outcome = fetch_from(folder, "large", 0, 0, NULL);
	CHECK(outcome.rc == -EBADMSG);
	unlink(path);
	rmdir(folder);
}

/* The server then sends nothing more, so only the header can tell. */
static void refuses_a_file_that_is_announced_past_the_ceiling(void **state)
{
	struct outcome outcome = fetch("announced", 0, 0);

	(void)state;
	CHECK(outcome.rc == -EBADMSG && outcome.size == 0);
	CHECK(strstr(outcome.why, "too large"));
	CHECK(fetch("absent-at-length", 0, 0).rc == -ENOENT); /* its page is not the file */
}

static void knows_a_bad_answer_from_no_answer(void **state)
{
	static const struct {
		const char *path;
		int rc;
	} cases[] = {
		{ "absent", -ENOENT },          { "ill", -EHOSTUNREACH },
		{ "cut", -EHOSTUNREACH },       { "round", -EHOSTUNREACH },
		{ "to-a-file", -EHOSTUNREACH }, { "rubbish", -EHOSTUNREACH },
		{ "stall", -EHOSTUNREACH },     { "nothing-at-all", -EHOSTUNREACH },
	};

	(void)state;
	for (size_t i = 0; i < ARRAY_COUNT(cases); i++) {
		bool ranged = strcmp(cases[i].path, "cut") == 0;
		struct outcome outcome = fetch(cases[i].path, ranged ? 3 : 0, ranged ? 5 : 0);

		if (outcome.rc != cases[i].rc)
			fail_msg("%s: %d", cases[i].path, outcome.rc);
	}
}

static void follows_redirections_to_the_server_itself(void **state)
{
	struct outcome outcome;
	char path[128];

	(void)state;
	snprintf(path, sizeof(path), "to/127.0.0.1:%d/whole", server.port);
	outcome = fetch(path, 0, 0);
	CHECK(gave(&outcome, letters) && strcmp(outcome.etag, "\"v1\"") == 0);
	snprintf(path, sizeof(path), "to/127.0.0.1:%d/range", server.port);
	outcome = fetch(path, 3, 5);
	CHECK(gave(&outcome, "defgh"));
	snprintf(path, sizeof(path), "to/127.0.0.1:%d/absent", server.port);
	outcome = fetch(path, 0, 0);
	CHECK(outcome.rc == -ENOENT);
}

static void follows_no_redirection_elsewhere(void **state)
{
	struct outcome outcome;
	char path[128];

	(void)state;
	snprintf(path, sizeof(path), "to/127.0.0.1:%d/other", neighbour.port);
	outcome = fetch(path, 0, 0);
	CHECK(outcome.rc == -EHOSTUNREACH && outcome.size == 0);
	CHECK(strcmp(outcome.why, "it redirects to another host, or too often") == 0);
	snprintf(path, sizeof(path), "to/localhost:%d/whole", server.port);
	outcome = fetch(path, 0, 0);
	CHECK(outcome.rc == -EHOSTUNREACH && outcome.size == 0);
	CHECK(neighbour.requests == 0); /* not even a connection */
}

static void follows_redirections_to_hosts_that_were_named(void **state)
{
	char url[64], named[64], path[128];
	const struct http_options options = { .url = url, .redirect_hosts = named };
	struct outcome outcome;

	(void)state;
	snprintf(url, sizeof(url), "http://127.0.0.1:%d", server.port);
	snprintf(named, sizeof(named), "127.0.0.1:%d", neighbour.port);
	snprintf(path, sizeof(path), "to/127.0.0.1:%d/other", neighbour.port);
	outcome = fetch_with(&options, path, 0, 0, NULL);
	CHECK(gave(&outcome, "other") && neighbour.requests == 1);
}

static void follows_a_few_redirections_only(void **state)
{
	struct outcome outcome;
	char path[256] = "";

	(void)state;
	for (int i = 0; i < 4; i++)
		snprintf(path + strlen(path), sizeof(path) - strlen(path), "to/127.0.0.1:%d/",
			 server.port);
	snprintf(path + strlen(path), sizeof(path) - strlen(path), "whole");
	outcome = fetch(path, 0, 0);
	CHECK(gave(&outcome, letters));
	outcome = fetch("round", 0, 0);
	CHECK(outcome.rc == -EHOSTUNREACH);
}

static void takes_no_headers_without_end(void **state)
{
	struct outcome outcome = fetch("headers", 0, 0);

	(void)state;
	CHECK(outcome.rc == -EBADMSG);
	CHECK(outcome.received_bytes < 50000000);
}

static void refuses_slow_retrieval(void **state)
{
	char url[64];
	const struct http_options options = { .url = url, .stall_s = 15, .patience_s = 1 };
	const int64_t began_ms = clock_now_ms();
	struct outcome outcome;

	(void)state;
	snprintf(url, sizeof(url), "http://127.0.0.1:%d", server.port);
	outcome = fetch_with(&options, "trickle", 0, 0, NULL);
	CHECK(outcome.rc == -EHOSTUNREACH && outcome.size >= 3);
	CHECK(strncmp(outcome.why, "too slow", 8) == 0);
	CHECK(clock_now_ms() - began_ms < 10000); /* long before it would count as stalled */
}

/* A connection to a machine that vanished takes requests as before, and answers none. */
static void has_the_kernel_end_a_dead_connection(void **state)
{
	(void)state;
	dead_after_ms = 0;
	(void)fetch("whole", 0, 0);
	CHECK(dead_after_ms > 0 && dead_after_ms <= 60000);
}

/* A name server that swallows queries. */
static void waits_for_no_name(void **state)
{
	const struct http_options options = { .url = "http://" SWALLOWED };
	struct http_get ask = { .path = "whole", .receive = on_piece, .done = on_done };
	struct pollfd ready = { .events = POLLIN };
	struct http_request *request;
	struct http *http;

	(void)state;
	CHECK(http_create(&http, &options) == 0 && http_get(http, &ask, &request) == 0);
	ready.fd = http_fd(http);
	while (!names.asked && poll(&ready, 1, 100) >= 0)
		CHECK(http_dispatch(http) == 0);
	http_cancel(request);
	http_destroy(http);
	CHECK(!names.answered);
	names.may_answer = true;
	while (!names.answered)
		poll(NULL, 0, 10);
}

static void asks_conditionally(void **state)
{
	struct outcome outcome;
	char url[64];

	(void)state;
	snprintf(url, sizeof(url), "http://127.0.0.1:%d", server.port);
	outcome = fetch_from(url, "not-modified", 0, 0, "\"v1\"");
	CHECK(outcome.rc == 0 && outcome.not_modified && outcome.size == 0);
	CHECK(strstr(server.request, "If-None-Match: \"v1\"\r\n"));
}

static void reads_a_folder_like_a_server(void **state)
{
	char folder[] = "/tmp/gopura 100% ü-XXXXXX", path[64];
	struct outcome outcome;

	(void)state;
	CHECK(mkdtemp(folder));
	snprintf(path, sizeof(path), "%s/file", folder);
	CHECK(bytes_write_file((struct bytes){ (const uint8_t *)letters, 26 }, path) == 0);
	outcome = fetch_from(folder, "file", 0, 0, NULL);
	CHECK(gave(&outcome, letters) && outcome.received_bytes == 26);
	outcome = fetch_from(folder, "file", 3, 5, NULL);
	CHECK(gave(&outcome, "defgh") && outcome.received_bytes == 5);
	outcome = fetch_from(folder, "absent", 0, 0, NULL);
	CHECK(outcome.rc == -ENOENT);
	outcome = fetch_from(folder, "file", 300, 5, NULL); /* past its end */
	CHECK(outcome.rc == -ENOENT || outcome.size == 0);
	unlink(path);
	rmdir(folder);
	outcome = fetch_from(folder, "file", 0, 0, NULL); /* the stick was pulled out */
	CHECK(outcome.rc == -EHOSTUNREACH);
}

static void knows_which_urls_it_can_serve(void **state)
{
	static const char *const bad[] = { "", "ftp://museum.example/", "gopher://x" };
	struct http *http;

	(void)state;
	for (size_t i = 0; i < ARRAY_COUNT(bad); i++) {
		struct http_options options = { .url = bad[i] };

		CHECK(http_create(&http, &options) == -EINVAL && http == NULL);
	}
	http_destroy(NULL);
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(downloads_files_and_ranges),
		cmocka_unit_test(finds_the_range_in_a_whole_file),
		cmocka_unit_test(refuses_another_range_than_it_asked_for),
		cmocka_unit_test(takes_no_byte_past_what_it_asked_for),
		cmocka_unit_test(refuses_a_file_past_the_ceiling),
		cmocka_unit_test(refuses_a_file_that_is_announced_past_the_ceiling),
		cmocka_unit_test(knows_a_bad_answer_from_no_answer),
		cmocka_unit_test(follows_redirections_to_the_server_itself),
		cmocka_unit_test(follows_no_redirection_elsewhere),
		cmocka_unit_test(follows_redirections_to_hosts_that_were_named),
		cmocka_unit_test(follows_a_few_redirections_only),
		cmocka_unit_test(takes_no_headers_without_end),
		cmocka_unit_test(refuses_slow_retrieval),
		cmocka_unit_test(has_the_kernel_end_a_dead_connection),
		cmocka_unit_test(waits_for_no_name),
		cmocka_unit_test(asks_conditionally),
		cmocka_unit_test(reads_a_folder_like_a_server),
		cmocka_unit_test(knows_which_urls_it_can_serve),
	};

	return cmocka_run_group_tests(tests, begin_server, end_server);
}
