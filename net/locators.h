/* The releases in use and their locators, which say where in the packs an object lies. A locator is
 * read from the cache or downloaded from the server. One thread; no call blocks, except on the disk
 * under the cache. */
#ifndef GOPURA_NET_LOCATORS_H
#define GOPURA_NET_LOCATORS_H

#include "format/message.h"
#include "net/http.h"
#include "net/link.h"
#include "net/range_plan.h"
#include "storage/cache.h"

struct located_release; /* private to locators.c */

struct locators_options {
	struct http *http; /* borrowed, like the pointers below */
	struct cache *cache;
	struct link *link;
	/* Another locator is there, or one is known to be missing. locators_find may answer
	 * differently now. */
	void (*changed)(void *data);
	void *data;
};

struct locators {
	struct locators_options options;
	struct located_release *releases[MESSAGE_RELEASES_MAX]; /* owned; newest first */
	bool suspected;                                         /* set by locators_suspect */
};

/* Options are copied; the pointers in them are borrowed. */
void locators_init(struct locators *locators, const struct locators_options *options);
/* Removes all releases and cancels their requests. */
void locators_clear(struct locators *locators);

/* Adds a release as the newest, unless it is in use already. If there are MESSAGE_RELEASES_MAX, the
 * oldest goes except for the first, which is shown. -ENOMEM: its objects are not found. */
must_check int locators_add(struct locators *locators, struct hash root);
/* Writes the roots of the releases in use, newest first. Returns their number. */
size_t locators_roots(const struct locators *locators, struct hash roots[MESSAGE_RELEASES_MAX]);
/* Finds the object's place; sets pack, place and size of *out, and zeroes the rest. If several
 * releases contain it, attempt (0: the newest release) selects one of them in turn. -ENOENT: no
 * release contains it. -EAGAIN: a locator has not arrived yet. */
must_check int locators_find(const struct locators *locators, const struct message_want *asked,
			     uint32_t attempt, struct range_item *out);

/* Notes that objects were not where a locator said; the packs may have been repacked. May be called
 * while bytes arrive, when no request may be made. */
void locators_suspect(struct locators *locators);
/* Downloads suspected locators again, at most once a minute each. */
void locators_refresh_suspected(struct locators *locators);

/* Reads missing locators from the cache, or requests them from the server. */
void locators_work(struct locators *locators);
/* Returns when locators_work has work to do (clock_now_ms); INT64_MAX: never. */
int64_t locators_due_ms(const struct locators *locators);

#endif
