/* Manages the release that is shown and the next one. The next release is drawn small and off
 * screen, with the visitor's camera, until nothing is missing; then it is stored, and it replaces
 * the other between two frames. */
#include <errno.h>
#include <string.h>

#include "app/kiosk.h"
#include "app/release/updater.h"
#include "base/clock.h"
#include "base/log.h"

enum {
	WARM_PERIOD_MS = 100,
	/* Longest wait for a complete picture; then what there is of it is shown. */
	WARM_MOST_MS = 60000,
	WARM_WIDTH_PX = 320,
	FORGETFUL_MS = 30000,  /* wait before a failed write is tried again */
	HELD_MS = 60000,       /* interval of checking the time of day */
	WHOLE_MOST_MS = 20000, /* longest wait before the first picture is synced */
	FOV_DEG = 45,
};

static float free_ahead(void *data, const float from_m[3], const float direction[3], float most_m)
{
	struct kiosk *kiosk = data;

	return scene_clearance(kiosk->shown.scene, from_m, direction, most_m);
}

struct scene_options kiosk_scene_options(const struct profile *profile, enum scene_mode mode)
{
	return (struct scene_options){
		.mode = mode,
		.texture_budget_bytes = (uint64_t)profile->texture_mib << 20,
		.geometry_budget_bytes = (uint64_t)profile->geometry_mib << 20,
		.triangle_budget = profile->triangles,
		.patch_error_px = profile->error_px,
		.price_px_per_kb = profile->price_px_per_kb,
		.upload_budget_us = profile->upload_us,
		.worker_count = profile->workers,
	};
}

static int open_session(struct kiosk *kiosk, struct session *session, struct hash root,
			uint32_t root_bytes)
{
	const struct profile *profile = &kiosk->profile;
	const struct scene_options scene = kiosk_scene_options(profile, kiosk->options.mode);
	const struct information_view_options view = {
		.width_px = kiosk_width_px(kiosk),
		.height_px = kiosk_height_px(kiosk),
		.px_per_mm = kiosk->px_per_mm,
		.language = kiosk->options.language,
	};
	int rc;

	*session = (struct session){ .root = root, .root_bytes = root_bytes };
	rc = scene_create(&session->scene, &scene);
	if (rc == 0)
		rc = information_view_create(&session->view, &view);
	if (rc == 0)
		rc = scene_open(session->scene, root, root_bytes);
	if (rc == 0)
		rc = kiosk_watch(kiosk, scene_fd(session->scene));
	if (rc < 0)
		session_close(session);
	return rc;
}

void session_close(struct session *session)
{
	information_view_destroy(session->view);
	scene_destroy(session->scene);
	*session = (struct session){ 0 };
}

static void open_root(struct session *session, struct hash hash, struct bytes object)
{
	struct page page;

	if (page_decode(&page, object) == 0) {
		information_view_open(session->view, hash, &page);
		page_finish(&page);
		session->root_here = true;
	}
}

bool session_give(struct session *session, struct hash hash, struct bytes object)
{
	bool kept;

	if (!session->scene)
		return false;
	session->was_settled = session->was_settled || session->frame.settled;
	kept = page_is(object) || !session->was_settled;
	if (kept && session->kept_count < SESSION_KEPT_MAX)
		session->kept[session->kept_count++] = hash;
	if (!information_view_give(session->view, hash, object))
		scene_give(session->scene, hash, object);
	if (!session->root_here && hash_equal(hash, session->root) && scene_root(session->scene))
		open_root(session, hash, object);
	return kept;
}

/* Takes the eye's bounds from the release. With the first release the eye goes to its start pose;
 * after an update it stays where the visitor has it. */
static void set_bounds(struct kiosk *kiosk)
{
	const struct root_page *root = scene_root(kiosk->shown.scene);
	struct navigator_options options = {
		.fov_deg = FOV_DEG,
		.clearance = free_ahead,
		.data = kiosk,
	};

	memcpy(options.box_min_m, root->box_min_m, sizeof(options.box_min_m));
	memcpy(options.box_max_m, root->box_max_m, sizeof(options.box_max_m));
	memcpy(options.home_eye_m, root->start_eye_m, sizeof(options.home_eye_m));
	memcpy(options.home_target_m, root->start_target_m, sizeof(options.home_target_m));
	if (kiosk->navigator_ready)
		kiosk->navigator.options = options;
	else
		navigator_init(&kiosk->navigator, &options);
	kiosk->navigator_ready = true;
	log_info("app", "showing %s: %llu of %llu triangles published", root->name,
		 (unsigned long long)root->published_triangles,
		 (unsigned long long)root->source_triangles);
}

/* Switches the fetcher to this release. It forgets all wants; the next frame sends them again. */
static void use_release(struct kiosk *kiosk, struct hash root, uint32_t root_bytes)
{
	net_client_use_release(kiosk->net, root, root_bytes);
	wants_clear(&kiosk->wants);
}

void session_begin(struct kiosk *kiosk, struct hash root, uint32_t root_bytes)
{
	/* A release without its root page shows nothing, so it is replaced at once. */
	const bool unseen = kiosk->shown.root_here;
	struct session *session = unseen ? &kiosk->coming : &kiosk->shown;
	int rc;

	session_close(&kiosk->coming);
	if (kiosk->shown.scene && hash_equal(kiosk->shown.root, root))
		return; /* the release that is on the panel */
	session_close(session);
	kiosk->coming_held = false;
	if (unseen)
		net_client_add_release(kiosk->net, root, root_bytes);
	else
		use_release(kiosk, root, root_bytes);
	rc = open_session(kiosk, session, root, root_bytes);
	if (rc < 0)
		log_error("app", "cannot open the release: %s", strerror(-rc));
	kiosk->coming_since_ms = clock_now_ms();
	kiosk->coming_drawn_ms = 0;
	kiosk->shown.shown_ms = unseen ? kiosk->shown.shown_ms : clock_now_ms();
	kiosk_redraw(kiosk);
}

bool session_may_load(const struct kiosk *kiosk)
{
	/* If the clock is not set, the time of day could block the download for ever. */
	return updater_next_on_stick(kiosk->updater) || !clock_wall_is_set() ||
	       daily_holds(&kiosk->options.download, clock_wall_s());
}

static bool is_ready(const struct kiosk *kiosk)
{
	const struct session *coming = &kiosk->coming;
	const bool waited = clock_now_ms() - kiosk->coming_since_ms > WARM_MOST_MS;

	return !coming->syncing && !coming->remembering && coming->frame.patches > 0 &&
	       information_view_info(coming->view) && (coming->frame.settled || waited);
}

static void take_over(struct kiosk *kiosk)
{
	struct session before = kiosk->shown;
	struct overlay *overlay = information_view_overlay(kiosk->coming.view);

	kiosk->shown = kiosk->coming;
	kiosk->shown.synced = true;
	kiosk->coming = (struct session){ 0 };
	kiosk->shown.shown_ms = clock_now_ms();
	use_release(kiosk, kiosk->shown.root, kiosk->shown.root_bytes);
	for (uint32_t i = 0; i < kiosk->shown.kept_count; i++)
		net_client_keep(kiosk->net, kiosk->shown.kept[i]);
	if (information_view_language(before.view))
		information_view_set_language(kiosk->shown.view,
					      information_view_language(before.view));
	if (overlay) /* NULL if the panel is too small for it */
		overlay_show_help(overlay, false);
	tour_player_end(kiosk);        /* the new release has other tours */
	back_forget(kiosk);            /* and other parts */
	kiosk->looked_triangles = 0;   /* and other anchors */
	if (before.frame.patches == 0) /* nothing was shown, so the eye has no place to keep */
		kiosk->navigator_ready = false;
	quads_forget(kiosk->quads);
	session_close(&before);
	set_bounds(kiosk);
	kiosk_redraw(kiosk);
}

static void draw_small(struct kiosk *kiosk)
{
	struct camera camera = kiosk->camera;

	camera.height_px = camera.height_px * WARM_WIDTH_PX / camera.width_px;
	camera.width_px = WARM_WIDTH_PX;
	camera.shift_px[0] = camera.shift_px[1] = 0;
	if (!kiosk->warm_target.framebuffer &&
	    gl_target_create(&kiosk->warm_target, camera.width_px, camera.height_px) < 0)
		return;
	gl_target_bind(&kiosk->warm_target);
	glClear(GL_COLOR_BUFFER_BIT | GL_DEPTH_BUFFER_BIT);
	scene_draw(kiosk->coming.scene, &camera, NULL, &kiosk->coming.frame);
}

static void wait_for_disk(struct kiosk *kiosk)
{
	kiosk->coming_drawn_ms = clock_now_ms() + FORGETFUL_MS;
	kiosk->coming_waits = true;
}

void session_remembered(struct kiosk *kiosk, struct hash root, int rc)
{
	if (!kiosk->coming.scene || !hash_equal(kiosk->coming.root, root))
		return;
	if (rc == 0) {
		take_over(kiosk);
		return;
	}
	/* The stored release stays on the panel; the write is tried again later. */
	kiosk->coming.remembering = false;
	wait_for_disk(kiosk);
}

/* Syncs the objects of the first release. A later release is synced before it is shown, but the
 * first is shown while it loads, so a power cut minutes later would lose it. On a slow machine its
 * picture may never be complete, because the eye moves by itself before; so there is a time limit.
 */
void session_keep_first(struct kiosk *kiosk)
{
	struct session *shown = &kiosk->shown;

	if (shown->synced || shown->frame.patches == 0 || kiosk->coming.syncing)
		return;
	if (!shown->frame.settled &&
	    (shown->pictured_ms == 0 || clock_now_ms() < shown->pictured_ms + WHOLE_MOST_MS))
		return;
	shown->synced = shown->syncing = true;
	net_client_sync(kiosk->net);
}

/* Objects are synced first, then the state that names them: a power cut between the two loses
 * nothing. */
void session_synced(struct kiosk *kiosk, bool done)
{
	struct session *coming = &kiosk->coming;

	if (kiosk->shown.syncing) { /* answers arrive in order */
		kiosk->shown.syncing = false;
		if (done)
			log_info("app", "the picture is safe on the disk");
		return;
	}
	if (!coming->scene || !coming->syncing)
		return;
	coming->syncing = false;
	if (!done) {
		log_warn("app", "the new release is not safe on the disk yet: the old one stays");
		return;
	}
	coming->remembering = true;
	updater_remember(kiosk->updater, coming->root);
}

void session_warm(struct kiosk *kiosk)
{
	const int64_t now_ms = clock_now_ms();

	if (kiosk->shown.root_here && !kiosk->navigator_ready) {
		set_bounds(kiosk);
		updater_remember(kiosk->updater, kiosk->shown.root);
	}
	if (trial_is_broken(&kiosk->coming)) {
		updater_refuse(kiosk->updater, kiosk->coming.root,
			       "objects of it cannot be decoded");
		session_close(&kiosk->coming);
	}
	kiosk->coming_waits = kiosk->coming.root_here;
	if (!kiosk->coming.root_here || kiosk->camera.width_px == 0 ||
	    now_ms < kiosk->coming_drawn_ms + WARM_PERIOD_MS)
		return;
	kiosk->coming_drawn_ms = now_ms;
	draw_small(kiosk);
	kiosk->coming_waits = kiosk->coming.frame.moving;
	kiosk->coming.syncing = false; /* no answer for so long: the fetcher was restarted */
	if (is_ready(kiosk) && visitor_left_ms(kiosk) == 0) {
		kiosk->coming.syncing = true;
		net_client_sync(kiosk->net);
		wait_for_disk(kiosk);
	}
}

int session_wait_ms(const struct kiosk *kiosk)
{
	const int64_t now_ms = clock_now_ms();
	int64_t due_ms = kiosk->coming_since_ms + WARM_MOST_MS + 1;

	if (kiosk->coming_held)
		return session_may_load(kiosk) ? 0 : HELD_MS;
	if (!kiosk->coming.root_here)
		return -1;
	if (kiosk->coming_waits)
		due_ms = kiosk->coming_drawn_ms + WARM_PERIOD_MS;
	else if (is_ready(kiosk))
		return visitor_left_ms(kiosk);
	else if (due_ms <= now_ms)
		return -1; /* wait until something of it arrives */
	return due_ms > now_ms ? (int)(due_ms - now_ms) : 0;
}
