/* From the numbers of sRGB to light and back (IEC 61966-2-1); both are 0 to 1. */
#ifndef GOPURA_GEOMETRY_SRGB_H
#define GOPURA_GEOMETRY_SRGB_H

#include <math.h>

static inline float srgb_to_light(float srgb)
{
	return srgb <= 0.04045f ? srgb / 12.92f : powf((srgb + 0.055f) / 1.055f, 2.4f);
}

static inline float srgb_of_light(float light)
{
	return light <= 0.0031308f ? 12.92f * light : 1.055f * powf(light, 1 / 2.4f) - 0.055f;
}

#endif
