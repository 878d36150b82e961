/* Follows releases by The Update Framework (docs/tuf.md, On the terminal): runs the client workflow
 * over files that arrive one after another, and keeps what it trusts. Pure: files and the time go
 * in; the next file to ask for, a release.json or a refusal comes out. One thread. */
#ifndef GOPURA_APP_RELEASE_TUF_FOLLOWER_H
#define GOPURA_APP_RELEASE_TUF_FOLLOWER_H

#include "format/metadata.h"
#include "storage/state.h"
#include "tuf/tuf_metadata.h"

enum {
	TUF_ROUND_FILES_MAX = 64, /* beyond them a round fails */
	TUF_FIRST_ROOTS_MAX = 64, /* versions among which a terminal looks for its first root */
	TUF_FOLLOWER_TARGET_BYTES = 97, /* of a target's path, with the zero at its end */
};

struct tuf_arrived {
	char name[MESSAGE_NAME_MAX + 1];
	enum file_answer answer;
	struct buffer bytes; /* owned */
};

/* The files that arrived from a source since its timestamp. */
struct tuf_round {
	struct tuf_arrived *files; /* owned; TUF_ROUND_FILES_MAX of them, or NULL */
	uint32_t count;
	bool done; /* all of them were taken */
};

struct tuf_follower {
	struct buffer kept[TUF_TYPES]; /* what is trusted; no root: this form is not followed */
	struct tuf_round rounds[2];    /* indexed by enum meta_source */
	char target[TUF_FOLLOWER_TARGET_BYTES]; /* the path of this terminal's release.json */
	/* What tuf_follower_run changed: kept, and floors to clear together with it. The caller
	 * resets both. */
	bool changed;
	enum state_clear clear;
	/* Of what is kept; 0: none. issued_s: when the timestamp was signed, if it says so. */
	uint32_t version[TUF_TYPES];
	int64_t expires_s[TUF_TYPES], issued_s;
	uint32_t first_root, first_root_last; /* the version that is asked for; 0: none */
	char why[256];                        /* after a failure, for people */
	struct message_file ask;              /* after -EAGAIN: the file that is missing */
};

/* Copies what the state has, which may be nothing. target: the path of this terminal's release.json
 * among the targets, copied; NULL: "release.json". -ENOMEM, or -ENAMETOOLONG for the target; call
 * tuf_follower_finish also then. */
must_check int tuf_follower_init(struct tuf_follower *follower, const struct state_tuf *kept,
				 const char *target);
/* Frees it. Zeroed is fine. */
void tuf_follower_finish(struct tuf_follower *follower);
/* Returns whether there is a root, so that this form is followed. */
bool tuf_follower_is_on(const struct tuf_follower *follower);
/* Returns what is trusted; borrowed until the next call that changes it. */
struct state_tuf tuf_follower_kept(const struct tuf_follower *follower);

/* Takes a first root. signers: of the earlier form, whose root keys must have signed it, as many as
 * its threshold; NULL: the file was given by hand. Returns 0, or -EBADMSG, -EKEYREJECTED or
 * -ENOMEM; why is set then. */
must_check int tuf_follower_pin(struct tuf_follower *follower, struct bytes root,
				const struct trust_root *signers);

/* A release says that there are roots up to a version: asks for the first of them. Returns false if
 * there are none; otherwise ask for follower->ask. */
bool tuf_follower_begin_first(struct tuf_follower *follower, uint32_t last,
			      enum meta_source source);
/* Handles the answer: takes a root that signers have signed (tuf_follower_pin). Returns 0 if it
 * was; -EAGAIN: ask for follower->ask, the next version; -ENOKEY: the file was not asked for;
 * another negative errno: none of the versions is good, why says what is wrong with the last. */
must_check int tuf_follower_first(struct tuf_follower *follower, const struct message_file *file,
				  const struct trust_root *signers);

/* Begins a round with a timestamp. If it is the one of the round before, and that did not fail,
 * what arrived then is used again, but for roots. If that still waits for a file, it goes on, so
 * that a slow line may take longer than the time between two timestamps. */
void tuf_follower_begin(struct tuf_follower *follower, enum meta_source source,
			struct bytes timestamp);
/* Adds a file that arrived, or that the source does not have; copied. */
void tuf_follower_add(struct tuf_follower *follower, const struct message_file *file);

/* Runs the workflow over the round's files as far as they go. now_s: 0: the clock is not known to
 * be set, so nothing counts as expired. known: release.json files that are here already, so that
 * they are not asked for again. Returns 0 and appends the signed release.json to *out, which is
 * empty; -EAGAIN: ask for follower->ask, add the answer, and run again; another negative errno of
 * tuf_client_refresh: what the source has is refused, follower->why says what and why, and the
 * round has ended. What was accepted is kept in each case. */
must_check int tuf_follower_run(struct tuf_follower *follower, enum meta_source source,
				int64_t now_s, const struct bytes known[2], struct buffer *out);

#endif
