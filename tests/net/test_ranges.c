#include "net/ranges.h"

#include "tests/check.h"
#include "tests/net/fake_http.h"

enum { OBJECTS = 4, OBJECT_BYTES = 700, PLACE = 5000, STEP = OBJECT_BYTES + 50 };

/* Four wants whose objects lie in one pack, with gaps of 50 bytes. */
struct stage {
	struct link link;
	struct want_set wants;
	struct ranges ranges;
	struct range_item items[OBJECTS];
	struct hash names[OBJECTS];
	struct want *want[OBJECTS];
	uint8_t pack[OBJECTS * STEP]; /* from PLACE on */
	int objects, failed, ended, rc;
	const struct want *last;
	struct hash last_hash;
};

static void on_object(void *data, struct want *want, uint32_t segment, struct hash hash,
		      struct bytes bytes)
{
	struct stage *stage = data;

	(void)segment;
	CHECK(bytes.size == OBJECT_BYTES && hash_equal(hash_of(bytes), hash));
	CHECK(!want || (want->state == WANT_WAITING && want->in_flight == 0));
	stage->objects++;
	stage->last = want;
	stage->last_hash = hash;
}

static void on_failed(void *data, struct want *want, int rc)
{
	struct stage *stage = data;

	CHECK(want->state == WANT_WAITING && want->in_flight == 0);
	stage->failed++;
	stage->last = want;
	stage->rc = rc;
}

static void on_ended(void *data)
{
	struct stage *stage = data;

	CHECK(stage->ranges.count == 0); /* there is room already */
	stage->ended++;
}

static int set_up(void **state)
{
	struct stage *stage = calloc(1, sizeof(*stage));
	struct ranges_options options = { .link = &stage->link,
					  .object = on_object,
					  .failed = on_failed,
					  .ended = on_ended,
					  .data = stage };

	*state = stage;
	memset(&server, 0, sizeof(server));
	server.now_ms = 1000;
	link_init(&stage->link);
	ranges_init(&stage->ranges, &options);
	for (size_t i = 0; i < sizeof(stage->pack); i++)
		stage->pack[i] = (uint8_t)(i * i / 7 + i / STEP);
	for (int n = 0; n < OBJECTS; n++) {
		struct message_want asked = { .size = OBJECT_BYTES };

		asked.hash = hash_of((struct bytes){ stage->pack + n * STEP, OBJECT_BYTES });
		CHECK(want_set_add(&stage->wants, &asked) == 0);
		stage->names[n] = asked.hash;
		stage->want[n] = want_set_find(&stage->wants, asked.hash);
		stage->items[n] = (struct range_item){ .pack = { { 0xaa } },
						       .place = (uint64_t)(PLACE + n * STEP),
						       .size = OBJECT_BYTES,
						       .want = stage->want[n] };
	}
	while (want_set_dequeue(&stage->wants))
		;
	CHECK(ranges_request(&stage->ranges, stage->items, OBJECTS) == 0);
	return 0;
}

static int tear_down(void **state)
{
	struct stage *stage = *state;

	ranges_cancel_all(&stage->ranges);
	CHECK(stage->ranges.count == 0 && stage->ranges.bytes == 0 && stage->link.in_flight == 0);
	want_set_finish(&stage->wants);
	free(stage);
	return 0;
}

static void give_pack(struct stage *stage, size_t from, size_t to)
{
	give(asked(0), (struct bytes){ stage->pack + from, to - from });
}

static void reports_each_object_as_its_last_byte_comes(void **state)
{
	struct stage *stage = *state;

	CHECK(strncmp(asked(0)->path, "packs/aa", 8) == 0);
	CHECK(asked(0)->get.first == PLACE);
	CHECK(asked(0)->get.size == (OBJECTS - 1) * STEP + OBJECT_BYTES);
	CHECK(stage->ranges.count == 1 && stage->ranges.bytes == asked(0)->get.size);
	CHECK(stage->link.in_flight == 1);
	give_pack(stage, 0, OBJECT_BYTES - 1);
	CHECK(stage->objects == 0 && stage->want[0]->state == WANT_IN_FLIGHT);
	give_pack(stage, OBJECT_BYTES - 1, OBJECT_BYTES);
	CHECK(stage->objects == 1 && stage->last == stage->want[0]);
	give_pack(stage, OBJECT_BYTES, sizeof(stage->pack));
	CHECK(stage->objects == OBJECTS && stage->last == stage->want[OBJECTS - 1]);
	CHECK(stage->ended == 0);
	end(asked(0), 0);
	CHECK(stage->ended == 1 && stage->failed == 0 && stage->link.answers == 1);
}

static void a_short_answer_fails_for_the_rest(void **state)
{
	struct stage *stage = *state;

	give_pack(stage, 0, STEP + OBJECT_BYTES + 10);
	end(asked(0), 0);
	CHECK(stage->objects == 2 && stage->failed == 2 && stage->rc == -ENOENT);
	CHECK(stage->ended == 1 && stage->link.failures == 0);
}

static void an_answer_that_never_comes_is_the_links_failure(void **state)
{
	struct stage *stage = *state;

	end(asked(0), -EHOSTUNREACH);
	CHECK(stage->failed == OBJECTS && stage->rc == -EHOSTUNREACH);
	CHECK(stage->link.failures == 1 && stage->link.errors == 1);
}

static void reports_without_a_want_what_has_left(void **state)
{
	struct stage *stage = *state;

	CHECK(!ranges_leave(&stage->ranges, stage->want[0]));
	CHECK(!ranges_leave(&stage->ranges, stage->want[0])); /* it is in none any more */
	CHECK(stage->want[0]->state == WANT_WAITING);
	give_pack(stage, 0, OBJECT_BYTES);
	CHECK(stage->objects == 1 && !stage->last);
	CHECK(hash_equal(stage->last_hash, stage->names[0]));
	end(asked(0), -EBADMSG);
	CHECK(stage->failed == OBJECTS - 1 && stage->rc == -EBADMSG);
}

static void is_cancelled_when_the_last_want_has_left(void **state)
{
	struct stage *stage = *state;

	give_pack(stage, 0, OBJECT_BYTES); /* the first has arrived */
	for (int n = 1; n < OBJECTS - 1; n++)
		CHECK(!ranges_leave(&stage->ranges, stage->want[n]));
	CHECK(server.cancelled == 0);
	CHECK(ranges_leave(&stage->ranges, stage->want[OBJECTS - 1]));
	CHECK(server.cancelled == 1 && stage->ranges.cancelled == 1);
	CHECK(stage->failed == 0 && stage->ended == 0);
}

static void says_how_much_is_ahead_of_what_is_as_urgent(void **state)
{
	struct stage *stage = *state;
	const uint32_t priority = stage->want[0]->asked.priority;
	const uint64_t all = stage->ranges.bytes;

	CHECK(all > 2 * OBJECT_BYTES && ranges_ahead(&stage->ranges, priority) == all);
	CHECK(ranges_ahead(&stage->ranges, UINT32_MAX) == 0);
	give_pack(stage, 0, OBJECT_BYTES + 7);
	CHECK(ranges_ahead(&stage->ranges, priority) == all - OBJECT_BYTES - 7);
	ranges_cancel_all(&stage->ranges);
	CHECK(ranges_ahead(&stage->ranges, 0) == 0);
}

static void keeps_the_wants_waiting_without_memory(void **state)
{
	struct stage *stage = *state;

	ranges_cancel_all(&stage->ranges);
	server.count = ASKED_MAX;
	CHECK(ranges_request(&stage->ranges, stage->items, OBJECTS) == -ENOMEM);
	CHECK(stage->ranges.count == 0 && stage->link.in_flight == 0);
	for (int n = 0; n < OBJECTS; n++)
		CHECK(stage->want[n]->state == WANT_WAITING);
}

#define STAGED(test) cmocka_unit_test_setup_teardown(test, set_up, tear_down)

int main(void)
{
	const struct CMUnitTest tests[] = {
		STAGED(reports_each_object_as_its_last_byte_comes),
		STAGED(a_short_answer_fails_for_the_rest),
		STAGED(an_answer_that_never_comes_is_the_links_failure),
		STAGED(reports_without_a_want_what_has_left),
		STAGED(is_cancelled_when_the_last_want_has_left),
		STAGED(says_how_much_is_ahead_of_what_is_as_urgent),
		STAGED(keeps_the_wants_waiting_without_memory),
	};

	return cmocka_run_group_tests(tests, NULL, NULL);
}
