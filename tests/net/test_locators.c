#include "net/locators.h"

#include <unistd.h>

#include "format/locator.h"
#include "tests/check.h"
#include "tests/net/fake_http.h"

static const struct hash first_root = { { 1 } }, second_root = { { 2 } };
static const struct hash shared_page = { { 9 } }, no_page = { { 0 } };

struct stage {
	char folder[64];
	struct cache *cache;
	struct link link;
	struct metrics_refusal refusal;
	struct locators locators;
	int changes;
};

static void on_change(void *data)
{
	((struct stage *)data)->changes++;
}

static void begin(struct stage *stage)
{
	struct locators_options options = {
		.cache = stage->cache, .link = &stage->link, .changed = on_change, .data = stage
	};

	locators_init(&stage->locators, &options);
}

static int set_up(void **state)
{
	struct stage *stage = calloc(1, sizeof(*stage));
	struct cache_options cache = { .budget_bytes = 8 << 20 };
	char path[96];

	*state = stage;
	memset(&server, 0, sizeof(server));
	server.now_ms = 1000;
	snprintf(stage->folder, sizeof(stage->folder), "/tmp/gopura-locators-XXXXXX");
	CHECK(mkdtemp(stage->folder));
	snprintf(path, sizeof(path), "%s/cache.db", stage->folder);
	cache.path = path;
	CHECK(cache_create(&stage->cache, &cache) == 0);
	link_init(&stage->link);
	stage->link.refusal = &stage->refusal;
	begin(stage);
	return 0;
}

static int tear_down(void **state)
{
	struct stage *stage = *state;
	char command[128];

	locators_clear(&stage->locators);
	CHECK(stage->link.in_flight == 0);
	cache_destroy(stage->cache);
	snprintf(command, sizeof(command), "rm -rf %s", stage->folder);
	free(stage);
	return system(command);
}

/* Answers the last request with a locator that has the page's block, 1000 bytes, in this pack. */
static void answer(uint8_t pack, uint32_t place, struct hash page)
{
	struct locator_block block = { page, 0, place, 1000 };
	struct hash pack_name = { { pack } };
	struct locator locator = { 1, 1, &pack_name, &block, HASH_BYTES };
	struct buffer file;

	buffer_init(&file, 1 << 20);
	locator_encode(&file, &locator);
	give(asked(0), buffer_bytes(&file));
	end(asked(0), 0);
	buffer_finish(&file);
}

static struct message_want object(struct hash page, uint32_t offset, uint32_t size)
{
	return (struct message_want){
		.hash = { { 77 } }, .page = page, .offset = offset, .size = size
	};
}

static void finds_an_object_once_the_locator_has_come(void **state)
{
	struct stage *stage = *state;
	struct message_want inside = object(shared_page, 300, 700);
	struct message_want beyond = object(shared_page, 301, 700);
	struct message_want stray = object(second_root, 0, 10);
	struct range_item place;

	CHECK(locators_find(&stage->locators, &inside, 0, &place) == -ENOENT); /* no release */
	CHECK(locators_add(&stage->locators, first_root) == 0 && stage->changes == 1);
	CHECK(locators_find(&stage->locators, &inside, 0, &place) == -EAGAIN);
	CHECK(locators_due_ms(&stage->locators) <= server.now_ms);
	locators_work(&stage->locators);
	CHECK(server.count == 1 && strncmp(asked(0)->path, "locator/01", 10) == 0);
	CHECK(stage->link.in_flight == 1 && locators_due_ms(&stage->locators) == INT64_MAX);
	answer(0xaa, 5000, shared_page);
	CHECK(stage->changes == 2);
	CHECK(locators_find(&stage->locators, &inside, 0, &place) == 0);
	CHECK(place.pack.bytes[0] == 0xaa && place.place == 5300 && place.size == 700);
	CHECK(!place.want && !place.taken);
	CHECK(locators_find(&stage->locators, &beyond, 0, &place) == -ENOENT);
	CHECK(locators_find(&stage->locators, &stray, 0, &place) == -ENOENT);
}

static void knows_the_root_page_only_of_its_own_release(void **state)
{
	struct stage *stage = *state;
	struct message_want root = { .hash = first_root, .page = no_page, .size = 100 };
	struct message_want other = { .hash = second_root, .page = no_page, .size = 100 };
	struct range_item place;

	CHECK(locators_add(&stage->locators, first_root) == 0);
	locators_work(&stage->locators);
	answer(0xaa, 0, no_page);
	CHECK(locators_find(&stage->locators, &root, 0, &place) == 0);
	CHECK(locators_find(&stage->locators, &other, 0, &place) == -ENOENT);
}

static void tries_the_releases_in_turn_newest_first(void **state)
{
	struct stage *stage = *state;
	struct message_want want = object(shared_page, 0, 10);
	struct hash roots[MESSAGE_RELEASES_MAX];
	struct range_item place;

	CHECK(locators_add(&stage->locators, first_root) == 0);
	locators_work(&stage->locators);
	answer(0xaa, 0, shared_page);
	CHECK(locators_add(&stage->locators, second_root) == 0);
	CHECK(locators_add(&stage->locators, first_root) == 0); /* it is in use already */
	locators_work(&stage->locators);
	answer(0xbb, 0, shared_page);
	CHECK(locators_roots(&stage->locators, roots) == 2);
	CHECK(hash_equal(roots[0], second_root) && hash_equal(roots[1], first_root));
	for (uint32_t attempt = 0; attempt < 4; attempt++) {
		CHECK(locators_find(&stage->locators, &want, attempt, &place) == 0);
		CHECK(place.pack.bytes[0] == (attempt % 2 ? 0xaa : 0xbb));
	}
}

/* The first one is on the panel. */
static void drops_the_oldest_but_the_first_with_its_request(void **state)
{
	struct stage *stage = *state;
	struct hash roots[MESSAGE_RELEASES_MAX];

	for (uint8_t n = 1; n <= MESSAGE_RELEASES_MAX + 1; n++) {
		CHECK(locators_add(&stage->locators, (struct hash){ { n } }) == 0);
		locators_work(&stage->locators);
	}
	CHECK(server.cancelled == 1 && !server.asked[1].open);
	CHECK(locators_roots(&stage->locators, roots) == MESSAGE_RELEASES_MAX);
	CHECK(roots[0].bytes[0] == MESSAGE_RELEASES_MAX + 1);
	CHECK(roots[MESSAGE_RELEASES_MAX - 2].bytes[0] == 3);
	CHECK(roots[MESSAGE_RELEASES_MAX - 1].bytes[0] == 1);
}

static void reads_from_the_cache_what_it_downloaded_before(void **state)
{
	struct stage *stage = *state;
	struct message_want want = object(shared_page, 0, 10);
	struct range_item place;

	CHECK(locators_add(&stage->locators, first_root) == 0);
	locators_work(&stage->locators);
	answer(0xaa, 0, shared_page);
	locators_clear(&stage->locators);
	CHECK(locators_add(&stage->locators, first_root) == 0);
	locators_work(&stage->locators);
	CHECK(server.count == 1 && locators_find(&stage->locators, &want, 0, &place) == 0);
}

static void pauses_after_a_missing_or_damaged_locator(void **state)
{
	struct stage *stage = *state;
	struct message_want want = object(shared_page, 0, 10);
	struct range_item place;

	CHECK(locators_add(&stage->locators, first_root) == 0);
	locators_work(&stage->locators);
	end(asked(0), -ENOENT);
	CHECK(locators_find(&stage->locators, &want, 0, &place) == -ENOENT); /* not to be awaited */
	CHECK(stage->refusal.count == 1 && stage->changes == 2);
	locators_work(&stage->locators);
	CHECK(server.count == 1 && locators_due_ms(&stage->locators) > server.now_ms);
	server.now_ms = locators_due_ms(&stage->locators);
	locators_work(&stage->locators);
	CHECK(server.count == 2);
	give(asked(0), (struct bytes){ (const uint8_t *)"no locator", 10 });
	end(asked(0), 0);
	CHECK(locators_find(&stage->locators, &want, 0, &place) == -ENOENT);
	CHECK(stage->refusal.count == 1); /* one refusal for one release */
	server.now_ms = locators_due_ms(&stage->locators);
	locators_work(&stage->locators);
	answer(0xaa, 0, shared_page);
	CHECK(locators_find(&stage->locators, &want, 0, &place) == 0);
}

static void waits_for_a_server_that_is_away(void **state)
{
	struct stage *stage = *state;
	struct message_want want = object(shared_page, 0, 10);
	struct range_item place;

	CHECK(locators_add(&stage->locators, first_root) == 0);
	locators_work(&stage->locators);
	end(asked(0), -EHOSTUNREACH);
	CHECK(stage->link.failures == 1);
	CHECK(locators_find(&stage->locators, &want, 0, &place) == -EAGAIN);
}

static void refreshes_a_suspected_locator_once_a_minute(void **state)
{
	struct stage *stage = *state;
	struct message_want want = object(shared_page, 0, 10);
	struct range_item place;

	CHECK(locators_add(&stage->locators, first_root) == 0);
	locators_work(&stage->locators);
	answer(0xaa, 0, shared_page);
	locators_suspect(&stage->locators);
	locators_refresh_suspected(&stage->locators);
	CHECK(server.count == 1); /* it has only just come */
	server.now_ms += 60000;
	locators_refresh_suspected(&stage->locators);
	CHECK(server.count == 1); /* the suspicion was answered */
	locators_suspect(&stage->locators);
	locators_refresh_suspected(&stage->locators);
	CHECK(server.count == 2);
	CHECK(locators_find(&stage->locators, &want, 0, &place) == 0); /* by the old one */
	CHECK(place.pack.bytes[0] == 0xaa);
	answer(0xbb, 0, shared_page);
	CHECK(locators_find(&stage->locators, &want, 0, &place) == 0);
	CHECK(place.pack.bytes[0] == 0xbb);
}

#define STAGED(test) cmocka_unit_test_setup_teardown(test, set_up, tear_down)

int main(void)
{
	const struct CMUnitTest tests[] = {
		STAGED(finds_an_object_once_the_locator_has_come),
		STAGED(knows_the_root_page_only_of_its_own_release),
		STAGED(tries_the_releases_in_turn_newest_first),
		STAGED(drops_the_oldest_but_the_first_with_its_request),
		STAGED(reads_from_the_cache_what_it_downloaded_before),
		STAGED(pauses_after_a_missing_or_damaged_locator),
		STAGED(waits_for_a_server_that_is_away),
		STAGED(refreshes_a_suspected_locator_once_a_minute),
	};

	return cmocka_run_group_tests(tests, NULL, NULL);
}
