#include "input/touch.h"

#include <dirent.h>
#include <errno.h>
#include <limits.h>
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
#include "input/touch_device.h"
#include "input/touch_replay.h"

enum {
	DEVICES_MOST = 8,
	READY_MOST = 16,
	REPLAY_BYTES_MOST = 16 << 20,
};

/* What a slot of a device is on the panel. */
struct slot {
	int id;      /* the finger's, while down */
	bool down;   /* known to be down, reported or ignored */
	int contact; /* reported as; -1: ignored until it lifts */
	float x_px, y_px;
};

struct source {
	struct touch_device *device; /* NULL: free */
	float matrix[6];             /* calibration */
	bool matrix_is_known;        /* udev need not be asked again */
	struct slot slots[TOUCH_SLOTS_MOST];
};

struct touch {
	struct touch_options options; /* folder and replay_path are our copies */
	char *folder, *replay_path;
	bool is_calibrated; /* by the options: udev is not asked */
	int epoll_fd, inotify_fd, timer_fd;
	int parent_watch; /* of the folder's own folder while it is missing, else -1 */
	struct source sources[DEVICES_MOST];
	bool contact_used[TOUCH_CONTACTS_MOST];
	struct touch_replay replay;
	size_t replayed; /* events */
	int64_t replay_start_us;
};

static const float no_calibration[6] = { 1, 0, 0, 0, 1, 0 };

/* ---- from the device to the panel ---- */

static void to_panel(const struct touch *touch, const float m[6], const struct touch_raw *raw,
		     float *x_px, float *y_px)
{
	float u = m[0] * raw->x + m[1] * raw->y + m[2];
	float v = m[3] * raw->x + m[4] * raw->y + m[5];
	float x = u, y = v;

	switch (touch->options.rotation_deg) {
	case 90: /* the panel's own left edge is on top */
		x = 1 - v;
		y = u;
		break;
	case 180:
		x = 1 - u;
		y = 1 - v;
		break;
	case 270:
		x = v;
		y = 1 - u;
		break;
	}
	x = x < 0 ? 0 : x > 1 ? 1 : x;
	y = y < 0 ? 0 : y > 1 ? 1 : y;
	*x_px = x * (float)touch->options.width_px;
	*y_px = y * (float)touch->options.height_px;
}

static bool is_at_edge(const struct touch *touch, float x_px, float y_px)
{
	const struct touch_options *o = &touch->options;

	return o->edge_px > 0 &&
	       (x_px < o->edge_px || y_px < o->edge_px || x_px > (float)o->width_px - o->edge_px ||
		y_px > (float)o->height_px - o->edge_px);
}

static bool is_palm(const struct touch *touch, const struct touch_raw *raw)
{
	const struct touch_options *o = &touch->options;
	bool sideways = o->rotation_deg % 180 != 0;
	float width_px = (float)(sideways ? o->height_px : o->width_px);

	return o->palm_px > 0 && raw->major * width_px > o->palm_px;
}

static int take_contact(struct touch *touch)
{
	for (int i = 0; i < TOUCH_CONTACTS_MOST; i++) {
		if (!touch->contact_used[i]) {
			touch->contact_used[i] = true;
			return i;
		}
	}
	return -1;
}

static void report(struct touch *touch, enum touch_phase phase, const struct slot *slot,
		   int64_t time_us)
{
	const struct touch_event event = { .phase = phase,
					   .contact = (uint32_t)slot->contact,
					   .x_px = slot->x_px,
					   .y_px = slot->y_px,
					   .time_us = time_us };

	if (slot->contact >= 0 && touch->options.event)
		touch->options.event(touch->options.data, &event);
}

static void lift(struct touch *touch, struct slot *slot, enum touch_phase phase, int64_t time_us)
{
	report(touch, phase, slot, time_us);
	if (slot->contact >= 0)
		touch->contact_used[slot->contact] = false;
	slot->contact = -1;
}

static void put_down(struct touch *touch, const float matrix[6], struct slot *slot,
		     const struct touch_raw *raw, int64_t time_us)
{
	*slot = (struct slot){ .id = raw->id, .down = true, .contact = -1 };
	to_panel(touch, matrix, raw, &slot->x_px, &slot->y_px);
	if (is_at_edge(touch, slot->x_px, slot->y_px) || is_palm(touch, raw))
		return;
	slot->contact = take_contact(touch);
	report(touch, TOUCH_DOWN, slot, time_us);
}

static void move(struct touch *touch, const float matrix[6], struct slot *slot,
		 const struct touch_raw *raw, int64_t time_us)
{
	float x_px, y_px;

	to_panel(touch, matrix, raw, &x_px, &y_px);
	if (is_palm(touch, raw)) {
		lift(touch, slot, TOUCH_CANCEL, time_us);
		return;
	}
	if (x_px == slot->x_px && y_px == slot->y_px)
		return;
	slot->x_px = x_px;
	slot->y_px = y_px;
	report(touch, TOUCH_MOVE, slot, time_us);
}

static bool any_down(const struct source *source)
{
	for (int i = 0; i < TOUCH_SLOTS_MOST; i++)
		if (source->slots[i].down)
			return true;
	return false;
}

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

/* A frame against what was known. A finger whose lift was lost shows as a changed id. */
static void compare(struct touch *touch, struct source *source, const struct touch_raw *slots,
		    int64_t time_us)
{
	if (!any_down(source)) /* between two fingers the world may turn */
		calibrate(touch, source);
	for (int i = 0; i < TOUCH_SLOTS_MOST; i++) {
		struct slot *slot = &source->slots[i];
		const struct touch_raw *raw = &slots[i];

		if (slot->down && (!raw->down || raw->id != slot->id)) {
			lift(touch, slot, TOUCH_UP, time_us);
			slot->down = false;
		}
		if (raw->down && !slot->down)
			put_down(touch, source->matrix, slot, raw, time_us);
		else if (raw->down)
			move(touch, source->matrix, slot, raw, time_us);
	}
}

/* ---- devices that come and go ---- */

static int watch(struct touch *touch, int fd, struct source *source)
{
	struct epoll_event event = { .events = EPOLLIN, .data.ptr = source };

	return epoll_ctl(touch->epoll_fd, EPOLL_CTL_ADD, fd, &event) < 0 ? -errno : 0;
}

static void remove_source(struct touch *touch, struct source *source)
{
	int64_t now_us = clock_now_us();

	log_info("input", "%s (%s) is gone", touch_device_name(source->device),
		 touch_device_path(source->device));
	for (int i = 0; i < TOUCH_SLOTS_MOST; i++)
		if (source->slots[i].down)
			lift(touch, &source->slots[i], TOUCH_CANCEL, now_us);
	epoll_ctl(touch->epoll_fd, EPOLL_CTL_DEL, touch_device_fd(source->device), NULL);
	touch_device_close(source->device);
	*source = (struct source){ 0 };
}

static bool is_open(const struct touch *touch, const char *path)
{
	for (int i = 0; i < DEVICES_MOST; i++)
		if (touch->sources[i].device &&
		    strcmp(touch_device_path(touch->sources[i].device), path) == 0)
			return true;
	return false;
}

/* A device that cannot be used is none of ours; one that may not be opened yet is told of again
 * when its permissions change. */
static void try_device(struct touch *touch, const char *name)
{
	struct source *source = NULL;
	char path[PATH_MAX];

	if (strncmp(name, "event", 5) != 0 ||
	    snprintf(path, sizeof(path), "%s/%s", touch->folder, name) >= (int)sizeof(path) ||
	    is_open(touch, path))
		return;
	for (int i = 0; i < DEVICES_MOST && !source; i++)
		if (!touch->sources[i].device)
			source = &touch->sources[i];
	if (!source || touch_device_open(&source->device, path) < 0)
		return;
	if (watch(touch, touch_device_fd(source->device), source) < 0) {
		log_error("input", "%s: cannot be waited for: %s", path, strerror(errno));
		touch_device_close(source->device);
		source->device = NULL;
		return;
	}
	log_info("input", "%s (%s) is there", touch_device_name(source->device), path);
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

/* A kernel without any device may have no /dev/input yet: then its parent is watched for it. */
static void watch_folder(struct touch *touch)
{
	char parent[PATH_MAX];

	if (touch->parent_watch >= 0)
		inotify_rm_watch(touch->inotify_fd, touch->parent_watch);
	touch->parent_watch = -1;
	if (inotify_add_watch(touch->inotify_fd, touch->folder,
			      IN_CREATE | IN_ATTRIB | IN_MOVED_TO) >= 0) {
		scan(touch);
		return;
	}
	snprintf(parent, sizeof(parent), "%s", touch->folder);
	if (strrchr(parent, '/'))
		strrchr(parent, '/')[1] = 0;
	touch->parent_watch = inotify_add_watch(touch->inotify_fd, parent, IN_CREATE | IN_MOVED_TO);
	if (touch->parent_watch < 0)
		log_warn("input", "%s cannot be watched (%s): devices plugged in later are missed",
			 touch->folder, strerror(errno));
}

static void read_source(struct touch *touch, struct source *source)
{
	struct touch_raw slots[TOUCH_SLOTS_MOST];
	int64_t time_us = clock_now_us(); /* of a frame that only a resync made */
	int rc;

	if (!source->device)
		return; /* went in this very dispatch */
	while ((rc = touch_device_read(source->device, slots, &time_us)) > 0)
		compare(touch, source, slots, time_us);
	if (rc < 0)
		remove_source(touch, source);
}

static void read_changes(struct touch *touch)
{
	union {
		struct inotify_event event;
		char bytes[4096];
	} buffer;
	bool folder_may_have_come = false;
	ssize_t size;

	while ((size = read(touch->inotify_fd, buffer.bytes, sizeof(buffer.bytes))) > 0) {
		for (ssize_t at = 0; at < size;) {
			struct inotify_event event;

			memcpy(&event, buffer.bytes + at, sizeof(event));
			folder_may_have_come |= event.wd == touch->parent_watch;
			if (event.len > 0 && event.wd != touch->parent_watch)
				try_device(touch, buffer.bytes + at + sizeof(event));
			at += (ssize_t)(sizeof(event) + event.len);
		}
	}
	if (folder_may_have_come && touch->parent_watch >= 0)
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
		wait_us = 1; /* zero would disarm it */
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

	buffer_init(&text, REPLAY_BYTES_MOST);
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
	touch->epoll_fd = touch->inotify_fd = touch->timer_fd = touch->parent_watch = -1;
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
	for (int i = 0; i < DEVICES_MOST; i++)
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

int touch_dispatch(struct touch *touch)
{
	struct epoll_event ready[READY_MOST];
	int count = epoll_wait(touch->epoll_fd, ready, READY_MOST, 0);

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

	for (int i = 0; touch && i < DEVICES_MOST; i++)
		count += touch->sources[i].device != NULL;
	return count;
}

const char *touch_device_text(const struct touch *touch, uint32_t index)
{
	for (int i = 0; i < DEVICES_MOST; i++)
		if (touch->sources[i].device && index-- == 0)
			return touch_device_describe(touch->sources[i].device);
	return "";
}

bool touch_replay_ended(const struct touch *touch)
{
	return touch->replay_path && touch->replayed == touch->replay.count;
}
