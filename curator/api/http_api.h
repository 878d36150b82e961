/* The HTTP interface of gopura-curator, as a handler sees it. A route (curator/api/route.h) names a
 * method, a path, the least role and a handler; the server has checked host, origin, role, token
 * and size before it calls the handler, which reads the request and fills in the response. A
 * handler that may wait for the disk or computes for long runs on a worker thread, so several may
 * run at once. No sockets here. */
#ifndef GOPURA_CURATOR_API_HTTP_API_H
#define GOPURA_CURATOR_API_HTTP_API_H

#include <stdbool.h>

#include "base/bytes.h"
#include "base/diagnostics.h"
#include "curator/accounts/role.h"

struct cJSON;

enum {
	API_PATH_BYTES = 256,   /* with its end, as all below */
	API_QUERY_BYTES = 1024, /* all of it */
	API_VALUE_BYTES = 65,   /* a parameter of the path */
	API_PARAMETERS_MAX = 4,
	API_TAGS_BYTES = 512, /* If-Match, If-None-Match */
	API_TYPE_BYTES = 128,
	API_ADDRESS_BYTES = 46,
	API_SECRET_BYTES = 65,
	API_HEADERS_MAX = 6,
	API_HEADER_BYTES = 256,
	API_JSON_BYTES_MAX = 64 << 10,   /* of a request's body, for routes of JSON */
	API_UPLOAD_BYTES_MAX = 32 << 20, /* the most that a route may allow */
	API_RESPONSE_BYTES_MAX = 64 << 20,
};

enum api_method { API_GET, API_PUT, API_POST, API_DELETE, API_METHOD_COUNT };

struct api_parameter {
	const char *name; /* static: from the route's pattern, not terminated */
	size_t name_bytes;
	char value[API_VALUE_BYTES]; /* A-Z a-z 0-9 - _ */
};

struct api_request {
	enum api_method method;
	struct caller caller;
	char path[API_PATH_BYTES];
	struct api_parameter parameters[API_PARAMETERS_MAX];
	uint32_t parameter_count;
	char query[API_QUERY_BYTES]; /* "name=value" and so on, decoded, each with its end */
	size_t query_bytes;
	char if_match[API_TAGS_BYTES], if_none_match[API_TAGS_BYTES]; /* "": there is none */
	char content_type[API_TYPE_BYTES];
	/* For signing in and out. */
	char address[API_ADDRESS_BYTES];  /* of the browser, or of its network; "": not known */
	bool is_secure;                   /* it came by https, as a proxy says */
	char cookie[API_SECRET_BYTES];    /* "": there is none */
	char token[API_SECRET_BYTES];     /* what the page must send to change something */
	char sign_on[ACCOUNT_NAME_BYTES]; /* whom a museum's own sign-on has named; "": nobody */
	struct buffer body;               /* whole; within the route's limit */
};

struct api_header {
	const char *name; /* static, in lower case with its colon, as "location:" */
	char value[API_HEADER_BYTES];
};

/* Zeroed except for the body, which is empty with a ceiling, when a handler gets it. */
struct api_response {
	int status;       /* 0: 200 */
	const char *type; /* static; NULL: there is no body */
	struct api_header headers[API_HEADERS_MAX];
	uint32_t header_count;
	struct buffer body;
};

/* ---- the request */

/* Returns what stands in the path where the route's pattern says {name}; borrowed. */
const char *api_parameter(const struct api_request *request, const char *name);
/* Returns a value of the query, borrowed, or NULL. It is foreign text. */
const char *api_query(const struct api_request *request, const char *name);
/* Parses the body as an object of JSON. *out is owned by the caller (cJSON_Delete). On failure *out
 * is NULL, the response says what is wrong, and -EINVAL or -ENOMEM is returned. */
must_check int api_read_json(const struct api_request *request, struct api_response *response,
			     struct cJSON **out);
/* Returns whether a header If-Match or If-None-Match names the tag, or is "*". Weak tags count. */
bool api_tag_matches(const char *header, const char *tag);

/* ---- the response */

/* Answers with an error: {"message": SENTENCE}. What was answered before is dropped. */
void api_fail(struct api_response *response, int status, const char *sentence, ...)
	printf_like(3, 4);
/* The same for a negative errno and its diagnostic: -ENOENT is 404, -EINVAL and -EBADMSG 422,
 * -EEXIST and -EBUSY 409, -ESTALE 412, -EACCES 403, -EFBIG 413, -ENOSPC 507, others 500. */
void api_fail_with(struct api_response *response, int rc, const struct diagnostics *diagnostics);
/* Answers with JSON, which is taken; NULL: 500. Status and headers stay. */
void api_send_json(struct api_response *response, struct cJSON *json);
/* Answers with bytes, which are copied. type is static. */
void api_send_bytes(struct api_response *response, const char *type, struct bytes bytes);
/* Adds a header; name is static and as in struct api_header. A value that does not fit, or has a
 * control character, makes the answer an error 500. */
void api_add_header(struct api_response *response, const char *name, const char *value, ...)
	printf_like(3, 4);
/* Adds ETag: "TAG". Returns true if the request has that already (If-None-Match): the answer is
 * then 304 without a body, and the handler is done. */
bool api_send_tag(const struct api_request *request, struct api_response *response,
		  const char *tag);

#endif
