/* Carvings of doors and gables: lintel, pediment, false door, window and antefix. */
#include "pipeline/temple/temple_doors.h"

#include <math.h>

#include "pipeline/temple/temple_carve.h"

static float disc(float x, float y, float cx, float cy, float rx, float ry)
{
	float d = (x - cx) * (x - cx) / (rx * rx) + (y - cy) * (y - cy) / (ry * ry);

	return d < 1 ? sqrtf(1 - d) : 0;
}

static float limb(float x, float y, float ax, float ay, float bx, float by, float ra, float rb)
{
	const float list[6] = { ax, ay, bx, by, ra, rb };

	return carve_limb(x, y, list);
}

/* Curling leaves seen from the tip; they fill everything that is not a figure. */
static float foliage(float x, float y, float size)
{
	float cx = x / size, row = floorf(y / size), shift = fmodf(row, 2) == 0 ? 0.5f : 0;
	float u = cx + shift - floorf(cx + shift) - 0.5f, v = y / size - row - 0.5f;
	float r = hypotf(u, v), a = atan2f(v, u);
	float turns = r * 3.4f - a / 6.28319f;

	return r < 0.5f ? carve_ridge(turns - roundf(turns), 0.36f) * (1 - r) : 0;
}

/* ---- lintel: in the middle Kala devours a garland that sags and ends in makara heads */

static float kala(float x, float y)
{
	float ax = fabsf(x);
	float skull = 0.95f * disc(x, y, 0, 0.55f, 0.36f, 0.34f);
	float eyes = 0.5f * disc(ax, y, 0.15f, 0.63f, 0.1f, 0.09f);
	float brow = 0.3f * carve_ridge(y - 0.77f - 0.3f * (ax - 0.15f) * (0.15f - ax), 0.05f) *
		     carve_step(0.34f, 0.28f, ax);
	float nose = 0.35f * disc(x, y, 0, 0.5f, 0.1f, 0.09f);
	float jaw = y < 0.42f && y > 0.28f && ax < 0.3f
			    ? 0.55f + 0.35f * fabsf(sinf(x * 34)) /* teeth */
			    : 0;
	float claws = 0.8f * disc(ax, y, 0.42f, 0.34f, 0.09f, 0.14f);
	float crest = 1.1f * limb(x, y, 0, 0.85f, 0, 1.0f, 0.1f, 0.02f) / 0.1f * 0.7f;

	return fmaxf(fmaxf(skull + eyes + brow + nose, jaw), fmaxf(claws, crest)) * 0.8f;
}

/* A head turned outwards with a rolled-up trunk and a row of teeth, at the end of the garland. */
static float lintel_makara(float x, float y)
{
	float r = hypotf(x, y), a = atan2f(y, x), turns = r * 7.5f + a / 6.28319f;
	float head = 0.7f * disc(x, y, 0, 0, 0.21f, 0.25f);
	float trunk = r < 0.2f ? 0.4f * carve_ridge(turns - roundf(turns), 0.4f) : 0;
	float eye = 0.45f * disc(x, y, -0.05f, 0.16f, 0.05f, 0.05f);
	float crest = 0.6f * carve_ridge(r - 0.26f, 0.05f) * fabsf(sinf(a * 6));

	return fmaxf(fmaxf(head * 0.6f + trunk, eye), crest);
}

float figure_lintel(float x, float y, float aspect)
{
	float half = aspect * 0.5f, ax = fabsf(x) / half;
	float frame = fmaxf(carve_ridge(y - 0.03f, 0.045f), carve_ridge(y - 0.97f, 0.045f)) * 0.6f;
	float line = 0.60f - 0.16f * sinf(ax * 3.14159f * 1.5f) * (1 - 0.3f * ax);
	float garland = carve_ridge(y - line, 0.085f);
	float twist = 0.18f * sinf((fabsf(x) + y * 0.6f) * 60);
	float above = y > line ? 0.55f * foliage(fabsf(x), y - line, 0.30f) : 0;
	/* Pendants of leaves hang below the garland. */
	float pendant_x = ax * 3.5f, px = pendant_x - floorf(pendant_x) - 0.5f;
	float hang = y < line ? 0.6f * carve_ridge(px, 0.36f * carve_step(0.02f, 0.4f, y)) : 0;
	float vein = y < line ? 0.16f * cosf((y + fabsf(px)) * 75) : 0;
	float makara = lintel_makara(fabsf(x) - half + 0.24f, y - 0.42f);
	float rider =
		8 * fmaxf(limb(fabsf(x), y, half * 0.5f, 0.62f, half * 0.5f, 0.78f, 0.09f, 0.1f),
			  limb(fabsf(x), y, half * 0.5f, 0.9f, half * 0.5f, 0.92f, 0.07f, 0.06f));
	float carved = fmaxf(garland > 0 ? garland * 0.75f + twist : 0,
			     fmaxf(above, hang > 0 ? hang + vein : 0));

	carved = fmaxf(fmaxf(carved, makara), fmaxf(fminf(rider, 0.95f), kala(x, y)));
	return fminf(1.15f, fmaxf(frame, carved));
}

/* ---- pediment: flames along a naga's body, a deity on his mount, two rows of worshippers */

static float worshipper(float x, float y, float size)
{
	float u = x / size, v = y / size;
	float body = fmaxf(limb(u, v, 0, 0.22f, 0, 0.5f, 0.2f, 0.17f),
			   limb(u, v, 0, 0.72f, 0, 0.74f, 0.12f, 0.12f));
	float arms = limb(u, v, -0.17f, 0.5f, 0.02f, 0.44f, 0.06f, 0.05f);
	float knees = limb(u, v, -0.25f, 0.1f, 0.25f, 0.1f, 0.11f, 0.11f);
	float crown = limb(u, v, 0, 0.82f, 0, 0.98f, 0.08f, 0.02f);

	return 4.2f * fmaxf(fmaxf(body, arms), fmaxf(knees, crown));
}

static float deity(float x, float y)
{
	float body = fmaxf(limb(x, y, 0, 0.36f, 0, 0.50f, 0.055f, 0.075f),
			   limb(x, y, 0, 0.60f, 0, 0.61f, 0.05f, 0.05f));
	float knees = limb(x, y, -0.14f, 0.33f, 0.14f, 0.33f, 0.045f, 0.045f);
	float arms = fmaxf(limb(fabsf(x), y, 0.07f, 0.50f, 0.14f, 0.42f, 0.03f, 0.025f),
			   limb(fabsf(x), y, 0.14f, 0.42f, 0.12f, 0.54f, 0.025f, 0.02f));
	float crown = limb(x, y, 0, 0.65f, 0, 0.74f, 0.035f, 0.008f);
	/* The three-headed elephant below. */
	float mount = fmaxf(1.3f * limb(x, y, 0, 0.2f, 0, 0.22f, 0.09f, 0.08f),
			    limb(fabsf(x), y, 0.13f, 0.2f, 0.14f, 0.2f, 0.07f, 0.06f));
	float trunks = fmaxf(limb(x, y, 0, 0.2f, 0, 0.07f, 0.05f, 0.025f),
			     limb(fabsf(x), y, 0.15f, 0.18f, 0.2f, 0.07f, 0.04f, 0.02f));

	return 9.5f * fmaxf(fmaxf(fmaxf(body, knees), fmaxf(arms, crown)), fmaxf(mount, trunks));
}

float figure_tympanum(float x, float y, float aspect, float shape)
{
	float edge = aspect * 0.5f * shape - fabsf(x), border = 0.07f;
	float floor = carve_ridge(y - 0.025f, 0.03f);
	float along = y * 16 + fabsf(x) * 4, leaf = along - floorf(along) - 0.5f;

	if (edge < border) /* the rim of flames */
		return 0.55f + 0.35f * carve_ridge(leaf, 0.45f) * carve_ridge(edge - 0.035f, 0.04f);
	if (edge < border + 0.075f) { /* the naga's body, ringed */
		float round = carve_ridge(edge - border - 0.0375f, 0.0375f);
		return 0.4f + 0.6f * round + 0.07f * cosf(along * 25);
	}
	float god = deity(x, y);
	float rows = 0;
	for (int row = 0; row < 2; row++) {
		float size = row ? 0.16f : 0.2f, base = row ? 0.27f : 0.05f,
		      first = row ? 0.2f : 0.28f;
		float u = (fabsf(x) - first) / (size * 0.62f), whole = roundf(u);
		if (whole >= 0)
			rows = fmaxf(rows, worshipper((u - whole) * size * 0.62f, y - base, size));
	}
	float leaves = 0.3f * foliage(x, y, 0.13f);
	return fminf(1.05f, fmaxf(fmaxf(floor * 0.7f, leaves), fmaxf(god, fminf(rows, 0.75f))));
}

/* ---- false door: two leaves and the bar between, as in wood, all of stone */

float figure_door(float x, float y, float aspect)
{
	float ax = fabsf(x), half = aspect * 0.5f, edge = fminf(half - ax, fminf(y, 1 - y));
	float knob = y * 9 - floorf(y * 9) - 0.5f;

	if (edge < 0.05f) /* mitred frame mouldings */
		return 0.75f + 0.25f * cosf(edge * 250);
	if (ax < 0.05f) { /* the bar with its bosses */
		float boss = knob * knob / 0.12f + x * x / 0.0018f;
		return 0.55f + (boss < 1 ? 0.42f * sqrtf(1 - boss) : 0) +
		       0.08f * carve_ridge(ax - 0.044f, 0.006f);
	}
	float px = (ax - 0.05f) / (half - 0.10f), inset = fminf(px, 1 - px) * (half - 0.10f);
	if (inset < 0.03f || edge < 0.08f)
		return 0.35f + 0.12f * carve_ridge(inset - 0.015f, 0.01f);
	float cy = (y - 0.08f) / 0.84f * 5, v = cy - floorf(cy) - 0.5f, u = px - 0.5f;
	float r = hypotf(u, v) * 2, a = atan2f(v, u);
	float rose =
		r < 0.78f ? 0.34f * sqrtf(1 - r / 0.78f) * (0.6f + 0.4f * fabsf(cosf(4 * a))) : 0;
	return fmaxf(rose, 0.16f * foliage(px - 0.5f, v, 0.33f));
}

/* ---- window: a moulded frame and an odd number of balusters, turned like wood */

float figure_window(float x, float y, float aspect)
{
	float half = aspect * 0.5f, edge = fminf(half - fabsf(x), fminf(y, 1 - y));
	const float frame = 0.13f;

	if (edge < frame)
		return 0.78f + 0.16f * cosf(edge * 120) + (edge < 0.02f ? 0.06f : 0);
	float inner = 2 * (half - frame);
	float count = fmaxf(3.0f, 2 * roundf((inner / 0.15f - 1) * 0.5f) + 1);
	float u = (x / inner + 0.5f) * count;
	float across = (u - floorf(u) - 0.5f) * inner / count;
	float t = fabsf(y - 0.5f) / (0.5f - frame);
	float rings = 0.010f * cosf(t * 38) + 0.012f * carve_ridge(t - 0.33f, 0.07f) +
		      0.014f * carve_ridge(t - 0.72f, 0.06f) + (t > 0.9f ? 0.012f : 0);
	return 0.05f + 0.72f * carve_ridge(across, 0.048f + rings);
}

/* ---- antefix: flames within flames around a small seated figure */

float figure_flame(float x, float y, float aspect, float shape)
{
	float half = aspect * 0.5f * shape, across = half > 0.01f ? fabsf(x) / half : 1;
	float rim = 0.5f + 0.2f * cosf((y * 9 + across * 2) * 6.28319f);
	float shell = carve_step(1.0f, 0.72f, across) * (0.5f + 0.25f * (1 - y));

	if (across > 0.72f)
		return rim * carve_step(1.05f, 0.9f, across) + 0.1f;
	float ring = 0.85f * carve_ridge(across - 0.6f, 0.1f);
	float figure = 1.7f * fmaxf(worshipper(x, y - 0.12f, 0.5f) / 4.2f * 3.5f, 0.0f);
	return fmaxf(fmaxf(shell * 0.6f, ring), fminf(figure, 1.0f));
}
