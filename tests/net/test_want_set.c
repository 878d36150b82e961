#include "net/want_set.h"

#include <errno.h>
#include <string.h>

#include "tests/check.h"

static struct hash name_of(uint32_t n)
{
	struct hash hash = { { 0 } };

	memcpy(hash.bytes, &n, sizeof(n));
	memcpy(hash.bytes + 8, &n, sizeof(n));
	return hash;
}

static void add(struct want_set *set, uint32_t n, uint32_t priority)
{
	struct message_want asked = { .hash = name_of(n), .priority = priority };

	CHECK(want_set_add(set, &asked) == 0);
}

/* Takes the next want off the queue; it must be this one. */
static struct want *expect(struct want_set *set, uint32_t n)
{
	struct want *want = want_set_dequeue(set);

	CHECK(want && hash_equal(want->asked.hash, name_of(n)));
	CHECK(want->state == WANT_WAITING);
	return want;
}

static void hands_out_the_most_urgent_first_and_of_equals_the_first(void **state)
{
	struct want_set set = { 0 };

	(void)state;
	add(&set, 1, 10);
	add(&set, 2, 30);
	add(&set, 3, 30);
	add(&set, 4, 20);
	CHECK(want_set_has_queued(&set));
	expect(&set, 2);
	add(&set, 5, 25); /* between two readings */
	expect(&set, 3);
	expect(&set, 5);
	expect(&set, 4);
	expect(&set, 1);
	CHECK(!want_set_has_queued(&set) && !want_set_dequeue(&set));
	CHECK(want_set_count(&set) == 5); /* wanted still */
	want_set_finish(&set);
	CHECK(want_set_count(&set) == 0);
}

static void follows_a_changed_priority(void **state)
{
	struct want_set set = { 0 };

	(void)state;
	add(&set, 1, 10);
	add(&set, 2, 20);
	expect(&set, 2);
	add(&set, 3, 20);
	want_set_change_priority(&set, want_set_find(&set, name_of(1)), 30);
	expect(&set, 1);
	expect(&set, 3);
	want_set_finish(&set);
}

static void forgets_what_was_removed_in_any_state(void **state)
{
	struct want_set set = { 0 };

	(void)state;
	for (uint32_t n = 0; n < 4; n++)
		add(&set, n, n);
	want_set_remove(&set, want_set_find(&set, name_of(3))); /* queued */
	CHECK(!want_set_find(&set, name_of(3)) && want_set_count(&set) == 3);
	want_set_remove(&set, expect(&set, 2)); /* waiting */
	CHECK(!want_set_find(&set, name_of(2)) && want_set_count(&set) == 2);
	add(&set, 3, 0); /* wanted anew while the old one is still queued */
	expect(&set, 1);
	expect(&set, 0);
	expect(&set, 3);
	CHECK(!want_set_dequeue(&set));
	want_set_finish(&set);
}

static void queues_a_waiting_want_again(void **state)
{
	struct want_set set = { 0 };
	struct want *want;
	size_t at = 0, count = 0;

	(void)state;
	for (uint32_t n = 0; n < 600; n++)
		add(&set, n, n);
	while (want_set_dequeue(&set))
		;
	while ((want = want_set_next(&set, &at))) {
		CHECK(want_set_requeue(&set, want) == 0 && want->state == WANT_QUEUED);
		count++;
	}
	CHECK(count == 600);
	for (uint32_t n = 600; n > 0; n--)
		expect(&set, n - 1);
	want_set_finish(&set);
}

static void refuses_more_than_its_maximum(void **state)
{
	struct message_want more = { .hash = name_of(WANTS_MAX) };
	struct want_set set = { 0 };

	(void)state;
	for (uint32_t n = 0; n < WANTS_MAX; n++)
		add(&set, n, 0);
	CHECK(want_set_add(&set, &more) == -ENOSPC);
	CHECK(want_set_count(&set) == WANTS_MAX);
	want_set_remove(&set, want_set_find(&set, name_of(0)));
	CHECK(want_set_add(&set, &more) == 0);
	want_set_finish(&set);
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(hands_out_the_most_urgent_first_and_of_equals_the_first),
		cmocka_unit_test(follows_a_changed_priority),
		cmocka_unit_test(forgets_what_was_removed_in_any_state),
		cmocka_unit_test(queues_a_waiting_want_again),
		cmocka_unit_test(refuses_more_than_its_maximum),
	};

	return cmocka_run_group_tests(tests, NULL, NULL);
}
