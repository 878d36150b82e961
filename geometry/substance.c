/* The substances, written once in what C and GLSL have in common: IN_BOTH compiles its text as C
 * and keeps it for the GLSL compiler. The Makefile compiles this file with constants of single
 * precision, as GLSL has them. */
#include "geometry/substance.h"

#include <math.h>
#include <string.h>

#include "geometry/noise.h"

struct colour {
	float x, y, z;
};

vector_inline struct colour substance_rgb(float r, float g, float b)
{
	return (struct colour){ r, g, b };
}

#define SUBSTANCE vector_inline
#define vec3      struct colour
#define sqrt      sqrtf
#define floor     floorf
#define abs       fabsf

#define GLSL_HEAD                                                                                  \
	"#define SUBSTANCE\n"                                                                      \
	"vec3 substance_rgb(float r, float g, float b) { return vec3(r, g, b); }\n"
#define IN_BOTH(...)                                                                               \
	__VA_ARGS__                                                                                \
	const char substance_glsl[] = GLSL_HEAD #__VA_ARGS__ "\n";

/* Frequencies are per metre, so a feature has the size that it has in the real stone. What is finer
 * than the footprint is left at its mean. */
/* clang-format off */
IN_BOTH(
SUBSTANCE vec3 substance_mix(vec3 a, vec3 b, float t)
{
	return substance_rgb(noise_blend(a.x, b.x, t), noise_blend(a.y, b.y, t), noise_blend(a.z, b.z, t));
}

SUBSTANCE float substance_detail(float x, float y, float z, float frequency, float footprint)
{
	float noise = noise_at(x * frequency, y * frequency, z * frequency);
	return noise_blend(0.5, noise, noise_kept(frequency, footprint));
}

SUBSTANCE float substance_ridge(float x)
{
	return abs(2.0 * (x - floor(x)) - 1.0);
}

SUBSTANCE float substance_octaves(float x, float y, float z, float frequency, float footprint)
{
	return 0.533 * substance_detail(x, y, z, frequency, footprint)
		+ 0.267 * substance_detail(x, y, z, frequency * 2.03, footprint)
		+ 0.133 * substance_detail(x, y, z, frequency * 4.09, footprint)
		+ 0.067 * substance_detail(x, y, z, frequency * 8.17, footprint);
}

SUBSTANCE vec3 marble_colour(float x, float y, float z, float footprint)
{
	float bent = substance_octaves(x, y, z, 2.1, footprint);
	float wave = substance_ridge(1.3 * x + 0.7 * y + 1.1 * z + 2.9 * bent);
	float thin = substance_octaves(z, x, y, 5.3, footprint);
	float other = substance_ridge(2.2 * y - 1.6 * z + 0.9 * x + 2.5 * thin);
	float vein = noise_blend(0.11, noise_ramp(0.22, 0.0, wave), noise_kept(45.0, footprint));
	float hair = noise_blend(0.045, noise_ramp(0.09, 0.0, other), noise_kept(160.0, footprint));
	float cloud = substance_octaves(y, z, x, 1.3, footprint);
	vec3 rgb = substance_mix(substance_rgb(0.93, 0.92, 0.90), substance_rgb(0.80, 0.81, 0.82), cloud);
	rgb = substance_mix(rgb, substance_rgb(0.46, 0.48, 0.52), vein * (0.35 + 0.5 * thin));
	return substance_mix(rgb, substance_rgb(0.58, 0.53, 0.46), hair * 0.6);
}

SUBSTANCE vec3 wood_colour(float x, float y, float z, float footprint)
{
	float bent = substance_octaves(x, y, z * 0.25, 2.3, footprint);
	float fromx = x + 0.21 + 0.10 * (bent - 0.5);
	float fromy = y - 0.13 + 0.08 * (noise_at(x * 1.9, y * 1.9, z * 0.7) - 0.5);
	float rings = sqrt(fromx * fromx + fromy * fromy) * 90.0;
	float ring = rings - floor(rings);
	float late = noise_ramp(0.3, 0.85, ring) * noise_ramp(1.0, 0.8, ring);
	float fibre = noise_at(x * 700.0, y * 700.0, z * 9.0);
	late = noise_blend(0.31, late, noise_kept(190.0, footprint));
	fibre = noise_blend(0.5, fibre, noise_kept(700.0, footprint));
	vec3 rgb = substance_mix(substance_rgb(0.70, 0.50, 0.30), substance_rgb(0.42, 0.25, 0.13), late);
	return substance_mix(rgb, substance_rgb(0.34, 0.20, 0.11), 0.45 * fibre * (0.5 + bent));
}

SUBSTANCE vec3 sandstone_colour(float x, float y, float z, float footprint)
{
	float level = z + 0.09 * (substance_octaves(x, y, z, 1.7, footprint) - 0.5) + 0.06 * x;
	float bed = substance_detail(0.5, 0.5, level, 17.0, footprint);
	float lamina = substance_detail(0.5, 7.5, level, 83.0, footprint);
	float grain = substance_detail(x, y, z, 420.0, footprint);
	float stain = substance_octaves(x, y, z, 2.9, footprint);
	float shade = 0.93 + 0.16 * (lamina - 0.5) + 0.20 * (grain - 0.5);
	vec3 rgb = substance_mix(substance_rgb(0.90, 0.78, 0.60), substance_rgb(0.80, 0.62, 0.44), noise_ramp(0.35, 0.75, bed));
	rgb = substance_mix(rgb, substance_rgb(0.72, 0.46, 0.30), 0.5 * noise_ramp(0.55, 0.75, stain));
	return substance_mix(substance_rgb(0.0, 0.0, 0.0), rgb, shade);
}

SUBSTANCE vec3 laterite_colour(float x, float y, float z, float footprint)
{
	float lump = substance_octaves(x, y, z, 11.0, footprint);
	float pore = noise_ramp(0.38, 0.24, noise_at(x * 61.0, y * 61.0, z * 61.0));
	float small = noise_ramp(0.32, 0.22, noise_at(y * 140.0, z * 140.0, x * 140.0));
	pore = noise_blend(0.17, pore, noise_kept(130.0, footprint));
	small = noise_blend(0.12, small, noise_kept(280.0, footprint));
	float crust = substance_octaves(z, x, y, 31.0, footprint);
	vec3 rgb = substance_mix(substance_rgb(0.58, 0.28, 0.17), substance_rgb(0.74, 0.45, 0.25), noise_ramp(0.3, 0.7, lump));
	rgb = substance_mix(rgb, substance_rgb(0.84, 0.62, 0.36), 0.5 * noise_ramp(0.55, 0.75, crust));
	rgb = substance_mix(rgb, substance_rgb(0.24, 0.11, 0.08), 0.8 * pore);
	return substance_mix(rgb, substance_rgb(0.28, 0.13, 0.09), 0.6 * small);
}
)
/* clang-format on */

#define MANY(name)                                                                                 \
	vector_clones static void many_##name(float *const rgb[3], const float *const at_m[3],     \
					      const float *footprint_m, uint32_t count)            \
	{                                                                                          \
		const float *x = at_m[0], *y = at_m[1], *z = at_m[2];                              \
		float *r = rgb[0], *g = rgb[1], *b = rgb[2];                                       \
                                                                                                   \
		_Pragma("GCC ivdep") for (uint32_t i = 0; i < count; i++)                          \
		{                                                                                  \
			struct colour c = name##_colour(x[i], y[i], z[i], footprint_m[i]);         \
                                                                                                   \
			r[i] = c.x;                                                                \
			g[i] = c.y;                                                                \
			b[i] = c.z;                                                                \
		}                                                                                  \
	}

MANY(marble)
MANY(wood)
MANY(sandstone)
MANY(laterite)

const char *const substance_names[SUBSTANCE_KINDS] = { "none", "marble", "wood", "sandstone",
						       "laterite" };

enum substance_kind substance_named(const char *name)
{
	int kind = 0;

	while (kind < SUBSTANCE_KINDS && strcmp(name, substance_names[kind]) != 0)
		kind++;
	return (enum substance_kind)kind;
}

void substance_colours(float *const rgb[3], enum substance_kind kind, const float *const at_m[3],
		       const float *footprint_m, uint32_t count)
{
	switch (kind) {
	case SUBSTANCE_MARBLE:
		many_marble(rgb, at_m, footprint_m, count);
		break;
	case SUBSTANCE_WOOD:
		many_wood(rgb, at_m, footprint_m, count);
		break;
	case SUBSTANCE_SANDSTONE:
		many_sandstone(rgb, at_m, footprint_m, count);
		break;
	case SUBSTANCE_LATERITE:
		many_laterite(rgb, at_m, footprint_m, count);
		break;
	default:
		break;
	}
}

void substance_colour(float rgb[3], enum substance_kind kind, const float position_m[3],
		      float footprint_m)
{
	float *const out[3] = { &rgb[0], &rgb[1], &rgb[2] };
	const float *const at_m[3] = { &position_m[0], &position_m[1], &position_m[2] };

	substance_colours(out, kind, at_m, &footprint_m, 1);
}
