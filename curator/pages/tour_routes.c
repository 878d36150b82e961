/* Reads, saves and flies tours.json. */
#include "curator/pages/tour_routes.h"

#include <cjson/cJSON.h>
#include <errno.h>
#include <string.h>

#include "base/json_tree.h"
#include "curator/pages/content_save.h"
#include "curator/pages/save_answer.h"
#include "curator/pages/tour_flight.h"
#include "curator/store/json_document.h"
#include "curator/store/parts_file.h"

#define TOURS_FILE "tours.json"

enum { TOURS_BYTES_MAX = 1 << 20 };

static int read_tours(cJSON **out, const struct site *site, char tag[DOCUMENT_TAG_BYTES],
		      struct diagnostics *diagnostics)
{
	return json_document_read(out, site->documents, TOURS_FILE, TOURS_BYTES_MAX, tag,
				  diagnostics);
}

static cJSON *tours_json(const cJSON *root, const char *tag)
{
	cJSON *json = cJSON_CreateObject();
	const cJSON *tours = cJSON_GetObjectItemCaseSensitive(root, "tours");

	json_add(json, "tours",
		 cJSON_IsArray(tours) ? cJSON_Duplicate(tours, true) : cJSON_CreateArray());
	cJSON_AddStringToObject(json, "tag", tag);
	return json;
}

static void get_tours(void *user, const struct api_request *request, struct api_response *response)
{
	struct diagnostics diagnostics = { 0 };
	char tag[DOCUMENT_TAG_BYTES];
	cJSON *root;
	int rc = read_tours(&root, user, tag, &diagnostics);

	(void)request;
	if (rc < 0)
		api_fail_with(response, rc, &diagnostics);
	else
		api_send_json(response, tours_json(root, tag));
	cJSON_Delete(root);
}

/* Reads the body's "tours". On failure *json is NULL and the response says why. */
static int read_body(const struct api_request *request, struct api_response *response, cJSON **json)
{
	int rc = api_read_json(request, response, json);

	if (rc == 0 && !cJSON_IsArray(cJSON_GetObjectItemCaseSensitive(*json, "tours"))) {
		api_fail(response, 400, "\"tours\" must be a list");
		cJSON_Delete(*json);
		*json = NULL;
		rc = -EINVAL;
	}
	return rc;
}

/* ---- saving */

/* The page merges them: it has what its tours began from, and asks where both changed the same. */
static void answer_theirs(struct api_response *response, const cJSON *root, const char *tag)
{
	cJSON *json = tours_json(root, tag);

	cJSON_AddStringToObject(json, "message",
				"somebody else has saved tours meanwhile: these are the newest");
	response->status = 409;
	api_send_json(response, json);
}

static void answer_saved(struct api_response *response, const char *tag)
{
	cJSON *json = cJSON_CreateObject();

	cJSON_AddStringToObject(json, "tag", tag);
	api_send_json(response, json);
}

/* Everything else that the file holds stays. root is changed; tours is taken. */
static int save_tours(struct site *site, cJSON *root, cJSON *tours, struct document_change *change,
		      const char *author, struct diagnostics *problems)
{
	struct buffer text;
	int rc;

	buffer_init(&text, TOURS_BYTES_MAX);
	rc = json_set(root, "tours", tours) ? json_print(root, &text) : -ENOMEM;
	if (rc == 0) {
		change->text = buffer_bytes(&text);
		rc = content_save(site, change, 1, author, "tours", problems);
	}
	buffer_finish(&text);
	return rc;
}

static void put_tours(void *user, const struct api_request *request, struct api_response *response)
{
	struct diagnostics problems = { .max = CONTENT_PROBLEMS_MAX };
	char base[DOCUMENT_TAG_BYTES], now[DOCUMENT_TAG_BYTES];
	struct document_change change = { .name = TOURS_FILE, .base = base };
	struct site *site = user;
	cJSON *json, *root;
	int rc;

	if (save_base_read(request, response, base) < 0 || read_body(request, response, &json) < 0)
		return;
	documents_lock(site->documents);
	rc = read_tours(&root, site, now, &problems);
	if (rc == 0 && strcmp(base, now) != 0) {
		answer_theirs(response, root, now);
	} else {
		if (rc == 0)
			rc = save_tours(site, root,
					cJSON_DetachItemFromObjectCaseSensitive(json, "tours"),
					&change, request->caller.name, &problems);
		if (rc < 0)
			save_answer_fail(response, rc, &problems);
		else
			answer_saved(response, change.tag);
	}
	documents_unlock(site->documents);
	diagnostics_finish(&problems);
	cJSON_Delete(root);
	cJSON_Delete(json);
}

/* ---- flying */

static void post_flight(void *user, const struct api_request *request,
			struct api_response *response)
{
	struct diagnostics diagnostics = { 0 };
	cJSON *json, *flight = NULL;
	struct buffer text;
	int rc;

	if (read_body(request, response, &json) < 0)
		return;
	buffer_init(&text, TOURS_BYTES_MAX);
	rc = json_print(json, &text);
	if (rc == 0)
		rc = tour_flight(&flight, user, api_parameter(request, "id"), buffer_bytes(&text),
				 &diagnostics);
	if (rc < 0)
		api_fail_with(response, rc, &diagnostics);
	else
		api_send_json(response, flight);
	buffer_finish(&text);
	cJSON_Delete(json);
}

struct api_routes tour_routes(struct site *site)
{
	static const struct api_route routes[] = {
		{ API_GET, "/api/tours", ROLE_READER, 0, true, get_tours },
		{ API_PUT, "/api/tours", ROLE_EDITOR, TOURS_BYTES_MAX, true, put_tours },
		{ API_POST, "/api/tours/{id}/flight", ROLE_READER, TOURS_BYTES_MAX, true,
		  post_flight },
	};

	return (struct api_routes){ routes, ARRAY_COUNT(routes), site };
}
