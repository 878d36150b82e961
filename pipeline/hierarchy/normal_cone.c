/* Bounds the normals of a patch by a cone. */
#include "pipeline/hierarchy/normal_cone.h"

#include <math.h>

static void triangle_normal(double out[3], const struct patch_mesh *patch, uint32_t t)
{
	const int32_t *at[3];
	double u[3], v[3], length;

	for (int corner = 0; corner < 3; corner++)
		at[corner] = patch->vertices[patch->indices[3 * t + (uint32_t)corner]].position;
	for (int i = 0; i < 3; i++) {
		u[i] = at[1][i] - at[0][i];
		v[i] = at[2][i] - at[0][i];
	}
	for (int i = 0; i < 3; i++)
		out[i] = u[(i + 1) % 3] * v[(i + 2) % 3] - u[(i + 2) % 3] * v[(i + 1) % 3];
	length = sqrt(out[0] * out[0] + out[1] * out[1] + out[2] * out[2]);
	for (int i = 0; i < 3; i++)
		out[i] = length > 0.0 ? out[i] / length : 0.0;
}

void normal_cone_bound(struct hierarchy_patch *out, const struct patch_mesh *patch)
{
	double axis[3] = { 0.0, 0.0, 0.0 }, normal[3], length, least = 1.0;

	for (uint32_t t = 0; t < patch->triangle_count; t++) {
		triangle_normal(normal, patch, t);
		for (int i = 0; i < 3; i++)
			axis[i] += normal[i];
	}
	length = sqrt(axis[0] * axis[0] + axis[1] * axis[1] + axis[2] * axis[2]);
	for (int i = 0; i < 3; i++)
		out->cone_axis[i] = length > 1e-9 ? (float)(axis[i] / length) : (i == 2);
	for (uint32_t t = 0; t < patch->triangle_count; t++) {
		double dot = 0.0;

		triangle_normal(normal, patch, t);
		for (int i = 0; i < 3; i++)
			dot += out->cone_axis[i] * normal[i];
		least = fmin(least, dot);
	}
	out->cone_cos = length > 1e-9 ? (float)fmax(-1.0, least - 1e-6) : -1.0f;
}
