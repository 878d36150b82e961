/* Writes and signs metadata files, for the publisher. format/metadata.h describes them. */
#ifndef GOPURA_FORMAT_METADATA_SIGN_H
#define GOPURA_FORMAT_METADATA_SIGN_H

#include "format/metadata.h"

/* For the publisher. secret: 64 bytes as libsodium's crypto_sign makes them. */
struct signing_key {
	uint8_t public_key[KEY_BYTES];
	uint8_t secret[64];
};
/* Each appends a signed file with one signature per key. Nothing checks whether these are the
 * role's keys. Returns -ENOMEM or the error of out. */
must_check int trust_root_encode(struct buffer *out, const struct trust_root *root,
				 const struct signing_key *keys, uint32_t key_count);
must_check int release_encode(struct buffer *out, const struct release *release,
			      const struct signing_key *keys, uint32_t key_count);
must_check int timestamp_encode(struct buffer *out, const struct timestamp *timestamp,
				const struct signing_key *keys, uint32_t key_count);

#endif
