/* Somebody who walks: stands on the floor below free space (format/solid.h), climbs stairs, stoops
 * under what is low, and finds a way. Pure. */
#ifndef GOPURA_GEOMETRY_FOOT_WAY_H
#define GOPURA_GEOMETRY_FOOT_WAY_H

#include "geometry/solid_way.h"

#include <stdbool.h>

struct foot {
	const struct solid *solid; /* borrowed */
	float ground_m;            /* height of the ground where the octree has none */
	float height_m;            /* of the eye above the floor, standing upright; above 0.5 m */
};

/* Where somebody stands. floor_m: the lowest free height there, an eye's room above the surface. */
struct foot_stance {
	float floor_m;
	float eye_m[3];
};

/* Finds the stance on the first floor below a free point. Returns false if the point is not free,
 * the floor is more than drop_m below it, or nobody fits in between. */
bool foot_stand(const struct foot *foot, const float from_m[3], float drop_m,
		struct foot_stance *out);
/* Finds the stance for a touched point of a surface: on it if it is a floor, else before it as seen
 * from eye_m and below. Returns false if there is none. */
bool foot_stand_at(const struct foot *foot, const float touched_m[3], const float eye_m[3],
		   struct foot_stance *out);
/* Steps to another place at most half a metre away, up or down a step of a stair at most. Returns
 * false if that cannot be. *out may be *from. */
bool foot_step(const struct foot *foot, const struct foot_stance *from, float x_m, float y_m,
	       struct foot_stance *out);
/* Plans the way of the eye from one stance to another, or to the nearest one that can be reached;
 * short, and even where stairs are not. Returns -ENOENT if no place that is nearer can be reached,
 * or -ENOMEM; *way is then unchanged. */
must_check int foot_way_plan(struct solid_way *way, const struct foot *foot,
			     const struct foot_stance *from, const struct foot_stance *to);

#endif
