/* The release in the form of The Update Framework (docs/tuf.md), beside its own signed files, where
 * the keys' folder has a tuf/1.root.json (pipeline/keys/keys_tuf.h):
 *
 *   tuf/N.root.json  tuf/timestamp.json  tuf/SEQUENCE.snapshot.json  tuf/SEQUENCE.targets.json
 *   tuf/targets/SHA256.release.json      the bytes of release.json, the one target
 *
 * The version of snapshot and targets is the release's sequence. Only the timestamp is ever
 * replaced, and it is written last. */
#ifndef GOPURA_PIPELINE_RELEASE_RELEASE_TUF_H
#define GOPURA_PIPELINE_RELEASE_RELEASE_TUF_H

#include "pipeline/keys/keys.h"

/* Brings all of it up to date with the release.json that is there, which says what: signs a new
 * timestamp, and the other files where they are of another release. Where the keys' folder has no
 * root for it, does nothing and returns 0. Errors are logged. */
must_check int release_tuf_write(const char *release, const char *keys_folder,
				 const struct publisher_keys *keys, const struct release *what,
				 int64_t timestamp_life_s);

#endif
