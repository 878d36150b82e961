/* Targets files, of the top and delegated, and the search for a target in them. */
#include "tuf/targets.h"

#include <cjson/cJSON.h>
#include <errno.h>
#include <fnmatch.h>
#include <inttypes.h>
#include <sodium.h>
#include <stdio.h>
#include <string.h>

#include "tuf/role_files.h"

enum { DELEGATIONS_MAX = 32 }; /* files in one search */

/* ---- one file (section 5.6) */

/* A targets file, and what its delegator says of it. */
struct targets_role {
	const char *name;
	const cJSON *keys, *by;
};

/* Opens a role's targets file: the snapshot's version and hashes, enough signatures, not expired.
 */
static int open_targets(struct tuf_client *client, const struct targets_role *role,
			const cJSON *meta, const struct buffer *bytes, struct tuf_file *out)
{
	int rc;

	if (!tuf_matches(meta, buffer_bytes(bytes)))
		return tuf_refuse(client, -EBADMSG,
				  "%s: not of the length and hashes that the snapshot names",
				  role->name);
	rc = tuf_open_file(client, out, bytes, role->name, TUF_TARGETS, role->keys, role->by);
	if (rc == 0 && out->version != tuf_meta_version(meta))
		rc = tuf_refuse(client, -EBADMSG, "%s version %" PRIu32 " is not the snapshot's",
				role->name, out->version);
	return rc < 0 ? rc : tuf_check_expiry(client, out, role->name);
}

static int take_targets(struct tuf_client *client, const struct targets_role *role,
			struct tuf_file *out)
{
	char name[TUF_NAME_MAX];
	const cJSON *meta = NULL;
	struct buffer bytes;
	uint32_t version;
	int rc;

	if (snprintf(name, sizeof(name), "%s.json", role->name) < (int)sizeof(name))
		meta = tuf_meta(&client->snapshot, name);
	if (!meta)
		return tuf_refuse(client, -ENOENT, "%s: not in the snapshot", role->name);
	rc = tuf_load(client, role->name, TUF_TARGETS_BYTES_MAX, &bytes);
	if (rc == 0)
		rc = open_targets(client, role, meta, &bytes, out);
	buffer_finish(&bytes);
	if (rc == 0)
		return 0;
	tuf_file_finish(out);
	version = tuf_meta_version(meta);
	rc = tuf_fetch(client, role->name, tuf_named_version(client, version),
		       tuf_length(meta, TUF_TARGETS_BYTES_MAX), &bytes);
	if (rc == 0)
		rc = open_targets(client, role, meta, &bytes, out);
	if (rc == 0)
		rc = tuf_store(client, role->name, &bytes);
	buffer_finish(&bytes);
	return rc;
}

int tuf_update_targets(struct tuf_client *client)
{
	const struct targets_role role = { .name = "targets",
					   .keys = tuf_root_keys(&client->root),
					   .by = tuf_root_role(&client->root, TUF_TARGETS) };

	return take_targets(client, &role, &client->targets);
}

/* ---- the search for a target (section 5.6.7) */

/* A wildcard matches no slash, so a pattern has as many as the path. */
static bool matches_path(const cJSON *role, const char *path)
{
	const cJSON *pattern;

	cJSON_ArrayForEach(pattern,
			   cJSON_GetObjectItemCaseSensitive(
				   role, "paths")) if (fnmatch(pattern->valuestring, path,
							       FNM_PATHNAME | FNM_NOESCAPE) ==
						       0) return true;
	return false;
}

static bool matches_prefix(const cJSON *role, const char *path)
{
	uint8_t hash[crypto_hash_sha256_BYTES];
	char hex[2 * sizeof(hash) + 1];
	const cJSON *prefix;

	crypto_hash_sha256(hash, (const uint8_t *)path, strlen(path));
	sodium_bin2hex(hex, sizeof(hex), hash, sizeof(hash));
	cJSON_ArrayForEach(
		prefix,
		cJSON_GetObjectItemCaseSensitive(
			role, "path_hash_prefixes")) if (strncmp(hex, prefix->valuestring,
								 strlen(prefix->valuestring)) ==
							 0) return true;
	return false;
}

/* The files of a search: those looked at, then those to look at, the next one last. Roles and keys
 * are borrowed from the files. */
struct search {
	struct tuf_file file[DELEGATIONS_MAX + 1];
	uint32_t file_count;
	struct targets_role waiting[DELEGATIONS_MAX];
	uint32_t waiting_count;
	const char *seen[DELEGATIONS_MAX + 1];
	uint32_t seen_count;
};

static bool was_seen(const struct search *search, const char *role)
{
	for (uint32_t i = 0; i < search->seen_count; i++)
		if (strcmp(search->seen[i], role) == 0)
			return true;
	return false;
}

/* Adds the roles to which a file delegates the path, so that the first of them comes next; after
 * one that is terminating nothing else does. */
static void add_delegations(struct search *search, const struct tuf_file *file, const char *path)
{
	const cJSON *all = cJSON_GetObjectItemCaseSensitive(file->content, "delegations");
	const cJSON *roles = cJSON_GetObjectItemCaseSensitive(all, "roles"), *role;
	struct targets_role found[DELEGATIONS_MAX];
	uint32_t count = 0;

	cJSON_ArrayForEach(role, roles)
	{
		if (count == DELEGATIONS_MAX ||
		    (!matches_path(role, path) && !matches_prefix(role, path)))
			continue;
		found[count++] = (struct targets_role){
			.name = cJSON_GetStringValue(
				cJSON_GetObjectItemCaseSensitive(role, "name")),
			.keys = cJSON_GetObjectItemCaseSensitive(all, "keys"),
			.by = role,
		};
		if (cJSON_IsTrue(cJSON_GetObjectItemCaseSensitive(role, "terminating"))) {
			search->waiting_count = 0;
			break;
		}
	}
	while (count > 0 && search->waiting_count < DELEGATIONS_MAX)
		search->waiting[search->waiting_count++] = found[--count];
}

static int give(struct tuf_client *client, const cJSON *entry, const char *path,
		struct tuf_target *out)
{
	const cJSON *hashes = cJSON_GetObjectItemCaseSensitive(entry, "hashes");
	const cJSON *hash = cJSON_GetObjectItemCaseSensitive(hashes, "sha256");
	const char *slash = strrchr(path, '/'), *name = slash ? slash + 1 : path;
	int size;

	if (!hash)
		hash = cJSON_GetObjectItemCaseSensitive(hashes, "sha512");
	if (!hash)
		return tuf_refuse(client, -EBADMSG, "target %s: neither sha256 nor sha512", path);
	size = tuf_root_is_consistent(&client->root)
		       ? snprintf(out->file, sizeof(out->file), "%.*s%s.%s", (int)(name - path),
				  path, hash->valuestring, name)
		       : snprintf(out->file, sizeof(out->file), "%s", path);
	if (size >= (int)sizeof(out->file))
		return tuf_refuse(client, -EFBIG, "target %s: its name is too long", path);
	out->length = tuf_length(entry, 0);
	out->entry = cJSON_Duplicate(entry, true);
	return out->entry ? 0 : -ENOMEM;
}

/* Looks into one file, and adds what it delegates. -ENOENT: not there. */
static int look(struct tuf_client *client, struct search *search, const struct tuf_file *file,
		const char *path, struct tuf_target *out)
{
	const cJSON *all = cJSON_GetObjectItemCaseSensitive(file->content, "targets");
	const cJSON *entry = cJSON_GetObjectItemCaseSensitive(all, path);

	if (entry)
		return give(client, entry, path, out);
	add_delegations(search, file, path);
	return -ENOENT;
}

static int find(struct tuf_client *client, struct search *search, const char *path,
		struct tuf_target *out)
{
	int rc = look(client, search, &client->targets, path, out);

	while (rc == -ENOENT && search->waiting_count > 0 && search->file_count < DELEGATIONS_MAX) {
		const struct targets_role role = search->waiting[--search->waiting_count];
		struct tuf_file *file = &search->file[search->file_count];

		if (was_seen(search, role.name))
			continue;
		search->seen[search->seen_count++] = role.name;
		search->file_count++;
		rc = take_targets(client, &role, file);
		if (rc < 0)
			return rc;
		rc = look(client, search, file, path, out);
	}
	return rc == -ENOENT ? tuf_refuse(client, rc, "there is no target %s", path) : rc;
}

int tuf_client_find(struct tuf_client *client, const char *path, struct tuf_target *out)
{
	struct search search = { 0 };
	int rc;

	*out = (struct tuf_target){ 0 };
	if (strlen(path) > TUF_PATH_MAX)
		return tuf_refuse(client, -EFBIG, "the path of a target has at most %d bytes",
				  TUF_PATH_MAX);
	rc = find(client, &search, path, out);
	for (uint32_t i = 0; i < search.file_count; i++)
		tuf_file_finish(&search.file[i]);
	if (rc < 0)
		tuf_target_finish(out);
	return rc;
}

bool tuf_target_is(const struct tuf_target *target, struct bytes file)
{
	return tuf_matches(target->entry, file);
}

void tuf_target_finish(struct tuf_target *target)
{
	cJSON_Delete(target->entry);
	*target = (struct tuf_target){ 0 };
}
