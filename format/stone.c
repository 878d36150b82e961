/* The C text below and the GLSL text at the end are the same function, line for line: a change of
 * one is a change of both. The hash is a permutation polynomial modulo 289, whose every
 * intermediate is an integer below 2^24. */
#include "format/stone.h"

#include <math.h>

static float mod289(float x)
{
	return x - floorf((x + 0.5f) * (1.0f / 289.0f)) * 289.0f;
}

static float permute(float x)
{
	float y = mod289(x);

	return mod289((34.0f * y + 1.0f) * y);
}

static float hash(float i, float j, float k)
{
	return permute(permute(permute(i) + mod289(j)) + mod289(k)) * (1.0f / 289.0f);
}

static float blend(float a, float b, float t)
{
	return a + (b - a) * t;
}

static float ramp(float from, float to, float x)
{
	float t = fminf(fmaxf((x - from) / (to - from), 0.0f), 1.0f);

	return t * t * (3.0f - 2.0f * t);
}

/* Value noise, 0..1; cells of 1 / (fx, fy, fz) metres. */
static float noise(const float p[3], float fx, float fy, float fz)
{
	float x = p[0] * fx, y = p[1] * fy, z = p[2] * fz;
	float i = floorf(x), j = floorf(y), k = floorf(z);
	float u = x - i, v = y - j, w = z - k;

	u = u * u * (3.0f - 2.0f * u);
	v = v * v * (3.0f - 2.0f * v);
	w = w * w * (3.0f - 2.0f * w);
	float a = permute(i), b = permute(i + 1.0f);
	float m = mod289(j), n = mod289(j + 1.0f);
	float aa = permute(a + m), ba = permute(b + m), ab = permute(a + n), bb = permute(b + n);
	float lo = mod289(k), hi = mod289(k + 1.0f);
	float low = blend(blend(permute(aa + lo), permute(ba + lo), u),
			  blend(permute(ab + lo), permute(bb + lo), u), v);
	float high = blend(blend(permute(aa + hi), permute(ba + hi), u),
			   blend(permute(ab + hi), permute(bb + hi), u), v);

	return blend(low, high, w) * (1.0f / 288.0f);
}

/* Detail of size 1 / frequency fades out as the footprint grows to it. */
static float kept(float frequency, float footprint_m)
{
	return fminf(fmaxf(1.6f - 1.6f * frequency * footprint_m, 0.0f), 1.0f);
}

static void mix3(float rgb[3], float r, float g, float b, float t)
{
	rgb[0] = blend(rgb[0], r, t);
	rgb[1] = blend(rgb[1], g, t);
	rgb[2] = blend(rgb[2], b, t);
}

void stone_colour(float rgb[3], const float p[3], const float n[3], float footprint_m)
{
	float f = footprint_m;
	float wide = noise(p, 0.31f, 0.31f, 0.31f), metre = noise(p, 1.3f, 1.3f, 1.3f);
	float hand = blend(0.5f, noise(p, 6.1f, 6.1f, 6.1f), kept(6.1f, f));
	float inch = blend(0.5f, noise(p, 23.0f, 23.0f, 23.0f), kept(23.0f, f));
	float grain = blend(0.5f, noise(p, 97.0f, 97.0f, 97.0f), kept(97.0f, f));
	float upward = ramp(0.35f, 0.85f, n[2]), upright = 1.0f - fminf(fabsf(n[2]), 1.0f);

	/* Courses of blocks: along the wall and up it; on a floor, both ways along it. */
	float along = fabsf(n[0]) > fabsf(n[1]) ? p[1] : p[0], up = p[2] * 2.3f;
	if (fabsf(n[2]) > 0.75f) {
		along = p[0];
		up = p[1] * 1.3f;
	}
	float row = floorf(up);
	float across = along * 1.17f + hash(row, 5.0f, 1.0f);
	float stone = floorf(across);
	float tone = hash(stone, row, 9.0f), tint = hash(row, stone, 23.0f);
	float edge = fminf(fminf(across - stone, stone + 1.0f - across) * 0.85f,
			   fminf(up - row, row + 1.0f - up) * 0.43f);
	float joint = (1.0f - ramp(0.003f, 0.014f, edge)) * kept(30.0f, f);

	/* Sandstone: ochre grey, some blocks pinker, some greener. */
	rgb[0] = 0.90f, rgb[1] = 0.80f, rgb[2] = 0.64f;
	mix3(rgb, 0.90f, 0.72f, 0.60f, ramp(0.55f, 0.95f, tint) * 0.7f);
	mix3(rgb, 0.74f, 0.74f, 0.61f, ramp(0.50f, 0.05f, tint) * 0.55f);
	mix3(rgb, 0.98f, 0.91f, 0.77f, ramp(0.45f, 0.75f, wide) * 0.5f);
	/* Laterite: the wall of the lowest terrace, red brown and full of holes. */
	float far = fmaxf(fabsf(p[0]), fabsf(p[1]));
	float red = ramp(17.4f, 17.6f, far) * ramp(2.05f, 1.95f, p[2] + 0.1f * hand) * upright;
	mix3(rgb, 0.66f, 0.40f, 0.25f, red * 0.85f);
	mix3(rgb, 0.24f, 0.13f, 0.09f, red * ramp(0.60f, 0.72f, inch) * 0.7f);

	float shade = 0.80f + 0.17f * tone + 0.16f * (metre - 0.5f) + 0.20f * (hand - 0.5f) +
		      0.16f * (inch - 0.5f) + 0.16f * (grain - 0.5f) + 0.10f * wide;
	rgb[0] *= shade, rgb[1] *= shade, rgb[2] *= shade;

	/* Black crust where water stands, dark runs where it falls. */
	float run = noise(p, 2.6f, 2.6f, 0.23f), thin = noise(p, 9.0f, 9.0f, 0.5f);
	float runs = ramp(0.50f, 0.78f,
			  run * 0.65f + thin * 0.35f * kept(9.0f, f) +
				  0.35f * (1.0f - kept(9.0f, f)) * 0.5f) *
		     upright;
	mix3(rgb, 0.19f, 0.175f, 0.155f, runs * 0.60f);
	float crust = upward * ramp(0.28f, 0.72f, metre * 0.6f + hand * 0.4f);
	mix3(rgb, 0.26f, 0.25f, 0.215f, crust * 0.62f);
	/* Lichen: grey green sheets, pale coins, a little orange. */
	float sheet = noise(p, 1.9f, 1.9f, 1.7f) * 0.7f + hand * 0.3f;
	mix3(rgb, 0.53f, 0.56f, 0.43f, ramp(0.56f, 0.70f, sheet) * 0.60f);
	float coin = noise(p, 4.3f, 4.7f, 4.1f) * 0.75f + inch * 0.25f;
	mix3(rgb, 0.80f, 0.79f, 0.69f, ramp(0.70f, 0.76f, coin) * 0.55f * kept(4.3f, f));
	mix3(rgb, 0.70f, 0.47f, 0.20f, ramp(0.25f, 0.21f, coin) * 0.45f * kept(4.3f, f));
	/* Moss and earth near the ground. */
	float low = ramp(1.3f, 0.0f, p[2] - 0.7f * metre);
	mix3(rgb, 0.33f, 0.35f, 0.19f, low * 0.35f * ramp(0.35f, 0.65f, hand));
	float earth = ramp(0.14f, 0.07f, p[2]) * ramp(0.3f, 0.6f, n[2]);
	mix3(rgb, 0.60f, 0.49f, 0.34f, earth * (0.35f + 0.45f * metre));
	float grass = ramp(0.46f, 0.60f, wide * 0.5f + metre * 0.35f + hand * 0.15f);
	mix3(rgb, 0.37f + 0.1f * inch, 0.41f + 0.1f * inch, 0.19f, earth * grass * 0.8f);

	float dark = 1.0f - (0.12f + 0.5f * metre * tone) * joint;
	rgb[0] *= dark, rgb[1] *= dark, rgb[2] *= dark;
}

const char stone_glsl[] =
	"float stone_mod289(float x) {\n"
	"return x - floor((x + 0.5) * (1.0 / 289.0)) * 289.0;\n"
	"}\n"
	"float stone_permute(float x) {\n"
	"float y = stone_mod289(x);\n"
	"return stone_mod289((34.0 * y + 1.0) * y);\n"
	"}\n"
	"float stone_hash(float i, float j, float k) {\n"
	"return stone_permute(stone_permute(stone_permute(i) + stone_mod289(j)) + stone_mod289(k)) *"
	" (1.0 / 289.0);\n"
	"}\n"
	"float stone_blend(float a, float b, float t) {\n"
	"return a + (b - a) * t;\n"
	"}\n"
	"float stone_ramp(float from, float to, float x) {\n"
	"float t = min(max((x - from) / (to - from), 0.0), 1.0);\n"
	"return t * t * (3.0 - 2.0 * t);\n"
	"}\n"
	"float stone_noise(vec3 p, float fx, float fy, float fz) {\n"
	"float x = p[0] * fx, y = p[1] * fy, z = p[2] * fz;\n"
	"float i = floor(x), j = floor(y), k = floor(z);\n"
	"float u = x - i, v = y - j, w = z - k;\n"
	"u = u * u * (3.0 - 2.0 * u);\n"
	"v = v * v * (3.0 - 2.0 * v);\n"
	"w = w * w * (3.0 - 2.0 * w);\n"
	"float a = stone_permute(i), b = stone_permute(i + 1.0);\n"
	"float m = stone_mod289(j), n = stone_mod289(j + 1.0);\n"
	"float aa = stone_permute(a + m), ba = stone_permute(b + m), ab = stone_permute(a + n), bb ="
	" stone_permute(b + n);\n"
	"float lo = stone_mod289(k), hi = stone_mod289(k + 1.0);\n"
	"float low = stone_blend(stone_blend(stone_permute(aa + lo), stone_permute(ba + lo), u),"
	" stone_blend(stone_permute(ab + lo), stone_permute(bb + lo), u), v);\n"
	"float high = stone_blend(stone_blend(stone_permute(aa + hi), stone_permute(ba + hi), u),"
	" stone_blend(stone_permute(ab + hi), stone_permute(bb + hi), u), v);\n"
	"return stone_blend(low, high, w) * (1.0 / 288.0);\n"
	"}\n"
	"float stone_kept(float frequency, float footprint_m) {\n"
	"return min(max(1.6 - 1.6 * frequency * footprint_m, 0.0), 1.0);\n"
	"}\n"
	"void stone_mix3(inout vec3 rgb, float r, float g, float b, float t) {\n"
	"rgb[0] = stone_blend(rgb[0], r, t);\n"
	"rgb[1] = stone_blend(rgb[1], g, t);\n"
	"rgb[2] = stone_blend(rgb[2], b, t);\n"
	"}\n"
	"vec3 stone_colour(vec3 p, vec3 n, float footprint_m) {\n"
	"vec3 rgb;\n"
	"float f = footprint_m;\n"
	"float wide = stone_noise(p, 0.31, 0.31, 0.31), metre = stone_noise(p, 1.3, 1.3, 1.3);\n"
	"float hand = stone_blend(0.5, stone_noise(p, 6.1, 6.1, 6.1), stone_kept(6.1, f));\n"
	"float inch = stone_blend(0.5, stone_noise(p, 23.0, 23.0, 23.0), stone_kept(23.0, f));\n"
	"float grain = stone_blend(0.5, stone_noise(p, 97.0, 97.0, 97.0), stone_kept(97.0, f));\n"
	"float upward = stone_ramp(0.35, 0.85, n[2]), upright = 1.0 - min(abs(n[2]), 1.0);\n"
	"float along = abs(n[0]) > abs(n[1]) ? p[1] : p[0], up = p[2] * 2.3;\n"
	"if (abs(n[2]) > 0.75) {\n"
	"along = p[0];\n"
	"up = p[1] * 1.3;\n"
	"}\n"
	"float row = floor(up);\n"
	"float across = along * 1.17 + stone_hash(row, 5.0, 1.0);\n"
	"float stone = floor(across);\n"
	"float tone = stone_hash(stone, row, 9.0), tint = stone_hash(row, stone, 23.0);\n"
	"float edge = min(min(across - stone, stone + 1.0 - across) * 0.85, min(up - row, row + 1.0"
	" - up) * 0.43);\n"
	"float joint = (1.0 - stone_ramp(0.003, 0.014, edge)) * stone_kept(30.0, f);\n"
	"rgb[0] = 0.90, rgb[1] = 0.80, rgb[2] = 0.64;\n"
	"stone_mix3(rgb, 0.90, 0.72, 0.60, stone_ramp(0.55, 0.95, tint) * 0.7);\n"
	"stone_mix3(rgb, 0.74, 0.74, 0.61, stone_ramp(0.50, 0.05, tint) * 0.55);\n"
	"stone_mix3(rgb, 0.98, 0.91, 0.77, stone_ramp(0.45, 0.75, wide) * 0.5);\n"
	"float far = max(abs(p[0]), abs(p[1]));\n"
	"float red = stone_ramp(17.4, 17.6, far) * stone_ramp(2.05, 1.95, p[2] + 0.1 * hand) *"
	" upright;\n"
	"stone_mix3(rgb, 0.66, 0.40, 0.25, red * 0.85);\n"
	"stone_mix3(rgb, 0.24, 0.13, 0.09, red * stone_ramp(0.60, 0.72, inch) * 0.7);\n"
	"float shade = 0.80 + 0.17 * tone + 0.16 * (metre - 0.5) + 0.20 * (hand - 0.5) + 0.16 *"
	" (inch - 0.5) + 0.16 * (grain - 0.5) + 0.10 * wide;\n"
	"rgb[0] *= shade, rgb[1] *= shade, rgb[2] *= shade;\n"
	"float run = stone_noise(p, 2.6, 2.6, 0.23), thin = stone_noise(p, 9.0, 9.0, 0.5);\n"
	"float runs = stone_ramp(0.50, 0.78, run * 0.65 + thin * 0.35 * stone_kept(9.0, f) + 0.35 *"
	" (1.0 - stone_kept(9.0, f)) * 0.5) * upright;\n"
	"stone_mix3(rgb, 0.19, 0.175, 0.155, runs * 0.60);\n"
	"float crust = upward * stone_ramp(0.28, 0.72, metre * 0.6 + hand * 0.4);\n"
	"stone_mix3(rgb, 0.26, 0.25, 0.215, crust * 0.62);\n"
	"float sheet = stone_noise(p, 1.9, 1.9, 1.7) * 0.7 + hand * 0.3;\n"
	"stone_mix3(rgb, 0.53, 0.56, 0.43, stone_ramp(0.56, 0.70, sheet) * 0.60);\n"
	"float coin = stone_noise(p, 4.3, 4.7, 4.1) * 0.75 + inch * 0.25;\n"
	"stone_mix3(rgb, 0.80, 0.79, 0.69, stone_ramp(0.70, 0.76, coin) * 0.55 * stone_kept(4.3, f));\n"
	"stone_mix3(rgb, 0.70, 0.47, 0.20, stone_ramp(0.25, 0.21, coin) * 0.45 * stone_kept(4.3, f));\n"
	"float low = stone_ramp(1.3, 0.0, p[2] - 0.7 * metre);\n"
	"stone_mix3(rgb, 0.33, 0.35, 0.19, low * 0.35 * stone_ramp(0.35, 0.65, hand));\n"
	"float earth = stone_ramp(0.14, 0.07, p[2]) * stone_ramp(0.3, 0.6, n[2]);\n"
	"stone_mix3(rgb, 0.60, 0.49, 0.34, earth * (0.35 + 0.45 * metre));\n"
	"float grass = stone_ramp(0.46, 0.60, wide * 0.5 + metre * 0.35 + hand * 0.15);\n"
	"stone_mix3(rgb, 0.37 + 0.1 * inch, 0.41 + 0.1 * inch, 0.19, earth * grass * 0.8);\n"
	"float dark = 1.0 - (0.12 + 0.5 * metre * tone) * joint;\n"
	"rgb[0] *= dark, rgb[1] *= dark, rgb[2] *= dark;\n"
	"return rgb;\n"
	"}\n";
