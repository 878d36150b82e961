/* The set is a map by hash. The queue is an array that is sorted when it is read after a change:
 * wants come and change in bursts, once per frame of the kiosk, and are read in bursts too. */
#include "net/want_set.h"

#include <errno.h>
#include <stdlib.h>

#include "base/array.h"

static void free_want(struct want *want)
{
	segments_destroy(want->segments);
	free(want);
}

void want_set_finish(struct want_set *set)
{
	struct want *want;
	size_t at = 0;

	while ((want = map_next_pointer(&set->wants, &at)))
		if (want->state != WANT_QUEUED)
			free_want(want);
	for (uint32_t i = 0; i < set->queue_count; i++)
		free_want(set->queue[i]);
	free(set->queue);
	map_finish(&set->wants);
	*set = (struct want_set){ .orders = set->orders };
}

size_t want_set_count(const struct want_set *set)
{
	return set->wants.count;
}

struct want *want_set_find(const struct want_set *set, struct hash hash)
{
	return map_get_pointer(&set->wants, hash_key(hash));
}

struct want *want_set_next(const struct want_set *set, size_t *at)
{
	return map_next_pointer(&set->wants, at);
}

int want_set_requeue(struct want_set *set, struct want *want)
{
	int rc = ARRAY_RESERVE(set->queue, set->queue_room, set->queue_count + 1, UINT32_MAX);

	if (rc < 0)
		return rc;
	want->state = WANT_QUEUED;
	set->queue[set->queue_count++] = want;
	set->queue_changed = true;
	return 0;
}

int want_set_add(struct want_set *set, const struct message_want *asked)
{
	struct want *want;
	int rc;

	if (set->wants.count >= WANTS_MAX)
		return -ENOSPC;
	want = calloc(1, sizeof(*want));
	if (!want)
		return -ENOMEM;
	want->asked = *asked;
	want->order = set->orders++;
	want->reported = -1;
	rc = map_set(&set->wants, hash_key(asked->hash), (uintptr_t)want);
	if (rc == 0) {
		rc = want_set_requeue(set, want);
		if (rc < 0)
			map_remove(&set->wants, hash_key(asked->hash));
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
	map_remove(&set->wants, hash_key(want->asked.hash));
	if (want->state == WANT_QUEUED)
		want->removed = true;
	else
		free_want(want);
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
		free_want(want);
	}
	return NULL;
}

bool want_set_has_queued(const struct want_set *set)
{
	return set->queue_count > 0;
}
