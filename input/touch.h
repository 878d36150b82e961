/* Fingers on the panel, in panel pixels, from whatever devices the board has: multitouch screens
 * (protocol B) and single-touch absolute devices (old resistive screens, QEMU's tablet), several at
 * once, plugged and unplugged at any time; or from a replayed file (docs/input.md has its format).
 *
 * One descriptor and one dispatch call. One thread. */
#ifndef GOPURA_INPUT_TOUCH_H
#define GOPURA_INPUT_TOUCH_H

#include <stdbool.h>
#include <stdint.h>

#include "base/compiler.h"
#include "input/touch_event.h"

struct touch_options {
	int width_px, height_px; /* of the picture as the visitor sees it, after rotation */
	int rotation_deg;        /* of the panel, clockwise: 0, 90, 180, 270; as the camera's */
	/* Calibration of the raw position, both coordinates 0..1, before the rotation: x' = m[0] x
	 * + m[1] y + m[2], y' = m[3] x + m[4] y + m[5]. All zero: use what udev knows of the
	 * device. */
	float matrix[6];
	float edge_px;      /* a finger that comes down nearer to the edge is ignored; 0: none */
	float palm_px;      /* a contact larger than this is a palm; 0: no limit */
	const char *folder; /* copied; NULL: /dev/input */
	const char *replay_path; /* copied; if set, the file is replayed and no device is opened */
	/* called from touch_dispatch; may be NULL */
	void (*event)(void *data, const struct touch_event *event);
	void *data;
};

struct touch;

/* Opens the devices, or the replay. It is no error if there is no device: one may be plugged in
 * later. The caller owns *out; it is NULL on failure. -EINVAL: the replay file is malformed (logged
 * with its line). -ENOMEM, and errors of opening. */
must_check int touch_create(struct touch **out, const struct touch_options *options);
/* Closes all devices. No events are reported. NULL is fine. */
void touch_destroy(struct touch *touch);

/* Returns a descriptor, borrowed, that is readable when touch_dispatch has work (an epoll
 * descriptor of its own). */
int touch_fd(const struct touch *touch);
/* Returns whether touch_dispatch has work; false for NULL. */
bool touch_waits(const struct touch *touch);
/* Calls event for everything that happened. Errors of a device are logged and close that device
 * only; negative errno only where waiting itself fails. */
must_check int touch_dispatch(struct touch *touch);

/* Returns how many devices are open now; 0 for NULL. */
uint32_t touch_device_count(const struct touch *touch);
/* Returns a description of the index-th of them, with its ranges, or "" where there is none;
 * borrowed until the next call. */
const char *touch_device_text(const struct touch *touch, uint32_t index);
/* Returns whether the replay is over (always false for devices). */
bool touch_replay_ended(const struct touch *touch);

#endif
