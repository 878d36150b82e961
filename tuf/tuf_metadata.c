/* Strict JSON, the shape of each type, and the threshold of signatures. */
#include "tuf/tuf_metadata.h"

#include <cjson/cJSON.h>
#include <errno.h>
#include <math.h>
#include <sodium.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>

#include "base/json_tree.h"
#include "tuf/canonical.h"
#include "tuf/key.h"

enum { SIGNATURES_MAX = 64, CANONICAL_BYTES_MAX = 8 << 20 };

const char *const tuf_type_names[TUF_TYPES] = { "root", "timestamp", "snapshot", "targets" };

/* ---- members */

/* Of two members of one name this takes the first; tuf_file_verify refuses the file. */
static const cJSON *member(const cJSON *object, const char *name)
{
	return cJSON_GetObjectItemCaseSensitive(object, name);
}

static const char *text(const cJSON *object, const char *name)
{
	return cJSON_GetStringValue(member(object, name));
}

static bool is_whole(const cJSON *item, double least, double most)
{
	return cJSON_IsNumber(item) && item->valuedouble >= least && item->valuedouble <= most &&
	       floor(item->valuedouble) == item->valuedouble;
}

static bool is_version(const cJSON *item)
{
	return is_whole(item, 1, UINT32_MAX);
}

/* An array of texts, none of which is there twice. */
static bool are_texts(const cJSON *array)
{
	const cJSON *item, *other;

	if (!cJSON_IsArray(array))
		return false;
	cJSON_ArrayForEach(item, array)
	{
		if (!cJSON_IsString(item))
			return false;
		for (other = array->child; other != item; other = other->next)
			if (strcmp(other->valuestring, item->valuestring) == 0)
				return false;
	}
	return true;
}

/* ---- JSON */

/* A text with a zero in it would be shorter to us than to those who signed it. */
static bool has_zero(struct bytes bytes)
{
	return memchr(bytes.data, 0, bytes.size) || memmem(bytes.data, bytes.size, "\\u0000", 6);
}

/* "2030-06-30T12:00:00Z", and nothing else. */
static bool read_time(const char *date, int64_t *out)
{
	struct tm tm = { 0 };
	const char *end =
		date && strlen(date) == 20 ? strptime(date, "%Y-%m-%dT%H:%M:%SZ", &tm) : NULL;

	if (!end || *end)
		return false;
	*out = timegm(&tm);
	return true;
}

/* ---- the shape of each type */

static bool is_role(const cJSON *role)
{
	return cJSON_IsObject(role) && are_texts(member(role, "keyids")) &&
	       is_whole(member(role, "threshold"), 1, SIGNATURES_MAX);
}

static bool are_keys(const cJSON *keys)
{
	const cJSON *key;

	if (!cJSON_IsObject(keys))
		return false;
	cJSON_ArrayForEach(key, keys) if (!cJSON_IsObject(key)) return false;
	return true;
}

static bool is_root(const cJSON *content)
{
	const cJSON *roles = member(content, "roles");

	for (int type = 0; type < TUF_TYPES; type++)
		if (!is_role(member(roles, tuf_type_names[type])))
			return false;
	return are_keys(member(content, "keys"));
}

static bool are_hashes(const cJSON *hashes)
{
	const cJSON *hash;

	if (!cJSON_IsObject(hashes) || !hashes->child)
		return false;
	cJSON_ArrayForEach(hash, hashes) if (!cJSON_IsString(hash)) return false;
	return true;
}

static bool is_meta(const cJSON *meta)
{
	const cJSON *length = member(meta, "length"), *hashes = member(meta, "hashes");

	return is_version(member(meta, "version")) && (!length || is_whole(length, 1, INT64_MAX)) &&
	       (!hashes || are_hashes(hashes));
}

static bool names_metadata(const cJSON *content, const char *needed)
{
	const cJSON *all = member(content, "meta"), *meta;

	if (!cJSON_IsObject(all) || !member(all, needed))
		return false;
	cJSON_ArrayForEach(meta, all) if (!is_meta(meta)) return false;
	return true;
}

static bool is_delegation(const cJSON *role)
{
	const cJSON *paths = member(role, "paths"), *prefixes = member(role, "path_hash_prefixes");

	return is_role(role) && text(role, "name") && cJSON_IsBool(member(role, "terminating")) &&
	       !paths != !prefixes && are_texts(paths ? paths : prefixes);
}

static bool are_delegations(const cJSON *delegations)
{
	const cJSON *roles = member(delegations, "roles"), *role, *other;

	if (!are_keys(member(delegations, "keys")) || (roles && !cJSON_IsArray(roles)))
		return false;
	cJSON_ArrayForEach(role, roles)
	{
		if (!is_delegation(role))
			return false;
		for (int type = 0; type < TUF_TYPES; type++)
			if (strcmp(text(role, "name"), tuf_type_names[type]) == 0)
				return false;
		for (other = roles->child; other != role; other = other->next)
			if (strcmp(text(other, "name"), text(role, "name")) == 0)
				return false;
	}
	return true;
}

static bool is_targets(const cJSON *content)
{
	const cJSON *all = member(content, "targets"), *target;
	const cJSON *delegations = member(content, "delegations");

	if (!cJSON_IsObject(all))
		return false;
	cJSON_ArrayForEach(target, all)
	{
		if (!is_whole(member(target, "length"), 0, INT64_MAX) ||
		    !are_hashes(member(target, "hashes")))
			return false;
	}
	return !delegations || are_delegations(delegations);
}

static const char *fault_of(struct tuf_file *file, enum tuf_type type)
{
	const cJSON *content = file->content;
	const char *is = text(content, "_type"), *spec = text(content, "spec_version");

	if (!is || strcmp(is, tuf_type_names[type]) != 0)
		return "it is of another type";
	if (!spec || strncmp(spec, "1.", 2) != 0)
		return "it is not of version 1 of the specification";
	if (!is_version(member(content, "version")))
		return "it has no version";
	if (!read_time(text(content, "expires"), &file->expires_s))
		return "it does not say when it expires";
	file->version = (uint32_t)member(content, "version")->valuedouble;
	switch (type) {
	case TUF_ROOT:
		return is_root(content) ? NULL : "its keys or roles are damaged";
	case TUF_TIMESTAMP:
		return names_metadata(content, "snapshot.json") ? NULL : "it names no snapshot";
	case TUF_SNAPSHOT:
		return names_metadata(content, "targets.json") ? NULL : "it names no targets";
	default:
		return is_targets(content) ? NULL : "its targets or delegations are damaged";
	}
}

/* Each key signs once. */
static bool are_signatures(const cJSON *list)
{
	const cJSON *item, *other;

	if (!cJSON_IsArray(list) || cJSON_GetArraySize(list) > SIGNATURES_MAX)
		return false;
	cJSON_ArrayForEach(item, list)
	{
		if (!text(item, "keyid") || !text(item, "sig"))
			return false;
		for (other = list->child; other != item; other = other->next)
			if (strcmp(text(other, "keyid"), text(item, "keyid")) == 0)
				return false;
	}
	return true;
}

int tuf_file_parse(struct tuf_file *out, struct bytes bytes, enum tuf_type type, const char **why)
{
	int rc;

	*out = (struct tuf_file){ 0 };
	rc = has_zero(bytes) ? -EBADMSG : json_parse_object(&out->json, bytes);
	out->content = member(out->json, "signed");
	if (rc == -ENOMEM)
		*why = "no memory is left";
	else if (rc < 0)
		*why = "it is not JSON";
	else if (!are_signatures(member(out->json, "signatures")))
		*why = "its signatures are damaged, or one key is there twice";
	else
		*why = fault_of(out, type);
	if (!*why)
		return 0;
	tuf_file_finish(out);
	return rc < 0 ? rc : -EBADMSG;
}

void tuf_file_finish(struct tuf_file *file)
{
	cJSON_Delete(file->json);
	*file = (struct tuf_file){ 0 };
}

/* ---- signatures */

static const char *signature_by(const struct tuf_file *file, const char *keyid)
{
	const cJSON *item;

	cJSON_ArrayForEach(
		item, member(file->json, "signatures")) if (strcmp(text(item, "keyid"), keyid) ==
							    0) return text(item, "sig");
	return NULL;
}

static bool is_new(const struct tuf_key_name *names, uint32_t count)
{
	for (uint32_t i = 0; i < count; i++)
		if (memcmp(&names[i], &names[count], sizeof(*names)) == 0)
			return false;
	return true;
}

/* Returns how many, or -ENOMEM. */
static int count_signers(const struct tuf_file *file, const cJSON *keys, const cJSON *role,
			 struct bytes message)
{
	struct tuf_key_name names[SIGNATURES_MAX];
	uint32_t count = 0;
	const cJSON *keyid;
	int rc = 0;

	cJSON_ArrayForEach(keyid, member(role, "keyids"))
	{
		const char *signature = signature_by(file, keyid->valuestring);
		const cJSON *key = member(keys, keyid->valuestring);

		if (!key || !signature || count == SIGNATURES_MAX)
			continue;
		rc = tuf_key_signed(key, message, signature, &names[count]);
		if (rc < 0)
			return rc;
		if (rc > 0 && is_new(names, count))
			count++;
	}
	return (int)count;
}

int tuf_file_verify(const struct tuf_file *file, const cJSON *keys, const cJSON *role)
{
	struct buffer message;
	int rc;

	buffer_init(&message, CANONICAL_BYTES_MAX);
	rc = canonical_write(&message, file->content);
	if (rc == 0)
		rc = count_signers(file, keys, role, buffer_bytes(&message));
	if (rc >= 0)
		rc = rc < member(role, "threshold")->valuedouble ? -EKEYREJECTED : 0;
	buffer_finish(&message);
	return rc;
}

/* ---- what files say */

int tuf_root_first(struct tuf_file *out, struct bytes bytes, const char **why)
{
	int rc = tuf_file_parse(out, bytes, TUF_ROOT, why);

	if (rc < 0)
		return rc;
	rc = tuf_file_verify(out, tuf_root_keys(out), tuf_root_role(out, TUF_ROOT));
	if (rc < 0) {
		*why = "the root has not enough signatures of its own keys";
		tuf_file_finish(out);
	}
	return rc;
}

const cJSON *tuf_root_keys(const struct tuf_file *root)
{
	return member(root->content, "keys");
}

const cJSON *tuf_root_role(const struct tuf_file *root, enum tuf_type type)
{
	return member(member(root->content, "roles"), tuf_type_names[type]);
}

bool tuf_root_is_consistent(const struct tuf_file *root)
{
	return cJSON_IsTrue(member(root->content, "consistent_snapshot"));
}

const cJSON *tuf_meta(const struct tuf_file *file, const char *name)
{
	return member(member(file->content, "meta"), name);
}

uint32_t tuf_meta_version(const cJSON *meta)
{
	return (uint32_t)member(meta, "version")->valuedouble;
}

int64_t tuf_issued_s(const struct tuf_file *timestamp)
{
	const cJSON *item = member(timestamp->content, "issued_s");
	const double value = cJSON_IsNumber(item) ? item->valuedouble : 0;

	return value >= 1 && value <= (double)timestamp->expires_s && floor(value) == value
		       ? (int64_t)value
		       : 0;
}

uint64_t tuf_length(const cJSON *entry, uint64_t otherwise)
{
	const cJSON *length = member(entry, "length");

	return length ? (uint64_t)length->valuedouble : otherwise;
}

static bool hash_is(const char *hex, const uint8_t *hash, size_t size)
{
	uint8_t wanted[crypto_hash_sha512_BYTES];
	size_t got;

	return sodium_hex2bin(wanted, sizeof(wanted), hex, strlen(hex), NULL, &got, NULL) == 0 &&
	       got == size && memcmp(wanted, hash, size) == 0;
}

bool tuf_matches(const cJSON *entry, struct bytes bytes)
{
	const cJSON *hashes = member(entry, "hashes");
	const char *sha256 = text(hashes, "sha256"), *sha512 = text(hashes, "sha512");
	uint8_t hash[crypto_hash_sha512_BYTES];

	if (tuf_length(entry, bytes.size) != bytes.size)
		return false;
	crypto_hash_sha256(hash, bytes.data, bytes.size);
	if (sha256 && !hash_is(sha256, hash, crypto_hash_sha256_BYTES))
		return false;
	crypto_hash_sha512(hash, bytes.data, bytes.size);
	if (sha512 && !hash_is(sha512, hash, crypto_hash_sha512_BYTES))
		return false;
	return !hashes || sha256 || sha512;
}
