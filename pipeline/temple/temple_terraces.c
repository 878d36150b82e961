/* Lays out the temple mountain: the ground, three terraces, the stairs on the four axes, and the
 * naga balustrades. */
#include "pipeline/temple/temple_terraces.h"

#include <math.h>

/* The moulded base of a Khmer terrace: the same mouldings from the bottom up and from the top down,
 * with a torus between them. */
static const struct profile_point terrace_points[] = {
	{ 1.00f, 0.00f, RELIEF_PLAIN, 0, 0 },
	{ 1.00f, 0.09f, RELIEF_PLAIN, 0, 0 },
	{ 0.88f, 0.09f, RELIEF_PETALS, 0.07f, 0.26f },
	{ 0.68f, 0.19f, RELIEF_PLAIN, 0, 0 },
	{ 0.60f, 0.19f, RELIEF_PLAIN, 0, 0 },
	{ 0.60f, 0.22f, RELIEF_HOLLOW, 0.03f, 0 },
	{ 0.46f, 0.28f, RELIEF_BEADS, 0.03f, 0.09f },
	{ 0.46f, 0.32f, RELIEF_PLAIN, 0, 0 },
	{ 0.34f, 0.32f, RELIEF_SCROLL, 0.05f, 0.62f },
	{ 0.34f, 0.43f, RELIEF_PLAIN, 0, 0 },
	{ 0.52f, 0.43f, RELIEF_ROUND, 0.09f, 0 },
	{ 0.52f, 0.56f, RELIEF_PLAIN, 0, 0 },
	{ 0.34f, 0.56f, RELIEF_FLOWERS, 0.045f, 0.24f },
	{ 0.34f, 0.67f, RELIEF_PLAIN, 0, 0 },
	{ 0.46f, 0.67f, RELIEF_BEADS, 0.03f, 0.09f },
	{ 0.46f, 0.71f, RELIEF_HOLLOW, 0.03f, 0 },
	{ 0.60f, 0.77f, RELIEF_PLAIN, 0, 0 },
	{ 0.60f, 0.80f, RELIEF_PLAIN, 0, 0 },
	{ 0.68f, 0.80f, RELIEF_DROPS, 0.07f, 0.26f },
	{ 0.88f, 0.91f, RELIEF_PLAIN, 0, 0 },
	{ 1.00f, 0.91f, RELIEF_PLAIN, 0, 0 },
	{ 1.00f, 1.00f, RELIEF_PLAIN, 0, 0 },
	{ -1.60f, 1.00f, RELIEF_PLAIN, 0, 0 },
};
static const struct temple_profile terrace = { ARRAY_COUNT(terrace_points), terrace_points };

/* Twelve steps, from the foot (out = 0) inwards. */
#define STEP(i)                                                                                    \
	{ -(i) / 12.0f, (i) / 12.0f, RELIEF_PLAIN, 0, 0 },                                         \
	{                                                                                          \
		-(i) / 12.0f, ((i) + 1) / 12.0f, RELIEF_PLAIN, 0, 0                                \
	}
static const struct profile_point stair_points[] = {
	STEP(0),
	STEP(1),
	STEP(2),
	STEP(3),
	STEP(4),
	STEP(5),
	STEP(6),
	STEP(7),
	STEP(8),
	STEP(9),
	STEP(10),
	STEP(11),
	{ -1.15f, 1.0f, RELIEF_PLAIN, 0, 0 },
};
static const struct temple_profile stairs = { ARRAY_COUNT(stair_points), stair_points };

/* The body of a naga: round, with scales all over. */
static const struct profile_point body_points[] = {
	{ 0.0f, -1.0f, RELIEF_SCALES, 0.03f, 0.16f }, { 0.7f, -0.7f, RELIEF_SCALES, 0.03f, 0.16f },
	{ 1.0f, 0.0f, RELIEF_SCALES, 0.03f, 0.16f },  { 0.7f, 0.7f, RELIEF_SCALES, 0.03f, 0.16f },
	{ 0.0f, 1.0f, RELIEF_SCALES, 0.03f, 0.16f },  { -0.7f, 0.7f, RELIEF_SCALES, 0.03f, 0.16f },
	{ -1.0f, 0.0f, RELIEF_SCALES, 0.03f, 0.16f }, { -0.7f, -0.7f, RELIEF_SCALES, 0.03f, 0.16f },
	{ 0.0f, -1.0f, RELIEF_PLAIN, 0, 0 },
};
static const struct temple_profile body = { ARRAY_COUNT(body_points), body_points };

static const struct profile_point post_points[] = {
	{ 1.0f, 0, RELIEF_PLAIN, 0, 0 },     { 1.0f, 0.2f, RELIEF_PLAIN, 0, 0 },
	{ 0.4f, 0.35f, RELIEF_PLAIN, 0, 0 }, { 0.4f, 0.65f, RELIEF_PLAIN, 0, 0 },
	{ 1.0f, 0.8f, RELIEF_PLAIN, 0, 0 },  { 1.0f, 1.0f, RELIEF_PLAIN, 0, 0 },
};
static const struct temple_profile post = { ARRAY_COUNT(post_points), post_points };

/* A seated guardian lion as a body of revolution: haunches, chest, mane and muzzle. */
static const struct profile_point lion_points[] = {
	{ 0.75f, 0.00f, RELIEF_PLAIN, 0, 0 },
	{ 0.95f, 0.12f, RELIEF_ROUND, 0.02f, 0 },
	{ 0.85f, 0.36f, RELIEF_ROUND, 0.02f, 0 },
	{ 0.62f, 0.52f, RELIEF_PETALS, 0.05f, 0.12f },
	{ 0.72f, 0.68f, RELIEF_BEADS, 0.04f, 0.09f },
	{ 0.74f, 0.80f, RELIEF_BEADS, 0.04f, 0.09f },
	{ 0.55f, 0.93f, RELIEF_PETALS, 0.04f, 0.10f },
	{ 0.25f, 1.00f, RELIEF_PLAIN, 0, 0 },
	{ 0.04f, 1.01f, RELIEF_PLAIN, 0, 0 },
};
static const struct temple_profile lion = { ARRAY_COUNT(lion_points), lion_points };

static const struct profile_point leg_points[] = {
	{ 1.5f, 0, RELIEF_PLAIN, 0, 0 },     { 1.5f, 0.1f, RELIEF_ROUND, 0.01f, 0 },
	{ 0.4f, 0.22f, RELIEF_PLAIN, 0, 0 }, { 0.3f, 0.7f, RELIEF_PLAIN, 0, 0 },
	{ 0.8f, 0.9f, RELIEF_PLAIN, 0, 0 },  { -0.8f, 1.05f, RELIEF_PLAIN, 0, 0 },
};
static const struct temple_profile leg = { ARRAY_COUNT(leg_points), leg_points };

static void plan_lion(struct plan *plan, const struct temple_frame *frame, float height_m)
{
	const uint32_t first = plan->count;
	struct sheet *sheet =
		plan_sheet(plan, frame, &outline_circle, &lion, 0.01f, height_m * 0.34f, height_m);
	struct temple_frame head = frame_within(frame, 0, -height_m * 0.10f, height_m * 0.56f, 0);

	sheet->optional = true;
	sheet->interest = 2;
	sheet = plan_panel(plan, &head, height_m * 0.46f, height_m * 0.44f, RELIEF_LION,
			   height_m * 0.30f, 0);
	sheet->interest = 4;
	for (int side = -1; side <= 1; side += 2) {
		struct temple_frame foot = frame_within(frame, (float)side * height_m * 0.17f,
							-height_m * 0.27f, 0, 0);
		sheet = plan_sheet(plan, &foot, &outline_circle, &leg, height_m * 0.045f,
				   height_m * 0.045f, height_m * 0.52f);
		sheet->optional = true;
	}
	plan_body(plan, "lion", first);
}

void plan_stairs(struct plan *plan, const struct temple_frame *frame, float half_m, float run_m,
		 float rise_m)
{
	plan_sheet(plan, frame, &outline_line, &stairs, 2 * half_m, run_m, rise_m);
	plan_body(plan, "stairs", plan->count - 1);
	for (int side = -1; side <= 1; side += 2) {
		float x = (float)side * (half_m + 0.28f);
		for (int block = 0; block < 3; block++) {
			float part = run_m / 3, y = ((float)block + 0.5f) * part;
			struct temple_frame foot = frame_within(frame, x, y, 0, 0);
			float height = rise_m * (float)(block + 1) / 3;
			plan_box(plan, &foot, 0.32f, part * 0.5f + 0.05f, height);
			struct temple_frame seat = frame_within(&foot, 0, 0, height, 0);
			if (block != 1)
				plan_lion(plan, &seat, 0.95f);
		}
	}
}

static void plan_hood(struct plan *plan, const struct temple_frame *frame)
{
	const uint32_t first = plan->count;

	for (int side = 0; side < 2; side++) {
		struct temple_frame face =
			frame_within(frame, 0, side ? 0.10f : -0.10f, 0, side ? 2 : 0);
		struct sheet *hood =
			plan_panel(plan, &face, 1.5f, 1.75f, RELIEF_HOOD, side ? 0.07f : 0.17f, 0);
		hood->shape = SHAPE_HOOD;
		hood->rim_m = 0.13f;
		hood->interest = 2.4f;
		hood->lean = side ? -0.1f : 0.1f;
	}
	plan_body(plan, "naga", first);
}

/* A naga along the edge of the lowest terrace, from the stairs to the corner. */
static void plan_naga(struct plan *plan, const struct temple_frame *side, float from_m, float to_m)
{
	float sign = from_m < to_m ? 1.0f : -1.0f, length = fabsf(to_m - from_m);
	struct temple_frame middle = frame_within(side, (from_m + to_m) * 0.5f, 0, 0.62f, 0);
	struct temple_frame head = frame_within(side, from_m, 0, 0.05f, 0);
	struct sheet *snake = plan_sheet(plan, &middle, &outline_line, &body, length, 0.21f, 0.21f);

	snake->optional = true;
	snake->interest = 1.2f;
	for (float x = 0.7f; x < length; x += 1.45f) {
		struct temple_frame foot = frame_within(side, from_m + sign * x, 0, 0, 0);
		struct sheet *block =
			plan_sheet(plan, &foot, &outline_square, &post, 0.14f, 0.07f, 0.5f);
		block->optional = true;
	}
	plan_hood(plan, &head);
}

static void plan_side(struct plan *plan, int turn)
{
	struct temple_frame axis = frame_at(0, 0, 0, turn);
	struct temple_frame low = frame_within(&axis, 0, -20.5f, 0, 0);
	struct temple_frame middle = frame_within(&axis, 0, -12.9f, 2.4f, 0);
	struct temple_frame high = frame_within(&axis, 0, -11.05f, 5.4f, 0);
	struct temple_frame rim = frame_within(&axis, 0, -18.0f, 2.4f, 0);

	uint32_t first = plan->count;
	plan_stairs(plan, &low, 1.3f, 2.2f, 2.4f);
	plan_stairs(plan, &middle, 1.1f, 1.9f, 3.0f);
	plan_stairs(plan, &high, 1.1f, 1.9f, 2.8f);
	struct temple_frame corner = frame_within(&rim, 18.0f, 0, 0, 0);
	plan_box(plan, &corner, 0.34f, 0.34f, 0.95f);
	struct temple_frame seat = frame_within(&corner, 0, 0, 0.95f, 0);
	plan_lion(plan, &seat, 1.0f);
	plan_naga(plan, &rim, 2.35f, 17.7f);
	plan_naga(plan, &rim, -2.35f, -17.7f);
	plan_refine(plan, first, turn == 1 ? 1.7f : 1.0f); /* the eastern approach */
}

void plan_terraces(struct plan *plan)
{
	static const struct {
		float floor, height, size, reach;
		bool redented;
	} steps[] = { { 0, 2.4f, 17.9f, 0.55f, false },
		      { 2.4f, 3.0f, 10.7f, 0.6f, true },
		      { 5.4f, 2.8f, 8.95f, 0.5f, true } };

	struct temple_frame ground = frame_at(0, 0, 0, 0);
	plan_floor(plan, &ground, 21, 21, RELIEF_BLOCKS, 0.04f, 0.9f);
	for (uint32_t i = 0; i < ARRAY_COUNT(steps); i++) {
		struct temple_frame foot = frame_at(0, 0, steps[i].floor, 0);
		struct temple_frame deck =
			frame_at(0, 0, steps[i].floor + steps[i].height - 0.04f, 0);
		plan_sheet(plan, &foot,
			   steps[i].redented ? &outline_redented_deep : &outline_square, &terrace,
			   steps[i].size, steps[i].reach, steps[i].height);
		float half = steps[i].size * (steps[i].redented ? 0.905f : 0.98f);
		plan_floor(plan, &deck, half, half, RELIEF_BLOCKS, 0.03f, 0.8f);
	}
	for (int turn = 0; turn < 4; turn++)
		plan_side(plan, turn);
}
