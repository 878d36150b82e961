/* Computes the direction of the raking light and its shading, in GLSL and in C. */
#include "render/lumigraph/raking_light.h"

#include <math.h>

#include "base/compiler.h"
#include "geometry/light.h"
#include "geometry/vec.h"

#define AMBIENT 0.22
#define DIRECT  1.30 /* keeps a wall facing the eye bright at the lowest light */
/* Below this light the scan's pictures hold little but noise. */
#define BAKED_MIN    0.3
#define STRING_OF(x) #x
#define STRING(x)    STRING_OF(x)

void rake_place(struct rake *rake, float right, float up)
{
	const float far = sqrtf(right * right + up * up), scale = far > 1 ? 1 / far : 1;

	rake->at[0] = right * scale;
	rake->at[1] = up * scale;
}

void rake_direction(const struct rake *rake, const float right[3], const float up[3],
		    const float forward[3], float towards[3])
{
	const float far = fminf(sqrtf(rake->at[0] * rake->at[0] + rake->at[1] * rake->at[1]), 1);
	const float elevation =
		(RAKE_HIGH_DEG + far * (RAKE_LOW_DEG - RAKE_HIGH_DEG)) * (float)M_PI / 180;
	/* Exactly in the middle the light comes from above, as is natural. */
	const float x = far > 1e-4f ? rake->at[0] / far : 0,
		    y = far > 1e-4f ? rake->at[1] / far : 1;

	for (int k = 0; k < 3; k++)
		towards[k] =
			cosf(elevation) * (x * right[k] + y * up[k]) - sinf(elevation) * forward[k];
}

/* The light that was baked into the colours is divided out, as far as the mesh knows it. What the
 * pictures have beyond it (finer relief and the colours of the material itself) stays. Half of the
 * sky's share stays as well: joints and corners are dark in any light. */
const char rake_vertex_glsl[] =
	"vec4 rake_of(vec3 normal, float open, vec4 sun) {\n"
	"	float baked = sun.w > 0.5 ? light(normal, open, sun.xyz) : 1.0;\n"
	"	return vec4(normal, (0.5 + 0.5 * open) / max(baked, " STRING(BAKED_MIN) "));\n"
											"}\n";
const char rake_fragment_glsl[] =
	"float rake_light(vec4 of, vec3 towards) {\n"
	"	float facing = max(0.0, dot(normalize(of.xyz), towards));\n"
	"	return (" STRING(AMBIENT) " + " STRING(DIRECT) " * facing) * of.w;\n"
							       "}\n";

float rake_light_at(const float normal[3], float open, const float sun[3], bool lit,
		    const float towards[3])
{
	const float baked = lit ? fmaxf(light_at(normal, open, sun), (float)BAKED_MIN) : 1;
	const float facing = fmaxf(0, vec_dot(normal, towards));

	return ((float)AMBIENT + (float)DIRECT * facing) * (0.5f + 0.5f * open) / baked;
}
