/* Toy meshes with pictures that can be worked out by hand. Counter-clockwise from outside. */
#ifndef GOPURA_TESTS_PIPELINE_TOY_H
#define GOPURA_TESTS_PIPELINE_TOY_H

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "pipeline/import/mesh.h"

/* Room for that much; counts start at 0. */
static inline struct mesh toy_empty(uint32_t vertices, uint32_t triangles)
{
	struct mesh mesh = { 0 };

	mesh.positions = malloc(vertices * sizeof(*mesh.positions));
	mesh.colours = malloc(vertices * sizeof(*mesh.colours));
	mesh.triangles = malloc(triangles * sizeof(*mesh.triangles));
	return mesh;
}

static inline void toy_free(struct mesh *mesh)
{
	free(mesh->positions);
	free(mesh->colours);
	free(mesh->uvs);
	free(mesh->triangles);
	free(mesh->materials);
}

static inline uint32_t toy_vertex(struct mesh *mesh, float x, float y, float z,
				  const uint8_t colour[3])
{
	uint32_t n = mesh->vertex_count++;

	mesh->positions[n][0] = x;
	mesh->positions[n][1] = y;
	mesh->positions[n][2] = z;
	memcpy(mesh->colours[n], colour, 3);
	mesh->colours[n][3] = 255;
	return n;
}

static inline void toy_triangle(struct mesh *mesh, uint32_t a, uint32_t b, uint32_t c)
{
	uint32_t *t = mesh->triangles[mesh->triangle_count++];

	t[0] = a;
	t[1] = b;
	t[2] = c;
}

/* Each of the six sides (+x -x +y -y +z -z) of one colour: 24 vertices, 12 triangles. */
static inline void toy_box(struct mesh *mesh, const float low[3], const float high[3],
			   uint8_t colours[6][3])
{
	for (int side = 0; side < 6; side++) {
		int axis = side / 2, u = (axis + 1) % 3, v = (axis + 2) % 3;
		uint32_t corner[4];

		for (int k = 0; k < 4; k++) {
			float p[3];

			p[axis] = side % 2 ? low[axis] : high[axis];
			p[u] = k == 1 || k == 2 ? high[u] : low[u];
			p[v] = k >= 2 ? high[v] : low[v];
			corner[k] = toy_vertex(mesh, p[0], p[1], p[2], colours[side]);
		}
		toy_triangle(mesh, corner[0], corner[side % 2 ? 2 : 1], corner[side % 2 ? 1 : 2]);
		toy_triangle(mesh, corner[0], corner[side % 2 ? 3 : 2], corner[side % 2 ? 2 : 3]);
	}
}

/* steps rings of 2 steps: a vertex more than (steps - 1) * 2 steps + 1, 4 steps^2 triangles. */
static inline void toy_sphere(struct mesh *mesh, const float centre[3], float radius,
			      uint32_t steps, const uint8_t colour[3])
{
	uint32_t around = 2 * steps, first = mesh->vertex_count, bottom;

	toy_vertex(mesh, centre[0], centre[1], centre[2] + radius, colour);
	for (uint32_t i = 1; i < steps; i++) {
		for (uint32_t k = 0; k < around; k++) {
			float a = (float)M_PI * (float)i / (float)steps;
			float b = 2 * (float)M_PI * (float)k / (float)around;

			toy_vertex(mesh, centre[0] + radius * sinf(a) * cosf(b),
				   centre[1] + radius * sinf(a) * sinf(b),
				   centre[2] + radius * cosf(a), colour);
		}
	}
	bottom = toy_vertex(mesh, centre[0], centre[1], centre[2] - radius, colour);
	for (uint32_t k = 0; k < around; k++) {
		uint32_t next = (k + 1) % around, row = first + 1;

		toy_triangle(mesh, first, row + k, row + next);
		for (uint32_t i = 1; i + 1 < steps; i++, row += around) {
			toy_triangle(mesh, row + k, row + around + k, row + around + next);
			toy_triangle(mesh, row + k, row + around + next, row + next);
		}
		toy_triangle(mesh, bottom, row + next, row + k);
	}
}

#endif
