/* A museum that publishes by The Update Framework, in memory, with the files that its server has.
 */
#ifndef GOPURA_TESTS_TUF_MUSEUM_H
#define GOPURA_TESTS_TUF_MUSEUM_H

#include <cjson/cJSON.h>
#include <sodium.h>
#include <stdio.h>
#include <string.h>

#include "format/metadata_sign.h"
#include "tests/check.h"
#include "tuf/sign.h"

enum { NOW_S = 1800000000, FILES_MAX = 32 };

#define LATER_S ((int64_t)4000000000)

static struct signing_key root_key, release_key, timestamp_key, other_key;

/* ---- the repository */

static struct {
	char name[120];
	struct buffer bytes;
} files[FILES_MAX];
static int file_count;
static const char *target_folder = ""; /* of the release, among the targets: "angkor/" */
static int64_t expires_s = LATER_S, issued_s;
static struct buffer release_file; /* the release.json that was published last */

static inline void put(const char *name, struct bytes bytes)
{
	int i = 0;

	while (i < file_count && strcmp(files[i].name, name) != 0)
		i++;
	CHECK(i < FILES_MAX);
	if (i == file_count) {
		snprintf(files[i].name, sizeof(files[i].name), "%s", name);
		buffer_init(&files[i].bytes, 1 << 20);
		file_count++;
	}
	buffer_clear(&files[i].bytes);
	buffer_put(&files[i].bytes, bytes.data, bytes.size);
}

static inline struct bytes file_of(const char *name)
{
	for (int i = 0; i < file_count; i++)
		if (strcmp(files[i].name, name) == 0)
			return buffer_bytes(&files[i].bytes);
	return (struct bytes){ NULL, 0 };
}

/* Takes content. */
static void sign(const char *name, cJSON *content, const struct signing_key *key)
{
	struct tuf_signer signer;
	struct buffer file;

	buffer_init(&file, 1 << 20);
	CHECK(tuf_signer_init(&signer, key->secret) == 0);
	CHECK(tuf_sign(&file, content, &signer, 1) == 0);
	put(name, buffer_bytes(&file));
	buffer_finish(&file);
	cJSON_Delete(content);
}

static void add_role(cJSON *content, const char *name, const struct signing_key *key)
{
	cJSON *role = cJSON_AddObjectToObject(cJSON_GetObjectItem(content, "roles"), name);
	cJSON *keys = cJSON_GetObjectItem(content, "keys");
	struct tuf_signer signer;

	CHECK(tuf_signer_init(&signer, key->secret) == 0);
	cJSON_AddItemToArray(cJSON_AddArrayToObject(role, "keyids"), cJSON_CreateString(signer.id));
	cJSON_AddNumberToObject(role, "threshold", 1);
	if (!cJSON_GetObjectItem(keys, signer.id))
		cJSON_AddItemToObject(keys, signer.id, tuf_signer_key(&signer));
}

/* With the keys of now; signed by root_key. */
static inline void publish_root(uint32_t version)
{
	cJSON *content = tuf_content(TUF_ROOT, version, LATER_S);
	char name[32];

	cJSON_AddObjectToObject(content, "keys");
	cJSON_AddObjectToObject(content, "roles");
	cJSON_AddTrueToObject(content, "consistent_snapshot");
	add_role(content, "root", &root_key);
	add_role(content, "timestamp", &timestamp_key);
	add_role(content, "snapshot", &release_key);
	add_role(content, "targets", &release_key);
	snprintf(name, sizeof(name), "%u.root.json", version);
	sign(name, content, &root_key);
}

static inline void publish_timestamp(uint32_t version, uint32_t snapshot)
{
	cJSON *content = tuf_content(TUF_TIMESTAMP, version, expires_s), *meta;
	char name[32];

	snprintf(name, sizeof(name), "%u.snapshot.json", snapshot);
	meta = cJSON_AddObjectToObject(content, "meta");
	CHECK(tuf_add_file(meta, "snapshot.json", snapshot, file_of(name)));
	if (issued_s)
		cJSON_AddNumberToObject(content, "issued_s", (double)issued_s);
	sign("timestamp.json", content, &timestamp_key);
}

/* Release n, with timestamp n. */
static inline void publish(uint32_t n)
{
	const struct release release = {
		.sequence = n, .expires_s = LATER_S, .root = { { (uint8_t)n } }, .root_bytes = 100
	};
	cJSON *content = tuf_content(TUF_TARGETS, n, LATER_S);
	cJSON *all = cJSON_AddObjectToObject(content, "targets"), *entry;
	char name[120];

	buffer_clear(&release_file);
	CHECK(release_encode(&release_file, &release, &release_key, 1) == 0);
	snprintf(name, sizeof(name), "%srelease.json", target_folder);
	entry = tuf_add_file(all, name, 0, buffer_bytes(&release_file));
	snprintf(name, sizeof(name), "targets/%s%s.release.json", target_folder,
		 cJSON_GetObjectItem(cJSON_GetObjectItem(entry, "hashes"), "sha256")->valuestring);
	put(name, buffer_bytes(&release_file));
	snprintf(name, sizeof(name), "%u.targets.json", n);
	sign(name, content, &release_key);
	content = tuf_content(TUF_SNAPSHOT, n, LATER_S);
	CHECK(tuf_add_file(cJSON_AddObjectToObject(content, "meta"), "targets.json", n,
			   file_of(name)));
	snprintf(name, sizeof(name), "%u.snapshot.json", n);
	sign(name, content, &release_key);
	publish_timestamp(n, n);
}

static inline void make_key(struct signing_key *key)
{
	CHECK(crypto_sign_keypair(key->public_key, key->secret) == 0);
}

/* With keys, and nothing published. */
static inline void museum_open(void)
{
	CHECK(sodium_init() >= 0);
	make_key(&root_key);
	make_key(&release_key);
	make_key(&timestamp_key);
	make_key(&other_key);
	expires_s = LATER_S;
	issued_s = 0;
	buffer_init(&release_file, METADATA_FILE_BYTES_MAX);
}

static inline void museum_close(void)
{
	buffer_finish(&release_file);
	while (file_count > 0)
		buffer_finish(&files[--file_count].bytes);
}

#endif
