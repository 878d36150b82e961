/* Private keys in PEM, as OpenSSL and other tools write them. */
#ifndef GOPURA_TUF_PRIVATE_KEY_H
#define GOPURA_TUF_PRIVATE_KEY_H

#include "base/bytes.h"

/* Signs a message as tuf/key.h checks it: ed25519; ECDSA on P-256, or RSA-PSS from 2048 bits, over
 * SHA-256. Appends the signature's bytes to *out. Returns 0; -EBADMSG: not a private key in PEM, or
 * one with a passphrase; -EOPNOTSUPP: a key of another kind; -EIO: OpenSSL failed; -ENOMEM. */
must_check int tuf_private_sign(struct buffer *out, struct bytes pem, struct bytes message);

#endif
