/* The path of a camera flight: straight, or a bend over or around an obstacle. A bend is a
 * quadratic Bezier curve. Pure. */
#ifndef GOPURA_APP_VIEW_FLIGHT_WAY_H
#define GOPURA_APP_VIEW_FLIGHT_WAY_H

#include <stdbool.h>

struct flight_way {
	/* over_m is the control point; the midpoint of a straight path. */
	float from_m[3], over_m[3], to_m[3];
};

/* Returns whether the segment is free: nothing lies on it, or so close to it that the near plane
 * would cut it open. */
typedef bool flight_way_free(void *data, const float from_m[3], const float to_m[3]);

/* Chooses the smallest free bend out of a fixed list that goes up, sideways or both; if none is
 * free, a straight path. size_m: about the height of possible obstacles; it limits the bend.
 * is_free is called with data, only during this call. */
void flight_way_choose(struct flight_way *way, const float from_m[3], const float to_m[3],
		       float size_m, flight_way_free *is_free, void *data);
/* Writes the point at t, 0 to 1, to out_m. */
void flight_way_at(const struct flight_way *way, float t, float out_m[3]);
/* Returns the length of the path, in metres, approximated by 16 segments. */
float flight_way_length_m(const struct flight_way *way);

#endif
