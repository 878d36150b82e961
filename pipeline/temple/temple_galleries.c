/* Lays out the galleries: a moulded base, walls or rows of pillars, and a vault of carved roof
 * stones with a crest. */
#include "pipeline/temple/temple_galleries.h"

#include <math.h>

#include "pipeline/temple/temple_carve.h"

static const struct profile_point base_points[] = {
	{ 1.0f, 0, RELIEF_PLAIN, 0, 0 },        { 1.0f, 0.3f, RELIEF_PETALS, 0.04f, 0.16f },
	{ 0.5f, 0.6f, RELIEF_ROUND, 0.04f, 0 }, { 0.5f, 0.85f, RELIEF_PLAIN, 0, 0 },
	{ 0.2f, 1.0f, RELIEF_PLAIN, 0, 0 },     { -1.5f, 1.0f, RELIEF_PLAIN, 0, 0 },
};
static const struct temple_profile base = { ARRAY_COUNT(base_points), base_points };

/* From the front eave over the ridge to the back eave. */
static const struct profile_point vault_points[] = {
	{ 0.86f, -0.10f, RELIEF_PLAIN, 0, 0 },        { 1.0f, 0.0f, RELIEF_PETALS, 0.05f, 0.22f },
	{ 0.98f, 0.13f, RELIEF_TILES, 0.13f, 0.5f },  { 0.92f, 0.38f, RELIEF_TILES, 0.13f, 0.5f },
	{ 0.76f, 0.66f, RELIEF_TILES, 0.13f, 0.5f },  { 0.48f, 0.87f, RELIEF_TILES, 0.13f, 0.5f },
	{ 0.10f, 0.99f, RELIEF_ROUND, 0.05f, 0 },     { -0.10f, 0.99f, RELIEF_TILES, 0.13f, 0.5f },
	{ -0.48f, 0.87f, RELIEF_TILES, 0.13f, 0.5f }, { -0.76f, 0.66f, RELIEF_TILES, 0.13f, 0.5f },
	{ -0.92f, 0.38f, RELIEF_TILES, 0.13f, 0.5f }, { -0.98f, 0.13f, RELIEF_DROPS, 0.05f, 0.22f },
	{ -1.0f, 0.0f, RELIEF_PLAIN, 0, 0 },          { -0.86f, -0.10f, RELIEF_PLAIN, 0, 0 },
};
static const struct temple_profile vault = { ARRAY_COUNT(vault_points), vault_points };

/* The inside of the vault, seen from below. */
static const struct profile_point ceiling_points[] = {
	{ -0.80f, -0.1f, RELIEF_PLAIN, 0, 0 }, { -0.72f, 0.35f, RELIEF_PLAIN, 0, 0 },
	{ 0.0f, 0.88f, RELIEF_PLAIN, 0, 0 },   { 0.72f, 0.35f, RELIEF_PLAIN, 0, 0 },
	{ 0.80f, -0.1f, RELIEF_PLAIN, 0, 0 },
};
static const struct temple_profile ceiling = { ARRAY_COUNT(ceiling_points), ceiling_points };

static const struct profile_point pillar_points[] = {
	{ 1.0f, 0, RELIEF_PLAIN, 0, 0 },
	{ 1.0f, 0.05f, RELIEF_PETALS, 0.025f, 0.12f },
	{ 0.3f, 0.11f, RELIEF_PLAIN, 0, 0 },
	{ 0.0f, 0.13f, RELIEF_SCROLL_UP, 0.02f, 0.3f },
	{ 0.0f, 0.30f, RELIEF_PLAIN, 0, 0 },
	{ 0.0f, 0.84f, RELIEF_BEADS, 0.02f, 0.07f },
	{ 0.3f, 0.87f, RELIEF_DROPS, 0.025f, 0.12f },
	{ 1.0f, 0.95f, RELIEF_PLAIN, 0, 0 },
	{ 1.0f, 1.0f, RELIEF_PLAIN, 0, 0 },
};
static const struct temple_profile pillar = { ARRAY_COUNT(pillar_points), pillar_points };

static const struct profile_point beam_points[] = {
	{ 0.0f, 0, RELIEF_PLAIN, 0, 0 },
	{ 1.0f, 0, RELIEF_SCROLL, 0.03f, 0.4f },
	{ 1.0f, 0.55f, RELIEF_BEADS, 0.025f, 0.07f },
	{ 1.0f, 0.72f, RELIEF_DROPS, 0.04f, 0.16f },
	{ 1.6f, 1.0f, RELIEF_PLAIN, 0, 0 },
	{ 0.0f, 1.0f, RELIEF_PLAIN, 0, 0 },
};
static const struct temple_profile beam = { ARRAY_COUNT(beam_points), beam_points };

/* A row of small leaves on the ridge; 12 % of them have fallen. */
static void plan_crest(struct plan *plan, const struct temple_frame *middle, float length_m,
		       float z_m)
{
	int count = (int)(length_m / 0.5f);

	for (int i = 0; i < count; i++) {
		if (temple_chance(plan->seed, plan->count, 11u + (uint32_t)i) < 0.12f)
			continue;
		float x = ((float)i + 0.5f) / (float)count * length_m - length_m * 0.5f;
		for (int side = 0; side < 2; side++) {
			struct temple_frame foot =
				frame_within(middle, x, side ? 0.04f : -0.04f, z_m, side ? 2 : 0);
			struct sheet *leaf =
				plan_panel(plan, &foot, 0.36f, 0.5f, RELIEF_FLAME, 0.05f, 0);
			leaf->shape = SHAPE_LEAF;
			leaf->rim_m = 0.05f;
			leaf->interest = 1.8f;
		}
	}
}

static void plan_colonnade(struct plan *plan, const struct temple_frame *row, float length_m,
			   float height_m)
{
	int count = (int)fmaxf(2, roundf(length_m / 1.35f) + 1);
	struct temple_frame above = frame_within(row, 0, 0, height_m - 0.34f, 0);

	for (int i = 0; i < count; i++) {
		float x = ((float)i / (float)(count - 1) - 0.5f) * (length_m - 0.5f);
		struct temple_frame foot = frame_within(row, x, 0, 0, 0);
		struct sheet *sheet = plan_sheet(plan, &foot, &outline_square, &pillar, 0.15f,
						 0.06f, height_m - 0.34f);
		sheet->interest = 1.3f;
		sheet->optional = true;
	}
	struct sheet *lintel =
		plan_sheet(plan, &above, &outline_square, &beam, length_m * 0.5f, 0.06f, 0.36f);
	lintel->stretch = 0.34f / length_m;
}

/* The front wall: windows and devatas alternate, with a frieze above. */
static void plan_front(struct plan *plan, const struct temple_frame *wall,
		       const struct gallery *gallery)
{
	int count = (int)fmaxf(1, roundf(gallery->length_m / 1.5f));
	float step = gallery->length_m / (float)count, height = gallery->wall_m;
	struct temple_frame frieze = frame_within(wall, 0, -0.02f, height - 0.3f, 0);

	plan_panel(plan, &frieze, gallery->length_m, 0.3f, RELIEF_SCROLL, 0.04f, 0.5f)->rim_m = 0;
	for (int i = 0; i < count; i++) {
		float x = ((float)i + 0.5f) * step - gallery->length_m * 0.5f;
		if (i % 2 == 0) {
			struct temple_frame at = frame_within(wall, x, -0.10f, height * 0.22f, 0);
			plan_panel(plan, &at, fminf(1.3f, step * 0.95f), height * 0.56f,
				   RELIEF_WINDOW, 0.16f, 0)
				->interest = 1.8f;
		} else {
			struct temple_frame at = frame_within(wall, x, -0.03f, height * 0.16f, 0);
			plan_panel(plan, &at, fminf(0.72f, step * 0.8f), height * 0.66f,
				   RELIEF_DEVATA, 0.12f, 0)
				->interest = 2.4f;
		}
	}
}

static void plan_vault(struct plan *plan, const struct temple_frame *frame,
		       const struct gallery *gallery)
{
	float rise = gallery->half_m * 1.25f;
	struct temple_frame eave = frame_within(frame, 0, 0, gallery->wall_m, 0);
	struct sheet *roof = plan_sheet(plan, &eave, &outline_line, &vault,
					gallery->length_m + 0.2f, gallery->half_m + 0.32f, rise);

	roof->interest = 0.95f;
	plan_sheet(plan, &eave, &outline_line, &ceiling, gallery->length_m, gallery->half_m + 0.3f,
		   rise);
	plan_crest(plan, &eave, gallery->length_m, rise * 0.97f);
}

void plan_gallery(struct plan *plan, const struct temple_frame *frame,
		  const struct gallery *gallery)
{
	float foot_m = 0.38f, half = gallery->half_m, wall = gallery->wall_m - foot_m;
	struct temple_frame floor = frame_within(frame, 0, 0, foot_m, 0);
	struct temple_frame back = frame_within(&floor, 0, half - 0.15f, 0, 0);
	struct temple_frame inside = frame_within(&floor, 0, half - 0.32f, 0.25f, 0);
	struct temple_frame court = frame_within(&floor, 0, half + 0.01f, 0, 2);
	struct temple_frame row = frame_within(&floor, 0, -half + 0.2f, 0, 0);
	struct temple_frame front = frame_within(&floor, 0, -half, 0, 0);
	struct gallery inner = *gallery;

	struct sheet *foot = plan_sheet(plan, frame, &outline_square, &base,
					gallery->length_m * 0.5f, 0.16f, foot_m);
	foot->stretch = half / (gallery->length_m * 0.5f);
	foot->optional = true;
	plan_floor(plan, &floor, gallery->length_m * 0.5f, half - 0.1f, RELIEF_PLAIN, 0, 0);
	plan_box(plan, &back, gallery->length_m * 0.5f, 0.15f, wall);
	inner.wall_m = wall;
	plan_front(plan, &court, &inner);
	if (gallery->open) {
		plan_colonnade(plan, &row, gallery->length_m, wall);
		if (gallery->reliefs)
			plan_panel(plan, &inside, gallery->length_m - 0.2f, wall - 0.45f,
				   RELIEF_MARCH, 0.07f, 0)
				->interest = 2.6f;
	} else {
		struct temple_frame outer = frame_within(&floor, 0, -half + 0.15f, 0, 0);
		plan_box(plan, &outer, gallery->length_m * 0.5f, 0.15f, wall);
		plan_front(plan, &front, &inner);
	}
	plan_vault(plan, frame, gallery);
}

void plan_galleries(struct plan *plan)
{
	for (int turn = 0; turn < 4; turn++) {
		struct temple_frame side = frame_at(0, 0, 0, turn);
		for (int half = -1; half <= 1; half += 2) {
			struct gallery outer = { 10.7f, 1.15f, 2.75f, true, true, false };
			struct temple_frame at =
				frame_within(&side, (float)half * 8.55f, -15.0f, 2.4f, 0);
			uint32_t first = plan->count;
			plan_gallery(plan, &at, &outer);
			plan_refine(plan, first, turn == 0 && half == 1 ? 1.25f : 0.9f);
		}
		struct gallery upper = { 9.1f, 0.85f, 2.3f, false, false, true };
		struct temple_frame at = frame_within(&side, 0, -6.2f, 8.2f, 0);
		uint32_t first = plan->count;
		plan_gallery(plan, &at, &upper);
		plan_refine(plan, first, turn == 0 ? 1.4f : 1.0f);
	}
}
