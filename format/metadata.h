/* Signed metadata: a minimal form of The Update Framework. A museum server holds
 *
 *   root/1.json ... root/N.json   keys and thresholds of the three roles; N is signed by N-1's keys
 *                                 and by its own
 *   release.json                  the release: root hash and size, sequence, expiry
 *   timestamp.json                short-lived: names the current release.json by its hash
 *
 * Each file is an envelope {"payload": BASE64, "signatures": [{"key": HEX, "signature": BASE64}]}.
 * Its signatures are ed25519 over "gopura-ROLE-v1\n" followed by the payload's exact bytes. So no
 * canonical JSON is needed, and a file of one role cannot pass for another's. A key is named by the
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

/* Contents of root/N.json. */
struct trust_root {
	uint32_t version;          /* N */
	int64_t expires_s;         /* seconds since 1970 */
	struct role_keys roles[3]; /* indexed by enum meta_role */
};

struct release {
	uint64_t sequence; /* never decreases */
	int64_t expires_s;
	struct hash root; /* hash of the root page */
	uint32_t root_bytes;
	char comment[256]; /* written by the publisher, for people */
	/* The last version of tuf/N.root.json when it was published; 0: there is none. */
	uint32_t tuf_root;
};

struct timestamp {
	uint64_t sequence; /* of the release that it names */
	int64_t expires_s;
	int64_t issued_s;    /* when it was signed, by the publisher's clock; 0: it does not say */
	struct hash release; /* of the bytes of release.json */
};

/* These decode a file and check its signatures against the role's keys in trust. They return
 *   -EBADMSG  not such a file            -EKEYREJECTED  fewer valid signatures than the threshold
 * or -ENOMEM. why (may be NULL) is set to a static text for the health page if a file is refused.
 * The caller judges expiry and sequence: only it knows whether the clock is set. *out is zeroed on
 * failure.
 *
 * trust_root_first() has no earlier root: it checks the file against the keys that it contains. */
must_check int trust_root_first(struct trust_root *out, struct bytes file, const char **why);
/* The version must be trust->version + 1, and both the old and the new root keys must have signed.
 * On success *trust is the new root; on failure it is unchanged. */
must_check int trust_root_next(struct trust_root *trust, struct bytes file, const char **why);
/* See above. These two check only the keys of their own role. */
must_check int release_decode(struct release *out, const struct trust_root *trust,
			      struct bytes file, const char **why);
/* Reads a release.json without its signatures: for one that is a signed target of The Update
 * Framework. Returns as release_decode. */
must_check int release_decode_target(struct release *out, struct bytes file, const char **why);
must_check int timestamp_decode(struct timestamp *out, const struct trust_root *trust,
				struct bytes file, const char **why);

#endif
