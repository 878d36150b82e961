/* Reads a request's headers. */
#include "curator/server/request_head.h"

#include <libwebsockets.h>
#include <stdlib.h>
#include <string.h>

enum { ACCEPT_BYTES = 256 };

/* Returns false if it is too long for out. Missing is "". */
static bool copy(struct lws *wsi, enum lws_token_indexes token, char *out, size_t out_bytes)
{
	out[0] = '\0';
	return lws_hdr_total_length(wsi, token) <= 0 ||
	       lws_hdr_copy(wsi, out, (int)out_bytes, token) >= 0;
}

bool request_head_length(const char *text, uint64_t *out)
{
	const size_t digits = strspn(text, "0123456789");

	if (digits == 0 || digits > 12 || text[digits])
		return false;
	*out = strtoull(text, NULL, 10);
	return true;
}

bool request_head_takes_gzip(const char *text)
{
	const char *at = strstr(text, "gzip"), *weight;

	if (!at)
		return false;
	at += strlen("gzip");
	at += strspn(at, " ");
	if (*at != ';')
		return true;
	weight = at + 1 + strspn(at + 1, " ");
	return strncmp(weight, "q=0", 3) != 0 ||
	       strcspn(weight + 3, "123456789") < strcspn(weight + 3, ",");
}

static bool read_method(struct lws *wsi, enum api_method *out)
{
	static const struct {
		enum lws_token_indexes token;
		enum api_method method;
	} methods[] = {
		{ WSI_TOKEN_GET_URI, API_GET },
		{ WSI_TOKEN_PUT_URI, API_PUT },
		{ WSI_TOKEN_POST_URI, API_POST },
		{ WSI_TOKEN_DELETE_URI, API_DELETE },
	};

	for (unsigned n = 0; n < ARRAY_COUNT(methods); n++)
		if (lws_hdr_total_length(wsi, methods[n].token) > 0) {
			*out = methods[n].method;
			return true;
		}
	return false;
}

/* libwebsockets has decoded the values. One with a zero byte in it ends there. */
static bool read_query(struct lws *wsi, struct api_request *request)
{
	int bytes = 0;

	for (int n = 0; lws_hdr_fragment_length(wsi, WSI_TOKEN_HTTP_URI_ARGS, n) > 0; n++) {
		bytes = lws_hdr_copy_fragment(wsi, request->query + request->query_bytes,
					      (int)(sizeof(request->query) - request->query_bytes),
					      WSI_TOKEN_HTTP_URI_ARGS, n);
		if (bytes < 0)
			return false;
		request->query_bytes += strlen(request->query + request->query_bytes) + 1;
	}
	return true;
}

static int read_length(struct request_head *head, struct lws *wsi, enum api_method method)
{
	char text[32];

	if (lws_hdr_total_length(wsi, WSI_TOKEN_HTTP_TRANSFER_ENCODING) > 0)
		return 411;
	if (!copy(wsi, WSI_TOKEN_HTTP_CONTENT_LENGTH, text, sizeof(text)))
		return 400;
	if (!*text)
		return method == API_PUT || method == API_POST ? 411 : 0;
	return request_head_length(text, &head->body_bytes) ? 0 : 400;
}

int request_head_read(struct request_head *head, struct api_request *request, struct lws *wsi,
		      const char *path)
{
	char accept[ACCEPT_BYTES];

	*head = (struct request_head){ 0 };
	if (!read_method(wsi, &request->method))
		return 405;
	if (strlen(path) >= sizeof(request->path) || !read_query(wsi, request))
		return 414;
	memcpy(request->path, path, strlen(path) + 1);
	if (!copy(wsi, WSI_TOKEN_HOST, head->host, sizeof(head->host)) ||
	    !copy(wsi, WSI_TOKEN_ORIGIN, head->origin, sizeof(head->origin)) ||
	    !copy(wsi, WSI_TOKEN_HTTP_IF_MATCH, request->if_match, sizeof(request->if_match)) ||
	    !copy(wsi, WSI_TOKEN_HTTP_IF_NONE_MATCH, request->if_none_match,
		  sizeof(request->if_none_match)) ||
	    !copy(wsi, WSI_TOKEN_HTTP_CONTENT_TYPE, request->content_type,
		  sizeof(request->content_type)))
		return 431;
	head->takes_gzip = copy(wsi, WSI_TOKEN_HTTP_ACCEPT_ENCODING, accept, sizeof(accept)) &&
			   request_head_takes_gzip(accept);
	return read_length(head, wsi, request->method);
}
