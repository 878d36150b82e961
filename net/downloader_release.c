/* Manages the locators of the releases in use: reads them from the cache, downloads them from the
 * server, and looks up the place of an object in them. */
#include <errno.h>
#include <stdio.h>
#include <stdlib.h>

#include "base/clock.h"
#include "base/log.h"
#include "net/downloader_private.h"

enum {
	LOCATOR_BYTES_MAX = 64 << 20,
	SUSPECT_MS = 60000, /* a locator is downloaded again at most this often */
};

static void release_destroy(struct downloader_release *release)
{
	if (!release)
		return;
	if (release->request) {
		http_cancel(release->request);
		release->downloader->options.link->in_flight--;
	}
	locator_finish(&release->locator);
	buffer_finish(&release->file);
	free(release);
}

void downloader_forget_releases(struct downloader *downloader)
{
	for (size_t i = 0; i < MESSAGE_RELEASES_MAX; i++) {
		release_destroy(downloader->releases[i]);
		downloader->releases[i] = NULL;
	}
}

static int take_locator(struct downloader_release *release, struct bytes file)
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
	release->downloader->plan_changed = true;
	return 0;
}

/* ---- from the server */

static bool on_piece(void *data, struct bytes piece)
{
	struct downloader_release *release = data;

	buffer_put(&release->file, piece.data, piece.size);
	return !release->file.error;
}

static void note_failure(struct downloader_release *release, int rc, const char *why)
{
	char hex[HASH_HEX_BYTES];

	hash_to_hex(release->root, hex);
	release->failures++;
	release->retry_at_ms = clock_now_ms() + link_pause_ms(release->failures);
	if (rc == -EHOSTUNREACH)
		return;
	release->missing = !release->has_locator;
	release->downloader->plan_changed = true;
	if (release->failures > 1)
		return;
	log_warn("net", "content bug: locator/%s: %s", hex, why);
	refusal_note(release->downloader->options.link->refusal, hex, why);
}

static void on_done(void *data, const struct http_result *result)
{
	struct downloader_release *release = data;
	struct downloader *downloader = release->downloader;
	int rc = result->rc ? result->rc : release->file.error;

	release->request = NULL;
	downloader->options.link->in_flight--;
	if (rc == -EHOSTUNREACH)
		link_failed(downloader->options.link, http_url(downloader->options.http),
			    result->why);
	else
		link_answered(downloader->options.link);
	if (rc == 0)
		rc = take_locator(release, buffer_bytes(&release->file));
	if (rc < 0) {
		note_failure(release, rc, rc == -EBADMSG ? "damaged" : result->why);
	} else {
		release->from_server = true;
		release->retry_at_ms = clock_now_ms() + SUSPECT_MS;
		if (cache_put_file(downloader->options.cache, release->root,
				   buffer_bytes(&release->file)) < 0)
			log_debug("net", "the locator is not in the cache");
	}
	buffer_finish(&release->file);
}

static void ask_server(struct downloader_release *release)
{
	char path[64], hex[HASH_HEX_BYTES];
	struct http_ask ask = { .path = path,
				.ceiling = LOCATOR_BYTES_MAX,
				.receive = on_piece,
				.done = on_done,
				.data = release };

	hash_to_hex(release->root, hex);
	snprintf(path, sizeof(path), "locator/%s", hex);
	buffer_init(&release->file, LOCATOR_BYTES_MAX);
	if (http_ask(release->downloader->options.http, &ask, &release->request) < 0)
		release->retry_at_ms = clock_now_ms() + 1000;
	else
		release->downloader->options.link->in_flight++;
}

/* ---- from the cache */

static void ask_cache(struct downloader_release *release)
{
	struct buffer file;
	int rc;

	release->asked_cache = true;
	buffer_init(&file, LOCATOR_BYTES_MAX);
	rc = cache_get_file(release->downloader->options.cache, release->root, &file);
	if (rc == 0)
		rc = take_locator(release, buffer_bytes(&file));
	if (rc < 0 && rc != -ENOENT)
		log_warn("net", "the locator in the cache is of no use: asking for it anew");
	buffer_finish(&file);
}

/* ---- called by downloader.c */

void downloader_use_release(struct downloader *downloader, struct hash root, uint32_t root_bytes,
			    bool also)
{
	struct downloader_release *release = NULL;

	if (!also)
		downloader_forget_all(downloader);
	for (size_t i = 0; i < MESSAGE_RELEASES_MAX; i++)
		if (downloader->releases[i] && hash_equal(downloader->releases[i]->root, root))
			return;
	release = calloc(1, sizeof(*release));
	if (!release)
		return; /* the wants of this release are reported missing */
	release->root = root;
	release->root_bytes = root_bytes;
	release->downloader = downloader;
	release_destroy(downloader->releases[MESSAGE_RELEASES_MAX - 1]);
	for (size_t i = MESSAGE_RELEASES_MAX - 1; i > 0; i--)
		downloader->releases[i] = downloader->releases[i - 1];
	downloader->releases[0] = release;
	if (!also && cache_use_release(downloader->options.cache, root) < 0)
		log_warn("net", "the cache cannot note which release is in use");
	downloader->plan_changed = true;
}

static bool needs_server(const struct downloader_release *release)
{
	return !release->has_locator && release->asked_cache && !release->request;
}

void downloader_work_releases(struct downloader *downloader)
{
	for (size_t i = 0; i < MESSAGE_RELEASES_MAX; i++) {
		struct downloader_release *release = downloader->releases[i];

		if (!release)
			continue;
		if (!release->asked_cache)
			ask_cache(release);
		if (needs_server(release) && clock_now_ms() >= release->retry_at_ms &&
		    link_may_ask(downloader->options.link))
			ask_server(release);
	}
}

int64_t downloader_releases_due_ms(const struct downloader *downloader)
{
	int64_t due_ms = INT64_MAX;

	for (size_t i = 0; i < MESSAGE_RELEASES_MAX; i++) {
		const struct downloader_release *release = downloader->releases[i];

		if (!release)
			continue;
		if (!release->asked_cache)
			return 0;
		if (needs_server(release) && release->retry_at_ms < due_ms)
			due_ms = release->retry_at_ms;
	}
	return due_ms;
}

void downloader_suspect_locators(struct downloader *downloader)
{
	downloader->suspicious = true;
}

void downloader_ask_suspects(struct downloader *downloader)
{
	if (!downloader->suspicious)
		return;
	downloader->suspicious = false;
	for (size_t i = 0; i < MESSAGE_RELEASES_MAX; i++) {
		struct downloader_release *release = downloader->releases[i];

		if (!release || !release->has_locator || release->request ||
		    clock_now_ms() < release->retry_at_ms ||
		    !link_may_ask(downloader->options.link))
			continue;
		release->retry_at_ms = clock_now_ms() + SUSPECT_MS;
		ask_server(release); /* the old locator is used until the new one has arrived */
	}
}

/* Writes the object's place in this release to *out. Returns false if the release does not contain
 * it. */
static bool locate_in(const struct downloader_release *release, const struct want *want,
		      struct range_item *out)
{
	const struct locator_block *block = locator_find(&release->locator, want->asked.page);

	if (!block || (uint64_t)want->asked.offset + want->asked.size > block->size)
		return false;
	/* The root page belongs to no page. It must be the root of this release. */
	if (hash_is_zero(want->asked.page) && !hash_equal(want->entry.key, release->root))
		return false;
	out->pack = release->locator.packs[block->pack];
	out->place = (uint64_t)block->offset + want->asked.offset;
	out->size = want->asked.size;
	return true;
}

bool downloader_ask_stick(struct downloader *downloader, const struct want *want)
{
	struct hash roots[MESSAGE_RELEASES_MAX];
	size_t count = 0;

	for (size_t i = 0; i < MESSAGE_RELEASES_MAX; i++)
		if (downloader->releases[i])
			roots[count++] = downloader->releases[i]->root;
	return count > 0 && stick_ask(downloader->options.stick, roots, count, &want->asked);
}

int downloader_locate(struct downloader *downloader, const struct want *want,
		      struct range_item *out)
{
	struct range_item found[MESSAGE_RELEASES_MAX];
	size_t count = 0;
	bool to_come = false;

	for (size_t i = 0; i < MESSAGE_RELEASES_MAX; i++) {
		const struct downloader_release *release = downloader->releases[i];

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
