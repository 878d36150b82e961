/* What the parts of the bringer share: bring.c has the wants, bring_release.c the locators,
 * bring_range.c a request for a range of a pack. */
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

struct bring_release {
	struct hash root;
	uint32_t root_bytes;
	struct locator locator;
	bool has_locator, from_server; /* where it came from: the cache's may be outdated */
	bool asked_cache;
	bool missing; /* the server has no locator of this name (so far) */
	struct bring *bring;
	struct http_request *request;
	struct buffer file;
	uint32_t failures;
	int64_t retry_at_ms;
};

struct bring {
	struct bring_options options;
	struct by_hash wants;
	struct want **fresh; /* owned array; sorted by priority when not fresh_changed, best last */
	size_t fresh_count, fresh_capacity;
	bool fresh_changed;
	bool plan_changed;   /* something may be asked for that could not before */
	int64_t plan_due_ms; /* when the first pause of a want is over; INT64_MAX: none waits */
	uint64_t orders;
	struct bring_release *releases[MESSAGE_RELEASES_MOST]; /* newest first */
	struct range *ranges;                                  /* in flight */
	uint32_t range_count;
	uint64_t flying_bytes;    /* that the ranges in flight asked for */
	struct range_item *items; /* scratch of planning */
	size_t item_capacity;
	struct buffer scratch;   /* an object from the cache */
	bool suspicious;         /* bring_suspect_locators, for bring_work to act on */
	bool was_down;           /* all wants were told of being offline */
	uint64_t bytes_per_s;    /* lately */
	int64_t allowance_bytes; /* with a rate limit: what may be asked for of what is for later;
				  * below 0: overdrawn */
	int64_t allowance_ms;    /* as of then */
	bool later_waits;        /* for the rate limit alone */
	struct bring_figures figures;
};

/* -- bring.c */

/* Bytes of the want's size have come: checks and passes them on, or notes the damage. */
void bring_arrived(struct bring *bring, struct want *want, struct bytes bytes);
/* The want was not brought: rc as http_result. */
void bring_failed(struct bring *bring, struct want *want, int rc);

/* -- bring_release.c */

/* The newest-first try'th release that knows the want's place (a want that failed tries them in
 * turn). -ENOENT: none has it. -EAGAIN: a locator is still to come. */
must_check int bring_locate(struct bring *bring, const struct want *want, struct range_item *out);
/* The stick will answer, by bring_stick_answered. false: there is none. */
bool bring_ask_stick(struct bring *bring, const struct want *want);
void bring_work_releases(struct bring *bring);
int64_t bring_releases_due_ms(const struct bring *bring);
/* Objects were not where a locator said: bring_ask_suspects gets it anew (packs may have been
 * packed anew). Only notes it, as it is called while bytes arrive, where nothing may be asked. */
void bring_suspect_locators(struct bring *bring);
void bring_ask_suspects(struct bring *bring);
void bring_forget_releases(struct bring *bring);

/* -- bring_range.c */

/* Asks for items[0 .. count), in order, of one pack, each a struct want. Gives the bytes asked
 * for; 0: no memory, and the wants wait on. */
int64_t bring_ask_range(struct bring *bring, const struct range_item *items, size_t count);
/* The want leaves its range; a range nobody wants is cancelled. */
void bring_leave_range(struct bring *bring, struct want *want);
void bring_cancel_ranges(struct bring *bring);

#endif
