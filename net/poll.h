/* Checks regularly for signed metadata (format/metadata.h): the next root, timestamp.json and
 * release.json, in this order. Changed files, and the release in every round, are passed on as
 * received; the kiosk checks the signatures. A root counts only when the kiosk confirms it
 * (poll_trust), never because a server sent it: each round requests the root after the kiosk's. For
 * a kiosk that follows The Update Framework, a round is tuf/timestamp.json alone, which is passed
 * on whether it changed or not. One thread. */
#ifndef GOPURA_NET_POLL_H
#define GOPURA_NET_POLL_H

#include "format/message.h"
#include "net/http.h"
#include "net/link.h"

struct poll; /* private to poll.c */

struct poll_options {
	struct http *http; /* borrowed, like link */
	struct link *link;
	uint32_t period_s; /* between rounds; varied randomly by 10 % so that terminals spread */
	/* A metadata file as received; its signature is not checked. Bytes are borrowed for the
	 * call. version is 0 except for a root. */
	void (*meta)(void *data, enum meta_role role, uint32_t version, struct bytes bytes);
	void *data;
};

/* *out is owned by the caller. It requests nothing before poll_start. -ENOMEM. */
must_check int poll_create(struct poll **out, const struct poll_options *options);
/* Cancels a request in flight. NULL is fine. */
void poll_destroy(struct poll *poll);

/* Passes all known files on again and starts a round now, unless one runs; then one round every
 * period_s (0: unchanged). */
void poll_start(struct poll *poll, uint32_t period_s);
/* Sets the version of the kiosk's trust root; 0: none; or MESSAGE_TRUST_TUF. Call it again after
 * every root that was passed on, whether the kiosk accepted it or not. A new version starts a round
 * at once: the next root may be available, and files rejected under the old root may be valid under
 * this one. */
void poll_trust(struct poll *poll, uint32_t root_version);
void poll_stop(struct poll *poll); /* Stops until poll_start; known files are forgotten. */
/* Does all work that is due now. */
void poll_work(struct poll *poll);
/* Returns when poll_work has work to do, like downloader_due_ms. */
int64_t poll_due_ms(const struct poll *poll);

#endif
