/* A binary heap, the least cost first. */
#include "geometry/search_queue.h"

#include <errno.h>
#include <stdlib.h>

#include "base/array.h"

int search_queue_add(struct search_queue *queue, float cost, uint32_t number)
{
	uint32_t at = queue->count;

	if (ARRAY_RESERVE(queue->entries, queue->room, at + 1, UINT32_MAX) < 0)
		return -ENOMEM;
	queue->count++;
	while (at > 0 && queue->entries[(at - 1) / 2].cost > cost) {
		queue->entries[at] = queue->entries[(at - 1) / 2];
		at = (at - 1) / 2;
	}
	queue->entries[at] = (struct search_entry){ cost, number };
	return 0;
}

uint32_t search_queue_take(struct search_queue *queue)
{
	struct search_entry *entries = queue->entries;
	const uint32_t number = entries[0].number;
	const struct search_entry last = entries[--queue->count];
	uint32_t at = 0, child;

	while ((child = 2 * at + 1) < queue->count) {
		child += child + 1 < queue->count && entries[child + 1].cost < entries[child].cost;
		if (entries[child].cost >= last.cost)
			break;
		entries[at] = entries[child];
		at = child;
	}
	entries[at] = last;
	return number;
}

void search_queue_finish(struct search_queue *queue)
{
	free(queue->entries);
	*queue = (struct search_queue){ 0 };
}
