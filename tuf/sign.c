/* The canonical form is what is signed and what is written. */
#include "tuf/sign.h"

#include <cjson/cJSON.h>
#include <errno.h>
#include <sodium.h>

#include "tuf/canonical.h"

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
	buffer_put(out, message.data, message.size);
	buffer_put_text(out, "}\n");
	buffer_finish(&message);
	return rc < 0 ? rc : out->error;
}
