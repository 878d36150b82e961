/* Whether a visitor is there, over time. */
#include "app/visit/presence.h"

#include "tests/check.h"

enum { IDLE_S = 60, S = 1000 };

static struct visit fresh(void)
{
	struct visit visit;

	visit_init(&visit, IDLE_S, 0);
	return visit;
}

static enum visit_state at(struct visit *visit, int64_t s, bool reading)
{
	visit_step(visit, s * S, reading);
	return visit->state;
}

static void nobody_who_never_touched_is_asked(void **state)
{
	struct visit visit = fresh();

	(void)state;
	CHECK(at(&visit, 59, false) == VISIT_SOMEBODY);
	CHECK(visit_wait_ms(&visit, 59 * S) == S);
	CHECK(at(&visit, 60, false) == VISIT_NOBODY);
	CHECK(visit_wait_ms(&visit, 60 * S) == -1 && visit_left_ms(&visit, 60 * S) == 0);
}

static void who_touched_is_asked_and_counted_down(void **state)
{
	struct visit visit = fresh();

	(void)state;
	visit_touch(&visit, 10 * S);
	CHECK(at(&visit, 69, false) == VISIT_SOMEBODY && visit_asked_s(&visit, 69 * S) == -1);
	CHECK(at(&visit, 70, false) == VISIT_ASKED && visit_asked_s(&visit, 70 * S) == 15);
	CHECK(visit_asked_s(&visit, 70 * S + 1) == 15 && visit_asked_s(&visit, 71 * S) == 14);
	CHECK(visit_asked_s(&visit, 85 * S - 1) == 1);
	CHECK(at(&visit, 84, false) == VISIT_ASKED);
	CHECK(at(&visit, 85, false) == VISIT_NOBODY && !visit.touched);
}

static void an_answer_keeps_the_visit(void **state)
{
	struct visit visit = fresh();

	(void)state;
	visit_touch(&visit, 0);
	CHECK(at(&visit, 70, false) == VISIT_ASKED);
	visit_touch(&visit, 71 * S);
	CHECK(visit.state == VISIT_SOMEBODY && at(&visit, 71, false) == VISIT_SOMEBODY);
	CHECK(at(&visit, 130, false) == VISIT_SOMEBODY && at(&visit, 131, false) == VISIT_ASKED);
}

static void who_reads_has_longer(void **state)
{
	struct visit visit = fresh();

	(void)state;
	visit_touch(&visit, 0);
	CHECK(at(&visit, 179, true) == VISIT_SOMEBODY && at(&visit, 180, true) == VISIT_ASKED);
	CHECK(at(&visit, 194, true) == VISIT_ASKED && at(&visit, 195, true) == VISIT_NOBODY);
}

static void a_touch_begins_a_visit(void **state)
{
	struct visit visit = fresh();

	(void)state;
	CHECK(at(&visit, 1000, false) == VISIT_NOBODY);
	visit_touch(&visit, 1001 * S);
	CHECK(at(&visit, 1001, false) == VISIT_SOMEBODY);
	CHECK(visit_left_ms(&visit, 1001 * S) == (IDLE_S * S) + VISIT_ASK_MS);
}

/* Whoever only waits as long as he is told, whatever was touched before, is out of every state. */
static void waiting_alone_ends_every_visit(void **state)
{
	uint32_t seed = 7;

	(void)state;
	for (int run = 0; run < 1000; run++) {
		struct visit visit = fresh();
		int64_t now_ms = 0;
		int turns = 0, wait_ms;

		for (int i = 0; i < 20; i++) {
			seed = seed * 1664525 + 1013904223;
			now_ms += seed >> 15;
			if (seed & 64)
				visit_touch(&visit, now_ms);
			visit_step(&visit, now_ms, seed & 128);
		}
		while ((wait_ms = visit_wait_ms(&visit, now_ms)) >= 0) {
			CHECK(++turns < 40);
			now_ms += wait_ms;
			visit_step(&visit, now_ms, visit.reading);
		}
		CHECK(visit.state == VISIT_NOBODY);
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
