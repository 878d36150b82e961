/* Edits the delegations of targets.json, and prints them. */
#include "pipeline/release/delegation.h"

#include <cjson/cJSON.h>
#include <errno.h>
#include <limits.h>
#include <string.h>
#include <time.h>
#include <unistd.h>

#include "base/clock.h"
#include "base/json_tree.h"
#include "base/log.h"
#include "pipeline/release/publish.h"
#include "pipeline/release/published.h"
#include "pipeline/release/release_tuf.h"
#include "pipeline/release/tuf_staged.h"
#include "tuf/public_key.h"
#include "tuf/sign.h"

enum { PUBLIC_KEY_BYTES_MAX = 16 << 10 };

static cJSON *member(const cJSON *object, const char *name)
{
	return cJSON_GetObjectItemCaseSensitive(object, name);
}

static const char *name_of(const cJSON *role)
{
	return cJSON_GetStringValue(member(role, "name"));
}

/* ---- the public keys that were given */

struct given {
	const struct delegation_options *options;
	struct tuf_public_key keys[DELEGATION_KEYS_MAX];
};

static const char *why_not(int rc)
{
	switch (rc) {
	case -EBADMSG:
		return "not a public key; it has to be PEM that begins with BEGIN PUBLIC KEY, as "
		       "`openssl pkey -pubout` and `gopura-content keys --team` write it, or a key "
		       "of The Update Framework in JSON";
	case -EPERM:
		return "a private key, which its team must not hand over: ask for the public one, "
		       "and let the team make a new key, because this one was seen by others";
	case -EOPNOTSUPP:
		return "only ed25519, ECDSA P-256 and RSA from 2048 bits are keys of The Update "
		       "Framework";
	default:
		return strerror(-rc);
	}
}

static bool same_key(const struct tuf_key_name *a, const struct tuf_key_name *b)
{
	return memcmp(a->sha256, b->sha256, sizeof(a->sha256)) == 0;
}

static int read_key(struct given *given, uint32_t index)
{
	const char *path = given->options->key_files[index];
	struct tuf_public_key *key = &given->keys[index];
	struct buffer file;
	int rc;

	buffer_init(&file, PUBLIC_KEY_BYTES_MAX);
	rc = buffer_read_file(&file, path);
	if (rc == 0)
		rc = tuf_public_key_read(key, buffer_bytes(&file));
	buffer_finish(&file);
	if (rc < 0)
		log_error("pipeline", "%s: %s", path, why_not(rc));
	for (uint32_t i = 0; rc == 0 && i < index; i++)
		if (same_key(&given->keys[i].name, &key->name)) {
			log_error("pipeline", "%s: the same key as %s; name each key once", path,
				  given->options->key_files[i]);
			rc = -EEXIST;
		}
	return rc;
}

static int given_init(struct given *given, const struct delegation_options *options)
{
	int rc = 0;

	*given = (struct given){ .options = options };
	if (options->key_count == 0 || options->threshold == 0 ||
	    options->threshold > options->key_count) {
		log_error("pipeline",
			  "%s: %u of its keys have to sign, but it has %u: give more keys, or a "
			  "lower threshold",
			  options->role, options->threshold, options->key_count);
		return -EINVAL;
	}
	for (uint32_t i = 0; rc == 0 && i < options->key_count; i++)
		rc = read_key(given, i);
	return rc;
}

static void given_finish(struct given *given)
{
	for (uint32_t i = 0; i < DELEGATION_KEYS_MAX; i++)
		tuf_public_key_finish(&given->keys[i]);
}

/* Complains if one of the given keys is among those of somebody else. ids NULL: all of keys. */
static int check_unused(const struct given *given, const cJSON *keys, const cJSON *ids,
			const char *whose)
{
	const cJSON *list = ids ? ids : keys, *key;
	struct tuf_key_name name;

	cJSON_ArrayForEach(key, list)
	{
		const cJSON *entry = ids ? member(keys, cJSON_GetStringValue(key)) : key;

		for (uint32_t i = 0; entry && i < given->options->key_count; i++) {
			const int named = tuf_key_name_of(entry, &name);

			if (named < 0) {
				log_error("pipeline", "%s: %s", given->options->key_files[i],
					  strerror(-named));
				return named;
			}
			if (named == 0 || !same_key(&name, &given->keys[i].name))
				continue;
			log_error("pipeline",
				  "%s: this key is used already, by %s; whoever has it could sign "
				  "for both: let the team make a key of its own",
				  given->options->key_files[i], whose);
			return -EEXIST;
		}
	}
	return 0;
}

/* ---- the role's place among what there is */

/* A path belongs to one role, and to nothing that terminals find before it. */
static int check_path(const struct tuf_folder *folder, const char *role)
{
	const cJSON *roles = member(tuf_folder_delegations(folder), "roles"), *item;
	const char *taken = NULL;
	char target[PATH_MAX];

	snprintf(target, sizeof(target), "%s/release.json", role);
	cJSON_ArrayForEach(item, roles)
	{
		if (strcmp(name_of(item), role) != 0 && member(item, "paths") &&
		    tuf_folder_role_has_path(item, target))
			taken = name_of(item);
	}
	cJSON_ArrayForEach(item, member(folder->top.content, "targets"))
	{
		if (strncmp(item->string, role, strlen(role)) == 0 &&
		    item->string[strlen(role)] == '/')
			taken = "targets.json itself";
	}
	if (taken)
		log_error("pipeline",
			  "%s/tuf: terminals find the path %s/... in %s already; choose another "
			  "name for the role",
			  folder->place.release, role, taken);
	return taken ? -EEXIST : 0;
}

/* Returns 1 if the role's keys signed the file, 0 if not, or -ENOMEM. */
static int is_signed(const struct tuf_file *file, const cJSON *keys, const cJSON *role)
{
	int rc = role ? tuf_file_verify(file, keys, role) : -EKEYREJECTED;

	return rc == -ENOMEM ? rc : rc == 0;
}

/* Judges what becomes of the role's present release. keys and role: as they will be, or NULL. */
static int check_release(const struct tuf_folder *folder, const struct delegation_options *options,
			 const cJSON *keys, const cJSON *role)
{
	const cJSON *delegations = tuf_folder_delegations(folder);
	const cJSON *before = tuf_folder_role_in(delegations, options->role);
	const cJSON *keys_before = member(delegations, "keys");
	struct tuf_file file;
	uint32_t version;
	int rc = tuf_folder_read_role(folder, options->role, &file, &version);
	int signed_before, signed_after = 0;

	if (rc < 0)
		return rc;
	signed_before = file.json ? is_signed(&file, keys_before, before) : 0;
	if (signed_before > 0)
		signed_after = is_signed(&file, keys, role);
	tuf_file_finish(&file);
	if (signed_before < 0 || signed_after < 0) {
		log_error("pipeline", "%s: %s", options->role, strerror(ENOMEM));
		return -ENOMEM;
	}
	if (signed_before == 0 || signed_after > 0)
		return 0;
	if (options->invalidate) {
		log_warn("pipeline",
			 "%s: its release (%u.%s.json) is not valid any more: terminals keep what "
			 "they show, and take nothing%s",
			 options->role, version, options->role,
			 role ? " until its team publishes with the new keys" : " any more");
		return 0;
	}
	log_error("pipeline",
		  role ? "%s: its release (%u.%s.json) would not be valid any more, and terminals "
			 "would take nothing until its team publishes again: name its present keys "
			 "too, and take them away when it has published with the new ones; for a "
			 "key that may be stolen, --invalidate"
		       : "%s: it has a release (%u.%s.json); terminals that show it would keep it, "
			 "and take nothing any more: give --invalidate if they may",
		  options->role, version, options->role);
	return -EKEYREJECTED;
}

/* ---- edits of targets.json, as struct tuf_change says */

static int no_memory(void)
{
	log_error("pipeline", "targets.json: %s", strerror(ENOMEM));
	return -ENOMEM;
}

/* Returns a member of that name, which is added where there is none. */
static cJSON *member_or(cJSON *object, const char *name, cJSON *(*make)(void))
{
	cJSON *item = member(object, name);

	if (item)
		return item;
	item = make();
	return json_add(object, name, item) ? item : NULL;
}

static cJSON *add_role(cJSON *roles, const char *name)
{
	cJSON *role = cJSON_CreateObject();
	char pattern[PATH_MAX];

	snprintf(pattern, sizeof(pattern), "%s/*", name);
	if (cJSON_AddStringToObject(role, "name", name) &&
	    json_append(cJSON_AddArrayToObject(role, "paths"), cJSON_CreateString(pattern)) &&
	    cJSON_AddTrueToObject(role, "terminating"))
		return json_append(roles, role) ? role : NULL;
	cJSON_Delete(role);
	return NULL;
}

static bool set_keys(cJSON *role, cJSON *keys, const struct given *given)
{
	cJSON *ids;

	cJSON_DeleteItemFromObjectCaseSensitive(role, "keyids");
	cJSON_DeleteItemFromObjectCaseSensitive(role, "threshold");
	ids = cJSON_AddArrayToObject(role, "keyids");
	for (uint32_t i = 0; i < given->options->key_count; i++) {
		const struct tuf_public_key *key = &given->keys[i];

		cJSON_DeleteItemFromObjectCaseSensitive(keys, key->id);
		if (!json_append(ids, cJSON_CreateString(key->id)) ||
		    !json_add(keys, key->id, cJSON_Duplicate(key->entry, true)))
			return false;
	}
	return cJSON_AddNumberToObject(role, "threshold", given->options->threshold);
}

static int edit_set(void *context, const struct tuf_folder *folder, cJSON *content)
{
	const struct given *given = context;
	const char *name = given->options->role;
	cJSON *all = member_or(content, "delegations", cJSON_CreateObject);
	cJSON *keys = member_or(all, "keys", cJSON_CreateObject);
	cJSON *roles = member_or(all, "roles", cJSON_CreateArray), *role;
	int rc = check_path(folder, name);

	if (rc == 0)
		rc = check_unused(given, tuf_root_keys(&folder->root), NULL, "the museum itself");
	cJSON_ArrayForEach(role, roles)
	{
		if (rc == 0 && strcmp(name_of(role), name) != 0)
			rc = check_unused(given, keys, member(role, "keyids"), name_of(role));
	}
	if (rc < 0)
		return rc;
	role = tuf_folder_role_in(all, name);
	if (!role)
		role = add_role(roles, name);
	if (!role || !set_keys(role, keys, given))
		return no_memory();
	tuf_drop_unused_keys(keys, roles);
	return check_release(folder, given->options, keys, role);
}

static int edit_remove(void *context, const struct tuf_folder *folder, cJSON *content)
{
	const struct delegation_options *options = context;
	cJSON *all = member(content, "delegations"), *roles = member(all, "roles");
	cJSON *role = tuf_folder_role_in(all, options->role);
	int rc = role ? check_release(folder, options, NULL, NULL) : -ENOENT;

	if (rc == -ENOENT)
		log_error("pipeline", "%s/tuf: targets.json delegates nothing to %s",
			  options->release, options->role);
	if (rc < 0)
		return rc;
	cJSON_Delete(cJSON_DetachItemViaPointer(roles, role));
	tuf_drop_unused_keys(member(all, "keys"), roles);
	return 0;
}

static int edit_nothing(void *context, const struct tuf_folder *folder, cJSON *content)
{
	(void)context;
	(void)content;
	if (folder->top.json)
		return 0;
	log_error("pipeline", "%s/tuf: there is no targets.json to renew", folder->place.release);
	return -ENOENT;
}

/* ---- */

static struct tuf_place place_of(const struct delegation_options *options)
{
	return (struct tuf_place){ .release = options->release,
				   .keys_folder = options->keys_folder };
}

/* A temple that publishes in the form of The Update Framework alone would remove release.json. */
static int check_form(const struct delegation_options *options)
{
	char path[PATH_MAX];

	if (snprintf(path, sizeof(path), "%s/release.json", options->release) >= PATH_MAX)
		return -ENAMETOOLONG;
	if (access(path, F_OK) < 0)
		return 0;
	log_error("pipeline",
		  "%s: this folder has releases in the earlier form too, which knows no roles: "
		  "publish once with metadata = tuf in [release] of temple.ini, when all terminals "
		  "have gone over (docs/tuf.md)",
		  path);
	return -EINVAL;
}

static int change(const struct delegation_options *options,
		  int (*edit)(void *, const struct tuf_folder *, cJSON *), void *context)
{
	const struct tuf_place place = place_of(options);
	const struct tuf_change change = { .edit = edit,
					   .context = context,
					   .expires_s = clock_wall_s() + options->life_s,
					   .renews = edit == edit_nothing };
	const struct publish_target target = { .release = options->release,
					       .keys_folder = options->keys_folder,
					       .tuf_alone = true,
					       .trust_clock = options->trust_clock };
	int rc = check_form(options);

	if (rc == 0)
		rc = published_check_clock(&target);
	return rc < 0 ? rc
		      : release_tuf_change(&place, &change, TIMESTAMP_LIFE_DAYS * 86400ll,
					   options->unsigned_folder);
}

int delegation_set(const struct delegation_options *options)
{
	struct given given;
	int rc = given_init(&given, options);

	if (rc == 0)
		rc = publish_make_folder(options->release);
	if (rc == 0)
		rc = change(options, edit_set, &given);
	given_finish(&given);
	return rc;
}

int delegation_remove(const struct delegation_options *options)
{
	struct delegation_options copy = *options;

	return change(options, edit_remove, &copy);
}

int delegation_renew(const struct delegation_options *options)
{
	return change(options, edit_nothing, NULL);
}

int delegation_add_signatures(const struct delegation_options *options, const char *staged_folder)
{
	struct tuf_place place = place_of(options);
	char role[128], target[PATH_MAX];
	int rc = tuf_staged_role(role, sizeof(role), staged_folder);

	if (rc < 0)
		return rc;
	snprintf(target, sizeof(target), "%s/release.json", role);
	if (role[0])
		place.role = role, place.target = target;
	return release_tuf_add_signatures(&place, staged_folder);
}

/* ---- for people */

static void print_until(FILE *to, const struct tuf_file *file)
{
	const time_t time_s = (time_t)file->expires_s;
	char date[32] = "";
	struct tm tm;

	if (gmtime_r(&time_s, &tm))
		strftime(date, sizeof(date), "%Y-%m-%d", &tm);
	fprintf(to, ", valid until %s\n", date);
}

static int print_state(FILE *to, const struct tuf_folder *folder, const cJSON *keys,
		       const cJSON *role)
{
	struct tuf_file file;
	uint32_t version;
	int rc = tuf_folder_read_role(folder, name_of(role), &file, &version);

	if (rc == 0 && !file.json) {
		fputs("    has published nothing yet\n", to);
	} else if (rc == 0 && tuf_file_verify(&file, keys, role) < 0) {
		fprintf(to,
			"    its last release (%u.%s.json) is not signed with these keys: its team "
			"has to publish again\n",
			version, name_of(role));
	} else if (rc == 0) {
		fprintf(to, "    release %u.%s.json", version, name_of(role));
		print_until(to, &file);
	}
	tuf_file_finish(&file);
	return rc;
}

static int print_role(FILE *to, const struct tuf_folder *folder, const cJSON *role)
{
	const cJSON *keys = member(tuf_folder_delegations(folder), "keys"), *item;
	const int threshold = member(role, "threshold")->valueint;

	fprintf(to, "%s signs", name_of(role));
	cJSON_ArrayForEach(item, member(role, "paths")) fprintf(to, " %s", item->valuestring);
	fprintf(to, "%s, with %d of these keys:\n",
		member(role, "paths") ? "" : " by hashes of paths", threshold);
	cJSON_ArrayForEach(item, member(role, "keyids"))
	{
		const char *type =
			cJSON_GetStringValue(member(member(keys, item->valuestring), "keytype"));

		fprintf(to, "    %-7s %s\n", type ? type : "missing", item->valuestring);
	}
	return print_state(to, folder, keys, role);
}

int delegation_print(FILE *to, const struct delegation_options *options)
{
	const struct tuf_place place = place_of(options);
	struct tuf_folder folder;
	const cJSON *roles, *role;
	int rc = tuf_folder_open(&folder, &place);

	if (rc == 0 && folder.top.json) {
		fprintf(to, "%s: targets.json version %u", options->release, folder.top.version);
		print_until(to, &folder.top);
		if (!folder.top_is_signed)
			fputs("signed with a key that was exchanged since: if this list is as it "
			      "should be, sign it anew with --renew\n",
			      to);
	} else if (rc == 0) {
		fprintf(to, "%s: nothing is signed there yet\n", options->release);
	}
	roles = member(tuf_folder_delegations(&folder), "roles");
	cJSON_ArrayForEach(role, roles)
	{
		if (rc == 0)
			rc = print_role(to, &folder, role);
	}
	if (rc == 0 && cJSON_GetArraySize(roles) == 0)
		fputs("it delegates nothing\n", to);
	tuf_folder_finish(&folder);
	return rc;
}
