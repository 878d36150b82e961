/* Switches the panel on and off by the clock and by touch, shifts the picture, and tells the
 * service manager that all is well. */
#include "app/panel.h"

#include <limits.h>
#include <string.h>
#include <time.h>

#include "base/clock.h"
#include "base/log.h"
#include "base/service.h"
#include "render/display/shift.h"

enum {
	LOOK_MS = 30000, /* interval of checking the clock: its time or time zone may be changed */
	MINUTE_MS = 60000,
};

/* ---- opening hours */

void panel_init(struct panel *panel, const struct panel_options *options)
{
	*panel = (struct panel){ .options = *options };
}

static bool has_hours(const struct panel *panel)
{
	struct hours always;

	hours_always(&always);
	return memcmp(&panel->options.hours, &always, sizeof(always)) != 0;
}

/* Returns whether the opening hours say closed. A clock that cannot be trusted could switch the
 * panel off by day, so the result is then always open. */
static bool is_closed(const struct panel *panel)
{
	const time_t now = (time_t)clock_wall_s();
	struct tm local;

	tzset();
	return clock_wall_is_plausible() && localtime_r(&now, &local) &&
	       !hours_open_at(&panel->options.hours, &local);
}

/* Returns whether a touch keeps the panel on: it is not switched off in front of a visitor, and a
 * late visitor may wake it. */
static bool was_touched(const struct panel *panel)
{
	return panel->touched_ms != 0 &&
	       clock_now_ms() - panel->touched_ms < (int64_t)panel->options.wake_min * MINUTE_MS;
}

static int keep_hours(struct panel *panel)
{
	bool asleep;
	int rc;

	if (!has_hours(panel))
		return 0;
	if (clock_now_ms() >= panel->look_ms) {
		panel->closed = is_closed(panel);
		panel->look_ms = clock_now_ms() + LOOK_MS;
	}
	asleep = panel->closed && !was_touched(panel);
	/* A frame that was submitted must reach the panel before it is switched off; a panel that
	 * is not connected need not be. */
	if (asleep == panel->asleep || (asleep && !display_ready(panel->options.display)))
		return 0;
	rc = display_sleep(panel->options.display, asleep);
	panel->asleep = asleep;
	log_info("app", asleep ? "the panel is off" : "the panel is on");
	return rc;
}

static void keep_shift(struct panel *panel)
{
	int shift_px[2];

	if (!panel->options.shift)
		return;
	shift_at(clock_now_ms(), shift_px);
	if (memcmp(shift_px, panel->options.viewport->shift_px, sizeof(shift_px)) == 0)
		return;
	memcpy(panel->options.viewport->shift_px, shift_px, sizeof(shift_px));
	redraw_ask(panel->options.redraw);
}

bool panel_take_touch(struct panel *panel, const struct touch_event *event)
{
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
static void tell_manager(struct panel *panel, int64_t frame_ms)
{
	const bool dark = display_is_dark(panel->options.display);

	if (!dark && (frame_ms == 0 || !display_ready(panel->options.display)))
		return;
	if (panel->well_ms == 0) {
		service_ready();
		panel->well_ms = frame_ms ? frame_ms : 1;
	}
	if (clock_now_ms() < service_due_ms())
		return;
	if (dark || frame_ms > panel->well_ms) {
		service_alive();
		panel->well_ms = dark ? panel->well_ms : frame_ms;
	} else {
		redraw_ask(panel->options.redraw);
	}
}

/* ---- the loop */

int panel_turn(struct panel *panel, int64_t frame_ms)
{
	int rc = 0;

	if (display_wait_ms(panel->options.display) == 0)
		rc = display_dispatch(panel->options.display);
	if (rc == 0)
		rc = keep_hours(panel);
	keep_shift(panel);
	if (display_take_stale(panel->options.display))
		redraw_ask(panel->options.redraw);
	tell_manager(panel, frame_ms);
	return rc;
}

/* Returns in how many milliseconds opening hours or picture shift need a check; -1 if neither is
 * used, so the loop is not woken. */
static int day_wait_ms(const struct panel *panel)
{
	const int64_t now_ms = clock_now_ms(), look_ms = panel->look_ms;
	int wait_ms = -1;

	if (has_hours(panel))
		wait_ms = look_ms > now_ms ? (int)(look_ms - now_ms) : 0;
	if (panel->options.shift)
		wait_ms = clock_sooner_ms(wait_ms, (int)(SHIFT_STEP_MS - now_ms % SHIFT_STEP_MS));
	return wait_ms;
}

int panel_wait_ms(const struct panel *panel)
{
	const struct display *display = panel->options.display;
	const int display_ms = display_wait_ms(display);

	/* While the display is busy with a frame, only it has something to do. */
	if (!display_is_dark(display) && !display_ready(display))
		return display_ms;
	return clock_sooner_ms(display_ms, clock_sooner_ms(manager_wait_ms(), day_wait_ms(panel)));
}
