/* Runs the visibility pass when it is due, counts the visible pixels of pieces and patches, and
 * moves the probes. */
#include "render/scene/scene_visibility.h"

#include <string.h>

#include "base/array.h"
#include "base/clock.h"
#include "geometry/vec.h"

enum {
	MOVING_US = 120000, /* between two passes while the eye moves */
	PARTS = 2,          /* of a pass while the eye moves, each drawn in a frame of its own */
	MOST_PARTS = 4,     /* the same, where frames take too long */
	PROBE_MOVES = 2,    /* rounds of moving probes per pass */
};

/* A view that differs by less than this counts as the same. */
static const float moved_m = 0.05f, turned = 0.01f;
/* A visible point farther than this share of a piece's radius from every probe deserves a probe. */
static const float stray_share = 0.2f;

/* The rest of an uncounted piece's sphere is beside it, or hidden. */
static const float seen_share = 0.125f;

float scene_seen_px(const struct piece_state *state, const struct visible_piece *v)
{
	return state->counted ? state->seen_px : seen_share * v->pixels;
}

static bool is_due(const struct scene *scene, bool moved)
{
	if (scene->visibility_us == 0 || scene->visibility_cut != scene->cut_signature)
		return true;
	if (!moved &&
	    memcmp(scene->visibility_section, scene->view.cut, sizeof(scene->view.cut)) != 0)
		return true;
	if (moved && clock_now_us() - scene->visibility_us < MOVING_US)
		return false;
	float limit = moved ? 1 : 0.2f; /* at rest the limits are tighter */
	return (moved && view_is_cut(&scene->view)) ||
	       vec_distance(scene->visibility_eye_m, scene->view.eye_m) > limit * moved_m ||
	       vec_distance(scene->visibility_forward, scene->view.forward) > limit * turned;
}

void scene_draw_numbers(struct scene *scene, uint32_t from, uint32_t to)
{
	uint32_t bound = HIERARCHY_NONE;
	for (uint32_t i = from; i < to; i++) {
		const struct visible_piece *v = &scene->counted[i];
		const struct geometry_patch *patch = &scene->geometry.patches[v->patch];
		if (!patch->pieces)
			continue; /* dropped since the pass began */
		const struct piece *piece = &patch->content.bvh.pieces[v->piece];
		if (v->patch != bound)
			geometry_bind(&scene->geometry, v->patch);
		bound = v->patch;
		visibility_number(&scene->visibility, i);
		geometry_draw(&scene->geometry, piece->first_triangle, piece->triangle_count);
	}
}

bool scene_keep_pieces(struct scene *scene)
{
	const uint32_t all = scene->visible_count + scene->leaving_count;
	if (ARRAY_RESERVE(scene->counted, scene->counted_room, all, UINT32_MAX) < 0) {
		scene->lacked_memory = true;
		return false;
	}
	scene->counted_count = scene->visible_count < VISIBILITY_PIECES_MAX ? scene->visible_count
									    : VISIBILITY_PIECES_MAX;
	scene->counted_all = all;
	if (all > 0)
		memcpy(scene->counted, scene->visible, all * sizeof(*scene->counted));
	scene->references.is_begun = false;
	return true;
}

bool scene_begin_visibility(struct scene *scene, float beside_m)
{
	if (!scene_keep_pieces(scene))
		return false;
	scene->counting_cut = scene->cut_signature;
	visibility_begin(&scene->visibility, &scene->view, &scene->root, beside_m);
	return true;
}

/* Returns in how many frames a pass is drawn, so that none takes much longer than others. */
static uint32_t parts_of(const struct scene *scene, bool moved)
{
	if (!moved)
		return 1;
	return scene_gives_way(scene) ? MOST_PARTS : PARTS;
}

/* Draws the next part of a pass. Returns whether the pass is complete. */
static bool draw(struct scene *scene, bool moved)
{
	uint32_t parts = parts_of(scene, moved);
	if (scene->counting && moved && scene->counting_cut == scene->cut_signature) {
		visibility_resume(&scene->visibility, &scene->root);
	} else {
		/* A pass that had to begin again is drawn at once, or it might never end. */
		parts = scene->counting ? 1 : parts;
		if (!scene_begin_visibility(scene, 0))
			return false;
		scene->counted_drawn = 0;
	}
	const uint32_t left = scene->counted_count - scene->counted_drawn;
	const uint32_t part = (scene->counted_count + parts - 1) / parts;
	const uint32_t to = scene->counted_drawn + (part < left ? part : left);
	scene_draw_numbers(scene, scene->counted_drawn, to);
	scene->counted_drawn = to;
	scene->counting = to < scene->counted_count;
	return !scene->counting;
}

static int nearest_probe(const struct piece_state *state, const float at_m[3])
{
	int nearest = 0;
	for (int k = 1; k < PIECE_PROBES; k++)
		if (vec_distance(state->probe[k].at_m, at_m) <
		    vec_distance(state->probe[nearest].at_m, at_m))
			nearest = k;
	return nearest;
}

/* Returns NULL where its patch was dropped since the pass began. */
static struct piece_state *state_of(const struct scene *scene, uint32_t visible)
{
	if (visible >= scene->counted_count)
		return NULL;
	const struct visible_piece *v = &scene->counted[visible];
	const struct geometry_patch *patch = &scene->geometry.patches[v->patch];
	return patch->pieces ? &patch->pieces[v->piece] : NULL;
}

/* Counts a visible point. The point of a piece farthest from every probe is kept in stray_m and
 * stray_off_m. */
static void count_point(struct scene *scene, const struct visibility_point *point)
{
	struct piece_state *state = state_of(scene, point->piece);
	if (!state)
		return;
	if (point->back &&
	    /* a section plane shows back faces only for now */
	    !view_is_cut(&scene->visibility.view))
		scene->geometry.patches[scene->counted[point->piece].patch].sides = SIDES_BOTH;
	int nearest = nearest_probe(state, point->at_m);
	float off = vec_distance(state->probe[nearest].at_m, point->at_m);
	state->weight[nearest] += 1;
	state->seen_px += 1;
	if (off > state->stray_off_m) {
		state->stray_off_m = off;
		memcpy(state->stray_m, point->at_m, sizeof(state->stray_m));
	}
}

static void count_all(struct scene *scene)
{
	struct visibility_point point;
	for (uint32_t i = 0; i < scene->counted_count; i++) {
		struct piece_state *state = state_of(scene, i);
		if (!state)
			continue;
		state->seen_px = state->stray_off_m = 0;
		memset(state->weight, 0, sizeof(state->weight));
	}
	for (int y = 0; y < VISIBILITY_HEIGHT; y++)
		for (int x = 0; x < VISIBILITY_WIDTH; x++)
			if (visibility_at(&scene->visibility, x, y, &point))
				count_point(scene, &point);
}

/* Moves a probe without visible points to the visible point farthest from any probe. */
static void move_probe(struct scene *scene, uint32_t visible)
{
	struct piece_state *state = state_of(scene, visible);
	if (!state)
		return;
	const struct visible_piece *v = &scene->counted[visible];
	const struct patch_bvh *bvh = &scene->geometry.patches[v->patch].content.bvh;
	const struct piece *piece = &bvh->pieces[v->piece];
	if (state->stray_off_m < stray_share * piece->radius_m)
		return;
	int idle = 0;
	while (idle < PIECE_PROBES && state->weight[idle] > 0)
		idle++;
	if (idle == PIECE_PROBES)
		return;
	/* The nearest of the piece's initial probes provides the normal. */
	struct piece_probe like = patch_bvh_probe(bvh, piece, 0);
	for (int k = 1; k < PIECE_PROBES; k++) {
		struct piece_probe other = patch_bvh_probe(bvh, piece, k);
		if (vec_distance(other.at_m, state->stray_m) <
		    vec_distance(like.at_m, state->stray_m))
			like = other;
	}
	memcpy(like.at_m, state->stray_m, sizeof(like.at_m));
	state->probe[idle] = like;
	plan_forget_probe(&state->choice, idle);
}

/* Normalises the weights, scales the count to pixels of the screen, and has the piece planned
 * again. */
static void conclude(struct scene *scene, const struct visible_piece *visible)
{
	struct geometry_patch *patch = &scene->geometry.patches[visible->patch];
	if (!patch->pieces)
		return;
	struct piece_state *state = &patch->pieces[visible->piece];
	if (patch->sides == SIDES_UNKNOWN && !view_is_cut(&scene->visibility.view))
		patch->sides = SIDES_FRONT;
	for (int k = 0; k < PIECE_PROBES && state->seen_px > 0; k++)
		state->weight[k] /= state->seen_px;
	state->seen_px *=
		scene->visibility.view.picture_px / (VISIBILITY_WIDTH * VISIBILITY_HEIGHT);
	state->counted = true;
	state->planned = false;
}

/* Sums the visible pixels of the shown patches; the others were not counted. */
static void sum_patches(struct scene *scene)
{
	for (uint32_t p = 0; p < scene->hierarchy.patch_count; p++)
		scene->seen_px[p] = -1;
	for (uint32_t i = 0; i < scene->cut.patch_count; i++)
		scene->seen_px[scene->cut.patches[i]] = 0;
	float all_px = 0;
	for (uint32_t i = 0; i < scene->counted_count; i++) {
		const struct piece_state *state = state_of(scene, i);
		const float seen_px = state ? state->seen_px : 0;
		scene->seen_px[scene->counted[i].patch] += seen_px;
		all_px += seen_px;
	}
	scene->filled = all_px / scene->visibility.view.picture_px;
}

bool scene_take_visibility(struct scene *scene, bool moved)
{
	if (!scene->counting && !is_due(scene, moved))
		return false;
	if (draw(scene, moved) && visibility_end(&scene->visibility) == 0)
		scene_count_visibility(scene);
	return true;
}

void scene_count_visibility(struct scene *scene)
{
	count_all(scene);
	for (int round = 0; round < PROBE_MOVES; round++) {
		for (uint32_t i = 0; i < scene->counted_count; i++)
			move_probe(scene, i);
		count_all(scene);
	}
	for (uint32_t i = 0; i < scene->counted_count; i++)
		conclude(scene, &scene->counted[i]);
	sum_patches(scene);
	scene->visibility_us = clock_now_us();
	scene->visibility_cut = scene->counting_cut;
	memcpy(scene->visibility_section, scene->visibility.view.cut,
	       sizeof(scene->visibility_section));
	memcpy(scene->visibility_eye_m, scene->visibility.view.eye_m,
	       sizeof(scene->visibility_eye_m));
	memcpy(scene->visibility_forward, scene->visibility.view.forward,
	       sizeof(scene->visibility_forward));
}
