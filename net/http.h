/* Requests to the museum server, using libcurl's multi interface behind one descriptor. The server
 * is https:// (HTTP/2 if it supports it), http://, or a local folder; all three are used in the
 * same way. One thread; no call blocks, except on the disk of a local folder. */
#ifndef GOPURA_NET_HTTP_H
#define GOPURA_NET_HTTP_H

#include "base/bytes.h"

struct http;         /* private to http.c */
struct http_request; /* one request in flight */

struct http_options {
	const char *url;     /* copied; https://..., http://..., file://... or a folder's path */
	const char *ca_file; /* copied; NULL: the system's certificates */
	uint32_t stall_s;    /* seconds without data before a request fails; 0: 15 */
	/* Time limit of a slow request in seconds: this value, plus one second for each KiB it may
	 * deliver, with at most 900 seconds added. 0: 60. */
	uint32_t patience_s;
	/* Hosts besides the server itself that it may redirect to (net/redirect.h). Copied; NULL:
	 * none. A redirection to any other host makes the request fail. */
	const char *redirect_hosts;
};

struct http_result {
	/* 0: the server answered and the body was delivered, or the receiver needed no more.
	 * -ENOENT: the server answered, but does not have this file or this range.
	 * -EBADMSG: the answer is not what was asked for: another range, or larger than the
	 * ceiling. A file whose Content-Length is beyond the ceiling is refused before its body.
	 * -EHOSTUNREACH: no answer, a broken or stalled one, or a server error (5xx). */
	int rc;
	bool not_modified; /* answer to a conditional request; there was no body */
	const char *etag;  /* borrowed for the call; "" if none */
	const char *why;   /* borrowed for the call; a reason for people to read */
};

struct http_get {
	const char *path;     /* below the server's url, for example "packs/HEX"; copied */
	uint64_t first, size; /* bytes; size 0: the whole file */
	uint64_t ceiling;     /* maximum size of a whole file in bytes */
	/* copied; ask for the file only if its ETag differs; NULL or "": always */
	const char *etag;
	/* Called for each piece of the body, in order. Returns false when no more is needed; the
	 * request then ends successfully. It must not call into this module. */
	bool (*receive)(void *data, struct bytes piece);
	/* Called once at the end, but not for a cancelled request. May start new requests. */
	void (*done)(void *data, const struct http_result *result);
	void *data;
};

/* *out is owned by the caller; it is NULL on failure. -EINVAL: the url is of an unknown kind, or
 * redirect_hosts is not a valid list. -ENOMEM, or another negative errno from epoll or the
 * timer. */
must_check int http_create(struct http **out, const struct http_options *options);
/* All requests must have ended or been cancelled. NULL is fine. */
void http_destroy(struct http *http);

/* An epoll descriptor, borrowed. It is readable when http_dispatch has work to do. http_dispatch
 * calls receive and done of the requests, and returns a negative errno only if waiting fails. */
int http_fd(const struct http *http);
/* Handles pending events without waiting; see http_fd. */
must_check int http_dispatch(struct http *http);

/* Starts a GET request; *get is copied. *out is borrowed until done has been called. -ENOMEM. */
must_check int http_get(struct http *http, const struct http_get *get, struct http_request **out);
/* Frees the request without calling done. Not allowed from receive. NULL is fine. */
void http_cancel(struct http_request *request);

/* Returns the number of bytes received. TCP connections count all bytes the kernel received,
 * including TLS and headers; a local folder counts the bytes read. */
uint64_t http_received_bytes(const struct http *http);
/* Returns the server's url for log messages. Borrowed. */
const char *http_url(const struct http *http);

#endif
