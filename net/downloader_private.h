/* What the parts of the bringer share: bring.c has the wants, downloader_release.c the locators,
 * downloader_range.c a request for a range of a pack. */
#ifndef GOPURA_NET_DOWNLOADER_PRIVATE_H
#define GOPURA_NET_DOWNLOADER_PRIVATE_H

#include "format/locator.h"
#include "net/by_hash.h"
#include "net/downloader.h"
#include "net/range_plan.h"

enum want_state {
	WANT_FRESH,    /* the cache was not asked yet; stands in bring.fresh */
	WANT_WAITING,  /* for a request, from retry_at_ms on */
	WANT_ON_STICK, /* the stick was asked, and will answer */
	WANT_FLYING,   /* in a range */
};

struct want {
	struct hash_entry entry; /* key: the object's hash */
	struct message_want asked;
	enum want_state state;
	uint64_t order;      /* of arrival */
	uint32_t failures;   /* answers without it, or with wrong bytes, in a row */
	uint32_t damages;    /* of these, wrong bytes */
	int64_t retry_at_ms; /* of WANT_WAITING */
	int reported;        /* enum missing_reason, -1: none */
	bool dropped;        /* while it stands in bring.fresh: freed when its turn comes */
	struct range *range; /* of WANT_FLYING */
};

struct downloader_release {
	struct hash root;
	uint32_t root_bytes;
	struct locator locator;
	bool has_locator, from_server; /* where it came from: the cache's may be outdated */
	bool asked_cache;
	bool missing; /* the server has no locator of this name (so far) */
	struct downloader *downloader;
	struct http_request *request;
	struct buffer file;
	uint32_t failures;
	int64_t retry_at_ms;
};

struct downloader {
	struct downloader_options options;
	struct by_hash wants;
	struct want **fresh; /* owned array; sorted by priority when not fresh_changed, best last */
	size_t fresh_count, fresh_capacity;
	bool fresh_changed;
	bool plan_changed;   /* something may be asked for that could not before */
	int64_t plan_due_ms; /* when the first pause of a want is over; INT64_MAX: none waits */
	uint64_t orders;
	struct downloader_release *releases[MESSAGE_RELEASES_MAX]; /* newest first */
	struct range *ranges;                                      /* in flight */
	uint32_t range_count;
	uint64_t flying_bytes;    /* that the ranges in flight asked for */
	struct range_item *items; /* scratch of planning */
	size_t item_capacity;
	struct buffer scratch;   /* an object from the cache */
	bool suspicious;         /* downloader_suspect_locators, for downloader_work to act on */
	bool was_down;           /* all wants were told of being offline */
	uint64_t bytes_per_s;    /* lately */
	int64_t allowance_bytes; /* with a rate limit: what may be asked for of what is for later;
				  * below 0: overdrawn */
	int64_t allowance_ms;    /* as of then */
	bool later_waits;        /* for the rate limit alone */
	struct downloader_figures metrics;
};

/* -- bring.c */

/* Bytes of the want's size have come: checks and passes them on, or notes the damage. */
void downloader_arrived(struct downloader *downloader, struct want *want, struct bytes bytes);
/* The want was not brought: rc as http_result. */
void downloader_failed(struct downloader *downloader, struct want *want, int rc);

/* -- downloader_release.c */

/* The newest-first try'th release that knows the want's place (a want that failed tries them in
 * turn). -ENOENT: none has it. -EAGAIN: a locator is still to come. */
must_check int downloader_locate(struct downloader *downloader, const struct want *want,
				 struct range_item *out);
/* The stick will answer, by downloader_stick_answered. false: there is none. */
bool downloader_ask_stick(struct downloader *downloader, const struct want *want);
void downloader_work_releases(struct downloader *downloader);
int64_t downloader_releases_due_ms(const struct downloader *downloader);
/* Objects were not where a locator said: downloader_ask_suspects gets it anew (packs may have been
 * packed anew). Only notes it, as it is called while bytes arrive, where nothing may be asked. */
void downloader_suspect_locators(struct downloader *downloader);
void downloader_ask_suspects(struct downloader *downloader);
void downloader_forget_releases(struct downloader *downloader);

/* -- downloader_range.c */

/* Asks for items[0 .. count), in order, of one pack, each a struct want. Gives the bytes asked
 * for; 0: no memory, and the wants wait on. */
int64_t downloader_ask_range(struct downloader *downloader, const struct range_item *items,
			     size_t count);
/* The want leaves its range; a range nobody wants is cancelled. */
void downloader_leave_range(struct downloader *downloader, struct want *want);
void downloader_cancel_ranges(struct downloader *downloader);

#endif
