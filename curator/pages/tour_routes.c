/* Reads, merges, saves and flies tours.json. */
#include "curator/pages/tour_routes.h"

#include <cjson/cJSON.h>
#include <errno.h>
#include <string.h>

#include "base/json_tree.h"
#include "curator/pages/content_save.h"
#include "curator/pages/save_answer.h"
#include "curator/pages/tour_flight.h"
#include "curator/store/documents_versions.h"
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

/* Tours that somebody saves. */
struct tours_save {
	struct site *site;
	const struct api_request *request;
	struct api_response *response;
	char base[DOCUMENT_TAG_BYTES]; /* from which they began; "": there was no file */
	struct buffer text, merged;
	bool is_merged;
};

static void answer_theirs(const struct tours_save *save, const cJSON *root, const char *tag)
{
	cJSON *json = tours_json(root, tag);

	cJSON_AddStringToObject(json, "message",
				"somebody else has changed the same tour meanwhile: take theirs, "
				"or save again to put yours in its place");
	save->response->status = 409;
	api_send_json(save->response, json);
}

/* Brings the text up to what is there now. Returns 0, or -ESTALE with an answer. */
static int meet_others(struct tours_save *save, const cJSON *root, const char *now)
{
	struct diagnostics diagnostics = { 0 };
	char tag[DOCUMENT_TAG_BYTES];
	bool is_clean = false;
	cJSON *both = NULL;
	int rc;

	if (strcmp(save->base, now) == 0)
		return 0;
	rc = *now ? documents_merge(save->site->documents, TOURS_FILE, save->base,
				    buffer_bytes(&save->text), &save->merged, &is_clean, tag,
				    &diagnostics)
		  : -ENOENT;
	save->is_merged =
		rc == 0 && is_clean && json_parse(&both, buffer_bytes(&save->merged)) == 0;
	cJSON_Delete(both);
	if (!save->is_merged) {
		answer_theirs(save, root, now);
		return -ESTALE;
	}
	memcpy(save->base, tag, sizeof(save->base));
	return 0;
}

static void answer_saved(const struct tours_save *save, const char *tag)
{
	const struct buffer *text = save->is_merged ? &save->merged : &save->text;
	cJSON *root, *json;

	if (json_parse(&root, buffer_bytes(text)) < 0)
		root = NULL; /* only for lack of memory; then api_send_json says so */
	json = tours_json(root, tag);
	cJSON_AddBoolToObject(json, "merged", save->is_merged);
	api_send_json(save->response, json);
	cJSON_Delete(root);
}

/* Everything else that the file holds stays. */
static void save_tours(struct tours_save *save, cJSON *tours)
{
	struct diagnostics problems = { .max = CONTENT_PROBLEMS_MAX };
	struct document_change change = { .name = TOURS_FILE, .base = save->base };
	char tag[DOCUMENT_TAG_BYTES];
	cJSON *root, *mine = NULL;
	int rc = read_tours(&root, save->site, tag, &problems);

	if (rc == 0) {
		mine = cJSON_Duplicate(root, true);
		if (!mine || !json_set(mine, "tours", tours))
			rc = -ENOMEM;
	}
	if (rc < 0 && !mine)
		cJSON_Delete(tours);
	if (rc == 0)
		rc = json_print(mine, &save->text);
	if (rc == 0 && meet_others(save, root, tag) == 0) {
		change.text = buffer_bytes(save->is_merged ? &save->merged : &save->text);
		rc = content_save(save->site, &change, 1, save->request->caller.name,
				  save->is_merged ? "tours, merged" : "tours", &problems);
		if (rc == 0)
			answer_saved(save, change.tag);
	}
	if (rc < 0)
		save_answer_fail(save->response, rc, &problems);
	cJSON_Delete(mine);
	cJSON_Delete(root);
	diagnostics_finish(&problems);
}

static void put_tours(void *user, const struct api_request *request, struct api_response *response)
{
	struct tours_save save = { .site = user, .request = request, .response = response };
	cJSON *json;

	if (save_base_read(request, response, save.base) < 0 ||
	    read_body(request, response, &json) < 0)
		return;
	buffer_init(&save.text, TOURS_BYTES_MAX);
	buffer_init(&save.merged, 4 * TOURS_BYTES_MAX);
	documents_lock(save.site->documents);
	save_tours(&save, cJSON_DetachItemFromObjectCaseSensitive(json, "tours"));
	documents_unlock(save.site->documents);
	buffer_finish(&save.merged);
	buffer_finish(&save.text);
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
