/* One frame: moves the eye, draws the scene from what is loaded, draws the overlay over it, and
 * asks the fetcher for what is missing. Nothing here waits for disk, network or a decoder. */
#ifndef GOPURA_APP_FRAME_H
#define GOPURA_APP_FRAME_H

#include "app/modes/setup_page.h"
#include "app/release/sessions.h"
#include "app/release/trial.h"
#include "app/view/anchors.h"
#include "app/visit/visitor.h"
#include "render/display/display.h"
#include "render/display/gpu_timer.h"
#include "render/scene/governor.h"

enum { FRAME_BUDGET_US = 16667 }; /* duration of a frame at 60 Hz */

struct frame_options {
	int64_t started_ms; /* when the program started */
	bool views;         /* the camera is set from outside, for pictures of views */
	bool words;         /* draw the overlay */
	float scale_least;  /* bound of the governor */
	/* Returns whether a touch waits, for which a picture at rest is left for later. */
	bool (*touch_waits)(void *data);
	void *data; /* borrowed */
	/* What it draws and works with; borrowed. */
	struct display *display;
	struct quads *quads;
	const struct viewport *viewport;
	struct redraw *redraw;
	struct eye *eye;
	struct anchors *anchors;
	struct sessions *sessions;
	const struct trial *trial;
	struct visitor *visitor;
	struct tour_player *tours;
	struct tools *tools;
	struct back *back;
	struct setup_page *setup_page;
};

struct frame {
	struct frame_options options;
	int64_t last_ms;            /* when the last frame was drawn; 0: none yet */
	uint32_t work_us;           /* CPU time of this thread for it */
	uint64_t count, late_count; /* frames drawn; those with work_us over FRAME_BUDGET_US */
	struct governor governor;   /* of the frames of a moving eye */
	struct gpu_timer timer;
	/* When the last frame began, and came to the scene, the words, and the end of drawing. */
	int64_t began_us, scene_us, words_us, drawn_us;
	int64_t slowest_us;     /* of the slow frames that were logged */
	int64_t spent_us;       /* what it took until it was handed to the display */
	bool pending;           /* the eye moved in it, and its time is not noted yet */
	bool words_move;        /* the overlay still changes */
	int64_t pictured_ms;    /* when the model was first drawn; 0: not yet */
	bool memory_given_back; /* done since the picture last settled */
};

/* Copies the options; needs the current GL context. */
void frame_init(struct frame *frame, const struct frame_options *options);
void frame_finish(struct frame *frame); /* zeroed is fine */
/* Draws and presents one frame, and updates the wants. Returns 0; -ENOTRECOVERABLE: the GPU lost
 * its context; or a negative errno of the display. */
must_check int frame_draw(struct frame *frame);
/* Tells that the display may have shown the last frame. */
void frame_note_shown(struct frame *frame);
/* Returns how many milliseconds should lie between the beginnings of two frames, so that they come
 * evenly. */
int frame_period_ms(const struct frame *frame);
/* Does what a frame does beside drawing, while no panel shows anything: loads the next release.
 * Returns 0; -ENOTRECOVERABLE: the GPU lost its context. */
must_check int frame_unseen(struct frame *frame);

#endif
