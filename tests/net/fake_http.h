/* A server inside the test, in place of net/http.c, and a clock that the test moves. Requests wait
 * until the test answers them. For unit tests and fuzz targets: a broken promise of net/http.h
 * aborts. */
#ifndef GOPURA_TESTS_FAKE_HTTP_H
#define GOPURA_TESTS_FAKE_HTTP_H

#include <assert.h>
#include <errno.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "base/clock.h"
#include "net/http.h"

enum { ASKED_MAX = 64 }; /* requests of one test; then http_get has no memory */

struct http_request {
	struct http_get get;
	char path[80], etag[80];
	bool open;      /* neither answered nor cancelled */
	bool enough;    /* the receiver needs no more */
	uint64_t given; /* bytes */
};

static struct fake_server {
	struct http_request asked[ASKED_MAX];
	size_t count; /* requests so far */
	size_t cancelled;
	int64_t now_ms;
	int64_t wall_ahead_s; /* the wall clock was set by so much */
	bool is_giving;       /* a receiver must not call into http */
	bool is_full;         /* http_get has no memory */
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
	return 1700000000 + server.now_ms / 1000 + server.wall_ahead_s;
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

int http_get(struct http *http, const struct http_get *get, struct http_request **out)
{
	struct http_request *request = &server.asked[server.count];

	(void)http;
	assert(!server.is_giving);
	*out = NULL;
	if (server.count == ASKED_MAX || server.is_full)
		return -ENOMEM;
	server.count++;
	*request = (struct http_request){ .get = *get, .open = true };
	snprintf(request->path, sizeof(request->path), "%s", get->path);
	snprintf(request->etag, sizeof(request->etag), "%s", get->etag ? get->etag : "");
	request->get.path = request->path;
	request->get.etag = request->etag;
	*out = request;
	return 0;
}

void http_cancel(struct http_request *request)
{
	assert(request->open && !server.is_giving);
	request->open = false;
	server.cancelled++;
}

/* The n-th request from the end (0: the last). */
static inline struct http_request *asked(size_t n)
{
	assert(n < server.count);
	return &server.asked[server.count - 1 - n];
}

/* Gives bytes in pieces of an odd size: never past what was requested, and nothing after the
 * receiver had enough. */
static inline void give(struct http_request *request, struct bytes body)
{
	const uint64_t max = request->get.size ? request->get.size : request->get.ceiling;

	assert(request->open);
	if (body.size > max - request->given)
		body.size = (size_t)(max - request->given);
	while (body.size > 0 && !request->enough) {
		size_t piece = body.size < 1009 ? body.size : 1009;

		server.is_giving = true;
		request->enough = !request->get.receive(request->get.data,
							(struct bytes){ body.data, piece });
		server.is_giving = false;
		request->given += piece;
		body.data += piece;
		body.size -= piece;
	}
}

static inline void end(struct http_request *request, int rc)
{
	struct http_result result = { .rc = rc, .etag = "", .why = "the test says so" };

	assert(request->open);
	request->open = false;
	request->get.done(request->get.data, &result);
}

#endif
