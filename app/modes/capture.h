/* Writes pictures to files, for people and benchmarks: a list of views, each drawn until it
 * improves no further, or shots at given times of a replay. */
#ifndef GOPURA_APP_MODES_CAPTURE_H
#define GOPURA_APP_MODES_CAPTURE_H

#include "app/kiosk.h"

/* Reads options.views_path or options.shots_path and creates options.capture_dir. *out is owned by
 * the caller; it is NULL if neither path is set. Returns 0; -EINVAL if the file has a fault (logged
 * with its line); -ENOMEM, or what the file system reports (logged). */
must_check int capture_create(struct capture **out, const struct kiosk *kiosk);
void capture_destroy(struct capture *capture); /* NULL is fine */

/* Call it before a frame: sets kiosk->camera to the current view, if views are drawn. */
void capture_aim(struct capture *capture, struct kiosk *kiosk);
/* Call it after each frame: writes the pictures that are due, goes to the next view, and sets
 * kiosk->quit after the last view. Returns 0 or a negative errno (logged). */
must_check int capture_after(struct capture *capture, struct kiosk *kiosk);
/* Counts an object that arrived. */
void capture_object(struct capture *capture);
/* Returns in how many milliseconds it needs a frame or a check; -1: not by time. */
int capture_wait_ms(const struct capture *capture);

#endif
