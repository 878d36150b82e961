/* Lays out the towers: five lotus buds on the summit, smaller ones at the corners of the outer
 * gallery, and towers with four faces over its gates. */
#include "pipeline/temple/temple_towers.h"

#include <math.h>

#include "pipeline/temple/temple_carve.h"
#include "pipeline/temple/temple_terraces.h"

static const struct profile_point plinth_points[] = {
	{ 1.0f, 0, RELIEF_PLAIN, 0, 0 },
	{ 1.0f, 0.18f, RELIEF_PETALS, 0.05f, 0.2f },
	{ 0.55f, 0.42f, RELIEF_PLAIN, 0, 0 },
	{ 0.4f, 0.42f, RELIEF_SCROLL, 0.035f, 0.4f },
	{ 0.4f, 0.62f, RELIEF_ROUND, 0.05f, 0 },
	{ 0.4f, 0.76f, RELIEF_BEADS, 0.025f, 0.08f },
	{ 0.25f, 0.86f, RELIEF_PETALS, 0.03f, 0.14f },
	{ 0.0f, 1.0f, RELIEF_PLAIN, 0, 0 },
};
static const struct temple_profile plinth = { ARRAY_COUNT(plinth_points), plinth_points };

static const struct profile_point cornice_points[] = {
	{ 0.0f, 0, RELIEF_SCROLL, 0.04f, 0.42f },
	{ 0.05f, 0.24f, RELIEF_BEADS, 0.03f, 0.09f },
	{ 0.20f, 0.33f, RELIEF_DROPS, 0.05f, 0.2f },
	{ 0.62f, 0.58f, RELIEF_PLAIN, 0, 0 },
	{ 0.75f, 0.58f, RELIEF_FLOWERS, 0.035f, 0.17f },
	{ 0.75f, 0.76f, RELIEF_PLAIN, 0, 0 },
	{ 1.0f, 0.80f, RELIEF_PETALS, 0.035f, 0.15f },
	{ 0.85f, 1.0f, RELIEF_PLAIN, 0, 0 },
	{ -1.2f, 1.02f, RELIEF_PLAIN, 0, 0 },
};
static const struct temple_profile cornice = { ARRAY_COUNT(cornice_points), cornice_points };

/* One storey of the tower's crown: a small wall and its cornice. */
static const struct profile_point storey_points[] = {
	{ -0.10f, 0, RELIEF_PETALS, 0.04f, 0.16f },
	{ -0.25f, 0.14f, RELIEF_FLOWERS, 0.035f, 0.19f },
	{ -0.25f, 0.48f, RELIEF_BEADS, 0.025f, 0.08f },
	{ -0.05f, 0.56f, RELIEF_DROPS, 0.045f, 0.17f },
	{ 0.55f, 0.74f, RELIEF_PLAIN, 0, 0 },
	{ 0.70f, 0.74f, RELIEF_SCROLL, 0.03f, 0.3f },
	{ 0.70f, 0.89f, RELIEF_BEADS, 0.025f, 0.08f },
	{ 0.62f, 0.95f, RELIEF_PLAIN, 0, 0 },
	{ -2.4f, 1.04f, RELIEF_PLAIN, 0, 0 },
};
static const struct temple_profile storey = { ARRAY_COUNT(storey_points), storey_points };

/* The lotus on top, and its stone pin. */
static const struct profile_point crown_points[] = {
	{ 0.80f, 0.00f, RELIEF_PETALS, 0.05f, 0.24f },
	{ 1.00f, 0.16f, RELIEF_PETALS, 0.06f, 0.24f },
	{ 0.78f, 0.32f, RELIEF_BEADS, 0.03f, 0.10f },
	{ 0.62f, 0.36f, RELIEF_PETALS, 0.05f, 0.2f },
	{ 0.70f, 0.48f, RELIEF_PETALS, 0.05f, 0.2f },
	{ 0.42f, 0.60f, RELIEF_BEADS, 0.03f, 0.09f },
	{ 0.34f, 0.64f, RELIEF_ROUND, 0.03f, 0 },
	{ 0.30f, 0.72f, RELIEF_ROUND, 0.02f, 0 },
	{ 0.16f, 0.82f, RELIEF_ROUND, 0.01f, 0 },
	{ 0.08f, 0.94f, RELIEF_PLAIN, 0, 0 },
	{ 0.02f, 1.00f, RELIEF_PLAIN, 0, 0 },
};
static const struct temple_profile crown = { ARRAY_COUNT(crown_points), crown_points };

static const struct profile_point wall_points[] = { { 0, 0, RELIEF_PLAIN, 0, 0 },
						    { 0, 1, RELIEF_PLAIN, 0, 0 } };
static const struct temple_profile wall = { 2, wall_points };

static const struct profile_point colonnette_points[] = {
	{ 1.0f, 0, RELIEF_PLAIN, 0, 0 },
	{ 1.0f, 0.08f, RELIEF_PETALS, 0.02f, 0.07f },
	{ 0.4f, 0.16f, RELIEF_FLOWERS, 0.012f, 0.08f },
	{ 0.4f, 0.30f, RELIEF_ROUND, 0.03f, 0 },
	{ 0.4f, 0.36f, RELIEF_FLOWERS, 0.012f, 0.08f },
	{ 0.4f, 0.47f, RELIEF_BEADS, 0.02f, 0.05f },
	{ 0.5f, 0.50f, RELIEF_ROUND, 0.035f, 0 },
	{ 0.5f, 0.56f, RELIEF_BEADS, 0.02f, 0.05f },
	{ 0.4f, 0.59f, RELIEF_FLOWERS, 0.012f, 0.08f },
	{ 0.4f, 0.70f, RELIEF_ROUND, 0.03f, 0 },
	{ 0.4f, 0.76f, RELIEF_FLOWERS, 0.012f, 0.08f },
	{ 0.4f, 0.88f, RELIEF_DROPS, 0.02f, 0.07f },
	{ 1.0f, 0.95f, RELIEF_PLAIN, 0, 0 },
	{ 1.0f, 1.0f, RELIEF_PLAIN, 0, 0 },
};
static const struct temple_profile colonnette = { ARRAY_COUNT(colonnette_points),
						  colonnette_points };

/* The front and back of a free-standing pediment. */
static void plan_pediment(struct plan *plan, const struct temple_frame *foot, float width_m,
			  float height_m)
{
	const uint32_t first = plan->count;

	for (int side = 0; side < 2; side++) {
		struct temple_frame face =
			frame_within(foot, 0, side ? 0.12f : -0.12f, 0, side ? 2 : 0);
		struct sheet *sheet = plan_panel(plan, &face, width_m, height_m, RELIEF_TYMPANUM,
						 side ? 0.04f : 0.17f, 0);
		sheet->shape = SHAPE_PEDIMENT;
		sheet->rim_m = 0.13f;
		sheet->interest = side ? 0.8f : 3.0f;
	}
	plan_body(plan, "pediment", first);
}

/* The frame of a doorway: colonettes, lintel and pediment; z = 0 at the sill. */
static void plan_doorway(struct plan *plan, const struct temple_frame *sill, float half_m,
			 float height_m)
{
	float opening = height_m * 0.72f;
	struct temple_frame over = frame_within(sill, 0, -0.06f, opening, 0);
	struct temple_frame gable = frame_within(sill, 0, 0.02f, height_m, 0);

	for (int side = -1; side <= 1; side += 2) {
		struct temple_frame jamb =
			frame_within(sill, (float)side * (half_m * 0.62f), 0.02f, 0, 0);
		struct temple_frame shaft =
			frame_within(sill, (float)side * (half_m * 0.62f), -0.16f, 0, 0);
		struct temple_frame pilaster =
			frame_within(sill, (float)side * (half_m * 0.87f), -0.14f, 0, 0);
		plan_box(plan, &jamb, 0.14f, 0.14f, opening);
		struct sheet *sheet = plan_sheet(plan, &shaft, &outline_circle, &colonnette, 0.075f,
						 0.05f, opening);
		sheet->interest = 2;
		sheet->optional = true;
		plan_body(plan, "column", plan->count - 1);
		plan_panel(plan, &pilaster, half_m * 0.3f, height_m, RELIEF_SCROLL_UP, 0.05f, 0.34f)
			->interest = 1.6f;
	}
	struct sheet *lintel =
		plan_panel(plan, &over, half_m * 1.5f, height_m - opening, RELIEF_LINTEL, 0.16f, 0);
	lintel->interest = 3;
	lintel->rim_m = 0.2f;
	plan_body(plan, "lintel", plan->count - 1);
	plan_pediment(plan, &gable, half_m * 2.7f, half_m * 1.75f);
}

/* A pointed vault over a porch, along the frame's y axis. */
static void plan_porch_roof(struct plan *plan, const struct temple_frame *frame, float half_m,
			    float depth_m, float height_m)
{
	static const struct profile_point points[] = {
		{ 1.0f, 0.0f, RELIEF_PETALS, 0.04f, 0.2f },
		{ 0.98f, 0.15f, RELIEF_TILES, 0.10f, 0.44f },
		{ 0.86f, 0.5f, RELIEF_TILES, 0.10f, 0.44f },
		{ 0.5f, 0.85f, RELIEF_TILES, 0.10f, 0.44f },
		{ 0.0f, 1.0f, RELIEF_TILES, 0.10f, 0.44f },
		{ -0.5f, 0.85f, RELIEF_TILES, 0.10f, 0.44f },
		{ -0.86f, 0.5f, RELIEF_TILES, 0.10f, 0.44f },
		{ -0.98f, 0.15f, RELIEF_DROPS, 0.04f, 0.2f },
		{ -1.0f, 0.0f, RELIEF_PLAIN, 0, 0 },
	};
	static const struct profile_point inside[] = { { -0.8f, 0, RELIEF_PLAIN, 0, 0 },
						       { 0, 0.85f, RELIEF_PLAIN, 0, 0 },
						       { 0.8f, 0, RELIEF_PLAIN, 0, 0 } };
	static const struct temple_profile roof = { ARRAY_COUNT(points), points };
	static const struct temple_profile ceiling = { ARRAY_COUNT(inside), inside };
	struct temple_frame across = frame_within(frame, 0, -depth_m * 0.5f + 0.1f, height_m, 1);

	plan_sheet(plan, &across, &outline_line, &roof, depth_m + 0.1f, half_m + 0.15f,
		   half_m * 1.2f);
	plan_sheet(plan, &across, &outline_line, &ceiling, depth_m, half_m + 0.1f, half_m * 1.2f);
}

void plan_porch(struct plan *plan, const struct temple_frame *frame, float half_m, float depth_m,
		float height_m)
{
	struct temple_frame front = frame_within(frame, 0, -depth_m, 0, 0);
	struct temple_frame door = frame_within(frame, 0, -0.06f, 0, 0);

	for (int side = -1; side <= 1; side += 2) {
		float x = (float)side * (half_m - 0.12f);
		struct temple_frame middle = frame_within(frame, x, -depth_m * 0.5f, 0, 0);
		struct temple_frame outside = frame_within(frame, (float)side * (half_m + 0.02f),
							   -depth_m * 0.5f, height_m * 0.16f, side);
		plan_box(plan, &middle, 0.13f, depth_m * 0.5f, height_m);
		if (depth_m > 0.8f)
			plan_panel(plan, &outside, fminf(0.7f, depth_m * 0.75f), height_m * 0.68f,
				   RELIEF_DEVATA, 0.1f, 0)
				->interest = 2.4f;
	}
	plan_panel(plan, &door, half_m * 1.3f, height_m * 0.75f, RELIEF_DOOR, 0.12f, 0)->interest =
		2;
	plan_porch_roof(plan, frame, half_m, depth_m, height_m);
	plan_doorway(plan, &front, half_m, height_m);
}

/* A free-standing leaf of stone on a cornice that leans back slightly. */
static void plan_antefix(struct plan *plan, const struct temple_frame *frame, float width_m,
			 float high_m)
{
	struct sheet *leaf = plan_panel(plan, frame, width_m, high_m, RELIEF_FLAME, 0.09f, 0);

	leaf->shape = SHAPE_LEAF;
	leaf->rim_m = fminf(0.12f, 0.2f * width_m);
	leaf->lean = -0.18f;
	leaf->interest = 3.9f;
	plan_body(plan, "antefix", plan->count - 1);
}

/* Antefixes on a cornice: one on each axis and one across each corner; where there is room, two
 * more beside each axis. */
static void plan_antefixes(struct plan *plan, const struct temple_frame *deck, float half_m,
			   float high_m)
{
	const float eighth = sqrtf(0.5f); /* sine and cosine of an eighth turn */
	const bool roomy = half_m > 1.9f;

	for (int turn = 0; turn < 4; turn++) {
		struct temple_frame side = frame_within(deck, 0, 0, 0, turn);
		struct temple_frame axis = frame_within(&side, 0, -half_m - 0.1f, 0, 0);
		struct temple_frame corner =
			frame_within(&side, 0.68f * half_m + 0.07f, -0.68f * half_m - 0.07f, 0, 0);
		float x = corner.turn[0], y = corner.turn[1];

		corner.turn[0] = eighth * (x - y);
		corner.turn[1] = eighth * (x + y);
		plan_antefix(plan, &axis, fmaxf(0.62f * half_m, 0.25f), high_m * 1.05f);
		if (temple_chance(plan->seed, plan->count, 13) >= 0.08f) /* not fallen */
			plan_antefix(plan, &corner, fmaxf(0.4f * half_m, 0.25f), high_m * 0.9f);
		for (int i = 0; roomy && i < 2; i++) {
			struct temple_frame beside = frame_within(
				&side, (i ? 0.55f : -0.55f) * half_m, -0.9f * half_m - 0.1f, 0, 0);

			if (temple_chance(plan->seed, plan->count, 14) >= 0.08f)
				plan_antefix(plan, &beside, fmaxf(0.26f * half_m, 0.25f),
					     high_m * 0.82f);
		}
	}
}

/* The storeys above the body, along the curve of a bud, and the lotus on top. */
static void plan_bud(struct plan *plan, const struct temple_frame *frame, float half_m,
		     float rise_m, uint32_t tiers)
{
	float z = 0, total = 0;

	for (uint32_t i = 0; i < tiers; i++)
		total += powf(0.86f, (float)i);
	for (uint32_t i = 0; i < tiers; i++) {
		float t = z / rise_m, half = half_m * 0.97f * (1 - 0.92f * powf(t, 1.85f));
		float high = rise_m * 0.82f * powf(0.86f, (float)i) / total;
		struct temple_frame at = frame_within(frame, 0, 0, z, 0);
		struct temple_frame deck = frame_within(frame, 0, 0, z + high * 0.92f, 0);
		plan_sheet(plan, &at, &outline_redented, &storey, half * 0.92f, half * 0.17f, high);
		plan_antefixes(plan, &deck, half * 0.97f, high * 0.72f);
		z += high;
	}
	struct temple_frame top = frame_within(frame, 0, 0, z, 0);
	struct sheet *lotus = plan_sheet(plan, &top, &outline_circle, &crown, 0.01f, half_m * 0.46f,
					 rise_m * 0.24f);
	lotus->interest = 1.6f;
	plan_body(plan, "lotus", plan->count - 1);
}

/* Devatas in the bays of the body, beside the porches. */
static void plan_bays(struct plan *plan, const struct temple_frame *frame, float half_m,
		      float body_m)
{
	for (int turn = 0; turn < 4; turn++) {
		struct temple_frame side = frame_within(frame, 0, 0, 0, turn);
		for (int i = 0; i < 4; i++) {
			float sign = i & 1 ? 1.0f : -1.0f, x = i < 2 ? 0.55f : 0.78f;
			float y = i < 2 ? 0.88f : 0.68f, width = half_m * (i < 2 ? 0.22f : 0.18f);
			struct temple_frame at = frame_within(
				&side, sign * x * half_m, -y * half_m - 0.02f, body_m * 0.12f, 0);
			plan_panel(plan, &at, width, body_m * 0.7f, RELIEF_DEVATA, 0.09f, 0)
				->interest = 2.6f;
		}
	}
}

void plan_tower(struct plan *plan, const struct temple_frame *frame, float half_m, float body_m,
		float top_m, uint32_t tiers)
{
	float foot_m = body_m * 0.2f, roof_m = body_m * 0.22f;
	struct temple_frame body = frame_within(frame, 0, 0, foot_m, 0);
	struct temple_frame under = frame_within(frame, 0, 0, foot_m + body_m, 0);
	struct temple_frame bud = frame_within(&under, 0, 0, roof_m, 0);

	plan_sheet(plan, frame, &outline_redented, &plinth, half_m, half_m * 0.16f, foot_m);
	plan_sheet(plan, &body, &outline_redented, &wall, half_m, 1, body_m);
	plan_sheet(plan, &under, &outline_redented, &cornice, half_m, half_m * 0.17f, roof_m);
	plan_bays(plan, &body, half_m, body_m);
	plan_antefixes(plan, &bud, half_m * 1.02f, body_m * 0.3f);
	plan_bud(plan, &bud, half_m, top_m - foot_m - body_m - roof_m, tiers);
}

void plan_face_tower(struct plan *plan, const struct temple_frame *frame, float half_m)
{
	float body_m = 3.2f, head_m = 3.1f;
	struct temple_frame head = frame_within(frame, 0, 0, body_m, 0);
	struct temple_frame neck = frame_within(&head, 0, 0, 0.5f, 0);
	struct temple_frame bud = frame_within(&head, 0, 0, head_m + 0.35f, 0);

	plan_sheet(plan, frame, &outline_redented, &wall, half_m, 1, body_m);
	plan_sheet(plan, &head, &outline_redented, &cornice, half_m, 0.42f, 0.55f);
	plan_sheet(plan, &neck, &outline_redented, &wall, half_m * 0.86f, 1, head_m - 0.2f);
	for (int turn = 0; turn < 4; turn++) {
		struct temple_frame face = frame_within(&neck, 0, 0, 0.1f, turn);
		face = frame_within(&face, 0, -half_m * 0.62f, 0, 0);
		struct sheet *sheet = plan_panel(plan, &face, head_m * 0.86f, head_m, RELIEF_FACE,
						 head_m * 0.42f, 0);
		sheet->interest = 3.4f;
		sheet->rim_m = 0.2f;
		plan_body(plan, "face", plan->count - 1);
	}
	plan_bud(plan, &bud, half_m * 0.8f, 3.6f, 3);
}

static void plan_gate(struct plan *plan, int turn)
{
	struct temple_frame gate = frame_at(0, 0, 0, turn);

	gate = frame_within(&gate, 0, -15.0f, 2.4f, 0);
	uint32_t tower = plan->count;
	plan_face_tower(plan, &gate, 1.7f);
	plan_refine(plan, tower, turn == 1 ? 1.4f : 1.0f);
	for (int side = 0; side < 4; side++) {
		uint32_t first = plan->count;
		struct temple_frame porch = frame_within(&gate, 0, 0, 0.1f, side);
		porch = frame_within(&porch, 0, -1.7f, 0, 0);
		plan_porch(plan, &porch, 1.05f, side & 1 ? 1.7f : 1.1f, 2.7f);
		if (side == 0 && turn < 2) /* the eastern and the southern door */
			plan_refine(plan, first, turn == 1 ? 2.1f : 1.7f);
	}
}

/* Stone doors on the two outer sides. */
static void plan_closed_doors(struct plan *plan, const struct temple_frame *tower, float half_m)
{
	for (int side = 0; side < 2; side++) {
		struct temple_frame door = frame_within(tower, 0, 0, 0.5f, side);
		door = frame_within(&door, 0, -half_m - 0.06f, 0, 0);
		plan_panel(plan, &door, 0.74f, 1.6f, RELIEF_DOOR, 0.1f, 0)->interest = 2;
		plan_doorway(plan, &door, 0.66f, 2.2f);
	}
}

void plan_towers(struct plan *plan)
{
	struct temple_frame middle = frame_at(0, 0, 8.2f, 0);
	struct temple_frame foot = frame_at(0, 0, 9.5f, 0);

	plan_sheet(plan, &middle, &outline_redented, &plinth, 3.9f, 0.4f, 1.3f);
	struct temple_frame deck = frame_at(0, 0, 9.48f, 0);
	plan_floor(plan, &deck, 3.4f, 3.4f, RELIEF_PLAIN, 0, 0);
	plan_tower(plan, &foot, 2.45f, 3.4f, 14.5f, 6);
	for (int turn = 0; turn < 4; turn++) {
		struct temple_frame side = frame_at(0, 0, 9.5f, turn);
		struct temple_frame porch = frame_within(&side, 0, -2.45f, 0.4f, 0);
		struct temple_frame steps = frame_within(&side, 0, -5.1f, -1.3f, 0);
		struct temple_frame corner = frame_at(0, 0, 8.2f, turn);
		corner = frame_within(&corner, 6.0f, -6.0f, 0, 0);
		struct temple_frame angle = frame_at(0, 0, 2.4f, turn);
		angle = frame_within(&angle, 15.0f, -15.0f, 0, 0);
		struct temple_frame high = frame_within(&porch, 0, -0.55f, 3.9f, 0);
		plan_porch(plan, &porch, 1.15f, 1.5f, 3.0f);
		plan_pediment(plan, &high, 3.6f, 2.3f);
		plan_stairs(plan, &steps, 0.7f, 1.2f, 1.3f);
		plan_tower(plan, &corner, 1.75f, 2.6f, 9.6f, 5);
		plan_tower(plan, &angle, 1.6f, 2.6f, 6.4f, 3);
		plan_closed_doors(plan, &angle, 1.6f);
		for (int door = 0; door < 4; door++) {
			struct temple_frame at = frame_within(&corner, 0, 0, 0.4f, door);
			at = frame_within(&at, 0, -1.75f, 0, 0);
			plan_porch(plan, &at, 0.8f, 0.75f, 2.2f);
		}
		plan_gate(plan, turn);
	}
}
