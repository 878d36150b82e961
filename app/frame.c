/* Draws the scene of the release that is shown, its overlay as textured quads, and the set-up page.
 * Updates the modules of the visit before, and the fetcher's list of wants after. */
#include "app/frame.h"

#include <errno.h>
#include <malloc.h>
#include <math.h>

#include "app/visit/layer_choice.h"
#include "base/clock.h"
#include "base/log.h"
#include "render/display/context.h"
#include "render/display/gl.h"

/* Longest time step of the navigator, so that after a delay the eye does not jump. */
enum { STEP_MOST_MS = 50 };
/* Frames that take longer are logged, each only if none before took as long: on a display of any
 * speed this is a handful of lines. */
enum { SLOW_US = 2000000 };

void frame_init(struct frame *frame, const struct frame_options *options)
{
	*frame = (struct frame){ .options = *options };
	governor_init(
		&frame->governor,
		&(struct governor_bounds){ .scale_least = options->scale_least,
					   .refresh_us = display_refresh_us(options->display) });
	gpu_timer_init(&frame->timer);
}

void frame_finish(struct frame *frame)
{
	gpu_timer_finish(&frame->timer);
}

static struct exhibit *shown_by(const struct frame *frame)
{
	return &frame->options.sessions->shown.exhibit;
}

/* ---- the scene */

static const struct scene_mark *marked_part(const struct frame *frame, struct scene_mark *out)
{
	const struct exhibit *shown = shown_by(frame);
	struct overlay *overlay = exhibit_overlay(shown);
	int part = -1;

	if (overlay)
		part = overlay_page(overlay) >= 0 ? overlay_page(overlay) : overlay_card(overlay);
	if (part < 0)
		part = tour_player_part(frame->options.tours);
	if (part < 0)
		return NULL;
	*out = (struct scene_mark){ .part = info_part(exhibit_info(shown), (uint32_t)part)->id };
	information_view_region(shown->view, (uint32_t)part, &out->region);
	return out;
}

static void draw_scene(struct frame *frame)
{
	const struct frame_options *o = &frame->options;
	struct exhibit *shown = shown_by(frame);
	const struct root_page *root = shown->scene ? scene_root(shown->scene) : NULL;
	struct scene_mark mark;

	glDisable(GL_SCISSOR_TEST);
	glViewport(0, 0, o->eye->camera.width_px, o->eye->camera.height_px);
	glClearColor((float)(root ? root->background[0] : 24) / 255,
		     (float)(root ? root->background[1] : 22) / 255,
		     (float)(root ? root->background[2] : 20) / 255, 0);
	glClear(GL_COLOR_BUFFER_BIT | GL_DEPTH_BUFFER_BIT);
	if (shown->scene && o->eye->ready) {
		const struct scene_effort effort = governor_effort(&frame->governor);

		scene_spend(shown->scene, &effort);
		scene_heed(shown->scene, o->touch_waits, o->data);
		scene_draw(shown->scene, &o->eye->camera,
			   o->words ? marked_part(frame, &mark) : NULL, &shown->frame);
	}
}

/* ---- the words over it */

static int draw_layers(const struct frame *frame, const struct overlay *overlay)
{
	static struct overlay_layer layers[OVERLAY_LAYERS_MAX];
	const struct viewport *viewport = frame->options.viewport;
	struct quads *quads = frame->options.quads;
	const uint32_t count = overlay_layers(overlay, layers, OVERLAY_LAYERS_MAX);
	int rc = 0;

	quads_begin(quads, viewport->shift_px, viewport->panel_width_px, viewport->panel_height_px,
		    viewport->rotation_deg);
	for (uint32_t i = 0; i < count && rc == 0; i++) {
		const struct overlay_layer *layer = &layers[i];
		const struct quads_pixels pixels = {
			.id = layer->bitmap,
			.revision = layer->revision,
			.width_px = layer->pixels->width_px,
			.height_px = layer->pixels->height_px,
			.stride_bytes = layer->pixels->stride_bytes,
			.bgra = layer->pixels->pixels,
		};

		rc = quads_upload(quads, &pixels);
		quads_draw(quads, layer->bitmap, layer->corners_px, layer->source, layer->alpha);
	}
	quads_end(quads);
	return rc;
}

static int draw_words(struct frame *frame, int64_t now_ms)
{
	const struct frame_options *o = &frame->options;
	struct overlay *overlay = exhibit_overlay(shown_by(frame));

	if (!overlay || !o->words)
		return 0;
	anchors_place(o->anchors, o->eye, o->viewport, &o->tools->now.section);
	frame->words_move = overlay_update(overlay, now_ms);
	return draw_layers(frame, overlay);
}

/* ---- its time */

/* Where nothing is governed, the clock is not asked: a simulated one advances with each look. */
static int64_t measured_us(const struct frame *frame)
{
	return governor_is_fixed(&frame->governor) ? 0 : clock_now_us();
}

void frame_note_shown(struct frame *frame)
{
	const int64_t target_us = governor_target_us(&frame->governor);
	int64_t spent_us = frame->spent_us, late_us, gpu_us;

	if (!frame->pending || !display_ready(frame->options.display))
		return;
	frame->pending = false;
	/* A panel shows a frame at its next refresh, so only more than that tells anything. */
	late_us = measured_us(frame) - frame->began_us;
	gpu_us = gpu_timer_take_us(&frame->timer);
	if (late_us > target_us * 3 / 2 && late_us > spent_us)
		spent_us = late_us;
	governor_note(&frame->governor, gpu_us > spent_us ? gpu_us : spent_us,
		      shown_by(frame)->frame.triangles);
}

/* What a whole picture at rest took tells how a motion should begin. */
static void expect(struct frame *frame)
{
	const struct scene_frame *shown = &shown_by(frame)->frame;

	if (!shown->moved && shown->moving && !shown->sliced && shown->patches > 0)
		governor_expect(&frame->governor, frame->spent_us, shown->triangles);
}

int frame_period_ms(const struct frame *frame)
{
	const bool moved = shown_by(frame)->frame.moved;

	return (int)((moved ? governor_target_us(&frame->governor)
			    : frame->governor.bounds.refresh_us) /
		     1000);
}

/* ---- after it */

static void log_first_picture(struct frame *frame)
{
	const struct scene_frame *shown = &shown_by(frame)->frame;

	if (frame->pictured_ms || shown->patches + shown->stream_triangles == 0)
		return;
	frame->pictured_ms = clock_now_ms();
	log_info("app", "first picture after %lld ms",
		 (long long)(frame->pictured_ms - frame->options.started_ms));
}

/* Returns freed memory to the system. Once each time the picture settles, because it takes
 * milliseconds (7 with the temple of 5 million triangles), and so does each page that is faulted in
 * again. */
static void give_back_memory(struct frame *frame)
{
	if (!shown_by(frame)->frame.settled)
		frame->memory_given_back = false;
	else if (!frame->options.redraw->wanted && !frame->memory_given_back) {
		log_debug("app", "the picture has settled");
		malloc_trim(0);
		frame->memory_given_back = true;
	}
}

int frame_unseen(struct frame *frame)
{
	const struct frame_options *o = &frame->options;

	if (context_is_lost())
		return -ENOTRECOVERABLE;
	o->redraw->wanted = false;
	/* The next release is drawn with this camera, which no frame may have set yet. */
	if (o->eye->ready)
		eye_aim(o->eye, o->viewport, clock_now_ms());
	sessions_warm(o->sessions);
	sessions_ask(o->sessions);
	return 0;
}

/* Logs where the time of a slow frame went: before the scene, in the scene, in the words, and until
 * the panel had it, where a driver does what it was told to draw. */
static void log_slow(struct frame *frame)
{
	const int64_t end_us = frame->began_us + frame->spent_us;
	const double us_a_second = 1e6;

	if (frame->spent_us <= (frame->slowest_us > SLOW_US ? frame->slowest_us : SLOW_US))
		return;
	frame->slowest_us = frame->spent_us;
	log_info("app",
		 "a frame took %.1f s: %.1f before the scene, scene %.1f, words %.1f, panel %.1f",
		 (double)frame->spent_us / us_a_second,
		 (double)(frame->scene_us - frame->began_us) / us_a_second,
		 (double)(frame->words_us - frame->scene_us) / us_a_second,
		 (double)(frame->drawn_us - frame->words_us) / us_a_second,
		 (double)(end_us - frame->drawn_us) / us_a_second);
}

/* ---- the frame */

static void move_eye(struct frame *frame, int64_t now_ms)
{
	const struct frame_options *o = &frame->options;
	const float dt_ms = fminf((float)(now_ms - frame->last_ms), STEP_MOST_MS);

	if (!o->eye->ready || o->views)
		return;
	eye_step(o->eye, o->viewport, dt_ms);
	o->eye->moves |= visitor_lead_eye(o->visitor, now_ms);
	eye_aim(o->eye, o->viewport, now_ms);
}

static int draw(struct frame *frame, int64_t now_ms)
{
	const struct frame_options *o = &frame->options;
	int rc;

	display_begin(o->display);
	frame->scene_us = measured_us(frame);
	draw_scene(frame);
	frame->words_us = measured_us(frame);
	rc = draw_words(frame, now_ms);
	if (rc == 0)
		rc = setup_page_draw(o->setup_page, o->quads, frame->pictured_ms > 0, now_ms);
	if (rc == 0)
		rc = gl_check("drawing a frame");
	frame->drawn_us = measured_us(frame);
	return rc;
}

int frame_draw(struct frame *frame)
{
	const int64_t now_ms = clock_now_ms(), began_us = clock_thread_us();
	const struct frame_options *o = &frame->options;
	int rc;

	if (context_is_lost())
		return -ENOTRECOVERABLE;
	o->redraw->wanted = false;
	frame->began_us = measured_us(frame);
	move_eye(frame, now_ms);
	frame->last_ms = now_ms;
	tools_show(o->tools);
	layer_choice_show(shown_by(frame));
	back_show(o->back);
	sessions_warm(o->sessions);
	gpu_timer_begin(&frame->timer);
	rc = draw(frame, now_ms);
	gpu_timer_end(&frame->timer);
	frame->work_us = (uint32_t)(clock_thread_us() - began_us);
	frame->count++;
	frame->late_count += frame->work_us > FRAME_BUDGET_US;
	if (rc == 0)
		rc = display_present(o->display);
	frame->spent_us = measured_us(frame) - frame->began_us;
	log_slow(frame);
	frame->pending = shown_by(frame)->frame.moved;
	expect(frame);
	frame_note_shown(frame);
	log_first_picture(frame);
	sessions_keep_first(o->sessions, o->trial->pictured_ms);
	sessions_ask(o->sessions);
	if (shown_by(frame)->frame.moving || frame->words_move || o->eye->moves ||
	    o->anchors->to_test > 0)
		redraw_ask(o->redraw);
	give_back_memory(frame);
	return rc;
}
