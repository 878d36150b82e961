/* What the headers and the path of a curator's request may say. The first byte chooses which. */
#include <stdlib.h>
#include <string.h>

#include "curator/api/route.h"
#include "curator/server/request_head.h"

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size);

static void check_path(const char *text)
{
	static const char *const patterns[] = { "/api/pages/{id}.{language}", "/api/parts/{id}",
						"/api/{a}/{b}.{c}/{d}" };
	struct api_request request = { 0 };

	if (strlen(text) >= sizeof(request.path))
		return;
	memcpy(request.path, text, strlen(text) + 1);
	for (unsigned n = 0; n < ARRAY_COUNT(patterns); n++)
		if (route_fits(patterns[n], &request))
			for (uint32_t p = 0; p < request.parameter_count; p++)
				if (!request.parameters[p].value[0] ||
				    strpbrk(request.parameters[p].value, "./\\ %"))
					abort();
}

static void check_cookie(const char *text)
{
	char value[API_SECRET_BYTES];

	if (!request_head_cookie(text, "gopura-curator-8780", value, sizeof(value)) && *value)
		abort();
	if (strchr(value, ';'))
		abort();
}

static void check_address(const char *text)
{
	char address[API_ADDRESS_BYTES], again[API_ADDRESS_BYTES];

	request_head_forwarded(text, address);
	request_head_address(address, again);
	if (strcmp(address, again) != 0)
		abort();
}

static void check_others(const char *text)
{
	struct origin_names names = { 0 };
	struct api_request request = { 0 };
	uint64_t length;

	if (request_head_length(text, &length) && length > 999999999999)
		abort();
	request_head_takes_gzip(text);
	api_tag_matches(text, "0123456789abcdef");
	if (origin_add(&names, "museum.example", 0, true) &&
	    origin_is_welcome(&names, "museum.example", text) && *text &&
	    !strcasestr(text, "://museum.example"))
		abort();
	if (strlen(text) < sizeof(request.query) - 1) {
		memcpy(request.query, text, strlen(text) + 1);
		request.query_bytes = strlen(text) + 1;
		api_query(&request, "token");
	}
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
	static void (*const checks[])(const char *text) = { check_path, check_cookie, check_address,
							    check_others };
	char *text;

	if (size == 0)
		return 0;
	text = strndup((const char *)data + 1, size - 1);
	if (text)
		checks[data[0] % ARRAY_COUNT(checks)](text);
	free(text);
	return 0;
}
