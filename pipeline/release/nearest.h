/* The nearest place of a surface: a tree of boxes over triangles. A triangle with two corners at
 * one place is a stretch of line, and as good. */
#ifndef GOPURA_PIPELINE_RELEASE_NEAREST_H
#define GOPURA_PIPELINE_RELEASE_NEAREST_H

#include <stdbool.h>
#include <stdint.h>

#include "base/compiler.h"

struct nearest;

/* positions and triangles are borrowed until nearest_destroy. *out is owned by the caller; NULL on
 * failure. -ENOMEM. */
must_check int nearest_create(struct nearest **out, float (*positions)[3], uint32_t (*triangles)[3],
			      uint32_t triangle_count);
void nearest_destroy(struct nearest *nearest); /* NULL is fine */

struct nearest_place {
	uint32_t triangle;
	float at_m[3], distance_m;
};

/* The nearest place within most_m (INFINITY: wherever); of triangles that show the side to which
 * facing points alone, unless that is NULL. false: there is none. Any thread. */
bool nearest_find(const struct nearest *nearest, const float point_m[3], const float facing[3],
		  float most_m, struct nearest_place *out);
/* Whether a triangle shows the side to which facing points. */
bool nearest_faces(const struct nearest *nearest, uint32_t triangle, const float facing[3]);

#endif
