/* The quality of an image at a point of the surface, and what follows from it: worth, levels and
 * priorities. plan.h explains the formula. Pure. */
#ifndef GOPURA_RENDER_PLAN_PLAN_QUALITY_H
#define GOPURA_RENDER_PLAN_PLAN_QUALITY_H

#include <stdint.h>

enum { PLAN_POINTS_BEST = 12 }; /* sampling points that are considered for a piece, the best */

struct plan_eye {
	float eye_m[3];
	float focal_px;
	float texels; /* texels wanted per pixel of the screen: more are sharper and cost more */
};

/* The constants of the quality; the product uses plan_tuning. */
struct plan_tuning {
	float blur, parallax, angle, own;
	/* cosine at the surface: quality 0 below the first, full above the second */
	float facing_low, facing_high;
};
extern const struct plan_tuning plan_tuning;

/* Returns the quality, 0..1, of a sampling point with half_px pixels per unit of tangent, at a
 * point of the surface whose mesh has an error of error_m. */
float plan_quality(const struct plan_eye *eye, const float point_m[3], const float normal[3],
		   const float sample_m[3], float half_px, float error_m);
/* Returns the quality of the patch's own colours on the same scale; its vertices are spacing_m
 * apart. */
float plan_own_quality(const struct plan_eye *eye, const float point_m[3], float spacing_m);
/* Returns what an image of one quality is worth where another would be shown instead, 0..1: the
 * octaves of detail gained, of which a picture has about eight. */
float plan_worth(float quality, float instead);
/* Returns how many pixels per unit of tangent a face needs to be as sharp at the point as the
 * screen. */
float plan_needed_half_px(const struct plan_eye *eye, const float point_m[3], const float normal[3],
			  const float sample_m[3]);
/* Returns the coarsest level that is sharp enough, or the finest one that exists. */
uint32_t plan_level(float needed_half_px, uint32_t level_count);
/* Returns half the side of a face's picture at the level, in pixels. */
float plan_level_half_px(uint32_t level);

/* Converts a gain to a priority: gain is pixels times improvement (0..1) for a fetch of `bytes`.
 * The result is at least MESSAGE_PRIORITY_PICTURE and below MESSAGE_PRIORITY_INDEX, and monotonic
 * in gain per byte. */
uint32_t plan_priority(float gain, uint32_t bytes);

#endif
