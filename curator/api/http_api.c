/* What handlers need to read a request and to fill in a response. */
#include "curator/api/http_api.h"

#include <cjson/cJSON.h>
#include <errno.h>
#include <stdarg.h>
#include <stdio.h>
#include <string.h>

#include "base/json_tree.h"

/* ---- the request */

const char *api_parameter(const struct api_request *request, const char *name)
{
	for (uint32_t n = 0; n < request->parameter_count; n++) {
		const struct api_parameter *parameter = &request->parameters[n];

		if (strlen(name) == parameter->name_bytes &&
		    memcmp(name, parameter->name, parameter->name_bytes) == 0)
			return parameter->value;
	}
	return "";
}

const char *api_query(const struct api_request *request, const char *name)
{
	const size_t name_bytes = strlen(name);
	const char *end = request->query + request->query_bytes;

	for (const char *at = request->query; at < end; at += strlen(at) + 1)
		if (strncmp(at, name, name_bytes) == 0 && at[name_bytes] == '=')
			return at + name_bytes + 1;
	return NULL;
}

int api_read_json(const struct api_request *request, struct api_response *response,
		  struct cJSON **out)
{
	const int rc = json_parse(out, buffer_bytes(&request->body));

	if (cJSON_IsObject(*out))
		return 0;
	if (rc == -ENOMEM) {
		api_fail(response, 500, "no memory is left");
		return rc;
	}
	cJSON_Delete(*out);
	*out = NULL;
	api_fail(response, 400, "the body must be an object of JSON");
	return -EINVAL;
}

bool api_tag_matches(const char *header, const char *tag)
{
	const size_t tag_bytes = strlen(tag);
	const char *at = header;

	while (*at) {
		const char *end;

		at += strspn(at, " \t,");
		if (*at == '*')
			return true;
		if (strncmp(at, "W/", 2) == 0)
			at += 2;
		if (*at != '"')
			return false; /* also the end */
		end = strchr(at + 1, '"');
		if (!end)
			return false;
		if ((size_t)(end - at - 1) == tag_bytes && memcmp(at + 1, tag, tag_bytes) == 0)
			return true;
		at = end + 1;
	}
	return false;
}

/* ---- the response */

static void send_json(struct api_response *response, const cJSON *json)
{
	char *text = json_line(json);

	buffer_clear(&response->body);
	response->type = "application/json";
	if (text)
		buffer_put_text(&response->body, text);
	if (!text || response->body.error) {
		buffer_clear(&response->body);
		response->status = 500;
		buffer_put_text(&response->body, "{\"message\":\"no memory is left\"}");
	}
	cJSON_free(text);
}

void api_send_json(struct api_response *response, struct cJSON *json)
{
	send_json(response, json);
	cJSON_Delete(json);
}

void api_send_bytes(struct api_response *response, const char *type, struct bytes bytes)
{
	buffer_clear(&response->body);
	response->type = type;
	buffer_put(&response->body, bytes.data, bytes.size);
	if (response->body.error)
		api_fail(response, 500, "no memory is left");
}

static void fail(struct api_response *response, int status, const char *sentence)
{
	cJSON *json = cJSON_CreateObject();

	response->status = status;
	response->header_count = 0;
	cJSON_AddStringToObject(json, "message", sentence);
	api_send_json(response, json);
}

void api_fail(struct api_response *response, int status, const char *sentence, ...)
{
	char text[DIAGNOSTIC_BYTES];
	va_list arguments;

	va_start(arguments, sentence);
	vsnprintf(text, sizeof(text), sentence, arguments);
	va_end(arguments);
	fail(response, status, text);
}

static int status_of(int rc)
{
	switch (rc) {
	case -ENOENT:
		return 404;
	case -EINVAL:
	case -EBADMSG:
		return 422;
	case -EEXIST:
	case -EBUSY:
		return 409;
	case -ESTALE:
		return 412;
	case -EACCES:
		return 403;
	case -EFBIG:
		return 413;
	case -ENOSPC:
		return 507;
	default:
		return 500;
	}
}

void api_fail_with(struct api_response *response, int rc, const struct diagnostics *diagnostics)
{
	fail(response, status_of(rc), diagnostics_cause(diagnostics, rc));
}

void api_add_header(struct api_response *response, const char *name, const char *value, ...)
{
	struct api_header *header = &response->headers[response->header_count];
	va_list arguments;
	int bytes;
	bool good = response->header_count < API_HEADERS_MAX;

	if (good) {
		va_start(arguments, value);
		bytes = vsnprintf(header->value, sizeof(header->value), value, arguments);
		va_end(arguments);
		good = bytes >= 0 && bytes < (int)sizeof(header->value);
	}
	for (const char *at = header->value; good && *at; at++)
		good = (unsigned char)*at >= ' ' && *at != 0x7f;
	if (!good) {
		fail(response, 500, "the answer's headers cannot be written");
		return;
	}
	header->name = name;
	response->header_count++;
}

bool api_send_tag(const struct api_request *request, struct api_response *response, const char *tag)
{
	api_add_header(response, "etag:", "\"%s\"", tag);
	if (!api_tag_matches(request->if_none_match, tag))
		return false;
	response->status = 304;
	response->type = NULL;
	buffer_clear(&response->body);
	return true;
}
