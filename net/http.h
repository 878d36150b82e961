/* Requests to the museum server: libcurl's multi interface behind one descriptor. The server is
 * https:// (HTTP/2 when it can), http://, or a local folder; all three answer the same calls.
 * One thread, nothing blocks (a local folder's disk apart). */
#ifndef GOPURA_NET_HTTP_H
#define GOPURA_NET_HTTP_H

#include "base/bytes.h"

struct http;         /* private to http.c */
struct http_request; /* one in flight */

struct http_options {
	const char *url;     /* copied; https://..., http://..., file://... or a folder's path */
	const char *ca_file; /* copied; NULL: the system's */
	uint32_t stall_s;    /* a request that brings nothing for so long has failed; 0: 15 */
	/* Before a request that trickles has failed: so long, and a second for each KiB it may
	 * bring, a quarter of an hour beside at most. 0: 60. */
	uint32_t patience_s;
	/* Hosts that the server may redirect to beside itself (net/redirect.h); copied; NULL: none.
	 * A redirection elsewhere is no answer. */
	const char *redirect_hosts;
};

struct http_result {
	/* 0            the server answered and the body was given, or the receiver had enough
	 * -ENOENT      the server answers, but has not this file, or not these bytes of it
	 * -EBADMSG     the answer is not what was asked for: another range, past the ceiling
	 * -EHOSTUNREACH  no answer, a broken one, a stalled one, or the server is ill (5xx) */
	int rc;
	bool not_modified; /* the answer to a conditional request: there was no body */
	const char *etag;  /* borrowed for the call; "" if none */
	const char *why;   /* borrowed; for people */
};

struct http_ask {
	const char *path;     /* below the server's url, for example "packs/HEX"; copied */
	uint64_t first, size; /* bytes; size 0: the whole file */
	uint64_t ceiling;     /* bytes of a whole file, at most */
	const char *etag;     /* copied; only if it is another than this; NULL or "": in any case */
	/* Each piece of the body, in order. False: enough, the request ends well. Must not call
	 * into this module. */
	bool (*receive)(void *data, struct bytes piece);
	/* Once, at the end; not for a cancelled request. May ask anew. */
	void (*done)(void *data, const struct http_result *result);
	void *data;
};

/* -EINVAL: the url is of no kind we know, or redirect_hosts are no hosts. */
must_check int http_create(struct http **out, const struct http_options *options);
void http_destroy(struct http *http); /* requests must have ended or been cancelled */

/* Readable when http_dispatch has something to do: requests' receive and done are called there. */
int http_fd(const struct http *http);
must_check int http_dispatch(struct http *http);

/* *out is borrowed until done was called. -ENOMEM. */
must_check int http_ask(struct http *http, const struct http_ask *ask, struct http_request **out);
void http_cancel(struct http_request *request); /* not from receive */

/* What came in: of TCP connections everything the kernel received (TLS, headers and all), of a
 * local folder what was read. */
uint64_t http_received_bytes(const struct http *http);
/* For people: what was given, as a url. Borrowed. */
const char *http_url(const struct http *http);

#endif
