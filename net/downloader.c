/* Decides where each wanted object comes from: cache, USB stick, or server. It also plans the range
 * requests under the limits for number, size and rate. */
#include "net/downloader.h"

#include <errno.h>
#include <stdlib.h>

#include "base/array.h"
#include "base/clock.h"
#include "base/log.h"
#include "format/page.h"
#include "net/line_rate.h"
#include "net/locators.h"
#include "net/range_plan.h"
#include "net/ranges.h"
#include "net/token_bucket.h"
#include "net/want_set.h"

enum {
	RANGES_MAX = 8,
	/* while all requests together are small, so that latency does not dominate */
	SMALL_RANGES_MAX = 32,
	SMALL_BYTES = 256 << 10,
	/* extra requests for index pages: without pages nothing else can be planned */
	RANGES_FOR_PAGES = 2,
	/* bytes to read and discard rather than send a new request (its cost, and a little more) */
	GAP_BYTES = 512,
	/* A turn is what the line carries in the waiting time. A range is a quarter of it, so that
	 * another can be on its way while one arrives. */
	TURN_BYTES_MIN = 6 << 10,
	RANGES_A_TURN = 4,
	RANGE_BYTES_MAX = 1 << 20,
	/* An object larger than so many ranges is requested in segments of a range each. */
	RANGES_AN_OBJECT = 2,
	LATER_BYTES_MIN = 64 << 10, /* a range for later, however low its rate */
	/* of the waiting time, what the most urgent object may wait for others of its range */
	AHEAD_SHARE = 10,
	WAIT_MS = 500,
	/* Until a want that the line broke with is tried after a pause of the link. Others are
	 * tried first: the server may never have this object, and only one request at a time is
	 * made. */
	BEHIND_MS = 100,
	FIRST_BYTES_PER_S = 1 << 20, /* assumed before the line was measured */
	CACHE_READS_MAX = 64,        /* per call: other sources share the loop */
	ITEMS_MAX = 1 << 20,         /* of one plan */
};

struct downloader {
	struct downloader_options options;
	struct want_set wants;
	struct locators locators;
	struct ranges ranges;
	bool plan_changed;    /* something may be requested that could not be before */
	int64_t stick_due_ms; /* when the stick is asked again for a want; INT64_MAX: for none */
	int64_t plan_due_ms;  /* when the first retry pause ends; INT64_MAX: no want is pausing */
	struct range_item *items; /* scratch memory for planning */
	uint32_t item_room;
	struct buffer scratch; /* holds one object read from the cache */
	bool was_down;         /* all wants were reported as offline */
	struct line_rate line;
	uint32_t wait_ms; /* of one turn */
	/* A range waits until what is ahead of it fits into a turn: its priority and size; 0: none
	 * does. */
	uint32_t held_priority;
	uint64_t held_bytes;
	struct token_bucket rate_limit;      /* for releases that are not shown yet */
	bool later_waits;                    /* something waits only for the rate limit */
	struct downloader_counters counters; /* without those that ranges keeps */
};

/* ---- wants */

/* Reports a missing object, but only when the reason changes. */
static void report(struct downloader *downloader, struct want *want, enum missing_reason reason)
{
	if (want->reported == (int)reason)
		return;
	want->reported = (int)reason;
	downloader->options.events.missing(downloader->options.data, want->asked.hash, reason);
}

static bool has_room(const struct downloader *downloader)
{
	return downloader->options.events.has_room(downloader->options.data);
}

/* True for objects of a release that is not shown yet. The rate limit applies to these, because no
 * visitor waits for them. */
static bool is_for_later(uint32_t priority)
{
	return priority < MESSAGE_PRIORITY_PICTURE;
}

int downloader_want(struct downloader *downloader, const struct message_want *asked)
{
	struct want *want = want_set_find(&downloader->wants, asked->hash);
	int rc;

	if (want) {
		if (is_for_later(want->asked.priority) && !is_for_later(asked->priority))
			downloader->plan_changed = true; /* no longer rate-limited */
		want_set_change_priority(&downloader->wants, want, asked->priority);
		return 0;
	}
	rc = want_set_add(&downloader->wants, asked);
	if (rc != -ENOSPC)
		return rc;
	downloader->options.events.missing(downloader->options.data, asked->hash, MISSING_OFFLINE);
	return 0;
}

void downloader_drop(struct downloader *downloader, struct hash hash)
{
	struct want *want = want_set_find(&downloader->wants, hash);

	if (!want)
		return;
	if (ranges_leave(&downloader->ranges, want))
		downloader->plan_changed = true;
	want_set_remove(&downloader->wants, want);
}

void downloader_keep(struct downloader *downloader, struct hash hash)
{
	int rc = cache_keep(downloader->options.cache, hash);

	if (rc == -ENOSPC)
		log_debug("net", "the cache is full of objects in use");
}

int downloader_use_release(struct downloader *downloader, struct hash root, bool also)
{
	int rc;

	if (!also)
		downloader_clear(downloader);
	rc = locators_add(&downloader->locators, root);
	if (rc < 0)
		return rc;
	if (!also && cache_use_release(downloader->options.cache, root) < 0)
		log_warn("net", "the cache cannot store which release is in use");
	return 0;
}

void downloader_clear(struct downloader *downloader)
{
	ranges_cancel_all(&downloader->ranges);
	want_set_finish(&downloader->wants);
	locators_clear(&downloader->locators);
}

/* ---- objects that arrive */

static void pass_on(struct downloader *downloader, struct want *want, struct bytes bytes)
{
	struct hash hash = want->asked.hash;
	struct segments *segments = want->segments;

	/* The stick may have the object while segments of it are on their way. */
	if (ranges_leave(&downloader->ranges, want))
		downloader->plan_changed = true;
	want->segments = NULL; /* bytes may be theirs */
	want_set_remove(&downloader->wants, want);
	downloader->options.events.object(downloader->options.data, hash, bytes);
	segments_destroy(segments);
}

static void put_into_cache(struct downloader *downloader, const struct want *want,
			   struct bytes bytes)
{
	int rc =
		cache_put(downloader->options.cache, want->asked.hash, bytes, want->asked.priority);

	if (rc < 0)
		log_debug("net", "an object is not in the cache (%d)", rc);
}

/* Handles wrong bytes. The first time the object is requested again at once (a bit may have flipped
 * in transit); the second time the damage is reported. */
static void note_damage(struct downloader *downloader, struct want *want)
{
	char hex[HASH_HEX_BYTES];

	downloader->counters.damaged++;
	if (want->segments)
		segments_forget(want->segments);
	want->damages++;
	want->failures++;
	want->retry_at_ms = clock_now_ms();
	downloader->plan_changed = true;
	if (want->damages < 2)
		return;
	hash_to_hex(want->asked.hash, hex);
	if (want->reported != MISSING_DAMAGED) {
		log_warn("net", "content bug: object %s from the server is damaged", hex);
		metrics_refusal_note(downloader->options.link->refusal, hex,
				     "the server's bytes of this object are damaged");
	}
	want->retry_at_ms += link_pause_ms(want->failures);
	report(downloader, want, MISSING_DAMAGED);
	locators_suspect(&downloader->locators);
}

/* See ranges_options.object. */
static void on_range_object(void *data, struct want *want, uint32_t segment, struct hash hash,
			    struct bytes bytes)
{
	struct downloader *downloader = data;

	if (want && want->segments) {
		if (!segments_put(want->segments, segment, bytes))
			return;
		bytes = segments_bytes(want->segments);
	}
	if (!hash_equal(hash_of(bytes), hash)) {
		if (want)
			note_damage(downloader, want);
	} else if (want) {
		downloader->counters.from_server++;
		put_into_cache(downloader, want, bytes);
		pass_on(downloader, want, bytes);
	} else if (cache_put(downloader->options.cache, hash, bytes, 0) == 0) {
		/* Nobody wants it any more, but its bytes were downloaded anyway. The cache logs
		 * its own failures. */
		downloader->counters.from_server++;
	}
}

/* The waiting want was not delivered. rc is that of struct http_result. */
static void on_failed(void *data, struct want *want, int rc)
{
	struct downloader *downloader = data;
	const int64_t now_ms = clock_now_ms();
	const int64_t behind_ms = downloader->options.link->retry_at_ms + BEHIND_MS;

	downloader->plan_changed = true;
	if (rc == -EHOSTUNREACH && want->retry_at_ms > now_ms)
		return;      /* the segments of an object break together */
	if (rc == -ENOMEM) { /* ours, not the server's */
		want->retry_at_ms = now_ms + NO_MEMORY_MS;
		return;
	}
	want->failures++;
	want->retry_at_ms = now_ms + link_pause_ms(want->failures);
	if (rc == -EHOSTUNREACH) {
		if (want->retry_at_ms < behind_ms)
			want->retry_at_ms = behind_ms;
		return;
	}
	report(downloader, want, rc == -EBADMSG ? MISSING_DAMAGED : MISSING_NOT_FOUND);
	locators_suspect(&downloader->locators);
}

/* More may be requested than before: a range has ended, or a locator has changed. */
static void on_change(void *data)
{
	struct downloader *downloader = data;

	downloader->plan_changed = true;
}

/* ---- the cache */

static void wait_for_server(struct downloader *downloader, struct want *want)
{
	want->state = WANT_WAITING;
	downloader->plan_changed = true;
	if (link_is_down(downloader->options.link))
		report(downloader, want, MISSING_OFFLINE);
}

/* Returns true if the stick was asked; downloader_stick_answered gets the answer. */
static bool request_from_stick(struct downloader *downloader, const struct want *want)
{
	struct hash roots[MESSAGE_RELEASES_MAX];
	size_t count = locators_roots(&downloader->locators, roots);

	return count > 0 && stick_request(downloader->options.stick, roots, count, &want->asked);
}

static void look_up(struct downloader *downloader, struct want *want)
{
	int rc = cache_get(downloader->options.cache, want->asked.hash, want->asked.priority,
			   &downloader->scratch);

	if (rc == 0) {
		downloader->counters.from_cache++;
		pass_on(downloader, want, buffer_bytes(&downloader->scratch));
		return;
	}
	if (request_from_stick(downloader, want))
		want->state = WANT_ON_STICK;
	else
		wait_for_server(downloader, want);
}

static void look_up_queued(struct downloader *downloader)
{
	for (int i = 0; i < CACHE_READS_MAX && has_room(downloader); i++) {
		struct want *want = want_set_dequeue(&downloader->wants);

		if (!want)
			break;
		look_up(downloader, want);
	}
}

/* ---- the stick */

static void note_damage_on_stick(struct downloader *downloader, struct hash hash)
{
	char hex[HASH_HEX_BYTES];

	hash_to_hex(hash, hex);
	metrics_refusal_note(downloader->options.link->refusal, hex,
			     "the stick's bytes of this object are damaged");
	/* logs only the first; there may be thousands */
	if (downloader->counters.stick_damaged++ == 0)
		log_warn("net", "object %s from the stick is damaged", hex);
}

/* Where no server answers, nobody else has the object. */
static void ask_stick_later(struct downloader *downloader, struct want *want)
{
	want->stick_at_ms = clock_now_ms() + link_pause_ms(++want->stick_failures);
	if (want->stick_at_ms < downloader->stick_due_ms)
		downloader->stick_due_ms = want->stick_at_ms;
}

static void ask_stick_again(struct downloader *downloader)
{
	const int64_t now_ms = clock_now_ms();
	struct want *want;
	size_t at = 0;

	if (downloader->stick_due_ms > now_ms)
		return;
	downloader->stick_due_ms = INT64_MAX;
	while ((want = want_set_next(&downloader->wants, &at))) {
		if (want->state != WANT_WAITING || want->stick_at_ms == 0)
			continue;
		if (want->stick_at_ms <= now_ms) {
			want->stick_at_ms = 0;
			if (want_set_requeue(&downloader->wants, want) == 0)
				continue;
			want->stick_at_ms = now_ms + NO_MEMORY_MS;
		}
		if (want->stick_at_ms < downloader->stick_due_ms)
			downloader->stick_due_ms = want->stick_at_ms;
	}
}

void downloader_stick_answered(struct downloader *downloader, struct hash hash, int rc,
			       struct bytes bytes)
{
	struct want *want = want_set_find(&downloader->wants, hash);

	if (rc == -EBADMSG)
		note_damage_on_stick(downloader, hash);
	if (!want || want->state != WANT_ON_STICK)
		return;
	if (rc < 0) {
		if (rc != -ENOENT && rc != -EBADMSG)
			ask_stick_later(downloader, want);
		wait_for_server(downloader, want);
		return;
	}
	downloader->counters.from_stick++;
	put_into_cache(downloader, want, bytes);
	pass_on(downloader, want, bytes);
}

bool downloader_wants_of_stick(const struct downloader *downloader, struct hash hash)
{
	const struct want *want = want_set_find(&downloader->wants, hash);

	return want && want->state == WANT_ON_STICK;
}

void downloader_look_up_again(struct downloader *downloader)
{
	struct want *want;
	size_t at = 0;

	while ((want = want_set_next(&downloader->wants, &at)))
		if (want->state == WANT_WAITING && want_set_requeue(&downloader->wants, want) < 0)
			return; /* stays waiting: the server may have it */
}

/* ---- the server */

/* Returns the bytes of a turn: what is asked for and not here yet, of what is equally urgent. */
static uint64_t turn_bytes(const struct downloader *downloader)
{
	uint64_t bytes = line_rate_carries(&downloader->line, downloader->wait_ms);

	return bytes > TURN_BYTES_MIN ? bytes : TURN_BYTES_MIN;
}

/* Limits for a range whose most urgent object has this priority. */
static struct range_limits limits_now(const struct downloader *downloader, uint32_t priority)
{
	const uint64_t rate = is_for_later(priority) ? downloader->options.rate_limit : 0;
	const uint64_t ahead = turn_bytes(downloader) / AHEAD_SHARE;
	uint64_t most = turn_bytes(downloader) / RANGES_A_TURN;

	if (rate > 0 && rate < most)
		most = rate < LATER_BYTES_MIN ? LATER_BYTES_MIN : rate;
	if (most > RANGE_BYTES_MAX)
		most = RANGE_BYTES_MAX;
	return (struct range_limits){ .gap_bytes = GAP_BYTES,
				      .most_bytes = (uint32_t)most,
				      .ahead_bytes = (uint32_t)ahead };
}

/* Divides an object that would fill the line for too long. Without memory for that it stays
 * whole. */
static void divide(const struct downloader *downloader, struct want *want, uint32_t size)
{
	const uint32_t most = limits_now(downloader, want->asked.priority).most_bytes;

	if (!want->segments && size > most * RANGES_AN_OBJECT &&
	    segments_create(&want->segments, size, most) < 0)
		log_debug("net", "out of memory for the segments of an object");
}

static int add_item(struct downloader *downloader, size_t *count, const struct range_item *item)
{
	int rc = ARRAY_RESERVE(downloader->items, downloader->item_room, *count + 1, ITEMS_MAX);

	if (rc == 0)
		downloader->items[(*count)++] = *item;
	return rc;
}

/* Adds the object at this place, or the segments of it that are lacking. */
static int add_items(struct downloader *downloader, size_t *count, struct range_item item)
{
	struct want *want = item.want;
	const struct segments *segments = want->segments;
	const uint64_t place = item.place;
	int rc = 0;

	if (!segments)
		return add_item(downloader, count, &item);
	for (uint32_t n = 0; n < segments->count && rc == 0; n++) {
		if (segments->states[n] != SEGMENT_LACKING)
			continue;
		item.place = place + (uint64_t)n * segments->bytes_each;
		item.size = segments_size(segments, n);
		item.segment = n;
		rc = add_item(downloader, count, &item);
	}
	return rc;
}

/* For what memory was lacking for. */
static void plan_again(struct downloader *downloader)
{
	const int64_t due_ms = clock_now_ms() + NO_MEMORY_MS;

	log_warn("net", "out of memory for requests; they are tried again in a second");
	if (due_ms < downloader->plan_due_ms)
		downloader->plan_due_ms = due_ms;
}

/* Collects all wants that could be requested now into items, sorted by place. Returns their
 * count. */
static size_t gather(struct downloader *downloader)
{
	int64_t now_ms = clock_now_ms();
	struct want *want;
	size_t at = 0, count = 0;

	downloader->plan_due_ms = INT64_MAX;
	downloader->later_waits = false;
	while ((want = want_set_next(&downloader->wants, &at))) {
		struct range_item item;
		int rc;

		if (want->state != WANT_WAITING)
			continue;
		if (token_bucket_is_empty(&downloader->rate_limit) &&
		    is_for_later(want->asked.priority)) {
			downloader->later_waits = true;
			continue;
		}
		rc = want->retry_at_ms > now_ms ? -EBUSY
						: locators_find(&downloader->locators, &want->asked,
								want->failures, &item);
		if (rc == -ENOENT)
			on_failed(downloader, want, rc);
		if (want->retry_at_ms > now_ms && want->retry_at_ms < downloader->plan_due_ms)
			downloader->plan_due_ms = want->retry_at_ms;
		if (rc < 0)
			continue;
		item.priority = want->asked.priority;
		item.order = want->order;
		item.want = want;
		divide(downloader, want, item.size);
		if (add_items(downloader, &count, item) < 0) {
			plan_again(downloader);
			break;
		}
	}
	range_sort(downloader->items, count);
	return count;
}

static uint32_t ranges_max(const struct downloader *downloader)
{
	return downloader->ranges.bytes < SMALL_BYTES ? SMALL_RANGES_MAX : RANGES_MAX;
}

static bool may_request(const struct downloader *downloader, uint32_t priority)
{
	uint32_t most = ranges_max(downloader);

	if (priority >= MESSAGE_PRIORITY_INDEX)
		most += RANGES_FOR_PAGES;
	return downloader->ranges.count < most && link_may_request(downloader->options.link);
}

/* Returns whether a range of so many bytes is part of this turn. What is less urgent does not
 * count: an urgent object shares the line with it. */
static bool fits_turn(const struct downloader *downloader, uint32_t priority, uint64_t bytes)
{
	const uint64_t ahead = ranges_ahead(&downloader->ranges, priority);

	return ahead == 0 || ahead + bytes <= turn_bytes(downloader);
}

static uint64_t span_of(const struct range_item *items, size_t count)
{
	return items[count - 1].place + items[count - 1].size - items[0].place;
}

/* Returns the highest priority among items that no range has taken yet; 0 if none is left. */
static uint32_t best_priority(const struct range_item *items, size_t count)
{
	uint32_t best = 0;

	for (size_t i = 0; i < count; i++)
		if (!items[i].taken && items[i].priority > best)
			best = items[i].priority;
	return best;
}

static uint32_t later_bytes(const struct range_item *items, size_t count)
{
	uint32_t bytes = 0;

	for (size_t i = 0; i < count; i++)
		if (is_for_later(items[i].priority))
			bytes += items[i].size;
	return bytes;
}

static void request_ranges(struct downloader *downloader)
{
	size_t count, first, taken;
	uint32_t best;

	token_bucket_refill(&downloader->rate_limit);
	if (downloader->later_waits && !token_bucket_is_empty(&downloader->rate_limit))
		downloader->plan_changed = true;
	if (!downloader->plan_changed ||
	    downloader->ranges.count >= ranges_max(downloader) + RANGES_FOR_PAGES ||
	    !link_may_request(downloader->options.link) || !has_room(downloader))
		return;
	count = gather(downloader);
	downloader->plan_changed = false;
	downloader->held_bytes = 0;
	/* The most urgent item decides whether another range may be requested. */
	while (best = best_priority(downloader->items, count),
	       (taken = range_plan(downloader->items, count, limits_now(downloader, best),
				   &first)) > 0) {
		if (is_for_later(best) && token_bucket_is_empty(&downloader->rate_limit)) {
			downloader->later_waits = true;
			return;
		}
		if (!may_request(downloader, best)) {
			downloader->plan_changed = true;
			return;
		}
		if (!fits_turn(downloader, best, span_of(&downloader->items[first], taken))) {
			downloader->held_priority = best;
			downloader->held_bytes = span_of(&downloader->items[first], taken);
			return;
		}
		if (ranges_request(&downloader->ranges, &downloader->items[first], taken) == 0)
			token_bucket_take(&downloader->rate_limit,
					  later_bytes(&downloader->items[first], taken));
		else
			plan_again(downloader);
	}
}

/* When the link goes down, reports MISSING_OFFLINE once to every waiting want. When it comes back,
 * clears these reports. */
static void report_link(struct downloader *downloader)
{
	bool is_down = link_is_down(downloader->options.link);
	struct want *want;
	size_t at = 0;

	if (is_down == downloader->was_down)
		return;
	downloader->was_down = is_down;
	downloader->plan_changed = true;
	while ((want = want_set_next(&downloader->wants, &at))) {
		if (want->state == WANT_QUEUED || want->state == WANT_ON_STICK)
			continue;
		if (is_down)
			report(downloader, want, MISSING_OFFLINE);
		else if (want->reported == MISSING_OFFLINE)
			want->reported = -1;
	}
}

void downloader_work(struct downloader *downloader)
{
	line_rate_note(&downloader->line, http_received_bytes(downloader->options.http),
		       downloader->options.link->in_flight > 0);
	if (downloader->held_bytes > 0 &&
	    fits_turn(downloader, downloader->held_priority, downloader->held_bytes))
		downloader->plan_changed = true;
	ask_stick_again(downloader);
	look_up_queued(downloader);
	locators_work(&downloader->locators);
	report_link(downloader);
	if (downloader->plan_due_ms <= clock_now_ms())
		downloader->plan_changed = true; /* the retry pause of a want is over */
	request_ranges(downloader);
	/* Last, because planning may also find objects without a place. */
	locators_refresh_suspected(&downloader->locators);
}

/* Adjusts due_ms to the state of the link. While a request is in flight after a failure, its answer
 * wakes the loop, so no timer is needed. */
static int64_t link_due_ms(const struct link *link, int64_t due_ms)
{
	if (link->failures == 0 || due_ms == INT64_MAX)
		return due_ms;
	if (link->in_flight > 0)
		return INT64_MAX;
	return due_ms > link->retry_at_ms ? due_ms : link->retry_at_ms;
}

int64_t downloader_due_ms(const struct downloader *downloader)
{
	const struct link *link = downloader->options.link;
	int64_t due_ms = locators_due_ms(&downloader->locators);

	if (!has_room(downloader))
		return link_due_ms(link, due_ms); /* the loop wakes up when the kiosk reads */
	if (want_set_has_queued(&downloader->wants))
		return 0;
	if (downloader->ranges.count < ranges_max(downloader)) {
		int64_t plan_ms = downloader->plan_changed ? 0 : downloader->plan_due_ms;

		if (downloader->later_waits &&
		    token_bucket_due_ms(&downloader->rate_limit) < plan_ms)
			plan_ms = token_bucket_due_ms(&downloader->rate_limit);
		due_ms = plan_ms < due_ms ? plan_ms : due_ms;
	}
	due_ms = link_due_ms(link, due_ms);
	return downloader->stick_due_ms < due_ms ? downloader->stick_due_ms : due_ms;
}

uint32_t downloader_wanted(const struct downloader *downloader)
{
	return (uint32_t)want_set_count(&downloader->wants);
}

void downloader_counters(const struct downloader *downloader, struct downloader_counters *out)
{
	*out = downloader->counters;
	out->ranges = downloader->ranges.requests;
	out->cancelled = downloader->ranges.cancelled;
}

/* ---- create, destroy */

int downloader_create(struct downloader **out, const struct downloader_options *options)
{
	struct downloader *downloader = calloc(1, sizeof(*downloader));
	struct ranges_options ranges = { .http = options->http,
					 .link = options->link,
					 .object = on_range_object,
					 .failed = on_failed,
					 .ended = on_change,
					 .data = downloader };
	struct locators_options locators = { .http = options->http,
					     .cache = options->cache,
					     .link = options->link,
					     .changed = on_change,
					     .data = downloader };

	*out = downloader;
	if (!downloader)
		return -ENOMEM;
	downloader->options = *options;
	downloader->stick_due_ms = INT64_MAX;
	downloader->plan_due_ms = INT64_MAX;
	token_bucket_init(&downloader->rate_limit, options->rate_limit);
	line_rate_init(&downloader->line, FIRST_BYTES_PER_S);
	downloader->wait_ms = options->wait_ms > 0 ? options->wait_ms : WAIT_MS;
	ranges_init(&downloader->ranges, &ranges);
	locators_init(&downloader->locators, &locators);
	buffer_init(&downloader->scratch, OBJECT_BYTES_MAX);
	return 0;
}

void downloader_destroy(struct downloader *downloader)
{
	if (!downloader)
		return;
	downloader_clear(downloader);
	buffer_finish(&downloader->scratch);
	free(downloader->items);
	free(downloader);
}
