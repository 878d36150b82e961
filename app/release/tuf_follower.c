/* Gives the workflow the files of a round and what is kept, and finds release.json among the
 * targets. */
#include "app/release/tuf_follower.h"

#include <cjson/cJSON.h>
#include <errno.h>
#include <sodium.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "base/json_tree.h"
#include "tuf/targets.h"
#include "tuf/workflow.h"

static int refuse(struct tuf_follower *follower, int code, const char *why)
{
	snprintf(follower->why, sizeof(follower->why), "%s", why);
	return code;
}

/* ---- what is kept */

/* Returns the type whose file has this name, or TUF_TYPES: none, it is a delegated role's. */
static enum tuf_type type_of(const char *name)
{
	enum tuf_type type;

	for (type = TUF_ROOT; type < TUF_TYPES; type++) {
		const size_t size = strlen(tuf_type_names[type]);

		if (strncmp(name, tuf_type_names[type], size) == 0 &&
		    strcmp(name + size, ".json") == 0)
			break;
	}
	return type;
}

/* Notes what a kept file says of itself. */
static void note(struct tuf_follower *follower, enum tuf_type type)
{
	struct tuf_file file = { 0 };
	const char *why;

	follower->expires_s[type] = follower->version[type] = 0;
	if (tuf_file_parse(&file, buffer_bytes(&follower->kept[type]), type, &why) == 0) {
		follower->expires_s[type] = file.expires_s;
		follower->version[type] = file.version;
		if (type == TUF_TIMESTAMP)
			follower->issued_s = tuf_issued_s(&file);
	}
	tuf_file_finish(&file);
}

static int keep(struct tuf_follower *follower, enum tuf_type type, struct bytes file)
{
	struct buffer fresh;
	int rc;

	buffer_init(&fresh, STATE_FILE_BYTES_MAX);
	buffer_put(&fresh, file.data, file.size);
	rc = fresh.error;
	if (rc < 0) {
		buffer_finish(&fresh);
		return rc;
	}
	buffer_finish(&follower->kept[type]);
	follower->kept[type] = fresh;
	note(follower, type);
	return 0;
}

int tuf_follower_init(struct tuf_follower *follower, const struct state_tuf *kept,
		      const char *target)
{
	const struct bytes files[TUF_TYPES] = {
		[TUF_ROOT] = kept->root,
		[TUF_TIMESTAMP] = kept->timestamp,
		[TUF_SNAPSHOT] = kept->snapshot,
		[TUF_TARGETS] = kept->targets,
	};
	int rc = 0;

	*follower = (struct tuf_follower){ 0 };
	if (snprintf(follower->target, sizeof(follower->target), "%s",
		     target ? target : "release.json") >= (int)sizeof(follower->target))
		rc = -ENAMETOOLONG;
	for (int type = 0; type < TUF_TYPES; type++)
		buffer_init(&follower->kept[type], STATE_FILE_BYTES_MAX);
	for (int type = 0; type < TUF_TYPES && rc == 0; type++)
		if (files[type].size > 0)
			rc = keep(follower, (enum tuf_type)type, files[type]);
	return rc;
}

static void clear_round(struct tuf_round *round)
{
	while (round->count > 0)
		buffer_finish(&round->files[--round->count].bytes);
	round->done = false;
}

void tuf_follower_finish(struct tuf_follower *follower)
{
	for (int type = 0; type < TUF_TYPES; type++)
		buffer_finish(&follower->kept[type]);
	for (size_t i = 0; i < ARRAY_COUNT(follower->rounds); i++) {
		clear_round(&follower->rounds[i]);
		free(follower->rounds[i].files);
	}
	*follower = (struct tuf_follower){ 0 };
}

bool tuf_follower_is_on(const struct tuf_follower *follower)
{
	return follower->kept[TUF_ROOT].size > 0;
}

struct state_tuf tuf_follower_kept(const struct tuf_follower *follower)
{
	const struct buffer *kept = follower->kept;

	return (struct state_tuf){ buffer_bytes(&kept[TUF_ROOT]),
				   buffer_bytes(&kept[TUF_TIMESTAMP]),
				   buffer_bytes(&kept[TUF_SNAPSHOT]),
				   buffer_bytes(&kept[TUF_TARGETS]) };
}

/* ---- the first root */

/* Returns whether an entry of a root's keys is one of these keys. */
static bool is_one_of(const cJSON *key, const struct role_keys *of)
{
	const cJSON *value = cJSON_GetObjectItemCaseSensitive(key, "keyval");
	const char *text = cJSON_GetStringValue(cJSON_GetObjectItemCaseSensitive(value, "public"));
	const char *type = cJSON_GetStringValue(cJSON_GetObjectItemCaseSensitive(key, "keytype"));
	uint8_t public_key[KEY_BYTES];
	size_t size = 0;

	if (!text || !type || strcmp(type, "ed25519") != 0 ||
	    sodium_hex2bin(public_key, sizeof(public_key), text, strlen(text), NULL, &size, NULL) <
		    0 ||
	    size != sizeof(public_key))
		return false;
	for (uint32_t i = 0; i < of->key_count; i++)
		if (memcmp(of->keys[i], public_key, KEY_BYTES) == 0)
			return true;
	return false;
}

/* The keys have the ids that the file itself gives them. */
static int check_signers(const struct tuf_file *root, const struct role_keys *signers)
{
	cJSON *role = cJSON_CreateObject(), *ids = cJSON_AddArrayToObject(role, "keyids");
	const cJSON *key;
	bool whole = ids && cJSON_AddNumberToObject(role, "threshold", signers->threshold);
	int rc;

	cJSON_ArrayForEach(key, tuf_root_keys(root))
	{
		if (whole && is_one_of(key, signers))
			whole = json_append(ids, cJSON_CreateString(key->string));
	}
	rc = whole ? tuf_file_verify(root, tuf_root_keys(root), role) : -ENOMEM;
	cJSON_Delete(role);
	return rc;
}

int tuf_follower_pin(struct tuf_follower *follower, struct bytes root,
		     const struct trust_root *signers)
{
	struct tuf_file file = { 0 };
	const char *why = NULL;
	int rc = tuf_root_first(&file, root, &why);

	if (rc == 0 && signers) {
		rc = check_signers(&file, &signers->roles[META_ROOT]);
		why = "the root is not signed by the root keys of the trust root in use";
	}
	tuf_file_finish(&file);
	if (rc == 0)
		rc = keep(follower, TUF_ROOT, root);
	if (rc == 0)
		follower->changed = true;
	return rc < 0 ? refuse(follower, rc, why ? why : strerror(-rc)) : 0;
}

static void ask_for_first(struct tuf_follower *follower, enum meta_source source)
{
	follower->ask =
		(struct message_file){ .source = source, .bytes_max = MESSAGE_META_BYTES_MAX };
	snprintf(follower->ask.name, sizeof(follower->ask.name), "%u.root.json",
		 follower->first_root);
}

bool tuf_follower_begin_first(struct tuf_follower *follower, uint32_t last, enum meta_source source)
{
	if (last == 0)
		return false;
	follower->first_root = 1;
	follower->first_root_last = last < TUF_FIRST_ROOTS_MAX ? last : TUF_FIRST_ROOTS_MAX;
	ask_for_first(follower, source);
	return true;
}

int tuf_follower_first(struct tuf_follower *follower, const struct message_file *file,
		       const struct trust_root *signers)
{
	int rc = -ENOENT;

	if (follower->first_root == 0 || strcmp(follower->ask.name, file->name) != 0 ||
	    file->source != follower->ask.source)
		return -ENOKEY;
	if (file->answer == FILE_IS_HERE)
		rc = tuf_follower_pin(follower, file->bytes, signers);
	else
		refuse(follower, rc, "it is not there, or larger than 64 KiB");
	if (rc < 0 && follower->first_root < follower->first_root_last) {
		follower->first_root++;
		ask_for_first(follower, file->source);
		return -EAGAIN;
	}
	follower->first_root = 0;
	return rc;
}

/* ---- the files of a round */

static struct tuf_arrived *find(struct tuf_round *round, const char *name)
{
	for (uint32_t i = 0; i < round->count; i++)
		if (strcmp(round->files[i].name, name) == 0)
			return &round->files[i];
	return NULL;
}

/* Removes roots, because there may be a next one by now. */
static void drop_roots(struct tuf_round *round)
{
	static const char end[] = ".root.json";
	uint32_t left = 0;

	for (uint32_t i = 0; i < round->count; i++) {
		struct tuf_arrived *file = &round->files[i];
		const size_t size = strlen(file->name);

		if (size >= sizeof(end) && strcmp(file->name + size + 1 - sizeof(end), end) == 0)
			buffer_finish(&file->bytes);
		else
			round->files[left++] = *file;
	}
	round->count = left;
}

void tuf_follower_add(struct tuf_follower *follower, const struct message_file *file)
{
	struct tuf_round *round = &follower->rounds[file->source];
	struct tuf_arrived *arrived = find(round, file->name);

	if (arrived)
		return;
	if (!round->files)
		round->files = calloc(TUF_ROUND_FILES_MAX, sizeof(*round->files));
	if (!round->files || round->count == TUF_ROUND_FILES_MAX)
		return; /* the workflow asks for it again, and the round fails */
	arrived = &round->files[round->count++];
	*arrived = (struct tuf_arrived){ .answer = file->answer };
	snprintf(arrived->name, sizeof(arrived->name), "%s", file->name);
	buffer_init(&arrived->bytes, MESSAGE_META_BYTES_MAX);
	buffer_put(&arrived->bytes, file->bytes.data, file->bytes.size);
}

void tuf_follower_begin(struct tuf_follower *follower, enum meta_source source,
			struct bytes timestamp)
{
	const struct message_file file = { .name = "timestamp.json",
					   .source = source,
					   .answer = FILE_IS_HERE,
					   .bytes = timestamp };
	struct tuf_round *round = &follower->rounds[source];
	const struct tuf_arrived *before = find(round, file.name);

	if (!before || !bytes_equal(buffer_bytes(&before->bytes), timestamp))
		clear_round(round);
	else if (round->done)
		drop_roots(round);
	round->done = false;
	tuf_follower_add(follower, &file);
}

/* ---- what the workflow asks for */

struct run {
	struct tuf_follower *follower;
	enum meta_source source;
};

static int fetch(void *context, const char *name, struct buffer *out)
{
	const struct run *run = context;
	struct tuf_follower *follower = run->follower;
	const struct tuf_round *round = &follower->rounds[run->source];
	const struct tuf_arrived *file = find(&follower->rounds[run->source], name);

	if (file && file->answer == FILE_IS_HERE) {
		buffer_put(out, file->bytes.data, file->bytes.size);
		return file->bytes.error ? file->bytes.error : out->error;
	}
	if (file)
		return file->answer == FILE_TOO_LARGE ? -EFBIG : -ENOENT;
	if (!message_name_is_fine(name))
		return -ENAMETOOLONG;
	if (round->count == TUF_ROUND_FILES_MAX)
		return -E2BIG;
	follower->ask = (struct message_file){ .source = run->source };
	follower->ask.bytes_max = out->ceiling < MESSAGE_META_BYTES_MAX ? (uint32_t)out->ceiling
									: MESSAGE_META_BYTES_MAX;
	snprintf(follower->ask.name, sizeof(follower->ask.name), "%s", name);
	return -EAGAIN;
}

static int load(void *context, const char *name, struct buffer *out)
{
	const struct run *run = context;
	const enum tuf_type type = type_of(name);
	const struct buffer *kept = &run->follower->kept[type < TUF_TYPES ? type : TUF_ROOT];

	if (type == TUF_TYPES || kept->size == 0)
		return -ENOENT;
	buffer_put(out, kept->data, kept->size);
	return out->error;
}

/* Returns 1 if a kept file is not signed any more as this root wants it, 0 if it is or there is
 * none, or -ENOMEM. */
static int is_withdrawn(const struct tuf_follower *follower, const struct tuf_file *root,
			enum tuf_type type)
{
	struct tuf_file file = { 0 };
	const char *why;
	int rc = tuf_file_parse(&file, buffer_bytes(&follower->kept[type]), type, &why);

	if (rc == 0)
		rc = tuf_file_verify(&file, tuf_root_keys(root), tuf_root_role(root, type));
	tuf_file_finish(&file);
	return rc == -ENOMEM ? rc : rc == -EKEYREJECTED;
}

static void forget(struct tuf_follower *follower, enum tuf_type type)
{
	buffer_clear(&follower->kept[type]);
	follower->expires_s[type] = follower->version[type] = 0;
	if (type == TUF_TIMESTAMP)
		follower->issued_s = 0;
	follower->clear |=
		type == TUF_TIMESTAMP ? STATE_CLEAR_BOTH_FLOORS : STATE_CLEAR_SEQUENCE_FLOOR;
}

/* Keeps a root, forgets what only keys that it withdraws have signed, and notes which floors they
 * may have set; all of it or, on failure, nothing. */
static int keep_root(struct tuf_follower *follower, struct bytes root)
{
	bool withdrawn[TUF_TYPES] = { false };
	struct tuf_file file = { 0 };
	const char *why;
	int rc = tuf_file_parse(&file, root, TUF_ROOT, &why);

	for (int type = TUF_TIMESTAMP; rc == 0 && type < TUF_TYPES; type++) {
		rc = is_withdrawn(follower, &file, (enum tuf_type)type);
		withdrawn[type] = rc > 0;
		rc = rc < 0 ? rc : 0;
	}
	tuf_file_finish(&file);
	if (rc == 0)
		rc = keep(follower, TUF_ROOT, root);
	for (int type = TUF_TIMESTAMP; rc == 0 && type < TUF_TYPES; type++)
		if (withdrawn[type])
			forget(follower, (enum tuf_type)type);
	return rc;
}

/* Delegated targets are not kept: the round has them. */
static int store(void *context, const char *name, struct bytes file)
{
	const struct run *run = context;
	struct tuf_follower *follower = run->follower;
	const enum tuf_type type = type_of(name);

	if (type == TUF_TYPES)
		return 0;
	if (type == TUF_ROOT)
		drop_roots(&follower->rounds[run->source]);
	follower->changed = true;
	return type == TUF_ROOT ? keep_root(follower, file) : keep(follower, type, file);
}

/* ---- release.json */

static int bring(struct run *run, const struct tuf_target *target, const struct bytes known[2],
		 struct buffer *out)
{
	char name[sizeof(target->file) + 16];
	int rc;

	for (int i = 0; i < 2; i++)
		if (known[i].size > 0 && tuf_target_is(target, known[i])) {
			buffer_put(out, known[i].data, known[i].size);
			return out->error;
		}
	if (target->length > METADATA_FILE_BYTES_MAX)
		return refuse(run->follower, -EFBIG, "release.json is larger than 64 KiB");
	out->ceiling = (size_t)target->length;
	snprintf(name, sizeof(name), "targets/%s", target->file);
	rc = fetch(run, name, out);
	if (rc < 0 && rc != -EAGAIN)
		snprintf(run->follower->why, sizeof(run->follower->why), "%.180s: %s", name,
			 strerror(-rc));
	if (rc == 0 && !tuf_target_is(target, buffer_bytes(out)))
		rc = refuse(run->follower, -EBADMSG,
			    "release.json is not the target that was signed");
	return rc;
}

int tuf_follower_run(struct tuf_follower *follower, enum meta_source source, int64_t now_s,
		     const struct bytes known[2], struct buffer *out)
{
	struct run run = { follower, source };
	const struct tuf_io io = { &run, fetch, load, store };
	struct tuf_client client = { 0 };
	struct tuf_target target = { 0 };
	int rc = tuf_client_refresh(&client, &io, now_s);

	if (rc == 0)
		rc = tuf_client_find(&client, follower->target, &target);
	if (rc < 0)
		refuse(follower, rc, client.why);
	else
		rc = bring(&run, &target, known, out);
	follower->rounds[source].done = rc == 0;
	if (rc < 0 && rc != -EAGAIN)
		clear_round(&follower->rounds[source]);
	tuf_target_finish(&target);
	tuf_client_finish(&client);
	return rc;
}
