/* Runs the checks of --self-test one after another (settings, storage, trust root, touch, panel,
 * GPU) and prints one line of result for each. */
#include "app/modes/self_test.h"

#include <dirent.h>
#include <errno.h>
#include <fcntl.h>
#include <inttypes.h>
#include <poll.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <sys/statvfs.h>
#include <unistd.h>

#include "app/settings/folder.h"
#include "app/settings/provision.h"
#include "app/settings/scene_settings.h"
#include "base/clock.h"
#include "base/safe_open.h"
#include "format/metadata.h"
#include "input/touch.h"
#include "render/display/display.h"
#include "render/display/gl.h"
#include "render/display/quads.h"
#include "storage/cache.h"
#include "storage/state.h"
#include "tuf/tuf_metadata.h"

enum {
	FLIP_MOST_MS = 8000, /* longest wait for a frame; the first mode set is slow */
	STATE_ROOM_MIB = 16, /* state.db, its journal and its second copy, with a large margin */
	PROBE_BYTES = 4096,
};

struct self_test {
	const struct options *options;
	struct profile profile;
	struct display *display; /* NULL: it could not be opened */
	char folder[PATH_MAX];   /* of the state; "": it cannot be written */
	bool settings_failed;    /* or the trust root */
	bool failed;             /* something else */
};

static void say(struct self_test *test, bool good, const char *what, const char *text, ...)
	printf_like(4, 5);

static void say(struct self_test *test, bool good, const char *what, const char *text, ...)
{
	va_list args;

	va_start(args, text);
	printf("%-5s %-8s ", good ? "ok" : "fail", what);
	vprintf(text, args);
	putchar('\n');
	fflush(stdout);
	va_end(args);
	if (strcmp(what, "settings") == 0 || strcmp(what, "trust") == 0)
		test->settings_failed |= !good;
	else
		test->failed |= !good;
}

/* ---- settings */

static void check_settings(struct self_test *test, struct options *options)
{
	static struct provision own; /* the options borrow from it */
	const struct provision *provision = &own;
	const int rc = provision_read(&own, options, &test->profile);
	const uint32_t faults = diagnostics_total(&provision->diagnostics);

	if (rc < 0)
		say(test, false, "settings", "%s cannot be used: correct what the log reports",
		    test->options->board_path);
	else if (faults > 0)
		say(test, false, "settings", "%s: %u faults, see the log", provision->path, faults);
	else if (test->options->conf_count > 0 && !provision->path)
		say(test, false, "settings", "%s does not exist: create it (docs/terminal.md)",
		    test->options->conf_paths[0]);
	else
		say(test, true, "settings", "%s",
		    provision->path ? provision->path : "given on the command line");
	provision_finish(&own);
}

/* ---- panel and GPU */

/* Presents one picture and waits until the panel is ready for the next. Returns 0, -ETIMEDOUT or a
 * negative errno. */
static int present(struct display *display, int64_t until_ms)
{
	int rc;

	display_begin(display);
	glClearColor(0, 0, 0, 1);
	glClear(GL_COLOR_BUFFER_BIT | GL_DEPTH_BUFFER_BIT);
	rc = display_present(display);
	while (rc == 0 && !display_ready(display) && !display_is_dark(display)) {
		struct pollfd wait = { .fd = display_fd(display), .events = POLLIN };

		if (clock_now_ms() > until_ms)
			return -ETIMEDOUT;
		if (poll(&wait, 1, 100) >= 0)
			rc = display_dispatch(display);
	}
	return rc;
}

/* Presents pictures until one is on the panel: one that was refused is to be drawn again. */
static int flip(struct display *display)
{
	const int64_t until_ms = clock_now_ms() + FLIP_MOST_MS;
	int rc;

	do
		rc = present(display, until_ms);
	while (rc == 0 && display_take_stale(display));
	return rc;
}

static void check_panel(struct self_test *test)
{
	static const char *const kinds[] = {
		[DISPLAY_DRM] = "KMS",
		[DISPLAY_WINDOW] = "a window",
		[DISPLAY_HEADLESS] = "in memory",
	};
	const struct options *o = test->options;
	const struct display_options options = {
		.kind = o->display,
		.width_px = o->width_px,
		.height_px = o->height_px,
		.hz = o->hz,
		.device = o->device,
		.title = "Gopura",
	};
	int rc = display_create(&test->display, &options);

	if (rc < 0) {
		say(test, false, "panel",
		    "cannot be opened (see the log): stop a running kiosk, or add the user to the "
		    "groups video and render");
		return;
	}
	if (!display_is_dark(test->display))
		rc = flip(test->display);
	if (display_is_dark(test->display))
		say(test, false, "panel",
		    "not connected, or in use by another program: check cable and power");
	else if (rc < 0)
		say(test, false, "panel",
		    "shows no picture (%s): try another mode with --size, then another cable",
		    strerror(-rc));
	else
		say(test, true, "panel", "%d x %d, shows a picture (%s)",
		    display_width_px(test->display), display_height_px(test->display),
		    kinds[display_kind(test->display)]);
}

static bool has_limit(struct self_test *test, GLenum name, int needed, const char *what)
{
	GLint has[2] = { 0, 0 };

	glGetIntegerv(name, has); /* viewport dimensions are two values: the smaller counts */
	if (name == GL_MAX_VIEWPORT_DIMS && has[1] < has[0])
		has[0] = has[1];
	if (has[0] >= needed)
		return true;
	say(test, false, "gpu", "%d %s, the kiosk needs %d: use %s", has[0], what, needed,
	    needed > GL_LIMIT_VERTEX_UNIFORMS ? "a smaller mode (--size), or another board"
					      : "another board or driver");
	return false;
}

/* Returns whether all shaders compile and a scene with the profile's budgets can be created. */
static bool has_scene(const struct self_test *test)
{
	struct scene_options options = scene_settings(&test->profile, test->options->mode);
	struct quads *quads = NULL;
	struct scene *scene = NULL;
	int rc = quads_create(&quads);

	if (rc == 0)
		rc = scene_create(&scene, &options);
	scene_destroy(scene);
	quads_destroy(quads);
	return rc == 0 && gl_check("trying the GPU") == 0;
}

static void check_gpu(struct self_test *test)
{
	int width, height, side;
	bool good;

	if (!test->display) {
		say(test, false, "gpu", "not tested, because there is no panel");
		return;
	}
	width = display_width_px(test->display);
	height = display_height_px(test->display);
	side = width > height ? width : height;
	good = has_limit(test, GL_MAX_TEXTURE_SIZE,
			 side > GL_LIMIT_MEDIUMP_PX ? side : GL_LIMIT_MEDIUMP_PX,
			 "pixels per texture side") &&
	       has_limit(test, GL_MAX_VIEWPORT_DIMS, side, "pixels per picture side") &&
	       has_limit(test, GL_MAX_TEXTURE_IMAGE_UNITS, GL_LIMIT_UNITS, "texture units") &&
	       has_limit(test, GL_MAX_VERTEX_ATTRIBS, GL_LIMIT_ATTRIBUTES, "vertex attributes") &&
	       has_limit(test, GL_MAX_FRAGMENT_UNIFORM_VECTORS, GL_LIMIT_FRAGMENT_UNIFORMS,
			 "fragment uniforms") &&
	       has_limit(test, GL_MAX_VERTEX_UNIFORM_VECTORS, GL_LIMIT_VERTEX_UNIFORMS,
			 "vertex uniforms");
	if (good && has_scene(test))
		say(test, true, "gpu", "%s", (const char *)glGetString(GL_RENDERER));
	else if (good)
		say(test, false, "gpu",
		    "%s cannot draw the scene (see the log): reduce texture_mib in the board profile, "
		    "or use another driver",
		    (const char *)glGetString(GL_RENDERER));
}

/* ---- touch */

/* Returns whether an input device exists that may not be opened; its path is in out. */
static bool is_locked_out(char *out, size_t bytes)
{
	DIR *folder = opendir("/dev/input");
	struct dirent *entry;
	bool locked = false;

	while (folder && !locked && (entry = readdir(folder))) {
		if (strncmp(entry->d_name, "event", 5) != 0)
			continue;
		snprintf(out, bytes, "/dev/input/%s", entry->d_name);
		locked = access(out, R_OK) < 0 && errno == EACCES;
	}
	if (folder)
		closedir(folder);
	return locked;
}

static void say_no_touch(struct self_test *test)
{
	char path[300], name[128];
	const bool had = test->folder[0] && folder_had_touch(test->folder, name);

	if (!had)
		say(test, true, "touch", "none, and none was ever connected");
	else if (is_locked_out(path, sizeof(path)))
		say(test, false, "touch",
		    "%s may not be read: add the user to the group input, and check the unit's "
		    "DeviceAllow",
		    path);
	else
		say(test, false, "touch",
		    "'%s' was connected before and is not found (see the log): check its cable and "
		    "power; if the terminal is to have no touchscreen, remove %s/touch.seen",
		    name, test->folder);
}

static void check_touch(struct self_test *test)
{
	const struct touch_options options = { .width_px = 100, .height_px = 100 };
	struct touch *touch = NULL;

	if (touch_create(&touch, &options) < 0) {
		say(test, false, "touch", "cannot be opened: see the log");
		return;
	}
	for (uint32_t i = 0; i < touch_device_count(touch); i++) {
		say(test, true, "touch", "%s", touch_device_text(touch, i));
		if (test->folder[0])
			folder_remember_touch(test->folder, touch_device_text(touch, i));
	}
	if (touch_device_count(touch) == 0)
		say_no_touch(test);
	touch_destroy(touch);
}

/* ---- storage */

static int write_probe(const char *folder)
{
	static const char zeros[PROBE_BYTES];
	char path[PATH_MAX + 16];
	int fd, rc = 0;

	snprintf(path, sizeof(path), "%s/probe", folder);
	fd = open(path, O_WRONLY | O_CREAT | O_TRUNC | O_CLOEXEC, 0600);
	if (fd < 0)
		return -errno;
	if (write(fd, zeros, sizeof(zeros)) != (ssize_t)sizeof(zeros) || fsync(fd) < 0)
		rc = errno ? -errno : -EIO;
	close(fd);
	unlink(path);
	return rc;
}

/* Returns the free space that the state folder still needs, in MiB. The cache counts only if this
 * kiosk starts the fetcher, less what it already occupies. */
static uint64_t room_needed_mib(const struct self_test *test)
{
	const uint64_t cache_mib =
		cache_budget_in(test->folder, (uint64_t)test->profile.cache_mib << 20) >> 20;
	char path[PATH_MAX + 16];
	struct stat cache;
	uint64_t has_mib = 0;

	if (test->options->socket_path)
		return STATE_ROOM_MIB;
	snprintf(path, sizeof(path), "%s/cache.db", test->folder);
	if (stat(path, &cache) == 0)
		has_mib = (uint64_t)cache.st_size >> 20;
	return STATE_ROOM_MIB + (cache_mib > has_mib ? cache_mib - has_mib : 0);
}

static void check_storage(struct self_test *test)
{
	struct statvfs disk;
	uint64_t free_mib, needed_mib;
	int rc = folder_of_state(test->options->state_dir, test->folder);

	if (rc == 0)
		rc = write_probe(test->folder);
	if (rc == 0 && statvfs(test->folder, &disk) < 0)
		rc = -errno;
	if (rc < 0) {
		say(test, false, "storage",
		    "%s cannot be written (%s): check its owner, and that its disk is mounted and "
		    "healthy",
		    test->folder, strerror(-rc));
		test->folder[0] = '\0';
		return;
	}
	free_mib = (uint64_t)disk.f_bavail * disk.f_frsize >> 20;
	needed_mib = room_needed_mib(test);
	if (free_mib < needed_mib)
		say(test, false, "storage",
		    "%s: %" PRIu64 " MiB free, %" PRIu64
		    " needed: free space, or reduce mib in section [cache] of the board profile",
		    test->folder, free_mib, needed_mib);
	else
		say(test, true, "storage", "%s: %" PRIu64 " MiB free", test->folder, free_mib);
}

/* ---- trust */

static void say_trust(struct self_test *test, const char *whose, struct bytes file)
{
	struct trust_root root;
	struct tuf_file tuf;
	const char *why = "", *unused;
	int rc = trust_root_first(&root, file, &why);

	if (rc < 0 && tuf_root_first(&tuf, file, &unused) == 0) {
		root = (struct trust_root){ .version = tuf.version, .expires_s = tuf.expires_s };
		tuf_file_finish(&tuf);
		rc = 0;
	}
	if (rc < 0)
		say(test, false, "trust", "%s: %s: get root/1.json from the publisher", whose, why);
	else if (clock_wall_is_set() && root.expires_s < clock_wall_s())
		say(test, false, "trust",
		    "%s has expired: the publisher must sign a new root; then give it with --trust",
		    whose);
	else
		say(test, true, "trust", "%s, version %" PRIu32, whose, root.version);
}

/* Checks the trust root stored in the state. Returns whether there is one. */
static bool check_remembered_trust(struct self_test *test)
{
	char path[PATH_MAX + 16];
	struct state_tuf tuf;
	struct state *state;
	struct bytes file;
	bool has;

	snprintf(path, sizeof(path), "%s/state.db", test->folder);
	if (!test->folder[0] || access(path, F_OK) < 0 || state_create(&state, path) < 0)
		return false;
	has = true;
	if (state_tuf(state, &tuf) == 0)
		say_trust(test, "the stored trust root of The Update Framework", tuf.root);
	else if (state_trust(state, &file) < 0)
		has = false;
	else
		say_trust(test, "the stored trust root", file);
	state_destroy(state);
	return has;
}

static void check_trust(struct self_test *test)
{
	const char *path = test->options->trust_path;
	struct buffer file;
	int rc;

	if (check_remembered_trust(test))
		return;
	if (!path) {
		say(test, false, "trust",
		    "no trust root is stored: give the museum's root/1.json with --trust once");
		return;
	}
	buffer_init(&file, METADATA_FILE_BYTES_MAX);
	rc = buffer_read_foreign(&file, path);
	if (rc < 0)
		say(test, false, "trust", "%s: %s: get root/1.json from the publisher", path,
		    open_problem(rc));
	else
		say_trust(test, path, buffer_bytes(&file));
	buffer_finish(&file);
}

int self_test_run(struct options *options)
{
	struct self_test test = { .options = options };

	check_settings(&test, options);
	check_storage(&test); /* sets the folder, in which check_touch looks for touch.seen */
	check_trust(&test);
	check_touch(&test);
	check_panel(&test);
	check_gpu(&test);
	display_destroy(test.display);
	if (test.failed)
		return EXIT_FAILURE;
	return test.settings_failed ? SELF_TEST_STATUS_SETTINGS : EXIT_SUCCESS;
}
