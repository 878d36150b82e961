/* The kiosk's persistent state: the release it shows, the trust root, and the floors, which only
 * the keys that set them can lower. docs/cache.md describes what happens after damage.
 *
 * It is an SQLite database at PATH with synchronous=FULL. Each change is one transaction, so after
 * a power cut it is either complete or absent. A damaged file is renamed to PATH.broken, and the
 * state is read from PATH.second, a copy with a checksum that is written after each change. One
 * thread. Calls that write wait for the disk, so do not make them on the frame path. */
#ifndef GOPURA_STORAGE_STATE_H
#define GOPURA_STORAGE_STATE_H

#include "format/hash.h"

struct state; /* private to state.c */

enum {
	STATE_FILE_BYTES_MAX = 64 * 1024, /* maximum size of a metadata file */
	STATE_TRIES_MAX = 3,              /* attempts to show a release that has never worked */
};

struct state_release {
	struct hash root;
	uint32_t root_bytes;
	uint64_t sequence;
	struct bytes file; /* release.json as received; borrowed */
};

/* The metadata of The Update Framework that was accepted last (docs/tuf.md); borrowed. */
struct state_tuf {
	struct bytes root, timestamp, snapshot, targets; /* as received; empty: none yet */
};

/* path is copied. *out is owned by the caller. The only error is -ENOMEM: if the disk fails, the
 * state is what could be read (or empty), and changes are refused with -EIO. */
must_check int state_create(struct state **out, const char *path);
void state_destroy(struct state *state); /* NULL is fine */

/* Reads the release in use; *out is borrowed until the next change. -ENOENT: none yet. */
must_check int state_release(const struct state *state, struct state_release *out);
/* Reads the previous release, the last one that worked. It is kept until another release is
 * activated while the one in use is proven. Borrowed until the next change. -ENOENT: none. */
must_check int state_previous(const struct state *state, struct state_release *out);
/* Returns how often the kiosk tried to show the release in use since state_activate; 0: it is
 * proven. */
uint32_t state_tries(const struct state *state);
/* Reads the file of the trust root in use (root/N.json as received); borrowed. -ENOENT: none
 * yet. */
must_check int state_trust(const struct state *state, struct bytes *out);
/* Reads the trusted metadata of The Update Framework; borrowed until the next change. -ENOENT:
 * there is no root, so this terminal follows the other form. */
must_check int state_tuf(const struct state *state, struct state_tuf *out);
/* Returns the lowest sequence number that may be activated; 0 at first. */
uint64_t state_sequence_floor(const struct state *state);
/* Returns the earliest time it can be now according to signed metadata, in seconds since 1970; 0 at
 * first. */
int64_t state_time_floor_s(const struct state *state);

/* Copies *release and sets the sequence floor to its sequence. If the root differs, the release in
 * use becomes the previous one (if it was proven), and the first try begins. -ESTALE: below the
 * floor. -EFBIG: file is larger than STATE_FILE_BYTES_MAX. -EIO, -ENOSPC: not written; the old
 * release stays in use. */
must_check int state_activate(struct state *state, const struct state_release *release);
/* Counts another try of a release that is not proven. Does nothing if it is proven or if there is
 * no previous release. */
must_check int state_try(struct state *state);
/* The release in use works: marks it as proven. */
must_check int state_prove(struct state *state);
/* Returns to the previous release and marks it as proven; floors stay. -ENOENT: there is none. */
must_check int state_fall_back(struct state *state);
/* Which floors state_set_trust clears. */
enum state_clear {
	STATE_CLEAR_NOTHING = 0,
	STATE_CLEAR_SEQUENCE_FLOOR = 1,
	STATE_CLEAR_TIME_FLOOR = 2,
	STATE_CLEAR_BOTH_FLOORS = 3,
};
/* Copies the trust root's file and clears the given floors in the same transaction. Errors as for
 * state_activate, without -ESTALE. */
must_check int state_set_trust(struct state *state, struct bytes file, enum state_clear clear);
/* Copies the trusted metadata of The Update Framework, which needs a root, and clears the given
 * floors in the same transaction. Errors as for state_set_trust. */
must_check int state_set_tuf(struct state *state, const struct state_tuf *tuf,
			     enum state_clear clear);
/* Raises the time floor; a lower value does nothing. It is written only when it rises by an hour or
 * more, to spare the flash memory. Until then the higher floor is kept in memory only. */
must_check int state_raise_time_floor(struct state *state, int64_t at_least_s);

#endif
