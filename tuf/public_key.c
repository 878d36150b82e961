/* PEM by OpenSSL; the entries of keys that metadata has. */
#include "tuf/public_key.h"

#include <cjson/cJSON.h>
#include <errno.h>
#include <limits.h>
#include <openssl/err.h>
#include <openssl/pem.h>
#include <sodium.h>
#include <stdio.h>
#include <string.h>

#include "base/json_tree.h"
#include "tuf/canonical.h"
#include "tuf/openssl_memory.h"

enum { ENTRY_BYTES_MAX = 16 << 10 };

static bool has(struct bytes file, const char *text)
{
	return file.size > 0 && memmem(file.data, file.size, text, strlen(text));
}

static int try_to_read_pem(EVP_PKEY **out, struct bytes file)
{
	BIO *bio = file.size <= INT_MAX ? BIO_new_mem_buf(file.data, (int)file.size) : NULL;

	*out = bio ? PEM_read_bio_PUBKEY(bio, NULL, NULL, NULL) : NULL;
	BIO_free(bio);
	if (openssl_lacked_memory() && !*out)
		return -ENOMEM;
	return *out ? 0 : -EBADMSG;
}

static int read_pem(EVP_PKEY **out, struct bytes file)
{
	const int rc = try_to_read_pem(out, file);

	return rc == -EBADMSG ? try_to_read_pem(out, file) : rc; /* tuf/openssl_memory.h */
}

/* Writes the key as one text, whatever spaces and comments the file had. */
static int write_pem(struct buffer *out, EVP_PKEY *key)
{
	BIO *bio = BIO_new(BIO_s_mem());
	char *text;
	int rc = -ENOMEM;

	if (bio && PEM_write_bio_PUBKEY(bio, key) == 1) {
		const long size = BIO_get_mem_data(bio, &text);

		buffer_put(out, text, (size_t)size);
		rc = out->error;
	}
	BIO_free(bio);
	ERR_clear_error();
	return rc;
}

static cJSON *entry_of(const char *type, const char *scheme, const char *public)
{
	cJSON *entry = cJSON_CreateObject();

	if (cJSON_AddStringToObject(entry, "keytype", type) &&
	    cJSON_AddStringToObject(entry, "scheme", scheme) &&
	    cJSON_AddStringToObject(cJSON_AddObjectToObject(entry, "keyval"), "public", public))
		return entry;
	cJSON_Delete(entry);
	return NULL;
}

static cJSON *entry_of_ed25519(EVP_PKEY *key)
{
	uint8_t raw[crypto_sign_PUBLICKEYBYTES];
	char hex[2 * sizeof(raw) + 1];
	size_t size = sizeof(raw);

	if (EVP_PKEY_get_raw_public_key(key, raw, &size) != 1 || size != sizeof(raw))
		return NULL;
	sodium_bin2hex(hex, sizeof(hex), raw, sizeof(raw));
	return entry_of("ed25519", "ed25519", hex);
}

/* Which curves and lengths may be used, tuf_key_name_of says afterwards. */
static int take_pem(cJSON **out, struct bytes file)
{
	EVP_PKEY *key;
	int rc = read_pem(&key, file);
	const int kind = key ? EVP_PKEY_get_base_id(key) : 0;
	const bool rsa = kind == EVP_PKEY_RSA;
	struct buffer text;

	buffer_init(&text, ENTRY_BYTES_MAX);
	if (key && kind != EVP_PKEY_ED25519 && kind != EVP_PKEY_EC && !rsa)
		rc = -EOPNOTSUPP;
	if (rc == 0)
		rc = write_pem(&text, key);
	buffer_put_u8(&text, 0);
	if (rc == 0)
		rc = text.error;
	if (rc == 0) {
		*out = kind == EVP_PKEY_ED25519
			       ? entry_of_ed25519(key)
			       : entry_of(rsa ? "rsa" : "ecdsa",
					  rsa ? "rsassa-pss-sha256" : "ecdsa-sha2-nistp256",
					  (const char *)text.data);
		rc = *out ? 0 : -ENOMEM;
	}
	buffer_finish(&text);
	EVP_PKEY_free(key);
	return rc;
}

static const char *text_in(const cJSON *object, const char *name)
{
	return cJSON_GetStringValue(cJSON_GetObjectItemCaseSensitive(object, name));
}

/* Takes the three members that matter; other tools add some, such as the key's id. */
static int take_json(cJSON **out, struct bytes file)
{
	cJSON *json;
	const int parsed = json_parse(&json, file);
	const cJSON *value = cJSON_GetObjectItemCaseSensitive(json, "keyval");
	const char *type = text_in(json, "keytype"), *scheme = text_in(json, "scheme");
	const char *public = text_in(value, "public"), *private = text_in(value, "private");
	int rc = type && scheme && public ? 0 : parsed < 0 ? parsed : -EBADMSG;

	if (private && *private)
		rc = -EPERM;
	if (rc == 0) {
		*out = entry_of(type, scheme, public);
		rc = *out ? 0 : -ENOMEM;
	}
	cJSON_Delete(json);
	return rc;
}

static int set_id(struct tuf_public_key *key)
{
	uint8_t hash[crypto_hash_sha256_BYTES];
	struct buffer canonical;
	int rc;

	buffer_init(&canonical, ENTRY_BYTES_MAX);
	rc = canonical_write(&canonical, key->entry);
	if (rc == 0) {
		crypto_hash_sha256(hash, canonical.data, canonical.size);
		sodium_bin2hex(key->id, sizeof(key->id), hash, sizeof(hash));
	}
	buffer_finish(&canonical);
	return rc;
}

int tuf_public_key_read(struct tuf_public_key *out, struct bytes file)
{
	int rc = -EBADMSG;

	*out = (struct tuf_public_key){ .entry = NULL };
	if (has(file, "PRIVATE KEY-----") || has(file, "gopura-key-1 "))
		return -EPERM;
	if (file.size > 0 && file.data[0] == '{')
		rc = take_json(&out->entry, file); /* the text of a key in it is PEM, too */
	else if (has(file, "-----BEGIN "))
		rc = take_pem(&out->entry, file);
	if (rc == 0) {
		rc = tuf_key_name_of(out->entry, &out->name);
		rc = rc < 0 ? rc : rc > 0 ? 0 : -EOPNOTSUPP;
	}
	return rc < 0 ? rc : set_id(out);
}

void tuf_public_key_finish(struct tuf_public_key *key)
{
	cJSON_Delete(key->entry);
	*key = (struct tuf_public_key){ .entry = NULL };
}

int tuf_public_key_write(struct buffer *out, const uint8_t public_key[32])
{
	EVP_PKEY *key = EVP_PKEY_new_raw_public_key(EVP_PKEY_ED25519, NULL, public_key,
						    crypto_sign_PUBLICKEYBYTES);
	int rc = key ? write_pem(out, key) : -ENOMEM;

	EVP_PKEY_free(key);
	return rc;
}
