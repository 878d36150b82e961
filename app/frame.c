/* Draws one frame: moves the eye, draws the scene, draws the overlay over it, and asks the fetcher
 * for missing objects. Nothing here waits for disk, network or a decoder. */
#include <errno.h>
#include <malloc.h>
#include <math.h>
#include <string.h>

#include <cglm/cglm.h>

#include "app/kiosk.h"
#include "base/clock.h"
#include "base/log.h"
#include "geometry/viewpoint.h"
#include "render/display/context.h"
#include "render/display/gl.h"

enum {
	/* Longest time step of the navigator, so that after a delay the eye does not jump. */
	STEP_MOST_MS = 50,
	ANCHORS_A_FRAME = 3,
	SAY_EYE_MS = 100,
};

void frame_camera(const struct kiosk *kiosk, struct camera *out)
{
	navigator_camera(&kiosk->navigator, out);
	out->width_px = display_width_px(kiosk->display);
	out->height_px = display_height_px(kiosk->display);
	out->rotation_deg = kiosk->profile.rotation_deg;
	memcpy(out->shift_px, kiosk->panel.shift_px, sizeof(out->shift_px));
}

/* ---- words over the model */

static bool anchor_is_hidden(struct kiosk *kiosk, const float anchor_m[3])
{
	const float off = navigator_keep_off_m(&kiosk->navigator);
	float direction[3], distance, free_m;

	glm_vec3_sub((float *)anchor_m, kiosk->camera.eye_m, direction);
	distance = glm_vec3_norm(direction);
	if (distance < off / 35)
		return false;
	glm_vec3_scale(direction, 1 / distance, direction);
	free_m = scene_clearance(kiosk->shown.scene, kiosk->camera.eye_m, direction, distance);
	return free_m < distance - fmaxf(off, 0.03f * distance);
}

/* Tests a few anchors per frame with a ray, because what hides an anchor changes slowly. */
static void look_at_anchors(struct kiosk *kiosk, uint32_t count)
{
	const struct info *info = information_view_info(kiosk->shown.view);

	/* Tests all anchors again if the eye moves, the frame still changes, or other triangles
	 * were drawn. Objects that are merely missing do not count, so a kiosk without a network
	 * comes to rest too. */
	if (kiosk->eye_moves || kiosk->shown.frame.moving ||
	    kiosk->looked_triangles != kiosk->shown.frame.triangles)
		kiosk->anchors_to_look = count;
	if (kiosk->anchors_to_look > count)
		kiosk->anchors_to_look = count;
	kiosk->looked_triangles = kiosk->shown.frame.triangles;
	for (int i = 0; i < ANCHORS_A_FRAME && kiosk->anchors_to_look > 0; i++) {
		kiosk->next_anchor = (kiosk->next_anchor + 1) % count;
		kiosk->hidden[kiosk->next_anchor] =
			anchor_is_hidden(kiosk, info_part(info, kiosk->next_anchor)->anchor_m);
		kiosk->anchors_to_look--;
	}
}

/* Returns the diameter of the part on the panel, in pixels; 0 if it is only a point. */
static float size_on_panel(const struct kiosk *kiosk, const struct info_part *part)
{
	const float distance_m =
		glm_vec3_distance((float *)part->anchor_m, (float *)kiosk->camera.eye_m);

	return 2 * region_size_m(&part->region) * camera_px_per_radian(&kiosk->camera) /
	       fmaxf(distance_m, 0.01f);
}

static void place_anchors(struct kiosk *kiosk, struct overlay *overlay)
{
	static struct overlay_anchor anchors[OVERLAY_PARTS_MAX];
	const struct info *info = information_view_info(kiosk->shown.view);
	const struct rect rect = overlay_scene_rect(overlay);
	const uint32_t count = info_part_count(info);

	if (count == 0 || count > OVERLAY_PARTS_MAX)
		return;
	look_at_anchors(kiosk, count);
	for (uint32_t i = 0; i < count; i++) {
		struct overlay_anchor *a = &anchors[i];
		const bool before_eye = camera_pixel(&kiosk->camera, info_part(info, i)->anchor_m,
						     &a->x_px, &a->y_px);

		if (before_eye)
			viewport_from_panel(kiosk, &a->x_px, &a->y_px);
		a->hidden = kiosk->hidden[i];
		a->size_px = size_on_panel(kiosk, info_part(info, i));
		a->visible =
			before_eye &&
			section_keeps(&kiosk->tools.now.section, info_part(info, i)->anchor_m) &&
			a->x_px >= rect.x_px && a->y_px >= rect.y_px &&
			a->x_px < rect.x_px + rect.width_px && a->y_px < rect.y_px + rect.height_px;
	}
	overlay_anchors(overlay, anchors, count);
}

static int draw_words(struct kiosk *kiosk, struct overlay *overlay, int64_t now_ms)
{
	static struct overlay_layer layers[OVERLAY_LAYERS_MAX];
	uint32_t count;
	int rc = 0;

	place_anchors(kiosk, overlay);
	kiosk->words_move = overlay_update(overlay, now_ms);
	count = overlay_layers(overlay, layers, OVERLAY_LAYERS_MAX);
	quads_begin(kiosk->quads, kiosk->panel.shift_px, display_width_px(kiosk->display),
		    display_height_px(kiosk->display), kiosk->profile.rotation_deg);
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

		rc = quads_upload(kiosk->quads, &pixels);
		quads_draw(kiosk->quads, layer->bitmap, layer->corners_px, layer->source,
			   layer->alpha);
	}
	quads_end(kiosk->quads);
	return rc;
}

/* ---- the scene */

static const struct scene_mark *marked_part(struct kiosk *kiosk, struct scene_mark *out)
{
	struct overlay *overlay = information_view_overlay(kiosk->shown.view);
	int part = -1;

	if (overlay)
		part = overlay_page(overlay) >= 0 ? overlay_page(overlay) : overlay_card(overlay);
	if (part < 0)
		part = tour_player_part(kiosk);
	if (part < 0)
		return NULL;
	*out = (struct scene_mark){
		.part = info_part(information_view_info(kiosk->shown.view), (uint32_t)part)->id
	};
	information_view_region(kiosk->shown.view, (uint32_t)part, &out->region);
	return out;
}

static void draw_scene(struct kiosk *kiosk, bool words)
{
	struct scene *scene = kiosk->shown.scene;
	const struct root_page *root = scene ? scene_root(scene) : NULL;
	struct scene_mark mark;

	glDisable(GL_SCISSOR_TEST);
	glViewport(0, 0, kiosk->camera.width_px, kiosk->camera.height_px);
	glClearColor((float)(root ? root->background[0] : 24) / 255,
		     (float)(root ? root->background[1] : 22) / 255,
		     (float)(root ? root->background[2] : 20) / 255, 0);
	glClear(GL_COLOR_BUFFER_BIT | GL_DEPTH_BUFFER_BIT);
	if (scene && kiosk->navigator_ready)
		scene_draw(scene, &kiosk->camera, words ? marked_part(kiosk, &mark) : NULL,
			   &kiosk->shown.frame);
}

static void add_wants(struct kiosk *kiosk, struct session *session)
{
	static struct message_want list[WANTS_MAX];
	size_t count;

	if (!session->scene)
		return;
	information_view_wants(session->view, &kiosk->wants);
	count = scene_wants(session->scene, list, WANTS_MAX / 2);
	for (size_t i = 0; i < count; i++)
		wants_add(&kiosk->wants, &list[i]);
}

/* Tells the fetcher what is wanted. The release that is shown comes first; the next release gets
 * the rest of the bandwidth. */
static void say_wants(struct kiosk *kiosk)
{
	wants_begin(&kiosk->wants);
	add_wants(kiosk, &kiosk->shown);
	kiosk->coming_held = kiosk->coming.scene && !session_may_load(kiosk);
	wants_later(&kiosk->wants);
	if (!kiosk->coming_held)
		add_wants(kiosk, &kiosk->coming);
	wants_say(&kiosk->wants, kiosk->net);
}

static void say_first_picture(struct kiosk *kiosk)
{
	if (kiosk->pictured || kiosk->shown.frame.patches == 0)
		return;
	kiosk->pictured = true;
	log_info("app", "first picture after %lld ms",
		 (long long)(clock_now_ms() - kiosk->started_ms));
}

/* Logs the path of the eye, so that a visit can be replayed with other timing. */
static void say_eye(struct kiosk *kiosk, int64_t now_ms)
{
	const float *e = kiosk->camera.eye_m, *t = kiosk->camera.target_m;

	if (now_ms - kiosk->said_ms < SAY_EYE_MS ||
	    (memcmp(e, kiosk->said.eye_m, sizeof(kiosk->said.eye_m)) == 0 &&
	     memcmp(t, kiosk->said.target_m, sizeof(kiosk->said.target_m)) == 0))
		return;
	kiosk->said = kiosk->camera;
	kiosk->said_ms = now_ms;
	log_debug("app", "eye at %.3f %.3f %.3f, looks at %.3f %.3f %.3f", (double)e[0],
		  (double)e[1], (double)e[2], (double)t[0], (double)t[1], (double)t[2]);
}

/* Returns freed memory to the system. Once each time the picture settles, because it takes
 * milliseconds (7 with the temple of 5 million triangles), and so does each page that is faulted in
 * again. */
static void give_back_memory(struct kiosk *kiosk)
{
	if (!kiosk->shown.frame.settled)
		kiosk->memory_given_back = false;
	else if (!kiosk->frame_wanted && !kiosk->memory_given_back) {
		log_debug("app", "the picture has settled");
		malloc_trim(0);
		kiosk->memory_given_back = true;
	}
}

int frame_unseen(struct kiosk *kiosk)
{
	if (context_is_lost())
		return -ENOTRECOVERABLE;
	kiosk->frame_wanted = false;
	session_warm(kiosk);
	say_wants(kiosk);
	return 0;
}

int frame_draw(struct kiosk *kiosk)
{
	const int64_t now_ms = clock_now_ms(), began_us = clock_thread_us();
	const float dt_ms = fminf((float)(now_ms - kiosk->last_frame_ms), STEP_MOST_MS);
	const bool words =
		!kiosk->capture || kiosk->options.capture_overlay || !kiosk->options.views_path;
	struct overlay *overlay;
	int rc = 0;

	if (context_is_lost())
		return -ENOTRECOVERABLE;
	kiosk->last_frame_ms = now_ms;
	kiosk->frame_wanted = false;
	if (kiosk->navigator_ready && !kiosk->options.views_path) {
		kiosk->eye_moves =
			navigator_step(&kiosk->navigator, dt_ms, (float)kiosk_height_px(kiosk));
		kiosk->eye_moves |= visitor_leads_eye(kiosk, now_ms);
		frame_camera(kiosk, &kiosk->camera);
		say_eye(kiosk, now_ms);
	}
	tools_say(kiosk);
	back_say(kiosk);
	session_warm(kiosk);
	display_begin(kiosk->display);
	draw_scene(kiosk, words);
	overlay =
		information_view_overlay(kiosk->shown.view); /* session_warm may have changed it */
	if (overlay && words)
		rc = draw_words(kiosk, overlay, now_ms);
	if (rc == 0)
		rc = setup_page_draw(kiosk, now_ms);
	if (rc == 0)
		rc = gl_check("drawing a frame");
	kiosk->frame_us = (uint32_t)(clock_thread_us() - began_us);
	kiosk->frames++;
	kiosk->late_frames += kiosk->frame_us > FRAME_BUDGET_US;
	if (rc == 0)
		rc = display_present(kiosk->display);
	say_first_picture(kiosk);
	session_keep_first(kiosk);
	say_wants(kiosk);
	if (kiosk->shown.frame.moving || kiosk->words_move || kiosk->eye_moves ||
	    kiosk->anchors_to_look > 0)
		kiosk->frame_wanted = true;
	give_back_memory(kiosk);
	return rc;
}
