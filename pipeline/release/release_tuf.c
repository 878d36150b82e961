/* Makes targets, snapshot and timestamp one from another. */
#include "pipeline/release/release_tuf.h"

#include <cjson/cJSON.h>
#include <errno.h>
#include <inttypes.h>
#include <limits.h>
#include <stdio.h>
#include <string.h>
#include <sys/stat.h>

#include "base/clock.h"
#include "base/log.h"
#include "pipeline/keys/keys_tuf.h"
#include "pipeline/release/release_files.h"
#include "tuf/sign.h"

enum { FILE_BYTES_MAX = 64 << 10 };

static int complain(const char *release, const char *name, int rc)
{
	log_error("pipeline", "%s/%s: %s", release, name, strerror(-rc));
	return rc;
}

static int make_folder(const char *release, const char *name)
{
	char path[PATH_MAX];

	snprintf(path, sizeof(path), "%s/%s", release, name);
	return mkdir(path, 0755) < 0 && errno != EEXIST ? complain(release, name, -errno) : 0;
}

static int read_file(struct buffer *out, const char *release, const char *name)
{
	char path[PATH_MAX];

	if (snprintf(path, sizeof(path), "%s/%s", release, name) >= (int)sizeof(path))
		return -ENAMETOOLONG;
	return buffer_read_file(out, path);
}

/* Signs a content, which is freed, into *file, cleared first, and writes it under that name. */
static int put(const char *release, const char *name, struct buffer *file, cJSON *content,
	       const struct signing_key *key)
{
	struct tuf_signer signer;
	int rc = content ? tuf_signer_init(&signer, key->secret) : -ENOMEM;

	buffer_clear(file);
	if (rc == 0)
		rc = tuf_sign(file, content, &signer, 1);
	tuf_signer_finish(&signer);
	cJSON_Delete(content);
	return rc < 0 ? complain(release, name, rc)
		      : release_files_put(release, name, buffer_bytes(file));
}

static cJSON *drop_unless(cJSON *content, bool whole)
{
	if (whole)
		return content;
	cJSON_Delete(content);
	return NULL;
}

/* ---- the files, from the target up */

static cJSON *targets_of(const struct release *what, struct bytes release_file)
{
	cJSON *content = tuf_content(TUF_TARGETS, (uint32_t)what->sequence, what->expires_s);
	cJSON *all = cJSON_AddObjectToObject(content, "targets");
	cJSON *target = tuf_add_file(all, "release.json", 0, release_file);
	cJSON *custom = cJSON_AddObjectToObject(target, "custom");
	char root[HASH_HEX_BYTES];

	hash_to_hex(what->root, root);
	return drop_unless(content, cJSON_AddStringToObject(custom, "root_page", root) &&
					    cJSON_AddNumberToObject(custom, "root_page_bytes",
								    what->root_bytes));
}

static cJSON *naming(enum tuf_type type, uint32_t version, int64_t expires_s, const char *name,
		     uint32_t named, struct bytes file)
{
	cJSON *content = tuf_content(type, version, expires_s);
	cJSON *meta = cJSON_AddObjectToObject(content, "meta");

	return drop_unless(content, tuf_add_file(meta, name, named, file) != NULL);
}

static int copy_roots(const char *release, const char *keys_folder, struct buffer *file)
{
	char name[64];
	int rc = 0;

	for (uint32_t version = 1; rc == 0; version++) {
		rc = keys_read_tuf_root(file, keys_folder, version);
		snprintf(name, sizeof(name), "tuf/%" PRIu32 ".root.json", version);
		if (rc == -ENOENT)
			return 0;
		rc = rc < 0 ? complain(keys_folder, name, rc)
			    : release_files_put(release, name, buffer_bytes(file));
	}
	return rc;
}

/* tuf/targets/SHA256.release.json; target: its entry */
static int put_target(const char *release, const cJSON *targets, struct bytes release_file)
{
	const cJSON *all = cJSON_GetObjectItem(targets, "targets");
	const cJSON *hashes =
		cJSON_GetObjectItem(cJSON_GetObjectItem(all, "release.json"), "hashes");
	char name[128];

	snprintf(name, sizeof(name), "tuf/targets/%s.release.json",
		 cJSON_GetObjectItem(hashes, "sha256")->valuestring);
	return release_files_put(release, name, release_file);
}

/* Returns the version after that of the present timestamp; *snapshot is set to the version that it
 * names. Without one: 1, and 0. */
static uint32_t next_timestamp(const char *release, struct buffer *file, uint32_t *snapshot)
{
	struct tuf_file timestamp = { 0 };
	const char *why;
	uint32_t version = 0;

	*snapshot = 0;
	if (read_file(file, release, "tuf/timestamp.json") == 0 &&
	    tuf_file_parse(&timestamp, buffer_bytes(file), TUF_TIMESTAMP, &why) == 0) {
		version = timestamp.version;
		*snapshot = tuf_meta_version(tuf_meta(&timestamp, "snapshot.json"));
	}
	tuf_file_finish(&timestamp);
	return version + 1;
}

/* Names a snapshot, whose bytes are in *file. */
static int put_timestamp(const char *release, const struct publisher_keys *keys, uint32_t version,
			 uint32_t snapshot, struct buffer *file, int64_t life_s)
{
	const int64_t now_s = clock_wall_s();
	cJSON *content = naming(TUF_TIMESTAMP, version, now_s + life_s, "snapshot.json", snapshot,
				buffer_bytes(file));

	/* A member of ours, which other clients ignore: terminals know then that it is not earlier.
	 */
	if (content && !cJSON_AddNumberToObject(content, "issued_s", (double)now_s))
		content = drop_unless(content, false);
	return put(release, "tuf/timestamp.json", file, content, &keys->timestamp);
}

/* Reads the snapshot of a version, if there is one. */
static bool has_snapshot(const char *release, uint32_t version, struct buffer *file)
{
	char name[64];

	snprintf(name, sizeof(name), "tuf/%" PRIu32 ".snapshot.json", version);
	return read_file(file, release, name) == 0;
}

/* Leaves the snapshot's bytes in *file. */
static int put_new(const char *release, const struct publisher_keys *keys,
		   const struct release *what, struct bytes release_file, struct buffer *file)
{
	const uint32_t version = (uint32_t)what->sequence;
	cJSON *targets = targets_of(what, release_file);
	char name[64];
	int rc = targets ? put_target(release, targets, release_file)
			 : complain(release, "tuf", -ENOMEM);

	snprintf(name, sizeof(name), "tuf/%" PRIu32 ".targets.json", version);
	if (rc < 0)
		cJSON_Delete(targets);
	else
		rc = put(release, name, file, targets, &keys->release);
	snprintf(name, sizeof(name), "tuf/%" PRIu32 ".snapshot.json", version);
	if (rc == 0)
		rc = put(release, name, file,
			 naming(TUF_SNAPSHOT, version, what->expires_s, "targets.json", version,
				buffer_bytes(file)),
			 &keys->release);
	return rc;
}

static int put_all(const char *release, const struct publisher_keys *keys,
		   const struct release *what, struct bytes release_file, int64_t life_s,
		   struct buffer *file)
{
	const uint32_t version = (uint32_t)what->sequence;
	uint32_t before, next = next_timestamp(release, file, &before);
	int rc = 0;

	if (what->sequence > UINT32_MAX)
		return complain(release, "tuf", -ERANGE);
	/* A publisher that was killed may have left a timestamp of the release before. */
	if (before != version || !has_snapshot(release, version, file))
		rc = put_new(release, keys, what, release_file, file);
	return rc < 0 ? rc : put_timestamp(release, keys, next, version, file, life_s);
}

int release_tuf_write(const char *release, const char *keys_folder,
		      const struct publisher_keys *keys, const struct release *what,
		      int64_t timestamp_life_s)
{
	struct buffer file, release_file;
	int rc;

	buffer_init(&file, FILE_BYTES_MAX);
	buffer_init(&release_file, METADATA_FILE_BYTES_MAX);
	rc = keys_read_tuf_root(&file, keys_folder, 1);
	if (rc == -ENOENT) {
		buffer_finish(&file);
		return 0;
	}
	if (rc == 0 && (rc = read_file(&release_file, release, "release.json")) < 0)
		complain(release, "release.json", rc);
	if (rc == 0)
		rc = make_folder(release, "tuf");
	if (rc == 0)
		rc = make_folder(release, "tuf/targets");
	if (rc == 0)
		rc = copy_roots(release, keys_folder, &file);
	if (rc == 0)
		rc = put_all(release, keys, what, buffer_bytes(&release_file), timestamp_life_s,
			     &file);
	buffer_finish(&release_file);
	buffer_finish(&file);
	return rc;
}
