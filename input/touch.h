/* Fingers on the panel, in panel pixels, from whatever the board has: multitouch screens
 * (protocol B), single-touch absolute devices (old resistive screens, QEMU's tablet), several at
 * once, plugged and unplugged at will; or a replayed file (docs/input.md has its form).
 *
 * One fd and one dispatch call. One thread. */
#ifndef GOPURA_INPUT_TOUCH_H
#define GOPURA_INPUT_TOUCH_H

#include <stdbool.h>
#include <stdint.h>

#include "base/compiler.h"
#include "input/touch_event.h"

struct touch_options {
	int width_px, height_px; /* of the picture as the visitor sees it (after rotation) */
	int rotation_deg;        /* of the panel, clockwise: 0, 90, 180, 270; as the camera's */
	/* Calibration of the raw position, both 0..1, before the rotation:
	 * x' = m[0] x + m[1] y + m[2], y' = m[3] x + m[4] y + m[5]. All zero: what udev knows of
	 * the device. */
	float matrix[6];
	float edge_px;      /* a finger that comes down nearer to the edge is ignored; 0: none */
	float palm_px;      /* a contact larger than this is a palm; 0: none are */
	const char *folder; /* copied; NULL: /dev/input */
	const char *replay_path; /* copied; when set, no device is opened */
	void (*event)(void *data, const struct touch_event *event); /* from touch_dispatch */
	void *data;
};

struct touch;

/* No device yet is not an error: one may be plugged in. *out is owned by the caller; on failure it
 * is NULL. -EINVAL: the replay file is malformed (logged with its line). */
must_check int touch_create(struct touch **out, const struct touch_options *options);
void touch_destroy(struct touch *touch); /* NULL is fine */

/* Readable when touch_dispatch has something to do (an epoll descriptor of its own). */
int touch_fd(const struct touch *touch);
/* Calls event for whatever happened since. Errors of a device are logged and end that device, not
 * the program; negative errno only where waiting itself is broken. */
must_check int touch_dispatch(struct touch *touch);

/* Devices that are open now; NULL: none. */
uint32_t touch_device_count(const struct touch *touch);
/* The index-th of them as people know it, with its ranges; borrowed until the next call. */
const char *touch_device_text(const struct touch *touch, uint32_t index);
/* The replay played its last line (always false for devices). */
bool touch_replay_ended(const struct touch *touch);

#endif
