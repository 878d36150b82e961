#include <errno.h>
#include <stdio.h>
#include <stdlib.h>

#include "base/clock.h"
#include "base/log.h"
#include "net/downloader_private.h"

enum {
	LOCATOR_BYTES_MOST = 64 << 20,
	SUSPECT_MS = 60000, /* a locator is not got anew more often */
};

static void release_destroy(struct bring_release *release)
{
	if (!release)
		return;
	if (release->request) {
		http_cancel(release->request);
		release->bring->options.link->in_flight--;
	}
	locator_finish(&release->locator);
	buffer_finish(&release->file);
	free(release);
}

void bring_forget_releases(struct bring *bring)
{
	for (size_t i = 0; i < MESSAGE_RELEASES_MOST; i++) {
		release_destroy(bring->releases[i]);
		bring->releases[i] = NULL;
	}
}

static int take_locator(struct bring_release *release, struct bytes file)
{
	struct locator locator;
	int rc = locator_decode(&locator, file);

	if (rc < 0)
		return rc;
	locator_finish(&release->locator);
	release->locator = locator;
	release->has_locator = true;
	release->missing = false;
	release->failures = 0;
	release->bring->plan_changed = true;
	return 0;
}

/* ---- from the server */

static bool on_piece(void *data, struct bytes piece)
{
	struct bring_release *release = data;

	buffer_put(&release->file, piece.data, piece.size);
	return !release->file.error;
}

static void note_failure(struct bring_release *release, int rc, const char *why)
{
	char hex[HASH_HEX_BYTES];

	hash_to_hex(release->root, hex);
	release->failures++;
	release->retry_at_ms = clock_now_ms() + link_pause_ms(release->failures);
	if (rc == -EHOSTUNREACH)
		return;
	release->missing = !release->has_locator;
	release->bring->plan_changed = true;
	if (release->failures > 1)
		return;
	log_warn("net", "content bug: locator/%s: %s", hex, why);
	refusal_note(release->bring->options.link->refusal, hex, why);
}

static void on_done(void *data, const struct http_result *result)
{
	struct bring_release *release = data;
	struct bring *bring = release->bring;
	int rc = result->rc ? result->rc : release->file.error;

	release->request = NULL;
	bring->options.link->in_flight--;
	if (rc == -EHOSTUNREACH)
		link_failed(bring->options.link, http_url(bring->options.http), result->why);
	else
		link_answered(bring->options.link);
	if (rc == 0)
		rc = take_locator(release, buffer_bytes(&release->file));
	if (rc < 0) {
		note_failure(release, rc, rc == -EBADMSG ? "damaged" : result->why);
	} else {
		release->from_server = true;
		release->retry_at_ms = clock_now_ms() + SUSPECT_MS;
		if (cache_put_file(bring->options.cache, release->root,
				   buffer_bytes(&release->file)) < 0)
			log_debug("net", "the locator is not in the cache");
	}
	buffer_finish(&release->file);
}

static void ask_server(struct bring_release *release)
{
	char path[64], hex[HASH_HEX_BYTES];
	struct http_ask ask = { .path = path,
				.ceiling = LOCATOR_BYTES_MOST,
				.receive = on_piece,
				.done = on_done,
				.data = release };

	hash_to_hex(release->root, hex);
	snprintf(path, sizeof(path), "locator/%s", hex);
	buffer_init(&release->file, LOCATOR_BYTES_MOST);
	if (http_ask(release->bring->options.http, &ask, &release->request) < 0)
		release->retry_at_ms = clock_now_ms() + 1000;
	else
		release->bring->options.link->in_flight++;
}

/* ---- from the cache */

static void ask_cache(struct bring_release *release)
{
	struct buffer file;
	int rc;

	release->asked_cache = true;
	buffer_init(&file, LOCATOR_BYTES_MOST);
	rc = cache_get_file(release->bring->options.cache, release->root, &file);
	if (rc == 0)
		rc = take_locator(release, buffer_bytes(&file));
	if (rc < 0 && rc != -ENOENT)
		log_warn("net", "the locator in the cache is of no use: asking for it anew");
	buffer_finish(&file);
}

/* ---- what bring.c asks */

void bring_use_release(struct bring *bring, struct hash root, uint32_t root_bytes, bool also)
{
	struct bring_release *release = NULL;

	if (!also)
		bring_forget_all(bring);
	for (size_t i = 0; i < MESSAGE_RELEASES_MOST; i++)
		if (bring->releases[i] && hash_equal(bring->releases[i]->root, root))
			return;
	release = calloc(1, sizeof(*release));
	if (!release)
		return; /* its wants are reported missing */
	release->root = root;
	release->root_bytes = root_bytes;
	release->bring = bring;
	release_destroy(bring->releases[MESSAGE_RELEASES_MOST - 1]);
	for (size_t i = MESSAGE_RELEASES_MOST - 1; i > 0; i--)
		bring->releases[i] = bring->releases[i - 1];
	bring->releases[0] = release;
	if (!also && cache_use_release(bring->options.cache, root) < 0)
		log_warn("net", "the cache cannot note which release is in use");
	bring->plan_changed = true;
}

static bool needs_server(const struct bring_release *release)
{
	return !release->has_locator && release->asked_cache && !release->request;
}

void bring_work_releases(struct bring *bring)
{
	for (size_t i = 0; i < MESSAGE_RELEASES_MOST; i++) {
		struct bring_release *release = bring->releases[i];

		if (!release)
			continue;
		if (!release->asked_cache)
			ask_cache(release);
		if (needs_server(release) && clock_now_ms() >= release->retry_at_ms &&
		    link_may_ask(bring->options.link))
			ask_server(release);
	}
}

int64_t bring_releases_due_ms(const struct bring *bring)
{
	int64_t due_ms = INT64_MAX;

	for (size_t i = 0; i < MESSAGE_RELEASES_MOST; i++) {
		const struct bring_release *release = bring->releases[i];

		if (!release)
			continue;
		if (!release->asked_cache)
			return 0;
		if (needs_server(release) && release->retry_at_ms < due_ms)
			due_ms = release->retry_at_ms;
	}
	return due_ms;
}

void bring_suspect_locators(struct bring *bring)
{
	bring->suspicious = true;
}

void bring_ask_suspects(struct bring *bring)
{
	if (!bring->suspicious)
		return;
	bring->suspicious = false;
	for (size_t i = 0; i < MESSAGE_RELEASES_MOST; i++) {
		struct bring_release *release = bring->releases[i];

		if (!release || !release->has_locator || release->request ||
		    clock_now_ms() < release->retry_at_ms || !link_may_ask(bring->options.link))
			continue;
		release->retry_at_ms = clock_now_ms() + SUSPECT_MS;
		ask_server(release); /* until it came the old one serves */
	}
}

/* Into *out where this release says; false: it does not. */
static bool locate_in(const struct bring_release *release, const struct want *want,
		      struct range_item *out)
{
	const struct locator_block *block = locator_find(&release->locator, want->asked.page);

	if (!block || (uint64_t)want->asked.offset + want->asked.size > block->size)
		return false;
	/* A root page is the block of no page, and must be this release's. */
	if (hash_is_zero(want->asked.page) && !hash_equal(want->entry.key, release->root))
		return false;
	out->pack = release->locator.packs[block->pack];
	out->place = (uint64_t)block->offset + want->asked.offset;
	out->size = want->asked.size;
	return true;
}

bool bring_ask_stick(struct bring *bring, const struct want *want)
{
	struct hash roots[MESSAGE_RELEASES_MOST];
	size_t count = 0;

	for (size_t i = 0; i < MESSAGE_RELEASES_MOST; i++)
		if (bring->releases[i])
			roots[count++] = bring->releases[i]->root;
	return count > 0 && stick_ask(bring->options.stick, roots, count, &want->asked);
}

int bring_locate(struct bring *bring, const struct want *want, struct range_item *out)
{
	struct range_item found[MESSAGE_RELEASES_MOST];
	size_t count = 0;
	bool to_come = false;

	for (size_t i = 0; i < MESSAGE_RELEASES_MOST; i++) {
		const struct bring_release *release = bring->releases[i];

		if (!release)
			continue;
		if (!release->has_locator)
			to_come = to_come || !release->missing;
		else if (locate_in(release, want, &found[count]))
			count++;
	}
	if (count == 0)
		return to_come ? -EAGAIN : -ENOENT;
	*out = (struct range_item){ .pack = found[want->failures % count].pack,
				    .place = found[want->failures % count].place,
				    .size = want->asked.size };
	return 0;
}
