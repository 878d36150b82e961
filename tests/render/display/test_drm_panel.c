/* The panel's life on a card that is played: what drm_card.h and libdrm would answer, and a clock
 * that only the test moves. */
#include "render/display/drm_flip.h"
#include "render/display/drm_panel.h"

#include <errno.h>
#include <string.h>
#include <sys/eventfd.h>
#include <unistd.h>

#include <xf86drm.h>

#include "base/clock.h"
#include "render/display/uevent.h"
#include "tests/check.h"

static int64_t now_ms;
static struct {
	bool connected, plugged_event, uevents, flip_done, master, can_be_master;
	enum drm_card_news news;
	int flip_rc, sleep_rc;
	int flips, mode_sets, looks, sleeps, wakes;
	void *flip_data;
	drmModeConnector connector;
} card;

int64_t clock_now_ms(void)
{
	return now_ms;
}

int64_t clock_now_us(void)
{
	return now_ms * 1000;
}

int drm_card_open(struct drm_card *out, const struct drm_card_options *options)
{
	(void)options;
	*out = (struct drm_card){ .fd = eventfd(0, EFD_CLOEXEC), .connected = card.connected };
	return 0;
}

void drm_card_close(struct drm_card *out)
{
	if (out->fd >= 0)
		close(out->fd);
	out->fd = -1;
}

enum drm_card_news drm_card_look(struct drm_card *out, const struct drm_card_options *options)
{
	(void)out, (void)options;
	card.looks++;
	return card.news;
}

int drm_card_flip(struct drm_card *out, uint32_t fb, bool set_mode, void *data)
{
	(void)out, (void)fb;
	card.flips++;
	card.mode_sets += set_mode;
	card.flip_data = data;
	return card.flip_rc;
}

bool drm_card_is_taken(int rc)
{
	return rc == -EBUSY || rc == -EACCES || rc == -EPERM;
}

int drm_card_sleep(struct drm_card *out)
{
	(void)out;
	card.sleeps++;
	return card.sleep_rc;
}

int drm_card_wake(struct drm_card *out)
{
	(void)out;
	card.wakes++;
	return 0;
}

int uevent_open(void)
{
	return card.uevents ? eventfd(0, EFD_CLOEXEC) : -EPERM;
}

bool uevent_take(int fd)
{
	const bool plugged = card.plugged_event;

	(void)fd;
	card.plugged_event = false;
	return plugged;
}

int drmHandleEvent(int fd, drmEventContextPtr events)
{
	if (card.flip_done)
		events->page_flip_handler(fd, 0, 0, 0, card.flip_data);
	card.flip_done = false;
	return 0;
}

int drmIsMaster(int fd)
{
	(void)fd;
	return card.master;
}

int drmSetMaster(int fd)
{
	(void)fd;
	card.master = card.can_be_master;
	return card.master ? 0 : -1;
}

drmModeConnectorPtr drmModeGetConnectorCurrent(int fd, uint32_t id)
{
	(void)fd, (void)id;
	card.connector.connection = card.connected ? DRM_MODE_CONNECTED : DRM_MODE_DISCONNECTED;
	return &card.connector;
}

void drmModeFreeConnector(drmModeConnectorPtr connector)
{
	(void)connector;
}

/* ---- */

static struct drm_panel panel;

static int begin(void **state)
{
	const struct drm_card_options options = { .device = "/dev/dri/card0" };

	(void)state;
	memset(&card, 0, sizeof(card));
	card.connected = card.uevents = card.master = true;
	card.news = DRM_CARD_SAME_PANEL;
	now_ms = 100000;
	return drm_panel_open(&panel, &options);
}

static int end(void **state)
{
	(void)state;
	drm_panel_close(&panel);
	return 0;
}

static int again(bool uevents, bool connected)
{
	const struct drm_card_options options = { .connector = "HDMI-A-1" };

	drm_panel_close(&panel);
	card.uevents = uevents;
	card.connected = connected;
	return drm_panel_open(&panel, &options);
}

static bool turn(void)
{
	bool flipped;

	CHECK(drm_panel_dispatch(&panel, &flipped) == 0);
	return flipped;
}

static void show(bool expected)
{
	bool shown;

	CHECK(drm_panel_ready(&panel));
	CHECK(drm_panel_show(&panel, 1, &shown) == 0 && shown == expected);
}

static void show_and_flip(void)
{
	show(true);
	card.flip_done = true;
	CHECK(turn());
}

static void sets_the_mode_once(void **state)
{
	(void)state;
	show(true);
	CHECK(!drm_panel_ready(&panel) && !drm_panel_dark(&panel));
	card.flip_done = true;
	CHECK(turn() && drm_panel_ready(&panel));
	show_and_flip();
	CHECK(card.flips == 2 && card.mode_sets == 1);
}

static void a_flip_that_hangs_is_a_fault(void **state)
{
	bool flipped;

	(void)state;
	show_and_flip();
	show(true);
	CHECK(drm_panel_wait_ms(&panel) == 1001);
	now_ms += 1001;
	CHECK(drm_panel_wait_ms(&panel) == 0);
	CHECK(drm_panel_dispatch(&panel, &flipped) == -ETIMEDOUT);
}

static void a_panel_may_take_seconds_to_switch_on(void **state)
{
	bool flipped;

	(void)state;
	show(true);
	for (int i = 0; i < 4; i++) {
		now_ms += 1200;
		CHECK(!turn());
	}
	card.flip_done = true;
	CHECK(turn());
	CHECK(drm_panel_sleep(&panel, true) == 0 && drm_panel_sleep(&panel, false) == 0);
	show(true);
	now_ms += 5001;
	CHECK(drm_panel_dispatch(&panel, &flipped) == -ETIMEDOUT);
}

static void waits_for_a_panel_that_goes_and_comes(void **state)
{
	(void)state;
	show_and_flip();
	card.plugged_event = true;
	card.news = DRM_CARD_NO_PANEL;
	turn();
	CHECK(drm_panel_dark(&panel) && !drm_panel_ready(&panel));
	CHECK(drm_panel_wait_ms(&panel) == 2000);
	for (int i = 0; i < 5; i++) {
		now_ms += 2000;
		turn();
	}
	CHECK(card.looks == 6 && drm_panel_dark(&panel)); /* by the clock, and no oftener */
	card.news = DRM_CARD_SAME_PANEL;
	now_ms += 2000;
	turn();
	CHECK(!drm_panel_dark(&panel) && drm_panel_take_stale(&panel));
	CHECK(!drm_panel_take_stale(&panel));
	show_and_flip();
	CHECK(card.mode_sets == 2);
}

static void starts_without_a_panel(void **state)
{
	(void)state;
	CHECK(again(true, false) == 0);
	CHECK(drm_panel_dark(&panel) && drm_panel_wait_ms(&panel) == 2000);
	now_ms += 2000;
	turn();
	CHECK(!drm_panel_dark(&panel) && drm_panel_take_stale(&panel));
}

static void another_panel_asks_for_another_process(void **state)
{
	bool flipped;

	(void)state;
	show_and_flip();
	card.plugged_event = true;
	card.news = DRM_CARD_OTHER_PANEL;
	CHECK(drm_panel_dispatch(&panel, &flipped) == -ESTALE);
}

static void looks_by_the_clock_where_the_kernel_says_nothing(void **state)
{
	(void)state;
	CHECK(again(false, true) == 0);
	CHECK(drm_panel_wait_ms(&panel) == 5000);
	now_ms += 5000;
	turn();
	CHECK(card.looks == 0 && drm_panel_wait_ms(&panel) == 5000); /* no panel was disturbed */
	card.connected = false;
	card.news = DRM_CARD_NO_PANEL;
	now_ms += 5000;
	turn();
	CHECK(card.looks == 1 && drm_panel_dark(&panel));
}

/* What was under way when the panel went: its second begins when it is back. */
static void a_flip_may_hang_while_the_panel_is_away(void **state)
{
	(void)state;
	show(true);
	card.plugged_event = true;
	card.news = DRM_CARD_NO_PANEL;
	turn();
	now_ms += 60000;
	turn();
	card.news = DRM_CARD_SAME_PANEL;
	now_ms += 2000;
	turn();
	CHECK(!drm_panel_ready(&panel));
	now_ms += 500;
	card.flip_done = true;
	CHECK(turn() && drm_panel_ready(&panel) && drm_panel_take_stale(&panel));
}

static void waits_while_another_program_has_the_panel(void **state)
{
	(void)state;
	show_and_flip();
	card.flip_rc = -EACCES;
	card.master = false;
	show(false);
	for (int i = 0; i < 100; i++) { /* however long it takes */
		CHECK(drm_panel_dark(&panel) && drm_panel_wait_ms(&panel) == 250);
		now_ms += 250;
		turn();
	}
	CHECK(card.flips == 2);
	card.can_be_master = true;
	card.flip_rc = 0;
	now_ms += 250;
	turn();
	CHECK(drm_panel_take_stale(&panel));
	show_and_flip();
	CHECK(card.mode_sets == 2); /* it may have been set to another */
}

static void a_suspend_that_keeps_the_card_busy_passes(void **state)
{
	(void)state;
	show_and_flip();
	card.flip_rc = -EBUSY;
	for (int i = 0; i < 20; i++) {
		show(false);
		now_ms += 250;
		turn();
		CHECK(drm_panel_take_stale(&panel));
	}
	card.flip_rc = 0;
	show_and_flip();
}

/* No other program has it, and a suspended one would not wait: the driver hangs. */
static void a_card_that_is_busy_for_ever_is_a_fault(void **state)
{
	bool shown;
	int rc = 0, tries = 0;

	(void)state;
	show_and_flip();
	card.flip_rc = -EBUSY;
	for (; rc == 0; tries++) {
		CHECK(tries < 300 && drm_panel_ready(&panel));
		rc = drm_panel_show(&panel, 1, &shown);
		now_ms += 250;
		turn();
	}
	CHECK(rc == -EBUSY && tries > 200);
}

/* It was busy when the panel was pulled, and is when it is back. */
static void time_without_a_panel_is_not_busy(void **state)
{
	(void)state;
	show_and_flip();
	card.flip_rc = -EBUSY;
	show(false);
	card.plugged_event = true;
	card.news = DRM_CARD_NO_PANEL;
	turn();
	for (int i = 0; i < 100; i++) {
		now_ms += 2000;
		turn();
	}
	card.news = DRM_CARD_SAME_PANEL;
	now_ms += 2000;
	turn();
	show(false);
	card.flip_rc = 0;
	now_ms += 250;
	turn();
	show_and_flip();
}

static void a_refused_picture_is_tried_with_its_mode(void **state)
{
	(void)state;
	show_and_flip();
	card.flip_rc = -EINVAL;
	show(false);
	CHECK(card.looks == 1 && !drm_panel_ready(&panel));
	now_ms += 250;
	turn();
	CHECK(drm_panel_take_stale(&panel));
	card.flip_rc = 0;
	show_and_flip();
	CHECK(card.mode_sets == 2);
}

static void a_panel_that_refuses_everything_is_a_fault(void **state)
{
	bool shown;

	(void)state;
	card.flip_rc = -EINVAL;
	for (int i = 0; i < 3; i++) {
		show(false);
		now_ms += 250;
		turn();
	}
	CHECK(drm_panel_show(&panel, 1, &shown) == -EINVAL && !shown);
}

static void a_refusal_for_want_of_a_panel_is_no_fault(void **state)
{
	(void)state;
	show_and_flip();
	card.flip_rc = -EINVAL;
	card.news = DRM_CARD_NO_PANEL;
	show(false);
	CHECK(drm_panel_dark(&panel));
}

/* Its last picture finds out before an event does. */
static void a_card_that_is_gone_asks_for_another_process(void **state)
{
	bool shown;

	(void)state;
	show_and_flip();
	card.flip_rc = -ENODEV;
	card.news = DRM_CARD_OTHER_PANEL;
	CHECK(drm_panel_show(&panel, 1, &shown) == -ESTALE && !shown);
}

/* Many a panel lets go of its connector while it sleeps. */
static void sleeps_and_wakes_with_its_mode(void **state)
{
	(void)state;
	show_and_flip();
	CHECK(drm_panel_sleep(&panel, true) == 0 && drm_panel_sleep(&panel, true) == 0);
	CHECK(card.sleeps == 1 && drm_panel_dark(&panel) && drm_panel_wait_ms(&panel) == -1);
	card.plugged_event = true;
	card.news = DRM_CARD_NO_PANEL;
	now_ms += 100000;
	turn();
	CHECK(card.looks == 0);
	card.news = DRM_CARD_SAME_PANEL;
	CHECK(drm_panel_sleep(&panel, false) == 0);
	CHECK(card.wakes == 1 && drm_panel_take_stale(&panel));
	show_and_flip();
	CHECK(card.mode_sets == 2);
}

/* It may sleep so deeply that only a signal wakes it. */
static void a_panel_that_went_in_its_sleep_gets_a_signal(void **state)
{
	(void)state;
	show_and_flip();
	CHECK(drm_panel_sleep(&panel, true) == 0);
	card.connected = false;
	card.news = DRM_CARD_NO_PANEL;
	CHECK(drm_panel_sleep(&panel, false) == 0);
	CHECK(!drm_panel_dark(&panel) && drm_panel_take_stale(&panel));
	show_and_flip();
	CHECK(card.mode_sets == 2);
	now_ms += 5000;
	turn();
	CHECK(drm_panel_dark(&panel) && drm_panel_wait_ms(&panel) == 2000);
}

static void a_panel_that_a_signal_woke_has_its_mode_set(void **state)
{
	(void)state;
	for (int by_event = 0; by_event < 2; by_event++) {
		show_and_flip();
		CHECK(drm_panel_sleep(&panel, true) == 0);
		card.connected = false;
		card.news = DRM_CARD_NO_PANEL;
		CHECK(drm_panel_sleep(&panel, false) == 0);
		show_and_flip();
		card.mode_sets = 0;
		card.connected = true;
		card.news = DRM_CARD_SAME_PANEL;
		card.plugged_event = by_event;
		now_ms += by_event ? 1000 : 5000;
		turn();
		CHECK(drm_panel_take_stale(&panel));
		show_and_flip();
		CHECK(card.mode_sets == 1);
		now_ms += 5000;
		turn();
		CHECK(!drm_panel_take_stale(&panel)); /* once */
	}
}

static void wakes_to_another_panel(void **state)
{
	(void)state;
	show_and_flip();
	CHECK(drm_panel_sleep(&panel, true) == 0);
	card.news = DRM_CARD_OTHER_PANEL;
	CHECK(drm_panel_sleep(&panel, false) == -ESTALE);
}

static void a_flip_may_hang_for_want_of_a_panel(void **state)
{
	(void)state;
	show_and_flip();
	show(true);
	card.connected = false; /* of which there was no event */
	card.news = DRM_CARD_NO_PANEL;
	now_ms += 1001;
	turn();
	CHECK(drm_panel_dark(&panel));
}

static void says_when_a_panel_cannot_sleep(void **state)
{
	(void)state;
	card.sleep_rc = -EOPNOTSUPP;
	CHECK(drm_panel_sleep(&panel, true) == -EOPNOTSUPP && drm_panel_dark(&panel));
}

static void decides_after_a_look(void **state)
{
	const enum drm_card_news same = DRM_CARD_SAME_PANEL;

	(void)state;
	CHECK(drm_panel_after_look(same, false, false, false) == DRM_PANEL_GO_ON);
	CHECK(drm_panel_after_look(same, false, false, true) == DRM_PANEL_SET_MODE);
	CHECK(drm_panel_after_look(same, true, false, false) == DRM_PANEL_SET_MODE);
	CHECK(drm_panel_after_look(DRM_CARD_NO_PANEL, true, true, true) == DRM_PANEL_WAIT);
	CHECK(drm_panel_after_look(DRM_CARD_OTHER_PANEL, true, true, true) == DRM_PANEL_ANEW);
}

int main(void)
{
#define CASE(name) cmocka_unit_test_setup_teardown(name, begin, end)
	const struct CMUnitTest tests[] = {
		CASE(sets_the_mode_once),
		CASE(a_flip_that_hangs_is_a_fault),
		CASE(a_panel_may_take_seconds_to_switch_on),
		CASE(waits_for_a_panel_that_goes_and_comes),
		CASE(starts_without_a_panel),
		CASE(another_panel_asks_for_another_process),
		CASE(looks_by_the_clock_where_the_kernel_says_nothing),
		CASE(a_flip_may_hang_while_the_panel_is_away),
		CASE(waits_while_another_program_has_the_panel),
		CASE(a_suspend_that_keeps_the_card_busy_passes),
		CASE(a_card_that_is_busy_for_ever_is_a_fault),
		CASE(time_without_a_panel_is_not_busy),
		CASE(a_refused_picture_is_tried_with_its_mode),
		CASE(a_panel_that_refuses_everything_is_a_fault),
		CASE(a_refusal_for_want_of_a_panel_is_no_fault),
		CASE(a_card_that_is_gone_asks_for_another_process),
		CASE(sleeps_and_wakes_with_its_mode),
		CASE(a_panel_that_went_in_its_sleep_gets_a_signal),
		CASE(a_panel_that_a_signal_woke_has_its_mode_set),
		CASE(wakes_to_another_panel),
		CASE(a_flip_may_hang_for_want_of_a_panel),
		CASE(says_when_a_panel_cannot_sleep),
		CASE(decides_after_a_look),
	};

	return cmocka_run_group_tests(tests, NULL, NULL);
}
