/* Basic carving shapes, the devata and the procession of walkers and elephants. */
#include "pipeline/temple/temple_figures.h"

#include <math.h>
#include <stddef.h>

#include "base/compiler.h"
#include "pipeline/temple/temple_carve.h"

static float limbs(float x, float y, const float (*list)[6], size_t count)
{
	float most = 0;

	for (size_t i = 0; i < count; i++)
		most = fmaxf(most, carve_limb(x, y, list[i]));
	return most;
}

static float disc(float x, float y, float cx, float cy, float rx, float ry)
{
	float d = (x - cx) * (x - cx) / (rx * rx) + (y - cy) * (y - cy) / (ry * ry);

	return d < 1 ? sqrtf(1 - d) : 0;
}

/* ---- a devata: slender, frontal, feet turned out, one hand raised with a lotus */

static const float devata_limbs[][6] = {
	{ 0, 0.615f, 0, 0.66f, 0.075f, 0.095f },         /* waist to chest */
	{ 0, 0.52f, 0, 0.60f, 0.098f, 0.07f },           /* hips */
	{ 0, 0.74f, 0, 0.78f, 0.028f, 0.03f },           /* neck */
	{ -0.10f, 0.705f, 0.10f, 0.705f, 0.04f, 0.04f }, /* shoulders */
	{ -0.125f, 0.70f, -0.165f, 0.56f, 0.034f, 0.027f },
	{ -0.165f, 0.56f, -0.14f, 0.42f, 0.026f, 0.022f },
	{ 0.125f, 0.70f, 0.175f, 0.57f, 0.034f, 0.027f },
	{ 0.175f, 0.57f, 0.13f, 0.70f, 0.025f, 0.022f },
	{ 0.13f, 0.70f, 0.155f, 0.80f, 0.012f, 0.012f }, /* lotus stem */
	{ 0.155f, 0.80f, 0.155f, 0.83f, 0.03f, 0.02f },
	{ -0.05f, 0.62f, -0.05f, 0.675f, 0.03f, 0.047f }, /* breasts */
	{ 0.05f, 0.62f, 0.05f, 0.675f, 0.03f, 0.047f },
	{ -0.04f, 0.07f, -0.11f, 0.055f, 0.026f, 0.026f }, /* feet */
	{ 0.04f, 0.07f, 0.11f, 0.055f, 0.026f, 0.026f },
};

static float devata_head(float x, float y)
{
	float face = 0.085f * disc(x, y, 0, 0.815f, 0.055f, 0.066f);
	float crown = 0;

	crown = fmaxf(crown, 0.075f * disc(x, y, 0, 0.868f, 0.07f, 0.03f));
	for (int i = -1; i <= 1; i++) {
		float limb[6] = {
			i * 0.045f, 0.875f, i * 0.066f, i ? 0.94f : 0.975f, 0.028f, 0.006f
		};
		crown = fmaxf(crown, carve_limb(x, y, limb) * 1.8f);
	}
	face = fmaxf(face, 0.03f * disc(fabsf(x), y, 0.066f, 0.785f, 0.016f, 0.035f));
	face -= 0.014f * disc(fabsf(x), y, 0.022f, 0.824f, 0.014f, 0.007f);
	face += 0.012f * disc(x, y, 0, 0.808f, 0.009f, 0.016f);
	return fmaxf(face, crown);
}

/* The long skirt: pleats, a flared hem, two hanging ends of the sash. */
static float devata_skirt(float x, float y)
{
	if (y < 0.06f || y > 0.56f)
		return 0;
	float down = (0.56f - y) / 0.5f, half = 0.098f + 0.03f * sinf(down * 2.6f) + 0.035f * down;
	float across = fabsf(x) / half;
	if (across > 1)
		return 0;
	float body = 0.085f * sqrtf(1 - across * across);
	float legs = 0.012f * cosf(x / half * 3.1416f * 2) * down;
	float pleats = 0.004f * cosf(x * 190);
	float sash = x > -0.03f && x < 0.03f ? 0.018f * (1 - down * 0.4f) : 0;
	float hem = carve_ridge(y - 0.085f, 0.02f) * 0.012f;
	float belt = carve_ridge(y - 0.54f, 0.022f) * 0.02f;
	return body - legs + pleats + sash + hem + belt;
}

float figure_devata(float x, float y, float aspect, uint32_t seed)
{
	float side = temple_chance(seed, 3, 5) < 0.5f ? -1.0f : 1.0f;
	float edge = aspect * 0.5f - fabsf(x);
	float arch_y = 0.80f + 0.17f * (1 - powf(fabsf(x) / (aspect * 0.5f), 1.6f));
	/* The niche: a frame of foliage with a lobed arch and a sunk ground. */
	float frame = y > arch_y || edge < 0.055f ? 0.62f : 0;
	float lip = fmaxf(y < arch_y ? carve_ridge(edge - 0.06f, 0.028f) : 0,
			  edge > 0.06f ? carve_ridge(y - arch_y, 0.03f) : 0);
	float leaf = frame > 0 ? 0.22f * sinf(x * 62) * sinf(y * 55) : 0;
	float pedestal = y < 0.045f ? 0.55f + 0.2f * cosf(x * 50) : 0;
	float body = limbs(x * side, y, devata_limbs, ARRAY_COUNT(devata_limbs));

	body = fmaxf(body, devata_skirt(x, y));
	body = fmaxf(body, devata_head(x, y)) * 9.5f;
	return fmaxf(fmaxf(frame + leaf, lip * 0.85f), fmaxf(pedestal, fminf(body, 1.15f)));
}

/* ---- a procession: registers of walkers, and now and then a rider on an elephant */

static float walker(float x, float y, uint32_t seed, uint32_t n)
{
	float stride = 0.10f + 0.05f * temple_chance(seed, n, 1);
	float arm = temple_chance(seed, n, 2), lean = 0.02f + 0.03f * temple_chance(seed, n, 3);
	const float body[][6] = {
		{ 0, 0.45f, -stride, 0.24f, 0.055f, 0.045f },
		{ -stride, 0.24f, -stride * 1.5f, 0.06f, 0.042f, 0.03f },
		{ 0, 0.45f, stride, 0.25f, 0.055f, 0.045f },
		{ stride, 0.25f, stride * 0.9f, 0.05f, 0.042f, 0.03f },
		{ 0, 0.44f, lean, 0.66f, 0.07f, 0.085f },
		{ lean, 0.80f, lean, 0.82f, 0.055f, 0.06f },
		{ lean, 0.86f, lean - 0.02f, 0.93f, 0.04f, 0.012f },
		{ lean, 0.68f, 0.14f, 0.54f + 0.1f * arm, 0.035f, 0.03f },
		{ 0.14f, 0.54f + 0.1f * arm, 0.20f, 0.64f + 0.1f * arm, 0.03f, 0.025f },
		{ lean, 0.68f, -0.13f, 0.52f, 0.035f, 0.028f },
		{ 0.20f, 0.30f, 0.20f + 0.05f * arm, 1.0f, 0.012f, 0.012f }, /* spear */
	};
	float h = limbs(x, y, body, ARRAY_COUNT(body)) * 9;
	float skirt = y > 0.28f && y < 0.48f && fabsf(x) < 0.06f + (0.48f - y) * 0.45f ? 0.55f : 0;

	if (temple_chance(seed, n, 4) < 0.3f) /* a round shield */
		h = fmaxf(h, 0.95f * carve_step(0.0f, 0.5f, disc(x, y, 0.1f, 0.55f, 0.13f, 0.15f)));
	return fmaxf(h, skirt);
}

static float elephant(float x, float y)
{
	static const float body[][6] = {
		{ -0.22f, 0.42f, 0.14f, 0.44f, 0.19f, 0.18f },
		{ -0.30f, 0.35f, -0.32f, 0.05f, 0.09f, 0.07f },
		{ -0.10f, 0.32f, -0.12f, 0.05f, 0.08f, 0.07f },
		{ 0.08f, 0.32f, 0.06f, 0.05f, 0.08f, 0.07f },
		{ 0.24f, 0.34f, 0.26f, 0.05f, 0.08f, 0.07f },
		{ 0.36f, 0.56f, 0.38f, 0.52f, 0.13f, 0.12f },
		{ 0.46f, 0.48f, 0.52f, 0.22f, 0.06f, 0.04f },
		{ 0.52f, 0.22f, 0.46f, 0.12f, 0.04f, 0.03f },
		{ 0.02f, 0.66f, 0.04f, 0.80f, 0.07f, 0.08f },
		{ 0.04f, 0.90f, 0.04f, 0.92f, 0.055f, 0.05f },
		{ 0.04f, 0.78f, 0.20f, 0.70f, 0.035f, 0.03f },
	};
	float ear = 0.12f * disc(x, y, 0.30f, 0.54f, 0.08f, 0.13f);

	return fmaxf(limbs(x, y, body, ARRAY_COUNT(body)), ear) * 6.5f;
}

static float register_of(float x, float y, uint32_t seed)
{
	float most = 0;
	int cell = (int)floorf(x / 0.42f);

	for (int n = cell - 1; n <= cell + 1; n++) {
		uint32_t id = (uint32_t)(n + 1000);
		float mid = ((float)n + 0.5f) * 0.42f;
		most = fmaxf(most, walker(x - mid, y, seed, id));
	}
	for (int n = (int)floorf(x / 3.36f) - 1; n <= (int)floorf(x / 3.36f) + 1; n++) {
		float mid =
			((float)n + 0.2f + 0.6f * temple_chance(seed, (uint32_t)(n + 1000), 9)) *
			3.36f;
		if (fabsf(x - mid) < 0.55f)
			most = fmaxf(elephant(x - mid, y), 0.35f * most);
	}
	return fminf(most, 1.0f);
}

float figure_march(float x_m, float y_m, float height_m, uint32_t seed)
{
	float rows = fmaxf(1.0f, roundf(height_m / 0.62f)), y = y_m / height_m * rows;
	float row = fminf(floorf(y), rows - 1);
	float up = (y - row),
	      line = fmaxf(carve_ridge(up - 0.0f, 0.035f), carve_ridge(up - 1.0f, 0.035f));

	return fmaxf(register_of(x_m / (height_m / rows), (up - 0.04f) / 0.92f,
				 seed + (uint32_t)row * 17),
		     0.7f * line);
}
