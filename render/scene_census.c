#include <string.h>

#include "base/clock.h"
#include "render/scene_parts.h"
#include "render/vec.h"

enum { MOVING_US = 120000 }; /* between two censuses of a moving eye */

/* A view that differs by less than this is counted as the same. */
static const float moved_m = 0.05f, turned = 0.01f;

static bool is_due(const struct scene *scene, bool moved)
{
	if (scene->census_us == 0 || scene->census_cut != scene->cut_signature)
		return true;
	if (moved && clock_now_us() - scene->census_us < MOVING_US)
		return false;
	float limit = moved ? 1 : 0.01f; /* at rest it must be right */
	return vec_distance(scene->census_eye_m, scene->view.eye_m) > limit * moved_m ||
	       vec_distance(scene->census_forward, scene->view.forward) > limit * turned;
}

static void draw_numbers(struct scene *scene)
{
	uint32_t bound = HIERARCHY_NONE;
	census_begin(&scene->census, &scene->view, &scene->root);
	for (uint32_t i = 0; i < scene->visible_count && i < CENSUS_PIECES_MOST; i++) {
		const struct visible_piece *v = &scene->visible[i];
		const struct piece *piece =
			&scene->geometry.patches[v->patch].content.solid.pieces[v->piece];
		if (v->patch != bound)
			geometry_bind(&scene->geometry, v->patch);
		bound = v->patch;
		census_number(&scene->census, i);
		geometry_draw(piece->first_triangle, piece->triangle_count);
	}
}

static void count_point(struct scene *scene, const struct census_point *point)
{
	if (point->piece >= scene->visible_count)
		return;
	const struct visible_piece *v = &scene->visible[point->piece];
	struct geometry_patch *patch = &scene->geometry.patches[v->patch];
	const struct piece *piece = &patch->content.solid.pieces[v->piece];
	struct piece_state *state = &patch->pieces[v->piece];
	int nearest = 0;
	for (int k = 1; k < PIECE_PROBES; k++)
		if (vec_distance(piece->probe_m[k], point->at_m) <
		    vec_distance(piece->probe_m[nearest], point->at_m))
			nearest = k;
	state->weight[nearest] += 1;
	state->seen_px += 1;
}

/* Weights that sum to one; pixels of the screen; a new judgement where what shows has changed. */
static void conclude(struct scene *scene, const struct visible_piece *visible)
{
	struct piece_state *state = &scene->geometry.patches[visible->patch].pieces[visible->piece];
	for (int k = 0; k < PIECE_PROBES && state->seen_px > 0; k++)
		state->weight[k] /= state->seen_px;
	state->seen_px *= scene->view.picture_px / (CENSUS_WIDTH * CENSUS_HEIGHT);
	state->counted = true;
	state->planned = false;
}

void scene_take_census(struct scene *scene, bool moved)
{
	if (!is_due(scene, moved))
		return;
	draw_numbers(scene);
	if (census_end(&scene->census) < 0)
		return;
	for (uint32_t i = 0; i < scene->visible_count; i++) {
		const struct visible_piece *v = &scene->visible[i];
		struct piece_state *state = &scene->geometry.patches[v->patch].pieces[v->piece];
		state->seen_px = 0;
		memset(state->weight, 0, sizeof(state->weight));
	}
	struct census_point point;
	for (int y = 0; y < CENSUS_HEIGHT; y++)
		for (int x = 0; x < CENSUS_WIDTH; x++)
			if (census_at(&scene->census, x, y, &point))
				count_point(scene, &point);
	for (uint32_t i = 0; i < scene->visible_count; i++)
		conclude(scene, &scene->visible[i]);
	scene->census_us = clock_now_us();
	scene->census_cut = scene->cut_signature;
	memcpy(scene->census_eye_m, scene->view.eye_m, sizeof(scene->census_eye_m));
	memcpy(scene->census_forward, scene->view.forward, sizeof(scene->census_forward));
}
