/* Divides the nodes of a graph in two with the least cost: the binary labelling problem of P0
 * equation 1, solved by a maximum flow. */
#ifndef GOPURA_CURATOR_SELECT_MIN_CUT_H
#define GOPURA_CURATOR_SELECT_MIN_CUT_H

#include <stdbool.h>
#include <stdint.h>

#include "base/compiler.h"

/* What a node costs in the rest and in the part; not negative. */
struct min_cut_node {
	float rest_cost, part_cost;
};

/* What it costs if the nodes a and b are divided; not negative. */
struct min_cut_link {
	uint32_t a, b;
	float cost;
};

/* Sets in_part for each node. Costs are rounded to 1/1024 and taken as at most 100 000. -ENOMEM. */
must_check int min_cut(bool *in_part, const struct min_cut_node *nodes, uint32_t node_count,
		       const struct min_cut_link *links, uint32_t link_count);

#endif
