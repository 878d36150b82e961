/* Writes pictures to files, for people and benchmarks: a list of views, each drawn until it
 * improves no further, or shots at given times of a replay. */
#ifndef GOPURA_APP_MODES_CAPTURE_H
#define GOPURA_APP_MODES_CAPTURE_H

#include "app/settings/options.h"
#include "app/view/eye.h"
#include "app/view/redraw.h"
#include "render/display/display.h"

struct capture;

/* The frame that was drawn last. */
struct capture_frame {
	struct display *display;     /* to read its pixels */
	const struct exhibit *shown; /* what was drawn */
	bool words_move;             /* the overlay still changes */
	uint32_t work_us;            /* CPU time that it took */
	uint64_t received_bytes;     /* by the fetcher, since the start */
};

/* Reads options->views_path or options->shots_path and creates options->capture_dir, which are
 * borrowed for the capture's life, and so is redraw. *out is owned by the caller; it is NULL if
 * neither path is set. Returns 0; -EINVAL if the file has a fault (logged with its line); -ENOMEM,
 * or what the file system reports (logged). */
must_check int capture_create(struct capture **out, const struct options *options,
			      struct redraw *redraw);
void capture_destroy(struct capture *capture); /* NULL is fine */

/* Call it before a frame: sets the eye's camera to the current view, if views are drawn. */
void capture_aim(struct capture *capture, struct eye *eye, const struct viewport *viewport,
		 uint64_t received_bytes);
/* Call it after each frame: writes the pictures that are due and goes to the next view. Returns 0;
 * 1 after the last view; or a negative errno (logged). */
must_check int capture_after(struct capture *capture, const struct capture_frame *frame);
/* Counts an object that arrived. */
void capture_object(struct capture *capture);
/* Returns in how many milliseconds it needs a frame, if the last one was drawn at frame_ms; -1: it
 * has written everything. */
int capture_wait_ms(const struct capture *capture, int64_t frame_ms);

#endif
