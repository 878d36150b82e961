/* Finds the nearest point of a surface, with a tree of boxes over its triangles. A triangle with
 * two equal corners works as a line segment. */
#ifndef GOPURA_PIPELINE_RELEASE_NEAREST_H
#define GOPURA_PIPELINE_RELEASE_NEAREST_H

#include <stdbool.h>
#include <stdint.h>

#include "base/compiler.h"

struct nearest;

/* Builds the tree. positions and triangles are borrowed until nearest_destroy. *out is owned by the
 * caller; NULL on failure. Returns -ENOMEM. */
must_check int nearest_create(struct nearest **out, float (*positions)[3], uint32_t (*triangles)[3],
			      uint32_t triangle_count);
void nearest_destroy(struct nearest *nearest); /* NULL is fine */

struct nearest_place {
	uint32_t triangle;
	float at_m[3], distance_m;
};

/* Finds the nearest point within most_m metres (INFINITY: no limit). If facing is not NULL, only
 * triangles that face that way count. Returns false if there is none; out->distance_m is then
 * most_m. Any thread. */
bool nearest_find(const struct nearest *nearest, const float point_m[3], const float facing[3],
		  float most_m, struct nearest_place *out);
/* Returns true if the triangle's normal points to the same side as facing. */
bool nearest_faces(const struct nearest *nearest, uint32_t triangle, const float facing[3]);

#endif
