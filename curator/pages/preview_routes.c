/* Answers with a picture of what a visitor will see. */
#include "curator/pages/preview_routes.h"

#include <cjson/cJSON.h>
#include <errno.h>
#include <string.h>

enum { REQUEST_BYTES_MAX = 1 << 20, PICTURE_BYTES_MAX = 8 << 20 };

static const char *member(const cJSON *json, const char *key)
{
	const char *text = cJSON_GetStringValue(cJSON_GetObjectItemCaseSensitive(json, key));

	return text ? text : "";
}

/* Returns false if there is no such kind. */
static bool read_kind(enum preview_kind *out, const char *name)
{
	static const char *const names[] = { "near", "card", "page" };

	for (unsigned n = 0; n < ARRAY_COUNT(names); n++)
		if (strcmp(name, names[n]) == 0) {
			*out = (enum preview_kind)n;
			return true;
		}
	return false;
}

static void post_preview(void *user, const struct api_request *request,
			 struct api_response *response)
{
	struct diagnostics diagnostics = { 0 };
	struct preview_wish wish;
	struct buffer picture;
	cJSON *json;
	int rc;

	if (api_read_json(request, response, &json) < 0)
		return;
	wish.part = member(json, "part");
	wish.language = member(json, "language");
	wish.html = cJSON_GetStringValue(cJSON_GetObjectItemCaseSensitive(json, "html"));
	buffer_init(&picture, PICTURE_BYTES_MAX);
	if (!read_kind(&wish.kind, member(json, "kind"))) {
		api_fail(response, 400, "\"kind\" must be near, card or page");
	} else {
		rc = preview_draw(user, &wish, &picture, &diagnostics);
		if (rc < 0)
			api_fail_with(response, rc, &diagnostics);
		else
			api_send_bytes(response, "image/jpeg", buffer_bytes(&picture));
	}
	buffer_finish(&picture);
	cJSON_Delete(json);
}

struct api_routes preview_routes(struct preview *preview)
{
	static const struct api_route routes[] = {
		{ API_POST, "/api/preview", ROLE_READER, REQUEST_BYTES_MAX, true, post_preview },
	};

	return (struct api_routes){ routes, ARRAY_COUNT(routes), preview };
}
