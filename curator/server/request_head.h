/* What the headers of a request say, copied from libwebsockets. */
#ifndef GOPURA_CURATOR_SERVER_REQUEST_HEAD_H
#define GOPURA_CURATOR_SERVER_REQUEST_HEAD_H

#include "curator/api/http_api.h"
#include "curator/server/origin.h"

struct lws;

struct request_head {
	char host[ORIGIN_NAME_BYTES], origin[ORIGIN_NAME_BYTES + 8];
	bool takes_gzip;
	uint64_t body_bytes; /* as announced; 0: there is none */
};

/* Fills in the request's method, path, query and headers. Returns 0 or the status to answer with;
 * its body, if it has one, is then of unknown length. */
must_check int request_head_read(struct request_head *head, struct api_request *request,
				 struct lws *wsi, const char *path);

/* Parses a Content-Length. Returns false if it is not a number of at most 12 digits. */
bool request_head_length(const char *text, uint64_t *out);
/* Returns whether an Accept-Encoding names gzip, and not with q=0. */
bool request_head_takes_gzip(const char *text);

#endif
