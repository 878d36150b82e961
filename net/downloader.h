/* Brings wanted objects, from the cache or the server, and checks each by its hash.
 *
 * A want is first looked for in the cache, best priority first. Else its place is found in the
 * locator of a release in use (newest first), and neighbours are asked for together
 * (net/range_plan.h), a few requests at a time. Objects go on as soon as their last byte came, not
 * at the end of their range. docs/fetch.md has the whole. One thread; nothing here waits but the
 * disk under the cache. */
#ifndef GOPURA_NET_DOWNLOADER_H
#define GOPURA_NET_DOWNLOADER_H

#include "format/message.h"
#include "net/http.h"
#include "net/link.h"
#include "net/stick.h"
#include "storage/cache.h"

struct downloader; /* private to bring*.c */

struct downloader_events {
	/* Bytes are borrowed for the call; their hash is right. The want is forgotten then. */
	void (*object)(void *data, struct hash hash, struct bytes bytes);
	/* The want stays; said again only when the reason changes. */
	void (*missing)(void *data, struct hash hash, enum missing_reason reason);
	/* False: bring no more for now (the kiosk is slow to take them). */
	bool (*has_room)(void *data);
};

struct downloader_options {
	struct http *http; /* borrowed, as all that follow */
	struct cache *cache;
	struct link *link;
	struct stick *stick; /* asked before the server; NULL: none */
	uint64_t rate_limit; /* bytes a second of what is for later, in the mean; 0: none */
	struct downloader_events events;
	void *data;
};

/* Since create. */
struct downloader_figures {
	uint64_t from_cache, from_server, from_stick; /* objects */
	uint64_t ranges;                              /* requests for objects */
	uint64_t damaged;       /* objects whose bytes were not of their hash */
	uint64_t stick_damaged; /* the same, of a stick; the server is asked then */
	uint64_t cancelled;     /* requests given up: nothing in them was wanted any more */
};

/* *out is owned by the caller. -ENOMEM. */
must_check int downloader_create(struct downloader **out, const struct downloader_options *options);
void downloader_destroy(struct downloader *downloader);

/* Alone: drops every want, forgets other releases. Also: beside them. */
void downloader_use_release(struct downloader *downloader, struct hash root, uint32_t root_bytes,
			    bool also);
/* Copied. Wanted already: only its priority changes. */
void downloader_want(struct downloader *downloader, const struct message_want *want);
/* No event follows; a request that brings nothing else is cancelled. */
void downloader_drop(struct downloader *downloader, struct hash hash);
/* The cache lets it go last. */
void downloader_keep(struct downloader *downloader, struct hash hash);
/* The stick's answer to a want, as stick_options.object has it. */
void downloader_stick_answered(struct downloader *downloader, struct hash hash, int rc,
			       struct bytes bytes);
/* The stick is still waited for with this want. */
bool downloader_wants_of_stick(const struct downloader *downloader, struct hash hash);
/* A stick came: what is waited for may be there. */
void downloader_ask_again(struct downloader *downloader);
void downloader_forget_all(
	struct downloader *downloader); /* the kiosk is gone: wants and releases */

/* Does what can be done now. Call after dispatching http and after each of the calls above. */
void downloader_work(struct downloader *downloader);
/* When downloader_work has something to do by time alone (clock_now_ms); INT64_MAX: never. Now or
 * earlier: at once. */
int64_t downloader_due_ms(const struct downloader *downloader);

/* Wants that were neither brought nor dropped. */
uint32_t downloader_wanted(const struct downloader *downloader);
void downloader_figures(const struct downloader *downloader, struct downloader_figures *out);

#endif
