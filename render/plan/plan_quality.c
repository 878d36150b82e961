/* The quality formula of plan.h and what follows from it: worth, levels and priorities. */
#include "render/plan/plan_quality.h"

#include <math.h>

#include "geometry/vec.h"
#include "render/plan/plan.h"

const struct plan_tuning plan_tuning = {
	.blur = 0.5f,
	.parallax = 0.25f,
	.angle = 0.6f,
	.own = 0.5f,
	.facing_low = 0.06f,
	.facing_high = 0.25f,
};

struct geometry {
	float eye_distance, sample_distance, depth; /* depth: distance along the face's axis */
	float eye_cosine, sample_cosine;            /* cosines at the surface */
	float angle_cosine;                         /* between the two lines of sight */
};

static struct geometry look(const struct plan_eye *eye, const float point[3], const float normal[3],
			    const float sample[3])
{
	struct geometry g;
	float to_eye[3], to_sample[3];
	vec_sub(to_eye, eye->eye_m, point);
	vec_sub(to_sample, sample, point);
	g.depth = vec_most(fabsf(to_sample[0]), vec_most(fabsf(to_sample[1]), fabsf(to_sample[2])));
	g.eye_distance = vec_most(vec_normalise(to_eye), 1e-3f);
	g.sample_distance = vec_most(vec_normalise(to_sample), 1e-3f);
	g.depth = vec_most(g.depth, 1e-3f);
	/* Scans have open borders: the visible side is the one that faces the eye. */
	float side = vec_dot(to_eye, normal) < 0 ? -1 : 1;
	g.eye_cosine = side * vec_dot(to_eye, normal);
	g.sample_cosine = side * vec_dot(to_sample, normal);
	g.angle_cosine = vec_dot(to_eye, to_sample);
	return g;
}

/* Foreshortening acts on one of two directions, so its square root is the mean. */
static float needed(const struct plan_eye *eye, const struct geometry *g)
{
	return eye->focal_px * g->depth / g->eye_distance *
	       sqrtf(vec_most(g->eye_cosine, 0.05f) / vec_most(g->sample_cosine, 0.05f));
}

float plan_needed_half_px(const struct plan_eye *eye, const float point_m[3], const float normal[3],
			  const float sample_m[3])
{
	struct geometry g = look(eye, point_m, normal, sample_m);
	return needed(eye, &g);
}

float plan_quality(const struct plan_eye *eye, const float point_m[3], const float normal[3],
		   const float sample_m[3], float half_px, float error_m)
{
	struct geometry g = look(eye, point_m, normal, sample_m);
	float facing = (g.sample_cosine - plan_tuning.facing_low) /
		       (plan_tuning.facing_high - plan_tuning.facing_low);
	if (facing <= 0)
		return 0;
	float blur = vec_most(needed(eye, &g) / half_px - 1, 0);
	float sine = sqrtf(vec_most(1 - g.angle_cosine * g.angle_cosine, 0));
	if (g.angle_cosine < 0)
		sine = 2 - sine;
	float shift = error_m * eye->focal_px / g.eye_distance * sine;
	float penalty = plan_tuning.blur * blur + plan_tuning.parallax * shift +
			plan_tuning.angle * (1 - g.angle_cosine);
	return vec_least(facing, 1) / ((1 + penalty) * (1 + penalty));
}

float plan_own_quality(const struct plan_eye *eye, const float point_m[3], float spacing_m)
{
	float distance = vec_most(vec_distance(eye->eye_m, point_m), 1e-3f);
	float penalty = 1 + plan_tuning.own * spacing_m * eye->focal_px / distance;
	return 1 / (penalty * penalty);
}

float plan_worth(float quality, float instead)
{
	if (quality <= instead)
		return 0;
	/* Quality is one over a squared penalty, so two octaves of it are one octave of detail. */
	return vec_least(log2f(quality / instead) / 16, 1);
}

float plan_level_half_px(uint32_t level)
{
	return (float)(SAMPLE_TILE_PX << level) / 2;
}

uint32_t plan_level(float needed_half_px, uint32_t level_count)
{
	uint32_t level = 0;
	while (level + 1 < level_count && plan_level_half_px(level) < needed_half_px)
		level++;
	return level;
}

uint32_t plan_priority(float gain, uint32_t bytes)
{
	/* The scale has 64 octaves of pixels per byte, from 2^-30. It includes everything from a
	 * hundredth of a pixel per megabyte to the whole picture per byte. */
	float per_byte = gain / (float)(bytes > 0 ? bytes : 1);
	float octaves = log2f(vec_most(per_byte, 1e-9f)) + 30;
	float scaled = vec_least(vec_most(octaves / 64, 0), 1);
	return MESSAGE_PRIORITY_PICTURE +
	       (uint32_t)(scaled * (MESSAGE_PRIORITY_INDEX - MESSAGE_PRIORITY_PICTURE - 2));
}
