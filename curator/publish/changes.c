/* Compiles the content's texts as a build would, and compares them with the release's. */
#include "curator/publish/changes.h"

#include <cjson/cJSON.h>
#include <errno.h>
#include <string.h>

#include "base/json_tree.h"
#include "curator/publish/alt_texts.h"
#include "curator/publish/info_difference.h"
#include "format/hash.h"
#include "pipeline/build.h"
#include "pipeline/release/release_look.h"

enum { DATABASE_BYTES_MAX = 16 << 20, SENTENCES_MAX = 500 };

static void add_found(cJSON *json, const struct diagnostics *found)
{
	cJSON *errors = cJSON_AddArrayToObject(json, "errors"),
	      *warnings = cJSON_AddArrayToObject(json, "warnings");

	for (uint32_t n = 0; n < found->count && n < SENTENCES_MAX; n++) {
		const struct diagnostic *one = diagnostics_get(found, n);

		json_append(one->error < 0 ? errors : warnings, cJSON_CreateString(one->text));
	}
}

/* Nothing was published: *before stays empty. */
static int read_before(cJSON *json, struct buffer *before, const struct release_place *place)
{
	struct trust_root trust;
	struct release release = { 0 };
	uint64_t bytes;
	int rc = release_look_trust(&trust, place->folder);

	if (rc == 0)
		rc = release_look_at(&release, place, &trust, 0);
	if (rc == 0)
		rc = release_look_info(before, place->folder, &release, &bytes);
	cJSON_AddNumberToObject(json, "release", (double)release.sequence);
	return rc == -ENOENT && release.sequence == 0 ? 0 : rc;
}

/* The database is one object, so any change of a text fetches it whole. */
static void add_bytes(cJSON *json, const struct buffer *now, const struct buffer *before)
{
	const cJSON *pictures = cJSON_GetObjectItemCaseSensitive(json, "picture_bytes");
	const bool same =
		now->size == before->size && memcmp(now->data, before->data, now->size) == 0;

	cJSON_AddNumberToObject(json, "bytes",
				cJSON_GetNumberValue(pictures) + (same ? 0 : (double)now->size));
}

/* Equal texts, pictures and sounds give the same database, byte by byte. */
static void add_content(cJSON *json, const struct buffer *now)
{
	char hex[HASH_HEX_BYTES];

	hash_to_hex(hash_of(buffer_bytes(now)), hex);
	cJSON_AddStringToObject(json, "content", hex);
}

static int compare(cJSON *json, const struct info_built *built, const struct release_place *place,
		   struct diagnostics *diagnostics)
{
	struct buffer before;
	int rc;

	buffer_init(&before, DATABASE_BYTES_MAX);
	rc = read_before(json, &before, place);
	if (rc == 0)
		rc = info_difference(json, buffer_bytes(&built->database), buffer_bytes(&before));
	if (rc < 0)
		diagnostics_add(diagnostics, rc, place->folder, 0,
				"the release cannot be compared: %s; see gopura-content verify",
				strerror(-rc));
	if (rc == 0) {
		add_bytes(json, &built->database, &before);
		add_content(json, &built->database);
	}
	buffer_finish(&before);
	return rc;
}

static void add_model(cJSON *json, struct scans *scans)
{
	struct master *master;

	build_known_master(&master, scans);
	cJSON_AddStringToObject(json, "model", master ? "same" : "new");
	master_destroy(master);
}

static int find(cJSON *json, const struct content *content, const char *release,
		struct diagnostics *diagnostics)
{
	const struct release_place place = { .folder = release,
					     .target = content->tuf_target,
					     .role = content->tuf_role };
	const struct info_built *built;
	struct sources *sources;
	int rc = sources_create(&sources, content);

	if (rc < 0)
		return diagnostics_add(diagnostics, rc, NULL, 0, "%s", strerror(-rc));
	sources_be_quiet(sources);
	rc = sources_info(sources, &built);
	add_found(json, sources_found(sources));
	alt_texts_find(cJSON_AddArrayToObject(json, "undescribed"), content->folder);
	if (rc == 0) {
		add_model(json, sources_scans(sources));
		rc = compare(json, built, &place, diagnostics);
	} else if (rc == -EINVAL && sources_found(sources)->error_count > 0) {
		rc = 0; /* the errors are the answer */
	} else {
		diagnostics_add(diagnostics, rc, content->folder, 0, "%s", strerror(-rc));
	}
	sources_destroy(sources);
	return rc;
}

/* A temple.ini with faults is content with errors too. */
static int find_without_settings(cJSON *json, int rc, const struct diagnostics *found,
				 struct diagnostics *diagnostics)
{
	if (rc != -EINVAL)
		return diagnostics_add(diagnostics, rc, "temple.ini", 0, "%s",
				       diagnostics_cause(found, rc));
	add_found(json, found);
	return 0;
}

int changes_find(struct cJSON **out, const char *folder, const char *release,
		 struct diagnostics *diagnostics)
{
	struct diagnostics found = { .max = SENTENCES_MAX };
	struct content content;
	int rc = content_read(&content, folder, &found);

	*out = cJSON_CreateObject();
	if (rc < 0)
		rc = find_without_settings(*out, rc, &found, diagnostics);
	else
		rc = find(*out, &content, release, diagnostics);
	diagnostics_finish(&found);
	content_release(&content);
	if (rc < 0) {
		cJSON_Delete(*out);
		*out = NULL;
	}
	return rc;
}
