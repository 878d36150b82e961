/* Lays out the towers, gates and porches of the demo temple. */
#ifndef GOPURA_PIPELINE_TEMPLE_TEMPLE_TOWERS_H
#define GOPURA_PIPELINE_TEMPLE_TEMPLE_TOWERS_H

#include "pipeline/temple/temple_plan.h"

/* The towers and the gates. */
void plan_towers(struct plan *plan);
/* A lotus-bud tower on a redented plan. half_m is half the width and body_m the height of its body,
 * top_m about its total height, tiers the number of storeys above the body. */
void plan_tower(struct plan *plan, const struct temple_frame *frame, float half_m, float body_m,
		float top_m, uint32_t tiers);
/* A tower with a face on each side; half_m is half its width. */
void plan_face_tower(struct plan *plan, const struct temple_frame *frame, float half_m);
/* A doorway with colonettes, lintel and pediment on a porch that projects depth_m from the front of
 * the frame. */
void plan_porch(struct plan *plan, const struct temple_frame *frame, float half_m, float depth_m,
		float height_m);

#endif
