/* Lays out the galleries of the demo temple. */
#ifndef GOPURA_PIPELINE_TEMPLE_TEMPLE_GALLERIES_H
#define GOPURA_PIPELINE_TEMPLE_TEMPLE_GALLERIES_H

#include "pipeline/temple/temple_plan.h"

/* The outer galleries and those on the top terrace. */
void plan_galleries(struct plan *plan);
/* A gallery along the frame's x axis; the frame is in the middle of its floor. */
struct gallery {
	float length_m, half_m, wall_m;
	bool open;    /* columns in front instead of a wall */
	bool reliefs; /* a procession along the back wall of an open gallery */
	bool windows; /* not used: every wall gets windows */
};
/* Adds a gallery. */
void plan_gallery(struct plan *plan, const struct temple_frame *frame,
		  const struct gallery *gallery);

#endif
