/* Weighted graphs and their division by METIS (Karypis and Kumar 1998).
 * METIS draws from one random generator of the process; graph_divide seeds it and holds a lock, so
 * that the answer depends on the graph alone. Any thread. */
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

/* Edges as they are found, then sealed into rows. */
struct graph {
	uint32_t node_count;
	int32_t *node_weights; /* owned */
	struct graph_edge *edges;
	size_t edge_count, edge_room;
};

must_check int graph_init(struct graph *graph, uint32_t node_count); /* weights 1 */
void graph_finish(struct graph *graph);
/* Two edges between the same nodes weigh their sum; an edge from a node to itself is ignored. */
must_check int graph_add(struct graph *graph, uint32_t a, uint32_t b, int32_t weight);

/* Joins what is disconnected where it is near, by edges of the weight: at[node] is where a node is,
 * in lattice steps. */
must_check int graph_connect(struct graph *graph, float (*at)[3], int32_t weight);

/* labels[node] in 0..part_count-1; no part is empty where there are nodes enough. shares, where not
 * NULL, are the wanted shares of the weight where there are two parts, with sum 1. */
must_check int graph_divide(uint32_t *labels, const struct graph *graph, uint32_t part_count,
			    const float *shares);

#endif
