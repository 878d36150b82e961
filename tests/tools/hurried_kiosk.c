/* gopura-kiosk on a clock that does not wait: where a kiosk would only wait for time (a visitor, a
 * fade, the next frame) time jumps, so that hours of visits pass in minutes. For the fetcher and
 * the decoders it really waits. With --shots time stands still during that, so that a picture does
 * not depend on how busy the machine is; the frames of a moving eye are as far apart as its longest
 * step, and only a corner of those is drawn of which no picture is taken.
 *
 *   hurried_kiosk [KIOSK OPTIONS] --touch-replay FILE [--log debug]
 *
 * After each frame it checks the budgets of the board, and in each turn of the loop that a terminal
 * which nobody has touched for long shows itself, with nothing left of the visitor. It continues
 * after the replay's end until nobody is there. Exits with 1 and a reason if a check fails. */
#include <errno.h>
#include <math.h>
#include <stdarg.h>
#include <stdatomic.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/epoll.h>
#include <sys/timerfd.h>
#include <time.h>

#include "app/kiosk.h"
#include "app/settings/options.h"
#include "base/clock.h"
#include "render/display/gl.h"
#include "render/scene/scene_parts.h"
#include "ui/overlay.h"

/* The linker wraps these (Makefile). */
int64_t __wrap_clock_now_us(void);
int64_t __wrap_clock_now_ms(void);
int __real_epoll_wait(int fd, struct epoll_event *events, int most, int timeout_ms);
int __wrap_epoll_wait(int fd, struct epoll_event *events, int most, int timeout_ms);
int __real_timerfd_settime(int fd, int flags, const struct itimerspec *to,
			   struct itimerspec *before);
int __wrap_timerfd_settime(int fd, int flags, const struct itimerspec *to,
			   struct itimerspec *before);
void __real_gl_place_bind(const struct gl_place *place, int width_px, int height_px);
void __wrap_gl_place_bind(const struct gl_place *place, int width_px, int height_px);
void __real_gl_target_bind(const struct gl_target *target);
void __wrap_gl_target_bind(const struct gl_target *target);
int __real_frame_draw(struct frame *frame);
int __wrap_frame_draw(struct frame *frame);
void __real_fingers_on_touch(void *data, const struct touch_event *event);
void __wrap_fingers_on_touch(void *data, const struct touch_event *event);

enum {
	TIMERS_MAX = 8,
	LOOK_US = 100,         /* a look at the clock takes so long, so budgets of time end */
	REAL_WAIT_MS = 2,      /* a look at what others do */
	GATHER_MS = 50,        /* of real time without an event */
	HELD_AT_US = 2000000,  /* of the kiosk's life, until there is a picture */
	END_MOST_US = 1200000, /* of a turn, past when nobody should have been there */
	SHOT_FRAME_US = 44000, /* of a frame; the eye's longest step is 50 ms */
	SHOT_NEAR_MS = 200,    /* frames this near to a shot are drawn whole */
	SHOTS_MAX = 256,
	STILL_MOST_MS = 60000, /* of real time; then what is waited for is taken not to come */
};

static struct kiosk kiosk;
static _Atomic int64_t virtual_us = 1000000000;
static struct {
	int fd;
	int64_t due_us;
} timers[TIMERS_MAX];
static uint32_t timer_count;
static bool failed;
static bool heard; /* an event came since the last frame */
static bool stands_still;
static int64_t still_since_ms; /* in real time; 0: since the last frame nothing is waited for */

static struct {
	uint64_t frames, touches, jumps_us;
	uint32_t triangles, layers;
	uint64_t texture_bytes, geometry_bytes;
	uint32_t nobody, asked, card, page, picture, search, typed, large, reach, tools, help,
		language, tour;
} seen;
static int64_t shots_ms[SHOTS_MAX]; /* since the first frame */
static uint32_t shot_count;
static int64_t first_frame_us;
static int64_t last_touch_us; /* or when somebody was last led about */

static void fail(const char *format, ...)
{
	va_list arguments;

	fprintf(stderr, "hurried_kiosk: %.3f s: ", (double)(virtual_us - 1000000000) / 1e6);
	va_start(arguments, format);
	vfprintf(stderr, format, arguments);
	va_end(arguments);
	fputc('\n', stderr);
	failed = true;
	kiosk.loop.quit = true;
}

/* ---- time */

static int64_t real_ms(void)
{
	struct timespec now;

	clock_gettime(CLOCK_MONOTONIC, &now);
	return (int64_t)now.tv_sec * 1000 + now.tv_nsec / 1000000;
}

/* Time stands still before the first picture, when no visitor comes, and while a picture of which
 * shots are taken waits for others. */
static bool held(void)
{
	return stands_still || (!kiosk.frame.pictured_ms && virtual_us > 1000000000 + HELD_AT_US);
}

int64_t __wrap_clock_now_us(void)
{
	return held() ? virtual_us : (virtual_us += LOOK_US);
}

int64_t __wrap_clock_now_ms(void)
{
	return __wrap_clock_now_us() / 1000;
}

int __wrap_timerfd_settime(int fd, int flags, const struct itimerspec *to,
			   struct itimerspec *before)
{
	const int64_t wait_us = to->it_value.tv_sec * 1000000 + to->it_value.tv_nsec / 1000;
	const struct itimerspec never = { 0 };
	uint32_t i = 0;

	while (i < timer_count && timers[i].fd != fd)
		i++;
	if (i == TIMERS_MAX)
		abort();
	if (i == timer_count)
		timer_count++;
	timers[i].fd = fd;
	timers[i].due_us = wait_us > 0 ? virtual_us + wait_us : INT64_MAX;
	return __real_timerfd_settime(fd, flags, &never, before);
}

/* When a timer is due next; those that are rung. */
static int64_t ring_timers(void)
{
	const struct itimerspec now = { .it_value = { .tv_nsec = 1 } };
	int64_t next_us = INT64_MAX;

	for (uint32_t i = 0; i < timer_count; i++) {
		if (timers[i].due_us <= virtual_us) {
			timers[i].due_us = INT64_MAX;
			__real_timerfd_settime(timers[i].fd, 0, &now, NULL);
		}
		next_us = timers[i].due_us < next_us ? timers[i].due_us : next_us;
	}
	return next_us;
}

static void advance(int64_t by_us)
{
	const int64_t next_us = ring_timers();

	if (held())
		return;
	if (!kiosk.frame.pictured_ms && by_us > REAL_WAIT_MS * 1000)
		by_us = REAL_WAIT_MS * 1000;
	if (next_us - virtual_us < by_us)
		by_us = next_us - virtual_us;
	virtual_us += by_us;
	ring_timers();
}

/* Whether a picture that is to be taken comes to be: neither eye nor finger moves it. */
static bool at_rest(void)
{
	bool down = false;

	for (int i = 0; i < TOUCH_CONTACTS_MAX; i++)
		down = down || kiosk.fingers.gestures.fingers[i].down;
	return kiosk.options.shots_path && kiosk.frame.pictured_ms && !kiosk.eye.moves && !down;
}

/* Whether decoders work at what the next frame would show. What they have done before that frame is
 * an event, or waits to be uploaded. */
static bool decoders_work(const struct scene *scene)
{
	return scene && !heard && !scene->uploads_wait && pool_busy(scene->pool) > 0;
}

static bool others_work(void)
{
	const struct exhibit *shown = &kiosk.releases.sessions.shown.exhibit;

	if (!kiosk.frame.pictured_ms || (!shown->frame.settled && !kiosk.redraw.wanted))
		return true;
	return at_rest() && decoders_work(shown->scene);
}

/* Whether time stands still for what others work at. */
static bool is_awaited(bool works)
{
	if (!works || !at_rest())
		return false;
	if (still_since_ms == 0)
		still_since_ms = real_ms();
	return real_ms() - still_since_ms < STILL_MOST_MS;
}

int __wrap_epoll_wait(int fd, struct epoll_event *events, int most, int timeout_ms)
{
	const bool works = others_work();
	int count = __real_epoll_wait(fd, events, most, 0);

	heard = heard || count > 0;
	stands_still = is_awaited(works);
	if (count != 0 || timeout_ms == 0)
		return count;
	if (works || (heard && at_rest())) { /* a frame shows what came together */
		count = __real_epoll_wait(fd, events, most, works ? REAL_WAIT_MS : GATHER_MS);
		if (count > 0 && at_rest()) {
			heard = true;
			return count;
		}
	}
	if (works)
		advance(REAL_WAIT_MS * 1000);
	else
		/* No wait is cut that something else could end but time: look first. */
		advance(timeout_ms < 0 ? INT64_MAX / 2 : (int64_t)timeout_ms * 1000);
	return count != 0 ? count : __real_epoll_wait(fd, events, most, 0);
}

/* ---- what must hold */

static void check_budgets(void)
{
	const struct exhibit *shown = &kiosk.releases.sessions.shown.exhibit;
	const struct scene_options budget = kiosk.releases.sessions.options.scene;
	static struct overlay_layer layers[OVERLAY_LAYERS_MAX + 1];
	const struct scene_frame *frame = &shown->frame;
	struct scene_memory memory = { 0 };
	uint32_t layer_count = 0;

	if (shown->scene)
		scene_memory(shown->scene, &memory);
	if (exhibit_overlay(shown))
		layer_count =
			overlay_layers(exhibit_overlay(shown), layers, OVERLAY_LAYERS_MAX + 1);
	if (frame->triangles > budget.triangle_budget)
		fail("%u triangles drawn, %u are the most", frame->triangles,
		     budget.triangle_budget);
	if (memory.texture_bytes > budget.texture_budget_bytes)
		fail("%llu bytes of textures", (unsigned long long)memory.texture_bytes);
	if (memory.geometry_bytes > budget.geometry_budget_bytes)
		fail("%llu bytes of patches", (unsigned long long)memory.geometry_bytes);
	if (layer_count >= OVERLAY_LAYERS_MAX)
		fail("%u layers of words", layer_count);
	for (int i = 0; i < 3; i++)
		if (!isfinite(kiosk.eye.camera.eye_m[i]) || !isfinite(kiosk.eye.camera.target_m[i]))
			fail("the eye is nowhere");
#define MOST(what, value) seen.what = seen.what > (value) ? seen.what : (value)
	MOST(triangles, frame->triangles);
	MOST(layers, layer_count);
	MOST(texture_bytes, memory.texture_bytes);
	MOST(geometry_bytes, memory.geometry_bytes);
}

static void look_at_words(const struct overlay *overlay)
{
	seen.card += overlay_card(overlay) >= 0;
	seen.page += overlay_page(overlay) >= 0;
	seen.picture += overlay_picture(overlay) >= 0;
	seen.search += overlay_searching(overlay);
	seen.typed += overlay_searching(overlay) && overlay_query(overlay)[0];
	seen.large += overlay_comfort(overlay).large;
	seen.reach += overlay_comfort(overlay).reach;
	seen.tools += tools_are_used(&kiosk.tools);
	seen.help += overlay_help(overlay);
	seen.language +=
		strcmp(information_view_language(kiosk.releases.sessions.shown.exhibit.view),
		       info_language(exhibit_info(&kiosk.releases.sessions.shown.exhibit), 0)) != 0;
}

static bool somebody_is_led(void)
{
	return !kiosk.tours.tour.loops && tour_runs(&kiosk.tours.tour);
}

/* Whether a frame is replaced by the next one before a picture of it is taken. */
static bool nobody_sees_frame(void)
{
	const struct scene *scene = kiosk.releases.sessions.shown.exhibit.scene;
	const int64_t now_ms = (virtual_us - first_frame_us) / 1000;

	if (!kiosk.options.shots_path || !scene || !scene->was_moving)
		return false;
	for (uint32_t i = 0; i < shot_count; i++)
		if (llabs(shots_ms[i] - now_ms) < SHOT_NEAR_MS)
			return false;
	return true;
}

static void draw_corner_alone(void)
{
	glEnable(GL_SCISSOR_TEST);
	glScissor(0, 0, 1, 1);
}

/* From here to the end of a frame everything is drawn to the panel. */
void __wrap_gl_place_bind(const struct gl_place *place, int width_px, int height_px)
{
	__real_gl_place_bind(place, width_px, height_px);
	if (nobody_sees_frame())
		draw_corner_alone();
}

/* Pictures of a moving eye may be drawn aside first. What passes draw aside is needed. */
void __wrap_gl_target_bind(const struct gl_target *target)
{
	const struct scene *scene = kiosk.releases.sessions.shown.exhibit.scene;

	__real_gl_target_bind(target);
	if (scene && target == &scene->accumulation.frame && nobody_sees_frame())
		draw_corner_alone();
}

int __wrap_frame_draw(struct frame *of)
{
	const struct exhibit *shown = &kiosk.releases.sessions.shown.exhibit;
	const int64_t next_us = virtual_us + SHOT_FRAME_US;
	int rc;

	if (first_frame_us == 0)
		first_frame_us = virtual_us;

	heard = stands_still = false;
	still_since_ms = 0;
	rc = __real_frame_draw(of);
	glDisable(GL_SCISSOR_TEST);
	/* Frames that refine a picture at rest are as close as ever, unless something fades in:
	 * time is not for the others to pass. */
	if (kiosk.options.shots_path && virtual_us < next_us &&
	    (!at_rest() || shown->frame.settled || (shown->scene && shown->scene->fading)))
		virtual_us = next_us;
	ring_timers(); /* the next frame may be due too */
	seen.frames++;
	seen.tour += somebody_is_led();
	if (somebody_is_led())
		last_touch_us = virtual_us;
	check_budgets();
	if (exhibit_overlay(&kiosk.releases.sessions.shown.exhibit))
		look_at_words(exhibit_overlay(&kiosk.releases.sessions.shown.exhibit));
	return rc;
}

/* A finger's event: what was before it must have been right. */
void __wrap_fingers_on_touch(void *data, const struct touch_event *event)
{
	const int64_t idle_us = (int64_t)kiosk.visitor.presence.idle_ms * 1000;
	const int64_t most_us =
		PRESENCE_READ_TIMES * idle_us + PRESENCE_ASK_MS * 1000 + END_MOST_US;
	const enum presence_state state = kiosk.visitor.presence.state;

	seen.asked += state == PRESENCE_ASKED;
	if (seen.touches > 0 && !somebody_is_led() && virtual_us - last_touch_us > most_us) {
		seen.nobody++;
		if (state != PRESENCE_NOBODY)
			fail("nobody touched it for %.1f s, and it does not show itself",
			     (double)(virtual_us - last_touch_us) / 1e6);
	}
	seen.touches++;
	last_touch_us = virtual_us;
	__real_fingers_on_touch(data, event);
}

/* Nothing of the last visitor is there. */
static void check_attract(void)
{
	struct overlay *overlay = exhibit_overlay(&kiosk.releases.sessions.shown.exhibit);

	if (kiosk.visitor.presence.state != PRESENCE_NOBODY || !overlay) {
		fail("it does not show itself at the end");
		return;
	}
	if (overlay_card(overlay) >= 0 || overlay_page(overlay) >= 0 ||
	    overlay_picture(overlay) >= 0 || overlay_searching(overlay) || overlay_help(overlay) ||
	    overlay_choosing(overlay) || overlay_choosing_language(overlay) ||
	    (kiosk.tours.tour.state != TOUR_OFF && !kiosk.tours.tour.loops))
		fail("something is open while nobody is there");
	if (overlay_comfort(overlay).large || overlay_comfort(overlay).reach)
		fail("large type or reach stayed");
	if (tools_are_used(&kiosk.tools))
		fail("a tool stayed");
	if (strcmp(information_view_language(kiosk.releases.sessions.shown.exhibit.view),
		   info_language(exhibit_info(&kiosk.releases.sessions.shown.exhibit), 0)) != 0)
		fail("the language stayed %s",
		     information_view_language(kiosk.releases.sessions.shown.exhibit.view));
	if (overlay_tap(overlay, 1, 1).kind != OVERLAY_NONE)
		fail("something lies in the corner that is the model's");
	for (int i = 0; i < TOUCH_CONTACTS_MAX; i++)
		if (kiosk.fingers.gestures.fingers[i].down)
			fail("finger %d is still down", i);
	if (kiosk.fingers.on_keys != 0)
		fail("keys are still held");
}

/* ---- run */

/* As app/main.c does, but that it ends when nobody is there any more. */
static int run(void)
{
	const struct options asked = kiosk.options;
	int64_t until_us;
	int rc;

	kiosk.options.quit_after_replay = true;
	rc = kiosk_run(&kiosk);
	if (rc < 0 || failed || asked.shots_path)
		return rc;
	until_us = virtual_us +
		   PRESENCE_READ_TIMES * (int64_t)kiosk.visitor.presence.idle_ms * 1000 +
		   PRESENCE_ASK_MS * 1000 + END_MOST_US;
	while (rc == 0 && !failed && kiosk.visitor.presence.state != PRESENCE_NOBODY &&
	       virtual_us < until_us) {
		if (somebody_is_led()) /* which ends by itself, and then it is as after a touch */
			until_us = virtual_us + kiosk.tours.tour.path.duration_ms * 1000 +
				   PRESENCE_READ_TIMES * (int64_t)kiosk.visitor.presence.idle_ms *
					   1000 +
				   PRESENCE_ASK_MS * 1000 + END_MOST_US;
		kiosk.loop.quit = false; /* the replay ended: a turn sets it again */
		rc = kiosk_run(&kiosk);
	}
	if (rc == 0 && !failed)
		check_attract();
	return rc;
}

static void read_shots(const char *path)
{
	FILE *file = fopen(path, "r");
	long long at_ms;

	while (file && shot_count < SHOTS_MAX && fscanf(file, "%lld %*s", &at_ms) == 1)
		shots_ms[shot_count++] = at_ms;
	if (file)
		fclose(file);
}

int main(int argc, char **argv)
{
	int rc;

	if (options_parse(&kiosk.options, argc, argv) != OPTIONS_RUN ||
	    !kiosk.options.touch_replay_path) {
		fputs("usage: hurried_kiosk [KIOSK OPTIONS] --touch-replay FILE\n", stderr);
		return 2;
	}
	if (kiosk.options.shots_path)
		read_shots(kiosk.options.shots_path);
	rc = kiosk_start(&kiosk);
	kiosk.frame.governor.bounds.scale_least = 1; /* its clock tells nothing about a frame */
	if (rc == 0)
		rc = run();
	printf("{\"touches\": %llu, \"frames\": %llu, \"seconds\": %.1f,\n"
	       " \"triangles_most\": %u, \"texture_bytes_most\": %llu, \"geometry_bytes_most\": "
	       "%llu, \"layers_most\": %u,\n"
	       " \"left_alone\": %u, \"asked\": %u,\n"
	       " \"frames_with\": {\"card\": %u, \"page\": %u, \"picture\": %u, \"search\": %u, "
	       "\"typed\": %u, \"help\": %u, \"large\": %u, \"reach\": %u, \"tools\": %u, "
	       "\"language\": %u, \"tour\": %u}}\n",
	       (unsigned long long)seen.touches, (unsigned long long)seen.frames,
	       (double)(virtual_us - 1000000000) / 1e6, seen.triangles,
	       (unsigned long long)seen.texture_bytes, (unsigned long long)seen.geometry_bytes,
	       seen.layers, seen.nobody, seen.asked, seen.card, seen.page, seen.picture,
	       seen.search, seen.typed, seen.help, seen.large, seen.reach, seen.tools,
	       seen.language, seen.tour);
	kiosk_stop(&kiosk);
	if (rc < 0)
		fprintf(stderr, "hurried_kiosk: %s\n", strerror(-rc));
	return rc == 0 && !failed ? 0 : 1;
}
