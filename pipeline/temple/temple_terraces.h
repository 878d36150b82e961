/* Lays out the ground, terraces, stairs and balustrades of the demo temple. */
#ifndef GOPURA_PIPELINE_TEMPLE_TEMPLE_TERRACES_H
#define GOPURA_PIPELINE_TEMPLE_TEMPLE_TERRACES_H

#include "pipeline/temple/temple_plan.h"

/* The ground, the terraces, stairs and balustrades. */
void plan_terraces(struct plan *plan);
/* A flight of stairs that climbs against the frame's direction, with side walls and lions. */
void plan_stairs(struct plan *plan, const struct temple_frame *frame, float half_m, float run_m,
		 float rise_m);

#endif
