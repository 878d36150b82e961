/* Projects directions onto the faces of a cube map, and back. */
#include "format/cube.h"

#include <math.h>

/* The four side faces have +z up. The faces above and below have +y up. */
const struct cube_axes cube_axes[CUBE_FACES] = {
	{ { 1, 0, 0 }, { 0, -1, 0 }, { 0, 0, 1 } }, { { -1, 0, 0 }, { 0, 1, 0 }, { 0, 0, 1 } },
	{ { 0, 1, 0 }, { 1, 0, 0 }, { 0, 0, 1 } },  { { 0, -1, 0 }, { -1, 0, 0 }, { 0, 0, 1 } },
	{ { 0, 0, 1 }, { -1, 0, 0 }, { 0, 1, 0 } }, { { 0, 0, -1 }, { 1, 0, 0 }, { 0, 1, 0 } },
};

const char *const cube_face_names[CUBE_FACES] = { "+x", "-x", "+y", "-y", "+z", "-z" };

static float dot(const float a[3], const float b[3])
{
	return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

int cube_project(const float direction[3], float *u, float *v)
{
	int axis = 0, face;
	float depth;

	for (int i = 1; i < 3; i++)
		if (fabsf(direction[i]) > fabsf(direction[axis]))
			axis = i;
	face = 2 * axis + (direction[axis] < 0);
	depth = dot(direction, cube_axes[face].forward);
	*u = dot(direction, cube_axes[face].right) / depth;
	*v = dot(direction, cube_axes[face].up) / depth;
	return face;
}

void cube_direction(float out[3], int face, float u, float v)
{
	const struct cube_axes *axes = &cube_axes[face];

	for (int i = 0; i < 3; i++)
		out[i] = axes->forward[i] + u * axes->right[i] + v * axes->up[i];
}
