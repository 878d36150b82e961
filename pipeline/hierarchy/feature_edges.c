/* Finds sharp edges, and base edges by the normals of their ends. */
#include "pipeline/hierarchy/feature_edges.h"

#include <errno.h>
#include <math.h>
#include <stdlib.h>

#include "base/array.h"
#include "geometry/vec.h"

/* How much a squared difference of colours (0..1 for black to white) lowers a weight. */
#define COLOUR_WEIGHT 4.0f

int features_init(struct features *features, struct collapse_mesh *mesh)
{
	const struct simplify_surface *surface = mesh->surface;
	size_t vertices = (size_t)surface->vertex_count + 1;
	size_t triangles = (size_t)surface->triangle_count + 1;

	*features = (struct features){
		.mesh = mesh,
		.vertices = calloc(vertices, sizeof(*features->vertices)),
		.normals = malloc(triangles * sizeof(*features->normals)),
		.alive = malloc(triangles * sizeof(*features->alive)),
		.alive_count = surface->triangle_count,
	};
	if (!features->vertices || !features->normals || !features->alive)
		return -ENOMEM;
	for (uint32_t t = 0; t < surface->triangle_count; t++)
		features->alive[t] = t;
	return ARRAY_RESERVE(features->edges, features->edge_room, 2 * triangles, UINT32_MAX);
}

void features_finish(struct features *features)
{
	free(features->vertices);
	free(features->normals);
	free(features->alive);
	free(features->edges);
}

/* ---- normals */

static void clear_vertices(struct features *features)
{
	uint32_t kept = 0;

	for (uint32_t i = 0; i < features->alive_count; i++) {
		const struct collapse_face *face = &features->mesh->faces[features->alive[i]];

		if (face->dead)
			continue;
		features->alive[kept++] = features->alive[i];
		for (int corner = 0; corner < 3; corner++) {
			struct feature_vertex *vertex = &features->vertices[face->corners[corner]];

			*vertex = (struct feature_vertex){ .touched = vertex->touched };
		}
	}
	features->alive_count = kept;
}

static void find_normals(struct features *features)
{
	for (uint32_t i = 0; i < features->alive_count; i++) {
		const uint32_t t = features->alive[i];
		const uint32_t *corners = features->mesh->faces[t].corners;
		double cross[3], length;

		collapse_cross_of_triangle(cross, features->mesh, corners);
		length = sqrt(collapse_dot(cross, cross));
		for (int k = 0; k < 3; k++)
			features->normals[t][k] = length > 0.0 ? (float)(cross[k] / length) : 0.0f;
		for (int corner = 0; corner < 3; corner++) {
			struct feature_vertex *vertex = &features->vertices[corners[corner]];

			vertex->area += (float)length;
			for (int k = 0; k < 3; k++)
				vertex->sum[k] += (float)cross[k];
		}
	}
}

/* ---- edges */

static void add_line(struct feature_vertex *vertex, uint32_t other)
{
	if (vertex->line_count < 2)
		vertex->lines[vertex->line_count] = other;
	if (vertex->line_count < UINT8_MAX)
		vertex->line_count++;
}

/* Adds the edge that a triangle has from a to b, unless the triangle on its other side does. */
static void add_edge(struct features *features, uint32_t t, uint32_t a, uint32_t b, float epsilon)
{
	struct collapse_mesh *mesh = features->mesh;
	struct feature_edge *edge = &features->edges[features->edge_count];
	uint32_t forth = 0, back = 0, other = t;

	COLLAPSE_EACH_CORNER(mesh, a, corner)
	{
		if (collapse_after(mesh, corner) == b && corner / 4 < t)
			return; /* that triangle adds it */
		forth += collapse_after(mesh, corner) == b;
		if (collapse_before(mesh, corner) == b) {
			back++;
			other = corner / 4;
		}
	}
	if (back > 0 && a > b)
		return;
	*edge = (struct feature_edge){ .ends = { a, b },
				       .sides = { t, other },
				       .is_open = forth != back };
	edge->is_sharp = forth != 1 || back != 1 ||
			 vec_dot(features->normals[t], features->normals[other]) < epsilon;
	if (edge->is_sharp) {
		add_line(&features->vertices[a], b);
		add_line(&features->vertices[b], a);
	}
	features->edge_count++;
}

static float colour_square(const struct features *features, uint32_t a, uint32_t b)
{
	const uint8_t *from = features->mesh->surface->vertices[a].colour;
	const uint8_t *to = features->mesh->surface->vertices[b].colour;
	float sum = 0.0f;

	for (int i = 0; i < 3; i++)
		sum += (float)((from[i] - to[i]) * (from[i] - to[i]));
	return sum / (3.0f * 255.0f * 255.0f);
}

/* The normal that the surface has at an end of an edge, in the part that the edge is in. */
static void end_normal(float out[3], const struct features *features,
		       const struct feature_edge *edge, int end)
{
	const struct feature_vertex *vertex = &features->vertices[edge->ends[end]];
	const float *left = features->normals[edge->sides[0]];
	const float *right = features->normals[edge->sides[1]];
	float length;

	for (int k = 0; k < 3; k++)
		out[k] = vertex->line_count > 0 ? left[k] + right[k] : vertex->sum[k];
	length = vertex->line_count > 0 ? vec_length(out) : vertex->area;
	for (int k = 0; length > 0.0f && k < 3; k++)
		out[k] /= length;
}

static void weigh_edge(struct features *features, struct feature_edge *edge, float epsilon)
{
	float a[3], b[3];

	end_normal(a, features, edge, 0);
	end_normal(b, features, edge, 1);
	edge->weight = vec_dot(a, b) -
		       COLOUR_WEIGHT * colour_square(features, edge->ends[0], edge->ends[1]);
	for (int end = 0; edge->weight < epsilon && end < 2; end++) {
		struct feature_vertex *vertex = &features->vertices[edge->ends[end]];

		/* A vertex on a line cannot leave it; so only edges of the line matter. */
		if (edge->is_sharp || vertex->line_count == 0)
			vertex->is_held = 1;
	}
}

int features_find(struct features *features, double epsilon)
{
	int rc = 0;

	clear_vertices(features);
	find_normals(features);
	features->edge_count = 0;
	for (uint32_t i = 0; rc == 0 && i < features->alive_count; i++) {
		const uint32_t t = features->alive[i];
		const uint32_t *corners = features->mesh->faces[t].corners;

		rc = ARRAY_RESERVE(features->edges, features->edge_room,
				   (uint64_t)features->edge_count + 3, UINT32_MAX);
		for (int corner = 0; rc == 0 && corner < 3; corner++)
			add_edge(features, t, corners[corner], corners[(corner + 1) % 3],
				 (float)epsilon);
	}
	for (uint32_t e = 0; rc == 0 && e < features->edge_count; e++)
		weigh_edge(features, &features->edges[e], (float)epsilon);
	return rc;
}

double features_straightness(const struct features *features, uint32_t vertex)
{
	const struct feature_vertex *on = &features->vertices[vertex];
	const double *at = features->mesh->nodes[vertex].at;
	double along[2][3], lengths[2];

	for (int line = 0; line < 2; line++) {
		for (int k = 0; k < 3; k++)
			along[line][k] = features->mesh->nodes[on->lines[line]].at[k] - at[k];
		lengths[line] = sqrt(collapse_dot(along[line], along[line]));
	}
	return -collapse_dot(along[0], along[1]) / (lengths[0] * lengths[1]);
}
