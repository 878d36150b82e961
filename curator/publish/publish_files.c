/* JSON to structs and back, and the files. */
#include "curator/publish/publish_files.h"

#include <cjson/cJSON.h>
#include <errno.h>
#include <fcntl.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <unistd.h>

#include "base/array.h"
#include "base/json_tree.h"
#include "base/utf8.h"
#include "curator/accounts/accounts.h"

static const char *const steps[] = { "idle", "running", "done", "failed" };

const char *publish_step_name(enum publish_step step)
{
	return steps[step];
}

bool publish_is_pending(const struct publish_request *request, const struct publish_state *state)
{
	return request->number > state->request.number || state->step == PUBLISH_RUNNING;
}

/* ---- values of JSON: each returns false where it is wrong */

static bool get_text(const cJSON *json, const char *key, char *out, size_t out_bytes)
{
	const cJSON *item = cJSON_GetObjectItemCaseSensitive(json, key);
	const size_t bytes = cJSON_IsString(item) ? strlen(item->valuestring) : out_bytes;

	if (bytes >= out_bytes)
		return false;
	for (size_t at = 0, size; at < bytes; at += size) {
		size = utf8_bytes(item->valuestring + at, bytes - at);
		if (size == 0)
			return false;
	}
	memcpy(out, item->valuestring, bytes + 1);
	return true;
}

static bool get_number(const cJSON *json, const char *key, uint64_t *out)
{
	const cJSON *item = cJSON_GetObjectItemCaseSensitive(json, key);

	if (!cJSON_IsNumber(item) || !(item->valuedouble >= 0) || item->valuedouble > 9e15 ||
	    floor(item->valuedouble) != item->valuedouble)
		return false;
	*out = (uint64_t)item->valuedouble;
	return true;
}

static bool get_time(const cJSON *json, const char *key, int64_t *out_s)
{
	uint64_t value;

	if (!get_number(json, key, &value))
		return false;
	*out_s = (int64_t)value;
	return true;
}

/* ---- a request */

static bool is_name(const char *name)
{
	return !*name || account_name_is_valid(name);
}

static bool get_request(const cJSON *json, struct publish_request *out)
{
	return get_number(json, "number", &out->number) &&
	       get_number(json, "sequence", &out->sequence) && get_time(json, "at", &out->at_s) &&
	       get_text(json, "by", out->by, sizeof(out->by)) && is_name(out->by) &&
	       get_text(json, "comment", out->comment, sizeof(out->comment));
}

static void add_request(cJSON *json, const struct publish_request *request)
{
	cJSON_AddNumberToObject(json, "number", (double)request->number);
	cJSON_AddNumberToObject(json, "sequence", (double)request->sequence);
	cJSON_AddNumberToObject(json, "at", (double)request->at_s);
	cJSON_AddStringToObject(json, "by", request->by);
	cJSON_AddStringToObject(json, "comment", request->comment);
}

bool publish_comment_is_valid(const char *comment)
{
	const size_t bytes = strlen(comment);

	for (size_t at = 0, size; at < bytes; at += size) {
		size = utf8_bytes(comment + at, bytes - at);
		if (size == 0)
			return false;
	}
	return bytes < PUBLISH_COMMENT_BYTES;
}

int publish_request_parse(struct publish_request *out, struct bytes text)
{
	cJSON *json;
	int rc = json_parse(&json, text);
	bool good;

	*out = (struct publish_request){ 0 };
	good = get_request(json, out);
	cJSON_Delete(json);
	if (!good)
		*out = (struct publish_request){ 0 };
	return good || rc < 0 ? rc : -EBADMSG;
}

/* ---- the state */

static bool get_step(const cJSON *json, enum publish_step *out)
{
	char name[16];

	if (!get_text(json, "step", name, sizeof(name)))
		return false;
	for (unsigned n = 0; n < ARRAY_COUNT(steps); n++)
		if (strcmp(name, steps[n]) == 0) {
			*out = (enum publish_step)n;
			return true;
		}
	return false;
}

int publish_state_parse(struct publish_state *out, struct bytes text)
{
	cJSON *json;
	int rc = json_parse(&json, text);
	bool good;

	*out = (struct publish_state){ 0 };
	good = get_request(cJSON_GetObjectItemCaseSensitive(json, "request"), &out->request) &&
	       get_step(json, &out->step) && get_time(json, "begun", &out->begun_s) &&
	       get_time(json, "ended", &out->ended_s) && get_number(json, "before", &out->before) &&
	       get_number(json, "after", &out->after) &&
	       get_text(json, "message", out->message, sizeof(out->message));
	cJSON_Delete(json);
	if (!good)
		*out = (struct publish_state){ 0 };
	return good || rc < 0 ? rc : -EBADMSG;
}

static cJSON *print_state(const struct publish_state *state)
{
	cJSON *json = cJSON_CreateObject();

	add_request(cJSON_AddObjectToObject(json, "request"), &state->request);
	cJSON_AddStringToObject(json, "step", steps[state->step]);
	cJSON_AddNumberToObject(json, "begun", (double)state->begun_s);
	cJSON_AddNumberToObject(json, "ended", (double)state->ended_s);
	cJSON_AddNumberToObject(json, "before", (double)state->before);
	cJSON_AddNumberToObject(json, "after", (double)state->after);
	cJSON_AddStringToObject(json, "message", state->message);
	return json;
}

/* ---- the releases */

static int add_release(struct publish_releases *releases, const cJSON *row)
{
	struct publish_release one = { 0 };
	int rc;

	if (!get_number(row, "sequence", &one.sequence) ||
	    !get_text(row, "root", one.root, sizeof(one.root)) ||
	    !get_text(row, "comment", one.comment, sizeof(one.comment)) ||
	    !get_text(row, "by", one.by, sizeof(one.by)) || !is_name(one.by) ||
	    !get_time(row, "at", &one.at_s))
		return -EBADMSG;
	rc = ARRAY_RESERVE(releases->list, releases->room, releases->count + 1,
			   PUBLISH_RELEASES_MAX);
	if (rc == 0)
		releases->list[releases->count++] = one;
	return rc == -EFBIG ? -EBADMSG : rc;
}

int publish_releases_parse(struct publish_releases *out, struct bytes text)
{
	cJSON *json;
	int rc = json_parse(&json, text);
	const cJSON *list = cJSON_GetObjectItemCaseSensitive(json, "releases"), *row;

	*out = (struct publish_releases){ 0 };
	if (rc == 0 && !cJSON_IsArray(list))
		rc = -EBADMSG;
	cJSON_ArrayForEach(row, list)
	{
		if (rc == 0)
			rc = add_release(out, row);
	}
	cJSON_Delete(json);
	if (rc < 0)
		publish_releases_finish(out);
	return rc;
}

void publish_releases_finish(struct publish_releases *releases)
{
	free(releases->list);
	*releases = (struct publish_releases){ 0 };
}

static cJSON *print_releases(const struct publish_releases *releases)
{
	cJSON *json = cJSON_CreateObject(), *list = cJSON_AddArrayToObject(json, "releases");

	for (uint32_t n = 0; n < releases->count; n++) {
		const struct publish_release *one = &releases->list[n];
		cJSON *row = cJSON_CreateObject();

		cJSON_AddNumberToObject(row, "sequence", (double)one->sequence);
		cJSON_AddStringToObject(row, "root", one->root);
		cJSON_AddStringToObject(row, "comment", one->comment);
		cJSON_AddStringToObject(row, "by", one->by);
		cJSON_AddNumberToObject(row, "at", (double)one->at_s);
		json_append(list, row);
	}
	return json;
}

/* ---- the files */

int publish_file_path(char path[PATH_MAX], const char *folder, const char *name)
{
	const char *parts = *name ? "%s/.curator/publish/%s" : "%s/.curator/publish%s";

	return snprintf(path, PATH_MAX, parts, folder, name) < PATH_MAX ? 0 : -ENAMETOOLONG;
}

int publish_files_make(const char *folder, struct diagnostics *diagnostics)
{
	char path[PATH_MAX];
	int rc = accounts_make_folder(folder, diagnostics);

	if (rc < 0)
		return rc;
	rc = publish_file_path(path, folder, "");
	if (rc < 0)
		return diagnostics_add(diagnostics, rc, folder, 0, "%s", strerror(-rc));
	/* The publisher may be another user of the folder's group, which the umask must allow. */
	if (mkdir(path, 0770) < 0 && errno != EEXIST)
		return diagnostics_add(diagnostics, -errno, path, 0, "%s", strerror(errno));
	return 0;
}

static int read_file(struct buffer *out, const char *folder, const char *name)
{
	char path[PATH_MAX];
	int rc = publish_file_path(path, folder, name);

	buffer_init(out, PUBLISH_FILE_BYTES_MAX);
	return rc == 0 ? buffer_read_foreign(out, path) : rc;
}

int publish_request_read(struct publish_request *out, const char *folder)
{
	struct buffer text;
	int rc = read_file(&text, folder, "request.json");

	*out = (struct publish_request){ 0 };
	if (rc == 0)
		rc = publish_request_parse(out, buffer_bytes(&text));
	buffer_finish(&text);
	return rc == -ENOENT ? 0 : rc;
}

int publish_state_read(struct publish_state *out, const char *folder)
{
	struct buffer text;
	int rc = read_file(&text, folder, "state.json");

	*out = (struct publish_state){ 0 };
	if (rc == 0)
		rc = publish_state_parse(out, buffer_bytes(&text));
	buffer_finish(&text);
	return rc == -ENOENT ? 0 : rc;
}

int publish_releases_read(struct publish_releases *out, const char *folder)
{
	struct buffer text;
	int rc = read_file(&text, folder, "releases.json");

	*out = (struct publish_releases){ 0 };
	if (rc == 0)
		rc = publish_releases_parse(out, buffer_bytes(&text));
	buffer_finish(&text);
	return rc == -ENOENT ? 0 : rc;
}

/* json is taken. */
static int write_file(cJSON *json, const char *folder, const char *name)
{
	char path[PATH_MAX], *text = json_indented(json);
	int rc = text ? publish_file_path(path, folder, name) : -ENOMEM;

	if (rc == 0)
		rc = bytes_write_file((struct bytes){ (const uint8_t *)text, strlen(text) }, path);
	cJSON_free(text);
	cJSON_Delete(json);
	return rc;
}

int publish_request_write(const struct publish_request *request, const char *folder)
{
	cJSON *json = cJSON_CreateObject();

	add_request(json, request);
	return write_file(json, folder, "request.json");
}

int publish_state_write(const struct publish_state *state, const char *folder)
{
	return write_file(print_state(state), folder, "state.json");
}

int publish_releases_write(const struct publish_releases *releases, const char *folder)
{
	return write_file(print_releases(releases), folder, "releases.json");
}

void publish_drop_leftovers(const char *folder, const char *name)
{
	char path[PATH_MAX];

	if (publish_file_path(path, folder, name) == 0)
		bytes_drop_leftovers(path);
}

/* ---- the lock */

static int open_lock(const char *folder, int flags)
{
	char path[PATH_MAX];
	int fd, rc = publish_file_path(path, folder, "lock");

	if (rc < 0)
		return rc;
	fd = open(path, flags | O_CLOEXEC | O_NOFOLLOW | O_NONBLOCK, 0644);
	return fd < 0 ? -errno : fd;
}

int publish_lock(const char *folder)
{
	int fd = open_lock(folder, O_RDWR | O_CREAT), rc;

	if (fd < 0 || flock(fd, LOCK_EX | LOCK_NB) == 0)
		return fd;
	rc = errno == EWOULDBLOCK ? -EBUSY : -errno;
	close(fd);
	return rc;
}

bool publish_has_publisher(const char *folder)
{
	int fd = open_lock(folder, O_RDONLY);
	bool has = false;

	if (fd < 0)
		return false;
	has = flock(fd, LOCK_SH | LOCK_NB) < 0 && errno == EWOULDBLOCK;
	close(fd);
	return has;
}
