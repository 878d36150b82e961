/* The weathered stone in C and, at the end, in GLSL. Both are the same function line for line: a
 * change of one is a change of both. Its noise is geometry/noise.h. */
#include "pipeline/material/material.h"

#include <math.h>
#include <stdbool.h>

#include "base/compiler.h"
#include "geometry/noise.h"

vector_inline void mix3(float rgb[3], float r, float g, float b, float t)
{
	rgb[0] = noise_blend(rgb[0], r, t);
	rgb[1] = noise_blend(rgb[1], g, t);
	rgb[2] = noise_blend(rgb[2], b, t);
}

/* Returns noise of one frequency, which fades to its mean where the footprint is too coarse for
 * it. */
vector_inline float detail(const float p[3], float frequency, float footprint_m)
{
	return noise_blend(0.5f, noise_value(p, frequency, frequency, frequency),
			   noise_kept(frequency, footprint_m));
}

/* Courses of blocks: along a wall and up it; on a floor, both ways along it. Writes for the block:
 * tone, tint, the share of a joint here, and the distance from the joint's middle (metres or
 * more). */
vector_inline void block_at(float block[4], const float p[3], const float n[3], float footprint_m)
{
	bool floor_like = fabsf(n[2]) > 0.75f, along_y = !floor_like & (fabsf(n[0]) > fabsf(n[1]));
	float along = along_y ? p[1] : p[0], up = floor_like ? p[1] * 1.3f : p[2] * 2.3f;
	float row = floorf(up);
	float across = along * 1.17f + noise_hash(row, 5.0f, 1.0f);
	float stone = floorf(across);
	float edge = noise_at_most(noise_at_most(across - stone, stone + 1.0f - across) * 0.85f,
				   noise_at_most(up - row, row + 1.0f - up) * 0.43f);

	block[0] = noise_hash(stone, row, 9.0f);
	block[1] = noise_hash(row, stone, 23.0f);
	block[2] = (1.0f - noise_ramp(0.003f, 0.014f, edge)) * noise_kept(30.0f, footprint_m);
	block[3] = edge;
}

/* Everything but the finest detail; inch and grain are its noises. */
vector_inline void paint(float rgb[3], const float p[3], const float n[3], float footprint_m,
			 const float block[4], float inch, float grain)
{
	float wide = noise_value(p, 0.31f, 0.31f, 0.31f), metre = noise_value(p, 1.3f, 1.3f, 1.3f);
	float hand = detail(p, 6.1f, footprint_m), tone = block[0], tint = block[1];
	float upward = noise_ramp(0.35f, 0.85f, n[2]),
	      upright = 1.0f - noise_at_most(fabsf(n[2]), 1.0f);

	/* Sandstone: ochre grey, some blocks pinker, some greyer. */
	rgb[0] = 0.90f, rgb[1] = 0.785f, rgb[2] = 0.61f;
	mix3(rgb, 0.90f, 0.72f, 0.565f, noise_ramp(0.60f, 0.95f, tint) * 0.6f);
	mix3(rgb, 0.77f, 0.735f, 0.62f, noise_ramp(0.45f, 0.05f, tint) * 0.6f);
	mix3(rgb, 0.97f, 0.88f, 0.70f, noise_ramp(0.45f, 0.75f, wide) * 0.6f);
	/* Laterite: the wall of the lowest terrace, red brown and full of holes. */
	float far = noise_at_least(fabsf(p[0]), fabsf(p[1]));
	float red = noise_ramp(17.4f, 17.6f, far) * noise_ramp(2.05f, 1.95f, p[2] + 0.1f * hand) *
		    upright;
	mix3(rgb, 0.68f, 0.41f, 0.26f, red * 0.85f);
	mix3(rgb, 0.27f, 0.15f, 0.10f, red * noise_ramp(0.60f, 0.72f, inch) * 0.7f);

	float shade = 0.94f + 0.11f * tone + 0.14f * (metre - 0.5f) + 0.16f * (hand - 0.5f) +
		      0.15f * (inch - 0.5f) + 0.15f * (grain - 0.5f) + 0.08f * wide;
	rgb[0] *= shade, rgb[1] *= shade, rgb[2] *= shade;

	/* Black crust where water stands, dark runs where it falls. */
	float run = noise_value(p, 2.6f, 2.6f, 0.23f), thin = noise_value(p, 9.0f, 9.0f, 0.5f);
	float fine = noise_kept(9.0f, footprint_m);
	float flow = run * 0.65f + noise_blend(0.5f, thin, fine) * 0.35f;
	mix3(rgb, 0.23f, 0.205f, 0.175f, noise_ramp(0.52f, 0.80f, flow) * upright * 0.60f);
	float crust = upward * noise_ramp(0.30f, 0.74f, metre * 0.6f + hand * 0.4f);
	mix3(rgb, 0.33f, 0.31f, 0.26f, crust * 0.46f);
	/* Lichen: grey green sheets, pale coins, a little orange. */
	float sheet = wide * 0.35f + metre * 0.35f + hand * 0.3f;
	mix3(rgb, 0.62f, 0.63f, 0.50f, noise_ramp(0.52f, 0.72f, sheet) * 0.50f);
	float coin = noise_value(p, 4.3f, 4.7f, 4.1f) * 0.75f + inch * 0.25f;
	float seen = noise_kept(4.3f, footprint_m);
	mix3(rgb, 0.86f, 0.84f, 0.73f, noise_ramp(0.71f, 0.77f, coin) * 0.5f * seen);
	mix3(rgb, 0.76f, 0.50f, 0.21f, noise_ramp(0.24f, 0.20f, coin) * 0.4f * seen);
	/* Moss and earth near the ground. */
	float low = noise_ramp(1.3f, 0.0f, p[2] - 0.7f * metre);
	mix3(rgb, 0.36f, 0.38f, 0.20f, low * 0.35f * noise_ramp(0.35f, 0.65f, hand));
	float earth = noise_ramp(0.14f, 0.07f, p[2]) * noise_ramp(0.3f, 0.6f, n[2]);
	mix3(rgb, 0.72f, 0.59f, 0.42f, earth * (0.35f + 0.45f * metre));
	float grass = noise_ramp(0.46f, 0.60f, wide * 0.5f + metre * 0.35f + hand * 0.15f);
	mix3(rgb, 0.40f + 0.1f * inch, 0.44f + 0.1f * inch, 0.21f, earth * grass * 0.8f);

	float dark = 1.0f - (0.12f + 0.5f * metre * tone) * block[2];
	rgb[0] *= dark, rgb[1] *= dark, rgb[2] *= dark;
}

void material_colour(float rgb[3], const float p[3], const float n[3], float footprint_m)
{
	float block[4];

	block_at(block, p, n, footprint_m);
	paint(rgb, p, n, footprint_m, block, detail(p, 23.0f, footprint_m),
	      detail(p, 97.0f, footprint_m));
}

/* ---- many places at once, in loops that the compiler turns into vector instructions */

vector_clones void material_details(float *out, const struct material_places *places,
				    float frequency)
{
	const float *x = places->x, *restrict y = places->y, *restrict z = places->z;
	const float *footprint = places->footprint_m;

#pragma GCC ivdep
	for (uint32_t i = 0; i < places->count; i++) {
		const float p[3] = { x[i], y[i], z[i] };

		out[i] = detail(p, frequency, footprint[i]);
	}
}

vector_clones void material_blocks(const struct material_blocks *out,
				   const struct material_places *places)
{
	const float *x = places->x, *restrict y = places->y, *restrict z = places->z;
	const float *nx = places->normal_x, *restrict ny = places->normal_y;
	const float *nz = places->normal_z, *restrict footprint = places->footprint_m;
	float *tone = out->tone, *restrict tint = out->tint;
	float *joint = out->joint, *restrict edge_m = out->edge_m;

#pragma GCC ivdep
	for (uint32_t i = 0; i < places->count; i++) {
		const float p[3] = { x[i], y[i], z[i] }, n[3] = { nx[i], ny[i], nz[i] };
		float block[4];

		block_at(block, p, n, footprint[i]);
		tone[i] = block[0];
		tint[i] = block[1];
		joint[i] = block[2];
		edge_m[i] = block[3];
	}
}

vector_clones void material_paints(float *const rgb[3], const struct material_places *places,
				   const struct material_blocks *blocks, const float *inch,
				   const float *grain)
{
	const float *x = places->x, *restrict y = places->y, *restrict z = places->z;
	const float *nx = places->normal_x, *restrict ny = places->normal_y;
	const float *nz = places->normal_z, *restrict footprint = places->footprint_m;
	const float *tone = blocks->tone, *restrict tint = blocks->tint;
	const float *joint = blocks->joint;
	float *r = rgb[0], *restrict g = rgb[1], *restrict b = rgb[2];

#pragma GCC ivdep
	for (uint32_t i = 0; i < places->count; i++) {
		const float p[3] = { x[i], y[i], z[i] }, n[3] = { nx[i], ny[i], nz[i] };
		const float block[4] = { tone[i], tint[i], joint[i], 0 };
		float colour[3];

		paint(colour, p, n, footprint[i], block, inch[i], grain[i]);
		r[i] = colour[0];
		g[i] = colour[1];
		b[i] = colour[2];
	}
}

const char material_glsl[] =
	"void material_mix3(inout vec3 rgb, float r, float g, float b, float t) {\n"
	"rgb[0] = noise_blend(rgb[0], r, t);\n"
	"rgb[1] = noise_blend(rgb[1], g, t);\n"
	"rgb[2] = noise_blend(rgb[2], b, t);\n"
	"}\n"
	"float material_detail(vec3 p, float frequency, float footprint_m) {\n"
	"float share = noise_kept(frequency, footprint_m);\n"
	"if (share <= 0.0) return 0.5;\n"
	"return noise_blend(0.5, noise_value(p, frequency, frequency, frequency), share);\n"
	"}\n"
	"vec4 material_block(vec3 p, vec3 n, float footprint_m) {\n"
	"float along = abs(n[0]) > abs(n[1]) ? p[1] : p[0], up = p[2] * 2.3;\n"
	"if (abs(n[2]) > 0.75) {\n"
	"along = p[0];\n"
	"up = p[1] * 1.3;\n"
	"}\n"
	"float row = floor(up);\n"
	"float across = along * 1.17 + noise_hash(row, 5.0, 1.0);\n"
	"float stone = floor(across);\n"
	"float edge = min(min(across - stone, stone + 1.0 - across) * 0.85, min(up - row,"
	" row + 1.0 - up) * 0.43);\n"
	"return vec4(noise_hash(stone, row, 9.0), noise_hash(row, stone, 23.0), (1.0 -"
	" noise_ramp(0.003, 0.014, edge)) * noise_kept(30.0, footprint_m), edge);\n"
	"}\n"
	"vec3 material_paint(vec3 p, vec3 n, float footprint_m, vec4 block, float inch, float grain) {\n"
	"vec3 rgb;\n"
	"float wide = noise_value(p, 0.31, 0.31, 0.31), metre = noise_value(p, 1.3, 1.3,"
	" 1.3);\n"
	"float hand = material_detail(p, 6.1, footprint_m), tone = block[0], tint = block[1];\n"
	"float upward = noise_ramp(0.35, 0.85, n[2]), upright = 1.0 - min(abs(n[2]), 1.0);\n"
	"rgb[0] = 0.90, rgb[1] = 0.785, rgb[2] = 0.61;\n"
	"material_mix3(rgb, 0.90, 0.72, 0.565, noise_ramp(0.60, 0.95, tint) * 0.6);\n"
	"material_mix3(rgb, 0.77, 0.735, 0.62, noise_ramp(0.45, 0.05, tint) * 0.6);\n"
	"material_mix3(rgb, 0.97, 0.88, 0.70, noise_ramp(0.45, 0.75, wide) * 0.6);\n"
	"float far = max(abs(p[0]), abs(p[1]));\n"
	"float red = noise_ramp(17.4, 17.6, far) * noise_ramp(2.05, 1.95, p[2] + 0.1 * hand)"
	" * upright;\n"
	"material_mix3(rgb, 0.68, 0.41, 0.26, red * 0.85);\n"
	"material_mix3(rgb, 0.27, 0.15, 0.10, red * noise_ramp(0.60, 0.72, inch) * 0.7);\n"
	"float shade = 0.94 + 0.11 * tone + 0.14 * (metre - 0.5) + 0.16 * (hand - 0.5) +"
	" 0.15 * (inch - 0.5) + 0.15 * (grain - 0.5) + 0.08 * wide;\n"
	"rgb[0] *= shade, rgb[1] *= shade, rgb[2] *= shade;\n"
	"float run = noise_value(p, 2.6, 2.6, 0.23), thin = noise_value(p, 9.0, 9.0, 0.5);\n"
	"float fine = noise_kept(9.0, footprint_m);\n"
	"float flow = run * 0.65 + noise_blend(0.5, thin, fine) * 0.35;\n"
	"material_mix3(rgb, 0.23, 0.205, 0.175, noise_ramp(0.52, 0.80, flow) * upright * 0.60);\n"
	"float crust = upward * noise_ramp(0.30, 0.74, metre * 0.6 + hand * 0.4);\n"
	"material_mix3(rgb, 0.33, 0.31, 0.26, crust * 0.46);\n"
	"float sheet = wide * 0.35 + metre * 0.35 + hand * 0.3;\n"
	"material_mix3(rgb, 0.62, 0.63, 0.50, noise_ramp(0.52, 0.72, sheet) * 0.50);\n"
	"float coin = noise_value(p, 4.3, 4.7, 4.1) * 0.75 + inch * 0.25;\n"
	"float seen = noise_kept(4.3, footprint_m);\n"
	"material_mix3(rgb, 0.86, 0.84, 0.73, noise_ramp(0.71, 0.77, coin) * 0.5 * seen);\n"
	"material_mix3(rgb, 0.76, 0.50, 0.21, noise_ramp(0.24, 0.20, coin) * 0.4 * seen);\n"
	"float low = noise_ramp(1.3, 0.0, p[2] - 0.7 * metre);\n"
	"material_mix3(rgb, 0.36, 0.38, 0.20, low * 0.35 * noise_ramp(0.35, 0.65, hand));\n"
	"float earth = noise_ramp(0.14, 0.07, p[2]) * noise_ramp(0.3, 0.6, n[2]);\n"
	"material_mix3(rgb, 0.72, 0.59, 0.42, earth * (0.35 + 0.45 * metre));\n"
	"float grass = noise_ramp(0.46, 0.60, wide * 0.5 + metre * 0.35 + hand * 0.15);\n"
	"material_mix3(rgb, 0.40 + 0.1 * inch, 0.44 + 0.1 * inch, 0.21, earth * grass * 0.8);\n"
	"float dark = 1.0 - (0.12 + 0.5 * metre * tone) * block[2];\n"
	"rgb[0] *= dark, rgb[1] *= dark, rgb[2] *= dark;\n"
	"return rgb;\n"
	"}\n"
	"vec3 material_colour(vec3 p, vec3 n, float footprint_m) {\n"
	"return material_paint(p, n, footprint_m, material_block(p, n, footprint_m), material_detail(p,"
	" 23.0, footprint_m), material_detail(p, 97.0, footprint_m));\n"
	"}\n";
