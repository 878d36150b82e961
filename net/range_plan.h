/* Plans which bytes of which pack to request next. Pure functions.
 *
 * A request starts with the object of the highest priority (if equal, the one wanted first). It
 * then grows by neighbours in the same pack, first on the side with the higher priority, as long as
 * the gap and the total size stay small. Objects that are wanted together lie together, and a
 * request costs a round trip and some hundred bytes, which is more than a small gap. */
#ifndef GOPURA_NET_RANGE_PLAN_H
#define GOPURA_NET_RANGE_PLAN_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "format/hash.h"

struct range_item {
	struct hash pack;
	uint64_t place; /* in the pack, in bytes */
	uint32_t size;  /* bytes */
	uint32_t priority;
	uint64_t order; /* a lower value was wanted earlier */
	void *want;     /* belongs to the caller, like segment */
	uint32_t segment;
	bool taken; /* used by an earlier plan: ignored */
};

struct range_limits {
	uint32_t gap_bytes;  /* maximum gap between neighbours */
	uint32_t most_bytes; /* maximum size of a request for several objects */
	/* of less urgent objects that may come before the most urgent one: it waits for them */
	uint32_t ahead_bytes;
};

/* Sorts by pack, then by place. */
void range_sort(struct range_item *items, size_t count);
/* Chooses the next range from sorted items: items[*first .. *first + result), and marks them taken.
 * Returns 0 if all items were taken already. */
size_t range_plan(struct range_item *items, size_t count, struct range_limits limits,
		  size_t *first);

#endif
