/* Contacts of a device over minutes: a finger is followed, and what stays on the glass is not. */
#include "input/contacts.h"

#include <string.h>

#include "tests/check.h"

enum { SECOND_US = 1000000 };

static const float as_it_is[6] = { 1, 0, 0, 0, 1, 0 };

static struct touch_event last;
static int heard;

static void note(void *data, const struct touch_event *event)
{
	(void)data;
	last = *event;
	heard++;
}

static struct contacts contacts;
static struct contact_slot slots[TOUCH_SLOTS_MAX];
static struct touch_raw raws[TOUCH_SLOTS_MAX];

static int begin(void **state)
{
	(void)state;
	contacts = (struct contacts){ .width_px = 1000, .height_px = 500, .event = note };
	memset(slots, 0, sizeof(slots));
	memset(raws, 0, sizeof(raws));
	heard = 0;
	return 0;
}

static void lay(int slot, int id, float x)
{
	raws[slot] = (struct touch_raw){ .down = true, .id = id, .x = x, .y = 0.5f };
}

/* Returns how much is heard of a frame. */
static int frame(int64_t time_us)
{
	const int before = heard;

	contacts_take(&contacts, slots, raws, as_it_is, time_us);
	return heard - before;
}

static void what_trembles_on_the_glass_is_no_finger_for_ever(void **state)
{
	int64_t at_us = 50 * SECOND_US;

	(void)state;
	for (int s = 0; s <= CONTACT_LONGEST_S; s++) {
		lay(0, 7, s % 2 ? 0.5f : 0.501f);
		CHECK(frame(at_us) == 1 && last.phase == (s == 0 ? TOUCH_DOWN : TOUCH_MOVE));
		at_us += SECOND_US;
	}
	lay(0, 7, 0.2f);
	CHECK(frame(at_us) == 1 && last.phase == TOUCH_CANCEL && last.contact == 0);
	lay(0, 7, 0.3f);
	CHECK(frame(at_us + SECOND_US) == 0);
	raws[0].down = false;
	CHECK(frame(at_us + 2 * SECOND_US) == 0);
	lay(0, 8, 0.3f); /* a finger on the same place */
	CHECK(frame(at_us + 3 * SECOND_US) == 1 && last.phase == TOUCH_DOWN);
}

/* It need not move: a visitor's finger brings the frame. */
static void a_coin_is_no_second_finger_for_ever(void **state)
{
	int64_t at_us = 50 * SECOND_US;

	(void)state;
	lay(0, 7, 0.5f);
	CHECK(frame(at_us) == 1);
	at_us += (int64_t)(CONTACT_LONGEST_S + 1) * SECOND_US;
	lay(1, 8, 0.2f);
	CHECK(frame(at_us) == 2 && last.phase == TOUCH_DOWN);
	CHECK(slots[0].contact == -1 && slots[1].contact == 0);
	CHECK(contacts_any_down(slots));
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test_setup(what_trembles_on_the_glass_is_no_finger_for_ever, begin),
		cmocka_unit_test_setup(a_coin_is_no_second_finger_for_ever, begin),
	};

	return cmocka_run_group_tests(tests, NULL, NULL);
}
