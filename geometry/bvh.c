/* Builds bounding volume hierarchies by median splits. The boxes come last, from the leaves up, so
 * each item is looked at once. */
#include "geometry/bvh.h"

#include <math.h>

#include "base/compiler.h"
#include "geometry/vec.h"

struct builder {
	struct bvh_node *nodes;
	uint32_t node_count;
	const struct bvh_items *items;
};

static float key_of(const struct bvh_items *items, int64_t at, int key)
{
	return items->keys[at * items->key_count + key];
}

static force_inline void swap_keys(float *a, float *b, int count)
{
	for (int k = 0; k < count; k++) {
		float key = a[k];

		a[k] = b[k];
		b[k] = key;
	}
}

static void swap_items(const struct bvh_items *items, int64_t i, int64_t j)
{
	float *a = &items->keys[i * items->key_count], *b = &items->keys[j * items->key_count];
	uint32_t number = items->order[i];

	items->order[i] = items->order[j];
	items->order[j] = number;
	if (items->key_count == 6) /* the kiosk's patches: without a loop */
		swap_keys(a, b, 6);
	else
		swap_keys(a, b, items->key_count);
}

/* Wirth's selection algorithm: moves the median item along a key to the middle of the range. */
static void split_at_median(const struct bvh_items *items, uint32_t first, uint32_t count, int key)
{
	int64_t low = first, high = low + count - 1, middle = low + count / 2;

	while (low < high) {
		float pivot = key_of(items, middle, key);
		int64_t i = low, j = high;

		while (i <= j) {
			while (key_of(items, i, key) < pivot)
				i++;
			while (key_of(items, j, key) > pivot)
				j--;
			if (i <= j)
				swap_items(items, i++, j--);
		}
		if (j < middle)
			low = i;
		if (middle < i)
			high = j;
	}
}

float bvh_extent(const struct bvh_items *items, uint32_t first, uint32_t count, int key)
{
	float least = INFINITY, most = -INFINITY;

	for (int64_t at = first; at < (int64_t)first + count; at++) {
		least = vec_least(least, key_of(items, at, key));
		most = vec_most(most, key_of(items, at, key));
	}
	return most - least;
}

static int longest_axis(const struct bvh_items *items, uint32_t first, uint32_t count)
{
	float longest = 0;
	int axis = 0;

	for (int k = 0; k < 3; k++) {
		float extent = bvh_extent(items, first, count, k);

		if (extent > longest) {
			longest = extent;
			axis = k;
		}
	}
	return axis;
}

static uint32_t split(struct builder *b, uint32_t first, uint32_t count)
{
	uint32_t self = b->node_count++, half = count / 2;
	int key;

	b->nodes[self] = (struct bvh_node){ .first = first, .count = count };
	if (count <= BVH_LEAF_MAX)
		return self;
	key = b->items->choose_key ? b->items->choose_key(b->items, first, count)
				   : longest_axis(b->items, first, count);
	split_at_median(b->items, first, count, key);
	split(b, first, half);
	b->nodes[self].right = split(b, first + half, count - half);
	return self;
}

static void bound_leaf(struct bvh_node *leaf, const struct bvh_items *items)
{
	for (int i = 0; i < 3; i++) {
		leaf->low[i] = INFINITY;
		leaf->high[i] = -INFINITY;
	}
	for (uint32_t at = leaf->first; at < leaf->first + leaf->count; at++)
		items->extend(items->data, items->order[at], leaf->low, leaf->high);
}

uint32_t bvh_nodes_max(uint32_t item_count)
{
	/* A leaf has at least four items, unless it is the root. */
	return item_count / 2 + 1;
}

uint32_t bvh_build(struct bvh_node *nodes, struct bvh_items *items)
{
	struct builder b = { .nodes = nodes, .items = items };

	split(&b, 0, items->count);
	for (uint32_t n = b.node_count; n-- > 0;) {
		const struct bvh_node *left = &nodes[n + 1], *right = &nodes[nodes[n].right];

		if (!nodes[n].right) {
			bound_leaf(&nodes[n], items);
			continue;
		}
		for (int i = 0; i < 3; i++) {
			nodes[n].low[i] = vec_least(left->low[i], right->low[i]);
			nodes[n].high[i] = vec_most(left->high[i], right->high[i]);
		}
	}
	return b.node_count;
}
