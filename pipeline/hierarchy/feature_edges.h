/* Feature edges of a surface (paper P3, section 3.4).
 *
 * Sharp edges are open edges, edges of more than two triangles, and creases: the triangles at them
 * meet at an angle with a cosine (SOD) below epsilon. They divide the surface into parts, as in
 * section 3.5.1.
 *
 * Base edges are found in what is left. The weight of an edge is the dot product of the normals of
 * its two ends (ESOD); if it is below epsilon, both ends stay. A normal is the mean of those of the
 * triangles around, weighted by area, and not scaled to 1: it is shorter where they differ. Where
 * one end is on a sharp edge, its normal would be one across parts; the triangles at the edge give
 * it instead. The lattice keeps no material and one colour a vertex, so a material's border is a
 * step of colour: it lowers the weight.
 *
 * Private to simplify_features.c and its test. */
#ifndef GOPURA_PIPELINE_HIERARCHY_FEATURE_EDGES_H
#define GOPURA_PIPELINE_HIERARCHY_FEATURE_EDGES_H

#include "pipeline/hierarchy/collapse.h"

struct feature_vertex {
	/* Of the triangles around: the sum of their normals times their areas, and of the areas;
	 * both times 2, in squared lattice steps. As long as area: the surface is flat there. */
	float sum[3], area;
	uint32_t lines[2];  /* the other ends of its sharp edges; of the first two */
	uint32_t touched;   /* the pass in which the surface around it changed */
	uint8_t line_count; /* sharp edges, 255 at most */
	uint8_t is_held;    /* it ends a base edge; on sharp edges: one that is both */
};

struct feature_edge {
	uint32_t ends[2];
	uint32_t sides[2]; /* a triangle on each side; both the same at an open edge */
	float weight;      /* 1: flat and of one colour; may be below -1 */
	bool is_sharp, is_open;
};

struct features {
	struct collapse_mesh *mesh;      /* borrowed */
	struct feature_vertex *vertices; /* owned; for each vertex */
	float (*normals)[3];             /* owned; of each triangle, unit; 0 without area */
	uint32_t *alive;                 /* owned; the triangles that are not dead, ascending */
	uint32_t alive_count;
	struct feature_edge *edges; /* owned; each once */
	uint32_t edge_count, edge_room;
};

/* Returns -ENOMEM; features are then only to be finished. */
must_check int features_init(struct features *features, struct collapse_mesh *mesh);
void features_finish(struct features *features); /* zeroed is fine */

/* Finds all edges of the surface as it is now, their weights, and which are sharp; and of vertices
 * that are on no sharp edge, which are held. epsilon: -1..1. Returns -ENOMEM. */
must_check int features_find(struct features *features, double epsilon);

/* Returns how straight the line of sharp edges is at a vertex on two of them: the cosine between
 * the directions in which it is walked, 1: straight. */
double features_straightness(const struct features *features, uint32_t vertex);

#endif
