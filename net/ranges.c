/* Requests ranges of packs and splits the answers into objects. */
#include "net/ranges.h"

#include <errno.h>
#include <stdio.h>
#include <stdlib.h>

#include "base/clock.h"
#include "base/log.h"

struct slot {
	struct hash hash;
	uint64_t place;
	uint32_t size;
	struct want *want; /* NULL: it left; its bytes are reported all the same */
	uint32_t segment;  /* of a want in segments */
};

struct range {
	struct range *next, **link;
	struct ranges *ranges;
	struct http_request *request;
	uint32_t wanted;      /* slots with a want that have not arrived yet */
	size_t count, now;    /* number of slots; index of the slot whose bytes arrive now */
	uint64_t at;          /* place in the pack of the next byte */
	uint64_t bytes;       /* size of the whole range */
	int64_t asked_ms;     /* when it was requested */
	uint32_t priority;    /* the highest of its wants */
	struct buffer object; /* bytes received so far of the current slot */
	struct slot slots[];
};

void ranges_init(struct ranges *ranges, const struct ranges_options *options)
{
	*ranges = (struct ranges){ .options = *options };
}

static void unlink_range(struct range *range)
{
	struct ranges *ranges = range->ranges;

	*range->link = range->next;
	if (range->next)
		range->next->link = range->link;
	ranges->count--;
	ranges->bytes -= range->bytes;
	ranges->options.link->in_flight--;
	buffer_finish(&range->object);
	free(range);
}

/* Takes the slot's want out of the range. Returns it, or NULL if it has left already. */
static struct want *detach(struct slot *slot)
{
	struct want *want = slot->want;

	if (!want)
		return NULL;
	slot->want = NULL;
	want->in_flight--;
	if (want->segments)
		want->segments->states[slot->segment] = SEGMENT_LACKING;
	else
		want->state = WANT_WAITING;
	return want;
}

/* Called when all bytes of the slot have arrived. */
static void finish_slot(struct range *range, struct slot *slot)
{
	const struct ranges_options *options = &range->ranges->options;
	struct want *want = detach(slot);

	if (want)
		range->wanted--;
	options->object(options->data, want, slot->segment, slot->hash,
			buffer_bytes(&range->object));
	buffer_clear(&range->object);
	range->now++;
}

/* Copies what the slot lacks, or skips the gap before it. Returns the number of bytes used. */
static size_t feed_slot(struct range *range, struct slot *slot, struct bytes piece)
{
	uint64_t gap = slot->place > range->at ? slot->place - range->at : 0;
	size_t lacking = slot->size - range->object.size;

	if (gap > 0)
		return gap < piece.size ? (size_t)gap : piece.size;
	if (lacking > piece.size)
		lacking = piece.size;
	buffer_put(&range->object, piece.data, lacking);
	if (range->object.size == slot->size)
		finish_slot(range, slot);
	return lacking;
}

static bool on_piece(void *data, struct bytes piece)
{
	struct range *range = data;

	while (piece.size > 0 && range->now < range->count && !range->object.error) {
		size_t used = feed_slot(range, &range->slots[range->now], piece);

		range->at += used;
		piece.data += used;
		piece.size -= used;
	}
	return !range->object.error; /* the request ends by itself after its last slot */
}

static void on_done(void *data, const struct http_result *result)
{
	struct range *range = data;
	const struct ranges_options *options = &range->ranges->options;
	/* A successful answer that ended early (a truncated pack) lacks the objects we requested.
	 */
	int rc = result->rc != 0            ? result->rc
		 : range->object.error != 0 ? range->object.error
					    : -ENOENT;

	log_debug("net", "%llu bytes of a pack, priority %u, after %lld ms",
		  (unsigned long long)range->bytes, range->priority,
		  (long long)(clock_now_ms() - range->asked_ms));
	if (rc == -EHOSTUNREACH)
		link_failed(options->link, http_url(options->http), result->why);
	else
		link_answered(options->link);
	for (size_t i = 0; i < range->count; i++) {
		struct want *want = detach(&range->slots[i]);

		if (want)
			options->failed(options->data, want, rc);
	}
	unlink_range(range);
	options->ended(options->data);
}

static void fill_slots(struct range *range, const struct range_item *items, size_t count)
{
	for (size_t i = 0; i < count; i++) {
		struct want *want = items[i].want;

		range->slots[i] = (struct slot){ want->asked.hash, items[i].place, items[i].size,
						 want, items[i].segment };
		want->in_flight++;
		if (want->segments)
			want->segments->states[items[i].segment] = SEGMENT_IN_FLIGHT;
		else
			want->state = WANT_IN_FLIGHT;
		if (want->asked.priority > range->priority)
			range->priority = want->asked.priority;
	}
	range->count = count;
	range->wanted = (uint32_t)count;
	range->at = items[0].place;
}

static void link_range(struct ranges *ranges, struct range *range)
{
	range->ranges = ranges;
	range->next = ranges->first;
	range->link = &ranges->first;
	if (range->next)
		range->next->link = &range->next;
	ranges->first = range;
	ranges->count++;
	ranges->bytes += range->bytes;
	ranges->requests++;
	ranges->options.link->in_flight++;
}

int ranges_request(struct ranges *ranges, const struct range_item *items, size_t count)
{
	struct range *range = calloc(1, sizeof(*range) + count * sizeof(range->slots[0]));
	char path[64], hex[HASH_HEX_BYTES];
	struct http_get get = { .path = path, .receive = on_piece, .done = on_done };
	int rc;

	if (!range)
		return -ENOMEM;
	hash_to_hex(items[0].pack, hex);
	snprintf(path, sizeof(path), "packs/%s", hex);
	get.first = items[0].place;
	get.size = items[count - 1].place + items[count - 1].size - get.first;
	get.data = range;
	rc = http_get(ranges->options.http, &get, &range->request);
	if (rc < 0) {
		free(range);
		return rc;
	}
	buffer_init(&range->object, UINT32_MAX);
	range->bytes = get.size;
	range->asked_ms = clock_now_ms();
	fill_slots(range, items, count);
	link_range(ranges, range);
	return 0;
}

uint64_t ranges_ahead(const struct ranges *ranges, uint32_t priority)
{
	uint64_t sum = 0;

	for (const struct range *range = ranges->first; range; range = range->next)
		if (range->priority >= priority)
			sum += range->bytes - (range->at - range->slots[0].place);
	return sum;
}

/* Removes a want from one range. Returns true if the range has no wants any more. */
static bool leave(struct range *range, const struct want *want)
{
	bool left = false;

	for (size_t i = range->now; i < range->count; i++)
		if (range->slots[i].want == want) {
			detach(&range->slots[i]);
			range->wanted--;
			left = true;
		}
	return left && range->wanted == 0;
}

bool ranges_leave(struct ranges *ranges, struct want *want)
{
	struct range *range, *next;
	bool any = false;

	for (range = ranges->first; range && want->in_flight > 0; range = next) {
		next = range->next;
		if (!leave(range, want))
			continue;
		ranges->cancelled++;
		http_cancel(range->request);
		unlink_range(range);
		any = true;
	}
	return any;
}

void ranges_cancel_all(struct ranges *ranges)
{
	while (ranges->first) {
		struct range *range = ranges->first;

		http_cancel(range->request);
		for (size_t i = 0; i < range->count; i++)
			detach(&range->slots[i]);
		unlink_range(range);
	}
}
