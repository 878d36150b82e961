/* Functions that all parts of the kiosk use: asking for a frame, watching a descriptor, and
 * converting between the visitor's pixels and the panel's. */
#include "app/kiosk.h"

#include <errno.h>
#include <sys/epoll.h>

void kiosk_redraw(struct kiosk *kiosk)
{
	kiosk->frame_wanted = true;
}

int kiosk_watch(struct kiosk *kiosk, int fd)
{
	struct epoll_event event = { .events = EPOLLIN, .data.fd = fd };

	if (fd < 0)
		return 0;
	return epoll_ctl(kiosk->epoll_fd, EPOLL_CTL_ADD, fd, &event) < 0 ? -errno : 0;
}

/* ---- the viewport */

static bool is_sideways(const struct kiosk *kiosk)
{
	return kiosk->profile.rotation_deg == 90 || kiosk->profile.rotation_deg == 270;
}

int kiosk_width_px(const struct kiosk *kiosk)
{
	return is_sideways(kiosk) ? display_height_px(kiosk->display)
				  : display_width_px(kiosk->display);
}

int kiosk_height_px(const struct kiosk *kiosk)
{
	return is_sideways(kiosk) ? display_width_px(kiosk->display)
				  : display_height_px(kiosk->display);
}

void viewport_to_panel(const struct kiosk *kiosk, float *x_px, float *y_px)
{
	const float width = (float)display_width_px(kiosk->display);
	const float height = (float)display_height_px(kiosk->display);
	const float x = *x_px, y = *y_px;

	switch (kiosk->profile.rotation_deg) {
	case 90:
		*x_px = y;
		*y_px = height - x;
		break;
	case 180:
		*x_px = width - x;
		*y_px = height - y;
		break;
	case 270:
		*x_px = width - y;
		*y_px = x;
		break;
	}
}

void viewport_from_panel(const struct kiosk *kiosk, float *x_px, float *y_px)
{
	const float width = (float)display_width_px(kiosk->display);
	const float height = (float)display_height_px(kiosk->display);
	const float x = *x_px, y = *y_px;

	switch (kiosk->profile.rotation_deg) {
	case 90:
		*x_px = height - y;
		*y_px = x;
		break;
	case 180:
		*x_px = width - x;
		*y_px = height - y;
		break;
	case 270:
		*x_px = y;
		*y_px = width - x;
		break;
	}
}

void viewport_unshift(const struct kiosk *kiosk, float *x_px, float *y_px)
{
	viewport_to_panel(kiosk, x_px, y_px);
	*x_px -= (float)kiosk->panel.shift_px[0];
	*y_px += (float)kiosk->panel.shift_px[1]; /* GL's y axis points up */
	viewport_from_panel(kiosk, x_px, y_px);
}
