/* Public keys as files, for those who say which keys may sign. */
#ifndef GOPURA_TUF_PUBLIC_KEY_H
#define GOPURA_TUF_PUBLIC_KEY_H

#include "tuf/key.h"

struct tuf_public_key {
	struct cJSON *entry; /* keytype, scheme and keyval, as tuf_key_signed takes them; owned */
	char id[65];         /* SHA-256 of the entry's canonical form, in hexadecimal */
	struct tuf_key_name name;
};

/* Reads a public key: PEM ("BEGIN PUBLIC KEY", as openssl, Python's cryptography and PKCS #11 tools
 * write it), or JSON as in metadata of The Update Framework. ed25519, ECDSA P-256, or RSA from 2048
 * bits. Returns 0; -EBADMSG: neither of the two forms; -EOPNOTSUPP: a key of another kind;
 * -EPERM: a private key, which nobody should hand over; -ENOMEM. tuf_public_key_finish frees *out,
 * also after a failure. */
must_check int tuf_public_key_read(struct tuf_public_key *out, struct bytes file);
void tuf_public_key_finish(struct tuf_public_key *key); /* Zeroed is fine. */

/* Appends an ed25519 key in PEM, which tuf_public_key_read and other tools read. -ENOMEM. */
must_check int tuf_public_key_write(struct buffer *out, const uint8_t public_key[32]);

#endif
