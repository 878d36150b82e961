/* The set is a map by hash. The queue is an array that is sorted when it is read after a change:
 * wants come and change in bursts, once per frame of the kiosk, and are read in bursts too. */
#include "net/want_set.h"

#include <errno.h>
#include <stdlib.h>

void want_set_finish(struct want_set *set)
{
	struct want *want;
	size_t at = 0;

	while ((want = by_hash_next(&set->by_hash, &at)))
		if (want->state != WANT_QUEUED)
			free(want);
	for (size_t i = 0; i < set->queue_count; i++)
		free(set->queue[i]);
	free(set->queue);
	by_hash_finish(&set->by_hash);
	*set = (struct want_set){ .orders = set->orders };
}

size_t want_set_count(const struct want_set *set)
{
	return set->by_hash.count;
}

struct want *want_set_find(const struct want_set *set, struct hash hash)
{
	return by_hash_find(&set->by_hash, hash);
}

struct want *want_set_next(const struct want_set *set, size_t *at)
{
	return by_hash_next(&set->by_hash, at);
}

int want_set_requeue(struct want_set *set, struct want *want)
{
	if (set->queue_count == set->queue_capacity) {
		size_t capacity = set->queue_capacity ? set->queue_capacity * 2 : 256;
		struct want **larger = realloc(set->queue, capacity * sizeof(struct want *));

		if (!larger)
			return -ENOMEM;
		set->queue = larger;
		set->queue_capacity = capacity;
	}
	want->state = WANT_QUEUED;
	set->queue[set->queue_count++] = want;
	set->queue_changed = true;
	return 0;
}

int want_set_add(struct want_set *set, const struct message_want *asked)
{
	struct want *want;
	int rc;

	if (set->by_hash.count >= WANTS_MAX)
		return -ENOSPC;
	want = calloc(1, sizeof(*want));
	if (!want)
		return -ENOMEM;
	want->entry.key = asked->hash;
	want->asked = *asked;
	want->order = set->orders++;
	want->reported = -1;
	rc = by_hash_add(&set->by_hash, &want->entry);
	if (rc == 0) {
		rc = want_set_requeue(set, want);
		if (rc < 0)
			by_hash_remove(&set->by_hash, asked->hash);
	}
	if (rc < 0)
		free(want);
	return rc;
}

void want_set_change_priority(struct want_set *set, struct want *want, uint32_t priority)
{
	want->asked.priority = priority;
	set->queue_changed = true;
}

void want_set_remove(struct want_set *set, struct want *want)
{
	by_hash_remove(&set->by_hash, want->entry.key);
	if (want->state == WANT_QUEUED)
		want->removed = true;
	else
		free(want);
}

/* Sorts the most urgent want to the end. */
static int by_priority(const void *a, const void *b)
{
	const struct want *left = *(struct want *const *)a, *right = *(struct want *const *)b;

	if (left->asked.priority != right->asked.priority)
		return left->asked.priority < right->asked.priority ? -1 : 1;
	return left->order > right->order ? -1 : 1;
}

struct want *want_set_dequeue(struct want_set *set)
{
	if (set->queue_changed && set->queue_count > 1)
		qsort(set->queue, set->queue_count, sizeof(set->queue[0]), by_priority);
	set->queue_changed = false;
	while (set->queue_count > 0) {
		struct want *want = set->queue[--set->queue_count];

		want->state = WANT_WAITING;
		if (!want->removed)
			return want;
		free(want);
	}
	return NULL;
}

bool want_set_has_queued(const struct want_set *set)
{
	return set->queue_count > 0;
}
