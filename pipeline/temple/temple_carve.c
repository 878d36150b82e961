/* Height profiles that the carvings are put together from, and a hash for variety. */
#include "pipeline/temple/temple_carve.h"

#include <math.h>

float carve_step(float from, float to, float x)
{
	float t = fminf(1.0f, fmaxf(0.0f, (x - from) / (to - from)));

	return t * t * (3 - 2 * t);
}

float carve_ridge(float distance, float width)
{
	float t = distance / width;

	return t > -1 && t < 1 ? sqrtf(1 - t * t) : 0;
}

float carve_limb(float x, float y, const float limb[6])
{
	float dx = limb[2] - limb[0], dy = limb[3] - limb[1];
	float px = x - limb[0], py = y - limb[1];
	float t = (px * dx + py * dy) / fmaxf(dx * dx + dy * dy, 1e-6f);

	t = fminf(1.0f, fmaxf(0.0f, t));
	float r = limb[4] + (limb[5] - limb[4]) * t;
	float d2 = (px - dx * t) * (px - dx * t) + (py - dy * t) * (py - dy * t);
	return d2 < r * r ? sqrtf(r * r - d2) : 0;
}

float temple_chance(uint32_t seed, uint32_t a, uint32_t b)
{
	uint32_t h = seed * 0x9e3779b1u ^ a * 0x85ebca6bu ^ b * 0xc2b2ae35u;

	h = (h ^ h >> 15) * 0x2c1b3c6du;
	h = (h ^ h >> 12) * 0x297a2d39u;
	h ^= h >> 15;
	return (float)(h >> 8) / 16777216.0f;
}
