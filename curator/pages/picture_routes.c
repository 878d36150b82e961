/* Sends pictures of the content folder, and takes new ones. */
#include "curator/pages/picture_routes.h"

#include <cjson/cJSON.h>
#include <ctype.h>
#include <errno.h>
#include <stdio.h>
#include <string.h>

#include "curator/pages/picture_import.h"
#include "format/page.h"

enum { STEM_BYTES = 60, NUMBERS_MAX = 1000 };

static void get_picture(void *user, const struct api_request *request,
			struct api_response *response)
{
	const char *name = api_query(request, "name");
	struct diagnostics diagnostics = { 0 };
	char tag[DOCUMENT_TAG_BYTES];
	struct site *site = user;
	struct buffer file;
	int rc;

	if (!name || strncmp(name, "pictures/", 9) != 0) {
		api_fail(response, 404, "pictures are in pictures/");
		return;
	}
	buffer_init(&file, OBJECT_BYTES_MAX);
	rc = documents_read(site->documents, name, &file, tag, &diagnostics);
	if (rc == -ENOENT)
		api_fail(response, 404, "there is no such picture");
	else if (rc < 0)
		api_fail_with(response, rc, &diagnostics);
	else if (!api_send_tag(request, response, tag))
		api_send_bytes(response,
			       file.size > 0 && file.data[0] == 0x89 ? "image/png" : "image/jpeg",
			       buffer_bytes(&file));
	buffer_finish(&file);
}

/* Makes a name of that of the curator's file: a-z, 0-9 and hyphens. */
static void make_stem(char out[STEM_BYTES], const char *name)
{
	const char *end = strrchr(name, '.');
	size_t bytes = 0;

	if (!end || end == name)
		end = name + strlen(name);
	for (; name < end && bytes + 1 < STEM_BYTES; name++) {
		const int letter = tolower((unsigned char)*name);

		if ((letter >= 'a' && letter <= 'z') || (letter >= '0' && letter <= '9'))
			out[bytes++] = (char)letter;
		else if (bytes > 0 && out[bytes - 1] != '-')
			out[bytes++] = '-';
	}
	while (bytes > 0 && out[bytes - 1] == '-')
		bytes--;
	out[bytes] = '\0';
	if (bytes == 0)
		snprintf(out, STEM_BYTES, "picture");
}

/* Saves under the first name that is free, or that has the same bytes already. */
static int save_picture(struct site *site, const char *stem, bool is_png, struct bytes file,
			const char *author, char name[DOCUMENT_NAME_BYTES],
			struct diagnostics *diagnostics)
{
	struct document_change change = { .name = name, .text = file, .base = "" };
	char wanted[HISTORY_ID_BYTES], number[16] = "";
	int rc = history_id(file, wanted);

	for (int n = 2; rc == 0 && n < NUMBERS_MAX; n++) {
		struct diagnostics told = { 0 };

		snprintf(name, DOCUMENT_NAME_BYTES, "pictures/%s%s.%s", stem, number,
			 is_png ? "png" : "jpg");
		rc = documents_save(site->documents, &change, 1, author, name, &told);
		if (rc != -ESTALE && rc < 0)
			diagnostics_add(diagnostics, rc, NULL, 0, "%s",
					diagnostics_cause(&told, rc));
		if (rc != -ESTALE || strcmp(change.tag, wanted) == 0)
			return rc == -ESTALE ? 0 : rc;
		snprintf(number, sizeof(number), "-%d", n);
		rc = 0;
	}
	return rc < 0 ? rc : -EEXIST;
}

static void post_picture(void *user, const struct api_request *request,
			 struct api_response *response)
{
	const char *name = api_query(request, "name");
	struct diagnostics diagnostics = { 0 };
	char stem[STEM_BYTES], saved[DOCUMENT_NAME_BYTES];
	struct site *site = user;
	struct buffer file;
	bool is_png;
	cJSON *json;
	int rc;

	make_stem(stem, name ? name : "");
	buffer_init(&file, OBJECT_BYTES_MAX);
	rc = picture_import(&file, &is_png, buffer_bytes(&request->body), &diagnostics);
	if (rc == 0)
		rc = save_picture(site, stem, is_png, buffer_bytes(&file), request->caller.name,
				  saved, &diagnostics);
	if (rc < 0) {
		api_fail_with(response, rc, &diagnostics);
	} else {
		json = cJSON_CreateObject();
		cJSON_AddStringToObject(json, "name", saved);
		api_send_json(response, json);
	}
	buffer_finish(&file);
}

struct api_routes picture_routes(struct site *site)
{
	static const struct api_route routes[] = {
		{ API_GET, "/api/picture", ROLE_READER, 0, true, get_picture },
		{ API_POST, "/api/pictures", ROLE_EDITOR, API_UPLOAD_BYTES_MAX, true,
		  post_picture },
	};

	return (struct api_routes){ routes, ARRAY_COUNT(routes), site };
}
