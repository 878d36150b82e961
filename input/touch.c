/* Watches the input folder for devices, reads and calibrates those that are touchscreens, and plays
 * recorded touches. */
#include "input/touch.h"

#include <dirent.h>
#include <errno.h>
#include <limits.h>
#include <poll.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/epoll.h>
#include <sys/inotify.h>
#include <sys/timerfd.h>
#include <unistd.h>

#include "base/bytes.h"
#include "base/clock.h"
#include "base/log.h"
#include "input/calibration.h"
#include "input/contacts.h"
#include "input/touch_device.h"
#include "input/touch_replay.h"

enum {
	DEVICES_MAX = 8,
	READY_MAX = 16,
	REPLAY_BYTES_MAX = 16 << 20,
};

struct source {
	struct touch_device *device; /* NULL: this entry is free */
	float matrix[6];             /* calibration */
	bool matrix_is_known;        /* known: udev need not be asked again */
	struct contact_slot slots[TOUCH_SLOTS_MAX];
};

struct touch {
	/* folder and replay_path here are not used; see the copies below */
	struct touch_options options;
	char *folder, *replay_path;
	bool is_calibrated; /* calibrated by the options: udev is not asked */
	int epoll_fd, inotify_fd, timer_fd;
	int folder_watch; /* inotify watch of the folder; -1 while it is missing */
	int parent_watch; /* of its parent while the folder is missing, else -1 */
	struct source sources[DEVICES_MAX];
	struct contacts contacts;
	struct touch_replay replay;
	size_t replayed; /* number of events played */
	int64_t replay_start_us;
};

static const float no_calibration[6] = { 1, 0, 0, 0, 1, 0 };

/* ---- devices that come and go ---- */

static void calibrate(const struct touch *touch, struct source *source)
{
	int rc;

	if (source->matrix_is_known)
		return;
	if (touch->is_calibrated) {
		memcpy(source->matrix, touch->options.matrix, sizeof(source->matrix));
		rc = 0;
	} else {
		memcpy(source->matrix, no_calibration, sizeof(source->matrix));
		rc = calibration_read(touch_device_path(source->device), source->matrix);
	}
	if (rc > 0)
		log_info("input", "%s is calibrated by udev", touch_device_name(source->device));
	source->matrix_is_known = rc >= 0;
}

static int watch(struct touch *touch, int fd, struct source *source)
{
	struct epoll_event event = { .events = EPOLLIN, .data.ptr = source };

	return epoll_ctl(touch->epoll_fd, EPOLL_CTL_ADD, fd, &event) < 0 ? -errno : 0;
}

static void remove_source(struct touch *touch, struct source *source)
{
	log_info("input", "%s (%s) was removed", touch_device_name(source->device),
		 touch_device_path(source->device));
	contacts_cancel(&touch->contacts, source->slots, clock_now_us());
	epoll_ctl(touch->epoll_fd, EPOLL_CTL_DEL, touch_device_fd(source->device), NULL);
	touch_device_close(source->device);
	*source = (struct source){ 0 };
}

static bool is_open(const struct touch *touch, const char *path)
{
	for (int i = 0; i < DEVICES_MAX; i++)
		if (touch->sources[i].device &&
		    strcmp(touch_device_path(touch->sources[i].device), path) == 0)
			return true;
	return false;
}

/* Opens a device if it is a touchscreen. One that may not be opened yet is reported again by
 * inotify when its permissions change. */
static void try_device(struct touch *touch, const char *name)
{
	struct source *source = NULL;
	char path[PATH_MAX];

	if (strncmp(name, "event", 5) != 0 ||
	    snprintf(path, sizeof(path), "%s/%s", touch->folder, name) >= (int)sizeof(path) ||
	    is_open(touch, path))
		return;
	for (int i = 0; i < DEVICES_MAX && !source; i++)
		if (!touch->sources[i].device)
			source = &touch->sources[i];
	if (!source || touch_device_open(&source->device, path) < 0)
		return;
	if (watch(touch, touch_device_fd(source->device), source) < 0) {
		log_error("input", "%s: cannot be watched: %s", path, strerror(errno));
		touch_device_close(source->device);
		source->device = NULL;
		return;
	}
	log_info("input", "%s (%s) is connected", touch_device_name(source->device), path);
	calibrate(touch, source);
}

static void scan(struct touch *touch)
{
	DIR *folder = opendir(touch->folder);
	struct dirent *entry;

	if (!folder)
		return;
	while ((entry = readdir(folder)))
		try_device(touch, entry->d_name);
	closedir(folder);
}

static bool watch_devices(struct touch *touch)
{
	touch->folder_watch = inotify_add_watch(touch->inotify_fd, touch->folder,
						IN_CREATE | IN_ATTRIB | IN_MOVED_TO);
	return touch->folder_watch >= 0;
}

static void watch_parent(struct touch *touch)
{
	char parent[PATH_MAX];

	snprintf(parent, sizeof(parent), "%s", touch->folder);
	if (strrchr(parent, '/'))
		strrchr(parent, '/')[1] = 0;
	touch->parent_watch = inotify_add_watch(touch->inotify_fd, parent, IN_CREATE | IN_MOVED_TO);
	if (touch->parent_watch < 0)
		log_warn("input",
			 "%s cannot be watched (%s), so devices plugged in later are not found",
			 touch->folder, strerror(errno));
}

/* Where there is no input device /dev/input may be missing, or be removed: then its parent is
 * watched. */
static void watch_folder(struct touch *touch)
{
	if (touch->parent_watch >= 0)
		inotify_rm_watch(touch->inotify_fd, touch->parent_watch);
	touch->parent_watch = -1;
	if (!watch_devices(touch)) {
		watch_parent(touch);
		if (!watch_devices(touch)) /* it may have come meanwhile */
			return;
	}
	scan(touch);
}

static void read_source(struct touch *touch, struct source *source)
{
	struct touch_raw slots[TOUCH_SLOTS_MAX];
	int64_t time_us = clock_now_us(); /* used for a frame that only a resync completed */
	int rc;

	if (!source->device)
		return; /* it was removed in this same dispatch */
	while ((rc = touch_device_read(source->device, slots, &time_us)) > 0) {
		/* the calibration may change while no finger is down */
		if (!contacts_any_down(source->slots))
			calibrate(touch, source);
		contacts_take(&touch->contacts, source->slots, slots, source->matrix, time_us);
	}
	if (rc < 0)
		remove_source(touch, source);
}

/* Returns whether the folder was removed, or may have come: then it is watched anew. */
static bool concerns_folder(const struct touch *touch, const struct inotify_event *event)
{
	if (event->mask & IN_Q_OVERFLOW)
		return true; /* events were lost */
	if (event->mask & IN_IGNORED)
		return event->wd == touch->folder_watch;
	return event->wd == touch->parent_watch;
}

static void read_changes(struct touch *touch)
{
	union {
		struct inotify_event event;
		char bytes[4096];
	} buffer;
	bool watch_anew = false;
	ssize_t size;

	while ((size = read(touch->inotify_fd, buffer.bytes, sizeof(buffer.bytes))) > 0) {
		for (ssize_t at = 0; at < size;) {
			struct inotify_event event;

			memcpy(&event, buffer.bytes + at, sizeof(event));
			watch_anew |= concerns_folder(touch, &event);
			if (event.len > 0 && event.wd != touch->parent_watch)
				try_device(touch, buffer.bytes + at + sizeof(event));
			at += (ssize_t)(sizeof(event) + event.len);
		}
	}
	if (watch_anew)
		watch_folder(touch);
}

/* ---- replay ---- */

static void arm_timer(struct touch *touch)
{
	int64_t wait_us;
	struct itimerspec when = { 0 };

	if (touch->replayed == touch->replay.count)
		return;
	wait_us = touch->replay_start_us + touch->replay.events[touch->replayed].time_us -
		  clock_now_us();
	if (wait_us < 1)
		wait_us = 1; /* zero would disarm the timer */
	when.it_value.tv_sec = wait_us / 1000000;
	when.it_value.tv_nsec = wait_us % 1000000 * 1000;
	timerfd_settime(touch->timer_fd, 0, &when, NULL);
}

static void play(struct touch *touch)
{
	int64_t now_us = clock_now_us() - touch->replay_start_us;
	uint64_t expired;

	while (read(touch->timer_fd, &expired, sizeof(expired)) > 0)
		continue;
	while (touch->replayed < touch->replay.count &&
	       touch->replay.events[touch->replayed].time_us <= now_us) {
		const struct touch_event *event = &touch->replay.events[touch->replayed++];

		if (touch->options.event)
			touch->options.event(touch->options.data, event);
	}
	arm_timer(touch);
}

static int open_replay(struct touch *touch)
{
	struct buffer text;
	unsigned line = 0;
	int rc;

	buffer_init(&text, REPLAY_BYTES_MAX);
	rc = buffer_read_file(&text, touch->replay_path);
	if (rc < 0)
		log_error("input", "%s: %s", touch->replay_path, strerror(-rc));
	else
		rc = touch_replay_parse(&touch->replay, buffer_bytes(&text),
					touch->options.width_px, touch->options.height_px, &line);
	if (rc == -EINVAL)
		log_error("input",
			  "%s:%u: write \"t_ms down|move|up|cancel slot x y\", times rising, down "
			  "before move and up",
			  touch->replay_path, line);
	buffer_finish(&text);
	if (rc < 0)
		return rc;
	touch->timer_fd = timerfd_create(CLOCK_MONOTONIC, TFD_NONBLOCK | TFD_CLOEXEC);
	if (touch->timer_fd < 0)
		return -errno;
	touch->replay_start_us = clock_now_us();
	arm_timer(touch);
	return watch(touch, touch->timer_fd, NULL);
}

/* ---- life ---- */

static int open_devices(struct touch *touch)
{
	int rc;

	touch->inotify_fd = inotify_init1(IN_NONBLOCK | IN_CLOEXEC);
	if (touch->inotify_fd < 0)
		return -errno;
	rc = watch(touch, touch->inotify_fd, NULL);
	if (rc < 0)
		return rc;
	watch_folder(touch);
	return 0;
}

static int start(struct touch *touch, const struct touch_options *options)
{
	for (int i = 0; i < 6; i++)
		touch->is_calibrated |= options->matrix[i] != 0;
	touch->folder = strdup(options->folder ? options->folder : "/dev/input");
	if (options->replay_path)
		touch->replay_path = strdup(options->replay_path);
	if (!touch->folder || (options->replay_path && !touch->replay_path))
		return -ENOMEM;
	touch->epoll_fd = epoll_create1(EPOLL_CLOEXEC);
	if (touch->epoll_fd < 0)
		return -errno;
	return touch->replay_path ? open_replay(touch) : open_devices(touch);
}

int touch_create(struct touch **out, const struct touch_options *options)
{
	struct touch *touch = calloc(1, sizeof(*touch));
	int rc;

	*out = NULL;
	if (!touch)
		return -ENOMEM;
	touch->options = *options;
	touch->contacts = (struct contacts){
		.width_px = options->width_px,
		.height_px = options->height_px,
		.rotation_deg = options->rotation_deg,
		.edge_px = options->edge_px,
		.palm_px = options->palm_px,
		.event = options->event,
		.data = options->data,
	};
	touch->epoll_fd = touch->inotify_fd = touch->timer_fd = -1;
	touch->folder_watch = touch->parent_watch = -1;
	rc = start(touch, options);
	if (rc < 0) {
		touch_destroy(touch);
		return rc;
	}
	*out = touch;
	return 0;
}

void touch_destroy(struct touch *touch)
{
	if (!touch)
		return;
	for (int i = 0; i < DEVICES_MAX; i++)
		touch_device_close(touch->sources[i].device);
	if (touch->inotify_fd >= 0)
		close(touch->inotify_fd);
	if (touch->timer_fd >= 0)
		close(touch->timer_fd);
	if (touch->epoll_fd >= 0)
		close(touch->epoll_fd);
	touch_replay_finish(&touch->replay);
	free(touch->folder);
	free(touch->replay_path);
	free(touch);
}

int touch_fd(const struct touch *touch)
{
	return touch->epoll_fd;
}

bool touch_waits(const struct touch *touch)
{
	struct pollfd ready = { .fd = touch ? touch->epoll_fd : -1, .events = POLLIN };

	return poll(&ready, 1, 0) > 0;
}

int touch_dispatch(struct touch *touch)
{
	struct epoll_event ready[READY_MAX];
	int count = epoll_wait(touch->epoll_fd, ready, READY_MAX, 0);

	if (count < 0)
		return errno == EINTR ? 0 : -errno;
	for (int i = 0; i < count; i++) {
		if (ready[i].data.ptr)
			read_source(touch, ready[i].data.ptr);
		else if (touch->timer_fd >= 0)
			play(touch);
		else
			read_changes(touch);
	}
	return 0;
}

uint32_t touch_device_count(const struct touch *touch)
{
	uint32_t count = 0;

	for (int i = 0; touch && i < DEVICES_MAX; i++)
		count += touch->sources[i].device != NULL;
	return count;
}

const char *touch_device_text(const struct touch *touch, uint32_t index)
{
	for (int i = 0; i < DEVICES_MAX; i++)
		if (touch->sources[i].device && index-- == 0)
			return touch_device_describe(touch->sources[i].device);
	return "";
}

bool touch_replay_ended(const struct touch *touch)
{
	return touch->replay_path && touch->replayed == touch->replay.count;
}
