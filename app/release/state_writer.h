/* Writes the kiosk's state on a thread of its own: an fsync takes from one millisecond to some
 * hundred, and the frame path waits for no disk. What is asked for is copied; of two wishes of one
 * kind the later one is enough. */
#ifndef GOPURA_APP_RELEASE_STATE_WRITER_H
#define GOPURA_APP_RELEASE_STATE_WRITER_H

#include "storage/state.h"

struct state_writer;

struct state_writer_answer {
	struct hash root; /* of the release that was to be remembered */
	uint32_t root_bytes;
	uint64_t sequence;
	int rc; /* of state_activate */
};

/* state is taken, also on failure: from now on the thread's alone. */
must_check int state_writer_create(struct state_writer **out, struct state *state);
/* Writes what was asked for, then ends; NULL is fine. */
void state_writer_destroy(struct state_writer *writer);

/* Answered by state_writer_take, unless a later release was asked for before this one was written.
 */
must_check int state_writer_activate(struct state_writer *writer,
				     const struct state_release *release);
/* clear: which floors fall with the old root, in one change with it. Failures are logged: the trust
 * root in use stays in use without a disk, too. Not while state_writer_activate waits for its
 * answer: that release would be written afterwards, and raise the floor once more. */
must_check int state_writer_set_trust(struct state_writer *writer, struct bytes file,
				      enum state_clear clear);
/* The release that was remembered last works, or does not: state_prove, state_fall_back. Failures
 * are logged: the next start then tries again. */
void state_writer_prove(struct state_writer *writer);
void state_writer_fall_back(struct state_writer *writer);
/* Never lowers it, and does not wait for the disk. */
void state_writer_raise_time_floor(struct state_writer *writer, int64_t at_least_s);

/* Readable when state_writer_take has something. */
int state_writer_fd(const struct state_writer *writer);
/* The next answer; false: none. */
bool state_writer_take(struct state_writer *writer, struct state_writer_answer *out);

#endif
