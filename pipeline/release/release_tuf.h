/* The release in the form of The Update Framework (docs/tuf.md):
 *
 *   tuf/N.root.json  tuf/timestamp.json  tuf/N.snapshot.json  tuf/SEQUENCE.targets.json
 *   tuf/targets/SHA256.release.json      the bytes of release.json
 *
 * or, where the targets delegate a path to a role of this temple,
 *
 *   tuf/SEQUENCE.ROLE.json  tuf/targets/FOLDER/SHA256.release.json
 *
 * Only the timestamp is ever replaced, and it is written last. What others published in the same
 * folder (targets, delegations, versions in the snapshot) is carried on. One publisher at a time:
 * the folder tuf is locked. */
#ifndef GOPURA_PIPELINE_RELEASE_RELEASE_TUF_H
#define GOPURA_PIPELINE_RELEASE_RELEASE_TUF_H

#include "pipeline/release/tuf_folder.h"

/* Puts the roots of the keys' folder into tuf/. Publishing does so too, but a release.json that
 * says that there are roots must come after them. Errors are logged. */
must_check int release_tuf_put_roots(const struct tuf_place *place);

/* Publishes release_file, the bytes of a release.json whose content is *what: signs a new
 * timestamp, and the other files where the release is another one. They are signed as signing.ini
 * of the keys' folder says (pipeline/keys/signing.h); nothing is written unless all of them have
 * signatures enough.
 *
 * unsigned_folder, if not NULL, gets the files instead, with the signatures that there are, and
 * beside each NAME.bytes, the bytes to be signed; release_tuf_add_signatures goes on from there.
 * Errors are logged. */
must_check int release_tuf_write(const struct tuf_place *place, const struct release *what,
				 struct bytes release_file, int64_t timestamp_life_s,
				 const char *unsigned_folder);

/* What becomes of targets.json besides a release: edit changes its next content, which has all that
 * the last one had, while the folder is locked. Returns 0 or a negative errno, logged; nothing is
 * written then. */
struct tuf_change {
	int (*edit)(void *context, const struct tuf_folder *folder, struct cJSON *content);
	void *context;
	int64_t expires_s; /* of targets.json and the snapshot, since 1970 */
	/* Somebody looked at what there is, so it is carried on even if a key signed it that was
	 * exchanged since. Otherwise -EKEYREJECTED. */
	bool renews;
};

/* Signs the next version of targets.json, with snapshot and timestamp; the rest as
 * release_tuf_write. place has no role. */
must_check int release_tuf_change(const struct tuf_place *place, const struct tuf_change *change,
				  int64_t timestamp_life_s, const char *unsigned_folder);

/* Publishes what was staged in a folder, with the signatures of NAME.*.sig beside each file: see
 * tuf_staged_read. Where snapshot and timestamp have too few, those whom signing.ini names sign
 * them. -EKEYREJECTED: a file has too few signatures; nothing is published then. -ESTALE: something
 * else was published since it was staged. Errors are logged. */
must_check int release_tuf_add_signatures(const struct tuf_place *place, const char *staged_folder);

#endif
