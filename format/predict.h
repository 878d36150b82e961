/* What the patch codec expects of a vertex before it reads the difference: private to format. All
 * arithmetic is on integers, so that every machine expects the same.
 *
 * Positions: the parallelogram rule (Touma and Gotsman 1998, "Triangle mesh compression") over the
 * triangles in their order. Normals: the area-weighted normal of the patch's own triangles.
 * Colours: the mean of the two vertices of the triangle that are known already. */
#ifndef GOPURA_FORMAT_PREDICT_H
#define GOPURA_FORMAT_PREDICT_H

#include "base/compiler.h"
#include "format/patch_mesh.h"

/* One step a vertex, in the order in which the vertices are coded: the order in which the
 * triangles name them, then the ones that no triangle names. */
struct predict_step {
	uint16_t vertex;
	uint16_t known_count; /* 0 to 3: how many of from[] hold */
	uint16_t from[3];     /* 1: near; 2: the edge's ends; 3: and the apex across the edge */
};

/* steps has room for mesh->vertex_count; only counts and indices of the mesh are read, and the
 * indices are in range. -ENOMEM. */
must_check int predict_steps(struct predict_step *steps, const struct patch_mesh *mesh);
void predict_position(uint16_t out[3], const struct predict_step *step,
		      const struct patch_vertex *vertices);
void predict_colour(uint8_t out[4], const struct predict_step *step,
		    const struct patch_vertex *vertices);
/* The expected normal of every vertex, from positions and triangles alone. -ENOMEM. */
must_check int predict_normals(int8_t (*out)[2], const struct patch_mesh *mesh);

#endif
