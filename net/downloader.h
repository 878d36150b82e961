/* Gets wanted objects from the cache, a USB stick or the server, and checks each by its hash.
 *
 * A want is first looked up in the cache, in order of priority, then on the stick. Otherwise its
 * place is found in the locator of a release in use (newest first). Neighbouring objects are
 * requested together (net/range_plan.h), a few requests at a time. Each object is passed on as soon
 * as its last byte has arrived, not at the end of its range. docs/fetch.md describes the whole. One
 * thread; no call blocks, except on the disk under the cache. */
#ifndef GOPURA_NET_DOWNLOADER_H
#define GOPURA_NET_DOWNLOADER_H

#include "format/message.h"
#include "net/http.h"
#include "net/link.h"
#include "net/stick.h"
#include "storage/cache.h"

struct downloader; /* private to downloader.c */

struct downloader_events {
	/* Bytes are borrowed for the call; their hash was checked. The want is removed. */
	void (*object)(void *data, struct hash hash, struct bytes bytes);
	/* The want stays. Called again only when the reason changes. */
	void (*missing)(void *data, struct hash hash, enum missing_reason reason);
	/* False: deliver no more for now, because the kiosk reads too slowly. */
	bool (*has_room)(void *data);
};

struct downloader_options {
	struct http *http; /* borrowed, like the pointers below */
	struct cache *cache;
	struct link *link;
	struct stick *stick; /* asked before the server; NULL: none */
	uint64_t rate_limit; /* average bytes per second for releases not shown yet; 0: no limit */
	uint32_t wait_ms;    /* one turn of requests takes about so long; 0: half a second */
	struct downloader_events events;
	void *data;
};

/* Counters since downloader_create. */
struct downloader_counters {
	uint64_t from_cache, from_server, from_stick; /* objects */
	uint64_t ranges;                              /* requests for objects */
	uint64_t damaged;       /* objects whose bytes did not match their hash */
	uint64_t stick_damaged; /* the same for a stick; the server is asked then */
	uint64_t cancelled;     /* requests cancelled because nothing in them was wanted any more */
};

/* *out is owned by the caller; it is NULL on failure. Options are copied; the pointers in them are
 * borrowed. -ENOMEM. */
must_check int downloader_create(struct downloader **out, const struct downloader_options *options);
/* Cancels all requests. Drops all wants without events. NULL is fine. */
void downloader_destroy(struct downloader *downloader);

/* also false: this becomes the only release; all wants and other releases are dropped. also true:
 * it is added beside the others. -ENOMEM: nothing of it can be found. */
must_check int downloader_use_release(struct downloader *downloader, struct hash root, bool also);
/* *want is copied. If the object is already wanted, only its priority changes. If there are too
 * many wants, it is reported missing. -ENOMEM: it is not wanted. */
must_check int downloader_want(struct downloader *downloader, const struct message_want *want);
/* No event follows. A request that carries no other wanted object is cancelled. */
void downloader_drop(struct downloader *downloader, struct hash hash);
/* Asks the cache to evict this object last. */
void downloader_keep(struct downloader *downloader, struct hash hash);
/* Passes in the stick's answer; the arguments are those of stick_options.object. */
void downloader_stick_answered(struct downloader *downloader, struct hash hash, int rc,
			       struct bytes bytes);
/* Returns true if this want still waits for the stick. */
bool downloader_wants_of_stick(const struct downloader *downloader, struct hash hash);
/* A stick was plugged in: looks up all waiting wants again. */
void downloader_look_up_again(struct downloader *downloader);
/* Drops all wants and releases, because the kiosk disconnected. */
void downloader_clear(struct downloader *downloader);

/* Does all work that is possible now. Call it after http_dispatch and after each of the calls
 * above. */
void downloader_work(struct downloader *downloader);
/* Returns when downloader_work next has timed work to do (clock_now_ms); INT64_MAX: never. A time
 * that is now or in the past means at once. */
int64_t downloader_due_ms(const struct downloader *downloader);

/* Returns the number of wants that were neither delivered nor dropped. */
uint32_t downloader_wanted(const struct downloader *downloader);
/* Copies the counters to *out. */
void downloader_counters(const struct downloader *downloader, struct downloader_counters *out);

#endif
