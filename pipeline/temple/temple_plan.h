/* The plan of the demo temple: which sheets stand where. Bounded: some thousands of sheets,
 * whatever the number of triangles asked for. */
#ifndef GOPURA_PIPELINE_TEMPLE_TEMPLE_PLAN_H
#define GOPURA_PIPELINE_TEMPLE_TEMPLE_PLAN_H

#include "pipeline/temple/temple_sheet.h"

/* Sheets that are one carving, such as a lion: a part can be marked by its faces. */
struct body {
	const char *kind; /* static: "lion", "naga", "stairs" */
	uint32_t number;  /* of its kind, from 1 */
	uint32_t first, count;
};

struct plan {
	struct sheet *sheets; /* owned */
	uint32_t count, capacity;
	struct body *bodies; /* owned; ascending, apart from one another */
	uint32_t body_count;
	uint32_t seed;
	int error; /* 0 or -ENOMEM, sticky */
};

/* Lays out the whole temple. On failure the plan is empty. */
void plan_destroy(struct plan *plan); /* NULL and zeroed are fine */

/* ---- for the files that lay it out */

/* A place with a direction: local -y looks that way. */
struct frame {
	float origin_m[3];
	float turn[2];
};

struct frame frame_at(float x_m, float y_m, float z_m, int quarter_turns);
/* A place in the frame's own axes. turns: quarter turns counter-clockwise. */
struct frame frame_within(const struct frame *frame, float x_m, float y_m, float z_m, int turns);

extern const struct outline outline_line, outline_square, outline_circle, outline_octagon,
	outline_redented, outline_redented_deep;

/* A sheet of the profile, standing at the frame; the caller changes what differs. Never NULL:
 * when memory ran out, a sheet that is in no plan. */
struct sheet *plan_sheet(struct plan *plan, const struct frame *frame,
			 const struct outline *outline, const struct profile *profile, float size_m,
			 float reach_m, float height_m);
/* An upright relief, its middle foot at the frame. */
struct sheet *plan_panel(struct plan *plan, const struct frame *frame, float width_m,
			 float height_m, enum relief relief, float depth_m, float period_m);
/* A level rectangle looking up, its middle at the frame. */
void plan_floor(struct plan *plan, const struct frame *frame, float half_x_m, float half_y_m,
		enum relief relief, float depth_m, float period_m);
/* A plain upright box with lid; the frame is the middle of its foot. */
void plan_box(struct plan *plan, const struct frame *frame, float half_x_m, float half_y_m,
	      float height_m);

/* The reliefs laid out since `from` (a plan->count) get more divisions: what a visitor
 * meets first, and what the parts point at, was scanned more closely. */
void plan_refine(struct plan *plan, uint32_t from, float factor);
/* What was laid out since `from` is one carving. */
void plan_body(struct plan *plan, const char *kind, uint32_t from);

void plan_terraces(struct plan *plan);
void plan_galleries(struct plan *plan);
void plan_towers(struct plan *plan);
/* A lotus-bud tower on a redented plan. half_m: of its body; body_m: height of the body. */
void plan_tower(struct plan *plan, const struct frame *frame, float half_m, float body_m,
		float top_m, uint32_t tiers);
/* A tower with a face to each side. */
void plan_face_tower(struct plan *plan, const struct frame *frame, float half_m);
/* A doorway with colonettes, lintel and pediment on a porch that comes out of the frame's front. */
void plan_porch(struct plan *plan, const struct frame *frame, float half_m, float depth_m,
		float height_m);
/* A flight of stairs climbing against the frame's direction, with its cheeks. */
void plan_stairs(struct plan *plan, const struct frame *frame, float half_m, float run_m,
		 float rise_m);
/* A gallery along the frame's x axis, the frame in the middle of its floor. */
struct gallery {
	float length_m, half_m, wall_m;
	bool open;    /* a row of columns in front instead of a wall */
	bool reliefs; /* a procession along the wall in front */
	bool windows; /* balustered windows in front */
};
void plan_gallery(struct plan *plan, const struct frame *frame, const struct gallery *gallery);

#endif
