/* Reads a key with OpenSSL, and signs with it once. */
#include "tuf/private_key.h"

#include <errno.h>
#include <limits.h>
#include <openssl/evp.h>
#include <openssl/pem.h>
#include <openssl/rsa.h>
#include <string.h>

#include "tuf/openssl_memory.h"

enum { SIGNATURE_BYTES_MAX = 1024, RSA_BITS_LEAST = 2048 };

/* A key with a passphrase would make OpenSSL ask for it on the terminal. */
static int no_passphrase(char *out, int size, int writing, void *user)
{
	(void)out;
	(void)size;
	(void)writing;
	(void)user;
	return -1;
}

static EVP_PKEY *read_key(struct bytes pem)
{
	BIO *bio = pem.size <= INT_MAX ? BIO_new_mem_buf(pem.data, (int)pem.size) : NULL;
	EVP_PKEY *key = bio ? PEM_read_bio_PrivateKey(bio, NULL, no_passphrase, NULL) : NULL;

	BIO_free(bio);
	return key;
}

static bool is_usable(EVP_PKEY *key)
{
	char group[32];

	switch (EVP_PKEY_get_base_id(key)) {
	case EVP_PKEY_ED25519:
		return true;
	case EVP_PKEY_EC:
		return EVP_PKEY_get_group_name(key, group, sizeof(group), NULL) == 1 &&
		       strcmp(group, "prime256v1") == 0;
	case EVP_PKEY_RSA:
		return EVP_PKEY_get_bits(key) >= RSA_BITS_LEAST;
	default:
		return false;
	}
}

static bool sign(EVP_PKEY *key, struct bytes message, uint8_t *out, size_t *size)
{
	const int kind = EVP_PKEY_get_base_id(key);
	EVP_MD_CTX *context = EVP_MD_CTX_new();
	EVP_PKEY_CTX *padding = NULL; /* borrowed from context */
	bool ok = context && EVP_DigestSignInit(context, &padding,
						kind == EVP_PKEY_ED25519 ? NULL : EVP_sha256(),
						NULL, key) == 1;

	if (ok && kind == EVP_PKEY_RSA)
		ok = EVP_PKEY_CTX_set_rsa_padding(padding, RSA_PKCS1_PSS_PADDING) == 1 &&
		     EVP_PKEY_CTX_set_rsa_pss_saltlen(padding, RSA_PSS_SALTLEN_DIGEST) == 1;
	/* Without memory OpenSSL 3.0 reports success for RSA, with a size of -1. */
	ok = ok && EVP_DigestSign(context, out, size, message.data, message.size) == 1 &&
	     *size <= SIGNATURE_BYTES_MAX;
	EVP_MD_CTX_free(context);
	return ok;
}

/* tuf_private_sign, once. */
static int try_to_sign(uint8_t signature[SIGNATURE_BYTES_MAX], size_t *size, struct bytes pem,
		       struct bytes message)
{
	EVP_PKEY *key = read_key(pem);
	int rc = 0;

	*size = SIGNATURE_BYTES_MAX;
	if (!key)
		rc = -EBADMSG;
	else if (!is_usable(key))
		rc = -EOPNOTSUPP;
	else if (!sign(key, message, signature, size))
		rc = -EIO;
	EVP_PKEY_free(key);
	return openssl_lacked_memory() && rc < 0 ? -ENOMEM : rc;
}

int tuf_private_sign(struct buffer *out, struct bytes pem, struct bytes message)
{
	uint8_t signature[SIGNATURE_BYTES_MAX];
	size_t size;
	int rc = try_to_sign(signature, &size, pem, message);

	if (rc < 0 && rc != -ENOMEM) /* once more: tuf/openssl_memory.h */
		rc = try_to_sign(signature, &size, pem, message);
	if (rc == 0)
		buffer_put(out, signature, size);
	return rc < 0 ? rc : out->error;
}
