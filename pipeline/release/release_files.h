/* The signed files of a release folder: what is current, and what was.
 *
 *   root/N.json  release.json  timestamp.json  history/SEQUENCE.json (each release.json there was)
 *
 * Writing order, so that a reader never meets a name without what it names: packs and locator (see
 * pack.h), roots, history, release.json, timestamp.json. */
#ifndef GOPURA_PIPELINE_RELEASE_RELEASE_FILES_H
#define GOPURA_PIPELINE_RELEASE_RELEASE_FILES_H

#include "pipeline/keys/keys.h"

/* The current release by its signed file. -ENOENT: nothing was published yet. Other errors are
 * logged: a release.json that our own keys did not sign is never overwritten. */
must_check int release_files_current(struct release *out, const char *release,
				     const struct publisher_keys *keys);

/* The release of a sequence, out of the history. -ENOENT: there was none. */
must_check int release_files_at(struct release *out, const char *release,
				const struct publisher_keys *keys, uint64_t sequence);

/* The newest one before `current` that had another root. -ENOENT: there is none. */
must_check int release_files_before(struct release *out, const char *release,
				    const struct publisher_keys *keys,
				    const struct release *current);

/* Signs and writes roots, history, release.json, timestamp.json. keys_folder is where the roots
 * are. timestamp_life_s: how long the timestamp holds from now. */
must_check int release_files_write(const char *release, const char *keys_folder,
				   const struct publisher_keys *keys, const struct release *what,
				   int64_t timestamp_life_s);

/* A new timestamp for the release.json that is there. */
must_check int release_files_renew(const char *release, const struct publisher_keys *keys,
				   int64_t timestamp_life_s);

#endif
