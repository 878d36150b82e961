/* Tests whether a new release works: it is on trial from when it is first shown. If its picture
 * does not appear, the kiosk falls back to the release before it. */
#include "app/kiosk.h"
#include "app/release/updater.h"
#include "base/clock.h"

enum {
	PROVEN_MS = 10000, /* visible for so long without a crash: it works */
	BLANK_MS = 60000,  /* everything wanted has arrived, but nothing is visible */
};

static int left_ms(int64_t since_ms, int64_t most_ms)
{
	const int64_t left = since_ms + most_ms - clock_now_ms();

	return left > 0 ? (int)left : 0;
}

bool trial_is_broken(const struct session *session)
{
	return session->scene &&
	       (scene_refused(session->scene) > 0 || information_view_broken(session->view));
}

/* Returns whether nothing is visible although nothing more is wanted. While objects are wanted the
 * network may be down, which is no fault of the release. */
static bool is_blank(const struct kiosk *kiosk)
{
	return kiosk->shown.scene && kiosk->shown.frame.patches == 0 && kiosk->shown.root_here &&
	       kiosk->wants.said_count == 0;
}

void trial_watch(struct kiosk *kiosk)
{
	struct session *shown = &kiosk->shown;

	if (!updater_on_trial(kiosk->updater) || shown->shown_ms == 0)
		return;
	if (shown->frame.patches > 0 && shown->pictured_ms == 0 &&
	    kiosk->last_frame_ms >= shown->shown_ms && !display_is_dark(kiosk->display))
		shown->pictured_ms = kiosk->last_frame_ms;
	if (shown->pictured_ms > 0 && left_ms(shown->pictured_ms, PROVEN_MS) == 0)
		updater_prove(kiosk->updater);
	else if (!updater_has_before(kiosk->updater) || kiosk->coming.scene)
		return;
	else if (shown->frame.patches == 0 && trial_is_broken(shown))
		updater_fall_back(kiosk->updater, "objects of it cannot be decoded");
	else if (is_blank(kiosk) && left_ms(shown->shown_ms, BLANK_MS) == 0)
		updater_fall_back(kiosk->updater, "nothing of it was to be seen for a minute");
}

int trial_wait_ms(const struct kiosk *kiosk)
{
	const struct session *shown = &kiosk->shown;

	if (!updater_on_trial(kiosk->updater) || shown->shown_ms == 0)
		return -1;
	if (shown->pictured_ms > 0)
		return left_ms(shown->pictured_ms, PROVEN_MS);
	if (updater_has_before(kiosk->updater) && !kiosk->coming.scene && is_blank(kiosk))
		return left_ms(shown->shown_ms, BLANK_MS);
	return -1;
}
