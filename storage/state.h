/* What the kiosk must not forget when the power goes: the release it shows, the trust root, the
 * floors that fall only with the keys that set them. docs/cache.md tells what happens to it in an
 * accident.
 *
 * SQLite with synchronous=FULL at PATH; each change is one transaction, so after a power cut it is
 * wholly there or wholly not. A damaged file is set aside as PATH.broken and what matters comes
 * back from PATH.second, a self-checked copy written after each change. One thread. A call that
 * writes waits for the disk: not for the frame path. */
#ifndef GOPURA_STORAGE_STATE_H
#define GOPURA_STORAGE_STATE_H

#include "format/hash.h"

struct state; /* private to state.c */

enum {
	STATE_FILE_BYTES_MAX = 64 * 1024, /* a metadata file */
	STATE_TRIES_MAX = 3,              /* of a release that was never seen to work */
};

struct state_release {
	struct hash root;
	uint32_t root_bytes;
	uint64_t sequence;
	struct bytes file; /* release.json as received; borrowed */
};

/* *out is owned by the caller. Fails with -ENOMEM alone: where the disk fails, the state is what
 * could be read (or empty) and changes are refused. */
must_check int state_create(struct state **out, const char *path);
void state_destroy(struct state *state); /* NULL is fine */

/* The release in use; *out is borrowed until the next change. -ENOENT: none yet. */
must_check int state_release(const struct state *state, struct state_release *out);
/* The last release that worked, kept until the one in use is seen to; borrowed. -ENOENT: none. */
must_check int state_previous(const struct state *state, struct state_release *out);
/* How often it was tried to show the release in use, since state_activate; 0: it is proven. */
uint32_t state_tries(const struct state *state);
/* The file of the trust root in use (root/N.json as received), borrowed. -ENOENT: none yet. */
must_check int state_trust(const struct state *state, struct bytes *out);
/* No release below it may be activated; 0 at first. */
uint64_t state_sequence_floor(const struct state *state);
/* It is at least this late by signed metadata, seconds since 1970; 0 at first. */
int64_t state_time_floor_s(const struct state *state);

/* Copies what release says and raises the sequence floor to it; the one in use becomes the
 * previous one where it is proven. The first try begins, unless it is the same root. -ESTALE: below
 * the floor. -EFBIG: file past STATE_FILE_BYTES_MAX. -EIO, -ENOSPC: the old one stays in use. */
must_check int state_activate(struct state *state, const struct state_release *release);
/* Another try of a release that is not proven; nothing where there is no other. */
must_check int state_try(struct state *state);
/* The release in use works: tries are counted no more. */
must_check int state_prove(struct state *state);
/* The previous release is in use again, and proven; floors stay. -ENOENT: there is none. */
must_check int state_fall_back(struct state *state);
/* Copies, and clears floors in the same transaction. Errors as state_activate. */
enum state_clear {
	STATE_CLEAR_NOTHING = 0,
	STATE_CLEAR_SEQUENCE_FLOOR = 1,
	STATE_CLEAR_TIME_FLOOR = 2,
	STATE_CLEAR_BOTH_FLOORS = 3,
};
must_check int state_set_trust(struct state *state, struct bytes file, enum state_clear clear);
/* Lower than the floor: nothing happens. Writes only when it rises by an hour or more, so that a
 * card does not wear; until then the higher floor holds in memory. */
must_check int state_raise_time_floor(struct state *state, int64_t at_least_s);

#endif
