/* The way of a flight through free space (format/solid.h): straight if nothing is in between, else
 * through doors and around walls, short and with rounded corners. */
#ifndef GOPURA_GEOMETRY_SOLID_WAY_H
#define GOPURA_GEOMETRY_SOLID_WAY_H

#include "format/solid.h"

enum { SOLID_WAY_POINTS_MAX = 128 };

struct solid_way {
	uint32_t count; /* 2 to SOLID_WAY_POINTS_MAX; the way goes straight from one to the next */
	float points_m[SOLID_WAY_POINTS_MAX][3];
	float at_m[SOLID_WAY_POINTS_MAX]; /* length of the way up to each point; [0] is 0 */
};

/* Sets a straight way, whatever is in between. */
void solid_way_straight(struct solid_way *way, const float from_m[3], const float to_m[3]);
/* Sets at_m from the points. */
void solid_way_measure(struct solid_way *way);
/* Plans a way. A last point that is not free is replaced by the nearest one that is; a first one
 * that is not is left by the shortest way. Returns -ENOENT if there is no way or it would take too
 * long to find, or -ENOMEM; *way is then straight, and not free. */
must_check int solid_way_plan(struct solid_way *way, const struct solid *solid,
			      const float from_m[3], const float to_m[3]);
/* Writes the point at a share, 0 to 1, of the way's length. */
void solid_way_at(const struct solid_way *way, float share, float out_m[3]);
/* Returns its length in metres. */
float solid_way_length_m(const struct solid_way *way);
/* Returns its last point, borrowed. */
const float *solid_way_end_m(const struct solid_way *way);

#endif
