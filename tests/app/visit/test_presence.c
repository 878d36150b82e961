/* Whether a visitor is there, over time. */
#include "app/visit/presence.h"

#include "tests/check.h"

enum { IDLE_S = 60, S = 1000 };

static struct presence fresh(void)
{
	struct presence presence;

	presence_init(&presence, IDLE_S, 0);
	return presence;
}

static enum presence_state at(struct presence *presence, int64_t s, bool reading)
{
	presence_step(presence, s * S, reading);
	return presence->state;
}

static void nobody_who_never_touched_is_asked(void **state)
{
	struct presence presence = fresh();

	(void)state;
	CHECK(at(&presence, 59, false) == PRESENCE_SOMEBODY);
	CHECK(presence_wait_ms(&presence, 59 * S) == S);
	CHECK(at(&presence, 60, false) == PRESENCE_NOBODY);
	CHECK(presence_wait_ms(&presence, 60 * S) == -1 &&
	      presence_left_ms(&presence, 60 * S) == 0);
}

static void who_touched_is_asked_and_counted_down(void **state)
{
	struct presence presence = fresh();

	(void)state;
	presence_touch(&presence, 10 * S);
	CHECK(at(&presence, 69, false) == PRESENCE_SOMEBODY &&
	      presence_asked_s(&presence, 69 * S) == -1);
	CHECK(at(&presence, 70, false) == PRESENCE_ASKED &&
	      presence_asked_s(&presence, 70 * S) == 15);
	CHECK(presence_asked_s(&presence, 70 * S + 1) == 15 &&
	      presence_asked_s(&presence, 71 * S) == 14);
	CHECK(presence_asked_s(&presence, 85 * S - 1) == 1);
	CHECK(at(&presence, 84, false) == PRESENCE_ASKED);
	CHECK(at(&presence, 85, false) == PRESENCE_NOBODY && !presence.touched);
}

static void an_answer_keeps_the_visit(void **state)
{
	struct presence presence = fresh();

	(void)state;
	presence_touch(&presence, 0);
	CHECK(at(&presence, 70, false) == PRESENCE_ASKED);
	presence_touch(&presence, 71 * S);
	CHECK(presence.state == PRESENCE_SOMEBODY && at(&presence, 71, false) == PRESENCE_SOMEBODY);
	CHECK(at(&presence, 130, false) == PRESENCE_SOMEBODY &&
	      at(&presence, 131, false) == PRESENCE_ASKED);
}

static void who_reads_has_longer(void **state)
{
	struct presence presence = fresh();

	(void)state;
	presence_touch(&presence, 0);
	CHECK(at(&presence, 179, true) == PRESENCE_SOMEBODY &&
	      at(&presence, 180, true) == PRESENCE_ASKED);
	CHECK(at(&presence, 194, true) == PRESENCE_ASKED &&
	      at(&presence, 195, true) == PRESENCE_NOBODY);
}

static void a_touch_begins_a_visit(void **state)
{
	struct presence presence = fresh();

	(void)state;
	CHECK(at(&presence, 1000, false) == PRESENCE_NOBODY);
	presence_touch(&presence, 1001 * S);
	CHECK(at(&presence, 1001, false) == PRESENCE_SOMEBODY);
	CHECK(presence_left_ms(&presence, 1001 * S) == (IDLE_S * S) + PRESENCE_ASK_MS);
}

/* Whoever only waits as long as he is told, whatever was touched before, is out of every state. */
static void waiting_alone_ends_every_visit(void **state)
{
	uint32_t seed = 7;

	(void)state;
	for (int run = 0; run < 1000; run++) {
		struct presence presence = fresh();
		int64_t now_ms = 0;
		int turns = 0, wait_ms;

		for (int i = 0; i < 20; i++) {
			seed = seed * 1664525 + 1013904223;
			now_ms += seed >> 15;
			if (seed & 64)
				presence_touch(&presence, now_ms);
			presence_step(&presence, now_ms, seed & 128);
		}
		while ((wait_ms = presence_wait_ms(&presence, now_ms)) >= 0) {
			CHECK(++turns < 40);
			now_ms += wait_ms;
			presence_step(&presence, now_ms, presence.reading);
		}
		CHECK(presence.state == PRESENCE_NOBODY);
	}
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(nobody_who_never_touched_is_asked),
		cmocka_unit_test(who_touched_is_asked_and_counted_down),
		cmocka_unit_test(an_answer_keeps_the_visit),
		cmocka_unit_test(who_reads_has_longer),
		cmocka_unit_test(a_touch_begins_a_visit),
		cmocka_unit_test(waiting_alone_ends_every_visit),
	};

	return cmocka_run_group_tests(tests, NULL, NULL);
}
