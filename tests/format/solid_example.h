/* Makes small octrees of where an eye may be out of a rule that says which cells are full. */
#ifndef GOPURA_TESTS_FORMAT_SOLID_EXAMPLE_H
#define GOPURA_TESTS_FORMAT_SOLID_EXAMPLE_H

#include <stdlib.h>

#include "format/solid.h"
#include "tests/check.h"

enum { SOLID_EXAMPLE_NODES = 1 << 16 };

typedef bool solid_example_rule(const int32_t place[3]);

static inline enum solid_state solid_example_state(solid_example_rule *full, const int32_t low[3],
						   int32_t side)
{
	const bool first = full(low);

	for (int32_t z = 0; z < side; z++)
		for (int32_t y = 0; y < side; y++)
			for (int32_t x = 0; x < side; x++)
				if (full((const int32_t[3]){ low[0] + x, low[1] + y,
							     low[2] + z }) != first)
					return SOLID_DIVIDED;
	return first ? SOLID_FULL : SOLID_FREE;
}

/* Cells of cell_m from the corner at low_m each; the rule must not be all full or all free. End it
 * with solid_finish(). */
static inline void solid_example_init(struct solid *out, uint32_t depth, float cell_m,
				      const float low_m[3], solid_example_rule *full)
{
	int32_t(*places)[3] = calloc(SOLID_EXAMPLE_NODES, sizeof(*places));
	uint32_t at = 0;

	*out = (struct solid){ .low_m = { low_m[0], low_m[1], low_m[2] },
			       .cell_m = cell_m,
			       .room_m = cell_m,
			       .depth = depth,
			       .node_count = 1,
			       .nodes = calloc(SOLID_EXAMPLE_NODES, sizeof(*out->nodes)) };
	for (uint32_t level = depth; level-- > 0;)
		for (const uint32_t end = out->node_count; at < end; at++) {
			out->nodes[at].first = out->node_count;
			for (uint32_t child = 0; child < SOLID_CHILDREN; child++) {
				const int32_t side = 1 << level;
				int32_t low[3];
				uint32_t state;

				for (int axis = 0; axis < 3; axis++)
					low[axis] =
						places[at][axis] + (child >> axis & 1 ? side : 0);
				state = solid_example_state(full, low, side);
				out->nodes[at].states |= (uint16_t)(state << 2 * child);
				if (state != SOLID_DIVIDED)
					continue;
				assert_true(out->node_count < SOLID_EXAMPLE_NODES);
				for (int axis = 0; axis < 3; axis++)
					places[out->node_count][axis] = low[axis];
				out->node_count++;
			}
		}
	free(places);
}

#endif
