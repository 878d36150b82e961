/* The lighting formula of light.h twice, in GLSL and in C. Both must stay equal. */
#include "geometry/light.h"

const char light_glsl[] =
	"float light(vec3 normal, float open, vec3 sun) {\n"
	"	return open * (0.36 + 0.20 * normal.z)\n"
	"	     + 0.62 * max(0.0, dot(normal, sun)) * (0.35 + 0.65 * open);\n"
	"}\n";

float light_at(const float normal[3], float open, const float sun[3])
{
	float facing = normal[0] * sun[0] + normal[1] * sun[1] + normal[2] * sun[2];

	if (facing < 0)
		facing = 0;
	return open * (0.36f + 0.20f * normal[2]) + 0.62f * facing * (0.35f + 0.65f * open);
}
