/* Lists versions, reads and compares them, and goes back to one. */
#include "curator/pages/history_routes.h"

#include <cjson/cJSON.h>
#include <errno.h>
#include <glib.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "base/json_tree.h"
#include "curator/pages/content_save.h"
#include "curator/pages/field_history.h"
#include "curator/pages/save_answer.h"
#include "curator/store/documents_versions.h"
#include "curator/store/text_compare.h"

enum { VERSIONS_MAX = 200, TEXT_BYTES_MAX = 16 << 20 };

/* Returns a value of the query, or "". */
static const char *asked(const struct api_request *request, const char *name)
{
	const char *value = api_query(request, name);

	return value ? value : "";
}

static cJSON *version_json(const struct history_version *version)
{
	const bool is_outside = strcmp(version->author, DOCUMENTS_OUTSIDE) == 0;
	cJSON *row = cJSON_CreateObject();

	cJSON_AddStringToObject(row, "version", version->id);
	cJSON_AddStringToObject(row, "author", is_outside ? "" : version->author);
	cJSON_AddStringToObject(row, "what", version->what);
	cJSON_AddNumberToObject(row, "time", (double)version->time_s);
	cJSON_AddBoolToObject(row, "removed", !version->text_id[0]);
	return row;
}

static void get_versions(void *user, const struct api_request *request,
			 struct api_response *response)
{
	struct history_version *versions = calloc(VERSIONS_MAX, sizeof(*versions));
	struct diagnostics diagnostics = { 0 };
	struct site *site = user;
	cJSON *json, *list;
	uint32_t count = 0;
	int rc = versions ? documents_versions(site->documents, asked(request, "document"),
					       versions, VERSIONS_MAX, &count, &diagnostics)
			  : -ENOMEM;

	if (rc < 0) {
		api_fail_with(response, rc, &diagnostics);
	} else {
		json = cJSON_CreateObject();
		list = cJSON_AddArrayToObject(json, "versions");
		for (uint32_t n = 0; n < count; n++)
			json_append(list, version_json(&versions[n]));
		api_send_json(response, json);
	}
	free(versions);
}

/* Reads a document as it was; version "": as it is, and nothing if it is not there. */
static int read_version(struct site *site, const char *name, const char *version,
			struct buffer *out, struct diagnostics *diagnostics)
{
	char tag[DOCUMENT_TAG_BYTES];
	int rc;

	buffer_init(out, TEXT_BYTES_MAX);
	if (*version)
		rc = documents_read_version(site->documents, name, version, out, diagnostics);
	else
		rc = documents_read(site->documents, name, out, tag, diagnostics);
	if (rc == -ENOENT && !*version)
		rc = 0;
	if (rc == 0 && out->size > 0 &&
	    !g_utf8_validate((const char *)out->data, (gssize)out->size, NULL))
		rc = diagnostics_add(diagnostics, -EINVAL, name, 0, "is not a text");
	return rc;
}

static void add_text(cJSON *json, const char *key, struct buffer *text)
{
	buffer_put_u8(text, 0);
	cJSON_AddStringToObject(json, key, text->error ? "" : (const char *)text->data);
}

static void get_version(void *user, const struct api_request *request,
			struct api_response *response)
{
	struct diagnostics diagnostics = { 0 };
	struct buffer text;
	cJSON *json;
	int rc = read_version(user, asked(request, "document"), asked(request, "version"), &text,
			      &diagnostics);

	if (rc < 0) {
		api_fail_with(response, rc, &diagnostics);
	} else {
		json = cJSON_CreateObject();
		add_text(json, "text", &text);
		api_send_json(response, json);
	}
	buffer_finish(&text);
}

/* From a version to another; "to" is left out: to the text that is there. */
static void get_difference(void *user, const struct api_request *request,
			   struct api_response *response)
{
	const char *name = asked(request, "document");
	struct diagnostics diagnostics = { 0 };
	struct buffer from, to, lines;
	cJSON *json;
	int rc = read_version(user, name, asked(request, "from"), &from, &diagnostics);

	buffer_init(&to, TEXT_BYTES_MAX);
	buffer_init(&lines, 2 * TEXT_BYTES_MAX);
	if (rc == 0)
		rc = read_version(user, name, asked(request, "to"), &to, &diagnostics);
	if (rc == 0)
		rc = text_difference(&lines, buffer_bytes(&from), buffer_bytes(&to));
	if (rc < 0) {
		api_fail_with(response, rc, &diagnostics);
	} else {
		json = cJSON_CreateObject();
		add_text(json, "lines", &lines);
		api_send_json(response, json);
	}
	buffer_finish(&lines);
	buffer_finish(&to);
	buffer_finish(&from);
}

/* Of a part's title, caption, reading and picture, each by itself. */
static void get_fields(void *user, const struct api_request *request, struct api_response *response)
{
	struct diagnostics diagnostics = { 0 };
	cJSON *json = cJSON_CreateObject();
	int rc = field_history(cJSON_AddArrayToObject(json, "changes"), user,
			       api_parameter(request, "id"), &diagnostics);

	if (rc == 0) {
		api_send_json(response, json);
		return;
	}
	cJSON_Delete(json);
	api_fail_with(response, rc, &diagnostics);
}

/* Goes back: a new version with the old text. */
static void post_restore(void *user, const struct api_request *request,
			 struct api_response *response)
{
	struct diagnostics problems = { .max = CONTENT_PROBLEMS_MAX };
	struct document_change change = { 0 };
	struct site *site = user;
	char what[HISTORY_WHAT_BYTES];
	const char *version;
	struct buffer text;
	cJSON *json;
	int rc;

	if (api_read_json(request, response, &json) < 0)
		return;
	change.name = cJSON_GetStringValue(cJSON_GetObjectItemCaseSensitive(json, "document"));
	change.base = cJSON_GetStringValue(cJSON_GetObjectItemCaseSensitive(json, "tag"));
	version = cJSON_GetStringValue(cJSON_GetObjectItemCaseSensitive(json, "version"));
	buffer_init(&text, DOCUMENT_BYTES_MAX);
	rc = change.name && version ? documents_read_version(site->documents, change.name, version,
							     &text, &problems)
				    : diagnostics_add(&problems, -EINVAL, NULL, 0,
						      "\"document\" and \"version\" must be texts");
	change.text = buffer_bytes(&text);
	snprintf(what, sizeof(what), "back to version %.8s", version ? version : "");
	if (rc == 0)
		rc = content_save(site, &change, 1, request->caller.name, what, &problems);
	if (rc < 0) {
		save_answer_fail(response, rc, &problems);
	} else {
		cJSON *answer = cJSON_CreateObject();

		cJSON_AddStringToObject(answer, "tag", change.tag);
		api_send_json(response, answer);
	}
	buffer_finish(&text);
	diagnostics_finish(&problems);
	cJSON_Delete(json);
}

struct api_routes history_routes(struct site *site)
{
	static const struct api_route routes[] = {
		{ API_GET, "/api/versions", ROLE_READER, 0, true, get_versions },
		{ API_GET, "/api/version", ROLE_READER, 0, true, get_version },
		{ API_GET, "/api/parts/{id}/history", ROLE_READER, 0, true, get_fields },
		{ API_GET, "/api/difference", ROLE_READER, 0, true, get_difference },
		{ API_POST, "/api/restore", ROLE_EDITOR, API_JSON_BYTES_MAX, true, post_restore },
	};

	return (struct api_routes){ routes, ARRAY_COUNT(routes), site };
}
