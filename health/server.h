/* HTTP/1.1 for a handful of clients on one thread: a request, its answer, the end of the
 * connection. What a client can take of us is bounded: REQUEST_BYTES_MOST bytes,
 * SERVER_CLIENTS_MOST connections, patience_ms for all of one. */
#ifndef GOPURA_HEALTH_SERVER_H
#define GOPURA_HEALTH_SERVER_H

#include "health/request.h"

enum { SERVER_CLIENTS_MOST = 16, SERVER_LISTENERS_MOST = 4 };

struct server_options {
	const int *listeners; /* borrowed; listening stream sockets, made non-blocking */
	size_t listener_count;
	int64_t patience_ms; /* then a connection is cut, whatever it is at */
	int64_t idle_ms;     /* without a connection: the server ends; 0: never */
	/* A whole HTTP answer into out, which is cleared before. status 200: to request; else what
	 * request_parse found wrong. */
	void (*answer)(void *data, int status, const struct request *request, struct buffer *out);
	void *data;
};

/* 0 when it was idle for idle_ms. -EINVAL: more listeners than SERVER_LISTENERS_MOST, or none. */
must_check int server_run(const struct server_options *options);

#endif
