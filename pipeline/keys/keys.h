/* The publisher's signing keys. They have their own folder, never inside a release, and by default
 * not inside the content either (pipeline/keys/keys_place.h).
 *
 *   root.key release.key timestamp.key   "gopura-key-1 ROLE HEX", an ed25519 seed; mode 0600
 *   root/1.json ... root/N.json          the signed roots, as published
 *
 * root.key may be moved away once root/1.json exists, because it is only needed to sign the next
 * root. Publishing needs the other two. */
#ifndef GOPURA_PIPELINE_KEYS_KEYS_H
#define GOPURA_PIPELINE_KEYS_KEYS_H

#include "format/metadata.h"
#include "format/metadata_sign.h"

/* A root must stay valid longer than the terminals that were shipped with it live: 20 years. */
enum { KEYS_ROOT_LIFE_S = 20 * 365 * 86400 };

struct publisher_keys {
	struct signing_key release, timestamp;
	struct trust_root trust; /* the newest root */
};

/* Creates three keys and root/1.json. A new folder is first created as FOLDER.part and renamed when
 * it is complete. The remains of an interrupted run are used and completed. Nobody else may work on
 * the folder at the same time. -EEXIST: it has keys already. Errors are logged. */
must_check int keys_make(const char *folder);
/* Returns whether the folder has a key or root/1.json, or that cannot be told. */
bool keys_are_in(const char *folder);
/* Returns whether the open file is one of these keys. */
bool keys_is_key_file(int fd);
/* Reads the text of one. role: whose it must be; NULL: anybody's. The caller wipes *out. -EBADMSG.
 */
must_check int keys_decode(struct signing_key *out, struct bytes file, const char *role);
/* Makes changes in this folder survive a power cut. Errors are logged. */
must_check int keys_sync_folder(const char *folder);
/* The same for the folder that contains this one. */
must_check int keys_sync_parent(const char *folder);
/* Reads what publishing needs and checks that the newest root names both keys. keys_finish frees
 * *out, and it is wiped on failure. -ENOENT: there is no root/1.json, or a key is missing. -EPERM:
 * others may read a key. -EBADMSG: damaged. -EKEYREJECTED: not the root's keys. -EBUSY: an exchange
 * of keys was not finished. Errors are logged, except that there is no root/1.json. */
must_check int keys_load(struct publisher_keys *out, const char *folder);
void keys_finish(struct publisher_keys *keys); /* Wipes the keys. NULL is fine. */
/* Returns -EKEYREJECTED, logged, if a release folder has later roots than these keys, as after an
 * exchange that was made elsewhere, and the newest of them does not name them: terminals would
 * refuse what they sign. Errors of reading are logged too. */
must_check int keys_check_release(const struct publisher_keys *keys, const char *release);

/* Reads NAME.key, a key besides those three, or makes it where there is none. The caller wipes
 * *out. Errors as of keys_load. */
must_check int keys_named(struct signing_key *out, const char *folder, const char *name);
/* Writes a complete new file or none. It is never readable by others, not even for a moment. */
must_check int keys_write_private(const char *path, const char *text);

/* Reads NAME.key alone, of which the caller wipes *out. -ENOENT: it is not in the folder. Other
 * errors are logged. */
must_check int keys_read_key(struct signing_key *out, const char *folder, const char *name);
/* Writes a key of that name as keys_write_private does. Errors are logged. */
must_check int keys_write_key(const char *path, const char *name, const struct signing_key *key);

/* Reads root/VERSION.json into *out, cleared first. -ENOENT: there is none. */
must_check int keys_read_root(struct buffer *out, const char *folder, uint32_t version);

/* Reads the newest root, after all before it. -ENOENT: there is no root/1.json. Other errors are
 * logged. */
must_check int keys_read_trust(struct trust_root *trust, const char *folder);

/* Verifies root/2.json, root/3.json, ... of folder in turn, starting after *trust, and updates
 * *trust. Returns the error of trust_root_next, or of reading; *why is as in format/metadata.h
 * after the first. */
must_check int keys_follow_roots(struct trust_root *trust, const char *folder, const char **why);

#endif
