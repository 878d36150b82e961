/* The six cube faces of a sampling point, and the directions of their pixels.
 *
 * A face is a square with a field of view of 90 degrees. For a direction d from the point:
 *   face = the axis of the largest |d|, with its sign: +x -x +y -y +z -z are 0..5
 *   u = dot(d, right) / dot(d, forward), v = dot(d, up) / dot(d, forward), both in -1..1
 *   image column = (u + 1) / 2 * px, image row = (1 - v) / 2 * px (row 0 is the top)
 *   right = forward x up. */
#ifndef GOPURA_FORMAT_CUBE_H
#define GOPURA_FORMAT_CUBE_H

enum { CUBE_FACES = 6 };

struct cube_axes {
	float forward[3], right[3], up[3];
};

/* Unit vectors of each face, indexed by face number. */
extern const struct cube_axes cube_axes[CUBE_FACES];
extern const char *const cube_face_names[CUBE_FACES]; /* "+x", "-x" ..., indexed by face number */

/* Returns the face that direction hits, and where on it. direction may have any length but zero. */
int cube_project(const float direction[3], float *u, float *v);
/* Sets out to forward + u right + v up of the face. The result is not normalised. */
void cube_direction(float out[3], int face, float u, float v);

#endif
