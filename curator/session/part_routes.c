/* Answers with parts.json as the page needs it. */
#include "curator/session/part_routes.h"

#include "curator/session/part_store.h"
#include "format/hash.h"

static void get_parts(void *user, const struct api_request *request, struct api_response *response)
{
	struct diagnostics diagnostics = { 0 };
	char tag[HASH_HEX_BYTES];
	struct buffer parts;
	int rc;

	buffer_init(&parts, API_RESPONSE_BYTES_MAX);
	rc = part_store_list(user, &parts, &diagnostics);
	if (rc == 0)
		rc = parts.error;
	hash_to_hex(hash_of(buffer_bytes(&parts)), tag);
	if (rc < 0)
		api_fail_with(response, rc, &diagnostics);
	else if (!api_send_tag(request, response, tag))
		api_send_bytes(response, "application/json", buffer_bytes(&parts));
	buffer_finish(&parts);
}

struct api_routes part_routes(struct site *site)
{
	static const struct api_route routes[] = {
		{ API_GET, "/api/parts", ROLE_READER, 0, true, get_parts },
	};

	return (struct api_routes){ routes, ARRAY_COUNT(routes), site };
}
