/* Private to input: one evdev device, its frames compared with what was known before. */
#ifndef GOPURA_INPUT_TOUCH_DEVICE_H
#define GOPURA_INPUT_TOUCH_DEVICE_H

#include <stdbool.h>
#include <stdint.h>

#include "base/compiler.h"

enum { TOUCH_SLOTS_MAX = 10 };

struct touch_device;

/* A finger in the device's own terms. */
struct touch_raw {
	bool down;
	int id;      /* changes when another finger takes the slot */
	float x, y;  /* 0..1 over the device's range, not turned, not calibrated */
	float major; /* of the contact, in widths of the device; 0: not told */
};

/* -ENODEV: not a touchscreen nor an absolute pointer; other negative errno from opening. *out is
 * owned by the caller. */
must_check int touch_device_open(struct touch_device **out, const char *path);
void touch_device_close(struct touch_device *device); /* NULL is fine */
int touch_device_fd(const struct touch_device *device);
const char *touch_device_path(const struct touch_device *device);
const char *touch_device_name(const struct touch_device *device);
/* Name, ranges and fingers; borrowed until the next call for any device. */
const char *touch_device_describe(const struct touch_device *device);

/* One frame: 1 and the slots filled in; 0: nothing (more) to read; -ENODEV: it is gone. */
must_check int touch_device_read(struct touch_device *device,
				 struct touch_raw slots[TOUCH_SLOTS_MAX], int64_t *time_us);

#endif
