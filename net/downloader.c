#include "net/downloader.h"

#include <errno.h>
#include <stdlib.h>

#include "base/clock.h"
#include "base/log.h"
#include "format/page.h"
#include "net/downloader_private.h"

enum {
	WANTS_MOST = 1 << 18,
	RANGES_MOST = 8,
	SMALL_RANGES_MOST = 32, /* as long as all together stay small: the line's delay */
	SMALL_BYTES = 256 << 10,
	RANGES_FOR_PAGES = 2, /* beside those: nothing can be judged without pages */
	GAP_BYTES = 512, /* what a request of its own would cost on the line, and a little more */
	RANGE_BYTES_LEAST = 64 << 10,
	RANGE_BYTES_MOST = 1 << 20,
	RANGE_MS = 250, /* of the line: what comes later in it should not wait longer */
	BYTES_PER_S_FIRST = 1 << 20,
	CACHE_READS_MOST = 64, /* in one go: the loop has other guests */
};

/* ---- create, destroy */

int bring_create(struct bring **out, const struct bring_options *options)
{
	struct bring *bring = calloc(1, sizeof(*bring));

	*out = bring;
	if (!bring)
		return -ENOMEM;
	bring->options = *options;
	bring->bytes_per_s = BYTES_PER_S_FIRST;
	bring->plan_due_ms = INT64_MAX;
	buffer_init(&bring->scratch, OBJECT_BYTES_MOST);
	return 0;
}

void bring_destroy(struct bring *bring)
{
	if (!bring)
		return;
	bring_forget_all(bring);
	by_hash_finish(&bring->wants);
	buffer_finish(&bring->scratch);
	free(bring->fresh);
	free(bring->items);
	free(bring);
}

/* ---- wants come and go */

static int add_fresh(struct bring *bring, struct want *want)
{
	if (bring->fresh_count == bring->fresh_capacity) {
		size_t capacity = bring->fresh_capacity ? bring->fresh_capacity * 2 : 256;
		struct want **larger = realloc(bring->fresh, capacity * sizeof(*larger));

		if (!larger)
			return -ENOMEM;
		bring->fresh = larger;
		bring->fresh_capacity = capacity;
	}
	want->state = WANT_FRESH;
	bring->fresh[bring->fresh_count++] = want;
	bring->fresh_changed = true;
	return 0;
}

static void report(struct bring *bring, struct want *want, enum missing_reason reason)
{
	if (want->reported == (int)reason)
		return;
	want->reported = (int)reason;
	bring->options.events.missing(bring->options.data, want->entry.key, reason);
}

/* Of a release that is not shown yet: the rate limit is for that, no visitor waits for it. */
static bool is_for_later(uint32_t priority)
{
	return priority < MESSAGE_PRIORITY_PICTURE;
}

void bring_want(struct bring *bring, const struct message_want *asked)
{
	struct want *want = by_hash_find(&bring->wants, asked->hash);

	if (want) {
		if (is_for_later(want->asked.priority) && !is_for_later(asked->priority))
			bring->plan_changed = true; /* it waits for the rate no more */
		want->asked.priority = asked->priority;
		bring->fresh_changed = true;
		return;
	}
	want = calloc(1, sizeof(*want));
	if (want && bring->wants.count < WANTS_MOST) {
		want->entry.key = asked->hash;
		want->asked = *asked;
		want->order = bring->orders++;
		want->reported = -1;
		if (add_fresh(bring, want) == 0) {
			if (by_hash_add(&bring->wants, &want->entry) == 0)
				return;
			bring->fresh_count--;
		}
	}
	free(want);
	bring->options.events.missing(bring->options.data, asked->hash, MISSING_OFFLINE);
}

/* Out of the map; freed unless it still stands among the fresh. */
static void forget(struct bring *bring, struct want *want)
{
	by_hash_remove(&bring->wants, want->entry.key);
	if (want->state == WANT_FRESH)
		want->dropped = true;
	else
		free(want);
}

void bring_drop(struct bring *bring, struct hash hash)
{
	struct want *want = by_hash_find(&bring->wants, hash);

	if (!want)
		return;
	bring_leave_range(bring, want);
	forget(bring, want);
}

void bring_keep(struct bring *bring, struct hash hash)
{
	int rc = cache_keep(bring->options.cache, hash);

	if (rc == -ENOSPC)
		log_debug("net", "the cache keeps as much as it may");
}

void bring_forget_all(struct bring *bring)
{
	struct want *want;
	size_t at = 0;

	bring_cancel_ranges(bring);
	while ((want = by_hash_next(&bring->wants, &at)))
		if (want->state != WANT_FRESH)
			free(want);
	for (size_t i = 0; i < bring->fresh_count; i++)
		free(bring->fresh[i]);
	bring->fresh_count = 0;
	by_hash_finish(&bring->wants);
	bring_forget_releases(bring);
}

/* ---- what comes */

static void pass_on(struct bring *bring, struct want *want, struct bytes bytes)
{
	struct hash hash = want->entry.key;

	want->state = WANT_WAITING; /* among the fresh no longer: forget frees it */
	forget(bring, want);
	bring->options.events.object(bring->options.data, hash, bytes);
}

/* Wrong bytes: once more at once (a flipped bit on the way), then it is damage and told. */
static void note_damage(struct bring *bring, struct want *want)
{
	char hex[HASH_HEX_BYTES];

	bring->figures.damaged++;
	want->state = WANT_WAITING;
	want->damages++;
	want->failures++;
	want->retry_at_ms = clock_now_ms();
	bring->plan_changed = true;
	if (want->damages < 2)
		return;
	hash_to_hex(want->entry.key, hex);
	if (want->reported != MISSING_DAMAGED) {
		log_warn("net", "content bug: the server's bytes of object %s are damaged", hex);
		refusal_note(bring->options.link->refusal, hex,
			     "the server's bytes of this object are damaged");
	}
	want->retry_at_ms += link_pause_ms(want->failures);
	report(bring, want, MISSING_DAMAGED);
	bring_suspect_locators(bring);
}

void bring_arrived(struct bring *bring, struct want *want, struct bytes bytes)
{
	int rc;

	if (!hash_equal(hash_of(bytes), want->entry.key)) {
		note_damage(bring, want);
		return;
	}
	bring->figures.from_server++;
	rc = cache_put(bring->options.cache, want->entry.key, bytes, want->asked.priority);
	if (rc < 0)
		log_debug("net", "an object did not get into the cache (%d)", rc);
	pass_on(bring, want, bytes);
}

void bring_failed(struct bring *bring, struct want *want, int rc)
{
	want->state = WANT_WAITING;
	want->retry_at_ms = 0; /* the line's pause is pause enough */
	bring->plan_changed = true;
	if (rc == -EHOSTUNREACH)
		return;
	want->failures++;
	want->retry_at_ms = clock_now_ms() + link_pause_ms(want->failures);
	report(bring, want, rc == -EBADMSG ? MISSING_DAMAGED : MISSING_NOT_FOUND);
	bring_suspect_locators(bring);
}

/* ---- the cache */

static int by_priority(const void *a, const void *b)
{
	const struct want *left = *(struct want *const *)a, *right = *(struct want *const *)b;

	if (left->asked.priority != right->asked.priority)
		return left->asked.priority < right->asked.priority ? -1 : 1;
	return left->order > right->order ? -1 : 1; /* the earlier one last: it is served first */
}

static void wait_for_server(struct bring *bring, struct want *want)
{
	want->state = WANT_WAITING;
	bring->plan_changed = true;
	if (link_is_down(bring->options.link))
		report(bring, want, MISSING_OFFLINE);
}

static void ask_cache(struct bring *bring, struct want *want)
{
	int rc = cache_get(bring->options.cache, want->entry.key, want->asked.priority,
			   &bring->scratch);

	want->state = WANT_WAITING;
	if (rc == 0) {
		bring->figures.from_cache++;
		pass_on(bring, want, buffer_bytes(&bring->scratch));
		return;
	}
	if (bring_ask_stick(bring, want))
		want->state = WANT_ON_STICK;
	else
		wait_for_server(bring, want);
}

/* ---- the stick */

static void note_damage_on_stick(struct bring *bring, struct hash hash)
{
	char hex[HASH_HEX_BYTES];

	hash_to_hex(hash, hex);
	refusal_note(bring->options.link->refusal, hex,
		     "the stick's bytes of this object are damaged");
	if (bring->figures.stick_damaged++ == 0) /* of thousands, perhaps */
		log_warn("net", "the stick's bytes of object %s are damaged", hex);
}

void bring_stick_answered(struct bring *bring, struct hash hash, int rc, struct bytes bytes)
{
	struct want *want = by_hash_find(&bring->wants, hash);

	if (rc == -EBADMSG)
		note_damage_on_stick(bring, hash);
	if (!want || want->state != WANT_ON_STICK)
		return;
	if (rc < 0) {
		wait_for_server(bring, want);
		return;
	}
	bring->figures.from_stick++;
	if (cache_put(bring->options.cache, hash, bytes, want->asked.priority) < 0)
		log_debug("net", "an object did not get into the cache");
	pass_on(bring, want, bytes);
}

bool bring_wants_of_stick(const struct bring *bring, struct hash hash)
{
	const struct want *want = by_hash_find(&bring->wants, hash);

	return want && want->state == WANT_ON_STICK;
}

void bring_ask_again(struct bring *bring)
{
	struct want *want;
	size_t at = 0;

	while ((want = by_hash_next(&bring->wants, &at)))
		if (want->state == WANT_WAITING && add_fresh(bring, want) < 0)
			return; /* the server may have it */
}

static void work_fresh(struct bring *bring)
{
	const struct bring_events *events = &bring->options.events;

	if (bring->fresh_changed && bring->fresh_count > 1)
		qsort(bring->fresh, bring->fresh_count, sizeof(bring->fresh[0]), by_priority);
	bring->fresh_changed = false;
	for (int i = 0; i < CACHE_READS_MOST && bring->fresh_count > 0 &&
			events->has_room(bring->options.data);
	     i++) {
		struct want *want = bring->fresh[--bring->fresh_count];

		if (want->dropped)
			free(want);
		else
			ask_cache(bring, want);
	}
}

/* ---- the server */

/* What the rate limit allows now; half a second of it is saved up at most. */
static void refill_allowance(struct bring *bring)
{
	int64_t rate = (int64_t)bring->options.rate_limit;
	int64_t now_ms = clock_now_ms(), most = rate / 2;

	bring->allowance_bytes += (now_ms - bring->allowance_ms) * rate / 1000;
	if (bring->allowance_bytes > most)
		bring->allowance_bytes = most;
	bring->allowance_ms = now_ms;
}

static bool is_overdrawn(const struct bring *bring)
{
	return bring->options.rate_limit > 0 && bring->allowance_bytes <= 0;
}

/* When what is for later may be asked for again. */
static int64_t allowance_due_ms(const struct bring *bring)
{
	if (!is_overdrawn(bring))
		return 0;
	return bring->allowance_ms + 1 +
	       -bring->allowance_bytes * 1000 / (int64_t)bring->options.rate_limit;
}

static bool reserve_items(struct bring *bring)
{
	size_t needed = bring->wants.count;
	struct range_item *larger;

	if (needed <= bring->item_capacity)
		return true;
	needed += needed / 2;
	larger = realloc(bring->items, needed * sizeof(*larger));
	if (!larger)
		return false;
	bring->items = larger;
	bring->item_capacity = needed;
	return true;
}

/* All wants that could be asked for now, sorted by place. */
static size_t gather(struct bring *bring)
{
	int64_t now_ms = clock_now_ms();
	struct want *want;
	size_t at = 0, count = 0;

	bring->plan_due_ms = INT64_MAX;
	bring->later_waits = false;
	if (!reserve_items(bring))
		return 0;
	while ((want = by_hash_next(&bring->wants, &at))) {
		struct range_item *item = &bring->items[count];
		int rc;

		if (want->state != WANT_WAITING)
			continue;
		if (is_overdrawn(bring) && is_for_later(want->asked.priority)) {
			bring->later_waits = true;
			continue;
		}
		rc = want->retry_at_ms > now_ms ? -EBUSY : bring_locate(bring, want, item);
		if (rc == -ENOENT)
			bring_failed(bring, want, rc);
		if (want->retry_at_ms > now_ms && want->retry_at_ms < bring->plan_due_ms)
			bring->plan_due_ms = want->retry_at_ms;
		if (rc < 0)
			continue;
		item->priority = want->asked.priority;
		item->order = want->order;
		item->want = want;
		count++;
	}
	range_sort(bring->items, count);
	return count;
}

static uint32_t ranges_most(const struct bring *bring)
{
	return bring->flying_bytes < SMALL_BYTES ? SMALL_RANGES_MOST : RANGES_MOST;
}

static bool may_ask_for(const struct bring *bring, uint32_t priority)
{
	uint32_t most = ranges_most(bring);

	if (priority >= MESSAGE_PRIORITY_INDEX)
		most += RANGES_FOR_PAGES;
	return bring->range_count < most && link_may_ask(bring->options.link);
}

/* Of those that no range has taken; 0 where all are. */
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

/* Of a range whose best one has this priority. */
static struct range_limits limits_now(const struct bring *bring, uint32_t priority)
{
	uint64_t rate = is_for_later(priority) ? bring->options.rate_limit : 0;
	uint64_t most = bring->bytes_per_s;

	most = (rate > 0 && rate < most ? rate : most) * RANGE_MS / 1000;
	if (most < RANGE_BYTES_LEAST)
		most = RANGE_BYTES_LEAST;
	if (most > RANGE_BYTES_MOST)
		most = RANGE_BYTES_MOST;
	return (struct range_limits){ .gap_bytes = GAP_BYTES, .most_bytes = (uint32_t)most };
}

static void work_ranges(struct bring *bring)
{
	size_t count, first, taken;
	uint32_t best;

	if (bring->options.rate_limit)
		refill_allowance(bring);
	if (bring->later_waits && !is_overdrawn(bring))
		bring->plan_changed = true;
	if (!bring->plan_changed || bring->range_count >= ranges_most(bring) + RANGES_FOR_PAGES ||
	    !link_may_ask(bring->options.link) ||
	    !bring->options.events.has_room(bring->options.data))
		return;
	count = gather(bring);
	bring->plan_changed = false;
	/* The best one decides whether there is a place for its range. */
	while (best = best_priority(bring->items, count),
	       (taken = range_plan(bring->items, count, limits_now(bring, best), &first)) > 0) {
		if (is_for_later(best) && is_overdrawn(bring)) {
			bring->later_waits = true;
			return;
		}
		if (!may_ask_for(bring, best)) {
			bring->plan_changed = true;
			return;
		}
		if (bring_ask_range(bring, &bring->items[first], taken) > 0)
			bring->allowance_bytes -= later_bytes(&bring->items[first], taken);
	}
}

/* The line is down: who waits is told, once. */
static void tell_of_the_line(struct bring *bring)
{
	bool is_down = link_is_down(bring->options.link);
	struct want *want;
	size_t at = 0;

	if (is_down == bring->was_down)
		return;
	bring->was_down = is_down;
	bring->plan_changed = true;
	while ((want = by_hash_next(&bring->wants, &at))) {
		if (want->state == WANT_FRESH || want->state == WANT_ON_STICK)
			continue;
		if (is_down)
			report(bring, want, MISSING_OFFLINE);
		else if (want->reported == MISSING_OFFLINE)
			want->reported = -1;
	}
}

void bring_work(struct bring *bring)
{
	work_fresh(bring);
	bring_work_releases(bring);
	tell_of_the_line(bring);
	if (bring->plan_due_ms <= clock_now_ms())
		bring->plan_changed = true; /* a want's pause is over */
	work_ranges(bring);
	bring_ask_suspects(bring); /* last: planning, too, finds objects without a place */
}

/* When what is due may go out, the line considered: an answer wakes us anyhow. */
static int64_t line_due_ms(const struct link *link, int64_t due_ms)
{
	if (link->failures == 0 || due_ms == INT64_MAX)
		return due_ms;
	if (link->in_flight > 0)
		return INT64_MAX;
	return due_ms > link->retry_at_ms ? due_ms : link->retry_at_ms;
}

int64_t bring_due_ms(const struct bring *bring)
{
	const struct link *link = bring->options.link;
	int64_t due_ms = bring_releases_due_ms(bring);

	if (!bring->options.events.has_room(bring->options.data))
		return line_due_ms(link, due_ms); /* the kiosk will wake us */
	if (bring->fresh_count > 0)
		return 0;
	if (bring->range_count < ranges_most(bring)) {
		int64_t plan_ms = bring->plan_changed ? 0 : bring->plan_due_ms;

		if (bring->later_waits && allowance_due_ms(bring) < plan_ms)
			plan_ms = allowance_due_ms(bring);
		due_ms = plan_ms < due_ms ? plan_ms : due_ms;
	}
	return line_due_ms(link, due_ms);
}

uint32_t bring_wanted(const struct bring *bring)
{
	return (uint32_t)bring->wants.count;
}

void bring_figures(const struct bring *bring, struct bring_figures *out)
{
	*out = bring->figures;
}
