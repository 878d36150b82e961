/* Follows the releases of the museum server: knows which one is shown (state.db), checks the signed
 * metadata, has the next release loaded in the background, and stores it before it is shown. A new
 * release is on trial until updater_prove; if it does not work, the one before it is used again.
 * Only updater_create waits for a disk. One thread. */
#ifndef GOPURA_APP_RELEASE_UPDATER_H
#define GOPURA_APP_RELEASE_UPDATER_H

#include "base/metrics_refusal.h"
#include "net/client.h"

struct updater;

/* What is trusted, for the metrics. Times are in seconds since 1970; 0: none is known. */
struct updater_trust {
	bool tuf;                                 /* The Update Framework is followed */
	uint32_t root_version, timestamp_version; /* 0: none; the earlier form has no version of a
						     timestamp */
	int64_t root_expires_s, timestamp_expires_s;
	/* Of release.json and all that says which one it is, whatever expires first. */
	int64_t release_expires_s;
};

struct updater_options {
	const char *state_path; /* state.db; borrowed, needed by updater_create only */
	const char *trust_path; /* root/1.json, or the root of The Update Framework, to trust if the
				   state has no root; borrowed likewise; NULL: none */
	const char *target;     /* path of the release among the targets of The Update Framework;
				   borrowed likewise; NULL: release.json */
	/* Load this release: at start the stored one, later each new one, or the one before it.
	 * Call updater_remember once it can be shown completely. */
	void (*begin)(void *data, struct hash root, uint32_t root_bytes);
	/* The release is stored on disk: show it. rc < 0: it is not; keep showing the other and ask
	 * again later. */
	void (*remembered)(void *data, struct hash root, int rc);
	/* Ask the fetcher for a file, copied for the call; the answer is for updater_file. NULL:
	 * the terminal does not go over to The Update Framework. */
	void (*ask)(void *data, const struct message_file *file);
	void *data;
};

/* Opens the state, decides about a release on trial, and starts the state writer. *out is owned by
 * the caller; it is NULL on failure. Returns 0 or a negative errno. */
must_check int updater_create(struct updater **out, const struct updater_options *options);
void updater_destroy(struct updater *updater); /* NULL is fine */

/* Calls begin with the stored release, if there is one. */
void updater_start(struct updater *updater);
/* Handles a metadata file that arrived; bytes are borrowed for the call, their signature is checked
 * here. version: of a root. A refused file is logged and counted. */
void updater_meta(struct updater *updater, enum meta_role role, uint32_t version,
		  struct bytes bytes, enum meta_source source);
/* Handles the answer to `ask`; everything in *file is borrowed for the call, and checked here. */
void updater_file(struct updater *updater, const struct message_file *file);
/* Returns the version of the trust root in use; 0: none; MESSAGE_TRUST_TUF: The Update Framework is
 * followed. */
uint32_t updater_root_version(const struct updater *updater);
/* Returns whether the release being loaded was offered by a stick. */
bool updater_next_on_stick(const struct updater *updater);
/* The release with this root can be shown completely: has it stored. `remembered` is called from
 * updater_dispatch once it is on disk, or at once if there is nothing to write. */
void updater_remember(struct updater *updater, struct hash root);
/* Returns the highest sequence that was stored; 0: none yet. */
uint64_t updater_sequence(const struct updater *updater);
/* Returns whether the stored release is not yet known to work. */
bool updater_on_trial(const struct updater *updater);
/* Returns whether there is a release before it that worked. */
bool updater_has_before(const struct updater *updater);
/* The stored release works: ends its trial. */
void updater_prove(struct updater *updater);
/* The release on trial does not work: records it as refused, and begins the one before it. why is
 * for people. Does nothing if there is none before it. */
void updater_fall_back(struct updater *updater, const char *why);
/* Records that the release being loaded cannot be shown. It is not begun again. why is for people.
 */
void updater_refuse(struct updater *updater, struct hash root, const char *why);
/* Returns the last refusal of an offered release or its files. Borrowed; its counter rises with
 * each. */
const struct metrics_refusal *updater_refusal(const struct updater *updater);
void updater_trust(const struct updater *updater, struct updater_trust *out);
/* Returns a descriptor, borrowed, that is readable when updater_dispatch has something to do. */
int updater_fd(const struct updater *updater);
/* Handles an answer of the state writer and calls `remembered`. Returns 0. */
must_check int updater_dispatch(struct updater *updater);

#endif
