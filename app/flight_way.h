/* Where a flight leads: straight, or in a bow over or round what is in the way. A bow is a
 * quadratic Bezier curve. Pure. */
#ifndef GOPURA_APP_FLIGHT_WAY_H
#define GOPURA_APP_FLIGHT_WAY_H

#include <stdbool.h>

struct flight_way {
	float from_m[3], over_m[3], to_m[3]; /* straight: over_m is half way */
};

/* Nothing is between two places, or so near them that it would be cut open. */
typedef bool flight_way_free(void *data, const float from_m[3], const float to_m[3]);

/* The least bow that is free, of some that rise or give way to a side; where none is, straight.
 * size_m: about as high as what may be in the way. */
void flight_way_choose(struct flight_way *way, const float from_m[3], const float to_m[3],
		       float size_m, flight_way_free *is_free, void *data);
/* t: 0 to 1. */
void flight_way_at(const struct flight_way *way, float t, float out_m[3]);
float flight_way_length_m(const struct flight_way *way);

#endif
