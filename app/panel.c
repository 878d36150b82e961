#include "app/panel.h"

#include <limits.h>

#include "app/kiosk.h"
#include "base/clock.h"
#include "base/log.h"
#include "base/service.h"

static int manager_wait_ms(void)
{
	const int64_t due_ms = service_due_ms(), now_ms = clock_now_ms();

	if (due_ms == INT64_MAX)
		return -1;
	return due_ms <= now_ms ? 0 : due_ms - now_ms > INT_MAX ? INT_MAX : (int)(due_ms - now_ms);
}

/* The terminal is well when what was drawn has come onto the panel. At rest nothing is drawn, and a
 * panel that hangs would not be noticed: then what is shown is drawn once more. Where nothing can
 * be shown, it is enough that the loop turns. */
static void tell_manager(struct kiosk *kiosk)
{
	const bool dark = display_is_dark(kiosk->display);

	if (!dark && (kiosk->last_frame_ms == 0 || !display_ready(kiosk->display)))
		return;
	if (kiosk->well_ms == 0) {
		service_ready();
		kiosk->well_ms = kiosk->last_frame_ms ? kiosk->last_frame_ms : 1;
	}
	if (clock_now_ms() < service_due_ms())
		return;
	if (dark || kiosk->last_frame_ms > kiosk->well_ms) {
		service_alive();
		kiosk->well_ms = dark ? kiosk->well_ms : kiosk->last_frame_ms;
	} else {
		kiosk_redraw(kiosk);
	}
}

int panel_turn(struct kiosk *kiosk)
{
	int rc = 0;

	if (display_wait_ms(kiosk->display) == 0)
		rc = display_dispatch(kiosk->display);
	if (display_take_stale(kiosk->display))
		kiosk_redraw(kiosk);
	if (rc == 0 && kiosk->frame_wanted && display_is_dark(kiosk->display))
		rc = frame_unseen(kiosk);
	tell_manager(kiosk);
	return rc;
}

int panel_wait_ms(const struct kiosk *kiosk)
{
	const int display_ms = display_wait_ms(kiosk->display);

	if (display_is_dark(kiosk->display))
		return sooner(display_ms, sooner(manager_wait_ms(), exhibit_wait_ms(kiosk)));
	return display_ready(kiosk->display) ? sooner(display_ms, manager_wait_ms()) : display_ms;
}
