/* Signs metadata of The Update Framework with ed25519 keys, whose seeds are files of 32 bytes
 * (docs/release.md, Keys). */
#ifndef GOPURA_TUF_SIGN_H
#define GOPURA_TUF_SIGN_H

#include "base/bytes.h"

struct cJSON;

struct tuf_signer {
	uint8_t public_key[32], secret[64];
	char id[65]; /* SHA-256 of the key's canonical form, in hexadecimal */
};

/* Derives the keys from a seed. -ENOMEM. */
must_check int tuf_signer_init(struct tuf_signer *out, const uint8_t seed[32]);
/* Overwrites the secret. */
void tuf_signer_finish(struct tuf_signer *signer);
/* Returns the public key as an entry of keys, owned by the caller; NULL: no memory. */
struct cJSON *tuf_signer_key(const struct tuf_signer *signer);

/* Appends a whole file to out: content, which becomes the member "signed", and one signature of
 * each signer. The same content and keys give the same bytes. Returns as canonical_write. */
must_check int tuf_sign(struct buffer *out, const struct cJSON *content,
			const struct tuf_signer *signers, uint32_t count);

#endif
