/* Parses the head of an HTTP/1.1 request, as far as four pages need it. Pure. */
#ifndef GOPURA_HEALTH_REQUEST_H
#define GOPURA_HEALTH_REQUEST_H

#include "base/bytes.h"

enum { REQUEST_BYTES_MAX = 4096 /* of a head */ };

enum request_page {
	REQUEST_OVERVIEW, /* / */
	REQUEST_METRICS,  /* /metrics */
	REQUEST_HEALTH,   /* /health */
	REQUEST_VISITS,   /* /visits.csv */
};

struct request {
	enum request_page page;
	bool head; /* a HEAD request: the answer has no body */
};

/* Parses what was received so far. Returns 0 if the head is not complete yet; otherwise an HTTP
 * status: 200 with *out filled in, or what is wrong: 400 not HTTP, 404 no such page, 405 neither
 * GET nor HEAD, 431 longer than REQUEST_BYTES_MAX, 505 neither HTTP/1.0 nor 1.1. */
must_check int request_parse(struct request *out, struct bytes received);

#endif
