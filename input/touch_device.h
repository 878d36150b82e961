/* Private to input: one evdev device, read as frames that hold the state of all fingers. */
#ifndef GOPURA_INPUT_TOUCH_DEVICE_H
#define GOPURA_INPUT_TOUCH_DEVICE_H

#include <stdbool.h>
#include <stdint.h>

#include "base/compiler.h"

enum { TOUCH_SLOTS_MAX = 10 };

struct touch_device;

/* A finger in the device's own coordinates. */
struct touch_raw {
	bool down;
	int id;      /* changes when another finger uses the slot */
	float x, y;  /* 0..1 over the device's range, neither rotated nor calibrated */
	float major; /* size of the contact as a share of the device's width; 0: unknown */
};

/* Opens a device. -ENODEV: neither a touchscreen nor an absolute pointer; other negative errno from
 * opening it. The caller owns *out; it is NULL on failure. */
must_check int touch_device_open(struct touch_device **out, const char *path);
void touch_device_close(struct touch_device *device); /* Closes and frees it. NULL is fine. */
/* Returns its descriptor, borrowed: readable when touch_device_read has something. */
int touch_device_fd(const struct touch_device *device);
/* Its path, as opened; borrowed until it is closed. */
const char *touch_device_path(const struct touch_device *device);
/* Its name by the kernel; borrowed until it is closed. */
const char *touch_device_name(const struct touch_device *device);
/* Returns its name, ranges and number of fingers as text; borrowed until the next call for any
 * device. */
const char *touch_device_describe(const struct touch_device *device);

/* Reads one frame. Returns 1 with the slots filled in; 0: nothing (more) to read; -ENODEV: the
 * device is gone. *time_us is the time of the kernel's last event; it is unchanged where a resync
 * brought no event. */
must_check int touch_device_read(struct touch_device *device,
				 struct touch_raw slots[TOUCH_SLOTS_MAX], int64_t *time_us);

#endif
