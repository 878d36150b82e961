/* Reads locators from the cache, downloads them from the server, and looks up the place of an
 * object in them. */
#include "net/locators.h"

#include <errno.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "base/clock.h"
#include "base/log.h"
#include "format/locator.h"

enum {
	LOCATOR_BYTES_MAX = 64 << 20,
	SUSPECT_MS = 60000, /* a locator is downloaded again at most this often */
};

struct located_release {
	struct hash root;
	struct locator locator;
	bool has_locator;
	bool read_cache; /* the cache was asked for the locator */
	bool missing;    /* the server has no locator with this name (so far) */
	struct locators *locators;
	struct http_request *request; /* NULL: none in flight */
	struct buffer file;           /* received so far */
	uint32_t failures;
	int64_t retry_at_ms;
};

static void release_destroy(struct located_release *release)
{
	if (!release)
		return;
	if (release->request) {
		http_cancel(release->request);
		release->locators->options.link->in_flight--;
	}
	locator_finish(&release->locator);
	buffer_finish(&release->file);
	free(release);
}

void locators_init(struct locators *locators, const struct locators_options *options)
{
	*locators = (struct locators){ .options = *options };
}

void locators_clear(struct locators *locators)
{
	for (size_t i = 0; i < MESSAGE_RELEASES_MAX; i++) {
		release_destroy(locators->releases[i]);
		locators->releases[i] = NULL;
	}
}

static void report_change(const struct locators *locators)
{
	locators->options.changed(locators->options.data);
}

static int take_locator(struct located_release *release, struct bytes file)
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
	report_change(release->locators);
	return 0;
}

/* ---- from the server */

static bool on_piece(void *data, struct bytes piece)
{
	struct located_release *release = data;

	buffer_put(&release->file, piece.data, piece.size);
	return !release->file.error;
}

static void note_failure(struct located_release *release, int rc, const char *why)
{
	char hex[HASH_HEX_BYTES];

	hash_to_hex(release->root, hex);
	release->failures++;
	release->retry_at_ms = clock_now_ms() + link_pause_ms(release->failures);
	if (rc == -EHOSTUNREACH)
		return;
	release->missing = !release->has_locator;
	report_change(release->locators);
	if (release->failures > 1)
		return;
	log_warn("net", "%slocator/%s: %s", rc == -ENOMEM ? "" : "content bug: ", hex, why);
	metrics_refusal_note(release->locators->options.link->refusal, hex, why);
}

static void on_done(void *data, const struct http_result *result)
{
	struct located_release *release = data;
	const struct locators_options *options = &release->locators->options;
	int rc = result->rc ? result->rc : release->file.error;

	release->request = NULL;
	options->link->in_flight--;
	if (rc == -EHOSTUNREACH)
		link_failed(options->link, http_url(options->http), result->why);
	else
		link_answered(options->link);
	if (rc == 0)
		rc = take_locator(release, buffer_bytes(&release->file));
	if (rc < 0) {
		note_failure(release, rc,
			     rc == -EBADMSG     ? "damaged"
			     : rc == result->rc ? result->why
						: strerror(-rc));
	} else {
		release->retry_at_ms = clock_now_ms() + SUSPECT_MS;
		if (cache_put_file(options->cache, release->root, buffer_bytes(&release->file)) < 0)
			log_debug("net", "the locator is not in the cache");
	}
	buffer_finish(&release->file);
}

static void request_from_server(struct located_release *release)
{
	char path[64], hex[HASH_HEX_BYTES];
	struct http_get get = { .path = path,
				.ceiling = LOCATOR_BYTES_MAX,
				.receive = on_piece,
				.done = on_done,
				.data = release };

	hash_to_hex(release->root, hex);
	snprintf(path, sizeof(path), "locator/%s", hex);
	buffer_init(&release->file, LOCATOR_BYTES_MAX);
	if (http_get(release->locators->options.http, &get, &release->request) < 0)
		release->retry_at_ms = clock_now_ms() + 1000;
	else
		release->locators->options.link->in_flight++;
}

/* ---- from the cache */

static void read_from_cache(struct located_release *release)
{
	struct buffer file;
	int rc;

	release->read_cache = true;
	buffer_init(&file, LOCATOR_BYTES_MAX);
	rc = cache_get_file(release->locators->options.cache, release->root, &file);
	if (rc == 0)
		rc = take_locator(release, buffer_bytes(&file));
	if (rc < 0 && rc != -ENOENT)
		log_warn("net", "the locator in the cache is damaged and is downloaded again");
	buffer_finish(&file);
}

/* ---- the releases in use */

int locators_add(struct locators *locators, struct hash root)
{
	struct located_release **releases = locators->releases, *release;
	size_t room = MESSAGE_RELEASES_MAX - 1; /* the place that is taken */

	for (size_t i = 0; i < MESSAGE_RELEASES_MAX; i++)
		if (releases[i] && hash_equal(releases[i]->root, root))
			return 0;
	release = calloc(1, sizeof(*release));
	if (!release)
		return -ENOMEM;
	release->root = root;
	release->locators = locators;
	if (releases[room]) { /* the first one, which is on the panel, stays */
		room--;
		release_destroy(releases[room]);
	}
	for (size_t i = room; i > 0; i--)
		releases[i] = releases[i - 1];
	releases[0] = release;
	report_change(locators);
	return 0;
}

size_t locators_roots(const struct locators *locators, struct hash roots[MESSAGE_RELEASES_MAX])
{
	size_t count = 0;

	for (size_t i = 0; i < MESSAGE_RELEASES_MAX; i++)
		if (locators->releases[i])
			roots[count++] = locators->releases[i]->root;
	return count;
}

static bool needs_server(const struct located_release *release)
{
	return !release->has_locator && release->read_cache && !release->request;
}

void locators_work(struct locators *locators)
{
	for (size_t i = 0; i < MESSAGE_RELEASES_MAX; i++) {
		struct located_release *release = locators->releases[i];

		if (!release)
			continue;
		if (!release->read_cache)
			read_from_cache(release);
		if (needs_server(release) && clock_now_ms() >= release->retry_at_ms &&
		    link_may_request(locators->options.link))
			request_from_server(release);
	}
}

int64_t locators_due_ms(const struct locators *locators)
{
	int64_t due_ms = INT64_MAX;

	for (size_t i = 0; i < MESSAGE_RELEASES_MAX; i++) {
		const struct located_release *release = locators->releases[i];

		if (!release)
			continue;
		if (!release->read_cache)
			return 0;
		if (needs_server(release) && release->retry_at_ms < due_ms)
			due_ms = release->retry_at_ms;
	}
	return due_ms;
}

void locators_suspect(struct locators *locators)
{
	locators->suspected = true;
}

void locators_refresh_suspected(struct locators *locators)
{
	if (!locators->suspected)
		return;
	locators->suspected = false;
	for (size_t i = 0; i < MESSAGE_RELEASES_MAX; i++) {
		struct located_release *release = locators->releases[i];

		if (!release || !release->has_locator || release->request ||
		    clock_now_ms() < release->retry_at_ms ||
		    !link_may_request(locators->options.link))
			continue;
		release->retry_at_ms = clock_now_ms() + SUSPECT_MS;
		/* the old locator is used until the new one has arrived */
		request_from_server(release);
	}
}

/* ---- the place of an object */

/* Writes the object's place in this release to *out. Returns false if the release does not contain
 * it. */
static bool find_in(const struct located_release *release, const struct message_want *asked,
		    struct range_item *out)
{
	const struct locator_block *block = locator_find(&release->locator, asked->page);

	if (!block || (uint64_t)asked->offset + asked->size > block->size)
		return false;
	/* The root page belongs to no page. It must be the root of this release. */
	if (hash_is_zero(asked->page) && !hash_equal(asked->hash, release->root))
		return false;
	*out = (struct range_item){ .pack = release->locator.packs[block->pack],
				    .place = (uint64_t)block->offset + asked->offset,
				    .size = asked->size };
	return true;
}

int locators_find(const struct locators *locators, const struct message_want *asked,
		  uint32_t attempt, struct range_item *out)
{
	struct range_item found[MESSAGE_RELEASES_MAX];
	size_t count = 0;
	bool pending = false;

	for (size_t i = 0; i < MESSAGE_RELEASES_MAX; i++) {
		const struct located_release *release = locators->releases[i];

		if (!release)
			continue;
		if (!release->has_locator)
			pending = pending || !release->missing;
		else if (find_in(release, asked, &found[count]))
			count++;
	}
	if (count == 0)
		return pending ? -EAGAIN : -ENOENT;
	*out = found[attempt % count];
	return 0;
}
