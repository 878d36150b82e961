/* Sends, takes and removes the recordings of pages and their words. */
#include "curator/pages/spoken_routes.h"

#include <cjson/cJSON.h>
#include <errno.h>
#include <stdio.h>

#include "curator/pages/content_save.h"
#include "curator/pages/save_answer.h"
#include "curator/pages/sound_import.h"
#include "pipeline/content/spoken_sound.h"
#include "storage/info_spoken.h"

/* A recording or its words. */
struct kind {
	const char *ending, *what, *type;
	uint32_t bytes_max;
};

static const struct kind sound = { "opus", "recording", "audio/ogg", INFO_SPOKEN_BYTES_MAX },
			 words = { "vtt", "words", "text/vtt; charset=utf-8", CUES_FILE_BYTES_MAX };

static void name_file(const struct api_request *request, const struct kind *kind,
		      char name[DOCUMENT_NAME_BYTES])
{
	snprintf(name, DOCUMENT_NAME_BYTES, "pages/%s.%s.%s", api_parameter(request, "id"),
		 api_parameter(request, "language"), kind->ending);
}

static void get(struct site *site, const struct api_request *request, struct api_response *response,
		const struct kind *kind)
{
	char name[DOCUMENT_NAME_BYTES], tag[DOCUMENT_TAG_BYTES];
	struct diagnostics diagnostics = { 0 };
	struct buffer file;
	int rc;

	name_file(request, kind, name);
	buffer_init(&file, kind->bytes_max);
	rc = documents_read(site->documents, name, &file, tag, &diagnostics);
	if (rc == -ENOENT)
		api_fail(response, 404, "nothing is spoken on this page");
	else if (rc < 0)
		api_fail_with(response, rc, &diagnostics);
	else if (!api_send_tag(request, response, tag))
		api_send_bytes(response, kind->type, buffer_bytes(&file));
	buffer_finish(&file);
}

static bool is_there(struct site *site, const char *name)
{
	char tag[DOCUMENT_TAG_BYTES];
	struct buffer file;
	int rc;

	buffer_init(&file, INFO_SPOKEN_BYTES_MAX);
	rc = documents_read(site->documents, name, &file, tag, NULL);
	buffer_finish(&file);
	return rc == 0;
}

static bool has_page(struct site *site, const struct api_request *request)
{
	static const struct kind page = { .ending = "html" };
	char name[DOCUMENT_NAME_BYTES];

	name_file(request, &page, name);
	return is_there(site, name);
}

/* removes: else what came is saved. A recording takes its words with it. */
static void change(struct site *site, const struct api_request *request,
		   struct api_response *response, const struct kind *kind, bool removes)
{
	struct diagnostics problems = { .max = CONTENT_PROBLEMS_MAX };
	char name[DOCUMENT_NAME_BYTES], base[DOCUMENT_TAG_BYTES], what[HISTORY_WHAT_BYTES];
	char its_words[DOCUMENT_NAME_BYTES];
	struct document_change documents[2] = { { .name = name,
						  .text = buffer_bytes(&request->body),
						  .removes = removes,
						  .base = base },
						{ .name = its_words, .removes = true } };
	struct buffer recording;
	uint32_t count = 1;
	cJSON *json;
	int rc = 0;

	if (save_base_read(request, response, base) < 0)
		return;
	if (!removes && !has_page(site, request)) {
		api_fail(response, 404,
			 "there is no such page: write it first, what is spoken "
			 "belongs to it");
		return;
	}
	buffer_init(&recording, INFO_SPOKEN_BYTES_MAX);
	name_file(request, kind, name);
	name_file(request, &words, its_words);
	if (removes && kind == &sound && is_there(site, its_words))
		count = 2;
	snprintf(what, sizeof(what), "%s of %s in %s%s", kind->what, api_parameter(request, "id"),
		 api_parameter(request, "language"), removes ? ", removed" : "");
	if (!removes && request->body.size == 0)
		rc = diagnostics_add(&problems, -EINVAL, NULL, 0, "the file is empty");
	else if (!removes && kind == &sound)
		rc = sound_import(&recording, documents[0].text, &problems);
	if (recording.size > 0)
		documents[0].text = buffer_bytes(&recording);
	if (rc == 0)
		rc = content_save(site, documents, count, request->caller.name, what, &problems);
	if (rc < 0) {
		save_answer_fail(response, rc, &problems);
	} else {
		json = cJSON_CreateObject();
		cJSON_AddStringToObject(json, "tag", documents[0].tag);
		api_send_json(response, json);
	}
	buffer_finish(&recording);
	diagnostics_finish(&problems);
}

static void get_sound(void *user, const struct api_request *request, struct api_response *response)
{
	get(user, request, response, &sound);
}

static void put_sound(void *user, const struct api_request *request, struct api_response *response)
{
	change(user, request, response, &sound, false);
}

static void delete_sound(void *user, const struct api_request *request,
			 struct api_response *response)
{
	change(user, request, response, &sound, true);
}

static void get_words(void *user, const struct api_request *request, struct api_response *response)
{
	get(user, request, response, &words);
}

static void put_words(void *user, const struct api_request *request, struct api_response *response)
{
	change(user, request, response, &words, false);
}

static void delete_words(void *user, const struct api_request *request,
			 struct api_response *response)
{
	change(user, request, response, &words, true);
}

struct api_routes spoken_routes(struct site *site)
{
	static const char sound_path[] = "/api/spoken/{id}.{language}",
			  words_path[] = "/api/words/{id}.{language}";
	static const struct api_route routes[] = {
		{ API_GET, sound_path, ROLE_READER, 0, true, get_sound },
		{ API_PUT, sound_path, ROLE_EDITOR, INFO_SPOKEN_BYTES_MAX, true, put_sound },
		{ API_DELETE, sound_path, ROLE_EDITOR, 0, true, delete_sound },
		{ API_GET, words_path, ROLE_READER, 0, true, get_words },
		{ API_PUT, words_path, ROLE_EDITOR, CUES_FILE_BYTES_MAX, true, put_words },
		{ API_DELETE, words_path, ROLE_EDITOR, 0, true, delete_words },
	};

	return (struct api_routes){ routes, ARRAY_COUNT(routes), site };
}
