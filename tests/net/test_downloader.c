#include "net/downloader.h"

#include <unistd.h>

#include "format/locator.h"
#include "format/page.h"
#include "tests/check.h"
#include "tests/net/fake_http.h"

enum { OBJECTS = 20, OBJECT_BYTES = 3000 };

/* A release of one page's objects, in a pack; and a downloader that reports to the test. */
struct stage {
	char folder[64];
	struct cache *cache;
	struct link link;
	struct metrics_refusal refusal;
	struct downloader *downloader;
	uint8_t pack[OBJECTS * OBJECT_BYTES];
	struct hash names[OBJECTS], page, pack_name, root;
	struct buffer locator;
	bool full; /* the kiosk takes no more */
	int objects, missing;
	struct hash last;
	enum missing_reason reason;
};

/* A stick that may be there, and is asked so often. */
static struct {
	bool is_there;
	int requests;
} stick;

bool stick_request(struct stick *reader, const struct hash *roots, size_t count,
		   const struct message_want *asked)
{
	(void)reader;
	CHECK(count == 0 || !hash_is_zero(roots[0]));
	stick.requests += stick.is_there && asked->size == OBJECT_BYTES;
	return stick.is_there;
}

static void on_object(void *data, struct hash hash, struct bytes bytes)
{
	struct stage *stage = data;

	CHECK(hash_equal(hash_of(bytes), hash));
	stage->objects++;
	stage->last = hash;
}

static void on_missing(void *data, struct hash hash, enum missing_reason reason)
{
	struct stage *stage = data;

	stage->missing++;
	stage->last = hash;
	stage->reason = reason;
}

static bool has_room(void *data)
{
	return !((struct stage *)data)->full;
}

static void make_release(struct stage *stage, uint8_t pack_name)
{
	struct locator_block block = { stage->page, 0, 0, sizeof(stage->pack) };
	struct locator locator = { 1, 1, &stage->pack_name, &block, HASH_BYTES };

	stage->pack_name = (struct hash){ { pack_name } };
	buffer_finish(&stage->locator);
	buffer_init(&stage->locator, 1 << 20);
	locator_encode(&stage->locator, &locator);
	CHECK(stage->locator.error == 0);
}

static int set_up(void **state)
{
	struct stage *stage = calloc(1, sizeof(*stage));
	struct cache_options cache = { .budget_bytes = 8 << 20 };
	struct downloader_options options = { .link = &stage->link,
					      .events = { on_object, on_missing, has_room },
					      .data = stage };
	char path[96];

	*state = stage;
	memset(&server, 0, sizeof(server));
	memset(&stick, 0, sizeof(stick));
	server.now_ms = 1000;
	snprintf(stage->folder, sizeof(stage->folder), "/tmp/gopura-download-XXXXXX");
	CHECK(mkdtemp(stage->folder));
	snprintf(path, sizeof(path), "%s/cache.db", stage->folder);
	cache.path = path;
	CHECK(cache_create(&stage->cache, &cache) == 0);
	link_init(&stage->link);
	stage->link.refusal = &stage->refusal;
	options.cache = stage->cache;
	CHECK(downloader_create(&stage->downloader, &options) == 0);
	for (size_t i = 0; i < sizeof(stage->pack); i++)
		stage->pack[i] = (uint8_t)(i * i / 7 + i / OBJECT_BYTES);
	for (int i = 0; i < OBJECTS; i++)
		stage->names[i] =
			hash_of((struct bytes){ stage->pack + i * OBJECT_BYTES, OBJECT_BYTES });
	stage->page = (struct hash){ { 9, 9 } };
	stage->root = (struct hash){ { 7 } };
	make_release(stage, 0xaa);
	return 0;
}

static int tear_down(void **state)
{
	struct stage *stage = *state;
	char command[128];

	downloader_destroy(stage->downloader);
	cache_destroy(stage->cache);
	buffer_finish(&stage->locator);
	snprintf(command, sizeof(command), "rm -rf %s", stage->folder);
	free(stage);
	return system(command);
}

static void want(struct stage *stage, int n, uint32_t priority)
{
	struct message_want message = { .hash = stage->names[n],
					.page = stage->page,
					.offset = (uint32_t)n * OBJECT_BYTES,
					.size = OBJECT_BYTES,
					.priority = priority };

	CHECK(downloader_want(stage->downloader, &message) == 0);
}

/* The release in use, its locator downloaded. */
static void begin(struct stage *stage)
{
	CHECK(downloader_use_release(stage->downloader, stage->root, false) == 0);
	downloader_work(stage->downloader);
	CHECK(server.count == 1 && strncmp(asked(0)->path, "locator/07", 10) == 0);
	give(asked(0), buffer_bytes(&stage->locator));
	end(asked(0), 0);
	downloader_work(stage->downloader);
}

/* The bytes that the request asked for, from the pack. */
static struct bytes answer_to(const struct stage *stage, const struct http_request *request)
{
	return (struct bytes){ stage->pack + request->get.first, request->get.size };
}

static void asks_for_neighbours_in_one_request(void **state)
{
	struct stage *stage = *state;

	begin(stage);
	want(stage, 3, 1000);
	want(stage, 4, 1000);
	want(stage, 6, 2000); /* across an object that nobody wants: its bytes would cost more */
	want(stage, 12, 1000);
	downloader_work(stage->downloader);
	CHECK(server.count == 4);
	CHECK(asked(2)->get.first == 6 * OBJECT_BYTES && asked(2)->get.size == OBJECT_BYTES);
	CHECK(asked(1)->get.first == 3 * OBJECT_BYTES && asked(1)->get.size == 2 * OBJECT_BYTES);
	CHECK(asked(0)->get.first == 12 * OBJECT_BYTES && asked(0)->get.size == OBJECT_BYTES);
	CHECK(strncmp(asked(0)->path, "packs/aa", 8) == 0);
	give(asked(1), answer_to(stage, asked(1)));
	CHECK(stage->objects == 2); /* before the request has ended */
	end(asked(1), 0);
	CHECK(downloader_wanted(stage->downloader) == 2);
}

static void finds_in_the_cache_what_it_downloaded_before(void **state)
{
	struct stage *stage = *state;
	struct downloader_counters metrics;

	begin(stage);
	want(stage, 3, 1000);
	downloader_work(stage->downloader);
	give(asked(0), answer_to(stage, asked(0)));
	end(asked(0), 0);
	want(stage, 3, 1000);
	downloader_work(stage->downloader);
	CHECK(server.count == 2 && stage->objects == 2);
	downloader_counters(stage->downloader, &metrics);
	CHECK(metrics.from_cache == 1 && metrics.from_server == 1);
	/* and the locator too: a start without the network */
	downloader_clear(stage->downloader);
	CHECK(downloader_use_release(stage->downloader, stage->root, false) == 0);
	want(stage, 5, 1000);
	downloader_work(stage->downloader);
	CHECK(strncmp(asked(0)->path, "packs/", 6) == 0);
}

static void asks_for_the_best_first_and_for_few_at_once(void **state)
{
	struct stage *stage = *state;

	begin(stage);
	for (int n = 0; n < OBJECTS; n += 3) /* too far apart to join */
		want(stage, n, 1000 + (uint32_t)n);
	want(stage, 1, MESSAGE_PRIORITY_INDEX);
	downloader_work(stage->downloader);
	CHECK(server.asked[1].get.first == 0); /* with the page beside it */
	CHECK(server.asked[2].get.first == 18 * OBJECT_BYTES);
}

/* Segments of large objects fill a turn and no more; what is more urgent does not wait for them. */
static void asks_for_one_turn_at_once(void **state)
{
	struct stage *stage = *state;
	struct locator_block block = { stage->page, 0, 0, UINT32_MAX };
	struct locator locator = { 1, 1, &stage->pack_name, &block, HASH_BYTES };
	struct message_want page = { .hash = { { 77 } },
				     .page = stage->page,
				     .offset = 50 << 20,
				     .size = 500,
				     .priority = MESSAGE_PRIORITY_INDEX };

	buffer_clear(&stage->locator);
	locator_encode(&stage->locator, &locator);
	begin(stage);
	for (uint32_t n = 0; n < 20; n++) {
		struct message_want large = { .hash = { { 1, (uint8_t)n } },
					      .page = stage->page,
					      .offset = n << 20,
					      .size = 1 << 20 };

		CHECK(downloader_want(stage->downloader, &large) == 0);
	}
	downloader_work(stage->downloader);
	CHECK(server.count == 1 + 4 && asked(0)->get.size == 128 << 10);
	downloader_work(stage->downloader);
	CHECK(server.count == 1 + 4 && downloader_due_ms(stage->downloader) > server.now_ms);
	CHECK(downloader_want(stage->downloader, &page) == 0);
	downloader_work(stage->downloader);
	CHECK(server.count == 1 + 5 && asked(0)->get.size == 500);
}

/* The downloader anew, where a turn has so few bytes that the whole pack, one object, takes three:
 * 12 segments. Returns the object's name. */
static struct hash want_in_segments(struct stage *stage)
{
	struct downloader_options options = { .cache = stage->cache,
					      .link = &stage->link,
					      .wait_ms = 20,
					      .events = { on_object, on_missing, has_room },
					      .data = stage };
	struct message_want large = { .page = stage->page,
				      .size = sizeof(stage->pack),
				      .priority = MESSAGE_PRIORITY_PICTURE };

	downloader_destroy(stage->downloader);
	CHECK(downloader_create(&stage->downloader, &options) == 0);
	large.hash = hash_of((struct bytes){ stage->pack, sizeof(stage->pack) });
	begin(stage);
	CHECK(downloader_want(stage->downloader, &large) == 0);
	downloader_work(stage->downloader);
	return large.hash;
}

static void answer(struct stage *stage, struct http_request *request)
{
	give(request, answer_to(stage, request));
	end(request, 0);
	downloader_work(stage->downloader);
}

static void asks_for_a_large_object_in_segments(void **state)
{
	struct stage *stage = *state;
	const struct hash name = want_in_segments(stage);
	struct downloader_counters counters;
	size_t next = 1;

	CHECK(server.count == 1 + 4 && asked(0)->get.size < sizeof(stage->pack) / 10);
	answer(stage, &server.asked[2]); /* not the first */
	CHECK(server.count == 1 + 5 && stage->objects == 0);
	while (next < server.count) {
		if (server.asked[next].open)
			answer(stage, &server.asked[next]);
		next++;
	}
	CHECK(stage->objects == 1 && hash_equal(stage->last, name) && server.count == 1 + 12);
	downloader_counters(stage->downloader, &counters);
	CHECK(counters.from_server == 1 && counters.ranges == 12);
}

static void keeps_the_segments_that_came_before_the_line_broke(void **state)
{
	struct stage *stage = *state;
	size_t next = 1;

	want_in_segments(stage);
	answer(stage, &server.asked[1]);
	while (next < server.count) {
		if (server.asked[next].open)
			end(&server.asked[next], -EHOSTUNREACH);
		next++;
	}
	CHECK(stage->objects == 0 && server.count == 1 + 5);
	server.now_ms += 120000;
	downloader_work(stage->downloader);
	for (; next < server.count; next++)
		answer(stage, &server.asked[next]);
	CHECK(stage->objects == 1 && server.count == 1 + 12 + 4);
}

static void starts_again_when_segments_are_not_the_object(void **state)
{
	struct stage *stage = *state;
	struct downloader_counters counters;
	size_t next = 1;

	want_in_segments(stage);
	stage->pack[40000] ^= 1;
	for (; next < 1 + 12; next++)
		answer(stage, &server.asked[next]);
	stage->pack[40000] ^= 1;
	downloader_counters(stage->downloader, &counters);
	CHECK(stage->objects == 0 && counters.damaged == 1);
	for (; next < server.count; next++)
		answer(stage, &server.asked[next]);
	CHECK(stage->objects == 1 && server.count == 1 + 24);
}

static void cancels_all_segments_of_what_is_dropped(void **state)
{
	struct stage *stage = *state;
	const struct hash name = want_in_segments(stage);

	answer(stage, &server.asked[1]);
	downloader_drop(stage->downloader, name);
	CHECK(server.cancelled == 4 && downloader_wanted(stage->downloader) == 0);
	downloader_work(stage->downloader);
	CHECK(server.count == 1 + 5);
}

/* The downloader anew, with a limit of 6000 bytes a second. */
static void limit(struct stage *stage)
{
	struct downloader_options options = { .cache = stage->cache,
					      .link = &stage->link,
					      .rate_limit = 6000,
					      .events = { on_object, on_missing, has_room },
					      .data = stage };

	downloader_destroy(stage->downloader);
	CHECK(downloader_create(&stage->downloader, &options) == 0);
	begin(stage);
}

/* Answers what was asked since, at once. */
static void answer_all(struct stage *stage, size_t *answered)
{
	for (; *answered < server.count; (*answered)++) {
		give(&server.asked[*answered], answer_to(stage, &server.asked[*answered]));
		end(&server.asked[*answered], 0);
	}
}

static void keeps_to_its_rate_with_what_is_for_later(void **state)
{
	struct stage *stage = *state;
	int64_t began_ms;
	size_t answered = 1;
	int turns = 0;

	limit(stage);
	began_ms = server.now_ms;
	for (int n = 0; n < OBJECTS; n += 2) /* too far apart to join */
		want(stage, n, MESSAGE_PRIORITY_PICTURE - 1);
	while (downloader_wanted(stage->downloader) > 0) {
		CHECK(++turns < 200); /* it sleeps until they are paid for */
		downloader_work(stage->downloader);
		answer_all(stage, &answered);
		if (downloader_due_ms(stage->downloader) > server.now_ms &&
		    downloader_due_ms(stage->downloader) != INT64_MAX)
			server.now_ms = downloader_due_ms(stage->downloader);
	}
	/* 30 000 bytes: the next may go out when they are paid for; half a second was saved */
	CHECK(server.now_ms - began_ms > 30000 / 6 - 500 - 600);
	CHECK(server.now_ms - began_ms < 30000 / 6 + 100);
}

static void what_is_shown_has_no_rate(void **state)
{
	struct stage *stage = *state;
	const int64_t began_ms = server.now_ms;
	size_t answered = 1;

	limit(stage);
	for (int n = 0; n < 8; n++) /* overdrawn by 21 000 bytes then: 3.5 seconds */
		want(stage, n, 0);
	downloader_work(stage->downloader);
	answer_all(stage, &answered);
	CHECK(stage->objects == 8);
	want(stage, 10, 500); /* for later, though it stands beside what is shown */
	for (int n = 11; n < OBJECTS; n++)
		want(stage, n, MESSAGE_PRIORITY_PICTURE);
	for (int i = 0; i < 3; i++) {
		downloader_work(stage->downloader);
		answer_all(stage, &answered);
	}
	CHECK(server.now_ms == began_ms && downloader_wanted(stage->downloader) == 1);
	CHECK(downloader_due_ms(stage->downloader) > server.now_ms + 2000);
	want(stage, 10, MESSAGE_PRIORITY_PICTURE); /* now it is shown */
	downloader_work(stage->downloader);
	answer_all(stage, &answered);
	CHECK(downloader_wanted(stage->downloader) == 0);
}

static void tries_again_what_memory_was_lacking_for(void **state)
{
	struct stage *stage = *state;
	size_t answered = 1;

	begin(stage);
	want(stage, 0, MESSAGE_PRIORITY_PICTURE);
	server.is_full = true;
	downloader_work(stage->downloader);
	CHECK(server.count == 1);
	CHECK(downloader_due_ms(stage->downloader) == server.now_ms + 1000);
	server.is_full = false;
	server.now_ms += 1000;
	downloader_work(stage->downloader);
	answer_all(stage, &answered);
	CHECK(server.count == 2 && stage->objects == 1);
}

static void stops_when_the_kiosk_takes_no_more(void **state)
{
	struct stage *stage = *state;

	begin(stage);
	stage->full = true;
	want(stage, 3, 1000);
	downloader_work(stage->downloader);
	CHECK(server.count == 1);
	CHECK(downloader_due_ms(stage->downloader) == INT64_MAX); /* no reason to wake up */
	stage->full = false;
	CHECK(downloader_due_ms(stage->downloader) <= server.now_ms);
	downloader_work(stage->downloader);
	CHECK(server.count == 2);
}

static void cancels_what_nobody_wants_any_more(void **state)
{
	struct stage *stage = *state;

	begin(stage);
	want(stage, 3, 1000);
	want(stage, 4, 1000);
	downloader_work(stage->downloader);
	downloader_drop(stage->downloader, stage->names[3]);
	CHECK(server.cancelled == 0);
	downloader_drop(stage->downloader, stage->names[4]);
	CHECK(server.cancelled == 1 && downloader_wanted(stage->downloader) == 0);
	downloader_work(stage->downloader);
	CHECK(server.count == 2);
}

static void keeps_what_was_dropped_while_it_came(void **state)
{
	struct stage *stage = *state;
	struct buffer back;

	begin(stage);
	want(stage, 3, 1000);
	want(stage, 4, 1000);
	downloader_work(stage->downloader);
	downloader_drop(stage->downloader, stage->names[3]);
	give(asked(0), answer_to(stage, asked(0)));
	end(asked(0), 0);
	CHECK(stage->objects == 1 && hash_equal(stage->last, stage->names[4]));
	buffer_init(&back, OBJECT_BYTES);
	CHECK(cache_get(stage->cache, stage->names[3], 0, &back) == 0);
	buffer_finish(&back);
}

static void refuses_a_wrong_hash_asks_again_and_tells(void **state)
{
	struct stage *stage = *state;

	begin(stage);
	want(stage, 3, 1000);
	want(stage, 4, 1000);
	downloader_work(stage->downloader);
	stage->pack[3 * OBJECT_BYTES + 77] ^= 1;
	give(asked(0), answer_to(stage, asked(0)));
	end(asked(0), 0);
	CHECK(stage->objects == 1 && stage->missing == 0); /* its neighbour is none the worse */
	downloader_work(stage->downloader);
	CHECK(server.count == 3 && asked(0)->get.size == OBJECT_BYTES);
	give(asked(0), answer_to(stage, asked(0)));
	CHECK(stage->missing == 1 && stage->reason == MISSING_DAMAGED);
	CHECK(stage->refusal.count == 1 && strstr(stage->refusal.why, "damaged"));
	end(asked(0), 0);
	stage->pack[3 * OBJECT_BYTES + 77] ^= 1; /* repaired */
	server.now_ms += 200000;
	downloader_work(stage->downloader);
	CHECK(server.count == 5 && asked(1)->get.size == OBJECT_BYTES); /* and the locator */
	give(asked(1), answer_to(stage, asked(1)));
	end(asked(1), 0);
	give(asked(0), buffer_bytes(&stage->locator));
	end(asked(0), 0);
	CHECK(stage->objects == 2 && downloader_wanted(stage->downloader) == 0);
}

static void asks_for_the_locator_after_damage_but_not_amid_it(void **state)
{
	struct stage *stage = *state;
	size_t before;

	begin(stage);
	server.now_ms += 100000; /* the locator is old enough to be suspected */
	want(stage, 3, 1000);
	stage->pack[3 * OBJECT_BYTES + 77] ^= 1;
	for (int i = 0; i < 2; i++) {
		downloader_work(stage->downloader);
		before = server.count;
		give(asked(0), answer_to(stage, asked(0)));
		CHECK(server.count == before);
		end(asked(0), 0);
	}
	CHECK(stage->missing == 1 && stage->reason == MISSING_DAMAGED);
	downloader_work(stage->downloader);
	CHECK(server.count == before + 1 && strncmp(asked(0)->path, "locator/", 8) == 0);
	downloader_work(stage->downloader);
	CHECK(server.count == before + 1); /* once */
}

static void asks_again_for_the_rest_of_a_pack_cut_short(void **state)
{
	struct stage *stage = *state;

	begin(stage);
	want(stage, 3, 1000);
	want(stage, 4, 1000);
	downloader_work(stage->downloader);
	give(asked(0), (struct bytes){ stage->pack + 3 * OBJECT_BYTES, OBJECT_BYTES + 500 });
	end(asked(0), 0);
	CHECK(stage->objects == 1);
	CHECK(stage->missing == 1 && stage->reason == MISSING_NOT_FOUND);
	CHECK(hash_equal(stage->last, stage->names[4]));
	downloader_work(stage->downloader);
	CHECK(downloader_due_ms(stage->downloader) > server.now_ms); /* but not at once */
}

static void waits_while_the_server_is_away(void **state)
{
	struct stage *stage = *state;
	size_t before;

	begin(stage);
	for (int n = 0; n < 9; n += 3)
		want(stage, n, 1000);
	downloader_work(stage->downloader);
	CHECK(server.count == 4);
	for (int n = 0; n < 3; n++)
		end(asked(2 - (size_t)n), -EHOSTUNREACH);
	downloader_work(stage->downloader);
	CHECK(server.count == 4 && stage->missing == 0 && !stage->link.online);
	CHECK(downloader_due_ms(stage->downloader) > server.now_ms);
	server.now_ms += 5000;
	downloader_work(stage->downloader);
	CHECK(server.count == 5); /* one goes to look */
	CHECK(downloader_due_ms(stage->downloader) == INT64_MAX);
	end(asked(0), -EHOSTUNREACH);
	downloader_work(stage->downloader);
	CHECK(stage->missing == 3 && stage->reason == MISSING_OFFLINE);
	want(stage, 15, 1000);
	downloader_work(stage->downloader);
	CHECK(stage->missing == 4); /* told at once */
	server.now_ms += 5000;
	downloader_work(stage->downloader);
	give(asked(0), answer_to(stage, asked(0)));
	before = server.count;
	end(asked(0), 0);
	downloader_work(stage->downloader);
	CHECK(stage->link.online && stage->objects == 1);
	CHECK(server.count == before + 3); /* and all the others follow */
}

/* What the server cannot read is asked for again and again, and everything else comes meanwhile. */
static void loads_the_rest_where_one_object_always_breaks_the_line(void **state)
{
	struct stage *stage = *state;

	begin(stage);
	stage->link.failures = 6; /* its pause is long by now */
	for (int n = 0; n < 12; n += 3)
		want(stage, n, n == 0 ? 3000 : 1000);
	for (int n = 0; n < 8 && stage->objects < 3; n++) {
		downloader_work(stage->downloader);
		for (size_t i = 0; i < server.count; i++)
			if (server.asked[i].open && server.asked[i].get.first == 0)
				end(&server.asked[i], -EHOSTUNREACH);
			else if (server.asked[i].open)
				answer(stage, &server.asked[i]);
		server.now_ms = downloader_due_ms(stage->downloader);
	}
	CHECK(stage->objects == 3 && downloader_wanted(stage->downloader) == 1);
	downloader_work(stage->downloader);
	answer(stage, asked(0));
	CHECK(stage->objects == 4);
}

/* A stick that was pushed, or a moment without memory, must not cost a terminal without a server
 * its pictures. */
static void asks_the_stick_again_when_it_could_not_be_read(void **state)
{
	struct stage *stage = *state;
	const struct bytes bytes = { stage->pack, OBJECT_BYTES };

	begin(stage);
	stick.is_there = true;
	stage->link.failures = 9; /* no server answers */
	stage->link.retry_at_ms = INT64_MAX;
	want(stage, 0, 5);
	downloader_work(stage->downloader);
	CHECK(stick.requests == 1);
	for (int n = 2; n < 12; n++) {
		downloader_stick_answered(stage->downloader, stage->names[0], -EIO,
					  (struct bytes){ NULL, 0 });
		downloader_work(stage->downloader);
		CHECK(stick.requests == n - 1);
		CHECK(downloader_due_ms(stage->downloader) > server.now_ms &&
		      downloader_due_ms(stage->downloader) <= server.now_ms + 100000);
		server.now_ms = downloader_due_ms(stage->downloader);
		downloader_work(stage->downloader);
		CHECK(stick.requests == n);
	}
	downloader_stick_answered(stage->downloader, stage->names[0], 0, bytes);
	CHECK(stage->objects == 1 && hash_equal(stage->last, stage->names[0]));
	/* What the stick does not have is the server's. */
	want(stage, 1, 5);
	downloader_work(stage->downloader);
	CHECK(stick.requests == 12);
	downloader_stick_answered(stage->downloader, stage->names[1], -ENOENT,
				  (struct bytes){ NULL, 0 });
	for (int n = 0; n < 100; n++, server.now_ms += 1000)
		downloader_work(stage->downloader);
	CHECK(stick.requests == 12);
}

static void tells_what_the_release_does_not_have(void **state)
{
	struct stage *stage = *state;
	struct message_want stray = { .hash = { { 5 } }, .page = { { 4 } }, .size = 10 };
	struct message_want beyond = { .hash = { { 6 } },
				       .page = stage->page,
				       .offset = OBJECTS * OBJECT_BYTES - 5,
				       .size = 10 };

	begin(stage);
	CHECK(downloader_want(stage->downloader, &stray) == 0);
	downloader_work(stage->downloader);
	CHECK(stage->missing == 1 && stage->reason == MISSING_NOT_FOUND);
	CHECK(downloader_want(stage->downloader, &beyond) == 0);
	downloader_work(stage->downloader);
	CHECK(stage->missing == 2);
	CHECK(strncmp(asked(0)->path, "packs/", 6) != 0);
}

static void does_without_a_damaged_locator_until_it_is_repaired(void **state)
{
	struct stage *stage = *state;

	CHECK(downloader_use_release(stage->downloader, stage->root, false) == 0);
	want(stage, 3, 1000);
	downloader_work(stage->downloader);
	stage->locator.data[20] ^= 1;
	give(asked(0), buffer_bytes(&stage->locator));
	end(asked(0), 0);
	downloader_work(stage->downloader);
	CHECK(stage->missing == 1 && server.count == 1);
	stage->locator.data[20] ^= 1;
	server.now_ms += 10000;
	downloader_work(stage->downloader);
	CHECK(server.count == 2);
	give(asked(0), buffer_bytes(&stage->locator));
	end(asked(0), 0);
	server.now_ms += 10000;
	downloader_work(stage->downloader);
	CHECK(server.count == 3 && strncmp(asked(0)->path, "packs/", 6) == 0);
}

static void follows_objects_into_other_packs(void **state)
{
	struct stage *stage = *state;

	begin(stage);
	server.now_ms += 100000;
	make_release(stage, 0xbb); /* packed anew under the same hashes */
	want(stage, 3, 1000);
	downloader_work(stage->downloader);
	end(asked(0), -ENOENT); /* the old pack is gone */
	downloader_work(stage->downloader);
	CHECK(strncmp(asked(0)->path, "locator/", 8) == 0);
	give(asked(0), buffer_bytes(&stage->locator));
	end(asked(0), 0);
	server.now_ms += 10000;
	downloader_work(stage->downloader);
	CHECK(strncmp(asked(0)->path, "packs/bb", 8) == 0);
}

static void serves_two_releases_side_by_side(void **state)
{
	struct stage *stage = *state;
	const struct hash next = { { 8 } };
	struct hash page = stage->page;

	begin(stage);
	want(stage, 3, 1000);
	CHECK(downloader_use_release(stage->downloader, next, true) == 0);
	downloader_work(stage->downloader);
	CHECK(downloader_wanted(stage->downloader) == 1);
	CHECK(strncmp(server.asked[1].path, "locator/08", 10) == 0 ||
	      strncmp(server.asked[2].path, "locator/08", 10) == 0);
	stage->page = (struct hash){ { 10 } };
	make_release(stage, 0xcc);
	for (size_t i = 1; i < server.count; i++)
		if (server.asked[i].open && server.asked[i].get.size == 0) {
			give(&server.asked[i], buffer_bytes(&stage->locator));
			end(&server.asked[i], 0);
		}
	want(stage, 5, 1000);
	downloader_work(stage->downloader);
	CHECK(strncmp(asked(0)->path, "packs/cc", 8) == 0);
	stage->page = page;
	want(stage, 9, 1000);
	downloader_work(stage->downloader);
	CHECK(strncmp(asked(0)->path, "packs/aa", 8) == 0);
	CHECK(downloader_use_release(stage->downloader, next, false) == 0);
	CHECK(downloader_wanted(stage->downloader) == 0);
}

static void raises_a_priority_before_it_asks(void **state)
{
	struct stage *stage = *state;

	begin(stage);
	want(stage, 0, 1000);
	want(stage, 9, 2000);
	want(stage, 0, 3000);
	downloader_work(stage->downloader);
	CHECK(server.asked[1].get.first == 0);
	CHECK(downloader_wanted(stage->downloader) == 2);
}

#define STAGED(test) cmocka_unit_test_setup_teardown(test, set_up, tear_down)

int main(void)
{
	const struct CMUnitTest tests[] = {
		STAGED(asks_for_neighbours_in_one_request),
		STAGED(finds_in_the_cache_what_it_downloaded_before),
		STAGED(asks_for_the_best_first_and_for_few_at_once),
		STAGED(asks_for_one_turn_at_once),
		STAGED(asks_for_a_large_object_in_segments),
		STAGED(keeps_the_segments_that_came_before_the_line_broke),
		STAGED(starts_again_when_segments_are_not_the_object),
		STAGED(cancels_all_segments_of_what_is_dropped),
		STAGED(keeps_to_its_rate_with_what_is_for_later),
		STAGED(what_is_shown_has_no_rate),
		STAGED(tries_again_what_memory_was_lacking_for),
		STAGED(stops_when_the_kiosk_takes_no_more),
		STAGED(cancels_what_nobody_wants_any_more),
		STAGED(keeps_what_was_dropped_while_it_came),
		STAGED(refuses_a_wrong_hash_asks_again_and_tells),
		STAGED(asks_for_the_locator_after_damage_but_not_amid_it),
		STAGED(asks_again_for_the_rest_of_a_pack_cut_short),
		STAGED(waits_while_the_server_is_away),
		STAGED(loads_the_rest_where_one_object_always_breaks_the_line),
		STAGED(asks_the_stick_again_when_it_could_not_be_read),
		STAGED(tells_what_the_release_does_not_have),
		STAGED(does_without_a_damaged_locator_until_it_is_repaired),
		STAGED(follows_objects_into_other_packs),
		STAGED(serves_two_releases_side_by_side),
		STAGED(raises_a_priority_before_it_asks),
	};

	return cmocka_run_group_tests(tests, NULL, NULL);
}
