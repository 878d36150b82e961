/* Requests a range of a pack and splits the answer into objects. A range holds objects of one pack
 * in the order of their places, with small gaps. Each object is passed on when it is complete. */
#include <errno.h>
#include <stdio.h>
#include <stdlib.h>

#include "base/clock.h"
#include "base/log.h"
#include "net/downloader_private.h"

struct slot {
	struct hash hash;
	uint64_t place;
	uint32_t size;
	struct want *want; /* NULL: dropped meanwhile; its bytes still go into the cache */
};

struct range {
	struct range *next, **link;
	struct downloader *downloader;
	struct http_request *request;
	uint32_t wanted;   /* slots with a want that have not arrived yet */
	size_t count, now; /* number of slots; index of the slot whose bytes arrive now */
	uint64_t at;       /* place in the pack of the next byte */
	uint64_t bytes;    /* size of the whole range */
	int64_t began_ms;
	struct buffer object; /* bytes received so far of the current slot */
	struct slot slots[];
};

static void unlink_range(struct range *range)
{
	*range->link = range->next;
	if (range->next)
		range->next->link = range->link;
	range->downloader->range_count--;
	range->downloader->flying_bytes -= range->bytes;
	range->downloader->options.link->in_flight--;
	range->downloader->plan_changed = true;
	buffer_finish(&range->object);
	free(range);
}

/* Called when all bytes of the slot have arrived. */
static void finish_slot(struct range *range, struct slot *slot)
{
	struct bytes bytes = buffer_bytes(&range->object);
	struct want *want = slot->want;

	slot->want = NULL;
	if (want) {
		range->wanted--;
		want->range = NULL;
		downloader_arrived(range->downloader, want, bytes);
	} else if (hash_equal(hash_of(bytes), slot->hash)) {
		/* The bytes were downloaded anyway, so they are cached. The cache logs its own
		 * failures. */
		if (cache_put(range->downloader->options.cache, slot->hash, bytes, 0) == 0)
			range->downloader->metrics.from_server++;
	}
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

/* Updates the moving average of the bandwidth. Short ranges measure latency more than bandwidth. */
static void measure(struct range *range)
{
	int64_t took_ms = clock_now_ms() - range->began_ms;
	uint64_t bytes = range->at - range->slots[0].place;
	uint64_t rate = bytes * 1000 / (uint64_t)(took_ms > 0 ? took_ms : 1);

	range->downloader->bytes_per_s = (range->downloader->bytes_per_s * 7 + rate) / 8;
}

static void on_done(void *data, const struct http_result *result)
{
	struct range *range = data;
	struct downloader *downloader = range->downloader;
	struct link *link = downloader->options.link;
	/* A successful answer that ended early (a truncated pack) lacks the objects we asked
	 * for. */
	int rc = result->rc == 0 ? -ENOENT : result->rc;

	if (rc == -EHOSTUNREACH)
		link_failed(link, http_url(downloader->options.http), result->why);
	else
		link_answered(link);
	if (range->now == range->count)
		measure(range);
	for (size_t i = 0; i < range->count; i++) {
		struct want *want = range->slots[i].want;

		range->slots[i].want = NULL;
		if (want) {
			want->range = NULL;
			downloader_failed(downloader, want, rc);
		}
	}
	unlink_range(range);
}

static void fill_slots(struct range *range, const struct range_item *items, size_t count)
{
	for (size_t i = 0; i < count; i++) {
		struct want *want = items[i].want;

		range->slots[i] =
			(struct slot){ want->entry.key, items[i].place, items[i].size, want };
		want->range = range;
		want->state = WANT_FLYING;
	}
	range->count = count;
	range->wanted = (uint32_t)count;
	range->at = items[0].place;
	range->began_ms = clock_now_ms();
}

int64_t downloader_ask_range(struct downloader *downloader, const struct range_item *items,
			     size_t count)
{
	struct range *range = calloc(1, sizeof(*range) + count * sizeof(range->slots[0]));
	char path[64], hex[HASH_HEX_BYTES];
	struct http_ask ask = { .path = path, .receive = on_piece, .done = on_done };

	if (!range)
		return 0;
	hash_to_hex(items[0].pack, hex);
	snprintf(path, sizeof(path), "packs/%s", hex);
	ask.first = items[0].place;
	ask.size = items[count - 1].place + items[count - 1].size - ask.first;
	ask.data = range;
	if (http_ask(downloader->options.http, &ask, &range->request) < 0) {
		free(range);
		return 0;
	}
	range->downloader = downloader;
	buffer_init(&range->object, UINT32_MAX);
	range->bytes = ask.size;
	fill_slots(range, items, count);
	range->next = downloader->ranges;
	range->link = &downloader->ranges;
	if (range->next)
		range->next->link = &range->next;
	downloader->ranges = range;
	downloader->range_count++;
	downloader->flying_bytes += range->bytes;
	downloader->metrics.ranges++;
	downloader->options.link->in_flight++;
	return (int64_t)range->bytes;
}

void downloader_leave_range(struct downloader *downloader, struct want *want)
{
	struct range *range = want->range;

	if (!range)
		return;
	for (size_t i = range->now; i < range->count; i++)
		if (range->slots[i].want == want)
			range->slots[i].want = NULL;
	want->range = NULL;
	if (--range->wanted > 0)
		return;
	downloader->metrics.cancelled++;
	http_cancel(range->request);
	unlink_range(range);
}

void downloader_cancel_ranges(struct downloader *downloader)
{
	while (downloader->ranges) {
		struct range *range = downloader->ranges;

		http_cancel(range->request);
		for (size_t i = 0; i < range->count; i++)
			if (range->slots[i].want)
				range->slots[i].want->range = NULL;
		unlink_range(range);
	}
}
