/* The signed files of a release folder: the current release and the earlier ones.
 *
 *   root/N.json  release.json  timestamp.json  history/SEQUENCE.json (every release.json so far)
 *
 * Files are written in this order, so that a reader never finds a name before the file it names:
 * packs and locator (see pack.h), roots, history, release.json, timestamp.json. */
#ifndef GOPURA_PIPELINE_RELEASE_RELEASE_FILES_H
#define GOPURA_PIPELINE_RELEASE_RELEASE_FILES_H

#include "pipeline/keys/keys.h"

/* keys_folder holds the roots. */

/* Reads the current release from its signed file. Returns -ENOENT if nothing was published yet; or
 * by a release.key that was exchanged, and *out is that release then, of which only the number
 * counts. Other errors are logged: a release.json that our own keys did not sign is never
 * overwritten, and nothing is by keys that terminals trust no more (keys_check_release). */
must_check int release_files_current(struct release *out, const char *release,
				     const char *keys_folder, const struct publisher_keys *keys);

/* Reads the release with that sequence from the history. Returns -ENOENT if there was none. */
must_check int release_files_at(struct release *out, const char *release, const char *keys_folder,
				const struct publisher_keys *keys, uint64_t sequence);

/* Reads the newest release before `current` that had another root. Returns -ENOENT if there is
 * none. */
must_check int release_files_before(struct release *out, const char *release,
				    const char *keys_folder, const struct publisher_keys *keys,
				    const struct release *current);

/* Reads when the timestamp was signed. 0: there is none, it does not say, or keys signed it that do
 * not count any more. Errors of reading are logged. */
must_check int release_files_issued_s(int64_t *out, const char *release,
				      const struct publisher_keys *keys);

/* Signs and writes roots, history, release.json and timestamp.json. timestamp_life_s: how long the
 * timestamp is valid from now, seconds. Errors are logged. */
must_check int release_files_write(const char *release, const char *keys_folder,
				   const struct publisher_keys *keys, const struct release *what,
				   int64_t timestamp_life_s);

/* Writes roots, and a new timestamp for the current release.json. */
must_check int release_files_renew(const char *release, const char *keys_folder,
				   const struct publisher_keys *keys, int64_t timestamp_life_s);

/* Writes or replaces a file of the release folder, whole or not at all, so that a server tells it
 * from the one before. Errors are logged. */
must_check int release_files_put(const char *release, const char *name, struct bytes bytes);

#endif
