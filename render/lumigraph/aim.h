/* Projects a piece into a face that colours it, in such a way that the fragment shader needs few
 * bits.
 *
 * Fragment shaders may have only mediump with 11 bits, and a face has as many pixels per side. So a
 * fragment computes relative to a cell of the face near the piece and to a depth near it, which are
 * integers and therefore exact; the vertex shader, which always has highp, subtracts them. Pure;
 * the fragment shader's part is in surface.c; tests/render/lumigraph/test_mediump.c computes the
 * same. */
#ifndef GOPURA_RENDER_LUMIGRAPH_AIM_H
#define GOPURA_RENDER_LUMIGRAPH_AIM_H

#include "format/cube.h"

enum {
	AIM_CELLS = 32,       /* cells per side of a face */
	AIM_DEPTH_STEPS = 32, /* depth steps per unit: the lowest 5 of 16 bits count them */
	AIM_DEPTH_UNITS = 2048,
};

struct aim {
	/* Rows to multiply with a point relative to the eye (fourth component 1). The first two
	 * give column and row in cells relative to `cell`, times the depth; the third gives the
	 * depth relative to `depth_m`. */
	float rows[3][4];
	float cell[2]; /* integers: column and row; rows count from the top */
	float units;   /* integer: the reference depth in units */
	float depth_m; /* the same in metres */
};

/* Returns the metres per unit of depth. */
static inline float aim_unit_m(float far_m)
{
	return far_m * (AIM_DEPTH_STEPS / 65535.0f);
}

/* Computes the projection of a piece into a face. point_m is the sampling point and centre_m the
 * centre of the piece's sphere, both relative to the eye; far_m is the far limit of depths. */
void aim_at(struct aim *out, const struct cube_axes *axes, const float point_m[3],
	    const float centre_m[3], float radius_m, float far_m);

#endif
