/* Controls the panel over the day: opening hours, waking it by touch, and the small picture shift
 * against burn-in. Also reports to the service manager that frames reach the panel. */
#include <limits.h>
#include <string.h>
#include <time.h>

#include "app/kiosk.h"
#include "base/clock.h"
#include "base/log.h"
#include "base/service.h"
#include "render/display/shift.h"

enum {
	LOOK_MS = 30000, /* interval of checking the clock: its time or time zone may be changed */
	MINUTE_MS = 60000,
};

/* ---- opening hours */

static bool has_hours(const struct kiosk *kiosk)
{
	struct hours always;

	hours_always(&always);
	return memcmp(&kiosk->options.hours, &always, sizeof(always)) != 0;
}

/* Returns whether the opening hours say closed. A clock that cannot be trusted could switch the
 * panel off by day, so the result is then always open. */
static bool is_closed(const struct kiosk *kiosk)
{
	const time_t now = (time_t)clock_wall_s();
	struct tm local;

	tzset();
	return clock_wall_is_plausible() && localtime_r(&now, &local) &&
	       !hours_open_at(&kiosk->options.hours, &local);
}

/* Returns whether a touch keeps the panel on: it is not switched off in front of a visitor, and a
 * late visitor may wake it. */
static bool was_touched(const struct kiosk *kiosk)
{
	const struct panel *panel = &kiosk->panel;

	return panel->touched_ms != 0 &&
	       clock_now_ms() - panel->touched_ms < (int64_t)kiosk->options.wake_min * MINUTE_MS;
}

static int keep_hours(struct kiosk *kiosk)
{
	struct panel *panel = &kiosk->panel;
	bool asleep;
	int rc;

	if (!has_hours(kiosk))
		return 0;
	if (clock_now_ms() >= panel->look_ms) {
		panel->closed = is_closed(kiosk);
		panel->look_ms = clock_now_ms() + LOOK_MS;
	}
	asleep = panel->closed && !was_touched(kiosk);
	/* A frame that was submitted must reach the panel before it is switched off; a panel that
	 * is not connected need not be. */
	if (asleep == panel->asleep || (asleep && !display_ready(kiosk->display)))
		return 0;
	rc = display_sleep(kiosk->display, asleep);
	panel->asleep = asleep;
	log_info("app", asleep ? "the panel is off" : "the panel is on");
	return rc;
}

static void keep_shift(struct kiosk *kiosk)
{
	struct panel *panel = &kiosk->panel;
	int shift_px[2];

	if (!kiosk->options.shift || kiosk->capture)
		return;
	shift_at(clock_now_ms(), shift_px);
	if (memcmp(shift_px, panel->shift_px, sizeof(shift_px)) == 0)
		return;
	memcpy(panel->shift_px, shift_px, sizeof(shift_px));
	kiosk_redraw(kiosk);
}

bool panel_takes_touch(struct kiosk *kiosk, const struct touch_event *event)
{
	struct panel *panel = &kiosk->panel;
	const uint32_t bit = 1u << event->contact;
	bool taken;

	if (event->phase == TOUCH_DOWN && panel->asleep)
		panel->taken |= bit;
	panel->touched_ms = clock_now_ms();
	taken = (panel->taken & bit) != 0;
	if (event->phase == TOUCH_UP || event->phase == TOUCH_CANCEL)
		panel->taken &= ~bit;
	return taken;
}

/* ---- the service manager */

static int manager_wait_ms(void)
{
	const int64_t due_ms = service_due_ms(), now_ms = clock_now_ms();

	if (due_ms == INT64_MAX)
		return -1;
	return due_ms <= now_ms ? 0 : due_ms - now_ms > INT_MAX ? INT_MAX : (int)(due_ms - now_ms);
}

/* Reports to the service manager that the kiosk works, once what was drawn has come onto the panel.
 * At rest nothing is drawn, so a hung panel would go unnoticed: when a report is due, one more
 * frame is drawn. If nothing can be shown, it is enough that the loop turns. */
static void tell_manager(struct kiosk *kiosk)
{
	const bool dark = display_is_dark(kiosk->display);
	struct panel *panel = &kiosk->panel;

	if (!dark && (kiosk->last_frame_ms == 0 || !display_ready(kiosk->display)))
		return;
	if (panel->well_ms == 0) {
		service_ready();
		panel->well_ms = kiosk->last_frame_ms ? kiosk->last_frame_ms : 1;
	}
	if (clock_now_ms() < service_due_ms())
		return;
	if (dark || kiosk->last_frame_ms > panel->well_ms) {
		service_alive();
		panel->well_ms = dark ? panel->well_ms : kiosk->last_frame_ms;
	} else {
		kiosk_redraw(kiosk);
	}
}

/* ---- the loop */

int panel_turn(struct kiosk *kiosk)
{
	int rc = 0;

	if (display_wait_ms(kiosk->display) == 0)
		rc = display_dispatch(kiosk->display);
	if (rc == 0)
		rc = keep_hours(kiosk);
	keep_shift(kiosk);
	if (display_take_stale(kiosk->display))
		kiosk_redraw(kiosk);
	if (rc == 0 && kiosk->frame_wanted && display_is_dark(kiosk->display))
		rc = frame_unseen(kiosk);
	tell_manager(kiosk);
	return rc;
}

/* Returns in how many milliseconds opening hours or picture shift need a check; -1 if neither is
 * used, so the loop is not woken. */
static int day_wait_ms(const struct kiosk *kiosk)
{
	const int64_t now_ms = clock_now_ms(), look_ms = kiosk->panel.look_ms;
	int wait_ms = -1;

	if (has_hours(kiosk))
		wait_ms = look_ms > now_ms ? (int)(look_ms - now_ms) : 0;
	if (kiosk->options.shift)
		wait_ms = sooner(wait_ms, (int)(SHIFT_STEP_MS - now_ms % SHIFT_STEP_MS));
	return wait_ms;
}

int panel_wait_ms(const struct kiosk *kiosk)
{
	const int display_ms = display_wait_ms(kiosk->display);
	const int due_ms = sooner(display_ms, sooner(manager_wait_ms(), day_wait_ms(kiosk)));

	if (display_is_dark(kiosk->display))
		return sooner(due_ms, session_wait_ms(kiosk));
	return display_ready(kiosk->display) ? due_ms : display_ms;
}
