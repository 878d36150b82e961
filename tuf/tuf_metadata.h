/* Metadata files of The Update Framework (TUF 1.0.34, section 4): one is parsed and checked for
 * shape, then its signatures are counted against what its delegator says.
 *
 * A file stays the JSON tree that it is, because signatures cover all of it, also members that this
 * version does not know. What is parsed may be relied on: members named in the specification are
 * there, of their kind and within their ranges. */
#ifndef GOPURA_TUF_TUF_METADATA_H
#define GOPURA_TUF_TUF_METADATA_H

#include <stdbool.h>

#include "base/bytes.h"

struct cJSON;

enum tuf_type { TUF_ROOT, TUF_TIMESTAMP, TUF_SNAPSHOT, TUF_TARGETS, TUF_TYPES };

/* "root", "timestamp", "snapshot", "targets": the value of _type, and the name of that role. */
extern const char *const tuf_type_names[TUF_TYPES];

struct tuf_file {
	struct cJSON *json;          /* owned; NULL: none */
	const struct cJSON *content; /* the member "signed" */
	uint32_t version;            /* at least 1 */
	int64_t expires_s;           /* since 1970 */
};

/* Parses a file of that type. Returns 0; -EBADMSG: it is not such a file, and *why is set to a
 * static text that says why not, as after -ENOMEM. *out is zeroed on failure. */
must_check int tuf_file_parse(struct tuf_file *out, struct bytes bytes, enum tuf_type type,
			      const char **why);
/* Frees it. Zeroed is fine. */
void tuf_file_finish(struct tuf_file *file);

/* Counts the different keys of the role that signed the file. keys: an object of keys by id; role:
 * an object with keyids and threshold. Returns 0; -EKEYREJECTED: fewer than the threshold;
 * -EBADMSG: the file has no canonical form; -ENOMEM. */
must_check int tuf_file_verify(const struct tuf_file *file, const struct cJSON *keys,
			       const struct cJSON *role);

/* Parses a root that nobody before it has signed: a first one, which must have enough signatures of
 * its own keys. Returns as the two above; *why is set to a static text after -EKEYREJECTED too.
 * *out is zeroed on failure. */
must_check int tuf_root_first(struct tuf_file *out, struct bytes bytes, const char **why);

/* Of a root: its keys, the role of a type, and whether file names carry versions and hashes. */
const struct cJSON *tuf_root_keys(const struct tuf_file *root);
const struct cJSON *tuf_root_role(const struct tuf_file *root, enum tuf_type type);
bool tuf_root_is_consistent(const struct tuf_file *root);

/* Of a timestamp or snapshot: what it says of a metadata file, "snapshot.json", or NULL. */
const struct cJSON *tuf_meta(const struct tuf_file *file, const char *name);
/* Returns the version in such an entry. */
uint32_t tuf_meta_version(const struct cJSON *meta);

/* Returns when a timestamp was signed, by its member issued_s: ours, which other clients ignore. 0:
 * it does not say, or nonsense. */
int64_t tuf_issued_s(const struct tuf_file *timestamp);

/* Returns the length that an entry of metadata or of a target gives, or otherwise. */
uint64_t tuf_length(const struct cJSON *entry, uint64_t otherwise);
/* Returns whether bytes have the length and the hashes that an entry gives; where it gives hashes,
 * sha256 or sha512 must be among them. */
bool tuf_matches(const struct cJSON *entry, struct bytes bytes);

#endif
