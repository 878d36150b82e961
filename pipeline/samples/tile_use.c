/* Looks at spots of the surface from eyes before it, and finds which level of which face would
 * colour each. Weights are those of a face's level, not of a single tile: so many views tell more
 * about a face than about a tile, and visitors do not stand where the views are. */
#include "pipeline/samples/tile_use.h"

#include <errno.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "format/cube.h"
#include "geometry/vec.h"
#include "pipeline/samples/sampler.h"
#include "render/plan/plan_quality.h"

enum {
	SPOTS = 2048,
	VIEWS = 256,
};

/* Pixels for each of the finest level, at the middle of face and picture: a panel of 1080 rows and
 * a field of view of 45 degrees have that many where faces have 2016. */
static const float focal = 1.3f;
/* Texels wanted per pixel, as in scene_plan.c. */
static const float texels = 1.2f;
/* What is looked at is within 32 degrees from the middle. */
static const float view_cosine = 0.85f;
/* Visits begin at the start view, turn around the model and come nearer. So views are denser in the
 * directions near to the start, lie up to 20 degrees higher and lower than it, and are as often in
 * each of three octaves of its distance. */
static const float rise_range = 0.7f, lowest = -0.3f, highest = 1.2f, octaves = 3;
/* So much of the mean is added to each weight: views not foreseen happen too. */
static const float unforeseen = 0.3f;

/* A place on the surface; each stands for the same area. */
struct spot {
	float at_m[3], normal[3];
};

struct use {
	const struct sample_grid *grid;
	const struct tile_use_patch *patches;
	uint32_t patch_count;
	float start_eye_m[3], start_target_m[3];
	float focal_px;
	float low_m[3], high_m[3], size_m; /* of the surface; its longest side */
	struct spot *spots;                /* owned */
	uint32_t spot_count;
	uint32_t point_count;
	float (*points_m)[3]; /* owned; sampling points */
	bool *exists;         /* owned; of each face, whether it has tiles */
	uint8_t *sight;       /* owned; of spot and point: 0 unknown, 1 hidden, 2 seen */
	double *pixels;       /* owned; of each level of each face */
	uint64_t *windows;    /* owned; likewise: of its tiles */
};

/* ---- the surface */

static void corner_m(const struct patch_bvh *bvh, uint32_t triangle, uint32_t corner, float out[3])
{
	float steps[3];

	patch_bvh_corner(bvh, bvh->indices[3 * triangle + corner], steps);
	for (int i = 0; i < 3; i++)
		out[i] = (float)(bvh->lattice.origin_m[i] +
				 bvh->lattice.step_m * ((double)bvh->base[i] + (double)steps[i]));
}

/* Sets middle and unit normal of a triangle; returns its area. */
static float look_at_triangle(struct spot *out, const struct patch_bvh *bvh, uint32_t triangle)
{
	float corners[3][3], ab[3], ac[3];

	for (uint32_t c = 0; c < 3; c++)
		corner_m(bvh, triangle, c, corners[c]);
	vec_sub(ab, corners[1], corners[0]);
	vec_sub(ac, corners[2], corners[0]);
	vec_cross(out->normal, ab, ac);
	for (int i = 0; i < 3; i++)
		out->at_m[i] = (corners[0][i] + corners[1][i] + corners[2][i]) / 3;
	return vec_normalise(out->normal) / 2;
}

static uint32_t triangles_of(const struct patch_bvh *bvh)
{
	return bvh->node_count > 0 ? bvh->nodes[0].count : 0;
}

static double measure(struct use *use)
{
	double area = 0;
	struct spot spot;

	for (int i = 0; i < 3; i++) {
		use->low_m[i] = INFINITY;
		use->high_m[i] = -INFINITY;
	}
	for (uint32_t p = 0; p < use->patch_count; p++)
		for (uint32_t t = 0; t < triangles_of(&use->patches[p].bvh); t++) {
			area += (double)look_at_triangle(&spot, &use->patches[p].bvh, t);
			for (int i = 0; i < 3; i++) {
				use->low_m[i] = fminf(use->low_m[i], spot.at_m[i]);
				use->high_m[i] = fmaxf(use->high_m[i], spot.at_m[i]);
			}
		}
	for (int i = 0; i < 3; i++)
		use->size_m = fmaxf(use->size_m, use->high_m[i] - use->low_m[i]);
	return area;
}

static void place_spots(struct use *use, double area)
{
	double passed = 0;
	struct spot spot;

	for (uint32_t p = 0; p < use->patch_count; p++)
		for (uint32_t t = 0; t < triangles_of(&use->patches[p].bvh); t++) {
			passed += (double)look_at_triangle(&spot, &use->patches[p].bvh, t);
			while (use->spot_count < SPOTS &&
			       (use->spot_count + 0.5) * area / SPOTS < passed)
				use->spots[use->spot_count++] = spot;
		}
}

static bool is_blocked(const struct use *use, const float from_m[3], const float at_m[3])
{
	float to[3], most_m;

	vec_sub(to, at_m, from_m);
	/* Not the surface itself: docs/lumigraph.md. */
	most_m = vec_normalise(to) * 0.985f - 0.002f * use->size_m;
	for (uint32_t p = 0; p < use->patch_count && most_m > 0; p++) {
		const struct tile_use_patch *patch = &use->patches[p];

		if (ray_meets_sphere(from_m, to, most_m, patch->centre_m, patch->radius_m) &&
		    patch_bvh_blocks(&patch->bvh, from_m, to, most_m))
			return true;
	}
	return false;
}

/* ---- eyes */

/* Returns the n-th of numbers that fill 0..1 evenly, together with those of the other axes: four
 * powers of the root of x^5 = x + 1 (Roberts 2018, "The unreasonable effectiveness of quasirandom
 * sequences"). */
static float spread(uint32_t n, int axis)
{
	static const double steps[] = { 0.8566748838545029, 0.733891856627126, 0.6287067210378087,
					0.5385972572236101 };

	return (float)fmod((n + 0.5) * steps[axis], 1);
}

/* Finds a spot that faces an eye in that direction, from a random one on. */
static const struct spot *facing_spot(const struct use *use, float from, const float way[3])
{
	const uint32_t first = (uint32_t)(from * (float)use->spot_count);

	for (uint32_t i = 0; i < use->spot_count; i++) {
		const struct spot *spot = &use->spots[(first + i) % use->spot_count];

		if (vec_dot(spot->normal, way) > 0.3f)
			return spot;
	}
	return NULL;
}

/* From afar it looks at what the start view looks at, and the nearer it is the more at the spot.
 * Returns false if it does not see the spot that it is near to. */
static bool place_eye(const struct use *use, uint32_t n, float eye_m[3], float forward[3])
{
	float start[3], target_m[3], way[3], distance_m, turn, rise, share;
	const struct spot *spot;

	vec_sub(start, use->start_eye_m, use->start_target_m);
	distance_m = vec_most(vec_length(start), 1e-3f * use->size_m);
	turn = 2 * spread(n, 0) - 1;
	turn = atan2f(start[1], start[0]) + (float)M_PI * fabsf(turn) * turn;
	rise = asinf(vec_most(-1, vec_least(start[2] / distance_m, 1))) +
	       (spread(n, 1) - 0.5f) * rise_range;
	rise = fminf(fmaxf(rise, lowest), highest);
	share = exp2f(-octaves * spread(n, 2));
	way[0] = cosf(turn) * cosf(rise);
	way[1] = sinf(turn) * cosf(rise);
	way[2] = sinf(rise);
	spot = facing_spot(use, spread(n, 3), way);
	if (!spot)
		return false;
	for (int i = 0; i < 3; i++)
		target_m[i] = share * use->start_target_m[i] + (1 - share) * spot->at_m[i];
	vec_add_scaled(eye_m, target_m, share * distance_m, way);
	eye_m[2] = fmaxf(eye_m[2], use->low_m[2] + 0.02f * use->size_m);
	vec_sub(forward, target_m, eye_m);
	vec_normalise(forward);
	/* From farther away it sees something, if not the spot. */
	return share > 0.5f || !is_blocked(use, eye_m, spot->at_m);
}

/* ---- which face colours a spot */

static bool sees(struct use *use, uint32_t spot, uint32_t point)
{
	uint8_t *known = &use->sight[(size_t)spot * use->point_count + point];

	if (*known == 0)
		*known = is_blocked(use, use->points_m[point], use->spots[spot].at_m) ? 1 : 2;
	return *known == 2;
}

struct ranked {
	uint32_t point;
	float quality;
};

static uint32_t rank(struct ranked ranked[PLAN_POINTS_BEST], const struct use *use,
		     const struct plan_eye *eye, const struct spot *spot)
{
	const float half_px = plan_level_half_px(use->grid->level_count - 1);
	const float error_m = vec_distance(eye->eye_m, spot->at_m) / use->focal_px; /* a pixel */
	uint32_t count = 0;

	for (uint32_t p = 0; p < use->point_count; p++) {
		const float quality = plan_quality(eye, spot->at_m, spot->normal, use->points_m[p],
						   half_px, error_m);
		uint32_t at = count;

		if (quality <= 0 ||
		    (count == PLAN_POINTS_BEST && ranked[count - 1].quality >= quality))
			continue;
		if (count < PLAN_POINTS_BEST)
			count++;
		else
			at--;
		for (; at > 0 && ranked[at - 1].quality < quality; at--)
			ranked[at] = ranked[at - 1];
		ranked[at] = (struct ranked){ p, quality };
	}
	return count;
}

/* The kiosk fetches one layer of images, the best of each place. It blends others if it has them;
 * they do not count here. */
static void colour_spot(struct use *use, const struct plan_eye *eye, uint32_t n, double pixels)
{
	const struct spot *spot = &use->spots[n];
	struct ranked ranked[PLAN_POINTS_BEST];
	const uint32_t count = rank(ranked, use, eye, spot);

	for (uint32_t i = 0; i < count; i++) {
		const uint32_t point = ranked[i].point;
		float to[3], u, v, needed;
		uint32_t face;

		vec_sub(to, spot->at_m, use->points_m[point]);
		face = point * CUBE_FACES + (uint32_t)cube_project(to, &u, &v);
		if (!use->exists[face] || !sees(use, n, point))
			continue;
		needed = plan_needed_half_px(eye, spot->at_m, spot->normal, use->points_m[point]);
		use->pixels[face * use->grid->level_count +
			    plan_level(texels * needed, use->grid->level_count)] += pixels;
		return;
	}
}

/* Each view counts as much as another, whatever the model fills of it. */
static void take_view(struct use *use, const float eye_m[3], const float forward[3])
{
	struct plan_eye eye = { .focal_px = use->focal_px, .texels = texels };
	float pixels[SPOTS];
	double sum = 0;

	memcpy(eye.eye_m, eye_m, sizeof(eye.eye_m));
	for (uint32_t n = 0; n < use->spot_count; n++) {
		const struct spot *spot = &use->spots[n];
		float to[3], distance, cosine;

		vec_sub(to, spot->at_m, eye_m);
		distance = fmaxf(vec_normalise(to), 1e-3f * use->size_m);
		cosine = -vec_dot(to, spot->normal);
		pixels[n] = 0;
		if (cosine > 0 && vec_dot(to, forward) > view_cosine &&
		    !is_blocked(use, eye_m, spot->at_m))
			pixels[n] = cosine / (distance * distance);
		sum += (double)pixels[n];
	}
	for (uint32_t n = 0; n < use->spot_count; n++)
		if (pixels[n] > 0)
			colour_spot(use, &eye, n, (double)pixels[n] / sum);
}

/* ---- the whole */

static void find_points(struct use *use)
{
	for (uint32_t n = 0; n < use->point_count; n++) {
		uint32_t point[3];

		sample_grid_point(use->grid, n, point);
		sampler_point(use->points_m[n], use->grid, point);
	}
}

static uint32_t face_of(const struct use *use, const struct sample_face *face)
{
	return sample_grid_number(use->grid, face->point) * CUBE_FACES + (uint32_t)face->face;
}

/* Finds which faces exist and the windows of their levels. Returns the number of tiles. */
static int count_windows(struct use *use, struct samples_store *store, uint32_t *tiles)
{
	struct sample_face face;
	int rc;

	samples_store_rewind(store);
	*tiles = 0;
	while ((rc = samples_store_next(store, &face)) == 1) {
		const uint32_t number = face_of(use, &face);

		use->exists[number] = true;
		*tiles += face.tile_count;
		for (uint32_t i = 0; i < face.tile_count; i++)
			use->windows[number * use->grid->level_count +
				     face_tile_level(face.tiles[i])] += face.windows[i];
	}
	samples_store_rewind(store);
	return rc;
}

static int weigh(const struct use *use, struct samples_store *store, float *out)
{
	const uint32_t count = use->point_count * CUBE_FACES * use->grid->level_count;
	double pixels = 0, windows = 0;
	struct sample_face face;
	uint32_t tile = 0;
	int rc;

	for (uint32_t i = 0; i < count; i++) {
		pixels += use->pixels[i];
		windows += (double)use->windows[i];
	}
	while ((rc = samples_store_next(store, &face)) == 1)
		for (uint32_t i = 0; i < face.tile_count; i++) {
			const uint32_t of = face_of(use, &face) * use->grid->level_count +
					    face_tile_level(face.tiles[i]);
			double weight = 1;

			if (pixels > 0)
				weight = use->pixels[of] / fmax((double)use->windows[of], 1) *
						 windows / pixels +
					 (double)unforeseen;
			out[tile++] = (float)weight;
		}
	samples_store_rewind(store);
	return rc;
}

static int allocate(struct use *use)
{
	const size_t faces = (size_t)use->point_count * CUBE_FACES,
		     levels = faces * use->grid->level_count;

	use->spots = malloc(SPOTS * sizeof(*use->spots));
	use->points_m = malloc(use->point_count * sizeof(*use->points_m));
	use->exists = calloc(faces, sizeof(*use->exists));
	use->sight = calloc(SPOTS, use->point_count);
	use->pixels = calloc(levels, sizeof(*use->pixels));
	use->windows = calloc(levels, sizeof(*use->windows));
	return use->spots && use->points_m && use->exists && use->sight && use->pixels &&
			       use->windows
		       ? 0
		       : -ENOMEM;
}

static void look_around(struct use *use)
{
	float eye_m[3], forward[3];

	use->focal_px = focal * plan_level_half_px(use->grid->level_count - 1);
	place_spots(use, measure(use));
	find_points(use);
	if (use->spot_count == 0)
		return;
	for (uint32_t n = 0; n < VIEWS; n++)
		if (place_eye(use, n, eye_m, forward))
			take_view(use, eye_m, forward);
}

int tile_use_make(float **out, struct samples_store *store, const struct tile_use_patch *patches,
		  uint32_t patch_count, const float start_eye_m[3], const float start_target_m[3])
{
	struct use use = { .grid = samples_store_grid(store),
			   .patches = patches,
			   .patch_count = patch_count };
	uint32_t tiles;
	int rc;

	memcpy(use.start_eye_m, start_eye_m, sizeof(use.start_eye_m));
	memcpy(use.start_target_m, start_target_m, sizeof(use.start_target_m));
	use.point_count = sample_grid_points(use.grid);
	*out = NULL;
	rc = allocate(&use);
	if (rc == 0)
		rc = count_windows(&use, store, &tiles);
	if (rc == 0) {
		*out = malloc(((size_t)tiles + 1) * sizeof(**out));
		rc = *out ? 0 : -ENOMEM;
	}
	if (rc == 0) {
		look_around(&use);
		rc = weigh(&use, store, *out);
	}
	if (rc < 0) {
		free(*out);
		*out = NULL;
	}
	free(use.spots);
	free(use.points_m);
	free(use.exists);
	free(use.sight);
	free(use.pixels);
	free(use.windows);
	return rc;
}
