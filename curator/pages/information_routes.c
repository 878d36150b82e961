/* Answers with everything about the parts, and changes parts.json. */
#include "curator/pages/information_routes.h"

#include <cjson/cJSON.h>
#include <errno.h>
#include <stdio.h>
#include <string.h>

#include "base/json_tree.h"
#include "curator/pages/content_save.h"
#include "curator/pages/information_list.h"
#include "curator/pages/part_change.h"
#include "curator/pages/save_answer.h"
#include "format/hash.h"

enum { CHANGES_BYTES_MAX = 1 << 20 };

static void get_information(void *user, const struct api_request *request,
			    struct api_response *response)
{
	struct diagnostics diagnostics = { 0 };
	char tag[HASH_HEX_BYTES];
	struct buffer list;
	int rc;

	buffer_init(&list, API_RESPONSE_BYTES_MAX);
	rc = information_list(user, &list, &diagnostics);
	hash_to_hex(hash_of(buffer_bytes(&list)), tag);
	if (rc < 0)
		api_fail_with(response, rc, &diagnostics);
	else if (!api_send_tag(request, response, tag))
		api_send_bytes(response, "application/json", buffer_bytes(&list));
	buffer_finish(&list);
}

/* Saves parts.json, and removes documents with it. */
static void save(struct site *site, const struct api_request *request,
		 struct api_response *response, const struct parts_file *parts, const char *what,
		 struct document_change *changes, uint32_t count)
{
	struct diagnostics problems = { .max = CONTENT_PROBLEMS_MAX };
	struct buffer text;
	int rc;

	buffer_init(&text, PARTS_FILE_BYTES_MAX);
	rc = json_print(parts->root, &text);
	changes[0] = (struct document_change){ .name = PARTS_FILE,
					       .text = buffer_bytes(&text),
					       .base = parts->tag };
	if (rc == 0)
		rc = content_save(site, changes, count, request->caller.name, what, &problems);
	if (rc < 0)
		save_answer_fail(response, rc, &problems);
	else
		api_send_json(response, cJSON_CreateObject());
	buffer_finish(&text);
	diagnostics_finish(&problems);
}

/* ---- texts */

static const char *member(const cJSON *json, const char *key)
{
	const char *text = cJSON_GetStringValue(cJSON_GetObjectItemCaseSensitive(json, key));

	return text ? text : "";
}

/* Answers where it fails. */
static int make_change(cJSON *part, const cJSON *json, struct api_response *response)
{
	const struct part_change change = { member(json, "field"), member(json, "language"),
					    member(json, "from"), member(json, "to") };
	struct diagnostics diagnostics = { 0 };
	struct buffer theirs;
	cJSON *answer;
	int rc;

	buffer_init(&theirs, CHANGES_BYTES_MAX);
	rc = part_change_make(part, &change, &theirs, &diagnostics);
	if (rc == -ESTALE) {
		answer = cJSON_CreateObject();
		cJSON_AddStringToObject(answer, "message",
					"somebody else has changed this text meanwhile");
		cJSON_AddStringToObject(answer, "field", change.field);
		cJSON_AddStringToObject(answer, "language", change.language);
		cJSON_AddStringToObject(answer, "theirs", (const char *)theirs.data);
		response->status = 409;
		api_send_json(response, answer);
	} else if (rc < 0) {
		api_fail_with(response, rc, &diagnostics);
	}
	buffer_finish(&theirs);
	return rc;
}

static void change_part(struct site *site, const struct api_request *request,
			struct api_response *response, const struct parts_file *parts,
			const cJSON *changes)
{
	const char *id = api_parameter(request, "id");
	cJSON *part = parts_file_find(parts, id);
	struct document_change document;
	char what[HISTORY_WHAT_BYTES];
	const cJSON *change;

	if (!part) {
		api_fail(response, 404, "there is no part \"%s\": somebody may have removed it",
			 id);
		return;
	}
	cJSON_ArrayForEach(change, changes)
	{
		if (make_change(part, change, response) < 0)
			return;
	}
	snprintf(what, sizeof(what), "%s of %s", member(changes->child, "field"), id);
	save(site, request, response, parts, what, &document, 1);
}

static void post_texts(void *user, const struct api_request *request, struct api_response *response)
{
	struct diagnostics diagnostics = { 0 };
	struct site *site = user;
	struct parts_file parts;
	const cJSON *changes;
	cJSON *json;
	int rc;

	if (api_read_json(request, response, &json) < 0)
		return;
	changes = cJSON_GetObjectItemCaseSensitive(json, "changes");
	documents_lock(site->documents);
	rc = parts_file_read(&parts, site->documents, &diagnostics);
	if (rc < 0)
		api_fail_with(response, rc, &diagnostics);
	else if (!cJSON_IsArray(changes) || !changes->child)
		api_fail(response, 400, "\"changes\" must be a list");
	else
		change_part(site, request, response, &parts, changes);
	documents_unlock(site->documents);
	parts_file_finish(&parts);
	cJSON_Delete(json);
}

/* ---- order */

static void post_place(void *user, const struct api_request *request, struct api_response *response)
{
	const char *id = api_parameter(request, "id");
	struct diagnostics diagnostics = { 0 };
	struct document_change document;
	struct site *site = user;
	char what[HISTORY_WHAT_BYTES];
	struct parts_file parts;
	cJSON *json;
	int rc;

	if (api_read_json(request, response, &json) < 0)
		return;
	documents_lock(site->documents);
	rc = parts_file_read(&parts, site->documents, &diagnostics);
	snprintf(what, sizeof(what), "place of %s", id);
	if (rc == 0)
		rc = part_change_place(&parts, id, member(json, "before"));
	if (rc == 0)
		save(site, request, response, &parts, what, &document, 1);
	else if (rc == -ENOENT)
		api_fail(response, 404, "one of the parts is gone: somebody has removed it");
	else
		api_fail_with(response, rc, &diagnostics);
	documents_unlock(site->documents);
	parts_file_finish(&parts);
	cJSON_Delete(json);
}

/* ---- removing */

struct removal {
	const char *id;
	char names[DOCUMENTS_CHANGES_MAX][DOCUMENT_NAME_BYTES];
	uint32_t count; /* the first is parts.json */
};

/* The part's pages, and its own list of faces. */
static int note_file(void *user, const char *name, const char *tag)
{
	struct removal *removal = user;
	char page[DOCUMENT_NAME_BYTES], region[DOCUMENT_NAME_BYTES];

	(void)tag;
	snprintf(page, sizeof(page), "pages/%s.", removal->id);
	snprintf(region, sizeof(region), "regions/%s.faces", removal->id);
	if (strncmp(name, page, strlen(page)) != 0 && strcmp(name, region) != 0)
		return 0;
	if (removal->count == DOCUMENTS_CHANGES_MAX)
		return -EFBIG;
	snprintf(removal->names[removal->count++], DOCUMENT_NAME_BYTES, "%s", name);
	return 0;
}

static void remove_part(struct site *site, const struct api_request *request,
			struct api_response *response, const struct parts_file *parts)
{
	struct removal removal = { .id = api_parameter(request, "id"), .count = 1 };
	struct document_change changes[DOCUMENTS_CHANGES_MAX] = { 0 };
	struct diagnostics diagnostics = { 0 };
	char what[HISTORY_WHAT_BYTES];
	int rc = part_change_remove(parts, removal.id);

	if (rc == 0)
		rc = documents_each(site->documents, note_file, &removal, &diagnostics);
	if (rc < 0) {
		api_fail_with(response, rc, &diagnostics);
		return;
	}
	for (uint32_t n = 1; n < removal.count; n++)
		changes[n] = (struct document_change){ .name = removal.names[n], .removes = true };
	snprintf(what, sizeof(what), "%s removed", removal.id);
	save(site, request, response, parts, what, changes, removal.count);
}

static void delete_part(void *user, const struct api_request *request,
			struct api_response *response)
{
	struct diagnostics diagnostics = { 0 };
	struct site *site = user;
	struct parts_file parts;
	int rc;

	documents_lock(site->documents);
	rc = parts_file_read(&parts, site->documents, &diagnostics);
	if (rc < 0)
		api_fail_with(response, rc, &diagnostics);
	else
		remove_part(site, request, response, &parts);
	documents_unlock(site->documents);
	parts_file_finish(&parts);
}

struct api_routes information_routes(struct site *site)
{
	static const struct api_route routes[] = {
		{ API_GET, "/api/information", ROLE_READER, 0, true, get_information },
		{ API_POST, "/api/parts/{id}/texts", ROLE_EDITOR, CHANGES_BYTES_MAX, true,
		  post_texts },
		{ API_POST, "/api/parts/{id}/place", ROLE_EDITOR, API_JSON_BYTES_MAX, true,
		  post_place },
		{ API_DELETE, "/api/parts/{id}", ROLE_EDITOR, 0, true, delete_part },
	};

	return (struct api_routes){ routes, ARRAY_COUNT(routes), site };
}
