/* Public keys of The Update Framework, and whether one of them signed a message.
 *
 * Three kinds (TUF 1.0.34, section 4.2): ed25519; ecdsa-sha2-nistp256 and rsassa-pss-sha256, which
 * hardware keys and cloud services make. */
#ifndef GOPURA_TUF_KEY_H
#define GOPURA_TUF_KEY_H

#include <stdbool.h>

#include "base/bytes.h"

struct cJSON;

/* Names a public key whatever id or white space a file gives it: of two entries with one name only
 * one counts. */
struct tuf_key_name {
	uint8_t sha256[32];
};

/* Returns 1 if the key, an object with keytype, scheme and keyval, signed the message, 0 if it did
 * not, or -ENOMEM; signature is hexadecimal. name is set to the key's name. A key of a kind that is
 * not known, or that is damaged or too short (RSA below 2048 bits), has signed nothing. */
must_check int tuf_key_signed(const struct cJSON *key, struct bytes message, const char *signature,
			      struct tuf_key_name *name);
/* Sets *name to a key's name. Returns 1; 0 for a key that can sign nothing, as above; or -ENOMEM.
 */
must_check int tuf_key_name_of(const struct cJSON *key, struct tuf_key_name *name);

#endif
