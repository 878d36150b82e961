/* A server inside the test, in place of net/http.c, and a clock that the test moves. Requests wait
 * until the test answers them. */
#ifndef GOPURA_TESTS_FAKE_HTTP_H
#define GOPURA_TESTS_FAKE_HTTP_H

#include <errno.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "base/clock.h"
#include "net/http.h"
#include "tests/check.h"

enum { ASKED_MAX = 32 };

struct http_request {
	struct http_ask ask;
	char path[80], etag[80];
	bool open; /* neither answered nor cancelled */
};

static struct fake_server {
	struct http_request asked[ASKED_MAX];
	size_t count; /* requests so far */
	size_t cancelled;
	int64_t now_ms;
	bool is_giving; /* a receiver must not call into http */
} server;

int64_t clock_now_ms(void)
{
	return server.now_ms;
}

int64_t clock_now_us(void)
{
	return server.now_ms * 1000;
}

int64_t clock_thread_us(void)
{
	return 0;
}

int64_t clock_wall_s(void)
{
	return 1700000000 + server.now_ms / 1000;
}

int http_create(struct http **out, const struct http_options *options)
{
	(void)options;
	*out = NULL;
	return 0;
}

void http_destroy(struct http *http)
{
	(void)http;
}

int http_fd(const struct http *http)
{
	(void)http;
	return -1;
}

int http_dispatch(struct http *http)
{
	(void)http;
	return 0;
}

uint64_t http_received_bytes(const struct http *http)
{
	(void)http;
	return 0;
}

const char *http_url(const struct http *http)
{
	(void)http;
	return "fake:";
}

int http_ask(struct http *http, const struct http_ask *ask, struct http_request **out)
{
	struct http_request *request = &server.asked[server.count++];

	(void)http;
	CHECK(!server.is_giving);
	CHECK(server.count <= ASKED_MAX);
	*request = (struct http_request){ .ask = *ask, .open = true };
	snprintf(request->path, sizeof(request->path), "%s", ask->path);
	snprintf(request->etag, sizeof(request->etag), "%s", ask->etag ? ask->etag : "");
	request->ask.path = request->path;
	request->ask.etag = request->etag;
	*out = request;
	return 0;
}

void http_cancel(struct http_request *request)
{
	CHECK(request->open && !server.is_giving);
	request->open = false;
	server.cancelled++;
}

/* The n-th request from the end (0: the last). */
static inline struct http_request *asked(size_t n)
{
	CHECK(n < server.count);
	return &server.asked[server.count - 1 - n];
}

/* Gives bytes in pieces of an odd size. */
static inline void give(struct http_request *request, struct bytes body)
{
	while (body.size > 0) {
		size_t piece = body.size < 1009 ? body.size : 1009;
		bool more;

		CHECK(request->open);
		server.is_giving = true;
		more = request->ask.receive(request->ask.data, (struct bytes){ body.data, piece });
		server.is_giving = false;
		if (!more)
			return;
		body.data += piece;
		body.size -= piece;
	}
}

static inline void end(struct http_request *request, int rc)
{
	struct http_result result = { .rc = rc, .etag = "", .why = "the test says so" };

	CHECK(request->open);
	request->open = false;
	request->ask.done(request->ask.data, &result);
}

#endif
