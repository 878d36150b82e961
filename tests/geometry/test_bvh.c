#include <stdbool.h>
#include <stdlib.h>

#include "geometry/bvh.h"
#include "geometry/vec.h"
#include "tests/check.h"

enum { POINTS = 1000 };

/* Points as items; the keys are their places. */
struct points {
	float at[POINTS][3];
	float keys[POINTS][3];
	uint32_t order[POINTS];
	struct bvh_node nodes[POINTS];
	uint32_t node_count;
};

static void extend_by_point(const void *data, uint32_t number, float low[3], float high[3])
{
	const struct points *points = data;

	for (int i = 0; i < 3; i++) {
		low[i] = vec_least(low[i], points->at[number][i]);
		high[i] = vec_most(high[i], points->at[number][i]);
	}
}

static float uniform(uint32_t *seed)
{
	*seed = *seed * 1664525u + 1013904223u;
	return (float)(*seed >> 8) / 16777216.0f;
}

/* The points lie in a box as long as size. */
static void build(struct points *points, uint32_t count, const float size[3],
		  int (*choose_key)(const struct bvh_items *, uint32_t, uint32_t))
{
	struct bvh_items items = { .count = count,
				   .order = points->order,
				   .keys = points->keys[0],
				   .key_count = 3,
				   .extend = extend_by_point,
				   .choose_key = choose_key,
				   .data = points };
	uint32_t seed = 1;

	for (uint32_t p = 0; p < count; p++) {
		for (int i = 0; i < 3; i++)
			points->at[p][i] = size[i] * uniform(&seed);
		vec_copy(points->keys[p], points->at[p]);
		points->order[p] = p;
	}
	points->node_count = bvh_build(points->nodes, &items);
	CHECK(points->node_count <= bvh_nodes_max(count));
}

/* Checks a node and all below it; returns how many levels that is. */
static uint32_t check_node(const struct points *points, uint32_t at)
{
	const struct bvh_node *node = &points->nodes[at], *left = node + 1;
	uint32_t left_levels, right_levels;

	for (uint32_t p = node->first; p < node->first + node->count; p++)
		for (int i = 0; i < 3; i++) {
			CHECK(points->at[points->order[p]][i] >= node->low[i]);
			CHECK(points->at[points->order[p]][i] <= node->high[i]);
			CHECK(points->keys[p][i] == points->at[points->order[p]][i]);
		}
	if (!node->right) {
		CHECK(node->count > 0 && node->count <= BVH_LEAF_MAX);
		return 1;
	}
	CHECK(left->first == node->first);
	CHECK(points->nodes[node->right].first == left->first + left->count);
	CHECK(left->count + points->nodes[node->right].count == node->count);
	left_levels = check_node(points, at + 1);
	right_levels = check_node(points, node->right);
	return 1 + (left_levels > right_levels ? left_levels : right_levels);
}

static const float cube[3] = { 1, 1, 1 };

static void every_node_is_a_range_within_its_box(void **state)
{
	struct points *points = malloc(sizeof(*points));

	(void)state;
	for (uint32_t count = 1; count <= POINTS; count += 1 + count / 7) {
		uint8_t seen[POINTS] = { 0 };

		build(points, count, cube, NULL);
		CHECK(points->nodes[0].first == 0 && points->nodes[0].count == count);
		CHECK(check_node(points, 0) < BVH_STACK_MAX);
		for (uint32_t p = 0; p < count; p++)
			seen[points->order[p]]++;
		for (uint32_t p = 0; p < count; p++)
			CHECK(seen[p] == 1);
	}
	free(points);
}

static int always_y(const struct bvh_items *items, uint32_t first, uint32_t count)
{
	(void)items;
	(void)first;
	(void)count;
	return 1;
}

/* Returns whether the root's children lie on the two sides of a plane across an axis. */
static bool is_parted_along(const struct points *points, int axis)
{
	return points->nodes[1].high[axis] <= points->nodes[points->nodes[0].right].low[axis];
}

static void splits_along_the_longest_axis_or_the_chosen_key(void **state)
{
	struct points *points = malloc(sizeof(*points));

	(void)state;
	for (int axis = 0; axis < 3; axis++) {
		float size[3] = { 1, 1, 1 };

		size[axis] = 2;
		build(points, POINTS, size, NULL);
		for (int i = 0; i < 3; i++)
			CHECK(is_parted_along(points, i) == (i == axis));
		build(points, POINTS, size, always_y);
		CHECK(is_parted_along(points, 1));
	}
	free(points);
}

static void items_in_one_place_are_halved_all_the_same(void **state)
{
	struct points *points = malloc(sizeof(*points));

	(void)state;
	build(points, POINTS, (float[]){ 0, 0, 0 }, NULL);
	CHECK(check_node(points, 0) < BVH_STACK_MAX);
	free(points);
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(every_node_is_a_range_within_its_box),
		cmocka_unit_test(splits_along_the_longest_axis_or_the_chosen_key),
		cmocka_unit_test(items_in_one_place_are_halved_all_the_same),
	};

	return cmocka_run_group_tests(tests, NULL, NULL);
}
