#include "curator/select/min_cut.h"

#include <errno.h>
#include <math.h>
#include <stdlib.h>

#include "base/compiler.h"
#include "tests/check.h"

enum { NODES_MAX = 12, LINKS_MAX = 40 };

static double cost_of(const bool *in_part, const struct min_cut_node *nodes, uint32_t node_count,
		      const struct min_cut_link *links, uint32_t link_count)
{
	double sum = 0;

	for (uint32_t n = 0; n < node_count; n++)
		sum += (double)(in_part[n] ? nodes[n].part_cost : nodes[n].rest_cost);
	for (uint32_t n = 0; n < link_count; n++)
		if (in_part[links[n].a] != in_part[links[n].b])
			sum += (double)links[n].cost;
	return sum;
}

static void no_division_is_cheaper(void **state)
{
	uint32_t chance = 1;

	(void)state;
	for (int round = 0; round < 300; round++) {
		struct min_cut_node nodes[NODES_MAX];
		struct min_cut_link links[LINKS_MAX];
		bool found[NODES_MAX], other[NODES_MAX];
		const uint32_t count = 2 + (uint32_t)round % (NODES_MAX - 1),
			       link_count = (uint32_t)round % LINKS_MAX;

		for (uint32_t n = 0; n < count; n++) {
			chance = chance * 1664525 + 1013904223;
			nodes[n].rest_cost = (float)(chance >> 28);
			chance = chance * 1664525 + 1013904223;
			nodes[n].part_cost = (float)(chance >> 28);
		}
		for (uint32_t n = 0; n < link_count; n++) {
			chance = chance * 1664525 + 1013904223;
			links[n].a = (chance >> 8) % count;
			links[n].b = (links[n].a + 1 + (chance >> 16) % (count - 1)) % count;
			links[n].cost = (float)(chance >> 29);
		}
		CHECK(min_cut(found, nodes, count, links, link_count) == 0);
		const double cost = cost_of(found, nodes, count, links, link_count);
		for (uint32_t bits = 0; bits < 1u << count; bits++) {
			for (uint32_t n = 0; n < count; n++)
				other[n] = bits >> n & 1;
			CHECK(cost <= cost_of(other, nodes, count, links, link_count) + 1e-3);
		}
	}
}

/* A chain is cut at its weakest link. */
static void a_chain_is_cut_where_it_is_weakest(void **state)
{
	enum { LENGTH = 5000, WEAKEST = 3210 };
	struct min_cut_node *nodes = calloc(LENGTH, sizeof(*nodes));
	struct min_cut_link *links = calloc(LENGTH, sizeof(*links));
	bool *in_part = calloc(LENGTH, sizeof(*in_part));

	(void)state;
	nodes[0].rest_cost = 1e9f; /* is taken as the most there is */
	nodes[LENGTH - 1].part_cost = 1e9f;
	for (uint32_t n = 0; n + 1 < LENGTH; n++)
		links[n] = (struct min_cut_link){ n, n + 1, n == WEAKEST ? 0.5f : 1 };
	CHECK(min_cut(in_part, nodes, LENGTH, links, LENGTH - 1) == 0);
	for (uint32_t n = 0; n < LENGTH; n++)
		CHECK(in_part[n] == (n <= WEAKEST));
	free(nodes);
	free(links);
	free(in_part);
}

static void nothing_is_cut_out_of_nothing(void **state)
{
	const struct min_cut_node node = { 1, 1 };
	bool in_part = true;

	(void)state;
	CHECK(min_cut(&in_part, &node, 0, NULL, 0) == 0);
	CHECK(in_part);
	CHECK(min_cut(&in_part, &node, 1, NULL, 0) == 0);
	CHECK(!in_part); /* equal costs: the rest */
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(no_division_is_cheaper),
		cmocka_unit_test(a_chain_is_cut_where_it_is_weakest),
		cmocka_unit_test(nothing_is_cut_out_of_nothing),
	};

	return cmocka_run_group_tests(tests, NULL, NULL);
}
