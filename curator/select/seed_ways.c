/* Dijkstra's shortest ways over the borders of superpixels. */
#include "curator/select/seed_ways.h"

#include <errno.h>
#include <math.h>
#include <stdlib.h>

#include "base/array.h"

/* What a step into the next superpixel costs, beside 1 for a strong border between. */
static const float step_cost = 0.03f;

struct waiting {
	float way;
	uint32_t superpixel;
};

/* A heap, the nearest first. */
struct queue {
	struct waiting *items; /* owned */
	uint32_t count, room;
};

static int push(struct queue *queue, float way, uint32_t superpixel)
{
	int rc = ARRAY_RESERVE(queue->items, queue->room, queue->count + 1, UINT32_MAX);
	uint32_t at = queue->count;

	if (rc < 0)
		return rc;
	queue->count++;
	while (at > 0 && queue->items[(at - 1) / 2].way > way) {
		queue->items[at] = queue->items[(at - 1) / 2];
		at = (at - 1) / 2;
	}
	queue->items[at] = (struct waiting){ way, superpixel };
	return 0;
}

static struct waiting pop(struct queue *queue)
{
	const struct waiting first = queue->items[0], last = queue->items[--queue->count];
	uint32_t at = 0;

	for (;;) {
		uint32_t child = 2 * at + 1;

		if (child + 1 < queue->count &&
		    queue->items[child + 1].way < queue->items[child].way)
			child++;
		if (child >= queue->count || queue->items[child].way >= last.way)
			break;
		queue->items[at] = queue->items[child];
		at = child;
	}
	queue->items[at] = last;
	return first;
}

/* The borders of each superpixel. */
struct neighbours {
	uint32_t *first;  /* owned; count + 1 */
	uint32_t *border; /* owned */
};

static int find_neighbours(struct neighbours *out, const struct superpixels *superpixels)
{
	out->first = calloc((size_t)superpixels->count + 2, sizeof(*out->first));
	out->border = malloc((2 * (size_t)superpixels->border_count + 1) * sizeof(*out->border));
	if (!out->first || !out->border)
		return -ENOMEM;
	for (uint32_t n = 0; n < superpixels->border_count; n++) {
		out->first[superpixels->borders[n].a + 2]++;
		out->first[superpixels->borders[n].b + 2]++;
	}
	for (uint32_t n = 2; n < superpixels->count + 2; n++)
		out->first[n] += out->first[n - 1];
	for (uint32_t n = 0; n < superpixels->border_count; n++) {
		out->border[out->first[superpixels->borders[n].a + 1]++] = n;
		out->border[out->first[superpixels->borders[n].b + 1]++] = n;
	}
	return 0;
}

static int run(float *ways, const struct superpixels *superpixels,
	       const struct neighbours *neighbours, const uint32_t *seeds)
{
	struct queue queue = { 0 };
	int rc = 0;

	for (uint32_t n = 0; n < superpixels->count && rc == 0; n++) {
		ways[n] = seeds[n] > 0 ? 0 : INFINITY;
		if (seeds[n] > 0)
			rc = push(&queue, 0, n);
	}
	while (queue.count > 0 && rc == 0) {
		const struct waiting its = pop(&queue);

		if (its.way > ways[its.superpixel])
			continue;
		for (uint32_t i = neighbours->first[its.superpixel];
		     i < neighbours->first[its.superpixel + 1] && rc == 0; i++) {
			const struct superpixel_border *border =
				&superpixels->borders[neighbours->border[i]];
			const uint32_t to = border->a == its.superpixel ? border->b : border->a;
			const float way = its.way + step_cost + 1 -
					  superpixel_border_cost(superpixels, border);

			if (way < ways[to]) {
				ways[to] = way;
				rc = push(&queue, way, to);
			}
		}
	}
	free(queue.items);
	return rc;
}

int seed_ways_find(float **out, const struct superpixels *superpixels, const uint32_t *seeds)
{
	struct neighbours neighbours;
	int rc = find_neighbours(&neighbours, superpixels);

	*out = malloc(((size_t)superpixels->count + 1) * sizeof(**out));
	if (rc == 0 && !*out)
		rc = -ENOMEM;
	if (rc == 0)
		rc = run(*out, superpixels, &neighbours, seeds);
	free(neighbours.first);
	free(neighbours.border);
	if (rc < 0) {
		free(*out);
		*out = NULL;
	}
	return rc;
}
