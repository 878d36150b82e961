/* Draws a frame: updates what is shown, draws depth maps and pieces, and accumulates at rest. */
#include "render/scene/scene_draw.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/clock.h"
#include "base/log.h"
#include "geometry/vec.h"
#include "render/scene/scene_around.h"
#include "render/scene/scene_backdrop.h"
#include "render/scene/scene_mark.h"
#include "render/scene/scene_picture.h"
#include "render/scene/scene_plan.h"
#include "render/scene/scene_reference.h"
#include "render/scene/scene_scenery.h"
#include "render/scene/scene_still.h"
#include "render/scene/scene_stream.h"
#include "render/scene/scene_visibility.h"
#include "render/scene/scene_wants.h"

enum {
	PLAN_BUDGET_US = 5000,
	PLAN_BUDGET_REST_US = 50000, /* at rest nobody waits for the next frame */
	UPLOAD_BUDGET_REST_US = 25000,
	SEASON_US = 1000000, /* longest season of the tiles while the eye moves */
	FRAME_MOST_MS = 400, /* longest time of a frame that fades go on by */
	PAUSE_MOST_MS = 100, /* the same after a pause in which nothing was drawn: or they jump */
	SHARE_PX_MAX = 320,  /* width of the picture from which image_share is counted */
	DEPTH_TRIANGLES = 24000, /* of a face's depths in a frame, where frames take too long */
	STILL_FRAMES = 1, /* drawn like those before, since a slow finger does not move in each */
	SMALL_FRAMES = 4, /* at rest after them, where a picture at full size takes long */
};

/* ---- depth of faces */

/* Visible surfaces are tested against these depths. A surface that is drawn, but simplified away
 * here, would take the colours of what is in front of it. */
static const float depth_error_px = 0.25f;

/* Returns whether a sphere may be inside the pyramid of a face. */
static bool face_sees(const struct cube_axes *axes, const float sample[3], const float centre[3],
		      float radius)
{
	float to[3];
	vec_sub(to, centre, sample);
	float depth = vec_dot(to, axes->forward), reach = radius * 1.4143f;
	return depth > -radius && fabsf(vec_dot(to, axes->right)) < depth + reach &&
	       fabsf(vec_dot(to, axes->up)) < depth + reach;
}

/* Draws the patches of the face that was begun, in the order of the list, until so many triangles
 * are drawn. */
static void draw_depth_patches(struct scene *scene, uint32_t triangles)
{
	struct depth_task *task = &scene->depth_task;
	const struct cube_axes *axes = &cube_axes[task->face % CUBE_FACES];
	uint32_t drawn = 0;
	glEnableVertexAttribArray(0);
	glDisableVertexAttribArray(1);
	glDisableVertexAttribArray(2);
	for (; task->drawn < scene->around.patch_count && drawn < triangles; task->drawn++) {
		const uint32_t p = scene->around.patches[task->drawn];
		const struct hierarchy_patch *patch = &scene->hierarchy.patches[p];
		const uint32_t count = scene->geometry.patches[p].content.mesh.triangle_count;
		if (!face_sees(axes, task->sample_m, patch->centre_m, patch->radius_m))
			continue;
		geometry_bind(&scene->geometry, p);
		depth_patch(&scene->depth, patch->centre_m);
		geometry_draw(&scene->geometry, 0, count);
		drawn += count;
	}
	if (task->drawn == scene->around.patch_count) {
		depth_end(&scene->depth, task->slot, task->face, task->cut);
		task->is_begun = false;
	}
}

/* Draws the depths of a face, or the first so many triangles of them. */
static void draw_depth_face(struct scene *scene, int slot, face_key face, uint32_t triangles)
{
	const struct cut_options options = { .error_px = depth_error_px,
					     .triangle_budget = scene->options.triangle_budget };
	struct depth_task *task = &scene->depth_task;
	*task = (struct depth_task){
		.is_begun = true, .slot = slot, .face = face, .cut = scene->cut_signature
	};
	repository_point_m(&scene->repository, face / CUBE_FACES, task->sample_m);
	cut_update_around(&scene->around, task->sample_m, (float)scene->depth.layout.face_px / 2,
			  scene->geometry.loaded, &options);
	depth_begin(&scene->depth, face, task->sample_m, &scene->root);
	draw_depth_patches(scene, triangles);
}

/* Returns whether the face that was begun is still wanted, and can be gone on with. */
static bool can_continue_depth(const struct scene *scene)
{
	const struct depth_task *task = &scene->depth_task;
	const struct tiles_face *face = &scene->tiles.faces[task->slot];
	if (!task->is_begun || !face->used || face->key != task->face)
		return false;
	for (uint32_t i = task->drawn; i < scene->around.patch_count; i++)
		if (!scene->geometry.patches[scene->around.patches[i]].pieces)
			return false;
	return true;
}

static bool continue_depth_face(struct scene *scene, uint32_t triangles)
{
	const struct depth_task *task = &scene->depth_task;
	if (!can_continue_depth(scene))
		return false;
	depth_resume(&scene->depth, task->face, task->sample_m, &scene->root);
	draw_depth_patches(scene, triangles);
	return true;
}

/* Draws faces without depths first, within the time; then one whose depths are from an older state
 * of the mesh. */
void scene_draw_depth(struct scene *scene, int64_t until_us, struct scene_frame *out)
{
	const uint32_t triangles = scene_gives_way(scene) ? DEPTH_TRIANGLES : UINT32_MAX;
	int outdated = -1;
	scene->depth_is_stale = false;
	out->depth_faces_drawn += continue_depth_face(scene, triangles);
	for (int i = 0; i < (int)scene->tiles.face_count; i++) {
		const struct tiles_face *face = &scene->tiles.faces[i];
		if (!face->used || face->stamp != scene->tiles.stamp)
			continue;
		if (depth_ready(&scene->depth, i, face->key)) {
			if (scene->depth.face[i].cut != scene->cut_signature)
				outdated = i;
			continue;
		}
		if (out->depth_faces_drawn > 0 &&
		    (triangles < UINT32_MAX || clock_now_us() >= until_us)) {
			scene->depth_is_stale = true;
			return;
		}
		draw_depth_face(scene, i, face->key, triangles);
		out->depth_faces_drawn++;
		scene->depth_is_stale = scene->depth_task.is_begun;
	}
	if (outdated < 0)
		return;
	scene->depth_is_stale = true;
	if (out->depth_faces_drawn > 0)
		return;
	draw_depth_face(scene, outdated, scene->tiles.faces[outdated].key, triangles);
	out->depth_faces_drawn++;
}

/* ---- a picture of shares */

/* Returns the share of the model's pixels that images colour, from a small picture. */
static float count_share(struct scene *scene)
{
	struct gl_target small;
	int width = scene->view.width_px, height = scene->view.height_px;
	while (width > SHARE_PX_MAX) {
		width /= 2;
		height /= 2;
	}
	if (gl_target_create(&small, width, height > 0 ? height : 1) < 0)
		return -1;
	scene_begin_picture(scene);
	glClearColor(0, 0, 0, 0);
	glClear(GL_COLOR_BUFFER_BIT);
	scene_draw_picture(scene, &scene->view, PICTURE_SHARES);
	size_t pixels = (size_t)small.width_px * (size_t)small.height_px;
	uint8_t *rgba = malloc(4 * pixels);
	double shares = 0, covered = 0;
	if (rgba && gl_target_read(&small, rgba) == 0) {
		for (size_t i = 0; i < pixels; i++) {
			covered += rgba[4 * i + 3] > 127;
			shares += rgba[4 * i + 3] > 127 ? rgba[4 * i] / 255.0 : 0;
		}
	}
	free(rgba);
	gl_target_destroy(&small);
	return covered > 0 ? (float)(shares / covered) : 0;
}

/* ---- the frame */

static bool is_busy(const struct scene *scene)
{
	return scene->uploads_wait || scene->plans_are_stale || scene->programs_wait ||
	       scene->fading || scene->depth_is_stale || scene->backdrop.moves ||
	       stream_growth_moves(&scene->stream.growth) || pool_busy(scene->pool) > 0 ||
	       scene_scenery_waits(scene);
}

static bool view_changed(const struct scene *scene, const struct view *view)
{
	const struct view *was = &scene->view;
	return !scene->has_view || memcmp(was->eye_m, view->eye_m, sizeof(was->eye_m)) != 0 ||
	       memcmp(was->clip, view->clip, sizeof(was->clip)) != 0 ||
	       memcmp(was->cut, view->cut, sizeof(was->cut)) != 0 ||
	       was->width_px != view->width_px || was->height_px != view->height_px;
}

/* Starts a new season where the view changed: another view may have room for other tiles. */
static void keep_season(struct scene *scene, bool moved, int64_t now_us)
{
	bool came_to_rest = scene->was_moving && !moved;
	scene->was_moving = moved;
	if (!came_to_rest && (!moved || now_us - scene->season_us < SEASON_US))
		return;
	tiles_begin_season(&scene->tiles);
	scene->season_us = now_us;
}

/* Returns whether the eye rests, but its picture is still enlarged from a small one: what loads,
 * fades and sharpens then comes two to three times as often. */
static bool rests_with_small(const struct scene *scene)
{
	return scene->effort.share < 1 && scene->still_frames > STILL_FRAMES &&
	       scene->still_frames <= STILL_FRAMES + SMALL_FRAMES && !scene_still_is_begun(scene);
}

/* Returns the time since the last frame. */
static float passed_ms(const struct scene *scene)
{
	return scene->frame_us ? fminf((float)(clock_now_us() - scene->frame_us) / 1000,
				       scene->is_still ? PAUSE_MOST_MS : FRAME_MOST_MS)
			       : 0;
}

static void prepare(struct scene *scene, bool moved, float passed, struct scene_frame *out)
{
	int64_t now_us = clock_now_us();
	scene->frame_us = now_us;
	int64_t upload_us = (int64_t)((float)scene->options.upload_budget_us * scene->used.budget);
	/* Where a frame at full size takes long, the usual time would load little in a second. */
	if (scene->still_frames > STILL_FRAMES && upload_us < UPLOAD_BUDGET_REST_US)
		upload_us = UPLOAD_BUDGET_REST_US;
	scene_upload(scene, now_us + upload_us, out);
	scene_step_stream(scene, passed);
	if (!scene->has_hierarchy) {
		scene->plans_are_stale = scene->depth_is_stale = scene->fading = false;
		return;
	}
	scene_update_cut(scene, passed);
	scene_list_pieces(scene);
	/* the first small picture after a stop comes at once: what it lacks is in the next one */
	const bool at_once = rests_with_small(scene) && scene->still_frames == STILL_FRAMES + 1;
	bool counted = false;
	if (scene_uses_references(scene))
		counted = scene_build_reference(scene);
	else if (!at_once)
		counted = scene_take_visibility(scene, moved);
	scene_desire(scene);
	if (scene->options.mode == SCENE_POLYGONS) {
		scene->plans_are_stale = scene->depth_is_stale = false;
		scene->fading = scene->dissolve.moving;
		return;
	}
	keep_season(scene, moved, now_us);
	scene_plan_pieces(scene, moved ? (int64_t)(PLAN_BUDGET_US * scene->used.budget)
				       : PLAN_BUDGET_REST_US);
	scene_fade_blends(scene, passed);
	scene_step_backdrop(scene, passed);
	if ((moved && counted) || at_once)
		/* beside the picture one further pass per frame is enough */
		scene->depth_is_stale = true;
	else
		scene_draw_depth(scene, clock_now_us() + upload_us, out);
}

/* Returns whether the picture was drawn smaller and enlarged. The mask of the marked part is as
 * small as the picture, whose depths it needs; the line is as wide as ever. */
static bool show_enlarged(struct scene *scene, const struct gl_place *place)
{
	const struct view *view = &scene->view;
	struct view small;
	if (!scene_gives_way(scene))
		return false;
	enlargement_view(&small, view, scene->used.scale);
	if (small.width_px >= view->width_px || enlargement_begin(&scene->enlargement, &small) < 0)
		return false;
	scene_begin_picture(scene);
	scene_draw_picture(scene, &small, PICTURE_ASIDE);
	scene_draw_mask(scene, &small, &scene->enlargement.small);
	enlargement_end(&scene->enlargement, place, view->width_px, view->height_px);
	outline_draw(&scene->outline, place, view->width_px, view->height_px);
	return true;
}

/* The mask of the marked part needs the depth of the picture, so a moving one is drawn aside; so is
 * all where the place has no depth. */
static void show_moving(struct scene *scene, const struct gl_place *place)
{
	const struct view *view = &scene->view;
	const struct gl_target *frame = &scene->accumulation.frame;
	if ((place->has_depth && !scene->is_marked) ||
	    accumulation_prepare(&scene->accumulation, view->width_px, view->height_px, true) < 0) {
		gl_place_bind(place, view->width_px, view->height_px);
		scene_begin_picture(scene);
		scene_draw_picture(scene, view, PICTURE_DIRECT);
		return;
	}
	gl_target_bind(frame);
	scene_begin_picture(scene);
	scene_draw_picture(scene, view, PICTURE_ASIDE);
	scene_draw_mask(scene, view, frame);
	accumulation_show_frame(&scene->accumulation, place);
	outline_draw(&scene->outline, place, view->width_px, view->height_px);
}

/* Draws to the given place: at rest through accumulation, while moving directly. */
static void show(struct scene *scene, const struct gl_place *place, bool moved, bool changed)
{
	const struct view *view = &scene->view;
	if (moved)
		scene_still_forget(scene);
	if (scene_show_reference(scene, place) || show_enlarged(scene, place))
		return;
	const bool draws = changed || scene_still_is_begun(scene) ||
			   !accumulation_is_done(&scene->accumulation);
	if (moved || accumulation_prepare(&scene->accumulation, view->width_px, view->height_px,
					  draws) < 0) {
		show_moving(scene, place);
		return;
	}
	scene_still_show(scene, place, draws, changed);
}

void scene_spend(struct scene *scene, const struct scene_effort *effort)
{
	scene->effort = *effort;
}

static void draw_nothing(const struct camera *camera)
{
	glViewport(0, 0, camera->width_px, camera->height_px);
	glClearColor(0, 0, 0, 0);
	glClear(GL_COLOR_BUFFER_BIT | GL_DEPTH_BUFFER_BIT);
}

void scene_draw(struct scene *scene, const struct camera *camera, const struct scene_mark *mark,
		struct scene_frame *out)
{
	struct gl_place place = { .x_px = camera->shift_px[0], .y_px = camera->shift_px[1] };
	GLint framebuffer = 0, depth_bits = 0;
	*out = (struct scene_frame){ .image_share = -1 };
	scene->wants_are_stale = scene->wants_are_stale || scene->lacked_memory;
	scene->lacked_memory = false;
	if (!scene->has_hierarchy && !scene->stream.growth.decoder) {
		draw_nothing(camera);
		scene->frame_us = clock_now_us();
		return;
	}
	glGetIntegerv(GL_FRAMEBUFFER_BINDING, &framebuffer);
	glGetIntegerv(GL_DEPTH_BITS, &depth_bits);
	place.framebuffer = (GLuint)framebuffer;
	place.has_depth = depth_bits > 0;
	struct view view;
	view_from_camera(&view, camera);
	section_cut(&scene->tools.section, view.eye_m, view.cut);
	bool moved = view_changed(scene, &view) || scene->tools_moved;
	const float passed = passed_ms(scene);
	scene->still_eye_frames = moved ? 0 : scene->still_eye_frames + 1;
	scene->eye_moves = scene->still_eye_frames <= STILL_FRAMES;
	if (scene_step_scenery(scene, passed)) {
		if (!scene->eye_moves)
			scene_forget_references(scene);
		moved = true;
	}
	scene->tools_moved = false;
	scene->still_frames = moved ? 0 : scene->still_frames + 1;
	scene->used = scene->still_frames <= STILL_FRAMES ? scene->effort : scene_effort_full;
	if (rests_with_small(scene))
		scene->used.scale = scene->effort.scale;
	scene_note_motion(scene, &view, fminf(passed, PAUSE_MOST_MS));
	scene->camera = *camera;
	scene->view = view;
	scene->has_view = true;
	/* what a picture shows may not change while parts of it are drawn */
	out->sliced = scene_still_is_begun(scene) && !moved;
	scene->still.passed_ms += passed;
	if (out->sliced) {
		scene->frame_us = clock_now_us();
	} else {
		prepare(scene, moved, fminf(scene->still.passed_ms, FRAME_MOST_MS), out);
		scene->still.passed_ms = 0;
		if (scene_scenery(scene))
			scene_update_around(scene, moved);
	}
	if (scene_note_mark(scene, mark))
		/* it answers a touch, so it must not blend in slowly */
		scene_still_renew(scene);
	bool changed = is_busy(scene);
	show(scene, &place, moved, changed);
	out->sliced |= scene_still_is_begun(scene);
	out->triangles = scene->cut.triangle_count;
	out->patches = scene->cut.patch_count;
	out->stream_triangles = scene->stream.growth.triangle_count;
	scene_list_wants(scene);
	/* Wanted objects may never arrive, so memory is freed without waiting for them. */
	bool still = !moved && !changed && !scene_still_is_begun(scene) &&
		     accumulation_is_done(&scene->accumulation);
	scene->is_still = still;
	out->settled = still && scene->want_count == 0;
	out->moved = moved;
	out->moving = !still || is_busy(scene);
	if (!out->settled)
		scene->image_share = -1;
	else if (scene->image_share < 0)
		scene->image_share = count_share(scene);
	out->image_share = scene->image_share;
	if (!still) {
		scene->references.is_kept = false;
		return;
	}
	if (scene->effort.share < 1)
		scene_keep_reference(scene);
	else
		scene_drop_references(scene);
	enlargement_let_go(&scene->enlargement);
	outline_let_go(&scene->outline);
	accumulation_let_go(&scene->accumulation, &place);
	gl_place_bind(&place, camera->width_px, camera->height_px);
}
