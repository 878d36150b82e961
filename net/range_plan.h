/* Which bytes of which pack to ask for next. Pure.
 *
 * The request begins with the object of the highest priority (of equal ones, the one wanted first)
 * and takes in neighbours of the same pack, on the side of the higher priority first, as long as
 * the gap to them and the whole stay small: objects that are wanted together lie together, and a
 * request costs a round trip and some hundred bytes, which a small gap does not. */
#ifndef GOPURA_NET_RANGE_PLAN_H
#define GOPURA_NET_RANGE_PLAN_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "format/hash.h"

struct range_item {
	struct hash pack;
	uint64_t place; /* in the pack, bytes */
	uint32_t size;  /* bytes */
	uint32_t priority;
	uint64_t order; /* lower was wanted earlier */
	void *want;     /* the caller's */
	bool taken;     /* by an earlier plan: not looked at */
};

struct range_limits {
	uint32_t gap_bytes;  /* between neighbours, at most */
	uint32_t most_bytes; /* of a request of several objects */
};

/* By pack, then place. */
void range_sort(struct range_item *items, size_t count);
/* Chooses items[*first .. *first + result), of sorted items. 0: nothing is left. Those that are not
 * taken among them are wanted; they are marked taken. */
size_t range_plan(struct range_item *items, size_t count, struct range_limits limits,
		  size_t *first);

#endif
