/* A doubly linked list of numbers. */
#include "pipeline/samples/recency.h"

#include <errno.h>
#include <stdlib.h>

struct recency_links {
	uint32_t newer, older; /* RECENCY_NONE: the end of the list */
};

int recency_init(struct recency *recency, uint32_t count)
{
	recency->newest = recency->oldest = RECENCY_NONE;
	recency->links = calloc(count, sizeof(*recency->links));
	return recency->links ? 0 : -ENOMEM;
}

void recency_finish(struct recency *recency)
{
	free(recency->links);
}

void recency_add(struct recency *recency, uint32_t number)
{
	recency->links[number] = (struct recency_links){ RECENCY_NONE, recency->newest };
	if (recency->newest == RECENCY_NONE)
		recency->oldest = number;
	else
		recency->links[recency->newest].newer = number;
	recency->newest = number;
}

void recency_remove(struct recency *recency, uint32_t number)
{
	struct recency_links links = recency->links[number];

	if (links.newer == RECENCY_NONE)
		recency->newest = links.older;
	else
		recency->links[links.newer].older = links.older;
	if (links.older == RECENCY_NONE)
		recency->oldest = links.newer;
	else
		recency->links[links.older].newer = links.newer;
}
