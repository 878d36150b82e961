/* Carvings of heads: the smiling face, the lion mask and the naga hood. */
#include "pipeline/temple/temple_heads.h"

#include <math.h>

#include "pipeline/temple/temple_carve.h"

static float bump(float x, float y, float cx, float cy, float rx, float ry)
{
	float dx = (x - cx) / rx, dy = (y - cy) / ry;

	return expf(-(dx * dx + dy * dy));
}

/* ---- a face in the style of the Bayon: closed mouth, wide lips, lowered lids, a diadem */

static float face_skull(float x, float y)
{
	float half = 0.385f - 0.55f * fmaxf(0.0f, 0.28f - y) * (0.28f - y) / 0.28f * 2.2f;
	float across = fabsf(x) / fmaxf(half, 0.05f);
	float up = y < 0.5f ? (0.5f - y) / 0.62f : (y - 0.5f) / 0.75f;
	float round = 1 - 0.42f * up * up;

	if (across >= 1 || y < 0.03f)
		return 0;
	return 0.62f * round * powf(1 - across * across, 0.36f) * carve_step(0.03f, 0.13f, y);
}

static float face_eye(float ax, float y)
{
	float curve = 0.495f + 0.02f * cosf((ax - 0.16f) * 11);
	float ball = 0.07f * bump(ax, y, 0.165f, 0.487f, 0.085f, 0.04f);
	float lid = 0.030f * carve_ridge(y - curve - 0.028f, 0.012f);
	float under = 0.022f * carve_ridge(y - (0.462f - 0.02f * cosf((ax - 0.16f) * 12)), 0.01f);
	float almond = carve_step(0.115f, 0.085f, fabsf(ax - 0.165f));
	float socket = -0.085f * bump(ax, y, 0.155f, 0.50f, 0.12f, 0.055f);

	return socket + ball + (lid + under) * almond;
}

static float face_nose(float ax, float y)
{
	float down = (0.58f - y) / 0.22f;
	float width = 0.036f + 0.048f * fmaxf(0.0f, down) * fmaxf(0.0f, down);
	float bridge = down > -0.1f && down < 1.0f
			       ? carve_ridge(ax, width) * (0.05f + 0.115f * fmaxf(down, 0.0f))
			       : 0;
	float tip = 0.12f * bump(ax, y, 0, 0.385f, 0.05f, 0.035f);
	float wing = 0.085f * bump(ax, y, 0.068f, 0.375f, 0.03f, 0.026f);
	float nostril = -0.05f * bump(ax, y, 0.035f, 0.353f, 0.022f, 0.012f);

	return fmaxf(bridge, tip) + wing + nostril;
}

static float face_mouth(float ax, float y)
{
	float smile = 0.262f + 0.85f * ax * ax; /* corners turned up */
	float end = carve_step(0.225f, 0.17f, ax);
	float bow = 0.02f * (1 - carve_step(0.0f, 0.05f, ax));
	float upper = 0.082f * carve_ridge(y - smile - 0.027f + bow * 0.5f, 0.033f);
	float lower = 0.092f * carve_ridge(y - smile + 0.030f, 0.038f * (1 - 1.5f * ax));
	float line = -0.06f * carve_ridge(y - smile, 0.007f);
	float dimple = -0.035f * bump(ax, y, 0.235f, 0.30f, 0.03f, 0.035f);

	return (fmaxf(upper, lower) + line) * end + dimple;
}

/* Above the brow: a beaded band, a row of leaves, and hair drawn up into the crown. */
static float face_diadem(float x, float y)
{
	float curve = y - 0.72f - 0.02f * cosf(x * 5);
	float band = 0;

	if (curve < -0.012f)
		return 0;
	float leaf_x = x * 11 - floorf(x * 11) - 0.5f;
	if (curve < 0.05f)
		band = 0.10f + 0.035f * carve_ridge(leaf_x * 0.09f, 0.036f) *
				       carve_ridge(curve - 0.022f, 0.022f) * 2;
	else if (curve < 0.15f)
		band = 0.06f + 0.06f * fmaxf(0.0f, 1 - fabsf(leaf_x) * 2 - (curve - 0.05f) * 8);
	else
		band = 0.05f + 0.025f * cosf(x * 60);
	return band;
}

static float face_ear(float ax, float y)
{
	float lobe = 0.16f * bump(ax, y, 0.405f, 0.36f, 0.035f, 0.2f);
	float ring = 0.10f * bump(ax, y, 0.41f, 0.16f, 0.04f, 0.05f);
	float hollow = -0.07f * bump(ax, y, 0.41f, 0.44f, 0.016f, 0.09f);

	return lobe + ring + hollow;
}

float figure_face(float x, float y, float aspect)
{
	float ax = fabsf(x), edge = aspect * 0.5f - ax;
	float h = face_skull(x, y);
	float brow_y = 0.562f + 0.035f * cosf((ax - 0.15f) * 9);

	h += 0.05f * carve_ridge(y - brow_y, 0.03f) * carve_step(0.34f, 0.26f, ax);
	h += face_eye(ax, y) + face_nose(ax, y) + face_mouth(ax, y);
	h += 0.05f * bump(ax, y, 0.21f, 0.34f, 0.1f, 0.09f); /* cheeks */
	h += 0.075f * bump(ax, y, 0, 0.125f, 0.1f, 0.055f);  /* chin */
	h += face_diadem(x, y) * carve_step(0.0f, 0.08f, edge);
	h = fmaxf(h, face_ear(ax, y) + 0.12f);
	/* The blocks it is built of: open joints, courses of a sixth of the face. */
	float course = y * 6.5f, row = floorf(course);
	float stone = x * 4.2f + 0.5f * fmodf(row, 2);
	float joint = fminf(fminf(course - row, row + 1 - course) / 6.5f,
			    fabsf(stone - roundf(stone)) / 4.2f);
	return h - 0.035f * (1 - carve_step(0.0f, 0.008f, joint));
}

/* ---- a lion: round eyes, a broad muzzle with teeth, curls all around */

float figure_lion(float x, float y)
{
	float ax = fabsf(x), cy = y - 0.5f, r = hypotf(x, cy), a = atan2f(cy, x);
	float head = r < 0.5f ? 0.62f * sqrtf(1 - r * r * 4) : 0;
	float curl_r = (r - 0.36f) / 0.07f, curl_a = a * 2.2f;
	float curls = r > 0.32f && r < 0.5f ? 0.14f * fabsf(sinf(curl_a * 3.14159f)) *
						      carve_ridge(curl_r - roundf(curl_r), 0.5f)
					    : 0;
	float eyes = 0.13f * carve_ridge(hypotf(ax - 0.14f, y - 0.6f), 0.075f);
	float brow = 0.09f * carve_ridge(y - 0.70f - 0.5f * (ax - 0.14f) * (0.14f - ax), 0.035f) *
		     carve_step(0.28f, 0.22f, ax);
	float muzzle = 0.34f * bump(ax, y, 0.0f, 0.40f, 0.2f, 0.13f);
	float nose = 0.10f * bump(x, y, 0, 0.47f, 0.07f, 0.05f);
	float mouth = -0.16f * carve_ridge(y - 0.315f - 0.3f * ax * ax, 0.028f) *
		      carve_step(0.24f, 0.18f, ax);
	float teeth = y < 0.335f && y > 0.295f && ax < 0.17f ? 0.07f * fabsf(sinf(x * 52)) : 0;
	float ears = 0.2f * bump(ax, y, 0.33f, 0.83f, 0.07f, 0.08f);

	/* Outside the mane the surface falls back into the body. */
	return head + curls + eyes + brow + muzzle + nose + mouth + teeth + ears -
	       0.75f * carve_step(0.43f, 0.56f, r);
}

/* ---- the naga's hood: seven heads rising from one throat, the middle one highest */

static float naga_head(float x, float y, float size)
{
	float crown = carve_ridge(x, 0.5f * size) * carve_step(1.5f * size, 0.6f * size, y);
	float snout = 0.9f * bump(x, y, 0, 0.1f * size, 0.3f * size, 0.35f * size);
	float eyes =
		0.35f * bump(fabsf(x), y, 0.24f * size, 0.45f * size, 0.09f * size, 0.09f * size);
	float jaw = -0.35f * carve_ridge(y + 0.08f * size, 0.06f * size) *
		    carve_step(0.4f * size, 0.2f * size, fabsf(x));
	float below = carve_step(-0.5f * size, -0.2f * size, y);

	return (crown * 0.7f + snout + eyes + jaw) * below;
}

float figure_hood(float x, float y, float aspect)
{
	float most = 0.25f;
	const float root[2] = { 0, 0.12f };

	(void)aspect;
	for (int i = -3; i <= 3; i++) {
		float angle = (float)i * 0.33f, reach = 0.72f - 0.045f * (float)(i * i) * 0.6f;
		float dx = sinf(angle), dy = cosf(angle);
		float tip[2] = { root[0] + dx * reach, root[1] + dy * reach };
		float along = (x - root[0]) * dx + (y - root[1]) * dy;
		float across = (x - root[0]) * dy - (y - root[1]) * dx;
		float neck = along > 0 && along < reach
				     ? carve_ridge(across, 0.045f + 0.07f * along) *
					       (0.55f + 0.08f * cosf(along * 70))
				     : 0;
		float head = naga_head((x - tip[0]) * dy - (y - tip[1]) * dx,
				       (x - tip[0]) * dx + (y - tip[1]) * dy, 0.155f);
		most = fmaxf(most, fmaxf(neck, head));
	}
	float throat = 0.75f * carve_ridge(x, 0.13f) * carve_step(0.62f, 0.3f, y);
	float plates = 0.06f * cosf(y * 75);
	return fmaxf(most, throat > 0 ? throat + plates : 0);
}
