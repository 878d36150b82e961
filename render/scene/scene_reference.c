/* Chooses where the eye will be, draws the reference picture in slices, and shows it. */
#include "render/scene/scene_reference.h"

#include <math.h>
#include <string.h>

#include "base/log.h"
#include "geometry/vec.h"
#include "render/scene/scene_mark.h"
#include "render/scene/scene_picture.h"
#include "render/scene/scene_plan.h"
#include "render/scene/scene_scenery.h"
#include "render/scene/scene_visibility.h"

/* Frames between two that draw depths of faces where some are of an older cut, and where some are
 * missing. */
enum { OUTDATED_FRAMES = 4, MISSING_FRAMES = 2 };
/* Pictures without a visibility pass between two with one. */
enum { PASS_PICTURES = 4 };

/* What reading a pass back and counting it takes, in triangles of it. */
static const float counting_cost = 0.3f * VISIBILITY_WIDTH * VISIBILITY_HEIGHT;
/* Its field of view is so much wider, for what the eye turns to. */
static const float wider = 1.06f;
/* It is drawn for the time when it is shown first, but not for later than this, nor for farther
 * away than this share of what is nearest, since eyes stop and turn round; fast ones do so later.
 */
static const float lead_most_ms = 300, lead_most_share = 0.4f, lead_hurry_share = 1;
/* For an eye that will be out of reach within about this time there are small pictures. They have
 * this part of the scale, since it is too fast to see details; but this scale at least. This share
 * of one is drawn in each frame, for a time at least so far ahead. */
static const float hurry_ms = 100, hurry_part = 0.5f, hurry_least = 0.25f, hurry_share = 0.5f,
		   hurry_lead_ms = 50;
/* Of one that is not small and comes late, so much more is drawn in a frame. */
static const float late_parts = 2;
/* How far off the last one is shown while another is being drawn. Farther away one is drawn at
 * once, for this share of the usual time ahead: it is shown already in this frame. */
static const float off_most = 3, catch_up_share = 0.5f;
/* The eye's speed is that of about so long: fingers tremble. */
static const float speed_ms = 60;
/* A turn uncovers the edge of a picture as long as it is shown, so its direction is that of the
 * middle of that time. */
static const float turn_lead = 1.5f;

bool scene_uses_references(const struct scene *scene)
{
	return scene->used.share < 1 && image_warp_is_supported() && scene->has_hierarchy &&
	       scene->backdrop.share <= 0 && (scene->eye_moves || scene_scenery_is_still(scene)) &&
	       scene->stream.growth.triangle_count == 0;
}

void scene_forget_references(struct scene *scene)
{
	struct scene_references *r = &scene->references;
	r->has_shown = r->is_begun = r->is_kept = false;
}

void scene_drop_references(struct scene *scene)
{
	for (int i = 0; i < 2; i++)
		image_warp_let_go(&scene->references.of[i]);
	scene_forget_references(scene);
}

void scene_note_motion(struct scene *scene, const struct view *view, float passed_ms)
{
	struct scene_references *r = &scene->references;
	const struct view *was = &scene->view;
	if (!scene->has_view || passed_ms <= 0)
		return;
	r->moving_frames = scene->was_moving ? r->moving_frames + 1 : 1;
	const float newest = fmaxf(passed_ms / (passed_ms + speed_ms), 1 / (float)r->moving_frames);
	for (int k = 0; k < 3; k++) {
		const float moved = (view->eye_m[k] - was->eye_m[k]) / passed_ms;
		const float turned = (view->forward[k] - was->forward[k]) / passed_ms;
		r->eye_speed[k] += newest * (moved - r->eye_speed[k]);
		r->turn_speed[k] += newest * (turned - r->turn_speed[k]);
	}
	r->begun_ms += passed_ms;
}

/* Returns how far off the last one is for a view, as image_warp_off. */
static float find_off(const struct scene *scene, const struct view *view)
{
	const struct scene_references *r = &scene->references;
	return r->has_shown ? image_warp_off(&r->of[r->shown], view) : INFINITY;
}

/* ---- the view of the next one */

/* Returns in how many milliseconds the next picture is shown first, if it takes as long as the last
 * one of its kind, but at least so long. A lead to the middle of the time in which it is shown gave
 * no better pictures (docs/figures.md). */
static float lead_ms(const struct scene *scene, float least_ms)
{
	const struct scene_references *r = &scene->references;
	const float speed = sqrtf(vec_dot(r->eye_speed, r->eye_speed));
	const float share = r->kind == REFERENCE_SMALL ? lead_hurry_share : lead_most_share;
	const float most_m = share * r->of[r->shown].nearest_m;
	float ms = fminf(fmaxf(r->took_ms[r->kind], least_ms), lead_most_ms);
	if (speed * ms > most_m)
		ms = most_m / speed;
	return ms;
}

static struct view view_ahead(const struct scene *scene, float ms)
{
	const struct scene_references *r = &scene->references;
	struct camera camera = scene->camera;
	struct view view;
	float forward[3];
	for (int k = 0; k < 3; k++) {
		camera.eye_m[k] += ms * r->eye_speed[k];
		forward[k] = scene->view.forward[k] + turn_lead * ms * r->turn_speed[k];
	}
	vec_normalise(forward);
	for (int k = 0; k < 3; k++)
		camera.target_m[k] = camera.eye_m[k] + forward[k];
	camera.fov_deg = 2 * atanf(wider * scene->view.tan_y) * 180 / (float)M_PI;
	camera.width_px = (int)(wider * (float)camera.width_px);
	camera.height_px = (int)(wider * (float)camera.height_px);
	view_from_camera(&view, &camera);
	section_cut(&scene->tools.section, view.eye_m, view.cut);
	return view;
}

/* ---- drawing it */

static struct image_warp_reference *coming(struct scene *scene)
{
	return &scene->references.of[1 - scene->references.shown];
}

/* Finds what the picture costs, and what of it is drawn in each frame: equal slices, of which none
 * is more than the share of a picture with a pass, whether it has one or not, or of a small one
 * without. */
static void sum_costs(struct scene *scene, float picture_px)
{
	struct scene_references *r = &scene->references;
	float pass = counting_cost, picture = 1; /* one of nothing has to be drawn too */
	for (uint32_t i = 0; i < scene->counted_all; i++) {
		const struct visible_piece *v = &scene->counted[i];
		const struct piece *piece =
			&scene->geometry.patches[v->patch].content.bvh.pieces[v->piece];
		pass += (float)piece->triangle_count;
		picture += scene_piece_cost(scene, v, 1, picture_px);
	}
	r->cost = pass + picture;
	const float share = scene->used.share;
	const float whole = r->is_counted ? picture : r->cost;
	const float most =
		r->kind == REFERENCE_SMALL ? fmaxf(share, hurry_share) * picture : share * r->cost;
	r->part = whole / ceilf(whole / most);
}

/* Returns what the picture is drawn with. */
static struct surface_frame frame_of(const struct scene *scene, struct view *small)
{
	const struct scene_references *r = &scene->references;
	enlargement_view(small, &r->of[1 - r->shown].view, r->scale);
	return scene_surface_frame(scene, small, PICTURE_ASIDE);
}

/* Lists the pieces of another view, and begins its picture with them, and its visibility pass if it
 * has one. */
static bool begin(struct scene *scene, float ahead_ms)
{
	struct scene_references *r = &scene->references;
	struct image_warp_reference *next = coming(scene);
	const struct view seen = scene->view;
	struct view small;
	scene->view = next->view = view_ahead(scene, ahead_ms);
	r->scale = scene->used.scale;
	if (r->kind == REFERENCE_SMALL)
		r->scale = fmaxf(hurry_part * r->scale, hurry_least);
	enlargement_view(&small, &next->view, r->scale);
	if (image_warp_begin(&r->warp, next, small.width_px, small.height_px) < 0) {
		scene->view = seen;
		return false;
	}
	scene_begin_picture(scene);
	scene_list_pieces(scene);
	r->is_counted = r->kind != REFERENCE_WITH_PASS;
	const bool is_kept = r->is_counted
				     ? scene_keep_pieces(scene)
				     : scene_begin_visibility(
					       scene, scene_scenery_far_m(scene, next->view.eye_m));
	scene->view = seen;
	scene_list_pieces(scene);
	if (!is_kept)
		return false;
	r->is_begun = true;
	scene->counting = false;
	r->begun_ms = 0;
	r->numbered = 0;
	sum_costs(scene, small.picture_px);
	const struct surface_frame frame = frame_of(scene, &small);
	scene_begin_slices(scene, &frame, scene->counted, scene->counted_all, &r->slice);
	return true;
}

/* Draws pieces of the visibility pass until the cost is reached. Returns that of those it drew. */
static float draw_numbers(struct scene *scene, float cost)
{
	struct scene_references *r = &scene->references;
	uint32_t to = r->numbered;
	float drawn = 0;
	for (; to < scene->counted_count && drawn < cost; to++) {
		const struct visible_piece *v = &scene->counted[to];
		const struct geometry_patch *patch = &scene->geometry.patches[v->patch];
		if (patch->pieces)
			drawn += (float)patch->content.bvh.pieces[v->piece].triangle_count;
	}
	visibility_resume(&scene->visibility, &scene->root);
	scene_draw_numbers(scene, r->numbered, to);
	r->numbered = to;
	return drawn;
}

/* Draws scenery into the pass, reads it back and counts it. */
static void count_pass(struct scene *scene)
{
	visibility_resume(&scene->visibility, &scene->root);
	scene_draw_scenery_depths(scene);
	if (visibility_end(&scene->visibility) == 0)
		scene_count_visibility(scene);
	scene->references.is_counted = true;
	scene->references.since_pass = 0;
}

/* It is whole: takes its depths, draws the outline over it, and shows it from now on. */
static void end_picture(struct scene *scene, const struct surface_frame *frame)
{
	struct scene_references *r = &scene->references;
	struct image_warp_reference *next = coming(scene);
	const struct gl_place place = { .framebuffer = next->picture.framebuffer };
	scene_draw_scenery(scene, frame);
	if (image_warp_read_depths(&r->warp, next) < 0)
		log_warn("render", "a picture will be warped with the depths of another one");
	gl_target_bind(&next->picture);
	scene_draw_mask(scene, frame->view, &next->picture);
	outline_draw(&scene->outline, &place, frame->view->width_px, frame->view->height_px);
	r->shown = 1 - r->shown;
	r->has_shown = true;
	r->is_begun = false;
	r->since_pass++;
	if (r->begun_ms > 0)
		r->took_ms[r->kind] = r->begun_ms;
}

/* Draws pieces of the picture. */
static void draw_pieces(struct scene *scene, float cost)
{
	struct scene_references *r = &scene->references;
	struct view small;
	const struct surface_frame frame = frame_of(scene, &small);
	gl_target_bind(&coming(scene)->picture);
	scene_resume_picture();
	if (scene_draw_slice(scene, &frame, &r->slice, cost))
		end_picture(scene, &frame);
}

/* Returns after how many frames one is left to depths of faces. */
static uint32_t frames_between_depths(const struct scene *scene)
{
	uint32_t frames = UINT32_MAX;
	for (int i = 0; i < (int)scene->tiles.face_count; i++) {
		const struct tiles_face *face = &scene->tiles.faces[i];
		if (!face->used || face->stamp != scene->tiles.stamp)
			continue;
		if (!depth_ready(&scene->depth, i, face->key))
			return MISSING_FRAMES;
		if (scene->depth.face[i].cut != scene->cut_signature)
			frames = OUTDATED_FRAMES;
	}
	return frames;
}

/* Goes on with the picture that was begun until the cost is reached. */
static void go_on(struct scene *scene, float cost)
{
	struct scene_references *r = &scene->references;
	const bool was_numbered = r->numbered == scene->counted_count;
	float left = cost;
	if (!r->is_counted && !was_numbered)
		left -= draw_numbers(scene, left);
	/* reading waits for what was drawn, so it comes at the begin of a frame */
	if (!r->is_counted && r->numbered == scene->counted_count &&
	    (was_numbered || left >= counting_cost)) {
		count_pass(scene);
		left -= counting_cost;
	}
	if (r->is_counted && left > 0)
		draw_pieces(scene, left);
}

static enum reference_kind choose_kind(const struct scene *scene)
{
	const struct scene_references *r = &scene->references;
	const struct view soon = view_ahead(scene, hurry_ms);
	if (find_off(scene, &soon) > 1)
		return REFERENCE_SMALL;
	return r->since_pass < PASS_PICTURES ? REFERENCE_PLAIN : REFERENCE_WITH_PASS;
}

/* Draws a small one at once, because the last one shows too little of what the eye sees: what is
 * left of the one that was begun, if that is enough. */
static bool catch_up(struct scene *scene)
{
	struct scene_references *r = &scene->references;
	if (r->is_begun && r->kind == REFERENCE_SMALL) {
		go_on(scene, INFINITY);
		if (find_off(scene, &scene->view) <= off_most)
			return true;
	}
	r->kind = REFERENCE_SMALL;
	if (!begin(scene, catch_up_share * lead_ms(scene, 0)))
		return false;
	go_on(scene, INFINITY);
	return true;
}

bool scene_build_reference(struct scene *scene)
{
	struct scene_references *r = &scene->references;
	const float off = find_off(scene, &scene->view);
	const bool is_near = off <= 1;
	r->is_kept = false;
	r->since_depth++;
	if (off > off_most)
		return catch_up(scene);
	if (is_near && !(r->is_begun && r->kind == REFERENCE_SMALL) &&
	    r->since_depth > frames_between_depths(scene)) {
		r->since_depth = 0;
		return false;
	}
	/* there is no time for its pass */
	if (!is_near && !r->is_counted)
		r->is_begun = false;
	if (!r->is_begun) {
		r->kind = choose_kind(scene);
		const float least_ms = r->kind == REFERENCE_SMALL ? hurry_lead_ms : 0;
		if (!begin(scene, lead_ms(scene, least_ms)))
			return false;
	}
	go_on(scene, is_near || r->kind == REFERENCE_SMALL ? r->part : late_parts * r->part);
	return true;
}

void scene_keep_reference(struct scene *scene)
{
	struct scene_references *r = &scene->references;
	const bool programs_wait = scene->programs_wait;
	if (r->is_kept)
		return;
	scene->used = scene->effort;
	r->is_kept = true;
	r->is_begun = false;
	r->kind = REFERENCE_PLAIN; /* the pass of the picture at rest was counted */
	if (scene_uses_references(scene) && begin(scene, 0)) {
		go_on(scene, INFINITY);
		image_warp_let_go(coming(scene));
	}
	scene->used = scene_effort_full;
	scene->programs_wait = programs_wait;
}

/* At the size of the reference and enlarged, because a processor enlarges faster than it warps
 * (docs/picture.md). */
bool scene_show_reference(struct scene *scene, const struct gl_place *place)
{
	struct scene_references *r = &scene->references;
	const struct view *view = &scene->view;
	struct view small;
	if (!scene_uses_references(scene) || find_off(scene, view) > off_most)
		return false;
	enlargement_view(&small, view, scene->used.scale);
	if (enlargement_begin(&scene->enlargement, &small) < 0)
		return false;
	const struct gl_place aside = { .framebuffer = scene->enlargement.small.framebuffer };
	scene_begin_picture(scene);
	image_warp_draw(&r->warp, &r->of[r->shown], &small, &aside);
	enlargement_end(&scene->enlargement, place, view->width_px, view->height_px);
	return true;
}
