/* Reads a request's headers. */
#include "curator/server/request_head.h"

#include <arpa/inet.h>
#include <libwebsockets.h>
#include <stdlib.h>
#include <string.h>
#include <sys/socket.h>

#include "curator/accounts/accounts.h"

enum { ACCEPT_BYTES = 256, COOKIES_BYTES = 4096, FORWARDED_BYTES = 1024 };

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

bool request_head_cookie(const char *header, const char *name, char *out, size_t out_bytes)
{
	const size_t name_bytes = strlen(name);

	out[0] = '\0';
	while (*header) {
		size_t bytes;

		header += strspn(header, " \t;");
		bytes = strcspn(header, ";");
		if (bytes > name_bytes && strncmp(header, name, name_bytes) == 0 &&
		    header[name_bytes] == '=') {
			bytes -= name_bytes + 1;
			if (bytes >= out_bytes)
				return false;
			memcpy(out, header + name_bytes + 1, bytes);
			out[bytes] = '\0';
			return true;
		}
		header += bytes;
	}
	return false;
}

void request_head_address(const char *text, char out[API_ADDRESS_BYTES])
{
	struct in6_addr wide;
	struct in_addr narrow;

	out[0] = '\0';
	if (inet_pton(AF_INET, text, &narrow) == 1) {
		inet_ntop(AF_INET, &narrow, out, API_ADDRESS_BYTES);
	} else if (inet_pton(AF_INET6, text, &wide) == 1 && IN6_IS_ADDR_V4MAPPED(&wide)) {
		inet_ntop(AF_INET, wide.s6_addr + 12, out, API_ADDRESS_BYTES);
	} else if (inet_pton(AF_INET6, text, &wide) == 1) {
		memset(wide.s6_addr + 8, 0, 8);
		inet_ntop(AF_INET6, &wide, out, API_ADDRESS_BYTES);
	}
}

void request_head_forwarded(const char *header, char out[API_ADDRESS_BYTES])
{
	const char *last = strrchr(header, ',');
	char text[API_ADDRESS_BYTES];
	size_t bytes;

	last = last ? last + 1 : header;
	last += strspn(last, " \t");
	bytes = strcspn(last, " \t");
	out[0] = '\0';
	if (bytes >= sizeof(text))
		return;
	memcpy(text, last, bytes);
	text[bytes] = '\0';
	request_head_address(text, out);
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

/* ---- who asks */

/* "": there is none, or it is too long for out. */
static void copy_custom(struct lws *wsi, const char *name, char *out, size_t out_bytes)
{
	if (lws_hdr_custom_copy(wsi, out, (int)out_bytes, name, (int)strlen(name)) < 0)
		out[0] = '\0';
}

/* Fills in the address of the other end. Returns whether that is on this machine. */
static bool read_peer(struct lws *wsi, char out[API_ADDRESS_BYTES])
{
	struct sockaddr_storage peer = { 0 };
	socklen_t bytes = sizeof(peer);
	char text[INET6_ADDRSTRLEN] = "";

	out[0] = '\0';
	if (getpeername(lws_get_socket_fd(wsi), (struct sockaddr *)&peer, &bytes) < 0)
		return false;
	if (peer.ss_family == AF_UNIX)
		return true;
	if (peer.ss_family == AF_INET)
		inet_ntop(AF_INET, &((struct sockaddr_in *)&peer)->sin_addr, text, sizeof(text));
	else if (peer.ss_family == AF_INET6)
		inet_ntop(AF_INET6, &((struct sockaddr_in6 *)&peer)->sin6_addr, text, sizeof(text));
	request_head_address(text, out);
	return strncmp(out, "127.", 4) == 0 || strcmp(text, "::1") == 0;
}

static void read_caller(struct request_head *head, struct api_request *request, struct lws *wsi,
			const struct request_head_options *options)
{
	char text[COOKIES_BYTES];
	const bool is_local = read_peer(wsi, request->address);

	if (copy(wsi, WSI_TOKEN_HTTP_COOKIE, text, sizeof(text)))
		request_head_cookie(text, options->cookie, request->cookie,
				    sizeof(request->cookie));
	copy_custom(wsi, "x-gopura-token:", head->token, sizeof(head->token));
	if (!is_local)
		return;
	if (options->sign_on[0]) {
		copy_custom(wsi, options->sign_on, request->sign_on, sizeof(request->sign_on));
		if (!account_name_is_valid(request->sign_on))
			request->sign_on[0] = '\0';
	}
	if (!options->is_proxied)
		return;
	if (copy(wsi, WSI_TOKEN_X_FORWARDED_FOR, text, FORWARDED_BYTES) && text[0])
		request_head_forwarded(text, request->address);
	copy_custom(wsi, "x-forwarded-proto:", text, sizeof(text));
	request->is_secure = strcmp(text, "https") == 0;
}

int request_head_read(struct request_head *head, struct api_request *request, struct lws *wsi,
		      const char *path, const struct request_head_options *options)
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
	read_caller(head, request, wsi, options);
	return read_length(head, wsi, request->method);
}
