/* The formulas of appearance.h twice, in GLSL and in C. Both must stay equal. */
#include "geometry/appearance.h"

#include <math.h>

#include "geometry/light.h"
#include "geometry/vec.h"

const char appearance_glsl[] =
	"float highlight(vec3 n, vec3 to_eye, vec3 sun, float shininess) {\n"
	"	float facing = clamp(4.0 * dot(n, sun), 0.0, 1.0);\n"
	"	float along = max(dot(n, normalize(sun + to_eye)), 0.0001);\n"
	"	return facing * pow(along, shininess);\n"
	"}\n";

const char appearance_fog_glsl[] =
	"float fog_share(float d, bool is_exponential) {\n"
	"	float share = min(d, 1.0);\n"
	"	return is_exponential ? 1.0 - exp(-share / max(1.0 - share, 0.0001)) : share;\n"
	"}\n";

static float highlight(const float normal[3], const float to_eye[3], const float sun[3],
		       float shininess)
{
	const float facing = vec_least(vec_most(4 * vec_dot(normal, sun), 0), 1);
	float half[3];

	vec_add(half, sun, to_eye);
	vec_normalise(half);
	return facing * powf(vec_most(vec_dot(normal, half), 0.0001f), shininess);
}

void appearance_colour(float rgb[3], const struct scenery_material *material,
		       const float surface[3], const float normal[3], const float to_eye[3],
		       const struct appearance_sun *sun)
{
	const float light = sun->is_lit ? light_at(normal, 1, sun->towards) : 1;
	const float shine = highlight(normal, to_eye, sun->towards, material->shininess);

	for (int k = 0; k < 3; k++)
		rgb[k] = vec_least(surface[k] * light + (float)material->emissive[k] / 255 +
					   (float)material->specular[k] / 255 * shine,
				   1);
}

float appearance_fog(float distance_m, float range_m, bool is_exponential)
{
	const float share = vec_least(distance_m / range_m, 1);

	return is_exponential ? 1 - expf(-share / vec_most(1 - share, 0.0001f)) : share;
}
