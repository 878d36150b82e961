/* Computes the reference cell, the reference depth and the projection rows for a piece and a
 * face. */
#include "render/lumigraph/aim.h"

#include <math.h>
#include <stdbool.h>

#include "geometry/vec.h"

static float whole_within(float value, float most)
{
	return floorf(fminf(fmaxf(value, 0), most));
}

void aim_at(struct aim *out, const struct cube_axes *axes, const float point_m[3],
	    const float centre_m[3], float radius_m, float far_m)
{
	const float half = AIM_CELLS / 2;
	float to[3];
	vec_sub(to, centre_m, point_m);
	float depth = vec_dot(to, axes->forward);
	float ahead = fmaxf(depth, 1e-3f);
	out->cell[0] = whole_within(half + half * vec_dot(to, axes->right) / ahead, AIM_CELLS - 1);
	out->cell[1] = whole_within(half - half * vec_dot(to, axes->up) / ahead, AIM_CELLS - 1);
	/* A piece near the sampling point needs depths relative to 0: the shader divides by the
	 * depth, which must not be a small difference. */
	bool far_off = depth > 2 * radius_m;
	out->units = far_off ? whole_within(depth / aim_unit_m(far_m), AIM_DEPTH_UNITS - 1) : 0;
	out->depth_m = out->units * aim_unit_m(far_m);
	for (int i = 0; i < 3; i++) {
		float forward = axes->forward[i];
		out->rows[0][i] = half * axes->right[i] - (out->cell[0] - half) * forward;
		out->rows[1][i] = -half * axes->up[i] - (out->cell[1] - half) * forward;
		out->rows[2][i] = forward;
	}
	for (int r = 0; r < 3; r++)
		out->rows[r][3] = -vec_dot(out->rows[r], point_m);
	out->rows[2][3] -= out->depth_m;
}
