/* Reads, merges and saves pages. */
#include "curator/pages/page_routes.h"

#include <cjson/cJSON.h>
#include <errno.h>
#include <glib.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "base/json_tree.h"
#include "curator/pages/content_save.h"
#include "curator/pages/save_answer.h"
#include "curator/store/documents_versions.h"
#include "curator/store/parts_file.h"
#include "format/html_tags.h"

enum { PAGE_REQUEST_BYTES_MAX = 1 << 20 };

/* A page that somebody saves. */
struct page_save {
	struct site *site;
	const struct api_request *request;
	struct api_response *response;
	char name[DOCUMENT_NAME_BYTES];
	char base[DOCUMENT_TAG_BYTES]; /* from which it began; "": there was none */
	struct bytes html;             /* borrowed; data NULL: the page is removed */
	struct buffer merged;
	bool is_merged;
	char sent[DOCUMENT_TAG_BYTES]; /* if it is merged: of the text that came */
};

static void name_page(const struct api_request *request, char name[DOCUMENT_NAME_BYTES])
{
	snprintf(name, DOCUMENT_NAME_BYTES, "pages/%s.%s.html", api_parameter(request, "id"),
		 api_parameter(request, "language"));
}

static cJSON *page_json(struct bytes html, const char *tag)
{
	cJSON *json = cJSON_CreateObject();
	char *text = strndup(html.data ? (const char *)html.data : "", html.size);

	cJSON_AddStringToObject(json, "html", text ? text : "");
	cJSON_AddStringToObject(json, "tag", tag);
	free(text);
	return json;
}

/* A browser would show something else in the place of other bytes, and save that. The tag is for
 * going back to an older version. */
static void refuse_bytes(struct api_response *response, const char *name, const char *tag)
{
	cJSON *json = page_json((struct bytes){ 0 }, tag);
	char message[DIAGNOSTIC_BYTES];

	snprintf(message, sizeof(message), "%s is not UTF-8: save the file as UTF-8.", name);
	cJSON_AddStringToObject(json, "message", message);
	response->status = 422;
	api_send_json(response, json);
}

/* A page that is not there is one without text. */
static void get_page(void *user, const struct api_request *request, struct api_response *response)
{
	char name[DOCUMENT_NAME_BYTES], tag[DOCUMENT_TAG_BYTES];
	struct diagnostics diagnostics = { 0 };
	struct site *site = user;
	struct buffer html;
	int rc;

	name_page(request, name);
	buffer_init(&html, HTML_BYTES_MAX);
	rc = documents_read(site->documents, name, &html, tag, &diagnostics);
	if (rc < 0 && rc != -ENOENT)
		api_fail_with(response, rc, &diagnostics);
	else if (html.size > 0 &&
		 !g_utf8_validate((const char *)html.data, (gssize)html.size, NULL))
		refuse_bytes(response, name, tag);
	else
		api_send_json(response, page_json(buffer_bytes(&html), tag));
	buffer_finish(&html);
}

/* ---- saving */

/* Somebody decides in the browser, which gets the text to decide on, and the tag of what is there
 * now: from that the next save begins. */
static void answer_conflict(struct page_save *save, struct bytes html, const char *tag,
			    const char *message)
{
	cJSON *json = page_json(html, tag);

	cJSON_AddStringToObject(json, "message", message);
	save->response->status = 409;
	api_send_json(save->response, json);
}

/* Brings the text up to what is there now, theirs. Returns 0, or 1 with an answer. */
static int meet_others(struct page_save *save, struct bytes theirs, const char *now)
{
	struct diagnostics diagnostics = { 0 };
	char tag[DOCUMENT_TAG_BYTES];
	bool is_clean;
	int rc;

	if (strcmp(save->base, now) == 0)
		return 0;
	if (*now && save->html.data && bytes_equal(save->html, theirs)) {
		/* Somebody has written the same, or it is saved and the answer was lost. */
		memcpy(save->base, now, sizeof(save->base));
		return 0;
	}
	if (!*now || !save->html.data) {
		answer_conflict(save, theirs, now,
				*now ? "somebody else has changed this page meanwhile: look at it, "
				       "and remove it again if it is to go"
				     : "somebody else has removed this page meanwhile: save again "
				       "to bring it back");
		return 1;
	}
	rc = documents_merge(save->site->documents, save->name, save->base, save->html,
			     &save->merged, &is_clean, tag, &diagnostics);
	if (rc < 0) {
		api_fail_with(save->response, rc, &diagnostics);
		return 1;
	}
	if (!is_clean) {
		answer_conflict(save, buffer_bytes(&save->merged), tag,
				"somebody else has changed the same lines meanwhile: both texts "
				"are below; keep what is right, and save again");
		return 1;
	}
	rc = documents_keep(save->site->documents, save->name, save->html, save->sent,
			    &diagnostics);
	if (rc < 0) {
		api_fail_with(save->response, rc, &diagnostics);
		return 1;
	}
	save->html = buffer_bytes(&save->merged);
	save->is_merged = true;
	memcpy(save->base, tag, sizeof(save->base));
	return 0;
}

struct page_count {
	const char *id, *besides;
	uint32_t count;
};

static int count_page(void *user, const char *name, const char *tag)
{
	struct page_count *pages = user;
	char start[DOCUMENT_NAME_BYTES];

	(void)tag;
	snprintf(start, sizeof(start), "pages/%s.", pages->id);
	pages->count +=
		strncmp(name, start, strlen(start)) == 0 && strcmp(name, pages->besides) != 0;
	return 0;
}

/* A part has "page": false as long as it has no page in any language. Returns 1 if parts.json
 * changes. */
static int note_page(const struct page_save *save, cJSON *part, struct diagnostics *problems)
{
	const char *id = api_parameter(save->request, "id");
	const bool is_without = cJSON_IsFalse(cJSON_GetObjectItemCaseSensitive(part, "page"));
	struct page_count others = { id, save->name, 0 };
	int rc;

	if (!part) /* a document */
		return 0;
	if (save->html.data) {
		cJSON_DeleteItemFromObjectCaseSensitive(part, "page");
		return is_without;
	}
	rc = documents_each(save->site->documents, count_page, &others, problems);
	if (rc < 0 || others.count > 0 || is_without)
		return rc;
	return json_set(part, "page", cJSON_CreateFalse()) ? 1 : -ENOMEM;
}

static int write_page(struct page_save *save, const struct parts_file *parts, cJSON *part,
		      char tag[DOCUMENT_TAG_BYTES], struct diagnostics *problems)
{
	struct document_change changes[2] = { { .name = save->name,
						.text = save->html,
						.removes = !save->html.data,
						.base = save->base },
					      { .name = PARTS_FILE, .base = parts->tag } };
	char what[HISTORY_WHAT_BYTES];
	struct buffer text;
	int rc = note_page(save, part, problems);
	uint32_t count = 1 + (rc > 0);

	buffer_init(&text, PARTS_FILE_BYTES_MAX);
	if (rc > 0)
		rc = json_print(parts->root, &text);
	changes[1].text = buffer_bytes(&text);
	snprintf(what, sizeof(what), "page of %s in %s%s", api_parameter(save->request, "id"),
		 api_parameter(save->request, "language"),
		 save->is_merged   ? ", merged"
		 : save->html.data ? ""
				   : ", removed");
	if (rc == 0)
		rc = content_save(save->site, changes, count, save->request->caller.name, what,
				  problems);
	memcpy(tag, changes[0].tag, DOCUMENT_TAG_BYTES);
	buffer_finish(&text);
	return rc;
}

static void answer_saved(struct page_save *save, const char *tag)
{
	struct diagnostics found = { 0 };
	cJSON *json = page_json(save->is_merged ? save->html : (struct bytes){ 0 }, tag);

	cJSON_AddBoolToObject(json, "merged", save->is_merged);
	if (save->is_merged)
		cJSON_AddStringToObject(json, "sent", save->sent);
	if (content_check(save->site, NULL, 0, &found) == 0)
		json_add(json, "problems", content_problems(&found, save->name));
	diagnostics_finish(&found);
	api_send_json(save->response, json);
}

/* A page of no part, which parts may have among their documents. */
static bool is_document(const struct api_request *request)
{
	const char *kind = api_query(request, "kind"), *id = api_parameter(request, "id");

	return kind && strcmp(kind, "document") == 0 &&
	       strspn(id, "abcdefghijklmnopqrstuvwxyz0123456789-_") == strlen(id);
}

static void save_page(struct page_save *save, const struct parts_file *parts)
{
	struct diagnostics problems = { .max = CONTENT_PROBLEMS_MAX };
	cJSON *part = parts_file_find(parts, api_parameter(save->request, "id"));
	char tag[DOCUMENT_TAG_BYTES] = "";
	struct buffer now;
	int rc;

	if (!part && !is_document(save->request)) {
		api_fail(save->response, 404,
			 "there is no such part: somebody may have removed it");
		return;
	}
	buffer_init(&now, HTML_BYTES_MAX);
	rc = documents_read(save->site->documents, save->name, &now, tag, &problems);
	if (rc == 0 || (rc == -ENOENT && save->html.data)) {
		rc = meet_others(save, buffer_bytes(&now), tag);
		if (rc == 0)
			rc = write_page(save, parts, part, tag, &problems);
	} else if (rc == -ENOENT) {
		rc = 0; /* a removal whose answer was lost is asked for again */
	}
	buffer_finish(&now);
	if (rc < 0)
		save_answer_fail(save->response, rc, &problems);
	else if (rc == 0)
		answer_saved(save, tag);
	diagnostics_finish(&problems);
}

static bool is_language(const struct site *site, const char *language)
{
	for (uint32_t n = 0; n < site->content.language_count; n++)
		if (strcmp(site->content.languages[n], language) == 0)
			return true;
	return false;
}

/* html NULL: removes the page. */
static void change_page(struct site *site, const struct api_request *request,
			struct api_response *response, const char *html)
{
	struct page_save save = { .site = site, .request = request, .response = response };
	struct diagnostics diagnostics = { 0 };
	struct parts_file parts;
	int rc;

	if (html)
		save.html = (struct bytes){ (const uint8_t *)html, strlen(html) };
	name_page(request, save.name);
	if (save_base_read(request, response, save.base) < 0)
		return;
	if (!is_language(site, api_parameter(request, "language"))) {
		api_fail(response, 404, "the release has no such language: see temple.ini");
		return;
	}
	buffer_init(&save.merged, 4 * HTML_BYTES_MAX);
	documents_lock(site->documents);
	rc = parts_file_read(&parts, site->documents, &diagnostics);
	if (rc < 0)
		api_fail_with(response, rc, &diagnostics);
	else
		save_page(&save, &parts);
	documents_unlock(site->documents);
	parts_file_finish(&parts);
	buffer_finish(&save.merged);
}

static void put_page(void *user, const struct api_request *request, struct api_response *response)
{
	const char *html;
	cJSON *json;

	if (api_read_json(request, response, &json) < 0)
		return;
	html = cJSON_GetStringValue(cJSON_GetObjectItemCaseSensitive(json, "html"));
	if (!html)
		api_fail(response, 400, "\"html\" must be a text");
	else
		change_page(user, request, response, html);
	cJSON_Delete(json);
}

static void delete_page(void *user, const struct api_request *request,
			struct api_response *response)
{
	change_page(user, request, response, NULL);
}

struct api_routes page_routes(struct site *site)
{
	static const struct api_route routes[] = {
		{ API_GET, "/api/pages/{id}.{language}", ROLE_READER, 0, true, get_page },
		{ API_PUT, "/api/pages/{id}.{language}", ROLE_EDITOR, PAGE_REQUEST_BYTES_MAX, true,
		  put_page },
		{ API_DELETE, "/api/pages/{id}.{language}", ROLE_EDITOR, 0, true, delete_page },
	};

	return (struct api_routes){ routes, ARRAY_COUNT(routes), site };
}
