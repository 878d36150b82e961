/* The root of The Update Framework for the publisher's keys (docs/tuf.md): FOLDER/tuf/1.root.json,
 * beside root/1.json. root.key signs roots, release.key targets and snapshots, timestamp.key
 * timestamps. Tools of The Update Framework may put 2.root.json and later ones beside it. */
#ifndef GOPURA_PIPELINE_KEYS_KEYS_TUF_H
#define GOPURA_PIPELINE_KEYS_KEYS_TUF_H

#include "pipeline/keys/keys.h"

/* Makes and signs the first root, valid as long as the newest root/N.json. Where there is one
 * already it stays. -ENOENT: root.key is not in the folder. Errors are logged. */
must_check int keys_make_tuf_root(const char *folder, const struct publisher_keys *keys);

/* The same for a museum that has several temples on one server: makes snapshot.key too, if it is
 * missing, and a root whose snapshots that key may sign as well as the keys of the targets. Where
 * there is a root that does not name it, makes the next one. */
must_check int keys_make_museum_root(const char *folder, const struct publisher_keys *keys);

/* Reads tuf/VERSION.root.json into *out, cleared first. -ENOENT: there is none. */
must_check int keys_read_tuf_root(struct buffer *out, const char *folder, uint32_t version);
/* Sets *out to the last version of tuf/N.root.json that is there, counted from 1 on; 0: none. If
 * that cannot be told, returns a negative errno, logged, and *out is 0. */
must_check int keys_last_tuf_root(uint32_t *out, const char *folder);

#endif
