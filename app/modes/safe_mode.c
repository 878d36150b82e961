/* Runs the safe page: a small loop that draws an animated page with Cairo into a display buffer,
 * without the GPU, and reports to the service manager. */
#include "app/modes/safe_mode.h"

#include <errno.h>
#include <limits.h>
#include <poll.h>
#include <stdio.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

#include "app/settings/folder.h"
#include "app/settings/provision.h"
#include "base/clock.h"
#include "base/log.h"
#include "base/service.h"
#include "board/profile.h"
#include "render/display/canvas.h"
#include "ui/bitmap.h"
#include "ui/safe_page.h"

enum { FRAME_MS = 100, SHOT_MS = 5000, SHOTS = 2 };

struct safe_mode {
	struct canvas *canvas;
	struct bitmap bitmap; /* in the panel's orientation */
	struct safe_page page;
	cairo_matrix_t to_panel; /* from the visitor's pixels to the panel's */
	int signal_fd;
	int64_t drawn_ms; /* time of the last picture; 0: none */
	bool ready;       /* the service manager was told that the page is up */
};

/* ---- start */

static void turn_matrix(cairo_matrix_t *out, int rotation_deg, int width_px, int height_px)
{
	switch (rotation_deg) {
	case 90:
		cairo_matrix_init(out, 0, -1, 1, 0, 0, height_px);
		break;
	case 180:
		cairo_matrix_init(out, -1, 0, 0, -1, width_px, height_px);
		break;
	case 270:
		cairo_matrix_init(out, 0, 1, -1, 0, width_px, 0);
		break;
	default:
		cairo_matrix_init_identity(out);
	}
}

static int start(struct safe_mode *safe, struct options *options)
{
	static struct provision provision; /* the options borrow from it */
	struct display_options display;
	struct profile profile;
	bool sideways;
	int rc, width, height;

	folder_open_catalogues(options->locale_dir);
	/* A faulty profile may be why the kiosk failed: the valid entries are used. */
	if (provision_read(&provision, options, &profile) < 0)
		log_warn("app",
			 "safe page: the board profile has faults; its valid entries are used");
	provision_finish(&provision);
	display = (struct display_options){
		.kind = options->display,
		.width_px = options->width_px,
		.height_px = options->height_px,
		.hz = options->hz,
		.device = options->device,
	};
	safe->signal_fd = service_stop_fd();
	if (safe->signal_fd < 0)
		return safe->signal_fd;
	rc = canvas_create(&safe->canvas, &display);
	if (rc < 0)
		return rc;
	width = canvas_width_px(safe->canvas);
	height = canvas_height_px(safe->canvas);
	sideways = profile.rotation_deg % 180 != 0;
	turn_matrix(&safe->to_panel, profile.rotation_deg, width, height);
	rc = bitmap_init(&safe->bitmap, width, height);
	if (rc == 0)
		rc = safe_page_init(&safe->page, sideways ? height : width,
				    sideways ? width : height);
	return rc;
}

static void stop(struct safe_mode *safe)
{
	safe_page_finish(&safe->page);
	bitmap_finish(&safe->bitmap);
	canvas_destroy(safe->canvas);
	if (safe->signal_fd >= 0)
		close(safe->signal_fd);
}

/* ---- pictures */

static void draw(struct safe_mode *safe, int64_t time_ms)
{
	cairo_t *context = bitmap_begin(&safe->bitmap);

	cairo_set_matrix(context, &safe->to_panel);
	safe_page_draw(&safe->page, context, time_ms);
	bitmap_end(&safe->bitmap, context);
}

static int write_shot(const struct safe_mode *safe, const char *folder, int shot)
{
	char path[PATH_MAX];
	int rc = 0;

	if (mkdir(folder, 0777) < 0 && errno != EEXIST)
		rc = -errno;
	snprintf(path, sizeof(path), "%s/safe-%d.png", folder, shot);
	if (rc == 0 &&
	    cairo_surface_write_to_png(safe->bitmap.surface, path) != CAIRO_STATUS_SUCCESS)
		rc = -EIO;
	if (rc < 0)
		log_error("app", "%s: cannot be written: %s", path, strerror(-rc));
	return rc;
}

static int write_shots(struct safe_mode *safe, const char *folder)
{
	int rc = 0;

	for (int i = 0; rc == 0 && i < SHOTS; i++) {
		draw(safe, (int64_t)i * SHOT_MS);
		rc = write_shot(safe, folder, i);
	}
	return rc;
}

/* ---- run */

/* Reports to the service manager that the page works: its pictures reach the panel, or it waits for
 * a panel to be connected. */
static void tell_manager(struct safe_mode *safe)
{
	if (!canvas_is_dark(safe->canvas) && (!safe->drawn_ms || !canvas_ready(safe->canvas)))
		return;
	if (!safe->ready)
		service_ready();
	safe->ready = true;
	if (clock_now_ms() >= service_due_ms())
		service_alive();
}

static int wait_ms(const struct safe_mode *safe)
{
	const int64_t since = clock_now_ms() - safe->drawn_ms;
	const int canvas_ms = canvas_wait_ms(safe->canvas);

	if (since >= FRAME_MS && canvas_ready(safe->canvas))
		return 0;
	return clock_sooner_ms(canvas_ms, since < FRAME_MS ? (int)(FRAME_MS - since) : FRAME_MS);
}

static int turn(struct safe_mode *safe, bool *quit)
{
	struct pollfd waits[] = { { .fd = safe->signal_fd, .events = POLLIN },
				  { .fd = canvas_fd(safe->canvas), .events = POLLIN } };
	int rc = 0;

	if (poll(waits, ARRAY_COUNT(waits), wait_ms(safe)) < 0)
		return errno == EINTR ? 0 : -errno;
	*quit = waits[0].revents != 0;
	if (waits[1].revents != 0 || canvas_wait_ms(safe->canvas) == 0)
		rc = canvas_dispatch(safe->canvas);
	if (rc < 0)
		return rc;
	tell_manager(safe);
	if (!canvas_ready(safe->canvas) || clock_now_ms() - safe->drawn_ms < FRAME_MS)
		return 0;
	safe->drawn_ms = clock_now_ms();
	draw(safe, safe->drawn_ms);
	return canvas_show(safe->canvas, safe->bitmap.pixels, safe->bitmap.stride_bytes);
}

int safe_mode_run(struct options *options)
{
	struct safe_mode safe = { .signal_fd = -1 };
	bool quit = false;
	int rc = start(&safe, options);

	if (rc == 0 && options->capture_dir) {
		rc = write_shots(&safe, options->capture_dir);
		quit = true;
	} else if (rc == 0) {
		log_warn("app", "safe page: shown in place of the kiosk");
	}
	while (rc == 0 && !quit)
		rc = turn(&safe, &quit);
	service_stopping();
	if (rc < 0)
		log_error("app", "safe page: stopping: %s", strerror(-rc));
	stop(&safe);
	return rc;
}
