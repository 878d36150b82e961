/* The publisher's signing keys: a folder of their own, never inside a release, and by default not
 * inside the content either (pipeline/keys/keys_place.h).
 *
 *   root.key release.key timestamp.key   "gopura-key-1 ROLE HEX", an ed25519 seed; mode 0600
 *   root/1.json ... root/N.json          the signed roots, as published
 *
 * root.key may be taken away once root/1.json is made (it signs the next root only); publishing
 * needs the other two. */
#ifndef GOPURA_PIPELINE_KEYS_KEYS_H
#define GOPURA_PIPELINE_KEYS_KEYS_H

#include "format/metadata.h"

struct publisher_keys {
	struct signing_key release, timestamp;
	struct trust_root trust; /* the newest root */
};

/* Makes three keys and root/1.json. A folder that does not exist is made aside, as FOLDER.part, and
 * renamed when it is whole. What an interrupted run left is used and completed. Nobody else may
 * work on folder meanwhile. -EEXIST: it has keys already. Errors are logged. */
must_check int keys_make(const char *folder);
/* Whether a key or root/1.json is there. */
bool keys_are_in(const char *folder);
/* Whether an open file is one of these keys. */
bool keys_is_key_file(int fd);
/* What was made or renamed in a folder, or in the one that folder lies in, outlives a power cut.
 * Errors are logged. */
must_check int keys_sync_folder(const char *folder);
must_check int keys_sync_parent(const char *folder);
/* Reads what publishing needs, and checks that the newest root names both keys. -ENOENT: no keys.
 * -EPERM: others may read a key. -EBADMSG, -EKEYREJECTED: damaged, or not the root's keys. Errors
 * but -ENOENT are logged. */
must_check int keys_load(struct publisher_keys *out, const char *folder);
void keys_finish(struct publisher_keys *keys); /* wipes; NULL is fine */

/* Bytes of root/VERSION.json in folder, cleared first. -ENOENT: none. */
must_check int keys_read_root(struct buffer *out, const char *folder, uint32_t version);

/* Follows root/2.json, root/3.json, ... of folder from trust on. why as in format/metadata.h. */
must_check int keys_follow_roots(struct trust_root *trust, const char *folder, const char **why);

#endif
