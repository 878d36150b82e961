/* Writes the kiosk's state on a thread of its own: an fsync takes from one millisecond to some
 * hundred, and the frame path waits for no disk. What is asked for is copied; of two wishes of one
 * kind the later one is enough. */
#ifndef GOPURA_APP_RELEASE_STATE_WRITER_H
#define GOPURA_APP_RELEASE_STATE_WRITER_H

#include "storage/state.h"

struct keeper;

struct keeper_answer {
	struct hash root; /* of the release that was to be remembered */
	uint32_t root_bytes;
	uint64_t sequence;
	int rc; /* of state_activate */
};

/* state is taken, also on failure: from now on the thread's alone. */
must_check int keeper_create(struct keeper **out, struct state *state);
/* Writes what was asked for, then ends; NULL is fine. */
void keeper_destroy(struct keeper *keeper);

/* Answered by keeper_take, unless a later release was asked for before this one was written. */
must_check int keeper_activate(struct keeper *keeper, const struct state_release *release);
/* clear: which floors fall with the old root, in one change with it. Failures are logged: the trust
 * root in use stays in use without a disk, too. Not while keeper_activate waits for its answer:
 * that release would be written afterwards, and raise the floor once more. */
must_check int keeper_set_trust(struct keeper *keeper, struct bytes file, enum state_clear clear);
/* The release that was remembered last works, or does not: state_prove, state_fall_back. Failures
 * are logged: the next start then tries again. */
void keeper_prove(struct keeper *keeper);
void keeper_fall_back(struct keeper *keeper);
/* Never lowers it, and does not wait for the disk. */
void keeper_raise_time_floor(struct keeper *keeper, int64_t at_least_s);

/* Readable when keeper_take has something. */
int keeper_fd(const struct keeper *keeper);
/* The next answer; false: none. */
bool keeper_take(struct keeper *keeper, struct keeper_answer *out);

#endif
