/* Range requests to the server. A range holds wanted objects of one pack in the order of their
 * places, with small gaps; its answer is split into these objects, and each is reported as soon as
 * its last byte has arrived. The hashes are not checked here. One thread; no call blocks. */
#ifndef GOPURA_NET_RANGES_H
#define GOPURA_NET_RANGES_H

#include "net/http.h"
#include "net/link.h"
#include "net/range_plan.h"
#include "net/want_set.h"

struct ranges_options {
	struct http *http; /* borrowed, like link */
	struct link *link;
	/* All bytes of an object have arrived, unchecked; they are borrowed for the call. want has
	 * left the range and waits; NULL if it left earlier. No request may be made here. Of a want
	 * in segments, the bytes are those of this segment. */
	void (*object)(void *data, struct want *want, uint32_t segment, struct hash hash,
		       struct bytes bytes);
	/* The range ended without this object; want has left it and waits. rc is that of
	 * struct http_result; -ENOENT also if the answer was too short, -ENOMEM. */
	void (*failed)(void *data, struct want *want, int rc);
	/* A range was answered in whole or in part, so there is room for another one. */
	void (*ended)(void *data);
	void *data;
};

struct ranges {
	struct ranges_options options;
	struct range *first;          /* list of the ranges in flight, owned */
	uint32_t count;               /* ranges in flight */
	uint64_t bytes;               /* sum of their sizes */
	uint64_t requests, cancelled; /* since ranges_init */
};

/* Options are copied; the pointers in them are borrowed. */
void ranges_init(struct ranges *ranges, const struct ranges_options *options);
/* Cancels all ranges without events; their wants wait afterwards. */
void ranges_cancel_all(struct ranges *ranges);

/* Requests items[0 .. count) with one range request. They are sorted, lie in one pack, and
 * item.want is the struct want that waits for each, or for its segment. -ENOMEM: the wants keep
 * waiting. */
must_check int ranges_request(struct ranges *ranges, const struct range_item *items, size_t count);
/* Returns how many bytes are still to come of ranges that are at least as urgent: those that hold
 * an object of that priority, or of a higher one. */
uint64_t ranges_ahead(const struct ranges *ranges, uint32_t priority);
/* Removes a want from all ranges; it waits afterwards. A range without wants is cancelled. Returns
 * true if that happened. Does nothing if the want is in no range. */
bool ranges_leave(struct ranges *ranges, struct want *want);

#endif
