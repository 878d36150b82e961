/* Shared by the sources of the downloader: downloader.c handles the wants, downloader_release.c the
 * locators, downloader_range.c one request for a range of a pack. */
#ifndef GOPURA_NET_DOWNLOADER_PRIVATE_H
#define GOPURA_NET_DOWNLOADER_PRIVATE_H

#include "format/locator.h"
#include "net/by_hash.h"
#include "net/downloader.h"
#include "net/range_plan.h"

enum want_state {
	WANT_FRESH,    /* the cache was not asked yet; the want is in downloader.fresh */
	WANT_WAITING,  /* for a request; not before retry_at_ms */
	WANT_ON_STICK, /* the stick was asked and will answer */
	WANT_FLYING,   /* part of a range in flight */
};

struct want {
	struct hash_entry entry; /* key: the object's hash */
	struct message_want asked;
	enum want_state state;
	uint64_t order;      /* order of arrival */
	uint32_t failures;   /* answers in a row without the object, or with wrong bytes */
	uint32_t damages;    /* how many of these had wrong bytes */
	int64_t retry_at_ms; /* in state WANT_WAITING */
	int reported;        /* enum missing_reason, -1: none */
	bool dropped;        /* dropped while in downloader.fresh; freed when its turn comes */
	struct range *range; /* in state WANT_FLYING */
};

struct downloader_release {
	struct hash root;
	uint32_t root_bytes;
	struct locator locator;
	bool has_locator, from_server; /* from_server: not from the cache, which may be outdated */
	bool asked_cache;
	bool missing; /* the server has no locator with this name (so far) */
	struct downloader *downloader;
	struct http_request *request;
	struct buffer file;
	uint32_t failures;
	int64_t retry_at_ms;
};

struct downloader {
	struct downloader_options options;
	struct by_hash wants;
	/* owned array; sorted by priority unless fresh_changed; the best is last */
	struct want **fresh;
	size_t fresh_count, fresh_capacity;
	bool fresh_changed;
	bool plan_changed;   /* something may be requested that could not be before */
	int64_t plan_due_ms; /* when the first retry pause ends; INT64_MAX: no want is pausing */
	/* number of wants so far; gives want.order */
	uint64_t orders;
	struct downloader_release *releases[MESSAGE_RELEASES_MAX]; /* newest first */
	struct range *ranges;                                      /* in flight */
	uint32_t range_count;
	uint64_t flying_bytes;    /* sum of the sizes of the ranges in flight */
	struct range_item *items; /* scratch memory for planning */
	size_t item_capacity;
	struct buffer scratch; /* holds one object read from the cache */
	bool suspicious;       /* set by downloader_suspect_locators, acted on by downloader_work */
	bool was_down;         /* all wants were told that the server is offline */
	uint64_t bytes_per_s;  /* moving average of the bandwidth */
	/* with a rate limit: bytes that may be requested now for later releases; negative:
	 * overdrawn */
	int64_t allowance_bytes;
	int64_t allowance_ms; /* when allowance_bytes was computed */
	bool later_waits;     /* something waits only for the rate limit */
	struct downloader_figures metrics;
};

/* -- downloader.c */

/* All bytes of the wanted object have arrived. Checks them and passes them on, or notes the
 * damage. */
void downloader_arrived(struct downloader *downloader, struct want *want, struct bytes bytes);
/* The want was not delivered. rc is that of struct http_result. */
void downloader_failed(struct downloader *downloader, struct want *want, int rc);

/* -- downloader_release.c */

/* Finds the object's place in a release that contains it, newest first. A want that failed tries
 * these releases in turn. -ENOENT: no release contains it. -EAGAIN: a locator has not arrived
 * yet. */
must_check int downloader_locate(struct downloader *downloader, const struct want *want,
				 struct range_item *out);
/* Asks the stick; downloader_stick_answered gets the answer. Returns false if there is no stick. */
bool downloader_ask_stick(struct downloader *downloader, const struct want *want);
/* Reads missing locators from the cache, or requests them from the server. */
void downloader_work_releases(struct downloader *downloader);
/* Returns when downloader_work_releases has work to do (clock_now_ms); INT64_MAX: never. */
int64_t downloader_releases_due_ms(const struct downloader *downloader);
/* Notes that objects were not where a locator said; the packs may have been repacked. It is called
 * while bytes arrive, when no request may be made. */
void downloader_suspect_locators(struct downloader *downloader);
/* Requests the noted locators again, at most once a minute each. */
void downloader_ask_suspects(struct downloader *downloader);
/* Frees all releases and cancels their requests. */
void downloader_forget_releases(struct downloader *downloader);

/* -- downloader_range.c */

/* Requests items[0 .. count) with one range request. They are sorted, lie in one pack, and each
 * refers to a struct want. Returns the number of bytes requested. 0: no memory; the wants keep
 * waiting. */
int64_t downloader_ask_range(struct downloader *downloader, const struct range_item *items,
			     size_t count);
/* Removes the want from its range, if it has one. A range without wants is cancelled. */
void downloader_leave_range(struct downloader *downloader, struct want *want);
/* Cancels all ranges. Their wants must be dropped by the caller. */
void downloader_cancel_ranges(struct downloader *downloader);

#endif
