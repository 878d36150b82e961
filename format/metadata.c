/* Reads signed metadata files: strict JSON, base64, ed25519 signatures, then the fields of each
 * role. */
#include "format/metadata.h"

#include <cjson/cJSON.h>
#include <errno.h>
#include <math.h>
#include <sodium.h>
#include <stdlib.h>
#include <string.h>

#include "base/json_tree.h"
#include "format/metadata_parts.h"
#include "format/page.h"

/* 2^53: JSON numbers are doubles to most readers, and an integer must survive that. */
#define WHOLE_MAX 9007199254740992.0

struct signature {
	struct hash key;
	uint8_t bytes[crypto_sign_BYTES];
};

/* One signature of every old and every new key at most. No honest file has more. */
enum { SIGNATURES_MAX = 2 * KEYS_MAX };

struct envelope {
	struct buffer payload; /* owned */
	struct signature signatures[SIGNATURES_MAX];
	int signature_count;
};

static int refuse(const char **why, int code, const char *text)
{
	if (why)
		*why = code == -ENOMEM ? "no memory is left" : text;
	return code;
}

/* ---- JSON, strictly ---- */

static int parse_object(cJSON **out, struct bytes text)
{
	*out = NULL;
	return text.size > METADATA_FILE_BYTES_MAX ? -EBADMSG : json_parse_object(out, text);
}

/* Returns the member of that name, or NULL if there is none or more than one: of two, another
 * reader could take the other. */
static const cJSON *member(const cJSON *object, const char *name)
{
	const cJSON *item, *found = NULL;

	cJSON_ArrayForEach(item, object)
	{
		if (!item->string || strcmp(item->string, name) != 0)
			continue;
		if (found)
			return NULL;
		found = item;
	}
	return found;
}

static const char *text_member(const cJSON *object, const char *name)
{
	const cJSON *item = member(object, name);

	return cJSON_IsString(item) ? item->valuestring : NULL;
}

static bool whole_member(const cJSON *object, const char *name, uint64_t least, uint64_t most,
			 uint64_t *out)
{
	const cJSON *item = member(object, name);
	double value;

	if (!cJSON_IsNumber(item))
		return false;
	value = item->valuedouble;
	if (!(value >= 0 && value <= WHOLE_MAX) || floor(value) != value)
		return false;
	*out = (uint64_t)value;
	return *out >= least && *out <= most;
}

static bool time_member(const cJSON *object, const char *name, int64_t *out)
{
	uint64_t seconds;

	if (!whole_member(object, name, 1, (uint64_t)WHOLE_MAX, &seconds))
		return false;
	*out = (int64_t)seconds;
	return true;
}

/* *size is the room in out before the call and the length after it. Characters above 127 are
 * refused, so that each byte string has only one text: libsodium mistakes some of them for
 * others. */
static bool base64_decode(const char *text, uint8_t *out, size_t *size)
{
	size_t length = text ? strlen(text) : 0, room = *size;

	for (size_t i = 0; i < length; i++)
		if ((unsigned char)text[i] > 127)
			return false;
	return length > 0 && sodium_base642bin(out, room, text, length, NULL, size, NULL,
					       sodium_base64_VARIANT_ORIGINAL) == 0;
}

static bool base64_exact(const char *text, uint8_t *out, size_t size)
{
	size_t got = size;

	return base64_decode(text, out, &got) && got == size;
}

/* ---- the envelope ---- */

static int read_signatures(struct envelope *envelope, const cJSON *list)
{
	const cJSON *item;

	if (!cJSON_IsArray(list))
		return -EBADMSG;
	cJSON_ArrayForEach(item, list)
	{
		struct signature *signature = &envelope->signatures[envelope->signature_count];
		const char *key = text_member(item, "key");

		if (envelope->signature_count == SIGNATURES_MAX || !cJSON_IsObject(item) || !key ||
		    hash_from_hex(&signature->key, key) < 0 ||
		    !base64_exact(text_member(item, "signature"), signature->bytes,
				  sizeof(signature->bytes)))
			return -EBADMSG;
		envelope->signature_count++;
	}
	return 0;
}

static int read_payload(struct envelope *envelope, const char *text)
{
	size_t size = text ? strlen(text) : 0;
	uint8_t *to = buffer_extend(&envelope->payload, size);

	if (!to)
		return envelope->payload.error;
	if (!base64_decode(text, to, &size) || size == 0)
		return -EBADMSG;
	envelope->payload.size = size;
	return 0;
}

static int envelope_open(struct envelope *envelope, struct bytes file)
{
	cJSON *json;
	int rc = parse_object(&json, file);

	envelope->signature_count = 0;
	buffer_init(&envelope->payload, METADATA_FILE_BYTES_MAX);
	if (rc < 0)
		return rc;
	rc = cJSON_GetArraySize(json) == 2 ? read_payload(envelope, text_member(json, "payload"))
					   : -EBADMSG;
	if (rc == 0)
		rc = read_signatures(envelope, member(json, "signatures"));
	cJSON_Delete(json);
	return rc;
}

static bool key_signed(const struct envelope *envelope, const uint8_t key[KEY_BYTES],
		       struct bytes message)
{
	struct hash name = hash_of((struct bytes){ key, KEY_BYTES });

	for (int i = 0; i < envelope->signature_count; i++)
		if (hash_equal(envelope->signatures[i].key, name) &&
		    crypto_sign_verify_detached(envelope->signatures[i].bytes, message.data,
						message.size, key) == 0)
			return true;
	return false;
}

static int check_signatures(const struct envelope *envelope, enum meta_role role,
			    const struct role_keys *keys, const char **why)
{
	struct buffer message;
	uint32_t good = 0;
	int rc = metadata_message(&message, role, buffer_bytes(&envelope->payload));

	for (uint32_t i = 0; rc == 0 && i < keys->key_count; i++)
		good += key_signed(envelope, keys->keys[i], buffer_bytes(&message));
	buffer_finish(&message);
	if (rc == 0 && (keys->threshold == 0 || good < keys->threshold))
		rc = refuse(why, -EKEYREJECTED, "fewer valid signatures than the threshold");
	return rc;
}

/* Parses the payload. *out is owned by the caller; NULL on failure. -EBADMSG: it is not of that
 * role.
 */
static int open_payload(cJSON **out, const struct envelope *envelope, enum meta_role role)
{
	int rc = parse_object(out, buffer_bytes(&envelope->payload));
	const char *type = rc == 0 ? text_member(*out, "type") : NULL;
	uint64_t format;

	if (rc == 0 && (!type || strcmp(type, metadata_role_names[role]) != 0 ||
			!whole_member(*out, "format", PAYLOAD_FORMAT, PAYLOAD_FORMAT, &format))) {
		cJSON_Delete(*out);
		*out = NULL;
		rc = -EBADMSG;
	}
	return rc;
}

/* ---- root ---- */

static int read_role(struct role_keys *role, const cJSON *json)
{
	const cJSON *list = member(json, "keys"), *item;
	uint64_t threshold;

	if (!cJSON_IsArray(list))
		return -EBADMSG;
	cJSON_ArrayForEach(item, list)
	{
		uint8_t *key = role->keys[role->key_count];

		if (role->key_count == KEYS_MAX || !cJSON_IsString(item) ||
		    !base64_exact(item->valuestring, key, KEY_BYTES))
			return -EBADMSG;
		/* A key listed twice would count twice towards the threshold. */
		for (uint32_t i = 0; i < role->key_count; i++)
			if (memcmp(role->keys[i], key, KEY_BYTES) == 0)
				return -EBADMSG;
		role->key_count++;
	}
	if (!whole_member(json, "threshold", 1, role->key_count, &threshold))
		return -EBADMSG;
	role->threshold = (uint32_t)threshold;
	return 0;
}

static int read_root(struct trust_root *root, const cJSON *json)
{
	const cJSON *roles = member(json, "roles");
	uint64_t version;

	*root = (struct trust_root){ 0 };
	if (!whole_member(json, "version", 1, UINT32_MAX, &version) ||
	    !time_member(json, "expires_s", &root->expires_s))
		return -EBADMSG;
	root->version = (uint32_t)version;
	for (int role = META_ROOT; role <= META_TIMESTAMP; role++)
		if (read_role(&root->roles[role], member(roles, metadata_role_names[role])) < 0)
			return -EBADMSG;
	return 0;
}

static int open_root(struct trust_root *root, struct envelope *envelope, struct bytes file,
		     const char **why)
{
	cJSON *json = NULL;
	int rc = envelope_open(envelope, file);

	if (rc < 0)
		return refuse(why, rc, "the root file is not a signed metadata file");
	rc = open_payload(&json, envelope, META_ROOT);
	if (rc == 0)
		rc = read_root(root, json);
	cJSON_Delete(json);
	if (rc < 0)
		return refuse(why, rc, "the root file's payload is not a root's");
	return check_signatures(envelope, META_ROOT, &root->roles[META_ROOT], why);
}

int trust_root_first(struct trust_root *out, struct bytes file, const char **why)
{
	struct envelope envelope;
	struct trust_root root;
	int rc = open_root(&root, &envelope, file, why);

	buffer_finish(&envelope.payload);
	*out = rc == 0 ? root : (struct trust_root){ 0 };
	return rc;
}

int trust_root_next(struct trust_root *trust, struct bytes file, const char **why)
{
	struct envelope envelope;
	struct trust_root root;
	int rc = open_root(&root, &envelope, file, why);

	if (rc == 0)
		rc = check_signatures(&envelope, META_ROOT, &trust->roles[META_ROOT], why);
	if (rc == 0 && root.version != trust->version + 1)
		rc = refuse(why, -EBADMSG, "the root file's version does not follow");
	buffer_finish(&envelope.payload);
	if (rc == 0)
		*trust = root;
	return rc;
}

/* ---- release and timestamp ---- */

/* Signatures are checked first, so that the JSON parser reads only payloads that a key holder
 * wrote. */
static int open_signed(cJSON **out, enum meta_role role, const struct trust_root *trust,
		       struct bytes file, const char **why)
{
	struct envelope envelope;
	int rc = envelope_open(&envelope, file);

	*out = NULL;
	if (rc < 0)
		rc = refuse(why, rc, "not a signed metadata file");
	else
		rc = check_signatures(&envelope, role, &trust->roles[role], why);
	if (rc == 0) {
		rc = open_payload(out, &envelope, role);
		if (rc < 0)
			rc = refuse(why, rc, "the payload is not of this role");
	}
	buffer_finish(&envelope.payload);
	return rc;
}

static int read_release(struct release *release, const cJSON *json)
{
	const char *root = text_member(json, "root"), *comment = text_member(json, "comment");
	uint64_t root_bytes, tuf_root = 0;

	/* Publishers before this one did not write it. */
	if (cJSON_GetObjectItemCaseSensitive(json, "tuf_root") &&
	    !whole_member(json, "tuf_root", 0, UINT32_MAX, &tuf_root))
		return -EBADMSG;
	if (!whole_member(json, "sequence", 1, (uint64_t)WHOLE_MAX, &release->sequence) ||
	    !time_member(json, "expires_s", &release->expires_s) || !root ||
	    hash_from_hex(&release->root, root) < 0 || hash_is_zero(release->root) ||
	    !whole_member(json, "root_bytes", 1, PAGE_BYTES_MAX, &root_bytes) || !comment ||
	    strlen(comment) >= sizeof(release->comment))
		return -EBADMSG;
	release->root_bytes = (uint32_t)root_bytes;
	release->tuf_root = (uint32_t)tuf_root;
	memcpy(release->comment, comment, strlen(comment) + 1);
	return 0;
}

static int take_release(struct release *out, const cJSON *json, const char **why)
{
	struct release release = { 0 };

	if (read_release(&release, json) < 0)
		return refuse(why, -EBADMSG,
			      "the release file lacks a member or has an invalid one");
	*out = release;
	return 0;
}

int release_decode_target(struct release *out, struct bytes file, const char **why)
{
	struct envelope envelope;
	cJSON *json = NULL;
	int rc = envelope_open(&envelope, file);

	*out = (struct release){ 0 };
	if (rc == 0)
		rc = open_payload(&json, &envelope, META_RELEASE);
	rc = rc < 0 ? refuse(why, rc, "not a release file") : take_release(out, json, why);
	cJSON_Delete(json);
	buffer_finish(&envelope.payload);
	return rc;
}

int release_decode(struct release *out, const struct trust_root *trust, struct bytes file,
		   const char **why)
{
	cJSON *json;
	int rc = open_signed(&json, META_RELEASE, trust, file, why);

	*out = (struct release){ 0 };
	if (rc == 0)
		rc = take_release(out, json, why);
	cJSON_Delete(json);
	return rc;
}

static int read_timestamp(struct timestamp *timestamp, const cJSON *json)
{
	const char *name = text_member(json, "release");

	if (!whole_member(json, "sequence", 1, (uint64_t)WHOLE_MAX, &timestamp->sequence) ||
	    !time_member(json, "expires_s", &timestamp->expires_s) || !name ||
	    hash_from_hex(&timestamp->release, name) < 0)
		return -EBADMSG;
	/* Publishers before this one did not write it. */
	if (cJSON_GetObjectItemCaseSensitive(json, "issued_s") &&
	    (!time_member(json, "issued_s", &timestamp->issued_s) ||
	     timestamp->issued_s > timestamp->expires_s))
		return -EBADMSG;
	return 0;
}

int timestamp_decode(struct timestamp *out, const struct trust_root *trust, struct bytes file,
		     const char **why)
{
	struct timestamp timestamp = { 0 };
	cJSON *json;
	int rc = open_signed(&json, META_TIMESTAMP, trust, file, why);

	*out = timestamp;
	if (rc < 0)
		return rc;
	rc = read_timestamp(&timestamp, json);
	cJSON_Delete(json);
	if (rc < 0)
		return refuse(why, rc, "the timestamp file lacks a member or has an invalid one");
	*out = timestamp;
	return 0;
}
