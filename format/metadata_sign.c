/* Writes and signs metadata files for the publisher: the payload as JSON, then the envelope. */
#include "format/metadata_sign.h"

#include <cjson/cJSON.h>
#include <errno.h>
#include <sodium.h>
#include <stdlib.h>
#include <string.h>

#include "base/json_tree.h"
#include "format/metadata_parts.h"

const char *const metadata_role_names[] = { "root", "release", "timestamp" };

/* The role's name is signed too, so that no file can pass for one of another role. */
int metadata_message(struct buffer *out, enum meta_role role, struct bytes payload)
{
	buffer_init(out, METADATA_FILE_BYTES_MAX + 64);
	buffer_print(out, "gopura-%s-v1\n", metadata_role_names[role]);
	buffer_put(out, payload.data, payload.size);
	return out->error;
}

static bool add_base64(cJSON *object, const char *name, struct bytes bytes)
{
	size_t room = sodium_base64_ENCODED_LEN(bytes.size, sodium_base64_VARIANT_ORIGINAL);
	char *text = malloc(room);
	bool added;

	if (!text)
		return false;
	sodium_bin2base64(text, room, bytes.data, bytes.size, sodium_base64_VARIANT_ORIGINAL);
	added = name ? cJSON_AddStringToObject(object, name, text) != NULL
		     : json_append(object, cJSON_CreateString(text));
	free(text);
	return added;
}

static bool add_signature(cJSON *list, const struct signing_key *key, struct bytes message)
{
	cJSON *item = cJSON_CreateObject();
	uint8_t signature[crypto_sign_BYTES];
	char name[HASH_HEX_BYTES];

	crypto_sign_detached(signature, NULL, message.data, message.size, key->secret);
	hash_to_hex(hash_of((struct bytes){ key->public_key, KEY_BYTES }), name);
	if (!item || !json_append(list, item))
		return false;
	return cJSON_AddStringToObject(item, "key", name) &&
	       add_base64(item, "signature", (struct bytes){ signature, sizeof(signature) });
}

static int put_envelope(struct buffer *out, enum meta_role role, struct bytes payload,
			const struct signing_key *keys, uint32_t key_count)
{
	cJSON *json = cJSON_CreateObject();
	cJSON *list = NULL;
	struct buffer message;
	char *text = NULL;
	int rc = metadata_message(&message, role, payload);
	bool good = rc == 0 && json && add_base64(json, "payload", payload);

	if (good)
		list = cJSON_AddArrayToObject(json, "signatures");
	good = good && list;
	for (uint32_t i = 0; good && i < key_count; i++)
		good = add_signature(list, &keys[i], buffer_bytes(&message));
	if (good)
		text = json_line(json);
	if (text) {
		buffer_put_text(out, text);
		buffer_put_u8(out, '\n');
	}
	rc = rc < 0 ? rc : text ? out->error : -ENOMEM;
	cJSON_free(text);
	cJSON_Delete(json);
	buffer_finish(&message);
	return rc;
}

/* Takes json. complete is false if memory ran out while json was built; json may then be NULL. */
static int sign_payload(struct buffer *out, enum meta_role role, cJSON *json, bool complete,
			const struct signing_key *keys, uint32_t key_count)
{
	char *text = complete ? json_line(json) : NULL;
	int rc = -ENOMEM;

	if (text)
		rc = put_envelope(out, role, (struct bytes){ (uint8_t *)text, strlen(text) }, keys,
				  key_count);
	cJSON_free(text);
	cJSON_Delete(json);
	return rc;
}

static cJSON *payload_create(enum meta_role role, int64_t expires_s)
{
	cJSON *json = cJSON_CreateObject();

	if (json && cJSON_AddStringToObject(json, "type", metadata_role_names[role]) &&
	    cJSON_AddNumberToObject(json, "format", PAYLOAD_FORMAT) &&
	    cJSON_AddNumberToObject(json, "expires_s", (double)expires_s))
		return json;
	cJSON_Delete(json);
	return NULL;
}

static bool add_role(cJSON *roles, const char *name, const struct role_keys *role)
{
	cJSON *json = cJSON_AddObjectToObject(roles, name), *list;

	if (!json || !cJSON_AddNumberToObject(json, "threshold", role->threshold))
		return false;
	list = cJSON_AddArrayToObject(json, "keys");
	for (uint32_t i = 0; list && i < role->key_count; i++)
		if (!add_base64(list, NULL, (struct bytes){ role->keys[i], KEY_BYTES }))
			return false;
	return list != NULL;
}

int trust_root_encode(struct buffer *out, const struct trust_root *root,
		      const struct signing_key *keys, uint32_t key_count)
{
	cJSON *json = payload_create(META_ROOT, root->expires_s), *roles = NULL;
	bool complete = json && cJSON_AddNumberToObject(json, "version", root->version);

	if (complete)
		roles = cJSON_AddObjectToObject(json, "roles");
	complete = complete && roles;
	for (int role = META_ROOT; complete && role <= META_TIMESTAMP; role++)
		complete = add_role(roles, metadata_role_names[role], &root->roles[role]);
	return sign_payload(out, META_ROOT, json, complete, keys, key_count);
}

int release_encode(struct buffer *out, const struct release *release,
		   const struct signing_key *keys, uint32_t key_count)
{
	cJSON *json = payload_create(META_RELEASE, release->expires_s);
	char root[HASH_HEX_BYTES];
	bool complete;

	hash_to_hex(release->root, root);
	complete = json && cJSON_AddNumberToObject(json, "sequence", (double)release->sequence) &&
		   cJSON_AddStringToObject(json, "root", root) &&
		   cJSON_AddNumberToObject(json, "root_bytes", release->root_bytes) &&
		   cJSON_AddStringToObject(json, "comment", release->comment);
	if (complete && release->tuf_root > 0)
		complete = cJSON_AddNumberToObject(json, "tuf_root", release->tuf_root);
	return sign_payload(out, META_RELEASE, json, complete, keys, key_count);
}

int timestamp_encode(struct buffer *out, const struct timestamp *timestamp,
		     const struct signing_key *keys, uint32_t key_count)
{
	cJSON *json = payload_create(META_TIMESTAMP, timestamp->expires_s);
	char name[HASH_HEX_BYTES];
	bool complete;

	hash_to_hex(timestamp->release, name);
	complete = json && cJSON_AddNumberToObject(json, "sequence", (double)timestamp->sequence) &&
		   cJSON_AddStringToObject(json, "release", name);
	if (complete && timestamp->issued_s > 0)
		complete = cJSON_AddNumberToObject(json, "issued_s", (double)timestamp->issued_s);
	return sign_payload(out, META_TIMESTAMP, json, complete, keys, key_count);
}
