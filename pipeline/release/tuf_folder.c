/* Follows the files of a release folder: timestamp, snapshot, targets, the role's targets. */
#include "pipeline/release/tuf_folder.h"

#include <cjson/cJSON.h>
#include <errno.h>
#include <fnmatch.h>
#include <inttypes.h>
#include <limits.h>
#include <stdio.h>
#include <string.h>

#include "base/log.h"
#include "base/transient.h"
#include "pipeline/keys/keys_tuf.h"

/* ---- where */

const char *tuf_folder_target(const struct tuf_place *place)
{
	return place->target && *place->target ? place->target : "release.json";
}

static bool has_role(const struct tuf_folder *folder)
{
	return folder->place.role && *folder->place.role;
}

const struct tuf_file *tuf_folder_naming(const struct tuf_folder *folder)
{
	return has_role(folder) ? &folder->own : &folder->top;
}

uint32_t tuf_folder_naming_version(const struct tuf_folder *folder)
{
	return has_role(folder) ? folder->own_version : folder->top_version;
}

const char *tuf_folder_naming_name(const struct tuf_folder *folder)
{
	return has_role(folder) ? folder->place.role : tuf_type_names[TUF_TARGETS];
}

/* ---- files */

static int complain(const struct tuf_folder *folder, const char *name, int rc, const char *why)
{
	log_error("pipeline", "%s/%s: %s", folder->place.release, name, why);
	return rc;
}

static int read_file(const struct tuf_folder *folder, const char *name, struct buffer *out)
{
	char path[PATH_MAX];
	int rc = -ENAMETOOLONG;

	if (snprintf(path, sizeof(path), "%s/%s", folder->place.release, name) < (int)sizeof(path))
		rc = buffer_read_file(out, path);
	return rc < 0 && rc != -ENOENT ? complain(folder, name, rc, strerror(-rc)) : rc;
}

/* *out stays empty where there is no such file. */
static int parse(const struct tuf_folder *folder, const char *name, enum tuf_type type,
		 struct tuf_file *out)
{
	const char *why = "no memory";
	struct buffer file;
	int rc;

	buffer_init(&file, TUF_FOLDER_FILE_BYTES_MAX);
	rc = read_file(folder, name, &file);
	if (rc == 0 && (rc = tuf_file_parse(out, buffer_bytes(&file), type, &why)) < 0)
		complain(folder, name, rc, why);
	buffer_finish(&file);
	return rc == -ENOENT ? 0 : rc;
}

/* Parses a version of a role's file; 0: none. It must be there if is_named, by the file before it.
 */
static int parse_version(const struct tuf_folder *folder, uint64_t version, const char *role,
			 enum tuf_type type, bool is_named, struct tuf_file *out)
{
	char name[PATH_MAX];
	int rc;

	if (version == 0)
		return 0;
	snprintf(name, sizeof(name), "tuf/%" PRIu64 ".%s.json", version, role);
	rc = parse(folder, name, type, out);
	return rc == 0 && is_named && !out->json
		       ? complain(
				 folder, name, -EBADMSG,
				 "is missing, and terminals ask for it: bring it back from another "
				 "copy of this folder, or see docs/release.md, From a backup")
		       : rc;
}

/* ---- the chain */

/* Each root must be signed by the keys of the one before it, and by its own. */
static int follow_root(struct tuf_folder *folder, struct bytes bytes, const char **why)
{
	struct tuf_file next = { 0 };
	int rc = tuf_root_first(&next, bytes, why);

	if (rc == 0 && folder->root.json) {
		rc = tuf_file_verify(&next, tuf_root_keys(&folder->root),
				     tuf_root_role(&folder->root, TUF_ROOT));
		*why = "not signed by the root before it";
	}
	if (rc == 0 && folder->root.json && next.version != folder->root.version + 1) {
		rc = -EBADMSG;
		*why = "says that it is another version";
	}
	if (rc < 0) {
		tuf_file_finish(&next);
		return rc;
	}
	tuf_file_finish(&folder->root);
	folder->root = next;
	return 0;
}

/* The release folder may have later roots than the keys' folder, after an exchange of keys that was
 * made elsewhere. Terminals follow them, so they say which keys may sign. */
static int follow_published(struct tuf_folder *folder)
{
	const struct tuf_place *place = &folder->place;
	const uint32_t last = folder->root.version;
	const char *why = "cannot be read";
	struct buffer file;
	int rc;

	buffer_init(&file, TUF_FOLDER_FILE_BYTES_MAX);
	while ((rc = keys_read_tuf_root(&file, place->release, folder->root.version + 1)) == 0 &&
	       (rc = follow_root(folder, buffer_bytes(&file), &why)) == 0)
		;
	buffer_finish(&file);
	folder->is_ahead = folder->root.version > last;
	if (rc == -ENOENT)
		return 0;
	if (is_transient(rc))
		return complain(folder, "tuf", rc, strerror(-rc));
	log_warn("pipeline", "%s/tuf/%" PRIu32 ".root.json: %s; terminals refuse it: remove it",
		 place->release, folder->root.version + 1, why);
	return 0;
}

static int open_root(struct tuf_folder *folder)
{
	const char *why = "cannot be read";
	struct buffer file;
	uint32_t version = 1;
	int rc;

	buffer_init(&file, TUF_FOLDER_FILE_BYTES_MAX);
	while ((rc = keys_read_tuf_root(&file, folder->place.keys_folder, version)) == 0 &&
	       (rc = follow_root(folder, buffer_bytes(&file), &why)) == 0)
		version++;
	buffer_finish(&file);
	if (rc == -ENOENT && version > 1)
		return follow_published(folder);
	if (rc == -ENOENT)
		why = "is not there; make it with `gopura-content keys DIR --tuf`, or put your own "
		      "there";
	log_error("pipeline", "%s/tuf/%" PRIu32 ".root.json: %s", folder->place.keys_folder,
		  version, why);
	return rc;
}

/* The version that the snapshot gives a role's file; 0: none. */
static uint32_t snapshot_version(const struct tuf_folder *folder, const char *role)
{
	const cJSON *meta;
	char name[PATH_MAX];

	snprintf(name, sizeof(name), "%s.json", role);
	meta = folder->snapshot.json ? tuf_meta(&folder->snapshot, name) : NULL;
	return meta ? tuf_meta_version(meta) : 0;
}

/* Returns whether the keys of an earlier root signed a file. */
static bool was_signed(const struct tuf_folder *folder, const struct tuf_file *file,
		       enum tuf_type type)
{
	const char *why;
	struct buffer bytes;
	bool was = false;

	buffer_init(&bytes, TUF_FOLDER_FILE_BYTES_MAX);
	for (uint32_t version = folder->root.version; !was && --version > 0;) {
		struct tuf_file root = { 0 };

		was = (keys_read_tuf_root(&bytes, folder->place.keys_folder, version) == 0 ||
		       keys_read_tuf_root(&bytes, folder->place.release, version) == 0) &&
		      tuf_file_parse(&root, buffer_bytes(&bytes), TUF_ROOT, &why) == 0 &&
		      tuf_file_verify(file, tuf_root_keys(&root), tuf_root_role(&root, type)) == 0;
		tuf_file_finish(&root);
	}
	buffer_finish(&bytes);
	return was;
}

static bool has_more_than_one_release(const struct tuf_file *file)
{
	const cJSON *targets = cJSON_GetObjectItemCaseSensitive(file->content, "targets");

	return cJSON_GetArraySize(targets) > 1 ||
	       cJSON_GetObjectItemCaseSensitive(file->content, "delegations");
}

bool tuf_folder_needs_renewal(const struct tuf_folder *folder)
{
	return folder->top.json && !folder->top_is_signed &&
	       has_more_than_one_release(&folder->top);
}

/* Drops a targets file that is signed by none of the keys that may do so, if nothing is lost with
 * it but one release: the keys may have changed. */
static int check_targets(struct tuf_folder *folder, struct tuf_file *file, const char *name,
			 const cJSON *keys, const cJSON *role)
{
	int rc = file->json ? tuf_file_verify(file, keys, role) : 0;

	if (rc == 0)
		return 0;
	if (has_more_than_one_release(file))
		return complain(folder, name, rc,
				"the last one is not signed with the keys of the newest root, and "
				"it has more than this release: sign it with these keys first");
	log_warn("pipeline",
		 "%s/tuf: the last %s is not signed with the keys of the newest root, and counts "
		 "for nothing",
		 folder->place.release, name);
	tuf_file_finish(file);
	return 0;
}

static bool is_signed(const struct tuf_folder *folder, const struct tuf_file *file,
		      enum tuf_type type)
{
	return tuf_file_verify(file, tuf_root_keys(&folder->root),
			       tuf_root_role(&folder->root, type)) == 0;
}

static int open_top(struct tuf_folder *folder)
{
	int rc;

	folder->top_version = snapshot_version(folder, "targets");
	rc = parse_version(folder, folder->top_version, "targets", TUF_TARGETS, true, &folder->top);
	folder->top_is_signed =
		rc == 0 && folder->top.json && is_signed(folder, &folder->top, TUF_TARGETS);
	if (rc < 0 || !folder->top.json || folder->top_is_signed)
		return rc;
	if (!was_signed(folder, &folder->top, TUF_TARGETS))
		return check_targets(folder, &folder->top, "targets.json",
				     tuf_root_keys(&folder->root),
				     tuf_root_role(&folder->root, TUF_TARGETS));
	log_warn("pipeline",
		 "%s/tuf: the last targets.json is signed with a key that was exchanged since%s",
		 folder->place.release,
		 tuf_folder_needs_renewal(folder) ? "" : ", so only its number counts");
	return 0;
}

const cJSON *tuf_folder_delegations(const struct tuf_folder *folder)
{
	return cJSON_GetObjectItemCaseSensitive(folder->top.content, "delegations");
}

cJSON *tuf_folder_role_in(const cJSON *delegations, const char *name)
{
	cJSON *role;

	cJSON_ArrayForEach(role, cJSON_GetObjectItemCaseSensitive(delegations, "roles"))
	{
		if (strcmp(cJSON_GetStringValue(cJSON_GetObjectItemCaseSensitive(role, "name")),
			   name) == 0)
			return role;
	}
	return NULL;
}

/* As terminals judge it: docs/tuf.md. */
bool tuf_folder_role_has_path(const cJSON *role, const char *target)
{
	const cJSON *paths = cJSON_GetObjectItemCaseSensitive(role, "paths"), *pattern;

	cJSON_ArrayForEach(pattern, paths)
	{
		if (fnmatch(pattern->valuestring, target, FNM_PATHNAME | FNM_NOESCAPE) == 0)
			return true;
	}
	return !paths; /* by hashes of paths: terminals will tell */
}

void tuf_folder_naming_keys(const struct tuf_folder *folder, const cJSON **keys, const cJSON **role)
{
	if (has_role(folder)) {
		*keys = cJSON_GetObjectItemCaseSensitive(tuf_folder_delegations(folder), "keys");
		*role = tuf_folder_role_in(tuf_folder_delegations(folder), folder->place.role);
	} else {
		*keys = tuf_root_keys(&folder->root);
		*role = tuf_root_role(&folder->root, TUF_TARGETS);
	}
}

int tuf_folder_read_role(const struct tuf_folder *folder, const char *name, struct tuf_file *out,
			 uint32_t *version)
{
	*out = (struct tuf_file){ .json = NULL };
	*version = snapshot_version(folder, name);
	return parse_version(folder, *version, name, TUF_TARGETS, true, out);
}

static int open_own(struct tuf_folder *folder)
{
	const cJSON *keys, *role;
	int rc;

	tuf_folder_naming_keys(folder, &keys, &role);
	if (!role || !tuf_folder_role_has_path(role, tuf_folder_target(&folder->place))) {
		log_error("pipeline",
			  "%s/tuf: targets.json does not delegate the path to %s; the museum has "
			  "to add that role with your keys (gopura-content delegate) and the path "
			  "%s",
			  folder->place.release, folder->place.role,
			  tuf_folder_target(&folder->place));
		return -ENOENT;
	}
	rc = tuf_folder_read_role(folder, folder->place.role, &folder->own, &folder->own_version);
	return rc < 0 ? rc : check_targets(folder, &folder->own, folder->place.role, keys, role);
}

int tuf_folder_open(struct tuf_folder *out, const struct tuf_place *place)
{
	const cJSON *meta;
	int rc;

	*out = (struct tuf_folder){ .place = *place };
	rc = open_root(out);
	if (rc == 0)
		rc = parse(out, "tuf/timestamp.json", TUF_TIMESTAMP, &out->timestamp);
	meta = out->timestamp.json ? tuf_meta(&out->timestamp, "snapshot.json") : NULL;
	if (rc == 0 && meta)
		rc = parse_version(out, tuf_meta_version(meta), "snapshot", TUF_SNAPSHOT, true,
				   &out->snapshot);
	out->snapshot_is_signed =
		rc == 0 && out->snapshot.json && is_signed(out, &out->snapshot, TUF_SNAPSHOT);
	out->snapshot_was_signed = rc == 0 && out->snapshot.json && !out->snapshot_is_signed &&
				   was_signed(out, &out->snapshot, TUF_SNAPSHOT);
	if (rc == 0)
		rc = open_top(out);
	return rc == 0 && has_role(out) ? open_own(out) : rc;
}

int64_t tuf_folder_issued_s(const struct tuf_folder *folder)
{
	return folder->timestamp.json && is_signed(folder, &folder->timestamp, TUF_TIMESTAMP)
		       ? tuf_issued_s(&folder->timestamp)
		       : 0;
}

void tuf_folder_finish(struct tuf_folder *folder)
{
	tuf_file_finish(&folder->root);
	tuf_file_finish(&folder->timestamp);
	tuf_file_finish(&folder->snapshot);
	tuf_file_finish(&folder->top);
	tuf_file_finish(&folder->own);
}

/* ---- releases */

static int read_named(const struct tuf_folder *folder, const struct tuf_file *naming,
		      struct release *out, struct buffer *file)
{
	const char *path = tuf_folder_target(&folder->place), *slash = strrchr(path, '/');
	const int before = slash ? (int)(slash + 1 - path) : 0;
	const cJSON *all = cJSON_GetObjectItemCaseSensitive(naming->content, "targets");
	const cJSON *entry = cJSON_GetObjectItemCaseSensitive(all, path);
	const cJSON *hash = cJSON_GetObjectItemCaseSensitive(
		cJSON_GetObjectItemCaseSensitive(entry, "hashes"), "sha256");
	const char *why = "not the target that was signed";
	char name[PATH_MAX];
	int rc;

	if (!entry)
		return -ENOENT;
	if (!hash)
		return complain(folder, path, -EBADMSG, "its target has no sha256");
	snprintf(name, sizeof(name), "tuf/targets/%.*s%s.%s", before, path, hash->valuestring,
		 path + before);
	rc = read_file(folder, name, file);
	if (rc < 0)
		return rc == -ENOENT ? complain(folder, name, -EBADMSG, "is missing") : rc;
	rc = tuf_matches(entry, buffer_bytes(file))
		     ? release_decode_target(out, buffer_bytes(file), &why)
		     : -EBADMSG;
	return rc < 0 ? complain(folder, name, rc, why) : 0;
}

int tuf_folder_current(const struct tuf_folder *folder, struct release *out, struct buffer *file)
{
	const struct tuf_file *naming = tuf_folder_naming(folder);
	int rc;

	*out = (struct release){ 0 };
	rc = naming->json ? read_named(folder, naming, out, file) : -ENOENT;
	return rc == 0 && !has_role(folder) && !folder->top_is_signed ? -ENOENT : rc;
}

int tuf_folder_at(const struct tuf_folder *folder, uint64_t version, struct release *out,
		  struct buffer *file)
{
	const char *name = tuf_folder_naming_name(folder);
	struct tuf_file naming = { 0 };
	const cJSON *keys, *role;
	int rc = parse_version(folder, version, name, TUF_TARGETS, false, &naming);

	*out = (struct release){ 0 };
	tuf_folder_naming_keys(folder, &keys, &role);
	if (rc == 0 && !naming.json)
		rc = -ENOENT;
	if (rc == 0 && (rc = tuf_file_verify(&naming, keys, role)) < 0)
		log_warn("pipeline",
			 "%s/tuf: version %" PRIu64 " of %s.json is not signed with the keys that "
			 "may sign it now",
			 folder->place.release, version, name);
	if (rc == 0)
		rc = read_named(folder, &naming, out, file);
	if (rc == 0 && out->sequence != version)
		rc = -ENOENT; /* delegations have changed, not the release */
	tuf_file_finish(&naming);
	return rc;
}
