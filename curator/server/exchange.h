/* A request over HTTP and its response, on a connection of libwebsockets: reads the headers and the
 * body, finds the file or the route, runs the handler, and writes the answer in pieces. All on the
 * server's thread, except slow handlers. */
#ifndef GOPURA_CURATOR_SERVER_EXCHANGE_H
#define GOPURA_CURATOR_SERVER_EXCHANGE_H

#include "curator/api/worker.h"
#include "curator/server/access.h"

struct exchange;
struct lws;

/* What all exchanges need; borrowed. */
struct exchange_env {
	const struct access *access;
	const struct api_routes *tables;
	uint32_t table_count;
	struct workers *workers;
	uint64_t upload_bytes;  /* bodies that are announced and not yet answered */
	struct exchange *first; /* those under way */
};

/* Zeroed between two exchanges of a connection. */
struct exchange {
	struct exchange_env *env;
	struct lws *wsi;
	struct exchange *next, **link; /* in the list of those under way */
	struct api_job *job;           /* owned */
	struct bytes body;             /* of the response; borrowed from the job or a web file */
	struct buffer output;          /* a piece of it */
	uint64_t announced_bytes, sent_bytes;
	bool has_body;    /* the request's has not arrived whole */
	bool is_at_work;  /* a worker has the job */
	bool is_answered; /* the response may be written */
	bool has_head;    /* its headers are written */
};

/* Each returns 0, or -1 if the connection must be closed. */
must_check int exchange_begin(struct exchange *exchange, struct exchange_env *env, struct lws *wsi,
			      const char *path);
must_check int exchange_take_body(struct exchange *exchange, const void *piece, size_t bytes);
must_check int exchange_end_body(struct exchange *exchange);
must_check int exchange_write(struct exchange *exchange);
/* Writes on where a worker has answered. */
void exchange_wake(const struct exchange_env *env);
/* Ends it, at any time. Zeroed is fine. */
void exchange_finish(struct exchange *exchange);

#endif
