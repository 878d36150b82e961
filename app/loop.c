/* The kiosk's event loop: starts the modules, waits for all their descriptors with one epoll,
 * dispatches events, draws frames when they are due, and stops the modules in reverse order. */
#include <errno.h>
#include <limits.h>
#include <signal.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/epoll.h>
#include <sys/signalfd.h>
#include <unistd.h>

#include "app/folder.h"
#include "app/kiosk.h"
#include "app/modes/capture.h"
#include "app/release/updater.h"
#include "base/clock.h"
#include "base/log.h"
#include "base/metrics_socket.h"
#include "base/service.h"
#include "ui/theme.h"

enum {
	FRAME_MS = 16, /* frame period if no panel sets the pace */
	LOST_LEAST_MS = 5000,
	FOV_DEG = 45,
};

/* ---- events of the fetcher */

static void on_object(void *data, struct hash hash, struct bytes bytes)
{
	struct kiosk *kiosk = data;

	bool kept;

	wants_arrived(&kiosk->wants, hash);
	kept = session_give(&kiosk->shown, hash, bytes);
	if (session_give(&kiosk->coming, hash, bytes) || kept)
		net_client_keep(kiosk->net, hash);
	if (kiosk->capture)
		capture_object(kiosk->capture);
	kiosk_redraw(kiosk);
}

static void on_missing(void *data, struct hash hash, enum missing_reason reason)
{
	static const char *const why[] = { "offline", "not on the server", "damaged" };
	char hex[HASH_HEX_BYTES];

	(void)data;
	hash_to_hex(hash, hex);
	log_debug("app", "object %s is missing: %s", hex, why[reason]);
}

static void on_meta(void *data, enum meta_role role, uint32_t version, struct bytes bytes,
		    enum meta_source source)
{
	struct kiosk *kiosk = data;

	updater_meta(kiosk->updater, role, version, bytes, source);
	net_client_trust(kiosk->net, updater_root_version(kiosk->updater));
	kiosk_redraw(kiosk);
}

static void on_synced(void *data, bool done)
{
	session_synced(data, done);
}

static void on_status(void *data, const struct message_status *status)
{
	struct kiosk *kiosk = data;

	if (status->online != kiosk->status.online)
		log_info("app", status->online ? "the museum server answers"
					       : "the museum server does not answer: offline");
	kiosk->status = *status;
	if (kiosk->capture)
		kiosk_redraw(kiosk);
}

static void begin_release(void *data, struct hash root, uint32_t root_bytes)
{
	session_begin(data, root, root_bytes);
}

static void release_remembered(void *data, struct hash root, int rc)
{
	session_remembered(data, root, rc);
}

/* ---- start */

static void on_closed(void *data)
{
	struct kiosk *kiosk = data;

	kiosk->quit = true;
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
		.pointer = fingers_on_pointer,
		.closed = on_closed,
		.data = kiosk,
	};
	int rc = display_create(&kiosk->display, &display);

	if (rc == 0)
		rc = quads_create(&kiosk->quads);
	return rc;
}

static int start_input(struct kiosk *kiosk)
{
	const struct profile *profile = &kiosk->profile;
	const int mm = profile->width_mm ? profile->width_mm : display_width_mm(kiosk->display);
	struct touch_options touch;

	kiosk->px_per_mm =
		mm > 0 ? (float)display_width_px(kiosk->display) / (float)mm
		       : theme_guess_px_per_mm(kiosk_width_px(kiosk), kiosk_height_px(kiosk));
	touch = (struct touch_options){
		.width_px = kiosk_width_px(kiosk),
		.height_px = kiosk_height_px(kiosk),
		.rotation_deg = profile->rotation_deg,
		.edge_px = profile->edge_mm * kiosk->px_per_mm,
		.palm_px = profile->palm_mm * kiosk->px_per_mm,
		.replay_path = kiosk->options.touch_replay_path,
		.event = fingers_on_touch,
		.data = kiosk,
	};

	memcpy(touch.matrix, profile->matrix, sizeof(touch.matrix));
	fingers_init(kiosk);
	/* In a window the mouse acts as the finger, and the desktop owns the touchscreen. */
	if (display_kind(kiosk->display) == DISPLAY_WINDOW && !touch.replay_path)
		return 0;
	return touch_create(&kiosk->touch, &touch);
}

/* Writes the path of gopura-fetch in the folder of this program to out. */
static void fetch_beside(char out[PATH_MAX])
{
	ssize_t length = readlink("/proc/self/exe", out, PATH_MAX - sizeof("gopura-fetch"));
	char *slash;

	out[length > 0 ? length : 0] = '\0';
	slash = strrchr(out, '/');
	memcpy(slash ? slash + 1 : out, "gopura-fetch", sizeof("gopura-fetch"));
}

static int start_net(struct kiosk *kiosk)
{
	char folder[PATH_MAX], cache[PATH_MAX + 16], state[PATH_MAX + 16], program[PATH_MAX];
	char visits[PATH_MAX + 16];
	struct net_client_options net = {
		.socket_path = kiosk->options.socket_path,
		.program = kiosk->options.fetch_program,
		/* Without a server or stick, a folder that holds no release: only what is cached
		 * can be shown. */
		.release_url = kiosk->options.release_url ? kiosk->options.release_url
			       : kiosk->options.stick_dir ? kiosk->options.stick_dir
							  : folder,
		.stick_path = kiosk->options.stick_dir,
		.cache_path = cache,
		.poll_s = kiosk->options.poll_s,
		.cache_budget_bytes = (uint64_t)kiosk->profile.cache_mib << 20,
		.ca_file = kiosk->options.ca_path,
		.redirect_hosts = kiosk->options.redirect_hosts,
		.events = { on_object, on_missing, on_meta, on_synced, on_status },
		.data = kiosk,
	};
	struct updater_options updater = {
		.state_path = state,
		.trust_path = kiosk->options.trust_path,
		.begin = begin_release,
		.remembered = release_remembered,
		.data = kiosk,
	};
	int rc = folder_of_state(kiosk->options.state_dir, folder);

	if (rc < 0)
		return rc;
	if (touch_device_count(kiosk->touch) > 0)
		folder_remember_touch(folder, touch_device_text(kiosk->touch, 0));
	snprintf(cache, sizeof(cache), "%s/cache.db", folder);
	snprintf(state, sizeof(state), "%s/state.db", folder);
	snprintf(visits, sizeof(visits), "%s/visits.csv", folder);
	rc = usage_create(&kiosk->usage, visits, kiosk->options.visits_path, counting_clock_s());
	if (rc < 0)
		return rc;
	if (!net.program) {
		fetch_beside(program);
		net.program = program;
	}
	rc = updater_create(&kiosk->updater, &updater);
	if (rc < 0)
		return rc;
	net.root_version = updater_root_version(kiosk->updater);
	return net_client_create(&kiosk->net, &net);
}

static int start_loop(struct kiosk *kiosk)
{
	sigset_t signals;
	int rc;

	sigemptyset(&signals);
	sigaddset(&signals, SIGINT);
	sigaddset(&signals, SIGTERM);
	sigprocmask(SIG_BLOCK, &signals, NULL);
	kiosk->signal_fd = signalfd(-1, &signals, SFD_CLOEXEC | SFD_NONBLOCK);
	kiosk->epoll_fd = epoll_create1(EPOLL_CLOEXEC);
	if (kiosk->signal_fd < 0 || kiosk->epoll_fd < 0)
		return -errno;
	rc = kiosk_watch(kiosk, kiosk->signal_fd);
	if (rc == 0)
		rc = kiosk_watch(kiosk, display_fd(kiosk->display));
	if (rc == 0)
		rc = kiosk_watch(kiosk, net_client_fd(kiosk->net));
	if (rc == 0)
		rc = kiosk_watch(kiosk, updater_fd(kiosk->updater));
	if (rc == 0 && kiosk->touch)
		rc = kiosk_watch(kiosk, touch_fd(kiosk->touch));
	return rc;
}

int kiosk_start(struct kiosk *kiosk)
{
	int rc = provision_read(&kiosk->provision, &kiosk->options, &kiosk->profile);

	kiosk->started_ms = clock_now_ms();
	presence_init(&kiosk->presence, kiosk->options.idle_s, kiosk->started_ms);
	kiosk->presence_said = kiosk->presence.state;
	if (rc == 0)
		rc = start_display(kiosk);
	if (rc == 0)
		rc = start_input(kiosk);
	if (rc == 0)
		rc = start_net(kiosk);
	if (rc == 0)
		rc = start_loop(kiosk);
	if (rc == 0)
		rc = capture_create(&kiosk->capture, kiosk);
	if (rc == 0)
		rc = vitals_offer(kiosk);
	if (rc == 0)
		updater_start(kiosk->updater);
	if (rc == 0)
		rc = setup_page_show(kiosk);
	kiosk->frame_wanted = true;
	return rc;
}

void kiosk_stop(struct kiosk *kiosk)
{
	metrics_socket_destroy(kiosk->metrics);
	usage_destroy(kiosk->usage);
	capture_destroy(kiosk->capture);
	if (kiosk->epoll_fd >= 0)
		close(kiosk->epoll_fd);
	if (kiosk->signal_fd >= 0)
		close(kiosk->signal_fd);
	updater_destroy(kiosk->updater);
	net_client_destroy(kiosk->net);
	touch_destroy(kiosk->touch);
	session_close(&kiosk->coming);
	session_close(&kiosk->shown);
	setup_page_finish(kiosk);
	if (kiosk->warm_target.framebuffer)
		gl_target_destroy(&kiosk->warm_target);
	quads_destroy(kiosk->quads);
	display_destroy(kiosk->display);
}

/* ---- run */

static int dispatch(struct kiosk *kiosk, int fd)
{
	if (fd == kiosk->signal_fd) {
		kiosk->quit = true;
		return 0;
	}
	if (fd == display_fd(kiosk->display))
		return display_dispatch(kiosk->display);
	if (fd == net_client_fd(kiosk->net))
		return net_client_dispatch(kiosk->net);
	if (fd == updater_fd(kiosk->updater))
		return updater_dispatch(kiosk->updater);
	if (kiosk->touch && fd == touch_fd(kiosk->touch))
		return touch_dispatch(kiosk->touch);
	if (kiosk->metrics && fd == metrics_socket_fd(kiosk->metrics)) {
		metrics_socket_dispatch(kiosk->metrics);
		return 0;
	}
	if (kiosk->shown.scene && fd == scene_fd(kiosk->shown.scene)) {
		kiosk_redraw(kiosk);
		return scene_dispatch(kiosk->shown.scene);
	}
	if (kiosk->coming.scene && fd == scene_fd(kiosk->coming.scene)) {
		kiosk_redraw(kiosk);
		return scene_dispatch(kiosk->coming.scene);
	}
	return 0; /* an event of a scene that was closed just before */
}

/* Returns how many milliseconds the loop may wait for events; -1: without limit. */
static int wait_ms(const struct kiosk *kiosk)
{
	const int64_t since = clock_now_ms() - kiosk->last_frame_ms;
	const bool paced = display_kind(kiosk->display) == DISPLAY_DRM;
	const int coming_ms = session_wait_ms(kiosk);
	const int capture_ms = kiosk->capture ? capture_wait_ms(kiosk->capture) : -1;

	if (!display_ready(kiosk->display))
		return panel_wait_ms(kiosk);
	if (kiosk->frame_wanted)
		return paced || since >= FRAME_MS ? 0 : (int)(FRAME_MS - since);
	return sooner(sooner(sooner(coming_ms, capture_ms), visitor_wait_ms(kiosk)),
		      sooner(sooner(trial_wait_ms(kiosk), setup_page_wait_ms(kiosk)),
			     panel_wait_ms(kiosk)));
}

static int turn(struct kiosk *kiosk)
{
	struct epoll_event ready[8];
	int count = epoll_wait(kiosk->epoll_fd, ready, ARRAY_COUNT(ready), wait_ms(kiosk));
	int rc = 0;

	if (count < 0)
		return errno == EINTR ? 0 : -errno;
	for (int i = 0; i < count && rc == 0; i++)
		rc = dispatch(kiosk, ready[i].data.fd);
	/* Frames must go on by time alone: capture counts its quiet time in frames, the next
	 * release is drawn as part of a frame, and the setup page fades out. */
	if (count == 0 &&
	    (kiosk->capture || session_wait_ms(kiosk) == 0 || setup_page_wait_ms(kiosk) == 0))
		kiosk_redraw(kiosk);
	if (rc == 0 && !kiosk->quit)
		rc = panel_turn(kiosk);
	if (rc < 0 || kiosk->quit)
		return rc;
	trial_watch(kiosk);
	visitor_watch(kiosk);
	if (kiosk->options.quit_after_replay && touch_replay_ended(kiosk->touch) &&
	    (!kiosk->capture || capture_wait_ms(kiosk->capture) < 0))
		kiosk->quit = true;
	if (kiosk->frame_wanted && display_ready(kiosk->display) && wait_ms(kiosk) == 0) {
		if (kiosk->capture)
			capture_aim(kiosk->capture, kiosk);
		rc = frame_draw(kiosk);
		if (rc == 0 && kiosk->capture)
			rc = capture_after(kiosk->capture, kiosk);
	}
	return rc;
}

int kiosk_run(struct kiosk *kiosk)
{
	int rc = 0;

	while (rc == 0 && !kiosk->quit)
		rc = turn(kiosk);
	service_stopping();
	if (rc == -ENOTRECOVERABLE && clock_now_ms() - kiosk->started_ms < LOST_LEAST_MS) {
		log_error("app", "board bug: the GPU loses its context as soon as it is used");
		return -EIO; /* counts as a crash: a restart would not help */
	}
	if (rc == -ENOTRECOVERABLE)
		log_warn("app", "board bug: the GPU lost its context: starting anew");
	else if (rc == -ESTALE)
		log_warn("app", "the panel is another one now: starting anew");
	else if (rc < 0)
		log_error("app", "stopping: %s", strerror(-rc));
	return rc;
}
