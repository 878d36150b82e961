/* Writes the kiosk's state on a thread of its own: an fsync takes from one millisecond to some
 * hundred, and the frame path must not wait for a disk. Requests are copied. Of two pending
 * requests of one kind, only the later one is written. All functions are for one thread, the
 * caller's. */
#ifndef GOPURA_APP_RELEASE_STATE_WRITER_H
#define GOPURA_APP_RELEASE_STATE_WRITER_H

#include "storage/state.h"

struct state_writer;

struct state_writer_answer {
	struct hash root; /* of the release that was to be stored */
	uint32_t root_bytes;
	uint64_t sequence;
	int rc; /* result of state_activate */
};

/* Starts the thread. *out is owned by the caller; it is NULL on failure. state is taken, also on
 * failure: from then on only the thread may use it. Returns 0 or a negative errno. */
must_check int state_writer_create(struct state_writer **out, struct state *state);
/* Writes the pending requests, then ends the thread and frees; NULL is fine. */
void state_writer_destroy(struct state_writer *writer);

/* Requests state_activate; release->file is copied. The answer comes through state_writer_take,
 * unless a later release was requested before this one was written. Returns 0; -ENOMEM, -EFBIG: not
 * requested. */
must_check int state_writer_activate(struct state_writer *writer,
				     const struct state_release *release);
/* Requests state_set_trust; file is copied. clear: floors to clear in the same transaction. A
 * failed write is only logged: the trust root in use stays in use without a disk. Do not call it
 * while state_writer_activate waits for its answer: that release would be written afterwards and
 * raise the floor again. Returns 0; -ENOMEM, -EFBIG: not requested. */
must_check int state_writer_set_trust(struct state_writer *writer, struct bytes file,
				      enum state_clear clear);
/* Requests state_set_tuf; the files are copied. As state_writer_set_trust. */
must_check int state_writer_set_tuf(struct state_writer *writer, const struct state_tuf *tuf,
				    enum state_clear clear);
/* Request state_prove and state_fall_back: the stored release works, or does not. A failed write is
 * only logged; the next start tries again. */
void state_writer_prove(struct state_writer *writer);
void state_writer_fall_back(struct state_writer *writer); /* likewise */
/* Requests state_raise_time_floor; a lower value than one requested before has no effect. */
void state_writer_raise_time_floor(struct state_writer *writer, int64_t at_least_s);

/* Returns a descriptor, borrowed, that is readable when state_writer_take has an answer. */
int state_writer_fd(const struct state_writer *writer);
/* Takes the latest answer. Returns false if there is none. */
bool state_writer_take(struct state_writer *writer, struct state_writer_answer *out);

#endif
