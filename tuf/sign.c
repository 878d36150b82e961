/* The canonical form is what is signed and what is written. */
#include "tuf/sign.h"

#include <cjson/cJSON.h>
#include <errno.h>
#include <sodium.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>

#include "base/json_tree.h"
#include "tuf/canonical.h"
#include "tuf/key.h"

_Static_assert(sizeof(((struct tuf_signer *)0)->public_key) == crypto_sign_PUBLICKEYBYTES &&
		       sizeof(((struct tuf_signer *)0)->secret) == crypto_sign_SECRETKEYBYTES,
	       "keys of ed25519");

cJSON *tuf_signer_key(const struct tuf_signer *signer)
{
	char hex[2 * sizeof(signer->public_key) + 1];
	cJSON *key = cJSON_CreateObject(), *value = cJSON_AddObjectToObject(key, "keyval");

	sodium_bin2hex(hex, sizeof(hex), signer->public_key, sizeof(signer->public_key));
	if (cJSON_AddStringToObject(key, "keytype", "ed25519") &&
	    cJSON_AddStringToObject(key, "scheme", "ed25519") &&
	    cJSON_AddStringToObject(value, "public", hex))
		return key;
	cJSON_Delete(key);
	return NULL;
}

int tuf_signer_init(struct tuf_signer *out, const uint8_t seed[32])
{
	uint8_t hash[crypto_hash_sha256_BYTES];
	struct buffer canonical;
	cJSON *key;
	int rc;

	crypto_sign_seed_keypair(out->public_key, out->secret, seed);
	buffer_init(&canonical, 4096);
	key = tuf_signer_key(out);
	rc = key ? canonical_write(&canonical, key) : -ENOMEM;
	if (rc == 0)
		crypto_hash_sha256(hash, canonical.data, canonical.size);
	if (rc == 0)
		sodium_bin2hex(out->id, sizeof(out->id), hash, sizeof(hash));
	cJSON_Delete(key);
	buffer_finish(&canonical);
	return rc;
}

cJSON *tuf_content(enum tuf_type type, uint32_t version, int64_t expires_s)
{
	const time_t time_s = (time_t)expires_s;
	cJSON *content = cJSON_CreateObject();
	char date[32];
	struct tm tm;

	if (content && gmtime_r(&time_s, &tm) &&
	    strftime(date, sizeof(date), "%Y-%m-%dT%H:%M:%SZ", &tm) > 0 &&
	    cJSON_AddStringToObject(content, "_type", tuf_type_names[type]) &&
	    cJSON_AddStringToObject(content, "spec_version", "1.0.34") &&
	    cJSON_AddNumberToObject(content, "version", version) &&
	    cJSON_AddStringToObject(content, "expires", date))
		return content;
	cJSON_Delete(content);
	return NULL;
}

cJSON *tuf_next_content(const struct tuf_file *last, enum tuf_type type, uint32_t version,
			int64_t expires_s)
{
	cJSON *content = tuf_content(type, version, expires_s);
	const cJSON *item, *members = last->json ? last->content : NULL;

	cJSON_ArrayForEach(item, members)
	{
		if (cJSON_GetObjectItemCaseSensitive(content, item->string))
			continue;
		if (!json_add(content, item->string, cJSON_Duplicate(item, true))) {
			cJSON_Delete(content);
			return NULL;
		}
	}
	return content;
}

cJSON *tuf_add_file(cJSON *to, const char *name, uint32_t version, struct bytes file)
{
	uint8_t hash[crypto_hash_sha256_BYTES];
	char hex[2 * sizeof(hash) + 1];
	cJSON *entry = cJSON_AddObjectToObject(to, name);

	crypto_hash_sha256(hash, file.data, file.size);
	sodium_bin2hex(hex, sizeof(hex), hash, sizeof(hash));
	if (!cJSON_AddNumberToObject(entry, "length", (double)file.size) ||
	    !cJSON_AddStringToObject(cJSON_AddObjectToObject(entry, "hashes"), "sha256", hex) ||
	    (version > 0 && !cJSON_AddNumberToObject(entry, "version", version)))
		return NULL;
	return entry;
}

bool tuf_role_names(const cJSON *role, const char *keyid)
{
	const cJSON *id;

	cJSON_ArrayForEach(id, cJSON_GetObjectItemCaseSensitive(role, "keyids"))
	{
		if (strcmp(cJSON_GetStringValue(id), keyid) == 0)
			return true;
	}
	return false;
}

void tuf_drop_unused_keys(cJSON *keys, const cJSON *roles)
{
	const cJSON *role;

	for (cJSON *key = keys ? keys->child : NULL, *next; key; key = next) {
		bool used = false;

		next = key->next;
		cJSON_ArrayForEach(role, roles) used = used || tuf_role_names(role, key->string);
		if (!used)
			cJSON_Delete(cJSON_DetachItemViaPointer(keys, key));
	}
}

void tuf_signer_finish(struct tuf_signer *signer)
{
	sodium_memzero(signer, sizeof(*signer));
}

static void write_signature(struct buffer *out, const struct tuf_signer *signer,
			    struct bytes message)
{
	uint8_t signature[crypto_sign_BYTES];
	char hex[2 * sizeof(signature) + 1];

	crypto_sign_detached(signature, NULL, message.data, message.size, signer->secret);
	sodium_bin2hex(hex, sizeof(hex), signature, sizeof(signature));
	buffer_print(out, "{\"keyid\":\"%s\",\"sig\":\"%s\"}", signer->id, hex);
}

/* Writes a canonical form as JSON for any reader: it has control characters as they are, such as
 * the line ends of a key in PEM, and nothing but strings has any. */
static void put_json(struct buffer *out, struct bytes canonical)
{
	size_t from = 0;

	if (canonical.size == 0)
		return; /* where there is no canonical form, there is no data either */
	for (size_t i = 0; i < canonical.size; i++) {
		if (canonical.data[i] >= ' ')
			continue;
		buffer_put(out, canonical.data + from, i - from);
		buffer_print(out, "\\u%04x", canonical.data[i]);
		from = i + 1;
	}
	buffer_put(out, canonical.data + from, canonical.size - from);
}

int tuf_sign(struct buffer *out, const cJSON *content, const struct tuf_signer *signers,
	     uint32_t count)
{
	struct buffer message;
	int rc;

	buffer_init(&message, out->ceiling);
	rc = canonical_write(&message, content);
	buffer_put_text(out, "{\"signatures\":[");
	for (uint32_t i = 0; i < count && rc == 0; i++) {
		buffer_put_text(out, i > 0 ? "," : "");
		write_signature(out, &signers[i], buffer_bytes(&message));
	}
	buffer_put_text(out, "],\"signed\":");
	put_json(out, buffer_bytes(&message));
	buffer_put_text(out, "}\n");
	buffer_finish(&message);
	return rc < 0 ? rc : out->error;
}

/* ---- signatures that were made elsewhere */

/* Finds the id of the role's key that made a signature in hexadecimal; *out is borrowed. Returns 0,
 * -EKEYREJECTED if none did, or -ENOMEM. */
static int maker_of(const char **out, const cJSON *keys, const cJSON *role, struct bytes message,
		    const char *hex)
{
	const cJSON *id;
	struct tuf_key_name name;
	int made;

	cJSON_ArrayForEach(id, cJSON_GetObjectItemCaseSensitive(role, "keyids"))
	{
		const cJSON *key;

		*out = cJSON_GetStringValue(id);
		key = *out ? cJSON_GetObjectItemCaseSensitive(keys, *out) : NULL;
		made = key ? tuf_key_signed(key, message, hex, &name) : 0;
		if (made != 0)
			return made < 0 ? made : 0;
	}
	return -EKEYREJECTED;
}

static void remove_of(cJSON *signatures, const char *id)
{
	for (int i = cJSON_GetArraySize(signatures) - 1; i >= 0; i--) {
		const char *of = cJSON_GetStringValue(cJSON_GetObjectItemCaseSensitive(
			cJSON_GetArrayItem(signatures, i), "keyid"));

		if (of && strcmp(of, id) == 0)
			cJSON_DeleteItemFromArray(signatures, i);
	}
}

int tuf_add_signature(cJSON *signatures, const cJSON *keys, const cJSON *role, struct bytes message,
		      struct bytes signature)
{
	const size_t room = 2 * signature.size + 1;
	char *hex = malloc(room);
	const char *id;
	cJSON *entry;
	int rc;

	if (!hex)
		return -ENOMEM;
	sodium_bin2hex(hex, room, signature.data, signature.size);
	rc = maker_of(&id, keys, role, message, hex);
	if (rc == 0) {
		entry = cJSON_CreateObject();
		if (cJSON_AddStringToObject(entry, "keyid", id) &&
		    cJSON_AddStringToObject(entry, "sig", hex)) {
			remove_of(signatures, id);
			rc = json_append(signatures, entry) ? 0 : -ENOMEM;
		} else {
			cJSON_Delete(entry);
			rc = -ENOMEM;
		}
	}
	free(hex);
	return rc;
}

int tuf_write_signed(struct buffer *out, struct bytes message, const cJSON *signatures)
{
	struct buffer list;
	int rc;

	buffer_put_text(out, "{\"signatures\":");
	buffer_init(&list, out->ceiling);
	rc = canonical_write(&list, signatures);
	put_json(out, buffer_bytes(&list));
	buffer_finish(&list);
	buffer_put_text(out, ",\"signed\":");
	put_json(out, message);
	buffer_put_text(out, "}\n");
	return rc < 0 ? rc : out->error;
}
