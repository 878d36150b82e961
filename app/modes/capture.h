/* Pictures for people and benchmarks: a list of views drawn until nothing improves any more, or
 * shots during a replayed visit. */
#ifndef GOPURA_APP_MODES_CAPTURE_H
#define GOPURA_APP_MODES_CAPTURE_H

#include "app/kiosk.h"

/* Reads options.views_path or options.shots_path; *out NULL: neither was asked for. -EINVAL: the
 * file is at fault (logged with its line). */
must_check int capture_create(struct capture **out, const struct kiosk *kiosk);
void capture_destroy(struct capture *capture); /* NULL is fine */

/* Before a frame: sets kiosk->camera where views are drawn. */
void capture_aim(struct capture *capture, struct kiosk *kiosk);
/* After each frame: writes what is due, moves on, sets kiosk->quit after the last. */
must_check int capture_after(struct capture *capture, struct kiosk *kiosk);
/* An object came. */
void capture_object(struct capture *capture);
/* Milliseconds until it has something to do without a frame; -1: not by time. */
int capture_wait_ms(const struct capture *capture);

#endif
