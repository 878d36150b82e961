/* What a finger does to the things that it drags: VRML97's PlaneSensor, CylinderSensor and
 * SphereSensor (ISO/IEC 14772-1 6.34, 6.15, 6.44). Pure: no GL, no clock. */
#ifndef GOPURA_RENDER_SCENERY_DRAG_H
#define GOPURA_RENDER_SCENERY_DRAG_H

#include "format/scenery.h"

/* One drag of the scenery, while a finger holds it and between. */
struct drag {
	float offset[4], value[4]; /* as scenery_drag's offset: where it begins, and where it is */
	/* While it is held, all in metres of the handle: */
	float to_handle[16]; /* from metres of the model, when it was taken */
	float begin[3];      /* where the finger took it */
	float angle_rad;     /* cylinder: of the finger at the last move */
	float turned_rad;    /* cylinder: since it was taken */
	bool is_disc, is_behind;
};

/* Sets it to how the scenery begins. */
void drag_init(struct drag *drag, const struct scenery_drag *of);
/* A finger took it. handle: from the handle's metres to those of the model; point_m: what it
 * touched, and direction: of the ray from the eye, both in the model. Returns false if the handle
 * has no size along some axis. */
bool drag_begin(struct drag *drag, const struct scenery_drag *of, const float handle[16],
		const float point_m[3], const float direction[3]);
/* The finger is now where a ray goes, in the model. Sets drag->value: of a plane a place, else a
 * unit quaternion. Where the ray leads nowhere the value stays. */
void drag_move(struct drag *drag, const struct scenery_drag *of, const float from_m[3],
	       const float direction[3]);
/* Writes what the moved node gets: a place of 3 numbers, or a turn of 4. */
void drag_value(const struct drag *drag, const struct scenery_drag *of, float out[4]);
/* The finger let go. */
void drag_end(struct drag *drag, const struct scenery_drag *of);

#endif
