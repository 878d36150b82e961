/* The triangles of transparent scenery from far to near, so that each is blended over what is
 * behind it. Pure: no GL. */
#ifndef GOPURA_RENDER_SCENERY_SCENERY_ORDER_H
#define GOPURA_RENDER_SCENERY_SCENERY_ORDER_H

#include "render/scenery/pose.h"

struct scenery_ordered {
	float distance_m; /* from the eye to its middle */
	uint32_t mesh, triangle;
};

/* Zeroed is empty. */
struct scenery_order {
	struct scenery_ordered *triangles; /* owned */
	uint32_t count, room;
};

/* Adds the triangles of a mesh, as the pose places them. Returns -ENOMEM. */
must_check int scenery_order_add(struct scenery_order *order, const struct pose *pose,
				 uint32_t mesh, const float eye_m[3]);
/* Sorts all that were added, the farthest first; equal ones by mesh and triangle. */
void scenery_order_sort(struct scenery_order *order);
void scenery_order_finish(struct scenery_order *order); /* zeroed is fine */

#endif
