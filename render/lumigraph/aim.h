/* How a piece is projected into a face that colours it, so that a fragment needs few bits.
 *
 * Fragments may have mediump alone: eleven bits, and a face has as many pixels a side. So what a
 * fragment computes counts from a cell of the face near the piece, and from a depth near it, which
 * are integers and exact; vertices, which always have highp, subtract them. Pure; the fragment's
 * part is in surface.c, its twin in tests/render/test_mediump.c. */
#ifndef GOPURA_RENDER_LUMIGRAPH_AIM_H
#define GOPURA_RENDER_LUMIGRAPH_AIM_H

#include "format/cube.h"

enum {
	AIM_CELLS = 32,       /* of a face, a side */
	AIM_DEPTH_STEPS = 32, /* in a unit of depth: what the lowest five of sixteen bits count */
	AIM_DEPTH_UNITS = 2048,
};

struct aim {
	/* Of a point from the eye (1 as its fourth): columns and rows of cells from `cell`, times
	 * the depth; the depth from `depth_m`. */
	float rows[3][4];
	float cell[2]; /* whole; column and row, which counts from the top */
	float units;   /* whole */
	float depth_m; /* what they are */
};

/* Metres in a unit of depth. */
static inline float aim_unit_m(float far_m)
{
	return far_m * (AIM_DEPTH_STEPS / 65535.0f);
}

/* The point, and the piece's sphere, as the eye sees them: metres from it. */
void aim_at(struct aim *out, const struct cube_axes *axes, const float point_m[3],
	    const float centre_m[3], float radius_m, float far_m);

#endif
