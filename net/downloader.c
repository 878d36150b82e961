/* Decides where each wanted object comes from: cache, USB stick, or server. It also plans the range
 * requests under the limits for number, size and rate. */
#include "net/downloader.h"

#include <errno.h>
#include <stdlib.h>

#include "base/clock.h"
#include "base/log.h"
#include "format/page.h"
#include "net/downloader_private.h"

enum {
	WANTS_MAX = 1 << 18,
	RANGES_MAX = 8,
	/* while all requests together are small, so that latency does not dominate */
	SMALL_RANGES_MAX = 32,
	SMALL_BYTES = 256 << 10,
	/* extra requests for index pages: without pages nothing else can be planned */
	RANGES_FOR_PAGES = 2,
	/* bytes to read and discard rather than send a new request (its cost, and a little more) */
	GAP_BYTES = 512,
	RANGE_BYTES_MIN = 64 << 10,
	RANGE_BYTES_MAX = 1 << 20,
	/* a range should take about this long, so that more urgent requests do not wait longer */
	RANGE_MS = 250,
	/* assumed bandwidth before the first measurement */
	BYTES_PER_S_FIRST = 1 << 20,
	CACHE_READS_MAX = 64, /* per call: other sources share the loop */
};

/* ---- create, destroy */

int downloader_create(struct downloader **out, const struct downloader_options *options)
{
	struct downloader *downloader = calloc(1, sizeof(*downloader));

	*out = downloader;
	if (!downloader)
		return -ENOMEM;
	downloader->options = *options;
	downloader->bytes_per_s = BYTES_PER_S_FIRST;
	downloader->plan_due_ms = INT64_MAX;
	buffer_init(&downloader->scratch, OBJECT_BYTES_MAX);
	return 0;
}

void downloader_destroy(struct downloader *downloader)
{
	if (!downloader)
		return;
	downloader_forget_all(downloader);
	by_hash_finish(&downloader->wants);
	buffer_finish(&downloader->scratch);
	free(downloader->fresh);
	free(downloader->items);
	free(downloader);
}

/* ---- adding and dropping wants */

static int add_fresh(struct downloader *downloader, struct want *want)
{
	if (downloader->fresh_count == downloader->fresh_capacity) {
		size_t capacity = downloader->fresh_capacity ? downloader->fresh_capacity * 2 : 256;
		struct want **larger = realloc(downloader->fresh, capacity * sizeof(*larger));

		if (!larger)
			return -ENOMEM;
		downloader->fresh = larger;
		downloader->fresh_capacity = capacity;
	}
	want->state = WANT_FRESH;
	downloader->fresh[downloader->fresh_count++] = want;
	downloader->fresh_changed = true;
	return 0;
}

/* Reports a missing object, but only when the reason changes. */
static void report(struct downloader *downloader, struct want *want, enum missing_reason reason)
{
	if (want->reported == (int)reason)
		return;
	want->reported = (int)reason;
	downloader->options.events.missing(downloader->options.data, want->entry.key, reason);
}

/* True for objects of a release that is not shown yet. The rate limit applies to these, because no
 * visitor waits for them. */
static bool is_for_later(uint32_t priority)
{
	return priority < MESSAGE_PRIORITY_PICTURE;
}

void downloader_want(struct downloader *downloader, const struct message_want *asked)
{
	struct want *want = by_hash_find(&downloader->wants, asked->hash);

	if (want) {
		if (is_for_later(want->asked.priority) && !is_for_later(asked->priority))
			downloader->plan_changed = true; /* no longer rate-limited */
		want->asked.priority = asked->priority;
		downloader->fresh_changed = true;
		return;
	}
	want = calloc(1, sizeof(*want));
	if (want && downloader->wants.count < WANTS_MAX) {
		want->entry.key = asked->hash;
		want->asked = *asked;
		want->order = downloader->orders++;
		want->reported = -1;
		if (add_fresh(downloader, want) == 0) {
			if (by_hash_add(&downloader->wants, &want->entry) == 0)
				return;
			downloader->fresh_count--;
		}
	}
	free(want);
	downloader->options.events.missing(downloader->options.data, asked->hash, MISSING_OFFLINE);
}

/* Removes the want from the map. Frees it unless it is still in the fresh list. */
static void forget(struct downloader *downloader, struct want *want)
{
	by_hash_remove(&downloader->wants, want->entry.key);
	if (want->state == WANT_FRESH)
		want->dropped = true;
	else
		free(want);
}

void downloader_drop(struct downloader *downloader, struct hash hash)
{
	struct want *want = by_hash_find(&downloader->wants, hash);

	if (!want)
		return;
	downloader_leave_range(downloader, want);
	forget(downloader, want);
}

void downloader_keep(struct downloader *downloader, struct hash hash)
{
	int rc = cache_keep(downloader->options.cache, hash);

	if (rc == -ENOSPC)
		log_debug("net", "the cache keeps as much as it may");
}

void downloader_forget_all(struct downloader *downloader)
{
	struct want *want;
	size_t at = 0;

	downloader_cancel_ranges(downloader);
	while ((want = by_hash_next(&downloader->wants, &at)))
		if (want->state != WANT_FRESH)
			free(want);
	for (size_t i = 0; i < downloader->fresh_count; i++)
		free(downloader->fresh[i]);
	downloader->fresh_count = 0;
	by_hash_finish(&downloader->wants);
	downloader_forget_releases(downloader);
}

/* ---- objects that arrive */

static void pass_on(struct downloader *downloader, struct want *want, struct bytes bytes)
{
	struct hash hash = want->entry.key;

	want->state = WANT_WAITING; /* no longer in the fresh list, so forget() frees it */
	forget(downloader, want);
	downloader->options.events.object(downloader->options.data, hash, bytes);
}

/* Handles wrong bytes. The first time the object is requested again at once (a bit may have flipped
 * in transit); the second time the damage is reported. */
static void note_damage(struct downloader *downloader, struct want *want)
{
	char hex[HASH_HEX_BYTES];

	downloader->metrics.damaged++;
	want->state = WANT_WAITING;
	want->damages++;
	want->failures++;
	want->retry_at_ms = clock_now_ms();
	downloader->plan_changed = true;
	if (want->damages < 2)
		return;
	hash_to_hex(want->entry.key, hex);
	if (want->reported != MISSING_DAMAGED) {
		log_warn("net", "content bug: the server's bytes of object %s are damaged", hex);
		refusal_note(downloader->options.link->refusal, hex,
			     "the server's bytes of this object are damaged");
	}
	want->retry_at_ms += link_pause_ms(want->failures);
	report(downloader, want, MISSING_DAMAGED);
	downloader_suspect_locators(downloader);
}

void downloader_arrived(struct downloader *downloader, struct want *want, struct bytes bytes)
{
	int rc;

	if (!hash_equal(hash_of(bytes), want->entry.key)) {
		note_damage(downloader, want);
		return;
	}
	downloader->metrics.from_server++;
	rc = cache_put(downloader->options.cache, want->entry.key, bytes, want->asked.priority);
	if (rc < 0)
		log_debug("net", "an object did not get into the cache (%d)", rc);
	pass_on(downloader, want, bytes);
}

void downloader_failed(struct downloader *downloader, struct want *want, int rc)
{
	want->state = WANT_WAITING;
	want->retry_at_ms = 0; /* the pause of the link is enough */
	downloader->plan_changed = true;
	if (rc == -EHOSTUNREACH)
		return;
	want->failures++;
	want->retry_at_ms = clock_now_ms() + link_pause_ms(want->failures);
	report(downloader, want, rc == -EBADMSG ? MISSING_DAMAGED : MISSING_NOT_FOUND);
	downloader_suspect_locators(downloader);
}

/* ---- the cache */

static int by_priority(const void *a, const void *b)
{
	const struct want *left = *(struct want *const *)a, *right = *(struct want *const *)b;

	if (left->asked.priority != right->asked.priority)
		return left->asked.priority < right->asked.priority ? -1 : 1;
	/* the earlier one comes last, because the list is served from its end */
	return left->order > right->order ? -1 : 1;
}

static void wait_for_server(struct downloader *downloader, struct want *want)
{
	want->state = WANT_WAITING;
	downloader->plan_changed = true;
	if (link_is_down(downloader->options.link))
		report(downloader, want, MISSING_OFFLINE);
}

static void ask_cache(struct downloader *downloader, struct want *want)
{
	int rc = cache_get(downloader->options.cache, want->entry.key, want->asked.priority,
			   &downloader->scratch);

	want->state = WANT_WAITING;
	if (rc == 0) {
		downloader->metrics.from_cache++;
		pass_on(downloader, want, buffer_bytes(&downloader->scratch));
		return;
	}
	if (downloader_ask_stick(downloader, want))
		want->state = WANT_ON_STICK;
	else
		wait_for_server(downloader, want);
}

/* ---- the stick */

static void note_damage_on_stick(struct downloader *downloader, struct hash hash)
{
	char hex[HASH_HEX_BYTES];

	hash_to_hex(hash, hex);
	refusal_note(downloader->options.link->refusal, hex,
		     "the stick's bytes of this object are damaged");
	/* logs only the first; there may be thousands */
	if (downloader->metrics.stick_damaged++ == 0)
		log_warn("net", "the stick's bytes of object %s are damaged", hex);
}

void downloader_stick_answered(struct downloader *downloader, struct hash hash, int rc,
			       struct bytes bytes)
{
	struct want *want = by_hash_find(&downloader->wants, hash);

	if (rc == -EBADMSG)
		note_damage_on_stick(downloader, hash);
	if (!want || want->state != WANT_ON_STICK)
		return;
	if (rc < 0) {
		wait_for_server(downloader, want);
		return;
	}
	downloader->metrics.from_stick++;
	if (cache_put(downloader->options.cache, hash, bytes, want->asked.priority) < 0)
		log_debug("net", "an object did not get into the cache");
	pass_on(downloader, want, bytes);
}

bool downloader_wants_of_stick(const struct downloader *downloader, struct hash hash)
{
	const struct want *want = by_hash_find(&downloader->wants, hash);

	return want && want->state == WANT_ON_STICK;
}

void downloader_ask_again(struct downloader *downloader)
{
	struct want *want;
	size_t at = 0;

	while ((want = by_hash_next(&downloader->wants, &at)))
		if (want->state == WANT_WAITING && add_fresh(downloader, want) < 0)
			return; /* stays waiting: the server may have it */
}

static void work_fresh(struct downloader *downloader)
{
	const struct downloader_events *events = &downloader->options.events;

	if (downloader->fresh_changed && downloader->fresh_count > 1)
		qsort(downloader->fresh, downloader->fresh_count, sizeof(downloader->fresh[0]),
		      by_priority);
	downloader->fresh_changed = false;
	for (int i = 0; i < CACHE_READS_MAX && downloader->fresh_count > 0 &&
			events->has_room(downloader->options.data);
	     i++) {
		struct want *want = downloader->fresh[--downloader->fresh_count];

		if (want->dropped)
			free(want);
		else
			ask_cache(downloader, want);
	}
}

/* ---- the server */

/* Adds what the rate limit allows since the last call. At most half a second's worth is saved
 * up. */
static void refill_allowance(struct downloader *downloader)
{
	int64_t rate = (int64_t)downloader->options.rate_limit;
	int64_t now_ms = clock_now_ms(), most = rate / 2;

	downloader->allowance_bytes += (now_ms - downloader->allowance_ms) * rate / 1000;
	if (downloader->allowance_bytes > most)
		downloader->allowance_bytes = most;
	downloader->allowance_ms = now_ms;
}

static bool is_overdrawn(const struct downloader *downloader)
{
	return downloader->options.rate_limit > 0 && downloader->allowance_bytes <= 0;
}

/* Returns when the rate limit allows requests for later releases again (clock_now_ms); 0: now. */
static int64_t allowance_due_ms(const struct downloader *downloader)
{
	if (!is_overdrawn(downloader))
		return 0;
	return downloader->allowance_ms + 1 +
	       -downloader->allowance_bytes * 1000 / (int64_t)downloader->options.rate_limit;
}

static bool reserve_items(struct downloader *downloader)
{
	size_t needed = downloader->wants.count;
	struct range_item *larger;

	if (needed <= downloader->item_capacity)
		return true;
	needed += needed / 2;
	larger = realloc(downloader->items, needed * sizeof(*larger));
	if (!larger)
		return false;
	downloader->items = larger;
	downloader->item_capacity = needed;
	return true;
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
	if (!reserve_items(downloader))
		return 0;
	while ((want = by_hash_next(&downloader->wants, &at))) {
		struct range_item *item = &downloader->items[count];
		int rc;

		if (want->state != WANT_WAITING)
			continue;
		if (is_overdrawn(downloader) && is_for_later(want->asked.priority)) {
			downloader->later_waits = true;
			continue;
		}
		rc = want->retry_at_ms > now_ms ? -EBUSY
						: downloader_locate(downloader, want, item);
		if (rc == -ENOENT)
			downloader_failed(downloader, want, rc);
		if (want->retry_at_ms > now_ms && want->retry_at_ms < downloader->plan_due_ms)
			downloader->plan_due_ms = want->retry_at_ms;
		if (rc < 0)
			continue;
		item->priority = want->asked.priority;
		item->order = want->order;
		item->want = want;
		count++;
	}
	range_sort(downloader->items, count);
	return count;
}

static uint32_t ranges_most(const struct downloader *downloader)
{
	return downloader->flying_bytes < SMALL_BYTES ? SMALL_RANGES_MAX : RANGES_MAX;
}

static bool may_ask_for(const struct downloader *downloader, uint32_t priority)
{
	uint32_t most = ranges_most(downloader);

	if (priority >= MESSAGE_PRIORITY_INDEX)
		most += RANGES_FOR_PAGES;
	return downloader->range_count < most && link_may_ask(downloader->options.link);
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

/* Limits for a range whose most urgent object has this priority. */
static struct range_limits limits_now(const struct downloader *downloader, uint32_t priority)
{
	uint64_t rate = is_for_later(priority) ? downloader->options.rate_limit : 0;
	uint64_t most = downloader->bytes_per_s;

	most = (rate > 0 && rate < most ? rate : most) * RANGE_MS / 1000;
	if (most < RANGE_BYTES_MIN)
		most = RANGE_BYTES_MIN;
	if (most > RANGE_BYTES_MAX)
		most = RANGE_BYTES_MAX;
	return (struct range_limits){ .gap_bytes = GAP_BYTES, .most_bytes = (uint32_t)most };
}

static void work_ranges(struct downloader *downloader)
{
	size_t count, first, taken;
	uint32_t best;

	if (downloader->options.rate_limit)
		refill_allowance(downloader);
	if (downloader->later_waits && !is_overdrawn(downloader))
		downloader->plan_changed = true;
	if (!downloader->plan_changed ||
	    downloader->range_count >= ranges_most(downloader) + RANGES_FOR_PAGES ||
	    !link_may_ask(downloader->options.link) ||
	    !downloader->options.events.has_room(downloader->options.data))
		return;
	count = gather(downloader);
	downloader->plan_changed = false;
	/* The most urgent item decides whether another range may be requested. */
	while (best = best_priority(downloader->items, count),
	       (taken = range_plan(downloader->items, count, limits_now(downloader, best),
				   &first)) > 0) {
		if (is_for_later(best) && is_overdrawn(downloader)) {
			downloader->later_waits = true;
			return;
		}
		if (!may_ask_for(downloader, best)) {
			downloader->plan_changed = true;
			return;
		}
		if (downloader_ask_range(downloader, &downloader->items[first], taken) > 0)
			downloader->allowance_bytes -=
				later_bytes(&downloader->items[first], taken);
	}
}

/* When the link goes down, reports MISSING_OFFLINE once to every waiting want. When it comes back,
 * clears these reports. */
static void tell_of_the_line(struct downloader *downloader)
{
	bool is_down = link_is_down(downloader->options.link);
	struct want *want;
	size_t at = 0;

	if (is_down == downloader->was_down)
		return;
	downloader->was_down = is_down;
	downloader->plan_changed = true;
	while ((want = by_hash_next(&downloader->wants, &at))) {
		if (want->state == WANT_FRESH || want->state == WANT_ON_STICK)
			continue;
		if (is_down)
			report(downloader, want, MISSING_OFFLINE);
		else if (want->reported == MISSING_OFFLINE)
			want->reported = -1;
	}
}

void downloader_work(struct downloader *downloader)
{
	work_fresh(downloader);
	downloader_work_releases(downloader);
	tell_of_the_line(downloader);
	if (downloader->plan_due_ms <= clock_now_ms())
		downloader->plan_changed = true; /* the retry pause of a want is over */
	work_ranges(downloader);
	/* Last, because planning may also find objects without a place. */
	downloader_ask_suspects(downloader);
}

/* Adjusts due_ms to the state of the link. While a request is in flight after a failure, its answer
 * wakes the loop, so no timer is needed. */
static int64_t line_due_ms(const struct link *link, int64_t due_ms)
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
	int64_t due_ms = downloader_releases_due_ms(downloader);

	if (!downloader->options.events.has_room(downloader->options.data))
		return line_due_ms(link, due_ms); /* the loop wakes up when the kiosk reads */
	if (downloader->fresh_count > 0)
		return 0;
	if (downloader->range_count < ranges_most(downloader)) {
		int64_t plan_ms = downloader->plan_changed ? 0 : downloader->plan_due_ms;

		if (downloader->later_waits && allowance_due_ms(downloader) < plan_ms)
			plan_ms = allowance_due_ms(downloader);
		due_ms = plan_ms < due_ms ? plan_ms : due_ms;
	}
	return line_due_ms(link, due_ms);
}

uint32_t downloader_wanted(const struct downloader *downloader)
{
	return (uint32_t)downloader->wants.count;
}

void downloader_figures(const struct downloader *downloader, struct downloader_figures *out)
{
	*out = downloader->metrics;
}
