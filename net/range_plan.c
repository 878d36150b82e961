/* Selects neighbouring objects for one range request, starting from the most urgent one and growing
 * in both directions. */
#include "net/range_plan.h"

#include <stdlib.h>

static int by_place(const void *a, const void *b)
{
	const struct range_item *left = a, *right = b;
	int packs = hash_compare(left->pack, right->pack);

	if (packs != 0)
		return packs;
	return (left->place > right->place) - (left->place < right->place);
}

void range_sort(struct range_item *items, size_t count)
{
	if (count > 1)
		qsort(items, count, sizeof(items[0]), by_place);
}

static bool goes_before(const struct range_item *a, const struct range_item *b)
{
	return a->priority != b->priority ? a->priority > b->priority : a->order < b->order;
}

static uint64_t end_of(const struct range_item *item)
{
	return item->place + item->size;
}

/* Returns whether the range from left's place to right's end may grow by `outer`, the neighbour of
 * `inner`. Overlapping objects are never joined (one of their places must be wrong). */
static bool may_join(const struct range_item *left, const struct range_item *right,
		     const struct range_item *outer, const struct range_item *inner,
		     struct range_limits limits)
{
	uint64_t gap;

	if (outer->taken || !hash_equal(outer->pack, inner->pack))
		return false;
	gap = outer < inner ? inner->place - end_of(outer) : outer->place - end_of(inner);
	if (outer < inner ? end_of(outer) > inner->place : end_of(inner) > outer->place)
		return false;
	return gap <= limits.gap_bytes && end_of(right) - left->place <= limits.most_bytes;
}

size_t range_plan(struct range_item *items, size_t count, struct range_limits limits, size_t *first)
{
	size_t left = count, right, start;

	for (size_t i = 0; i < count; i++)
		if (!items[i].taken && (left == count || goes_before(&items[i], &items[left])))
			left = i;
	if (left == count)
		return 0;
	right = start = left;
	for (;;) {
		bool down = left > 0 &&
			    may_join(&items[left - 1], &items[right], &items[left - 1],
				     &items[left], limits) &&
			    (items[left - 1].priority == items[start].priority ||
			     items[start].place - items[left - 1].place <= limits.ahead_bytes);
		bool up = right + 1 < count && may_join(&items[left], &items[right + 1],
							&items[right + 1], &items[right], limits);

		if (down && (!up || goes_before(&items[left - 1], &items[right + 1])))
			left--;
		else if (up)
			right++;
		else
			break;
	}
	for (size_t i = left; i <= right; i++)
		items[i].taken = true;
	*first = left;
	return right - left + 1;
}
