/* Takes decoded objects, grows the cut, lists the pieces in the frustum, plans which faces colour
 * them, and fades between faces. */
#include "render/scene/scene_plan.h"

#include <errno.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/array.h"
#include "base/clock.h"
#include "base/log.h"
#include "geometry/vec.h"
#include "render/plan/plan_quality.h"
#include "render/scene/scene_objects.h"
#include "render/scene/scene_scenery.h"
#include "render/scene/scene_space.h"

/* A piece is planned again when the eye has moved by this share of its distance. */
static const float eye_moved = 0.02f;

/* ---- what workers decoded */

static void upload_one(struct scene *scene, struct pool_answer *answer, struct scene_frame *out)
{
	uint64_t at = map_get(&scene->decoding, answer->id);
	map_remove(&scene->decoding, answer->id);
	if (at == MAP_NONE || at >= scene->object_count)
		return;
	struct object *object = &scene->objects[at];
	int rc = answer->error;
	object->state = OBJECT_WANTED; /* it may be wanted again after it is dropped */
	if (rc == 0 && object->kind == OBJECT_GROUP) {
		rc = geometry_put(&scene->geometry, (uint32_t)object->id, answer);
	} else if (rc == 0 && object->kind == OBJECT_LABELS) {
		rc = geometry_label(&scene->geometry, (uint32_t)object->id, &answer->labels);
		if (scene->is_marked)
			accumulation_break(
				&scene->accumulation); /* the accumulated sum has the old outline */
	} else if (rc == 0 && object->kind == OBJECT_SOLID) {
		scene_put_solid(scene, &answer->solid);
	} else if (rc == 0 && object->kind == OBJECT_SCENERY) {
		rc = scene_put_scenery(scene, &answer->scenery);
	} else if (rc == 0) {
		rc = tiles_put(&scene->tiles, tile_name_unpack(object->id), answer->rgb);
		out->tiles_uploaded += rc == 0;
		if (rc == -ENOSPC)
			rc = 0; /* every slot is in use; not an error */
	}
	if (rc == -EBADMSG)
		scene_refuse(scene, object, rc);
	else if (rc < 0)
		log_warn("render", "an object could not be used: %s", strerror(-rc));
}

void scene_upload(struct scene *scene, int64_t until_us, struct scene_frame *out)
{
	struct pool_answer answer;
	scene->uploads_wait = false;
	while (pool_busy(scene->pool) > 0 && pool_take(scene->pool, &answer)) {
		upload_one(scene, &answer, out);
		pool_answer_finish(&answer);
		if (clock_now_us() >= until_us) {
			scene->uploads_wait = true;
			return;
		}
	}
}

/* ---- what is in sight */

static struct cut_options cut_options_of(const struct scene *scene)
{
	return (struct cut_options){ .error_px = scene->options.patch_error_px,
				     .triangle_budget = scene->options.triangle_budget };
}

/* Pictures of scenery take from the patches' memory, but leave half of it. */
static uint64_t geometry_budget(const struct scene *scene)
{
	const uint64_t all = scene->options.geometry_budget_bytes;
	const uint64_t pictures = scene_scenery_bytes(scene);

	return all - (pictures < all / 2 ? pictures : all / 2);
}

/* Where a picture takes several frames, groups replace each other so many times as fast: few steps
 * of it would be seen, and until it is over both are drawn. */
static const float hurry = 4;

void scene_update_cut(struct scene *scene, float passed_ms)
{
	struct cut_options options = cut_options_of(scene);
	struct geometry *geometry = &scene->geometry;
	if (options.triangle_budget > scene->used.triangles)
		options.triangle_budget = scene->used.triangles;
	geometry_evict(geometry, &scene->cut, geometry_budget(scene));
	cut_update(&scene->cut, &scene->view, geometry->loaded, &options);
	scene->cut_signature = geometry->changes;
	dissolve_step(&scene->dissolve, geometry->loaded,
		      scene->used.share < 1 ? hurry * passed_ms : passed_ms);
}

void scene_desire(struct scene *scene)
{
	const struct cut_options options = cut_options_of(scene);
	cut_desire(&scene->cut, &scene->view, scene->geometry.loaded,
		   scene->visibility_us ? scene->seen_px : NULL, &options);
}

float scene_patch_error_m(const struct scene *scene, uint32_t patch)
{
	uint32_t finer = scene->hierarchy.patches[patch].finer;
	if (finer != HIERARCHY_NONE)
		return scene->hierarchy.groups[finer].error_m;
	/* For the finest published patches the error against the scan is not stored; half the error
	 * of the group they came with is a fair guess. */
	float error = scene->hierarchy.groups[scene->hierarchy.patches[patch].group].error_m;
	return isfinite(error) ? error / 2 : 0;
}

static bool add_visible(struct scene *scene, const struct visible_piece *piece)
{
	const uint32_t count = scene->visible_count + scene->leaving_count;
	if (ARRAY_RESERVE(scene->visible, scene->visible_room, count + 1, UINT32_MAX) < 0) {
		scene->lacked_memory = true;
		return false;
	}
	scene->visible[count] = *piece;
	return true;
}

/* Lists the pieces of a patch that are in the frustum, as far as memory allows. */
static void list_patch(struct scene *scene, uint32_t p, uint32_t *count)
{
	const struct view *view = &scene->view;
	const struct hierarchy_patch *patch = &scene->hierarchy.patches[p];
	const struct patch_bvh *bvh = &scene->geometry.patches[p].content.bvh;
	if (!view_sees_sphere(view, patch->centre_m, patch->radius_m))
		return;
	for (uint32_t k = 0; k < bvh->piece_count; k++) {
		const struct piece *piece = &bvh->pieces[k];
		const struct visible_piece visible = {
			.patch = p,
			.piece = k,
			.pixels = view_sphere_px(view, piece->centre_m, piece->radius_m),
			.range = dissolve_range(&scene->dissolve, p),
		};
		if (view_sees_sphere(view, piece->centre_m, piece->radius_m))
			*count += add_visible(scene, &visible);
	}
}

static int by_distance(const void *a, const void *b, void *data)
{
	const struct scene *scene = data;
	const uint32_t *patch[2] = { a, b };
	float distance[2];
	for (int i = 0; i < 2; i++)
		distance[i] = vec_distance(scene->hierarchy.patches[*patch[i]].centre_m,
					   scene->view.eye_m);
	return (distance[0] > distance[1]) - (distance[0] < distance[1]);
}

/* Front to back, so that hidden fragments fail the depth test before they are coloured. */
void scene_list_pieces(struct scene *scene)
{
	qsort_r(scene->cut.patches, scene->cut.patch_count, sizeof(*scene->cut.patches),
		by_distance, scene);
	scene->visible_count = scene->leaving_count = 0;
	for (uint32_t i = 0; i < scene->cut.patch_count; i++)
		list_patch(scene, scene->cut.patches[i], &scene->visible_count);
	for (uint32_t p = 0; p < scene->hierarchy.patch_count && scene->dissolve.moving; p++)
		if (!cut_shows(&scene->cut, p) &&
		    dissolve_draws(dissolve_range(&scene->dissolve, p)))
			list_patch(scene, p, &scene->leaving_count);
}

/* ---- which faces colour them */

static int level_at(void *data, face_key face, float u, float v)
{
	const struct scene *scene = data;
	return tiles_level_at(&scene->tiles, face, u, v);
}

bool scene_sees(const struct scene *scene, const float sample_m[3], const float point_m[3])
{
	float to[3];
	vec_sub(to, point_m, sample_m);
	float distance = vec_normalise(to);
	/* Stop before the surface itself, by more than the usual error of the mesh. */
	float most = distance * 0.985f - 2.5f * depth_slack_m(&scene->depth);
	if (most <= 0)
		return true;
	return !geometry_blocks(&scene->geometry, &scene->cut, sample_m, to, most);
}

static bool sees(void *data, const float sample_m[3], const float point_m[3])
{
	return scene_sees(data, sample_m, point_m);
}

/* Returns a sum that changes when a tile of a wanted face comes or goes. */
static uint32_t versions_of(const struct scene *scene, const struct plan_choice *choice)
{
	uint32_t sum = 0;
	for (uint32_t i = 0; i < choice->want_count; i++) {
		int slot = tiles_face_slot(&scene->tiles, choice->want[i].face);
		if (slot >= 0)
			sum += scene->tiles.faces[slot].version;
	}
	return sum;
}

static bool is_stale(const struct scene *scene, const struct piece *piece,
		     const struct piece_state *state)
{
	if (state->counted && state->seen_px <= 0)
		return false; /* hidden: keeps its old colours */
	if (!state->planned || state->orphan)
		return true;
	if (state->choice.want_count > 0 &&
	    (state->planned_epoch != scene->epoch ||
	     state->planned_versions != versions_of(scene, &state->choice)))
		return true;
	float moved = vec_distance(state->planned_eye_m, scene->view.eye_m);
	float distance = view_sphere_distance(&scene->view, piece->centre_m, piece->radius_m);
	return moved > eye_moved * (distance + piece->radius_m);
}

static void plan_one(struct scene *scene, const struct plan_world *world,
		     const struct visible_piece *visible, struct piece_state *state)
{
	struct plan_surface surface = {
		.piece =
			&scene->geometry.patches[visible->patch].content.bvh.pieces[visible->piece],
		.error_m = scene_patch_error_m(scene, visible->patch),
		.probe = state->probe,
	};
	for (int k = 0; k < PIECE_PROBES; k++)
		surface.weight[k] = state->counted ? state->weight[k] : 1.0f / PIECE_PROBES;
	/* Up to a fifth more texels than needed; the higher the thrift, the fewer. */
	struct plan_eye eye = { .focal_px = scene->view.focal_px,
				.texels = 1 + 0.2f / (1 + scene->options.price_px_per_kb / 10) };
	memcpy(eye.eye_m, scene->view.eye_m, sizeof(eye.eye_m));
	if (scene->options.mode == SCENE_CORNERS)
		plan_piece_corners(&state->choice, world, &eye, &surface);
	else
		plan_piece(&state->choice, world, &eye, &surface);
	state->planned = true;
	state->orphan = false;
	state->planned_epoch = scene->epoch;
	state->planned_versions = versions_of(scene, &state->choice);
	memcpy(state->planned_eye_m, eye.eye_m, sizeof(eye.eye_m));
}

void scene_plan_pieces(struct scene *scene, int64_t budget_us)
{
	int64_t until_us = clock_now_us() + budget_us;
	const struct plan_world world = {
		.repository = &scene->repository,
		.resident = scene->tiles.keys,
		.resident_count = scene->tiles.key_count,
		.level_at = level_at,
		.sees = sees,
		.data = scene,
	};
	scene->plans_are_stale = false;
	if (!scene->repository.ready)
		return;
	/* Each frame continues where the last one ran out of time. */
	uint32_t count = scene->visible_count;
	uint32_t start = count ? scene->plan_cursor % count : 0;
	for (uint32_t i = 0; i < count; i++) {
		uint32_t at = (start + i) % count;
		const struct visible_piece *v = &scene->visible[at];
		struct geometry_patch *patch = &scene->geometry.patches[v->patch];
		struct piece_state *state = &patch->pieces[v->piece];
		if (!is_stale(scene, &patch->content.bvh.pieces[v->piece], state))
			continue;
		if (clock_now_us() >= until_us) {
			scene->plan_cursor = at;
			scene->plans_are_stale = true;
			return;
		}
		plan_one(scene, &world, v, state);
	}
}

/* ---- fades */

/* Returns how many of the entries, which are in the order of what they add, may be used. */
static uint32_t entries_used(const struct scene *scene, const struct plan_choice *choice)
{
	const uint32_t most = scene->used.faces;
	return choice->entry_count < most ? choice->entry_count : most;
}

static bool blend_is_chosen(const struct plan_choice *choice, uint32_t entries, struct blend *blend)
{
	for (uint32_t i = 0; i < entries; i++) {
		if (choice->entry[i].face != blend->face)
			continue;
		blend->half_px = choice->entry[i].half_px;
		blend->target = choice->entry[i].share;
		return true;
	}
	blend->target = 0;
	return false;
}

static bool is_blended(const struct piece_state *state, face_key face)
{
	for (int i = 0; i < PLAN_ENTRIES; i++)
		if (state->blend[i].held && state->blend[i].face == face)
			return true;
	return false;
}

static void take_up(struct piece_state *state, const struct plan_entry *entry)
{
	for (int i = 0; i < PLAN_ENTRIES; i++) {
		if (state->blend[i].held)
			continue;
		state->blend[i] = (struct blend){ .face = entry->face,
						  .half_px = entry->half_px,
						  .held = true,
						  .target = entry->share };
		return;
	}
}

/* Returns whether any weight still changes. */
static bool fade_piece(struct scene *scene, struct piece_state *state, float step)
{
	const uint32_t entries = entries_used(scene, &state->choice);
	bool moving = false;
	for (int i = 0; i < PLAN_ENTRIES; i++) {
		struct blend *blend = &state->blend[i];
		if (!blend->held)
			continue;
		int slot = tiles_face_slot(&scene->tiles, blend->face);
		if (slot < 0) {
			*blend = (struct blend){ 0 };
			state->orphan = true;
			moving = true;
			continue;
		}
		bool chosen = blend_is_chosen(&state->choice, entries, blend);
		if (chosen && !depth_ready(&scene->depth, slot, blend->face))
			continue; /* its depths are not drawn yet */
		float left = blend->target - blend->weight;
		blend->weight += left > step ? step : left < -step ? -step : left;
		moving |= fabsf(left) > 0;
		if (!chosen && blend->weight <= 0)
			*blend = (struct blend){ 0 };
	}
	for (uint32_t i = 0; i < entries; i++) {
		face_key face = state->choice.entry[i].face;
		if (is_blended(state, face) || tiles_face_slot(&scene->tiles, face) < 0)
			continue;
		take_up(state, &state->choice.entry[i]);
		moving = true;
	}
	return moving;
}

static void touch_piece(struct scene *scene, const struct piece *piece,
			const struct piece_state *state)
{
	for (int i = 0; i < PLAN_ENTRIES; i++) {
		if (!state->blend[i].held)
			continue;
		struct plan_area area;
		float sample[3];
		face_key face = state->blend[i].face;
		repository_point_m(&scene->repository, face / CUBE_FACES, sample);
		if (plan_footprint(&area, face, sample, piece))
			tiles_touch(&scene->tiles, face, area.u0, area.v0, area.u1, area.v1);
	}
}

/* Returns whether every face chosen for the piece has reached its weight. */
static bool is_dressed(const struct scene *scene, const struct piece_state *state)
{
	const uint32_t entries = entries_used(scene, &state->choice);
	for (uint32_t i = 0; i < entries; i++) {
		const struct plan_entry *entry = &state->choice.entry[i];
		bool held = tiles_face_slot(&scene->tiles, entry->face) < 0;
		for (int k = 0; k < PLAN_ENTRIES; k++)
			held |= state->blend[k].held && state->blend[k].face == entry->face &&
				state->blend[k].weight >= entry->share;
		if (!held)
			return false;
	}
	return true;
}

void scene_fade_blends(struct scene *scene, float passed_ms)
{
	float step = passed_ms / TILES_FADE_MS;
	tiles_begin(&scene->tiles);
	scene->fading = false;
	for (uint32_t i = 0; i < scene->visible_count + scene->leaving_count; i++) {
		const struct visible_piece *v = &scene->visible[i];
		struct geometry_patch *patch = &scene->geometry.patches[v->patch];
		struct piece_state *state = &patch->pieces[v->piece];
		/* A piece that is not shown yet takes its first weights at once. */
		const bool shown = dissolve_draws(v->range);
		const bool hidden = state->counted && state->seen_px <= 0;
		const bool moving = fade_piece(scene, state, shown ? step : 1);
		scene->fading |= moving;
		if (!hidden)
			touch_piece(scene, &patch->content.bvh.pieces[v->piece], state);
		if (!shown && !hidden && (moving || !state->planned || !is_dressed(scene, state)))
			dissolve_hold(&scene->dissolve, scene->hierarchy.patches[v->patch].group);
	}
	scene->fading |= tiles_tick(&scene->tiles) || scene->dissolve.moving;
}
