/* Collects parts.json, tours.json and the names of pages and pictures. */
#include "curator/pages/information_list.h"

#include <cjson/cJSON.h>
#include <errno.h>
#include <stdio.h>
#include <string.h>

#include "base/json_tree.h"
#include "curator/pages/content_save.h"
#include "curator/store/json_document.h"
#include "curator/store/parts_file.h"

static void copy(cJSON *to, const cJSON *from, const char *key)
{
	const cJSON *item = cJSON_GetObjectItemCaseSensitive(from, key);

	if (item)
		json_add(to, key, cJSON_Duplicate(item, true));
}

static void add_part(cJSON *rows, const cJSON *part)
{
	static const char *const keys[] = { "title",   "caption",   "reading",
					    "credits", "thumbnail", "documents" };
	const cJSON *id = cJSON_GetObjectItemCaseSensitive(part, "id"),
		    *kind = cJSON_GetObjectItemCaseSensitive(
			    cJSON_GetObjectItemCaseSensitive(part, "region"), "kind");
	cJSON *row;

	if (!cJSON_IsString(id))
		return;
	row = cJSON_CreateObject();
	cJSON_AddStringToObject(row, "id", id->valuestring);
	for (size_t n = 0; n < ARRAY_COUNT(keys); n++)
		copy(row, part, keys[n]);
	cJSON_AddStringToObject(row, "kind", cJSON_IsString(kind) ? kind->valuestring : "point");
	cJSON_AddBoolToObject(row, "without_page",
			      cJSON_IsFalse(cJSON_GetObjectItemCaseSensitive(part, "page")));
	cJSON_AddObjectToObject(row, "pages");
	cJSON_AddObjectToObject(row, "spoken");
	cJSON_AddObjectToObject(row, "words");
	json_append(rows, row);
}

struct lister {
	const struct content *content;
	cJSON *parts, *pictures, *documents;
};

static cJSON *row_of(const cJSON *parts, const char *id, size_t bytes)
{
	cJSON *row;

	cJSON_ArrayForEach(row, parts)
	{
		const char *its = cJSON_GetStringValue(cJSON_GetObjectItemCaseSensitive(row, "id"));

		/* none: no memory was left for it, and the list will not be sent */
		if (its && strlen(its) == bytes && memcmp(its, id, bytes) == 0)
			return row;
	}
	return NULL;
}

/* Pages that are of no part: documents. */
static cJSON *add_document_row(cJSON *documents, const char *id, size_t bytes)
{
	cJSON *row = row_of(documents, id, bytes);
	char name[DOCUMENT_NAME_BYTES];

	if (row)
		return row;
	snprintf(name, sizeof(name), "%.*s", (int)bytes, id);
	row = cJSON_CreateObject();
	cJSON_AddStringToObject(row, "id", name);
	cJSON_AddObjectToObject(row, "pages");
	return json_append(documents, row) ? row : NULL;
}

/* A page, its recording, or the words of that. */
static void add_page(const struct lister *lister, const char *name, const char *tag)
{
	static const char *const kinds[][2] = { { ".html", "pages" },
						{ ".opus", "spoken" },
						{ ".vtt", "words" } };
	const char *id = name + strlen("pages/"), *dot = strchr(id, '.');
	const cJSON *row = dot ? row_of(lister->parts, id, (size_t)(dot - id)) : NULL;

	if (dot && !row)
		row = add_document_row(lister->documents, id, (size_t)(dot - id));

	for (uint32_t n = 0; row && n < lister->content->language_count; n++) {
		const char *language = lister->content->languages[n];
		const size_t bytes = strlen(language);

		for (size_t k = 0; k < ARRAY_COUNT(kinds); k++)
			if (strncmp(dot + 1, language, bytes) == 0 &&
			    strcmp(dot + 1 + bytes, kinds[k][0]) == 0)
				cJSON_AddStringToObject(
					cJSON_GetObjectItemCaseSensitive(row, kinds[k][1]),
					language, tag); /* documents have pages alone */
	}
}

static int add_document(void *user, const char *name, const char *tag)
{
	const struct lister *lister = user;

	if (strncmp(name, "pages/", 6) == 0)
		add_page(lister, name, tag);
	else if (strncmp(name, "pictures/", 9) == 0)
		json_append(lister->pictures, cJSON_CreateString(name));
	return 0;
}

/* Tours are only named here: a file that is not valid has its problem in the list. */
static void add_tours(struct site *site, cJSON *rows)
{
	char tag[DOCUMENT_TAG_BYTES];
	const cJSON *tour;
	cJSON *root;

	if (json_document_read(&root, site->documents, "tours.json", PARTS_FILE_BYTES_MAX, tag,
			       NULL) < 0)
		root = NULL;
	cJSON_ArrayForEach(tour, cJSON_GetObjectItemCaseSensitive(root, "tours"))
	{
		cJSON *row = cJSON_CreateObject();

		copy(row, tour, "id");
		copy(row, tour, "title");
		json_append(rows, row);
	}
	cJSON_Delete(root);
}

static int fill(struct site *site, cJSON *root, struct diagnostics *diagnostics)
{
	struct lister lister = { &site->content, cJSON_AddArrayToObject(root, "parts"),
				 cJSON_AddArrayToObject(root, "pictures"),
				 cJSON_AddArrayToObject(root, "documents") };
	cJSON *languages = cJSON_AddArrayToObject(root, "languages");
	struct diagnostics problems = { 0 };
	struct parts_file parts;
	const cJSON *part;
	int rc = parts_file_read(&parts, site->documents, diagnostics);

	if (rc < 0)
		return rc;
	cJSON_AddStringToObject(root, "name", site->content.name);
	for (uint32_t n = 0; n < site->content.language_count; n++)
		json_append(languages, cJSON_CreateString(site->content.languages[n]));
	cJSON_ArrayForEach(part, parts_file_list(&parts)) add_part(lister.parts, part);
	copy(root, parts.root, "credits");
	add_tours(site, cJSON_AddArrayToObject(root, "tours"));
	rc = documents_each(site->documents, add_document, &lister, diagnostics);
	if (rc == 0)
		rc = content_check(site, NULL, 0, &problems);
	if (rc == 0)
		json_add(root, "problems", content_problems(&problems, ""));
	diagnostics_finish(&problems);
	parts_file_finish(&parts);
	return rc;
}

int information_list(struct site *site, struct buffer *out, struct diagnostics *diagnostics)
{
	cJSON *root = cJSON_CreateObject();
	char *text = NULL;
	int rc;

	documents_lock(site->documents);
	rc = fill(site, root, diagnostics);
	documents_unlock(site->documents);
	if (rc == 0) {
		text = json_line(root);
		rc = text ? 0 : -ENOMEM;
	}
	if (rc == 0) {
		buffer_put_text(out, text);
		rc = out->error;
	}
	cJSON_free(text);
	cJSON_Delete(root);
	return rc;
}
