/* Opens releases, gives them what arrives, and decides when the next one takes the place of the
 * other. */
#include "app/release/sessions.h"

#include <errno.h>
#include <string.h>
#include <sys/epoll.h>
#include <unistd.h>

#include "base/clock.h"
#include "base/compiler.h"
#include "base/log.h"

enum {
	WARM_PERIOD_MS = 100,
	/* Longest wait for a complete picture; then what there is of it is shown. */
	WARM_MOST_MS = 60000,
	WARM_WIDTH_PX = 320,
	FORGETFUL_MS = 30000,  /* wait before a failed write or sync is tried again */
	HELD_MS = 60000,       /* interval of checking the time of day */
	WHOLE_MOST_MS = 20000, /* longest wait before the first picture is synced */
	AGAIN_MS = 1000,       /* wait before a release is opened again that could not be */
	/* Wait before a release is loaded a third time, because the disk refused some of it again:
	 * each time may cost the line all of it. */
	LOAD_AGAIN_MS = 3600000,
};

int sessions_init(struct sessions *sessions, const struct sessions_options *options)
{
	*sessions = (struct sessions){ .options = *options };
	sessions->epoll_fd = epoll_create1(EPOLL_CLOEXEC);
	return sessions->epoll_fd < 0 ? -errno : 0;
}

static void close_session(struct session *session)
{
	exhibit_close(&session->exhibit);
	*session = (struct session){ 0 };
}

void sessions_finish(struct sessions *sessions)
{
	close_session(&sessions->coming);
	close_session(&sessions->shown);
	if (sessions->warm_target.framebuffer)
		gl_target_destroy(&sessions->warm_target);
	if (sessions->epoll_fd > 0)
		close(sessions->epoll_fd);
	sessions->epoll_fd = 0;
}

/* ---- the scenes' descriptors */

static int watch(const struct sessions *sessions, int fd)
{
	struct epoll_event event = { .events = EPOLLIN, .data.fd = fd };

	return epoll_ctl(sessions->epoll_fd, EPOLL_CTL_ADD, fd, &event) < 0 ? -errno : 0;
}

int sessions_fd(const struct sessions *sessions)
{
	return sessions->epoll_fd;
}

int sessions_dispatch(struct sessions *sessions)
{
	struct scene *const scenes[] = { sessions->shown.exhibit.scene,
					 sessions->coming.exhibit.scene };
	struct epoll_event ready[ARRAY_COUNT(scenes)];
	const int count = epoll_wait(sessions->epoll_fd, ready, ARRAY_COUNT(ready), 0);
	int rc = 0;

	if (count < 0)
		return errno == EINTR ? 0 : -errno;
	for (int i = 0; i < count; i++)
		for (size_t k = 0; k < ARRAY_COUNT(scenes) && rc == 0; k++)
			if (scenes[k] && scene_fd(scenes[k]) == ready[i].data.fd)
				rc = scene_dispatch(scenes[k]);
	redraw_ask(sessions->options.redraw);
	return rc;
}

/* ---- objects */

static int open_session(struct sessions *sessions, struct session *session, struct hash root,
			uint32_t root_bytes)
{
	const struct sessions_options *o = &sessions->options;
	int rc;

	*session = (struct session){ 0 };
	rc = exhibit_open(&session->exhibit, root, root_bytes, &o->scene, &o->view);
	if (rc == 0)
		rc = watch(sessions, scene_fd(session->exhibit.scene));
	if (rc < 0)
		close_session(session);
	return rc;
}

/* Gives the root page to the scene, and its part about the texts to their view. */
static void give_root(struct session *session, struct hash hash, struct bytes object)
{
	struct page page;
	const int rc = page_decode(&page, object);

	if (rc == -ENOMEM) {
		log_warn("app", "out of memory for the root page; it is requested again");
		return;
	}
	scene_give(session->exhibit.scene, hash, object);
	if (rc == 0 && scene_root(session->exhibit.scene)) {
		information_view_open(session->exhibit.view, hash, &page);
		session->root_here = true;
	}
	if (rc == 0)
		page_finish(&page);
}

/* Returns true if the fetcher should keep the object. */
static bool give(struct session *session, struct hash hash, struct bytes object)
{
	struct exhibit *exhibit = &session->exhibit;
	bool kept;

	if (!exhibit->scene)
		return false;
	session->was_settled = session->was_settled || exhibit->frame.settled;
	kept = page_is(object) || !session->was_settled;
	if (kept && session->kept_count < SESSION_KEPT_MAX)
		session->kept[session->kept_count++] = hash;
	if (!session->root_here && hash_equal(hash, exhibit->root))
		give_root(session, hash, object);
	else if (!information_view_give(exhibit->view, hash, object))
		scene_give(exhibit->scene, hash, object);
	return kept;
}

void sessions_give(struct sessions *sessions, struct hash hash, struct bytes object)
{
	const bool shown_keeps = give(&sessions->shown, hash, object);
	const bool coming_keeps = give(&sessions->coming, hash, object);

	if (shown_keeps || coming_keeps)
		net_client_keep(sessions->options.net, hash);
}

/* Returns false if memory was lacking for some. */
static bool add_wants(struct wants *wants, struct session *session)
{
	static struct message_want list[WANTS_MAX];
	bool awaits_image;
	uint32_t count;

	if (!session->exhibit.scene)
		return true;
	awaits_image = scene_awaits_image(session->exhibit.scene);
	count = information_view_wants(session->exhibit.view, list, WANTS_MAX);
	for (uint32_t i = 0; i < count; i++)
		if (list[i].priority >= MESSAGE_PRIORITY_INDEX || !awaits_image)
			wants_add(wants, &list[i]);
	count = (uint32_t)scene_wants(session->exhibit.scene, list, WANTS_MAX / 2);
	for (uint32_t i = 0; i < count; i++)
		wants_add(wants, &list[i]);
	return !scene_lacked_memory(session->exhibit.scene);
}

/* Returns whether objects of the next release may be requested: it is the time of day for it, the
 * release is on a stick, or the clock is not set. */
static bool may_load(const struct sessions *sessions)
{
	/* If the clock is not set, the time of day could block the download for ever. */
	return updater_next_on_stick(sessions->options.updater) || !clock_wall_is_set() ||
	       daily_holds(&sessions->options.download, clock_wall_s());
}

/* The release that is shown comes first; the next release gets the rest of the bandwidth. */
void sessions_ask(struct sessions *sessions)
{
	struct wants *wants = sessions->options.wants;
	const bool was_held = sessions->coming_held;
	bool all;

	wants_begin(wants);
	all = add_wants(wants, &sessions->shown);
	sessions->coming_held = sessions->coming.exhibit.scene && !may_load(sessions);
	if (was_held && !sessions->coming_held)
		sessions->coming_since_ms = clock_now_ms(); /* it begins to load only now */
	wants_later(wants);
	if (!sessions->coming_held)
		all = add_wants(wants, &sessions->coming) && all;
	if (!wants_say(wants) || !all)
		redraw_ask(sessions->options.redraw);
}

/* ---- the release that is shown */

static void take_bounds(struct sessions *sessions)
{
	const struct root_page *root = scene_root(sessions->shown.exhibit.scene);

	eye_take_bounds(sessions->options.eye);
	log_info("app", "showing %s: %llu of %llu triangles published", root->name,
		 (unsigned long long)root->published_triangles,
		 (unsigned long long)root->source_triangles);
}

static void announce(struct sessions *sessions, const struct exhibit *before)
{
	const struct exhibit_change change = { .shown = &sessions->shown.exhibit,
					       .before = before };

	sessions->options.changed(sessions->options.data, &change);
	redraw_ask(sessions->options.redraw);
}

void sessions_begin(struct sessions *sessions, struct hash root, uint32_t root_bytes)
{
	static const struct exhibit none;
	/* A release without its root page shows nothing, so it is replaced at once. */
	const bool unseen = sessions->shown.root_here;
	struct session *session = unseen ? &sessions->coming : &sessions->shown;
	const bool again = sessions->again_ms > 0;
	int rc;

	sessions->again_ms = 0;
	close_session(&sessions->coming);
	if (sessions->shown.exhibit.scene && hash_equal(sessions->shown.exhibit.root, root))
		return; /* the release that is on the panel */
	close_session(session);
	sessions->coming_held = false;
	if (unseen)
		net_client_add_release(sessions->options.net, root, root_bytes);
	rc = open_session(sessions, session, root, root_bytes);
	if (rc < 0) {
		if (!again) /* it may fail every second */
			log_error("app", "cannot open the release: %s", strerror(-rc));
		sessions->again_root = root;
		sessions->again_bytes = root_bytes;
		sessions->again_ms = clock_now_ms() + AGAIN_MS;
	}
	sessions->coming_since_ms = clock_now_ms();
	sessions->coming_drawn_ms = 0;
	if (unseen)
		redraw_ask(sessions->options.redraw);
	else
		announce(sessions, &none);
}

static void take_over(struct sessions *sessions)
{
	struct session before = sessions->shown;

	sessions->shown = sessions->coming;
	sessions->shown.synced = true;
	sessions->coming = (struct session){ 0 };
	sessions->store_again_ms = sessions->loaded_again_ms = 0;
	announce(sessions, &before.exhibit);
	for (uint32_t i = 0; i < sessions->shown.kept_count; i++)
		net_client_keep(sessions->options.net, sessions->shown.kept[i]);
	close_session(&before);
	take_bounds(sessions);
}

/* ---- the next release */

static int visitor_left_ms(const struct sessions *sessions)
{
	return sessions->options.visitor_left_ms(sessions->options.data);
}

static bool is_ready(const struct sessions *sessions)
{
	const struct session *coming = &sessions->coming;
	const bool waited = clock_now_ms() - sessions->coming_since_ms > WARM_MOST_MS;

	return !coming->syncing && !coming->remembering && coming->exhibit.frame.patches > 0 &&
	       exhibit_info(&coming->exhibit) && (coming->exhibit.frame.settled || waited);
}

static void draw_small(struct sessions *sessions)
{
	struct camera camera = sessions->options.eye->camera;

	camera.height_px = camera.height_px * WARM_WIDTH_PX / camera.width_px;
	camera.width_px = WARM_WIDTH_PX;
	camera.shift_px[0] = camera.shift_px[1] = 0;
	if (!sessions->warm_target.framebuffer &&
	    gl_target_create(&sessions->warm_target, camera.width_px, camera.height_px) < 0)
		return;
	gl_target_bind(&sessions->warm_target);
	glClear(GL_COLOR_BUFFER_BIT | GL_DEPTH_BUFFER_BIT);
	scene_draw(sessions->coming.exhibit.scene, &camera, NULL, &sessions->coming.exhibit.frame);
}

static void wait_for_disk(struct sessions *sessions)
{
	sessions->coming_drawn_ms = clock_now_ms() + FORGETFUL_MS;
	sessions->coming_waits = true;
}

/* For the release that is on the panel already. */
static void store_later(struct sessions *sessions)
{
	sessions->store_again_ms = clock_now_ms() + FORGETFUL_MS;
}

void sessions_remembered(struct sessions *sessions, struct hash root, int rc)
{
	if (rc < 0 && hash_equal(sessions->shown.exhibit.root, root))
		store_later(sessions);
	if (!sessions->coming.exhibit.scene || !hash_equal(sessions->coming.exhibit.root, root))
		return;
	if (rc == 0) {
		take_over(sessions);
		return;
	}
	/* The stored release stays on the panel; the write is tried again later. */
	sessions->coming.remembering = false;
	wait_for_disk(sessions);
}

/* Syncs the objects of the first release. A later release is synced before it is shown, but the
 * first is shown while it loads, so a power cut minutes later would lose it. On a slow machine its
 * picture may never be complete, because the eye moves by itself before; so there is a time limit.
 */
void sessions_keep_first(struct sessions *sessions, int64_t pictured_ms)
{
	struct session *shown = &sessions->shown;

	if (shown->synced || shown->exhibit.frame.patches == 0 || sessions->coming.syncing ||
	    sessions->store_again_ms > 0)
		return;
	if (!shown->exhibit.frame.settled &&
	    (pictured_ms == 0 || clock_now_ms() < pictured_ms + WHOLE_MOST_MS))
		return;
	shown->synced = shown->syncing = true;
	net_client_sync(sessions->options.net);
}

/* The disk takes now what it refused before, which is nowhere any more: the release is opened anew.
 * What is stored comes from the fetcher's cache. */
static void load_again(struct sessions *sessions)
{
	const struct exhibit coming = sessions->coming.exhibit;

	if (sessions->loaded_again_ms > 0 &&
	    clock_now_ms() < sessions->loaded_again_ms + LOAD_AGAIN_MS)
		return; /* it is synced again, and this is asked again */
	sessions->loaded_again_ms = clock_now_ms();
	log_info("app", "the disk stores objects again; what the new release lacks is loaded");
	sessions_begin(sessions, coming.root, coming.root_bytes);
}

/* Objects are synced first, then the state that names them: a power cut between the two loses
 * nothing. */
void sessions_synced(struct sessions *sessions, bool done)
{
	struct session *coming = &sessions->coming;

	if (sessions->shown.syncing) { /* answers arrive in order */
		sessions->shown.syncing = false;
		sessions->shown.synced = done;
		if (done)
			log_info("app", "the objects of the picture are stored on the disk");
		else
			store_later(sessions);
		return;
	}
	if (!coming->exhibit.scene || !coming->syncing)
		return;
	coming->syncing = false;
	if (!done) {
		log_warn("app",
			 "the new release could not be stored on the disk; the current one stays");
		coming->lacks_objects = true;
		return;
	}
	if (coming->lacks_objects) {
		load_again(sessions);
		return;
	}
	if (visitor_left_ms(sessions) > 0)
		return; /* somebody came meanwhile */
	coming->remembering = true;
	updater_remember(sessions->options.updater, coming->exhibit.root);
}

void sessions_warm(struct sessions *sessions)
{
	const int64_t now_ms = clock_now_ms();

	if (sessions->again_ms > 0 && now_ms >= sessions->again_ms)
		sessions_begin(sessions, sessions->again_root, sessions->again_bytes);
	if (sessions->shown.root_here && !sessions->options.eye->ready) {
		take_bounds(sessions);
		updater_remember(sessions->options.updater, sessions->shown.exhibit.root);
	} else if (sessions->store_again_ms > 0 && now_ms >= sessions->store_again_ms) {
		sessions->store_again_ms = 0;
		updater_remember(sessions->options.updater, sessions->shown.exhibit.root);
	}
	if (exhibit_is_broken(&sessions->coming.exhibit)) {
		updater_refuse(sessions->options.updater, sessions->coming.exhibit.root,
			       "objects of it cannot be decoded");
		close_session(&sessions->coming);
	}
	sessions->coming_waits = sessions->coming.root_here;
	if (!sessions->coming.root_here || sessions->options.eye->camera.width_px == 0 ||
	    now_ms < sessions->coming_drawn_ms + WARM_PERIOD_MS)
		return;
	sessions->coming_drawn_ms = now_ms;
	draw_small(sessions);
	sessions->coming_waits = sessions->coming.exhibit.frame.moving;
	sessions->coming.syncing = false; /* no answer for so long: the fetcher was restarted */
	if (is_ready(sessions) && visitor_left_ms(sessions) == 0) {
		sessions->coming.syncing = true;
		net_client_sync(sessions->options.net);
		wait_for_disk(sessions);
	}
}

static int until_ms(int64_t due_ms)
{
	const int64_t left_ms = due_ms - clock_now_ms();

	return left_ms > 0 ? (int)left_ms : 0;
}

static int coming_wait_ms(const struct sessions *sessions)
{
	int64_t due_ms = sessions->coming_since_ms + WARM_MOST_MS + 1;

	if (sessions->again_ms > 0)
		return until_ms(sessions->again_ms);
	if (sessions->coming_held)
		return may_load(sessions) ? 0 : HELD_MS;
	if (!sessions->coming.root_here)
		return -1;
	if (sessions->coming_waits)
		due_ms = sessions->coming_drawn_ms + WARM_PERIOD_MS;
	else if (is_ready(sessions))
		return visitor_left_ms(sessions);
	else if (due_ms <= clock_now_ms())
		return -1; /* wait until something of it arrives */
	return until_ms(due_ms);
}

int sessions_wait_ms(const struct sessions *sessions)
{
	const int coming_ms = coming_wait_ms(sessions);

	return sessions->store_again_ms > 0
		       ? clock_sooner_ms(coming_ms, until_ms(sessions->store_again_ms))
		       : coming_ms;
}
