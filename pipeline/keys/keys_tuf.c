/* Builds the root's content from the keys and signs it with root.key. */
#include "pipeline/keys/keys_tuf.h"

#include <cjson/cJSON.h>
#include <errno.h>
#include <limits.h>
#include <sodium.h>
#include <stdio.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

#include "base/json_tree.h"
#include "base/log.h"
#include "tuf/sign.h"

enum { ROOT_BYTES_MAX = 64 << 10 };

static bool add_key(cJSON *keys, const struct tuf_signer *signer)
{
	cJSON *key = tuf_signer_key(signer);

	return json_add(keys, signer->id, key);
}

static bool add_role(cJSON *roles, enum tuf_type type, const struct tuf_signer *signer)
{
	cJSON *role = cJSON_AddObjectToObject(roles, tuf_type_names[type]);
	cJSON *id = cJSON_CreateString(signer->id);

	return json_append(cJSON_AddArrayToObject(role, "keyids"), id) &&
	       cJSON_AddNumberToObject(role, "threshold", 1);
}

/* Lets the signer sign snapshots beside those who sign targets, whom it would be useless to keep
 * out. */
static bool share_snapshot(cJSON *content, const struct tuf_signer *snapshot)
{
	cJSON *roles = cJSON_GetObjectItemCaseSensitive(content, "roles");
	const cJSON *targets = cJSON_GetObjectItemCaseSensitive(roles, tuf_type_names[TUF_TARGETS]);
	cJSON *keyids = cJSON_Duplicate(cJSON_GetObjectItemCaseSensitive(targets, "keyids"), true);
	cJSON *role;

	cJSON_DeleteItemFromObjectCaseSensitive(roles, tuf_type_names[TUF_SNAPSHOT]);
	role = cJSON_AddObjectToObject(roles, tuf_type_names[TUF_SNAPSHOT]);
	return json_add(role, "keyids", keyids) &&
	       json_append(keyids, cJSON_CreateString(snapshot->id)) &&
	       cJSON_AddNumberToObject(role, "threshold", 1) &&
	       add_key(cJSON_GetObjectItemCaseSensitive(content, "keys"), snapshot);
}

/* signers: of meta_role; snapshot NULL: nobody else signs snapshots */
static cJSON *make_content(const struct tuf_signer signers[3], const struct tuf_signer *snapshot,
			   int64_t expires_s)
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
	    add_role(roles, TUF_TIMESTAMP, &signers[META_TIMESTAMP]) &&
	    (!snapshot || share_snapshot(content, snapshot)))
		return content;
	cJSON_Delete(content);
	return NULL;
}

/* content is taken; NULL: there was no memory for it. */
static int write_root(const char *folder, uint32_t version, cJSON *content,
		      const struct tuf_signer *root)
{
	char path[PATH_MAX];
	struct buffer file;
	int rc = content ? 0 : -ENOMEM;

	buffer_init(&file, ROOT_BYTES_MAX);
	snprintf(path, sizeof(path), "%s/tuf", folder);
	if (rc == 0 && mkdir(path, 0755) < 0 && errno != EEXIST)
		rc = -errno;
	snprintf(path, sizeof(path), "%s/tuf/%u.root.json", folder, version);
	if (rc == 0)
		rc = tuf_sign(&file, content, root, 1);
	if (rc == 0)
		rc = bytes_write_file(buffer_bytes(&file), path);
	if (rc < 0)
		log_error("pipeline", "%s: %s", path, strerror(-rc));
	buffer_finish(&file);
	cJSON_Delete(content);
	return rc < 0 ? rc : keys_sync_folder(folder);
}

/* ---- the root after the newest one */

static bool has_keyid(const struct tuf_file *root, enum tuf_type type, const char *keyid)
{
	return tuf_role_names(tuf_root_role(root, type), keyid);
}

static cJSON *next_content(const struct tuf_file *last, const struct tuf_signer *snapshot)
{
	cJSON *content = cJSON_Duplicate(last->content, true);
	cJSON *keys = cJSON_GetObjectItemCaseSensitive(content, "keys");

	cJSON_DeleteItemFromObjectCaseSensitive(content, "version");
	cJSON_DeleteItemFromObjectCaseSensitive(keys, snapshot->id);
	if (!cJSON_AddNumberToObject(content, "version", last->version + 1) ||
	    !share_snapshot(content, snapshot)) {
		cJSON_Delete(content);
		return NULL;
	}
	tuf_drop_unused_keys(keys, cJSON_GetObjectItemCaseSensitive(content, "roles"));
	return content;
}

/* Makes the root that names the snapshot's key, unless the last one does. */
static int write_next(const char *folder, uint32_t last_version, const struct tuf_signer *root,
		      const struct tuf_signer *snapshot)
{
	struct tuf_file last = { 0 };
	const char *why = "cannot be read";
	struct buffer file;
	int rc;

	buffer_init(&file, ROOT_BYTES_MAX);
	rc = keys_read_tuf_root(&file, folder, last_version);
	if (rc == 0)
		rc = tuf_root_first(&last, buffer_bytes(&file), &why);
	if (rc == 0 &&
	    (!has_keyid(&last, TUF_ROOT, root->id) ||
	     cJSON_GetObjectItemCaseSensitive(tuf_root_role(&last, TUF_ROOT), "threshold")
			     ->valueint != 1)) {
		rc = -EKEYREJECTED;
		why = "root.key alone may not sign the root after this one: let the tools that "
		      "made it add snapshot.key to the keys of the snapshot";
	}
	if (rc < 0)
		log_error("pipeline", "%s/tuf/%u.root.json: %s", folder, last_version, why);
	else if (!has_keyid(&last, TUF_SNAPSHOT, snapshot->id))
		rc = write_root(folder, last_version + 1, next_content(&last, snapshot), root);
	tuf_file_finish(&last);
	buffer_finish(&file);
	return rc;
}

/* ---- */

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

/* snapshot NULL: as make_content has it. */
static int make_root(const char *folder, const struct publisher_keys *keys,
		     const struct tuf_signer *snapshot)
{
	struct tuf_signer signers[3] = { 0 };
	struct signing_key root = { 0 };
	uint32_t last;
	int rc = keys_last_tuf_root(&last, folder);

	if (rc < 0)
		return rc;
	rc = keys_read_key(&root, folder, "root");
	if (rc == -ENOENT)
		log_error("pipeline",
			  "%s/root.key: not here; bring it back for this one command, since it "
			  "signs who may sign",
			  folder);
	if (rc == 0)
		rc = make_signers(signers, keys, &root);
	if (rc == 0 && last > 0)
		rc = write_next(folder, last, &signers[META_ROOT], snapshot);
	else if (rc == 0)
		rc = write_root(folder, 1, make_content(signers, snapshot, keys->trust.expires_s),
				&signers[META_ROOT]);
	sodium_memzero(&root, sizeof(root));
	sodium_memzero(signers, sizeof(signers));
	return rc;
}

int keys_make_tuf_root(const char *folder, const struct publisher_keys *keys)
{
	struct buffer file;
	int rc;

	buffer_init(&file, ROOT_BYTES_MAX);
	rc = keys_read_tuf_root(&file, folder, 1);
	buffer_finish(&file);
	if (rc < 0 && rc != -ENOENT)
		log_error("pipeline", "%s/tuf/1.root.json: %s", folder, strerror(-rc));
	return rc == -ENOENT ? make_root(folder, keys, NULL) : rc;
}

/* Returns whether the newest root names the key already, so that root.key is not needed. */
static bool is_shared(const char *folder, const struct tuf_signer *snapshot)
{
	struct tuf_file last = { 0 };
	struct buffer file;
	uint32_t version;
	const char *why;
	bool is = false;

	buffer_init(&file, ROOT_BYTES_MAX);
	if (keys_last_tuf_root(&version, folder) == 0 &&
	    keys_read_tuf_root(&file, folder, version) == 0 &&
	    tuf_root_first(&last, buffer_bytes(&file), &why) == 0)
		is = has_keyid(&last, TUF_SNAPSHOT, snapshot->id);
	tuf_file_finish(&last);
	buffer_finish(&file);
	return is;
}

int keys_make_museum_root(const char *folder, const struct publisher_keys *keys)
{
	struct tuf_signer snapshot = { 0 };
	struct signing_key key = { 0 };
	int rc = keys_named(&key, folder, tuf_type_names[TUF_SNAPSHOT]);

	if (rc == 0)
		rc = tuf_signer_init(&snapshot, key.secret);
	if (rc == 0 && !is_shared(folder, &snapshot))
		rc = make_root(folder, keys, &snapshot);
	sodium_memzero(&key, sizeof(key));
	tuf_signer_finish(&snapshot);
	return rc;
}

int keys_read_tuf_root(struct buffer *out, const char *folder, uint32_t version)
{
	char path[PATH_MAX];

	if (snprintf(path, sizeof(path), "%s/tuf/%u.root.json", folder, version) >= PATH_MAX)
		return -ENAMETOOLONG;
	return buffer_read_file(out, path);
}

int keys_last_tuf_root(uint32_t *out, const char *folder)
{
	char path[PATH_MAX];
	uint32_t version = 0;

	*out = 0;
	do
		snprintf(path, sizeof(path), "%s/tuf/%u.root.json", folder, ++version);
	while (access(path, F_OK) == 0);
	if (errno != ENOENT) {
		const int rc = -errno;

		log_error("pipeline", "%s: %s", path, strerror(-rc));
		return rc;
	}
	*out = version - 1;
	return 0;
}
