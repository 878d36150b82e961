/* Collects the sheets of the temple: outlines, frames, and the sheets that every building part
 * uses. */
#include "pipeline/temple/temple_plan.h"

#include <errno.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/array.h"

const struct temple_outline outline_line = { OUTLINE_LINE, 2, { { -0.5f, 0 }, { 0.5f, 0 } } };
const struct temple_outline outline_square = { OUTLINE_CLOSED,
					       4,
					       { { -1, -1 }, { 1, -1 }, { 1, 1 }, { -1, 1 } } };
const struct temple_outline outline_circle = { OUTLINE_ROUND, 1, { { 1, 0 } } };
const struct temple_outline outline_octagon = { OUTLINE_CLOSED,
						8,
						{ { 1, 0.414f },
						  { 0.414f, 1 },
						  { -0.414f, 1 },
						  { -1, 0.414f },
						  { -1, -0.414f },
						  { -0.414f, -1 },
						  { 0.414f, -1 },
						  { 1, -0.414f } } };

/* The corners of a quarter, rotated into the other three. */
#define QUARTERS(ax, bx, by)                                                                       \
	{ 1, ax }, { bx, ax }, { bx, by }, { by, by }, { by, bx }, { ax, bx }, { ax, 1 },          \
		{ -ax, 1 }, { -ax, bx }, { -by, bx }, { -by, by }, { -bx, by }, { -bx, ax },       \
		{ -1, ax }, { -1, -ax }, { -bx, -ax }, { -bx, -by }, { -by, -by }, { -by, -bx },   \
		{ -ax, -bx }, { -ax, -1 }, { ax, -1 }, { ax, -bx }, { by, -bx }, { by, -by },      \
		{ bx, -by }, { bx, -ax },                                                          \
	{                                                                                          \
		1, -ax                                                                             \
	}

const struct temple_outline outline_redented = { OUTLINE_CLOSED,
						 28,
						 { QUARTERS(0.42f, 0.88f, 0.68f) } };
const struct temple_outline outline_redented_deep = { OUTLINE_CLOSED,
						      28,
						      { QUARTERS(0.24f, 0.965f, 0.90f) } };

struct temple_frame frame_at(float x_m, float y_m, float z_m, int quarter_turns)
{
	static const float turns[4][2] = { { 1, 0 }, { 0, 1 }, { -1, 0 }, { 0, -1 } };
	const float *turn = turns[quarter_turns & 3];

	return (struct temple_frame){ { x_m, y_m, z_m }, { turn[0], turn[1] } };
}

struct temple_frame frame_within(const struct temple_frame *frame, float x_m, float y_m, float z_m,
				 int turns)
{
	struct temple_frame step = frame_at(x_m, y_m, z_m, turns);
	float c = frame->turn[0], s = frame->turn[1];

	return (struct temple_frame){
		{ frame->origin_m[0] + c * x_m - s * y_m, frame->origin_m[1] + s * x_m + c * y_m,
		  frame->origin_m[2] + z_m },
		{ c * step.turn[0] - s * step.turn[1], s * step.turn[0] + c * step.turn[1] },
	};
}

/* Receives the writes after memory has run out, so that the layout need not check each sheet. */
static struct sheet nowhere;

static struct sheet *plan_room(struct plan *plan)
{
	if (plan->error)
		return &nowhere;
	plan->error = ARRAY_RESERVE(plan->sheets, plan->room, plan->count + 1, UINT32_MAX);
	if (plan->error)
		return &nowhere;
	return &plan->sheets[plan->count++];
}

struct sheet *plan_sheet(struct plan *plan, const struct temple_frame *frame,
			 const struct temple_outline *outline, const struct temple_profile *profile,
			 float size_m, float reach_m, float height_m)
{
	struct sheet *sheet = plan_room(plan);

	*sheet = (struct sheet){
		.outline = outline,
		.profile = profile,
		.origin_m = { frame->origin_m[0], frame->origin_m[1], frame->origin_m[2] },
		.turn = { frame->turn[0], frame->turn[1] },
		.size_m = size_m,
		.stretch = 1,
		.reach_m = reach_m,
		.height_m = height_m,
		.interest = 1,
		.relief.seed = plan->seed * 7919u + plan->count,
	};
	return sheet;
}

static const struct profile_point upright_points[] = { { 0, 0, RELIEF_SHEET, 0, 0 },
						       { 0, 1, RELIEF_PLAIN, 0, 0 } };
static const struct temple_profile upright = { 2, upright_points };
static const struct profile_point level_points[] = { { 1, 0, RELIEF_SHEET, 0, 0 },
						     { -1, 0, RELIEF_PLAIN, 0, 0 } };
static const struct temple_profile level = { 2, level_points };

struct sheet *plan_panel(struct plan *plan, const struct temple_frame *frame, float width_m,
			 float height_m, enum relief relief, float depth_m, float period_m)
{
	struct sheet *sheet =
		plan_sheet(plan, frame, &outline_line, &upright, width_m, 1, height_m);

	sheet->relief = (struct relief_style){ relief, depth_m, period_m, sheet->relief.seed };
	sheet->rim_m = 0.08f;
	sheet->optional = true;
	return sheet;
}

void plan_floor(struct plan *plan, const struct temple_frame *frame, float half_x_m, float half_y_m,
		enum relief relief, float depth_m, float period_m)
{
	struct sheet *sheet =
		plan_sheet(plan, frame, &outline_line, &level, 2 * half_x_m, half_y_m, 1);

	sheet->relief = (struct relief_style){ relief, depth_m, period_m, sheet->relief.seed };
	sheet->interest = 0.35f;
}

void plan_box(struct plan *plan, const struct temple_frame *frame, float half_x_m, float half_y_m,
	      float height_m)
{
	struct temple_frame top = frame_within(frame, 0, 0, height_m, 0);
	struct sheet *sheet =
		plan_sheet(plan, frame, &outline_square, &upright, half_x_m, 1, height_m);

	sheet->stretch = half_y_m / half_x_m;
	plan_floor(plan, &top, half_x_m, half_y_m, RELIEF_PLAIN, 0, 0);
}

void plan_refine(struct plan *plan, uint32_t from, float factor)
{
	for (uint32_t i = from; i < plan->count; i++)
		if (relief_varies_across(plan->sheets[i].relief.kind))
			plan->sheets[i].interest *= factor;
}

void plan_body(struct plan *plan, const char *kind, uint32_t from)
{
	uint32_t number = 1;
	int rc = ARRAY_RESERVE(plan->bodies, plan->body_room, plan->body_count + 1, UINT32_MAX);

	if (rc < 0) {
		plan->error = rc;
		return;
	}
	for (uint32_t i = 0; i < plan->body_count; i++)
		number += strcmp(plan->bodies[i].kind, kind) == 0;
	plan->bodies[plan->body_count++] = (struct body){ kind, number, from, plan->count - from };
}

void plan_destroy(struct plan *plan)
{
	if (!plan)
		return;
	free(plan->sheets);
	free(plan->bodies);
	*plan = (struct plan){ 0 };
}
