/* Weighted graphs and their division by METIS (Karypis and Kumar 1998). Large graphs are shrunk to
 * clusters first, and the cut is smoothed afterwards (docs/hierarchy.md). METIS uses one random
 * generator per process. graph_divide seeds it and holds a lock, so that the result depends on the
 * graph alone. Any thread. */
#ifndef GOPURA_PIPELINE_HIERARCHY_GRAPH_H
#define GOPURA_PIPELINE_HIERARCHY_GRAPH_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "base/compiler.h"

struct graph_edge {
	uint32_t a, b;
	int32_t weight; /* 1 or more */
};

/* A graph as a list of edges in the order they were added. */
struct graph {
	uint32_t node_count;
	int32_t *node_weights; /* owned */
	struct graph_edge *edges;
	size_t edge_count;
	uint32_t edge_room;
};

must_check int graph_init(struct graph *graph,
			  uint32_t node_count); /* all nodes get weight 1; -ENOMEM */
/* Frees the graph. NULL and zeroed are fine. */
void graph_finish(struct graph *graph);
/* Adds an edge. The weights of edges between the same nodes add up; an edge from a node to itself
 * is ignored. Returns -ENOMEM, or -EFBIG past UINT32_MAX edges. */
must_check int graph_add(struct graph *graph, uint32_t a, uint32_t b, int32_t weight);

/* Connects the parts of a disconnected graph where they are near each other, by edges of that
 * weight. at[node] is a node's position in coarse steps. Returns -ENOMEM. */
must_check int graph_connect(struct graph *graph, float (*at)[3], int32_t weight);

/* Divides the graph. Sets labels[node] to 0..part_count-1; no part is empty if there are enough
 * nodes. shares (may be NULL) are the wanted shares of the weight, with sum 1; they count only for
 * two parts. Returns -ENOMEM, or -EINVAL if METIS refuses the graph. */
must_check int graph_divide(uint32_t *labels, const struct graph *graph, uint32_t part_count,
			    const float *shares);

#endif
