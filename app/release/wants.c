/* Compares the objects wanted this turn with those already asked for, as two lists sorted by hash,
 * and sends only the differences to the fetcher. */
#include "app/release/wants.h"

#include <stdlib.h>
#include <string.h>

enum {
	/* Divisor for priorities: twice MESSAGE_PRIORITY_INDEX, the highest priority, becomes 999.
	 */
	LATER_SHARE = 2 * MESSAGE_PRIORITY_INDEX / MESSAGE_PRIORITY_PICTURE + 2,
};

static int by_hash(const void *a, const void *b)
{
	const struct message_want *left = a, *right = b;

	return hash_compare(left->hash, right->hash);
}

void wants_init(struct wants *wants, struct net_client *client)
{
	wants->client = client;
	wants->said_count = 0;
	wants->next_count = 0;
	wants->later = false;
}

void wants_begin(struct wants *wants)
{
	wants->next_count = 0;
	wants->later = false;
}

void wants_add(struct wants *wants, const struct message_want *want)
{
	if (wants->next_count == WANTS_MAX)
		return;
	wants->next[wants->next_count] = *want;
	if (wants->later)
		wants->next[wants->next_count].priority /= LATER_SHARE;
	wants->next_count++;
}

void wants_later(struct wants *wants)
{
	wants->later = true;
}

/* Sorts the new list by hash and keeps each hash once, with its highest priority. */
static void tidy(struct wants *wants)
{
	uint32_t kept = 0;

	qsort(wants->next, wants->next_count, sizeof(wants->next[0]), by_hash);
	for (uint32_t i = 0; i < wants->next_count; i++) {
		const struct message_want *want = &wants->next[i];

		if (kept > 0 && hash_equal(wants->next[kept - 1].hash, want->hash)) {
			if (want->priority > wants->next[kept - 1].priority)
				wants->next[kept - 1] = *want;
			continue;
		}
		wants->next[kept++] = *want;
	}
	wants->next_count = kept;
}

/* Returns whether the priorities differ enough, by a quarter of the lower one, to be worth a
 * message. */
static bool priority_differs(uint32_t a, uint32_t b)
{
	const uint32_t low = a < b ? a : b, high = a < b ? b : a;

	return high - low > low / 4;
}

bool wants_say(struct wants *wants)
{
	struct net_client *client = wants->client;
	uint32_t a = 0, b = 0, kept = 0;
	bool all;

	tidy(wants);
	while (a < wants->said_count || b < wants->next_count) {
		struct message_want *said = &wants->said[a], *next = &wants->next[b];
		int rc = 0;
		int order = a == wants->said_count   ? 1
			    : b == wants->next_count ? -1
						     : by_hash(said, next);

		if (order < 0) {
			net_client_drop(client, said->hash);
			a++;
		} else if (order > 0) {
			rc = net_client_want(client, next);
			b++;
		} else {
			if (priority_differs(said->priority, next->priority))
				rc = net_client_want(client, next);
			else
				next->priority = said->priority;
			a++;
			b++;
		}
		if (order >= 0 && rc == 0)
			wants->next[kept++] = *next;
	}
	all = kept == wants->next_count;
	memcpy(wants->said, wants->next, kept * sizeof(wants->next[0]));
	wants->said_count = kept;
	return all;
}

void wants_arrived(struct wants *wants, struct hash hash)
{
	struct message_want key = { .hash = hash };
	struct message_want *found =
		bsearch(&key, wants->said, wants->said_count, sizeof(key), by_hash);

	if (!found)
		return;
	wants->said_count--;
	memmove(found, found + 1,
		(size_t)(wants->said + wants->said_count - found) * sizeof(*found));
}

void wants_on_release(void *data, const struct exhibit_change *change)
{
	struct wants *wants = data;

	if (!change->shown->scene)
		return;
	net_client_use_release(wants->client, change->shown->root, change->shown->root_bytes);
	wants_init(wants, wants->client);
}
