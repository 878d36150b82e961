/* Builds the root's content from the three keys and signs it with the first. */
#include "pipeline/keys/keys_tuf.h"

#include <cjson/cJSON.h>
#include <errno.h>
#include <limits.h>
#include <sodium.h>
#include <stdio.h>
#include <string.h>
#include <sys/stat.h>

#include "base/log.h"
#include "tuf/sign.h"

enum { ROOT_BYTES_MAX = 64 << 10 };

static bool add_key(cJSON *keys, const struct tuf_signer *signer)
{
	cJSON *key = tuf_signer_key(signer);

	return key && cJSON_AddItemToObject(keys, signer->id, key);
}

static bool add_role(cJSON *roles, enum tuf_type type, const struct tuf_signer *signer)
{
	cJSON *role = cJSON_AddObjectToObject(roles, tuf_type_names[type]);
	cJSON *id = cJSON_CreateString(signer->id);

	return cJSON_AddItemToArray(cJSON_AddArrayToObject(role, "keyids"), id) &&
	       cJSON_AddNumberToObject(role, "threshold", 1);
}

/* signers: of meta_role */
static cJSON *make_content(const struct tuf_signer signers[3], int64_t expires_s)
{
	cJSON *content = tuf_content(TUF_ROOT, 1, expires_s);
	cJSON *keys = cJSON_AddObjectToObject(content, "keys");
	cJSON *roles = cJSON_AddObjectToObject(content, "roles");

	if (cJSON_AddTrueToObject(content, "consistent_snapshot") &&
	    add_key(keys, &signers[META_ROOT]) && add_key(keys, &signers[META_RELEASE]) &&
	    add_key(keys, &signers[META_TIMESTAMP]) &&
	    add_role(roles, TUF_ROOT, &signers[META_ROOT]) &&
	    add_role(roles, TUF_TARGETS, &signers[META_RELEASE]) &&
	    add_role(roles, TUF_SNAPSHOT, &signers[META_RELEASE]) &&
	    add_role(roles, TUF_TIMESTAMP, &signers[META_TIMESTAMP]))
		return content;
	cJSON_Delete(content);
	return NULL;
}

static int write_root(const char *path, const struct tuf_signer signers[3], int64_t expires_s)
{
	cJSON *content = make_content(signers, expires_s);
	struct buffer file;
	int rc;

	buffer_init(&file, ROOT_BYTES_MAX);
	rc = content ? tuf_sign(&file, content, &signers[META_ROOT], 1) : -ENOMEM;
	if (rc == 0)
		rc = bytes_write_file(buffer_bytes(&file), path);
	if (rc < 0)
		log_error("pipeline", "%s: %s", path, strerror(-rc));
	buffer_finish(&file);
	cJSON_Delete(content);
	return rc;
}

/* The first 32 bytes of a secret key of libsodium are its seed. */
static int make_signers(struct tuf_signer signers[3], const struct publisher_keys *keys,
			const struct signing_key *root)
{
	int rc = tuf_signer_init(&signers[META_ROOT], root->secret);

	if (rc == 0)
		rc = tuf_signer_init(&signers[META_RELEASE], keys->release.secret);
	if (rc == 0)
		rc = tuf_signer_init(&signers[META_TIMESTAMP], keys->timestamp.secret);
	return rc;
}

int keys_make_tuf_root(const char *folder, const struct publisher_keys *keys)
{
	struct tuf_signer signers[3] = { 0 };
	struct signing_key root = { 0 };
	char path[PATH_MAX];
	struct buffer file;
	int rc;

	buffer_init(&file, ROOT_BYTES_MAX);
	snprintf(path, sizeof(path), "%s/tuf/1.root.json", folder);
	rc = keys_read_tuf_root(&file, folder, 1);
	buffer_finish(&file);
	if (rc < 0 && rc != -ENOENT)
		log_error("pipeline", "%s: %s", path, strerror(-rc));
	if (rc != -ENOENT)
		return rc;
	rc = keys_read_root_key(&root, folder);
	if (rc == -ENOENT)
		log_error("pipeline",
			  "%s/root.key: not here; bring it back for this one command, since it "
			  "signs who may sign",
			  folder);
	if (rc == 0)
		rc = make_signers(signers, keys, &root);
	snprintf(path, sizeof(path), "%s/tuf", folder);
	if (rc == 0 && mkdir(path, 0755) < 0 && errno != EEXIST) {
		rc = -errno;
		log_error("pipeline", "%s: %s", path, strerror(-rc));
	}
	snprintf(path, sizeof(path), "%s/tuf/1.root.json", folder);
	if (rc == 0)
		rc = write_root(path, signers, keys->trust.expires_s);
	if (rc == 0)
		rc = keys_sync_folder(folder);
	sodium_memzero(&root, sizeof(root));
	sodium_memzero(signers, sizeof(signers));
	return rc;
}

int keys_read_tuf_root(struct buffer *out, const char *folder, uint32_t version)
{
	char path[PATH_MAX];

	if (snprintf(path, sizeof(path), "%s/tuf/%u.root.json", folder, version) >= PATH_MAX)
		return -ENAMETOOLONG;
	return buffer_read_file(out, path);
}

uint32_t keys_last_tuf_root(const char *folder)
{
	struct buffer file;
	uint32_t version = 1;

	buffer_init(&file, ROOT_BYTES_MAX);
	while (keys_read_tuf_root(&file, folder, version) == 0)
		version++;
	buffer_finish(&file);
	return version - 1;
}
