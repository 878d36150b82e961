/* Reads an evdev device through libevdev. libevdev keeps the state of every slot and repairs it
 * after SYN_DROPPED, so a frame is read as a state, not as a list of events: whatever was lost, the
 * next frame is right. */
#include "input/touch_device.h"

#include <errno.h>
#include <fcntl.h>
#include <libevdev/libevdev.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>
#include <unistd.h>

#include "base/log.h"

struct axis {
	unsigned code;
	int minimum, maximum;
};

struct touch_device {
	char *path;
	int fd;
	struct libevdev *evdev;
	bool multitouch, syncing;
	int slot_count;
	struct axis x, y;
	unsigned button; /* single touch: the button that means contact */
	bool was_down;
	int presses; /* single touch: counts contacts, in place of tracking ids */
};

static bool read_axis(struct touch_device *device, unsigned code, struct axis *out)
{
	if (!libevdev_has_event_code(device->evdev, EV_ABS, code))
		return false;
	out->code = code;
	out->minimum = libevdev_get_abs_minimum(device->evdev, code);
	out->maximum = libevdev_get_abs_maximum(device->evdev, code);
	if (out->maximum <= out->minimum)
		log_warn("input",
			 "board bug: %s (%s) has axis %s from %d to %d, which is not a range",
			 touch_device_name(device), device->path,
			 libevdev_event_code_get_name(EV_ABS, code), out->minimum, out->maximum);
	return out->maximum > out->minimum;
}

/* Touchpads move a pointer and joysticks steer: they are not the panel. */
static bool is_something_else(const struct libevdev *evdev)
{
	return (libevdev_has_property(evdev, INPUT_PROP_POINTER) &&
		libevdev_has_event_code(evdev, EV_KEY, BTN_TOOL_FINGER)) ||
	       libevdev_has_property(evdev, INPUT_PROP_ACCELEROMETER) ||
	       libevdev_has_event_code(evdev, EV_KEY, BTN_JOYSTICK) ||
	       libevdev_has_event_code(evdev, EV_KEY, BTN_GAMEPAD);
}

static int recognise(struct touch_device *device)
{
	struct libevdev *evdev = device->evdev;

	if (is_something_else(evdev))
		return -ENODEV;
	device->slot_count = libevdev_get_num_slots(evdev);
	if (device->slot_count > 0 && read_axis(device, ABS_MT_POSITION_X, &device->x) &&
	    read_axis(device, ABS_MT_POSITION_Y, &device->y)) {
		device->multitouch = true;
		if (device->slot_count > TOUCH_SLOTS_MAX)
			device->slot_count = TOUCH_SLOTS_MAX;
		return 0;
	}
	if (!read_axis(device, ABS_X, &device->x) || !read_axis(device, ABS_Y, &device->y))
		return -ENODEV;
	if (libevdev_has_event_code(evdev, EV_KEY, BTN_TOUCH))
		device->button = BTN_TOUCH;
	else if (libevdev_has_event_code(evdev, EV_KEY, BTN_LEFT))
		device->button = BTN_LEFT; /* the tablet of a virtual machine */
	else
		return -ENODEV;
	device->slot_count = 1;
	return 0;
}

/* Logs a message of libevdev, which reports when a kernel driver breaks the protocol and then does
 * what is safest. */
static void hear_libevdev(const struct libevdev *evdev, enum libevdev_log_priority priority,
			  void *data, const char *file, int line, const char *function,
			  const char *format, va_list args)
{
	char text[200];

	(void)data;
	(void)file;
	(void)line;
	(void)function;
	vsnprintf(text, sizeof(text), format, args);
	text[strcspn(text, "\n")] = 0;
	if (priority == LIBEVDEV_LOG_ERROR)
		log_warn("input", "kernel bug: %s: %s", libevdev_get_name(evdev), text);
}

int touch_device_open(struct touch_device **out, const char *path)
{
	struct touch_device *device = calloc(1, sizeof(*device));
	int rc = 0;

	*out = NULL;
	if (!device)
		return -ENOMEM;
	device->path = strdup(path);
	device->fd = open(path, O_RDONLY | O_NONBLOCK | O_CLOEXEC);
	if (!device->path)
		rc = -ENOMEM;
	else if (device->fd < 0)
		rc = -errno;
	else
		rc = libevdev_new_from_fd(device->fd, &device->evdev);
	if (rc == 0)
		rc = recognise(device);
	if (rc < 0) {
		touch_device_close(device);
		return rc;
	}
	/* Without the monotonic clock the kernel uses its wall clock, which is acceptable: only
	 * time differences count. */
	if (libevdev_set_clock_id(device->evdev, CLOCK_MONOTONIC) < 0)
		log_debug("input", "%s: keeps its timestamps in wall-clock time", path);
	libevdev_set_device_log_function(device->evdev, hear_libevdev, LIBEVDEV_LOG_ERROR, NULL);
	*out = device;
	return 0;
}

void touch_device_close(struct touch_device *device)
{
	if (!device)
		return;
	libevdev_free(device->evdev);
	if (device->fd >= 0)
		close(device->fd);
	free(device->path);
	free(device);
}

int touch_device_fd(const struct touch_device *device)
{
	return device->fd;
}

const char *touch_device_path(const struct touch_device *device)
{
	return device->path;
}

const char *touch_device_name(const struct touch_device *device)
{
	return libevdev_get_name(device->evdev);
}

const char *touch_device_describe(const struct touch_device *device)
{
	static char text[256];

	snprintf(text, sizeof(text), "%s: %d..%d x %d..%d, %d finger%s", touch_device_name(device),
		 device->x.minimum, device->x.maximum, device->y.minimum, device->y.maximum,
		 device->slot_count, device->slot_count == 1 ? "" : "s");
	return text;
}

static float fraction(const struct axis *axis, int value)
{
	float at = (float)(value - axis->minimum) / (float)(axis->maximum - axis->minimum);

	return at < 0 ? 0 : at > 1 ? 1 : at;
}

static void take_slots(const struct touch_device *device, struct touch_raw *slots)
{
	for (int i = 0; i < device->slot_count; i++) {
		unsigned slot = (unsigned)i;
		int id = libevdev_get_slot_value(device->evdev, slot, ABS_MT_TRACKING_ID);
		int x = libevdev_get_slot_value(device->evdev, slot, device->x.code);
		int y = libevdev_get_slot_value(device->evdev, slot, device->y.code);
		int major = libevdev_get_slot_value(device->evdev, slot, ABS_MT_TOUCH_MAJOR);

		slots[i] = (struct touch_raw){ .down = id >= 0,
					       .id = id,
					       .x = fraction(&device->x, x),
					       .y = fraction(&device->y, y),
					       .major = (float)major / (float)(device->x.maximum -
									       device->x.minimum) };
	}
}

static void take_single(struct touch_device *device, struct touch_raw *slots)
{
	bool down = libevdev_get_event_value(device->evdev, EV_KEY, device->button) != 0;

	if (down && !device->was_down)
		device->presses++;
	device->was_down = down;
	slots[0] = (struct touch_raw){
		.down = down,
		.id = device->presses,
		.x = fraction(&device->x,
			      libevdev_get_event_value(device->evdev, EV_ABS, device->x.code)),
		.y = fraction(&device->y,
			      libevdev_get_event_value(device->evdev, EV_ABS, device->y.code)),
	};
}

static void take_frame(struct touch_device *device, struct touch_raw *slots)
{
	memset(slots, 0, TOUCH_SLOTS_MAX * sizeof(*slots));
	if (device->multitouch)
		take_slots(device, slots);
	else
		take_single(device, slots);
}

int touch_device_read(struct touch_device *device, struct touch_raw slots[TOUCH_SLOTS_MAX],
		      int64_t *time_us)
{
	struct input_event event;

	for (;;) {
		unsigned flag =
			device->syncing ? LIBEVDEV_READ_FLAG_SYNC : LIBEVDEV_READ_FLAG_NORMAL;
		int status = libevdev_next_event(device->evdev, flag, &event);

		if (status == LIBEVDEV_READ_STATUS_SYNC && !device->syncing) {
			/* The kernel dropped events: read the present state, then continue. */
			device->syncing = true;
			continue;
		}
		if (status == -EAGAIN && device->syncing) {
			device->syncing = false;
			take_frame(device, slots);
			return 1;
		}
		if (status == -EAGAIN || status == -EINTR)
			return 0;
		if (status < 0)
			return -ENODEV;
		*time_us = (int64_t)event.input_event_sec * 1000000 + event.input_event_usec;
		if (device->syncing || event.type != EV_SYN || event.code != SYN_REPORT)
			continue;
		take_frame(device, slots);
		return 1;
	}
}
