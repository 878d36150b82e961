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

/* Frames between two that renew depths of faces, and between two where some are missing. */
enum { DEPTH_FRAMES = 4, MISSING_FRAMES = 2 };

/* What reading a pass back and what counting it takes, in triangles of it. */
static const float reading_cost = 0.3f * VISIBILITY_WIDTH * VISIBILITY_HEIGHT;
static const float counting_cost = 0.5f * VISIBILITY_WIDTH * VISIBILITY_HEIGHT;
/* Its field of view is so much wider, for what the eye turns to. */
static const float wider = 1.06f;
/* It is drawn for the time when it is shown first, but not for later than this, nor for
 * farther away than this share of what is nearest: eyes stop and turn round. */
static const float lead_most_ms = 300, lead_most_share = 0.4f;
/* Where no reference is near, at least this share of the next one is drawn beside each direct
 * picture, so that there are few of those. */
static const float direct_share = 0.25f;
/* The direct picture has this part of the scale of references, because it is for an eye that is too
 * fast to see details; but this scale at least. */
static const float direct_part = 0.5f, direct_least = 0.25f;
/* The eye's speed is that of about so long: fingers tremble. */
static const float speed_ms = 60;
/* A turn uncovers the edge of a picture as long as it is shown, so its direction is that of the
 * middle of that time. */
static const float turn_lead = 1.5f;

bool scene_uses_references(const struct scene *scene)
{
	return scene->used.share < 1 && scene->has_hierarchy && scene->backdrop.share <= 0 &&
	       (scene->eye_moves || scene_scenery_is_still(scene)) &&
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

float scene_direct_scale(const struct scene *scene)
{
	const float scale = scene->used.scale;
	return scene_uses_references(scene) ? fmaxf(direct_part * scale, direct_least) : scale;
}

/* ---- the view of the next one */

/* Returns in how many milliseconds the next picture is shown first, if it takes as long as the last
 * one. A lead to the middle of the time in which it is shown gave no better pictures
 * (docs/figures.md). */
static float lead_ms(const struct scene *scene)
{
	const struct scene_references *r = &scene->references;
	const float speed = sqrtf(vec_dot(r->eye_speed, r->eye_speed));
	const float most_m = lead_most_share * r->of[r->shown].nearest_m;
	float ms = fminf(r->took_ms, lead_most_ms);
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

static void sum_costs(struct scene *scene, float picture_px)
{
	float cost = reading_cost + counting_cost;
	for (uint32_t i = 0; i < scene->counted_all; i++) {
		const struct visible_piece *v = &scene->counted[i];
		const struct piece *piece =
			&scene->geometry.patches[v->patch].content.bvh.pieces[v->piece];
		cost += (float)piece->triangle_count + scene_piece_cost(scene, v, 1, picture_px);
	}
	scene->references.cost = cost;
}

/* Lists the pieces of another view, and begins its visibility pass and its picture with them. */
static bool begin(struct scene *scene, float ahead_ms)
{
	struct scene_references *r = &scene->references;
	struct image_warp_reference *next = coming(scene);
	const struct view seen = scene->view;
	struct view small;
	scene->view = next->view = view_ahead(scene, ahead_ms);
	enlargement_view(&small, &next->view, scene->used.scale);
	if (image_warp_begin(&r->warp, next, small.width_px, small.height_px) < 0) {
		scene->view = seen;
		return false;
	}
	scene_begin_picture(scene);
	scene_list_pieces(scene);
	r->is_begun = scene_begin_visibility(scene, scene_scenery_far_m(scene, next->view.eye_m));
	scene->view = seen;
	scene_list_pieces(scene);
	if (!r->is_begun)
		return false;
	scene->counting = r->is_read = r->is_counted = false;
	r->begun_ms = 0;
	r->numbered = 0;
	sum_costs(scene, small.picture_px);
	const struct surface_frame frame = scene_surface_frame(scene, &small, PICTURE_ASIDE);
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

/* Draws scenery into the pass, and takes its depths. */
static void read_depths(struct scene *scene)
{
	visibility_resume(&scene->visibility, &scene->root);
	scene_draw_scenery_depths(scene);
	if (visibility_end(&scene->visibility) < 0) {
		log_warn("render", "a picture will be warped with the depths of another one");
		scene->references.is_counted = true; /* there is nothing to count */
	}
	image_warp_take_depths(coming(scene), &scene->visibility);
	scene->references.is_read = true;
}

/* Draws pieces of the picture. After the last one it is the one that is shown. */
static void draw_pieces(struct scene *scene, float cost)
{
	struct scene_references *r = &scene->references;
	struct image_warp_reference *next = coming(scene);
	const struct gl_place place = { .framebuffer = next->picture.framebuffer };
	struct view small;
	enlargement_view(&small, &next->view, scene->used.scale);
	small.width_px = next->picture.width_px;
	small.height_px = next->picture.height_px;
	const struct surface_frame frame = scene_surface_frame(scene, &small, PICTURE_ASIDE);
	gl_target_bind(&next->picture);
	scene_resume_picture();
	if (!scene_draw_slice(scene, &frame, &r->slice, cost))
		return;
	scene_draw_scenery(scene, &frame);
	scene_draw_mask(scene, &small, &next->picture);
	outline_draw(&scene->outline, &place, small.width_px, small.height_px);
	r->shown = 1 - r->shown;
	r->has_shown = true;
	r->is_begun = false;
	if (r->begun_ms > 0)
		r->took_ms = r->begun_ms;
}

/* Returns whether a face that is used has no depths. */
static bool depth_is_missing(const struct scene *scene)
{
	for (int i = 0; i < (int)scene->tiles.face_count; i++) {
		const struct tiles_face *face = &scene->tiles.faces[i];
		if (face->used && face->stamp == scene->tiles.stamp &&
		    !depth_ready(&scene->depth, i, face->key))
			return true;
	}
	return false;
}

/* Goes on with the picture that was begun until the cost is reached. */
static void go_on(struct scene *scene, float cost)
{
	struct scene_references *r = &scene->references;
	if (r->numbered < scene->counted_count)
		cost -= draw_numbers(scene, cost);
	if (r->numbered == scene->counted_count && !r->is_read && cost > 0) {
		read_depths(scene);
		cost -= reading_cost;
	}
	if (r->is_read && !r->is_counted && cost > 0) {
		/* at rest the pass of the picture at rest was counted */
		if (!r->is_kept)
			scene_count_visibility(scene);
		r->is_counted = true;
		cost -= counting_cost;
	}
	if (r->is_counted && cost > 0)
		draw_pieces(scene, cost);
}

/* Returns whether the last one shows the eye what it sees now. */
static bool is_near(const struct scene *scene)
{
	const struct scene_references *r = &scene->references;
	return r->has_shown && image_warp_reaches(&r->of[r->shown], &scene->view);
}

bool scene_build_reference(struct scene *scene)
{
	struct scene_references *r = &scene->references;
	float share = scene->used.share;
	r->is_kept = false;
	r->since_depth++;
	if (!is_near(scene))
		share = fmaxf(share, direct_share);
	else if (r->since_depth > (depth_is_missing(scene) ? MISSING_FRAMES : DEPTH_FRAMES)) {
		r->since_depth = 0;
		return false;
	}
	if (!r->is_begun && !begin(scene, lead_ms(scene)))
		return false;
	go_on(scene, share * r->cost);
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
	if (!scene_uses_references(scene) || !is_near(scene))
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
