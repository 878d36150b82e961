/* Writes signed metadata of The Update Framework: with ed25519 keys, whose seeds are files of 32
 * bytes (docs/release.md, Keys), or with signatures that were made elsewhere. */
#ifndef GOPURA_TUF_SIGN_H
#define GOPURA_TUF_SIGN_H

#include "tuf/tuf_metadata.h"

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

/* Returns the content of a file of that type with the members that all have, owned by the caller;
 * NULL: no memory. */
struct cJSON *tuf_content(enum tuf_type type, uint32_t version, int64_t expires_s);
/* Returns a content of the next version with all other members of the last one, which may be empty;
 * owned by the caller; NULL: no memory. */
struct cJSON *tuf_next_content(const struct tuf_file *last, enum tuf_type type, uint32_t version,
			       int64_t expires_s);
/* Adds what a timestamp or a snapshot says of a metadata file, or targets of a target: its length
 * and SHA-256; version 0: none. Returns the entry, borrowed; NULL: no memory. */
struct cJSON *tuf_add_file(struct cJSON *to, const char *name, uint32_t version, struct bytes file);

/* Returns whether a role names the key with this id. */
bool tuf_role_names(const struct cJSON *role, const char *keyid);
/* Removes from keys those that no role names; roles: their array, or the object that a root has. */
void tuf_drop_unused_keys(struct cJSON *keys, const struct cJSON *roles);

/* Appends a whole file to out: content, which becomes the member "signed", and one signature of
 * each signer. The same content and keys give the same bytes. Returns as canonical_write. */
must_check int tuf_sign(struct buffer *out, const struct cJSON *content,
			const struct tuf_signer *signers, uint32_t count);

/* Adds a signature's bytes to signatures, an array, under the id of that of the role's keys which
 * made it; one that the key has there already is replaced. message: the canonical form of the
 * content. keys and role as for tuf_file_verify. Returns 0; -EKEYREJECTED: none of them made it;
 * -ENOMEM. */
must_check int tuf_add_signature(struct cJSON *signatures, const struct cJSON *keys,
				 const struct cJSON *role, struct bytes message,
				 struct bytes signature);
/* Appends a whole file to out, as tuf_sign does. */
must_check int tuf_write_signed(struct buffer *out, struct bytes message,
				const struct cJSON *signatures);

#endif
