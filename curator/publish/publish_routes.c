/* Answers with what the publisher wrote, and writes requests for it. */
#include "curator/publish/publish_routes.h"

#include <cjson/cJSON.h>
#include <errno.h>
#include <fcntl.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "base/clock.h"
#include "base/json_tree.h"
#include "base/log.h"
#include "base/transient.h"
#include "curator/publish/changes.h"
#include "curator/publish/publish_files.h"

void publish_place_init(struct publish_place *place, const char *folder, const char *release)
{
	struct diagnostics diagnostics = { 0 };
	int rc;

	*place = (struct publish_place){ .folder = folder, .release = release };
	rc = release ? publish_files_make(folder, &diagnostics) : 0;
	if (rc < 0)
		log_error("curator", "%s", diagnostics_cause(&diagnostics, rc));
	publish_drop_leftovers(folder, "request.json");
	pthread_mutex_init(&place->asking, NULL);
	pthread_mutex_init(&place->comparing, NULL);
}

void publish_place_finish(struct publish_place *place)
{
	pthread_mutex_destroy(&place->asking);
	pthread_mutex_destroy(&place->comparing);
}

/* Returns false, and an answer, if the program was not told where releases are. */
static bool has_release(const struct publish_place *place, struct api_response *response)
{
	if (!place->release)
		api_fail(response, 409,
			 "publishing is not set up: start gopura-curator with --release RELEASE, "
			 "and gopura-curator publisher beside it");
	return place->release != NULL;
}

/* Returns what changes_find gives; NULL, and an answer, on failure. */
static cJSON *find_changes(struct publish_place *place, struct api_response *response)
{
	struct diagnostics diagnostics = { 0 };
	cJSON *json;
	int rc;

	if (pthread_mutex_trylock(&place->comparing) != 0) {
		api_fail(response, 503, "somebody else is looking at the changes: try again");
		api_add_header(response, "retry-after:", "1");
		return NULL;
	}
	rc = changes_find(&json, place->folder, place->release, &diagnostics);
	pthread_mutex_unlock(&place->comparing);
	if (rc < 0)
		api_fail_with(response, rc, &diagnostics);
	return json;
}

static void get_changes(void *user, const struct api_request *request,
			struct api_response *response)
{
	cJSON *json = NULL;

	(void)request;
	if (has_release(user, response))
		json = find_changes(user, response);
	if (json)
		api_send_json(response, json);
}

/* ---- the state */

/* The end of what gopura-content printed; bytes that are not UTF-8 are left to the browser. */
static void add_log(cJSON *json, const char *folder)
{
	char path[PATH_MAX], *text = malloc(PUBLISH_LOG_BYTES_MAX + 1);
	int fd = -1;
	ssize_t bytes = 0;

	if (text && publish_file_path(path, folder, "log") == 0)
		fd = open(path, O_RDONLY | O_CLOEXEC | O_NOFOLLOW | O_NONBLOCK);
	if (fd >= 0) {
		if (lseek(fd, -PUBLISH_LOG_BYTES_MAX, SEEK_END) < 0)
			lseek(fd, 0, SEEK_SET);
		bytes = read(fd, text, PUBLISH_LOG_BYTES_MAX);
		close(fd);
	}
	if (text) {
		text[bytes > 0 ? bytes : 0] = '\0';
		cJSON_AddStringToObject(json, "log", text);
	}
	free(text);
}

static void add_state(cJSON *json, const struct publish_request *request,
		      const struct publish_state *state)
{
	const struct publish_request *shown = &state->request;

	if (request->number > shown->number) {
		cJSON_AddStringToObject(json, "step", "waiting");
		shown = request;
	} else {
		cJSON_AddStringToObject(json, "step", publish_step_name(state->step));
		cJSON_AddNumberToObject(json, "begun", (double)state->begun_s);
		cJSON_AddNumberToObject(json, "ended", (double)state->ended_s);
		cJSON_AddNumberToObject(json, "before", (double)state->before);
		cJSON_AddNumberToObject(json, "after", (double)state->after);
		cJSON_AddStringToObject(json, "message", state->message);
	}
	cJSON_AddStringToObject(json, "by", shown->by);
	cJSON_AddStringToObject(json, "comment", shown->comment);
	cJSON_AddNumberToObject(json, "sequence", (double)shown->sequence);
	cJSON_AddNumberToObject(json, "at", (double)shown->at_s);
}

static void add_releases(cJSON *json, const struct publish_releases *releases)
{
	cJSON *list = cJSON_AddArrayToObject(json, "releases");

	for (uint32_t n = 0; n < releases->count; n++) {
		const struct publish_release *one = &releases->list[n];
		cJSON *row = cJSON_CreateObject();

		cJSON_AddNumberToObject(row, "sequence", (double)one->sequence);
		cJSON_AddStringToObject(row, "comment", one->comment);
		cJSON_AddStringToObject(row, "by", one->by);
		cJSON_AddNumberToObject(row, "at", (double)one->at_s);
		cJSON_AddBoolToObject(row, "current",
				      strcmp(one->root, releases->list[0].root) == 0);
		json_append(list, row);
	}
}

/* A file that is damaged, or is not ours to read, counts as none: it is replaced when somebody
 * asks, or by the publisher. */
static int unless_damaged(int rc)
{
	return is_transient(rc) ? rc : 0;
}

static void get_publish(void *user, const struct api_request *request,
			struct api_response *response)
{
	const struct publish_place *place = user;
	struct publish_request asked;
	struct publish_state state;
	struct publish_releases releases;
	cJSON *json;
	int rc = unless_damaged(publish_request_read(&asked, place->folder));

	if (rc == 0)
		rc = unless_damaged(publish_state_read(&state, place->folder));
	if (rc == 0)
		rc = unless_damaged(publish_releases_read(&releases, place->folder));
	if (rc < 0) {
		api_fail(response, 500, "the files of .curator/publish cannot be read: %s",
			 strerror(-rc));
		return;
	}
	json = cJSON_CreateObject();
	cJSON_AddBoolToObject(json, "set_up", place->release != NULL);
	cJSON_AddBoolToObject(json, "publisher", publish_has_publisher(place->folder));
	add_state(json, &asked, &state);
	add_releases(json, &releases);
	if (api_query(request, "log"))
		add_log(json, place->folder);
	publish_releases_finish(&releases);
	api_send_json(response, json);
}

/* ---- a request */

/* *content, which is json's, is that which somebody has looked at; NULL: not said. */
static bool parse_wish(struct publish_request *out, const char **content, const cJSON *json)
{
	const cJSON *comment = cJSON_GetObjectItemCaseSensitive(json, "comment"),
		    *sequence = cJSON_GetObjectItemCaseSensitive(json, "sequence"),
		    *seen = cJSON_GetObjectItemCaseSensitive(json, "content");

	*content = cJSON_GetStringValue(seen);
	if (seen && !*content)
		return false;
	if (!cJSON_IsString(comment) || !publish_comment_is_valid(comment->valuestring))
		return false;
	memcpy(out->comment, comment->valuestring, strlen(comment->valuestring) + 1);
	if (!sequence)
		return true;
	if (!cJSON_IsNumber(sequence) || !(sequence->valuedouble >= 1) ||
	    sequence->valuedouble > UINT32_MAX)
		return false;
	out->sequence = (uint64_t)sequence->valuedouble;
	return true;
}

/* Returns whether the content is what somebody has looked at; if not, the answer has the changes as
 * they are now. */
static bool is_as_seen(struct publish_place *place, const char *content,
		       struct api_response *response)
{
	cJSON *json, *changes = find_changes(place, response);
	const char *now;

	if (!changes)
		return false;
	now = cJSON_GetStringValue(cJSON_GetObjectItemCaseSensitive(changes, "content"));
	if (now && strcmp(now, content) == 0) {
		cJSON_Delete(changes);
		return true;
	}
	json = cJSON_CreateObject();
	cJSON_AddStringToObject(
		json, "message",
		"the content has been changed since these changes were listed: look "
		"at them again, then publish");
	json_add(json, "changes", changes);
	response->status = 409;
	api_send_json(response, json);
	return false;
}

/* Under the lock. Negative errno, with a diagnostic. */
static int ask(const struct publish_place *place, struct publish_request *wish,
	       struct diagnostics *diagnostics)
{
	struct publish_request before;
	struct publish_state state;
	int rc = publish_files_make(place->folder, diagnostics);

	if (rc == 0)
		rc = unless_damaged(publish_request_read(&before, place->folder));
	if (rc == 0)
		rc = unless_damaged(publish_state_read(&state, place->folder));
	if (rc == 0 && publish_is_pending(&before, &state))
		return diagnostics_add(diagnostics, -EBUSY, NULL, 0,
				       "%s is publishing already: wait for the end", before.by);
	if (rc == 0) {
		wish->number =
			before.number > state.request.number ? before.number : state.request.number;
		wish->number++;
		rc = publish_request_write(wish, place->folder);
	}
	if (rc < 0)
		diagnostics_add(diagnostics, rc, "request.json", 0, "%s", strerror(-rc));
	return rc;
}

static void make_wish(struct publish_place *place, struct publish_request *wish,
		      struct api_response *response)
{
	struct diagnostics diagnostics = { 0 };
	int rc;

	pthread_mutex_lock(&place->asking);
	rc = ask(place, wish, &diagnostics);
	pthread_mutex_unlock(&place->asking);
	if (rc < 0) {
		api_fail_with(response, rc, &diagnostics);
		return;
	}
	log_info("curator", "%s asks to publish", wish->by);
	response->status = 202;
	api_send_json(response, cJSON_CreateObject());
}

static void post_publish(void *user, const struct api_request *request,
			 struct api_response *response)
{
	struct publish_place *place = user;
	struct publish_request wish = { .at_s = clock_wall_s() };
	const char *content;
	cJSON *json;

	if (!has_release(place, response) || api_read_json(request, response, &json) < 0)
		return;
	memcpy(wish.by, request->caller.name, sizeof(wish.by));
	if (!parse_wish(&wish, &content, json))
		api_fail(
			response, 422,
			"\"comment\" is one line of at most %d bytes, \"sequence\" the number of a "
			"release, and \"content\" that of its changes",
			PUBLISH_COMMENT_BYTES - 1);
	else if (!content || wish.sequence > 0 || is_as_seen(place, content, response))
		make_wish(place, &wish, response);
	cJSON_Delete(json);
}

struct api_routes publish_routes(struct publish_place *place)
{
	static const struct api_route routes[] = {
		{ API_GET, "/api/changes", ROLE_READER, 0, true, get_changes },
		{ API_GET, "/api/publish", ROLE_READER, 0, true, get_publish },
		{ API_POST, "/api/publish", ROLE_PUBLISHER, API_JSON_BYTES_MAX, true,
		  post_publish },
	};

	return (struct api_routes){ routes, ARRAY_COUNT(routes), place };
}
