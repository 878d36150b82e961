/* Small tools of carving, and the temple's only source of chance. Pure functions. */
#ifndef GOPURA_PIPELINE_TEMPLE_TEMPLE_CARVE_H
#define GOPURA_PIPELINE_TEMPLE_TEMPLE_CARVE_H

#include <stdint.h>

/* 0 up to `from`, 1 beyond `to`, smooth between. */
float carve_step(float from, float to, float x);
/* The height of a rounded limb over the ground. limb: ax ay bx by, radius at a, radius at b, all in
 * one unit, that of the result. */
float carve_limb(float x, float y, const float limb[6]);
/* The profile of a round ridge: 1 on its line, 0 from `width` away from it. */
float carve_ridge(float distance, float width);

/* A number in 0..1 that depends on seed, a and b alone. */
float temple_chance(uint32_t seed, uint32_t a, uint32_t b);

#endif
