/* Signed metadata, as in The Update Framework, as small as it can be. A museum server holds
 *
 *   root/1.json ... root/N.json   keys and thresholds of the three roles; N is signed by N-1's keys
 *                                 and by its own
 *   release.json                  the release: root hash and size, sequence, expiry
 *   timestamp.json                short-lived: names the current release.json by its hash
 *
 * Each file is an envelope {"payload": BASE64, "signatures": [{"key": HEX, "signature": BASE64}]}
 * whose signatures are ed25519 over "gopura-ROLE-v1\n" followed by the payload's exact bytes, so
 * that no canonical JSON is needed and no role's file can pass for another's. A key is named by the
 * hash of its 32 bytes. */
#ifndef GOPURA_FORMAT_METADATA_H
#define GOPURA_FORMAT_METADATA_H

#include "format/message.h"

enum { KEY_BYTES = 32, KEYS_MAX = 8, METADATA_FILE_BYTES_MAX = MESSAGE_META_BYTES_MAX };

struct role_keys {
	uint32_t threshold;
	uint32_t key_count;
	uint8_t keys[KEYS_MAX][KEY_BYTES];
};

/* What root/N.json says. */
struct trust_root {
	uint32_t version;          /* N */
	int64_t expires_s;         /* seconds since 1970 */
	struct role_keys roles[3]; /* indexed by enum meta_role */
};

struct release {
	uint64_t sequence; /* never falls */
	int64_t expires_s;
	struct hash root; /* of the root page */
	uint32_t root_bytes;
	char comment[256]; /* the publisher's, for people */
};

struct timestamp {
	uint64_t sequence; /* of the release it names */
	int64_t expires_s;
	int64_t issued_s;    /* when it was signed, by the publisher's clock; 0: it does not say */
	struct hash release; /* of release.json's bytes */
};

/* Decode and check the signatures against the role's keys in trust.
 *   -EBADMSG  not such a file            -EKEYREJECTED  fewer good signatures than the threshold
 * why (may be NULL) is set to a static text for the health page. Expiry and sequence are the
 * caller's to judge: only it knows whether the clock is set. */
must_check int trust_root_first(struct trust_root *out, struct bytes file, const char **why);
/* Version must be trust->version + 1, signed by both. On success *trust is the new one. */
must_check int trust_root_next(struct trust_root *trust, struct bytes file, const char **why);
must_check int release_decode(struct release *out, const struct trust_root *trust,
			      struct bytes file, const char **why);
must_check int timestamp_decode(struct timestamp *out, const struct trust_root *trust,
				struct bytes file, const char **why);

/* The publisher's side. secret: 64 bytes as libsodium's crypto_sign makes them. */
struct signing_key {
	uint8_t public_key[KEY_BYTES];
	uint8_t secret[64];
};
must_check int trust_root_encode(struct buffer *out, const struct trust_root *root,
				 const struct signing_key *keys, uint32_t key_count);
must_check int release_encode(struct buffer *out, const struct release *release,
			      const struct signing_key *keys, uint32_t key_count);
must_check int timestamp_encode(struct buffer *out, const struct timestamp *timestamp,
				const struct signing_key *keys, uint32_t key_count);

#endif
