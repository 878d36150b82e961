#include "app/release/wants.h"

#include <errno.h>
#include <string.h>

#include "tests/check.h"

/* The fetcher's end, at the linker: writes down what is said. */
static uint32_t want_count, drop_count;
static struct message_want last_want;
static struct hash last_drop;

static bool is_full; /* no memory for another want */

int net_client_want(struct net_client *client, const struct message_want *want)
{
	(void)client;
	want_count++;
	last_want = *want;
	return is_full ? -ENOMEM : 0;
}

void net_client_drop(struct net_client *client, struct hash hash)
{
	(void)client;
	drop_count++;
	last_drop = hash;
}

static struct hash used;

void net_client_use_release(struct net_client *client, struct hash root, uint32_t root_bytes)
{
	(void)client;
	CHECK(root_bytes == 77);
	used = root;
}

static struct message_want want_of(uint8_t name, uint32_t priority)
{
	struct message_want want = { .priority = priority, .size = 10 };

	memset(want.hash.bytes, name, HASH_BYTES);
	return want;
}

static void turn(struct wants *wants, const struct message_want *list, uint32_t count)
{
	want_count = drop_count = 0;
	wants_begin(wants);
	for (uint32_t i = 0; i < count; i++)
		wants_add(wants, &list[i]);
	CHECK(wants_say(wants) != is_full);
}

static void says_only_what_changed(void **state)
{
	static struct wants wants;
	struct message_want list[3] = { want_of(9, 100), want_of(3, 100), want_of(5, 100) };

	(void)state;
	wants_init(&wants, NULL);
	turn(&wants, list, 3);
	CHECK(want_count == 3 && drop_count == 0);
	turn(&wants, list, 3);
	CHECK(want_count == 0 && drop_count == 0);
	list[1].priority = 110; /* hardly more */
	turn(&wants, list, 3);
	CHECK(want_count == 0);
	list[1].priority = 400;
	turn(&wants, list, 3);
	CHECK(want_count == 1 && last_want.priority == 400);
	turn(&wants, list, 2);
	CHECK(want_count == 0 && drop_count == 1);
	CHECK(hash_equal(last_drop, list[2].hash));
}

static void says_again_what_memory_was_lacking_for(void **state)
{
	static struct wants wants;
	const struct message_want list[2] = { want_of(9, 100), want_of(3, 100) };

	(void)state;
	wants_init(&wants, NULL);
	turn(&wants, list, 1);
	is_full = true;
	turn(&wants, list, 2);
	CHECK(want_count == 1 && hash_equal(last_want.hash, list[1].hash));
	is_full = false;
	turn(&wants, list, 2);
	CHECK(want_count == 1 && hash_equal(last_want.hash, list[1].hash));
	turn(&wants, list, 2);
	CHECK(want_count == 0 && drop_count == 0);
}

static void a_slow_drift_of_priority_is_said_in_the_end(void **state)
{
	static struct wants wants;
	struct message_want one = want_of(1, 100);
	uint32_t said = 0;

	(void)state;
	wants_init(&wants, NULL);
	for (; one.priority < 200; one.priority += 10) {
		turn(&wants, &one, 1);
		said += want_count;
	}
	CHECK(said >= 3 && said < 10);
}

static void an_object_that_came_is_neither_dropped_nor_said(void **state)
{
	static struct wants wants;
	struct message_want list[2] = { want_of(9, 100), want_of(3, 100) };

	(void)state;
	wants_init(&wants, NULL);
	turn(&wants, list, 2);
	wants_arrived(&wants, list[0].hash);
	turn(&wants, list + 1, 1);
	CHECK(want_count == 0 && drop_count == 0);
}

static void twice_wanted_counts_once_with_the_higher_priority(void **state)
{
	static struct wants wants;
	struct message_want list[2] = { want_of(9, 100), want_of(9, 700) };

	(void)state;
	wants_init(&wants, NULL);
	turn(&wants, list, 2);
	CHECK(want_count == 1 && last_want.priority == 700);
}

static void what_is_for_later_comes_after_all_that_is_shown(void **state)
{
	static struct wants wants;
	const struct message_want root = want_of(1, 2 * MESSAGE_PRIORITY_INDEX);
	const struct message_want tile = want_of(2, MESSAGE_PRIORITY_INDEX / 2);

	(void)state;
	wants_init(&wants, NULL);
	for (int i = 0; i < 2; i++) { /* a turn begins with what is shown */
		wants_begin(&wants);
		wants_add(&wants, &tile);
		wants_later(&wants);
		wants_add(&wants, &root);
		CHECK(wants_say(&wants));
		CHECK(wants.said[0].priority < MESSAGE_PRIORITY_PICTURE);
		CHECK(wants.said[1].priority == tile.priority);
	}
	wants_begin(&wants);
	wants_add(&wants, &tile); /* of both: it is shown */
	wants_later(&wants);
	wants_add(&wants, &tile);
	wants_add(&wants, &root);
	CHECK(wants_say(&wants));
	CHECK(wants.said_count == 2 && wants.said[1].priority == tile.priority);
	turn(&wants, &root, 1);
	CHECK(want_count == 1 && last_want.priority == root.priority); /* now it is shown */
	wants_begin(&wants);
	wants_later(&wants);
	wants_add(&wants, &root);
	wants_add(&wants, &tile);
	CHECK(wants_say(&wants));
	CHECK(wants.said[0].priority > wants.said[1].priority);
}

static void more_than_fit_are_ignored(void **state)
{
	static struct wants wants;

	(void)state;
	wants_init(&wants, NULL);
	want_count = 0;
	wants_begin(&wants);
	for (uint32_t i = 0; i < WANTS_MAX + 50; i++) {
		struct message_want want = want_of(1, 100);

		want.hash.bytes[0] = (uint8_t)i;
		want.hash.bytes[1] = (uint8_t)(i >> 8);
		wants_add(&wants, &want);
	}
	CHECK(wants_say(&wants));
	CHECK(want_count == WANTS_MAX);
}

static void another_release_begins_with_no_wants(void **state)
{
	static struct wants wants;
	struct exhibit shown = { .root = { { 8 } }, .root_bytes = 77 };
	const struct exhibit_change change = { .shown = &shown };
	const struct message_want one = want_of(1, 100);

	(void)state;
	wants_init(&wants, NULL);
	turn(&wants, &one, 1);
	wants_on_release(&wants, &change); /* it could not be opened */
	CHECK(wants.said_count == 1);
	shown.scene = (struct scene *)&shown; /* nobody looks behind it */
	wants_on_release(&wants, &change);
	CHECK(wants.said_count == 0 && hash_equal(used, shown.root));
	turn(&wants, &one, 1);
	CHECK(want_count == 1); /* said again */
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(says_only_what_changed),
		cmocka_unit_test(says_again_what_memory_was_lacking_for),
		cmocka_unit_test(a_slow_drift_of_priority_is_said_in_the_end),
		cmocka_unit_test(an_object_that_came_is_neither_dropped_nor_said),
		cmocka_unit_test(twice_wanted_counts_once_with_the_higher_priority),
		cmocka_unit_test(what_is_for_later_comes_after_all_that_is_shown),
		cmocka_unit_test(more_than_fit_are_ignored),
		cmocka_unit_test(another_release_begins_with_no_wants),
	};

	return cmocka_run_group_tests(tests, NULL, NULL);
}
