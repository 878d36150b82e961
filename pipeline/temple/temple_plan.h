/* The plan of the demo temple: which sheets stand where. Its size is bounded: some thousands of
 * sheets for any number of triangles. */
#ifndef GOPURA_PIPELINE_TEMPLE_TEMPLE_PLAN_H
#define GOPURA_PIPELINE_TEMPLE_TEMPLE_PLAN_H

#include "pipeline/temple/temple_sheet.h"

/* Consecutive sheets that form one carving, such as a lion, so that a part can be marked by its
 * faces. */
struct body {
	const char *kind; /* static: "lion", "naga", "stairs" */
	uint32_t number;  /* number within its kind, from 1 */
	uint32_t first, count;
};

struct plan {
	struct sheet *sheets; /* owned */
	uint32_t count, room;
	struct body *bodies; /* owned; ascending, without overlaps */
	uint32_t body_count, body_room;
	uint32_t seed;
	int error; /* 0 or -ENOMEM; the first error stays */
};

void plan_destroy(struct plan *plan); /* Frees the plan. NULL and a zeroed plan are fine. */

/* ---- for the sources that lay it out */

/* A position with a direction: its local -y axis points that way. */
struct temple_frame {
	float origin_m[3];
	float turn[2];
};

/* A frame in the temple's own axes. quarter_turns are counter-clockwise. */
struct temple_frame frame_at(float x_m, float y_m, float z_m, int quarter_turns);
/* A frame given in the axes of another one. turns: quarter turns counter-clockwise. */
struct temple_frame frame_within(const struct temple_frame *frame, float x_m, float y_m, float z_m,
				 int turns);

extern const struct temple_outline outline_line, outline_square, outline_circle, outline_octagon,
	outline_redented, outline_redented_deep;

/* Adds a sheet of the profile, standing at the frame; the caller then changes what differs. Never
 * NULL: when memory has run out, it returns a sheet that belongs to no plan. Borrowed until the
 * next sheet. */
struct sheet *plan_sheet(struct plan *plan, const struct temple_frame *frame,
			 const struct temple_outline *outline, const struct temple_profile *profile,
			 float size_m, float reach_m, float height_m);
/* Adds an upright relief; the frame is the middle of its lower edge. Returns as plan_sheet. */
struct sheet *plan_panel(struct plan *plan, const struct temple_frame *frame, float width_m,
			 float height_m, enum relief relief, float depth_m, float period_m);
/* Adds a level rectangle that faces up; the frame is its middle. */
void plan_floor(struct plan *plan, const struct temple_frame *frame, float half_x_m, float half_y_m,
		enum relief relief, float depth_m, float period_m);
/* Adds a plain upright box with a lid; the frame is the middle of its base. */
void plan_box(struct plan *plan, const struct temple_frame *frame, float half_x_m, float half_y_m,
	      float height_m);

/* Multiplies the divisions of the reliefs added since `from` (a plan->count): what a visitor meets
 * first, and what the parts refer to, is modelled more finely. */
void plan_refine(struct plan *plan, uint32_t from, float factor);
/* Declares the sheets added since `from` as one carving. kind is a static string. */
void plan_body(struct plan *plan, const char *kind, uint32_t from);

#endif
