/* Anything as an HTTP server's answers, through the whole of net/http.c and libcurl: connections
 * are socket pairs, the other end of which is here. First byte: what is asked for; second: how
 * large the pieces are that arrive; the rest is what the server sends, on whatever connections
 * there are (an answer that redirects is followed by what the next one gets). */
#include <errno.h>
#include <netdb.h>
#include <poll.h>
#include <sys/socket.h>
#include <sys/syscall.h>

#include "net/http.h"
#include "tests/fuzz/scratch.h"

enum {
	ASK_RANGE = 1,
	ASK_ETAG = 2,
	ASK_LITTLE = 4, /* a low ceiling */
	ASK_FEW = 8,    /* the receiver has enough after some bytes */
	FIRST = 100,
	RANGE_BYTES = 50,
	CEILING_BYTES = 4096,
	CEILING_LITTLE_BYTES = 10,
	ENOUGH_BYTES = 20,
	STEPS_MAX = 400,
};

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size);

static struct server {
	struct bytes left; /* to be sent */
	int fd;            /* of the newest connection; -1: none */
	size_t piece_bytes;
} server;

static struct asked {
	uint8_t what;
	uint64_t given;
	int done;
} asked;

/* ---- a network of this process alone */

int socket(int domain, int type, int protocol)
{
	int pair[2];

	if ((type & 0xf) != SOCK_STREAM || domain == AF_UNIX)
		return (int)syscall(SYS_socket, domain, type, protocol);
	if (socketpair(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC | SOCK_NONBLOCK, 0, pair) < 0)
		return -1;
	if (server.fd >= 0)
		close(server.fd);
	server.fd = pair[1];
	return pair[0];
}

int connect(int fd, const struct sockaddr *address, socklen_t size)
{
	(void)fd, (void)address, (void)size;
	return 0;
}

/* No name is known. */
int getaddrinfo(const char *name, const char *service, const struct addrinfo *wish,
		struct addrinfo **out)
{
	(void)name, (void)service, (void)wish;
	*out = NULL;
	return EAI_NONAME;
}

/* The next piece, once something was asked on the connection; at the end of all, it hangs up. */
static void serve(void)
{
	struct pollfd ready = { .fd = server.fd, .events = POLLIN };
	uint8_t dropped[4096];
	size_t size = server.left.size < server.piece_bytes ? server.left.size : server.piece_bytes;
	ssize_t sent;

	if (server.fd < 0)
		return;
	while (poll(&ready, 1, 0) > 0 && read(server.fd, dropped, sizeof(dropped)) > 0)
		;
	if (size == 0) {
		close(server.fd);
		server.fd = -1;
		return;
	}
	sent = send(server.fd, server.left.data, size, MSG_NOSIGNAL);
	if (sent <= 0)
		return;
	server.left.data += sent;
	server.left.size -= (size_t)sent;
}

/* ---- who asks */

static uint64_t most(void)
{
	if (asked.what & ASK_RANGE)
		return RANGE_BYTES;
	return asked.what & ASK_LITTLE ? CEILING_LITTLE_BYTES : CEILING_BYTES;
}

static bool receive(void *data, struct bytes piece)
{
	(void)data;
	if (asked.done || piece.size == 0)
		abort();
	asked.given += piece.size;
	if (asked.given > most())
		abort();
	return !(asked.what & ASK_FEW) || asked.given < ENOUGH_BYTES;
}

static void done(void *data, const struct http_result *result)
{
	(void)data;
	asked.done++;
	if ((result->rc != 0 && result->rc != -ENOENT && result->rc != -EBADMSG &&
	     result->rc != -EHOSTUNREACH) ||
	    !result->why || strlen(result->why) == 0 || strlen(result->etag) > 200 ||
	    strpbrk(result->etag, "\r\n"))
		abort();
	if (result->not_modified && asked.given > 0)
		abort();
}

static void ask(struct http *http)
{
	const struct http_get ask = {
		.path = "packs/00",
		.first = asked.what & ASK_RANGE ? FIRST : 0,
		.size = asked.what & ASK_RANGE ? RANGE_BYTES : 0,
		.ceiling = most(),
		.etag = asked.what & ASK_ETAG ? "\"abc\"" : NULL,
		.receive = receive,
		.done = done,
	};
	struct http_request *request;

	if (http_get(http, &ask, &request) < 0)
		abort();
	for (int i = 0; i < STEPS_MAX && !asked.done; i++) {
		struct pollfd ready = { .fd = http_fd(http), .events = POLLIN };

		poll(&ready, 1, i > STEPS_MAX / 2 ? 1 : 0);
		if (http_dispatch(http) < 0)
			abort();
		serve();
	}
	if (!asked.done)
		http_cancel(request);
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
	struct http_options options = { .url = "http://127.0.0.1:1" };
	struct http *http;

	if (size < 2)
		return 0;
	if (!scratch[0]) { /* no authority is trusted, and no list of them is read each time */
		scratch_begin();
		scratch_write("ca.pem", NULL, 0);
	}
	options.ca_file = scratch_path("ca.pem");
	asked = (struct asked){ .what = data[0] };
	server = (struct server){ .left = { data + 2, size - 2 },
				  .fd = -1,
				  .piece_bytes = data[1] % 8 ? data[1] : 1u << 20 };
	if (http_create(&http, &options) < 0)
		abort();
	ask(http);
	http_destroy(http);
	if (server.fd >= 0)
		close(server.fd);
	if (asked.done > 1)
		abort();
	return 0;
}
