/* Connects the kiosk's modules: gives each what it works with, passes events between them, and
 * lists the sources and tasks of the loop. */
#include "app/kiosk.h"

#include <errno.h>
#include <limits.h>
#include <stdio.h>
#include <string.h>
#include <unistd.h>

#include "app/settings/folder.h"
#include "app/settings/scene_settings.h"
#include "base/clock.h"
#include "base/log.h"
#include "base/metrics_socket.h"
#include "base/service.h"
#include "ui/theme.h"

enum { LOST_LEAST_MS = 5000 };

/* ---- the event that another release is shown */

static void forget_textures(void *data, const struct exhibit_change *change)
{
	(void)change;
	quads_forget(data);
}

static void on_release_changed(void *data, const struct exhibit_change *change)
{
	struct kiosk *kiosk = data;
	const struct {
		void (*take)(void *data, const struct exhibit_change *change);
		void *data;
	} listeners[] = {
		{ wants_on_release, &kiosk->releases.wants },
		{ visitor_on_release, &kiosk->visitor },
		{ tour_player_on_release, &kiosk->tours },
		{ back_on_release, &kiosk->back },
		{ listening_on_release, &kiosk->listening },
		{ anchors_on_release, &kiosk->anchors },
		{ eye_on_release, &kiosk->eye },
		{ forget_textures, kiosk->quads },
		{ releases_on_release, &kiosk->releases },
	};

	for (size_t i = 0; i < ARRAY_COUNT(listeners); i++)
		listeners[i].take(listeners[i].data, change);
}

/* ---- events from one room to another */

static int on_visitor_asked(void *data)
{
	const struct kiosk *kiosk = data;

	return visitor_left_ms(&kiosk->visitor);
}

static void on_visit_ended(void *data)
{
	struct kiosk *kiosk = data;

	fingers_reset(&kiosk->fingers);
}

static void on_object_arrived(void *data)
{
	struct kiosk *kiosk = data;

	if (kiosk->capture)
		capture_object(kiosk->capture);
}

/* A capture counts the bytes received. */
static void on_status_arrived(void *data)
{
	struct kiosk *kiosk = data;

	if (kiosk->capture)
		redraw_ask(&kiosk->redraw);
}

/* ---- start: panel and touch */

static void on_pointer(void *data, enum pointer_kind kind, float x_px, float y_px, float steps)
{
	struct kiosk *kiosk = data;

	fingers_on_pointer(&kiosk->fingers, kind, x_px, y_px, steps);
}

static void on_closed(void *data)
{
	struct kiosk *kiosk = data;

	loop_quit(&kiosk->loop);
}

static void set_viewport(struct kiosk *kiosk)
{
	const struct profile *profile = &kiosk->profile;
	const int mm = profile->width_mm ? profile->width_mm : display_width_mm(kiosk->display);
	struct viewport *viewport = &kiosk->viewport;

	viewport->panel_width_px = display_width_px(kiosk->display);
	viewport->panel_height_px = display_height_px(kiosk->display);
	viewport->rotation_deg = profile->rotation_deg;
	viewport->px_per_mm = mm > 0 ? (float)viewport->panel_width_px / (float)mm
				     : theme_guess_px_per_mm(viewport_width_px(viewport),
							     viewport_height_px(viewport));
}

static int start_display(struct kiosk *kiosk)
{
	const struct display_options display = {
		.kind = kiosk->options.display,
		.width_px = kiosk->options.width_px,
		.height_px = kiosk->options.height_px,
		.hz = kiosk->options.hz,
		.device = kiosk->options.device,
		.title = "Gopura",
		.pointer = on_pointer,
		.closed = on_closed,
		.data = kiosk,
	};
	int rc = display_create(&kiosk->display, &display);

	if (rc == 0)
		rc = quads_create(&kiosk->quads);
	if (rc == 0)
		set_viewport(kiosk);
	return rc;
}

static int start_touch(struct kiosk *kiosk)
{
	const struct profile *profile = &kiosk->profile;
	struct touch_options touch = {
		.width_px = viewport_width_px(&kiosk->viewport),
		.height_px = viewport_height_px(&kiosk->viewport),
		.rotation_deg = profile->rotation_deg,
		.edge_px = profile->edge_mm * kiosk->viewport.px_per_mm,
		.palm_px = profile->palm_mm * kiosk->viewport.px_per_mm,
		.replay_path = kiosk->options.touch_replay_path,
		.event = fingers_on_touch,
		.data = &kiosk->fingers,
	};

	memcpy(touch.matrix, profile->matrix, sizeof(touch.matrix));
	/* In a window the mouse acts as the finger, and the desktop owns the touchscreen. */
	if (display_kind(kiosk->display) == DISPLAY_WINDOW && !touch.replay_path)
		return 0;
	return touch_create(&kiosk->touch, &touch);
}

/* ---- start: state and releases */

/* Of what is written on the panel. A profile's width is meant as it is. */
static float words_px_per_mm(const struct kiosk *kiosk)
{
	const float px_per_mm = kiosk->viewport.px_per_mm;

	return kiosk->profile.width_mm > 0 ? px_per_mm : theme_legible_px_per_mm(px_per_mm);
}

static struct sessions_options sessions_options(struct kiosk *kiosk)
{
	return (struct sessions_options){
		.scene = scene_settings(&kiosk->profile, kiosk->options.mode),
		.view = { .width_px = viewport_width_px(&kiosk->viewport),
			  .height_px = viewport_height_px(&kiosk->viewport),
			  .px_per_mm = words_px_per_mm(kiosk),
			  .language = kiosk->options.language,
			  .sound = kiosk->options.loudness > 0 },
		.download = kiosk->options.download,
		.eye = &kiosk->eye,
		.redraw = &kiosk->redraw,
		.visitor_left_ms = on_visitor_asked,
		.changed = on_release_changed,
		.data = kiosk,
	};
}

static int start_releases(struct kiosk *kiosk, const char *folder)
{
	const struct options *options = &kiosk->options;
	char cache[PATH_MAX + 16], state[PATH_MAX + 16], program[PATH_MAX];
	struct releases_options releases = {
		.state_path = state,
		.trust_path = options->trust_path,
		.target = options->target,
		.net = { .socket_path = options->socket_path,
			 .program = options->fetch_program,
			 /* Without a server or stick, a folder that holds no release: only what is
			  * cached can be shown. */
			 .release_url = options->release_url ? options->release_url
					: options->stick_dir ? options->stick_dir
							     : folder,
			 .stick_path = options->stick_dir,
			 .cache_path = cache,
			 .poll_s = options->poll_s,
			 .cache_budget_bytes = (uint64_t)kiosk->profile.cache_mib << 20,
			 .ca_file = options->ca_path,
			 .redirect_hosts = options->redirect_hosts },
		.sessions = sessions_options(kiosk),
		.object_arrived = on_object_arrived,
		.status_arrived = on_status_arrived,
	};

	snprintf(cache, sizeof(cache), "%s/cache.db", folder);
	snprintf(state, sizeof(state), "%s/state.db", folder);
	if (!releases.net.program) {
		folder_beside_program("gopura-fetch", program);
		releases.net.program = program;
	}
	return releases_init(&kiosk->releases, &releases);
}

static int start_state(struct kiosk *kiosk)
{
	char folder[PATH_MAX], visits[PATH_MAX + 16];
	int rc = folder_of_state(kiosk->options.state_dir, folder);

	if (rc < 0)
		return rc;
	if (touch_device_count(kiosk->touch) > 0)
		folder_remember_touch(folder, touch_device_text(kiosk->touch, 0));
	snprintf(visits, sizeof(visits), "%s/visits.csv", folder);
	rc = counting_init(&kiosk->counting, &kiosk->releases.sessions.shown.exhibit, visits,
			   kiosk->options.visits_path);
	if (rc == 0)
		rc = start_releases(kiosk, folder);
	return rc;
}

/* ---- start: what each module works with */

static void connect_visit(struct kiosk *kiosk)
{
	const struct exhibit *shown = &kiosk->releases.sessions.shown.exhibit;

	eye_init(&kiosk->eye, shown);
	tools_init(&kiosk->tools, &(struct tools_env){ shown, &kiosk->eye, &kiosk->viewport,
						       &kiosk->anchors, &kiosk->redraw });
	tour_player_init(
		&kiosk->tours,
		&(struct tour_player_env){ shown, &kiosk->eye, &kiosk->counting, &kiosk->redraw });
	back_init(&kiosk->back, &(struct back_env){ shown, &kiosk->eye, &kiosk->tours });
	kiosk->actions = (struct actions){
		shown,         &kiosk->eye,  &kiosk->viewport, &kiosk->tours,
		&kiosk->tools, &kiosk->back, &kiosk->counting, &kiosk->listening
	};
	visitor_init(&kiosk->visitor,
		     &(struct visitor_options){ .idle_s = kiosk->options.idle_s,
						.language = kiosk->options.language,
						.off = kiosk->options.views_path },
		     &(struct visitor_env){ .shown = shown,
					    .eye = &kiosk->eye,
					    .tours = &kiosk->tours,
					    .listening = &kiosk->listening,
					    .tools = &kiosk->tools,
					    .back = &kiosk->back,
					    .counting = &kiosk->counting,
					    .redraw = &kiosk->redraw,
					    .ended = on_visit_ended,
					    .data = kiosk });
}

static bool touch_waits_for(void *data)
{
	const struct kiosk *kiosk = data;

	return touch_waits(kiosk->touch);
}

static void connect_panel(struct kiosk *kiosk)
{
	const struct options *options = &kiosk->options;
	const bool captures = options->views_path || options->shots_path;

	setup_page_init(&kiosk->setup_page, &kiosk->viewport, &kiosk->redraw);
	panel_init(&kiosk->panel, &(struct panel_options){ .hours = options->hours,
							   .wake_min = options->wake_min,
							   .shift = options->shift && !captures,
							   .display = kiosk->display,
							   .viewport = &kiosk->viewport,
							   .redraw = &kiosk->redraw });
	fingers_init(&kiosk->fingers,
		     &(struct fingers_env){ .panel = &kiosk->panel,
					    .setup_page = &kiosk->setup_page,
					    .visitor = &kiosk->visitor,
					    .tools = &kiosk->tools,
					    .actions = &kiosk->actions,
					    .shown = &kiosk->releases.sessions.shown.exhibit,
					    .eye = &kiosk->eye,
					    .tours = &kiosk->tours,
					    .viewport = &kiosk->viewport,
					    .redraw = &kiosk->redraw });
	frame_init(&kiosk->frame, &(struct frame_options){
					  .started_ms = kiosk->started_ms,
					  .views = options->views_path,
					  .words = options->capture_overlay || !options->views_path,
					  .scale_least = kiosk->profile.scale_least,
					  .touch_waits = touch_waits_for,
					  .data = kiosk,
					  .display = kiosk->display,
					  .quads = kiosk->quads,
					  .viewport = &kiosk->viewport,
					  .redraw = &kiosk->redraw,
					  .eye = &kiosk->eye,
					  .anchors = &kiosk->anchors,
					  .sessions = &kiosk->releases.sessions,
					  .trial = &kiosk->releases.trial,
					  .visitor = &kiosk->visitor,
					  .tours = &kiosk->tours,
					  .tools = &kiosk->tools,
					  .back = &kiosk->back,
					  .setup_page = &kiosk->setup_page });
}

/* ---- start: the loop */

static int on_signal(void *data)
{
	struct kiosk *kiosk = data;

	loop_quit(&kiosk->loop);
	return 0;
}

static int dispatch_display(void *data)
{
	struct kiosk *kiosk = data;

	const int rc = display_dispatch(kiosk->display);

	frame_note_shown(&kiosk->frame);
	return rc;
}

static int dispatch_net(void *data)
{
	struct kiosk *kiosk = data;

	return net_client_dispatch(kiosk->releases.net);
}

static int dispatch_updater(void *data)
{
	struct kiosk *kiosk = data;

	return updater_dispatch(kiosk->releases.updater);
}

static int dispatch_sessions(void *data)
{
	struct kiosk *kiosk = data;

	return sessions_dispatch(&kiosk->releases.sessions);
}

static int dispatch_touch(void *data)
{
	struct kiosk *kiosk = data;

	return touch_dispatch(kiosk->touch);
}

static int dispatch_metrics(void *data)
{
	struct kiosk *kiosk = data;

	metrics_socket_dispatch(kiosk->metrics);
	return 0;
}

/* Returns whether the kiosk waits for something to happen: no frame is on its way or due. What is
 * done by time waits for that, because a frame does it too. */
static bool is_at_rest(const struct kiosk *kiosk)
{
	return display_ready(kiosk->display) && !kiosk->redraw.wanted;
}

static int panel_wait(void *data)
{
	const struct kiosk *kiosk = data;

	return panel_wait_ms(&kiosk->panel);
}

static int panel_step(void *data)
{
	struct kiosk *kiosk = data;

	return panel_turn(&kiosk->panel, kiosk->frame.last_ms);
}

/* The next release is loaded while the panel is dark too. */
static int releases_wait(void *data)
{
	const struct kiosk *kiosk = data;
	const bool is_dark = display_is_dark(kiosk->display);
	int wait_ms = -1;

	if (is_at_rest(kiosk) || is_dark)
		wait_ms = releases_wait_ms(&kiosk->releases);
	if (is_at_rest(kiosk))
		wait_ms = clock_sooner_ms(
			wait_ms,
			releases_trial_wait_ms(&kiosk->releases, kiosk->frame.last_ms, is_dark));
	return wait_ms;
}

static int releases_step(void *data)
{
	struct kiosk *kiosk = data;

	releases_turn(&kiosk->releases, kiosk->frame.last_ms, display_is_dark(kiosk->display));
	return 0;
}

static int visitor_wait(void *data)
{
	const struct kiosk *kiosk = data;

	return is_at_rest(kiosk) ? visitor_wait_ms(&kiosk->visitor) : -1;
}

static int visitor_step(void *data)
{
	struct kiosk *kiosk = data;

	visitor_turn(&kiosk->visitor, display_is_dark(kiosk->display));
	return 0;
}

static int listening_wait(void *data)
{
	const struct kiosk *kiosk = data;

	return listening_wait_ms(&kiosk->listening);
}

static int listening_step(void *data)
{
	struct kiosk *kiosk = data;

	listening_turn(&kiosk->listening);
	return 0;
}

static int setup_page_wait(void *data)
{
	const struct kiosk *kiosk = data;

	return is_at_rest(kiosk)
		       ? setup_page_wait_ms(&kiosk->setup_page, kiosk->frame.pictured_ms > 0)
		       : -1;
}

/* The page fades out in frames. */
static int setup_page_step(void *data)
{
	struct kiosk *kiosk = data;

	if (setup_page_wait_ms(&kiosk->setup_page, kiosk->frame.pictured_ms > 0) == 0)
		redraw_ask(&kiosk->redraw);
	return 0;
}

static int capture_wait(void *data)
{
	const struct kiosk *kiosk = data;

	return kiosk->capture && is_at_rest(kiosk)
		       ? capture_wait_ms(kiosk->capture, kiosk->frame.last_ms)
		       : -1;
}

/* A capture counts its quiet time in frames. */
static int capture_step(void *data)
{
	struct kiosk *kiosk = data;

	if (kiosk->capture && capture_wait_ms(kiosk->capture, kiosk->frame.last_ms) == 0)
		redraw_ask(&kiosk->redraw);
	return 0;
}

static int frame_wait(void *data)
{
	const struct kiosk *kiosk = data;
	const int64_t since_ms = clock_now_ms() - kiosk->frame.last_ms;
	const int panel_ms = (int)(display_refresh_us(kiosk->display) / 1000);
	const int period_ms = frame_period_ms(&kiosk->frame);

	if (!kiosk->redraw.wanted || !display_ready(kiosk->display))
		return -1;
	/* A panel sets the pace by being ready; only at a divisor of its rate refreshes are let
	 * pass. */
	if (panel_ms > 0 && period_ms < 2 * panel_ms)
		return 0;
	return since_ms >= period_ms ? 0 : (int)(period_ms - since_ms);
}

static int draw_captured(struct kiosk *kiosk)
{
	struct capture_frame drawn = { .display = kiosk->display,
				       .shown = &kiosk->releases.sessions.shown.exhibit };
	int rc;

	capture_aim(kiosk->capture, &kiosk->eye, &kiosk->viewport,
		    kiosk->releases.status.received_bytes);
	rc = frame_draw(&kiosk->frame);
	if (rc < 0)
		return rc;
	drawn.words_move = kiosk->frame.words_move;
	drawn.work_us = kiosk->frame.work_us;
	drawn.received_bytes = kiosk->releases.status.received_bytes;
	rc = capture_after(kiosk->capture, &drawn);
	if (rc > 0)
		loop_quit(&kiosk->loop);
	return rc < 0 ? rc : 0;
}

static int frame_step(void *data)
{
	struct kiosk *kiosk = data;

	if (kiosk->redraw.wanted && display_is_dark(kiosk->display))
		return frame_unseen(&kiosk->frame);
	if (frame_wait(kiosk) != 0)
		return 0;
	return kiosk->capture ? draw_captured(kiosk) : frame_draw(&kiosk->frame);
}

static int replay_step(void *data)
{
	struct kiosk *kiosk = data;

	if (kiosk->options.quit_after_replay && touch_replay_ended(kiosk->touch) &&
	    (!kiosk->capture || capture_wait_ms(kiosk->capture, kiosk->frame.last_ms) < 0))
		loop_quit(&kiosk->loop);
	return 0;
}

static int start_loop(struct kiosk *kiosk)
{
	const int touch_fd_or_none = kiosk->touch ? touch_fd(kiosk->touch) : -1;
	const struct loop_source sources[] = {
		{ "signals", kiosk->signal_fd, on_signal, kiosk },
		{ "display", display_fd(kiosk->display), dispatch_display, kiosk },
		{ "fetcher", net_client_fd(kiosk->releases.net), dispatch_net, kiosk },
		{ "updater", updater_fd(kiosk->releases.updater), dispatch_updater, kiosk },
		{ "decoders", sessions_fd(&kiosk->releases.sessions), dispatch_sessions, kiosk },
		{ "touch", touch_fd_or_none, dispatch_touch, kiosk },
		{ "metrics", metrics_socket_fd(kiosk->metrics), dispatch_metrics, kiosk },
	};
	/* The frame comes after all that may ask for one. */
	const struct loop_task tasks[] = {
		{ "panel", panel_wait, panel_step, kiosk },
		{ "releases", releases_wait, releases_step, kiosk },
		{ "visitor", visitor_wait, visitor_step, kiosk },
		{ "listening", listening_wait, listening_step, kiosk },
		{ "set-up page", setup_page_wait, setup_page_step, kiosk },
		{ "capture", capture_wait, capture_step, kiosk },
		{ "frame", frame_wait, frame_step, kiosk },
		{ "replay", NULL, replay_step, kiosk },
	};

	return loop_init(&kiosk->loop, sources, ARRAY_COUNT(sources), tasks, ARRAY_COUNT(tasks));
}

static int start_metrics(struct kiosk *kiosk)
{
	/* With a replayed file no touch device is expected. */
	const bool has_devices = !kiosk->options.touch_replay_path;

	kiosk->vitals = (struct vitals){ .frame = &kiosk->frame,
					 .sessions = &kiosk->releases.sessions,
					 .updater = kiosk->releases.updater,
					 .wants = &kiosk->releases.wants,
					 .touch = has_devices ? kiosk->touch : NULL };
	if (!kiosk->options.metrics_path)
		return 0;
	return vitals_offer(&kiosk->metrics, &kiosk->vitals, kiosk->options.metrics_path);
}

static int read_settings(struct kiosk *kiosk)
{
	const int rc = provision_read(&kiosk->provision, &kiosk->options, &kiosk->profile);

	folder_open_catalogues(kiosk->options.locale_dir);
	kiosk->started_ms = clock_now_ms();
	return rc;
}

static int start_visit(struct kiosk *kiosk)
{
	const struct listening_env listening = { &kiosk->releases.sessions.shown.exhibit,
						 &kiosk->redraw };

	connect_visit(kiosk);
	connect_panel(kiosk);
	return listening_init(&kiosk->listening, &listening, (uint32_t)kiosk->options.loudness);
}

static int start_capture(struct kiosk *kiosk)
{
	return capture_create(&kiosk->capture, &kiosk->options, &kiosk->redraw);
}

static int start_signals(struct kiosk *kiosk)
{
	kiosk->signal_fd = service_stop_fd();
	return kiosk->signal_fd < 0 ? kiosk->signal_fd : 0;
}

static int show_release(struct kiosk *kiosk)
{
	releases_start(&kiosk->releases);
	return setup_page_show(&kiosk->setup_page, &kiosk->options, &kiosk->provision,
			       kiosk->releases.sessions.shown.exhibit.scene);
}

int kiosk_start(struct kiosk *kiosk)
{
	static const struct {
		const char *name;
		int (*start)(struct kiosk *kiosk);
	} parts[] = {
		{ "settings", read_settings }, { "display", start_display },
		{ "touch", start_touch },      { "visit", start_visit },
		{ "state", start_state },      { "capture", start_capture },
		{ "metrics", start_metrics },  { "signals", start_signals },
		{ "loop", start_loop },        { "release", show_release },
	};
	int rc = 0;

	for (size_t i = 0; i < ARRAY_COUNT(parts) && rc == 0; i++) {
		rc = parts[i].start(kiosk);
		if (rc < 0)
			log_error("app", "the kiosk does not start: %s: %s", parts[i].name,
				  strerror(-rc));
	}
	redraw_ask(&kiosk->redraw);
	return rc;
}

void kiosk_stop(struct kiosk *kiosk)
{
	loop_finish(&kiosk->loop);
	if (kiosk->signal_fd > 0)
		close(kiosk->signal_fd);
	metrics_socket_destroy(kiosk->metrics);
	capture_destroy(kiosk->capture);
	listening_finish(&kiosk->listening);
	releases_finish(&kiosk->releases);
	counting_finish(&kiosk->counting);
	setup_page_finish(&kiosk->setup_page);
	touch_destroy(kiosk->touch);
	quads_destroy(kiosk->quads);
	frame_finish(&kiosk->frame);
	display_destroy(kiosk->display);
	provision_finish(&kiosk->provision);
}

/* Whether the start, or the first picture after it, is only seconds ago. */
static bool is_lost_at_once(const struct kiosk *kiosk)
{
	const int64_t started_ms = kiosk->started_ms, pictured_ms = kiosk->frame.pictured_ms;

	return clock_now_ms() - (pictured_ms > 0 ? pictured_ms : started_ms) < LOST_LEAST_MS;
}

int kiosk_run(struct kiosk *kiosk)
{
	const int rc = loop_run(&kiosk->loop);

	service_stopping();
	if (rc == -ENOTRECOVERABLE && is_lost_at_once(kiosk)) {
		log_error("app", "board bug: the GPU loses its context as soon as it is used");
		return -EIO; /* counts as a crash: a restart would not help */
	}
	if (rc == -ENOTRECOVERABLE)
		log_warn("app", "board bug: the GPU lost its context; the kiosk restarts");
	else if (rc == -ESTALE)
		log_warn("app", "there is another panel or card; the kiosk restarts");
	else if (rc < 0)
		log_error("app", "stopping: %s: %s",
			  kiosk->loop.failed ? kiosk->loop.failed : "the loop", strerror(-rc));
	return rc;
}
