/* Predicts the vertices of a patch for the patch codec, which stores only the differences. Private
 * to format/. All arithmetic is on integers, so that every machine predicts the same values.
 *
 * Positions: the parallelogram rule (Touma and Gotsman 1998, "Triangle mesh compression") over the
 * triangles in their order. Normals: the area-weighted normal of the patch's own triangles.
 * Colours: the mean of the two vertices of the triangle that are already known. */
#ifndef GOPURA_FORMAT_PREDICT_H
#define GOPURA_FORMAT_PREDICT_H

#include "base/compiler.h"
#include "format/patch_mesh.h"
#include "format/root_page.h"

/* One step per vertex, in the order in which vertices are coded: first in the order in which the
 * triangles name them, then those that no triangle names. */
struct predict_step {
	uint16_t vertex;
	uint16_t known_count; /* 0 to 3: how many entries of from are valid */
	uint16_t from[3];     /* 1: nearby; 2: ends of the edge; 3: also the apex across it */
};

/* Fills steps, which has room for mesh->vertex_count. Reads only counts and indices of the mesh;
 * the indices must be in range. Returns -ENOMEM. */
must_check int predict_steps(struct predict_step *steps, const struct patch_mesh *mesh);
/* The places of a group: from base to base + most on each axis. */
struct predict_range {
	int32_t base[3];
	int32_t most; /* 2^n - 1, so that differences within it wrap */
};

/* Predict one vertex from those that its step names, which must be decoded already. */
void predict_position(int32_t out[3], const struct predict_step *step,
		      const struct patch_vertex *vertices, const struct predict_range *range);
void predict_colour(uint8_t out[4], const struct predict_step *step,
		    const struct patch_vertex *vertices);
/* Predicts the normal of every vertex from positions and triangles alone. out has room for
 * mesh->vertex_count normals. Returns -ENOMEM. */
must_check int predict_normals(int8_t (*out)[2], const struct patch_mesh *mesh);

#endif
