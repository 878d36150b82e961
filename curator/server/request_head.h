/* What the headers of a request say, copied from libwebsockets. */
#ifndef GOPURA_CURATOR_SERVER_REQUEST_HEAD_H
#define GOPURA_CURATOR_SERVER_REQUEST_HEAD_H

#include "curator/api/http_api.h"
#include "curator/server/origin.h"

struct lws;

struct request_head {
	char host[ORIGIN_NAME_BYTES], origin[ORIGIN_NAME_BYTES + 8];
	bool takes_gzip;
	uint64_t body_bytes;          /* as announced; 0: there is none */
	char token[API_SECRET_BYTES]; /* what the page sent with it; "": nothing */
};

/* Which headers mean something here. */
struct request_head_options {
	char cookie[32];  /* the name of the cookie */
	char sign_on[64]; /* the header that names who has signed on, with its colon; "": none */
	bool is_proxied;  /* believe what a proxy on this machine says of address and https */
};

/* Fills in the request's method, path, query and headers, except caller and token. Returns 0 or the
 * status to answer with; its body, if it has one, is then of unknown length. */
must_check int request_head_read(struct request_head *head, struct api_request *request,
				 struct lws *wsi, const char *path,
				 const struct request_head_options *options);

/* Finds a cookie in a header. Returns false, and out is "", if it is not there or does not fit. */
bool request_head_cookie(const char *header, const char *name, char *out, size_t out_bytes);
/* Copies an address so that it names who has it: an IPv6 address without its lower half. "" if it
 * is none. */
void request_head_address(const char *text, char out[API_ADDRESS_BYTES]);
/* Takes the last address of X-Forwarded-For: that is the one that our own proxy saw. */
void request_head_forwarded(const char *header, char out[API_ADDRESS_BYTES]);

/* Parses a Content-Length. Returns false if it is not a number of at most 12 digits. */
bool request_head_length(const char *text, uint64_t *out);
/* Returns whether an Accept-Encoding names gzip, and not with q=0. */
bool request_head_takes_gzip(const char *text);

#endif
