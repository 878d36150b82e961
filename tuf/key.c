/* ed25519 by libsodium, the others by OpenSSL. */
#include "tuf/key.h"

#include <cjson/cJSON.h>
#include <errno.h>
#include <openssl/bio.h>
#include <openssl/evp.h>
#include <openssl/pem.h>
#include <openssl/rsa.h>
#include <sodium.h>
#include <string.h>

#include "tuf/openssl_memory.h"

enum {
	SIGNATURE_BYTES_MAX = 1024, /* of RSA with 8192 bits */
	RSA_BITS_LEAST = 2048,
	PUBLIC_CHARS_MAX = 4096,
};

struct signature {
	uint8_t bytes[SIGNATURE_BYTES_MAX];
	size_t size;
};

static const char *text(const cJSON *object, const char *name)
{
	return cJSON_GetStringValue(cJSON_GetObjectItemCaseSensitive(object, name));
}

static bool read_hex(uint8_t *out, size_t room, size_t *size, const char *hex)
{
	return sodium_hex2bin(out, room, hex, strlen(hex), NULL, size, NULL) == 0;
}

/* ---- ed25519 */

static bool read_ed25519(const char *public, uint8_t key[crypto_sign_PUBLICKEYBYTES],
			 struct tuf_key_name *name)
{
	size_t size;

	if (!read_hex(key, crypto_sign_PUBLICKEYBYTES, &size, public) ||
	    size != crypto_sign_PUBLICKEYBYTES)
		return false;
	crypto_hash_sha256(name->sha256, key, crypto_sign_PUBLICKEYBYTES);
	return true;
}

static bool verify_ed25519(const uint8_t key[crypto_sign_PUBLICKEYBYTES], struct bytes message,
			   const struct signature *signature)
{
	return signature->size == crypto_sign_BYTES &&
	       crypto_sign_verify_detached(signature->bytes, message.data, message.size, key) == 0;
}

/* ---- ECDSA and RSA */

static bool is_p256(EVP_PKEY *key)
{
	char group[32];

	return EVP_PKEY_get_base_id(key) == EVP_PKEY_EC &&
	       EVP_PKEY_get_group_name(key, group, sizeof(group), NULL) == 1 &&
	       strcmp(group, "prime256v1") == 0;
}

static bool is_rsa(EVP_PKEY *key)
{
	return EVP_PKEY_get_base_id(key) == EVP_PKEY_RSA &&
	       EVP_PKEY_get_bits(key) >= RSA_BITS_LEAST;
}

static bool name_key(EVP_PKEY *key, struct tuf_key_name *name)
{
	unsigned char *der = NULL;
	const int size = i2d_PUBKEY(key, &der);

	if (size > 0)
		crypto_hash_sha256(name->sha256, der, (unsigned long long)size);
	OPENSSL_free(der);
	return size > 0;
}

static bool verify(EVP_PKEY *key, bool pss, struct bytes message, const struct signature *signature)
{
	EVP_MD_CTX *context = EVP_MD_CTX_new();
	EVP_PKEY_CTX *padding = NULL;
	bool ok = context && EVP_DigestVerifyInit(context, &padding, EVP_sha256(), NULL, key) == 1;

	if (ok && pss)
		ok = EVP_PKEY_CTX_set_rsa_padding(padding, RSA_PKCS1_PSS_PADDING) == 1 &&
		     EVP_PKEY_CTX_set_rsa_pss_saltlen(padding, RSA_PSS_SALTLEN_AUTO) == 1;
	ok = ok && EVP_DigestVerify(context, signature->bytes, signature->size, message.data,
				    message.size) == 1;
	EVP_MD_CTX_free(context);
	return ok;
}

/* ---- keys of every kind */

/* Which of the three kinds a key is. */
enum scheme { SCHEME_NONE, SCHEME_ED25519, SCHEME_ECDSA, SCHEME_RSA };

static enum scheme scheme_of(const cJSON *key)
{
	const char *type = text(key, "keytype"), *scheme = text(key, "scheme");

	if (!type || !scheme)
		return SCHEME_NONE;
	if (strcmp(scheme, "ed25519") == 0 && strcmp(type, "ed25519") == 0)
		return SCHEME_ED25519;
	/* older files give the scheme as the type, too */
	if (strcmp(scheme, "ecdsa-sha2-nistp256") == 0 &&
	    (strcmp(type, "ecdsa") == 0 || strcmp(type, scheme) == 0))
		return SCHEME_ECDSA;
	if (strcmp(scheme, "rsassa-pss-sha256") == 0 && strcmp(type, "rsa") == 0)
		return SCHEME_RSA;
	return SCHEME_NONE;
}

/* judge, for the two kinds of keys that OpenSSL verifies. */
static int judge_pem(const char *public, enum scheme scheme, struct bytes message,
		     const struct signature *signature, struct tuf_key_name *name)
{
	BIO *bio = BIO_new_mem_buf(public, -1);
	EVP_PKEY *key = bio ? PEM_read_bio_PUBKEY(bio, NULL, NULL, NULL) : NULL;
	bool ok = key && (scheme == SCHEME_RSA ? is_rsa(key) : is_p256(key)) &&
		  name_key(key, name) &&
		  (!signature || verify(key, scheme == SCHEME_RSA, message, signature));

	EVP_PKEY_free(key);
	BIO_free(bio);
	return (openssl_lacked_memory() && !ok) || !bio ? -ENOMEM : ok;
}

/* Names the key and, with a signature, verifies it. */
static int judge(const cJSON *key, struct bytes message, const struct signature *signature,
		 struct tuf_key_name *name)
{
	const char *public = text(cJSON_GetObjectItemCaseSensitive(key, "keyval"), "public");
	const enum scheme scheme = scheme_of(key);
	uint8_t raw[crypto_sign_PUBLICKEYBYTES];
	int ok;

	if (scheme == SCHEME_NONE || !public || strlen(public) > PUBLIC_CHARS_MAX)
		return 0;
	if (scheme == SCHEME_ED25519)
		return read_ed25519(public, raw, name) &&
		       (!signature || verify_ed25519(raw, message, signature));
	ok = judge_pem(public, scheme, message, signature, name);
	/* once more: tuf/openssl_memory.h */
	return ok == 0 ? judge_pem(public, scheme, message, signature, name) : ok;
}

int tuf_key_signed(const cJSON *key, struct bytes message, const char *signature,
		   struct tuf_key_name *name)
{
	struct signature read;

	if (!read_hex(read.bytes, sizeof(read.bytes), &read.size, signature))
		return 0;
	return judge(key, message, &read, name);
}

int tuf_key_name_of(const cJSON *key, struct tuf_key_name *name)
{
	return judge(key, (struct bytes){ NULL, 0 }, NULL, name);
}
