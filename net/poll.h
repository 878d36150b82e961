/* Looks for signed metadata (format/metadata.h) now and then: the next root, timestamp.json,
 * release.json, in this order. What is new goes on as received; signatures are the kiosk's to
 * check. A root counts when the kiosk says that it has it (poll_trust), never because a server
 * answered: each round asks for the root after the kiosk's. One thread. */
#ifndef GOPURA_NET_POLL_H
#define GOPURA_NET_POLL_H

#include "format/message.h"
#include "net/http.h"
#include "net/link.h"

struct poll; /* private to poll.c */

struct poll_options {
	struct http *http; /* borrowed, as link */
	struct link *link;
	uint32_t period_s; /* between looks; a tenth more or less, so that terminals spread */
	void (*meta)(void *data, enum meta_role role, uint32_t version, struct bytes bytes);
	void *data;
};

/* *out is owned by the caller; it looks for nothing before poll_ask. -ENOMEM. */
must_check int poll_create(struct poll **out, const struct poll_options *options);
void poll_destroy(struct poll *poll);

/* Says again all that is known, and looks now; from now on every period_s (0: as before). */
void poll_ask(struct poll *poll, uint32_t period_s);
/* The version of the trust root that the kiosk has, 0: none. Said again after every root that went
 * to the kiosk, whether it took it or not. A new one begins a round at once: its successor may be
 * there, and what was refused under the old root may be good under this one. */
void poll_trust(struct poll *poll, uint32_t root_version);
void poll_stop(struct poll *poll); /* until poll_ask; what is known is forgotten */
void poll_work(struct poll *poll);
int64_t poll_due_ms(const struct poll *poll); /* as downloader_due_ms */

#endif
