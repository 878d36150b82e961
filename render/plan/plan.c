/* Ranks the sampling points of a piece, tests which of them see it, and chooses entries and wants
 * greedily by gain. */
#include "render/plan/plan.h"

#include <math.h>
#include <string.h>

#include "geometry/vec.h"
#include "render/plan/plan_quality.h"

enum {
	POINTS_RESIDENT = 6, /* further ones, among points with tiles on the GPU */
	POINTS_ENOUGH = 3,   /* points that see all of the piece, after which ray tests stop */
	CANDIDATES_MAX = 2 * (PLAN_POINTS_BEST + POINTS_RESIDENT),
};

/* Below these gains a further face or fetch is not worth its cost. */
static const float entry_gain_least = 0.05f, want_gain_least = 0.02f;
/* A shown face stays unless another is better by this factor. */
static const float loyalty = 1.1f;

bool plan_footprint(struct plan_area *out, face_key face, const float sample_m[3],
		    const struct piece *piece)
{
	const struct cube_axes *axes = &cube_axes[face % CUBE_FACES];
	bool any = false;
	*out = (struct plan_area){ 1, 1, -1, -1 };
	for (int k = 0; k < 6; k++) {
		float to[3];
		vec_sub(to, piece->extent_m[k], sample_m);
		float x = vec_dot(to, axes->right), y = vec_dot(to, axes->up);
		float z = vec_dot(to, axes->forward);
		any |= z > 0;
		/* Points beside or behind the face are clamped to its border. */
		z = vec_most(z, 1e-3f * (fabsf(x) + fabsf(y)) + 1e-6f);
		float u = vec_least(vec_most(x / z, -1), 1), v = vec_least(vec_most(y / z, -1), 1);
		out->u0 = vec_least(out->u0, u);
		out->u1 = vec_most(out->u1, u);
		out->v0 = vec_least(out->v0, v);
		out->v1 = vec_most(out->v1, v);
	}
	return any;
}

/* ---- candidates */

struct candidate {
	face_key face;
	float sample_m[3];
	uint8_t level;
	bool resident;
	float ideal[PIECE_PROBES], now[PIECE_PROBES]; /* worth; 0 where it does not see the probe */
	float resident_half_px;
};

struct ranked {
	uint32_t point[PLAN_POINTS_BEST + POINTS_RESIDENT];
	float quality[PLAN_POINTS_BEST + POINTS_RESIDENT];
	uint32_t count;
};

static void rank(struct ranked *ranked, uint32_t from, uint32_t most, uint32_t point, float quality)
{
	uint32_t at = ranked->count;
	if (quality <= 0)
		return;
	if (at == from + most) {
		if (ranked->quality[at - 1] >= quality)
			return;
		at--;
	} else {
		ranked->count++;
	}
	while (at > from && ranked->quality[at - 1] < quality) {
		ranked->point[at] = ranked->point[at - 1];
		ranked->quality[at] = ranked->quality[at - 1];
		at--;
	}
	ranked->point[at] = point;
	ranked->quality[at] = quality;
}

static bool is_ranked(const struct ranked *ranked, uint32_t point)
{
	for (uint32_t i = 0; i < ranked->count; i++)
		if (ranked->point[i] == point)
			return true;
	return false;
}

static float point_quality(const struct plan_world *world, const struct plan_eye *eye,
			   const struct plan_surface *surface, uint32_t point)
{
	float sample[3], to[3], u, v;
	repository_point_m(world->repository, point, sample);
	vec_sub(to, surface->piece->centre_m, sample);
	if (vec_dot(to, to) < 1e-6f)
		return 0;
	float half_px = plan_level_half_px(repository_levels(world->repository) - 1);
	float quality = 0;
	if (surface->piece->flatness > 0.8f)
		quality = plan_quality(eye, surface->piece->centre_m, surface->piece->normal,
				       sample, half_px, surface->error_m);
	for (int k = 0; k < PIECE_PROBES && surface->piece->flatness <= 0.8f; k += 2)
		if (surface->weight[k] > 0)
			quality = vec_most(quality, plan_quality(eye, surface->probe[k].at_m,
								 surface->probe[k].normal, sample,
								 half_px, surface->error_m));
	if (quality <= 0)
		return 0;
	face_key face = point * CUBE_FACES + (uint32_t)cube_project(to, &u, &v);
	if (repository_face(world->repository, face, NULL, NULL) == REPOSITORY_EMPTY)
		return 0;
	return quality;
}

static void rank_points(struct ranked *ranked, const struct plan_world *world,
			const struct plan_eye *eye, const struct plan_surface *surface)
{
	ranked->count = 0;
	for (uint32_t point = 0; point < world->repository->point_count; point++)
		rank(ranked, 0, PLAN_POINTS_BEST, point, point_quality(world, eye, surface, point));
	uint32_t from = ranked->count;
	for (uint32_t i = 0; i < world->resident_count; i++) {
		uint32_t point = world->resident[i] / CUBE_FACES;
		if (!is_ranked(ranked, point))
			rank(ranked, from, POINTS_RESIDENT, point,
			     point_quality(world, eye, surface, point));
	}
}

/* Returns a bit mask of the probes that the point sees without an obstacle. The rays are remembered
 * with the piece, since neither end moves. */
static uint8_t sight_of(struct plan_choice *choice, const struct plan_world *world,
			const struct plan_surface *surface, uint32_t point, const float sample[3])
{
	/* The slot is given by the lowest bits of the point's number, rotated by the higher bits:
	 * rows of the grid, whose lengths are often powers of two, then spread over the slots. */
	uint32_t high = point / PLAN_SIGHTS;
	struct plan_sight *sight = &choice->sight[(point + high * 37) % PLAN_SIGHTS];
	if (sight->point != high + 1)
		*sight = (struct plan_sight){ .point = (uint16_t)(high + 1) };
	for (int k = 0; k < PIECE_PROBES; k++) {
		uint8_t bit = (uint8_t)(1 << k);
		if (sight->known & bit || surface->weight[k] <= 0)
			continue;
		sight->known |= bit;
		if (world->sees(world->data, sample, surface->probe[k].at_m))
			sight->seen |= bit;
	}
	return sight->seen;
}

void plan_forget_probe(struct plan_choice *choice, int probe)
{
	for (int i = 0; i < PLAN_SIGHTS; i++) {
		choice->sight[i].known &= (uint8_t) ~(1 << probe);
		choice->sight[i].seen &= (uint8_t) ~(1 << probe);
	}
}

/* Returns the probe near most of the visible area. */
static const struct piece_probe *main_probe(const struct plan_surface *surface)
{
	int main = 0;
	for (int k = 1; k < PIECE_PROBES; k++)
		if (surface->weight[k] > surface->weight[main])
			main = k;
	return &surface->probe[main];
}

static bool is_resident(const struct plan_world *world, face_key face)
{
	for (uint32_t i = 0; i < world->resident_count; i++)
		if (world->resident[i] == face)
			return true;
	return false;
}

static bool has_resident(const struct plan_world *world, uint32_t point)
{
	for (uint32_t i = 0; i < world->resident_count; i++)
		if (world->resident[i] / CUBE_FACES == point)
			return true;
	return false;
}

static struct candidate *candidate_of(struct candidate *list, uint32_t *count, face_key face)
{
	for (uint32_t i = *count; i > 0 && list[i - 1].face / CUBE_FACES == face / CUBE_FACES; i--)
		if (list[i - 1].face == face)
			return &list[i - 1];
	if (*count == CANDIDATES_MAX)
		return NULL;
	struct candidate *candidate = &list[(*count)++];
	memset(candidate, 0, sizeof(*candidate));
	candidate->face = face;
	return candidate;
}

static uint16_t sixteenth_of(float u, float v)
{
	int column = (int)((u + 1) * 2), row = (int)((1 - v) * 2);
	column = column < 0 ? 0 : column > 3 ? 3 : column;
	row = row < 0 ? 0 : row > 3 ? 3 : row;
	return (uint16_t)(1u << (row * 4 + column));
}

static void judge_probe(struct candidate *candidate, const struct plan_world *world,
			const struct plan_eye *eye, const struct plan_surface *surface, int probe,
			const float uv[2])
{
	const float *at = surface->probe[probe].at_m, *normal = surface->probe[probe].normal;
	float own = plan_own_quality(eye, at, surface->piece->spacing_m);
	candidate->ideal[probe] =
		plan_worth(plan_quality(eye, at, normal, candidate->sample_m,
					plan_level_half_px(candidate->level), surface->error_m),
			   own);
	if (!candidate->resident)
		return;
	int level = world->level_at(world->data, candidate->face, uv[0], uv[1]);
	if (level < 0)
		return;
	float half_px = plan_level_half_px((uint32_t)level);
	candidate->resident_half_px = vec_most(candidate->resident_half_px, half_px);
	candidate->now[probe] = plan_worth(
		plan_quality(eye, at, normal, candidate->sample_m, half_px, surface->error_m), own);
	candidate->ideal[probe] = vec_most(candidate->ideal[probe], candidate->now[probe]);
}

static uint32_t level_for(const struct plan_world *world, const struct plan_eye *eye,
			  const struct piece_probe *probe, const float sample_m[3])
{
	float needed = plan_needed_half_px(eye, probe->at_m, probe->normal, sample_m);
	return plan_level(eye->texels * needed, repository_levels(world->repository));
}

/* Adds the faces of a point as candidates. Returns a bit mask of the visible probes that it
 * sees. */
static uint8_t add_point(struct candidate *list, uint32_t *count, struct plan_choice *choice,
			 const struct plan_world *world, const struct plan_eye *eye,
			 const struct plan_surface *surface, uint8_t in_sight, uint32_t point)
{
	float sample[3];
	repository_point_m(world->repository, point, sample);
	const struct piece_probe *main = main_probe(surface);
	uint8_t seen = sight_of(choice, world, surface, point, sample) & in_sight;
	uint32_t level = level_for(world, eye, main, sample);
	for (int k = 0; k < PIECE_PROBES; k++) {
		float to[3], uv[2];
		vec_sub(to, surface->probe[k].at_m, sample);
		if (!(seen & 1 << k) || vec_dot(to, to) < 1e-6f)
			continue;
		face_key face = point * CUBE_FACES + (uint32_t)cube_project(to, &uv[0], &uv[1]);
		if (repository_face(world->repository, face, NULL, NULL) == REPOSITORY_EMPTY ||
		    !repository_covers(world->repository, face, sixteenth_of(uv[0], uv[1])))
			continue;
		struct candidate *candidate = candidate_of(list, count, face);
		if (!candidate)
			return seen;
		memcpy(candidate->sample_m, sample, sizeof(sample));
		candidate->level = (uint8_t)level;
		candidate->resident = is_resident(world, face);
		judge_probe(candidate, world, eye, surface, k, uv);
	}
	return seen;
}

/* ---- choosing */

static bool is_chosen(const struct plan_entry *entries, uint32_t count, face_key face)
{
	for (uint32_t i = 0; i < count; i++)
		if (entries[i].face == face)
			return true;
	return false;
}

/* Chooses greedily. What remains to be improved at a probe is the product of what each chosen face
 * leaves. */
static void choose_entries(struct plan_choice *choice, const struct candidate *list, uint32_t count,
			   const struct plan_surface *surface)
{
	struct plan_entry was[PLAN_ENTRIES];
	uint32_t was_count = choice->entry_count;
	memcpy(was, choice->entry, sizeof(was));
	float undone[PIECE_PROBES];
	for (int k = 0; k < PIECE_PROBES; k++)
		undone[k] = 1;
	choice->entry_count = 0;
	while (choice->entry_count < PLAN_ENTRIES) {
		const struct candidate *best = NULL;
		float best_gain = entry_gain_least;
		for (uint32_t i = 0; i < count; i++) {
			float gain = 0;
			for (int k = 0; k < PIECE_PROBES; k++)
				gain += undone[k] * list[i].now[k] * surface->weight[k];
			if (is_chosen(was, was_count, list[i].face))
				gain *= loyalty;
			if (gain > best_gain &&
			    !is_chosen(choice->entry, choice->entry_count, list[i].face)) {
				best = &list[i];
				best_gain = gain;
			}
		}
		if (!best)
			return;
		for (int k = 0; k < PIECE_PROBES; k++)
			undone[k] *= 1 - best->now[k];
		choice->entry[choice->entry_count++] = (struct plan_entry){
			.face = best->face, .half_px = best->resident_half_px, .share = 1
		};
	}
}

/* One good image colours a piece well. So each probe counts only its best image, and a fetch is
 * worth what it adds to that. */
static void choose_wants(struct plan_choice *choice, const struct candidate *list, uint32_t count,
			 const struct plan_surface *surface)
{
	float best_now[PIECE_PROBES] = { 0 };
	for (uint32_t i = 0; i < count; i++)
		for (int k = 0; k < PIECE_PROBES; k++)
			best_now[k] = vec_most(best_now[k], list[i].now[k]);
	choice->want_count = 0;
	while (choice->want_count < PLAN_WANTS) {
		const struct candidate *best = NULL;
		float best_gain = want_gain_least;
		for (uint32_t i = 0; i < count; i++) {
			float gain = 0;
			for (int k = 0; k < PIECE_PROBES; k++)
				gain += vec_most(list[i].ideal[k] - best_now[k], 0) *
					surface->weight[k];
			if (gain > best_gain) {
				best = &list[i];
				best_gain = gain;
			}
		}
		if (!best)
			return;
		for (int k = 0; k < PIECE_PROBES; k++)
			best_now[k] = vec_most(best_now[k], best->ideal[k]);
		struct plan_want want = { .face = best->face,
					  .level = best->level,
					  .gain = best_gain };
		if (!plan_footprint(&want.area, want.face, best->sample_m, surface->piece))
			return;
		choice->want[choice->want_count++] = want;
	}
}

void plan_piece(struct plan_choice *choice, const struct plan_world *world,
		const struct plan_eye *eye, const struct plan_surface *surface)
{
	struct candidate list[CANDIDATES_MAX];
	struct ranked ranked;
	uint32_t count = 0;
	uint8_t in_sight = 0;
	for (int k = 0; k < PIECE_PROBES; k++)
		if (surface->weight[k] > 0)
			in_sight |= (uint8_t)(1 << k);
	rank_points(&ranked, world, eye, surface);
	/* Rays are expensive: once enough good points see the whole piece, worse ones add
	 * nothing. */
	uint32_t whole = 0;
	for (uint32_t i = 0; i < ranked.count; i++) {
		if (whole >= POINTS_ENOUGH && !has_resident(world, ranked.point[i]))
			continue;
		uint8_t seen = add_point(list, &count, choice, world, eye, surface, in_sight,
					 ranked.point[i]);
		whole += seen == in_sight;
	}
	choose_entries(choice, list, count, surface);
	choose_wants(choice, list, count, surface);
}

/* ---- the eight corners of the paper */

static void add_corner(struct plan_choice *choice, const struct plan_world *world,
		       const struct plan_eye *eye, const struct plan_surface *surface,
		       uint32_t point, float weight)
{
	float sample[3], to[3], uv[2];
	repository_point_m(world->repository, point, sample);
	vec_sub(to, surface->piece->centre_m, sample);
	if (weight <= 0 || vec_dot(to, to) < 1e-6f)
		return;
	face_key face = point * CUBE_FACES + (uint32_t)cube_project(to, &uv[0], &uv[1]);
	if (repository_face(world->repository, face, NULL, NULL) == REPOSITORY_EMPTY)
		return;
	const struct piece_probe *main = main_probe(surface);
	struct candidate one = { .face = face };
	memcpy(one.sample_m, sample, sizeof(sample));
	one.level = (uint8_t)level_for(world, eye, main, sample);
	one.resident = is_resident(world, face);
	for (int k = 0; k < PIECE_PROBES; k++) {
		vec_sub(to, surface->probe[k].at_m, sample);
		if (face % CUBE_FACES == (uint32_t)cube_project(to, &uv[0], &uv[1]))
			judge_probe(&one, world, eye, surface, k, uv);
	}
	if (one.resident_half_px > 0)
		choice->entry[choice->entry_count++] = (struct plan_entry){
			.face = face, .half_px = one.resident_half_px, .share = weight
		};
	struct plan_want want = { .face = face, .level = one.level, .gain = weight };
	if (one.resident_half_px < plan_level_half_px(one.level) &&
	    choice->want_count < PLAN_WANTS &&
	    plan_footprint(&want.area, face, sample, surface->piece))
		choice->want[choice->want_count++] = want;
}

void plan_piece_corners(struct plan_choice *choice, const struct plan_world *world,
			const struct plan_eye *eye, const struct plan_surface *surface)
{
	const struct samples_page *grid = &world->repository->grid;
	uint32_t low[3], order[8];
	float share[3], weight[8];
	choice->entry_count = choice->want_count = 0;
	for (int i = 0; i < 3; i++) {
		float at = (eye->eye_m[i] - grid->origin_m[i]) / grid->spacing_m[i];
		float most = (float)grid->count[i] - 1;
		at = vec_least(vec_most(at, 0), most);
		low[i] = (uint32_t)vec_least(floorf(at), vec_most(most - 1, 0));
		share[i] = at - (float)low[i];
	}
	for (uint32_t c = 0; c < 8; c++) {
		weight[c] = 1;
		for (int i = 0; i < 3; i++)
			weight[c] *= c >> i & 1 ? share[i] : 1 - share[i];
		uint32_t at = c;
		for (; at > 0 && weight[order[at - 1]] < weight[c]; at--)
			order[at] = order[at - 1];
		order[at] = c;
	}
	for (uint32_t i = 0; i < 8 && choice->entry_count < PLAN_ENTRIES; i++) {
		uint32_t c = order[i], x = low[0] + (c & 1), y = low[1] + (c >> 1 & 1);
		uint32_t z = low[2] + (c >> 2 & 1);
		if (x < grid->count[0] && y < grid->count[1] && z < grid->count[2])
			add_corner(choice, world, eye, surface,
				   (z * grid->count[1] + y) * grid->count[0] + x, weight[c]);
	}
}
