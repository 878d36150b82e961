/* Adds up pixels at the probes of all pieces in the picture. */
#include "tests/bench/shown.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/array.h"
#include "base/map.h"
#include "geometry/vec.h"
#include "render/scene/scene_parts.h"
#include "render/scene/scene_plan.h"

/* A tile and its pixels. */
struct image {
	uint64_t name;
	double pixels;
};

struct shown {
	const struct scene *scene;
	struct plan_eye eye;
	struct map at;        /* name -> index of images */
	struct image *images; /* owned */
	uint32_t count, room;
};

static int add(struct shown *shown, uint64_t name, double pixels)
{
	uint64_t at = map_get(&shown->at, name);
	int rc = 0;

	if (at == MAP_NONE) {
		at = shown->count;
		rc = ARRAY_RESERVE(shown->images, shown->room, at + 1, UINT32_MAX);
		if (rc == 0)
			rc = map_set(&shown->at, name, at);
		if (rc == 0)
			shown->images[shown->count++] = (struct image){ .name = name };
	}
	if (rc == 0)
		shown->images[at].pixels += pixels;
	return rc;
}

static int place_of(float share, int side)
{
	const int place = (int)(share * (float)side);

	return place < 0 ? 0 : place >= side ? side - 1 : place;
}

/* Finds the tile of a blended face that is seen at a probe. Returns its weight there, as the shader
 * has it (surface.c); 0: nothing of the face is seen. */
static double weigh(uint64_t *name, const struct shown *shown, const struct blend *blend,
		    const struct piece_probe *probe, float error_m)
{
	const struct scene *scene = shown->scene;
	float sample_m[3], to[3], u, v;
	int level, side;

	if (!blend->held || blend->weight <= 0)
		return 0;
	repository_point_m(&scene->repository, blend->face / CUBE_FACES, sample_m);
	vec_sub(to, probe->at_m, sample_m);
	if (cube_project(to, &u, &v) != (int)(blend->face % CUBE_FACES))
		return 0;
	level = tiles_level_at(&scene->tiles, blend->face, u, v);
	if (level < 0 || !scene_sees(scene, sample_m, probe->at_m))
		return 0;
	side = 1 << level;
	*name = tile_name_pack(
		(struct tile_name){ .face = blend->face,
				    .level = (uint8_t)level,
				    .row = (uint8_t)place_of((1 - v) / 2, side),
				    .column = (uint8_t)place_of((1 + u) / 2, side) });
	return pow((double)(blend->weight * plan_quality(&shown->eye, probe->at_m, probe->normal,
							 sample_m, blend->half_px, error_m)),
		   4);
}

static int add_piece(struct shown *shown, const struct piece_state *state, float error_m)
{
	int rc = 0;

	for (int k = 0; rc == 0 && k < PIECE_PROBES; k++) {
		double weights[PLAN_ENTRIES], sum = 0;
		uint64_t names[PLAN_ENTRIES];

		for (int i = 0; i < PLAN_ENTRIES; i++)
			sum += weights[i] = weigh(&names[i], shown, &state->blend[i],
						  &state->probe[k], error_m);
		for (int i = 0; rc == 0 && i < PLAN_ENTRIES; i++)
			if (weights[i] > 0)
				rc = add(shown, names[i],
					 (double)(state->seen_px * state->weight[k]) * weights[i] /
						 sum);
	}
	return rc;
}

int shown_write(const struct scene *scene, FILE *file)
{
	struct shown shown = { .scene = scene, .eye = { .focal_px = scene->view.focal_px } };
	int rc = 0;

	memcpy(shown.eye.eye_m, scene->view.eye_m, sizeof(shown.eye.eye_m));
	for (uint32_t i = 0; rc == 0 && i < scene->visible_count; i++) {
		const struct visible_piece *piece = &scene->visible[i];
		const struct piece_state *state =
			&scene->geometry.patches[piece->patch].pieces[piece->piece];

		if (state->counted && state->seen_px > 0)
			rc = add_piece(&shown, state, scene_patch_error_m(scene, piece->patch));
	}
	for (uint32_t i = 0; rc == 0 && i < shown.count; i++) {
		const struct tile_name name = tile_name_unpack(shown.images[i].name);

		fprintf(file, "%u %u %u %u %.1f\n", name.face, name.level, name.row, name.column,
			shown.images[i].pixels);
	}
	map_finish(&shown.at);
	free(shown.images);
	return rc;
}
