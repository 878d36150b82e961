/* The queue of a search for a way (A*): numbers with their costs, of which the cheapest comes out
 * first. A plain value; zeroed is empty. */
#ifndef GOPURA_GEOMETRY_SEARCH_QUEUE_H
#define GOPURA_GEOMETRY_SEARCH_QUEUE_H

#include <stdint.h>

#include "base/compiler.h"

struct search_entry {
	float cost;
	uint32_t number;
};

struct search_queue {
	struct search_entry *entries; /* owned; a binary heap */
	uint32_t count, room;
};

/* Adds a number, which may be there already with another cost. -ENOMEM: nothing changed. */
must_check int search_queue_add(struct search_queue *queue, float cost, uint32_t number);
/* Takes the cheapest number out; there is at least one. */
uint32_t search_queue_take(struct search_queue *queue);
void search_queue_finish(struct search_queue *queue); /* frees it and leaves it empty */

#endif
