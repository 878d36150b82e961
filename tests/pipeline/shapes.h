/* Small scans for the tests of the pipeline: made, not read. */
#ifndef GOPURA_TESTS_PIPELINE_SHAPES_H
#define GOPURA_TESTS_PIPELINE_SHAPES_H

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "pipeline/import/mesh.h"

static inline void shape_room(struct mesh *mesh, uint32_t vertices, uint32_t triangles)
{
	memset(mesh, 0, sizeof(*mesh));
	mesh->positions = calloc(vertices, sizeof(*mesh->positions));
	mesh->colours = calloc(vertices, sizeof(*mesh->colours));
	mesh->triangles = calloc(triangles, sizeof(*mesh->triangles));
}

static inline uint32_t shape_vertex(struct mesh *mesh, float x, float y, float z)
{
	uint32_t v = mesh->vertex_count++;

	mesh->positions[v][0] = x;
	mesh->positions[v][1] = y;
	mesh->positions[v][2] = z;
	mesh->colours[v][0] = (uint8_t)(128.0f + 60.0f * sinf(3.0f * x));
	mesh->colours[v][1] = (uint8_t)(128.0f + 60.0f * sinf(4.0f * y));
	mesh->colours[v][2] = (uint8_t)(128.0f + 60.0f * sinf(5.0f * z));
	mesh->colours[v][3] = 255;
	return v;
}

static inline void shape_triangle(struct mesh *mesh, uint32_t a, uint32_t b, uint32_t c)
{
	uint32_t *triangle = mesh->triangles[mesh->triangle_count++];

	triangle[0] = a;
	triangle[1] = b;
	triangle[2] = c;
}

/* A closed bumpy ball with a tower on top; about 4 n^2 triangles. */
static inline struct mesh shape_temple(uint32_t n)
{
	struct mesh mesh;
	uint32_t round = 2 * n, top, bottom;

	shape_room(&mesh, round * n + 2, 2 * round * n + 2 * round);
	for (uint32_t y = 1; y < n; y++)
		for (uint32_t x = 0; x < round; x++) {
			float down = 3.14159265f * (float)y / (float)n;
			float turn = 6.2831853f * (float)x / (float)round;
			float r = 1.0f + 0.03f * sinf(11.0f * turn) * sinf(9.0f * down) +
				  0.01f * sinf(41.0f * turn + 31.0f * down);

			if (down < 0.3f)
				r += 1.5f * (0.3f - down) / 0.3f;
			shape_vertex(&mesh, r * sinf(down) * cosf(turn),
				     r * sinf(down) * sinf(turn), r * cosf(down));
		}
	top = shape_vertex(&mesh, 0.0f, 0.0f, 2.5f);
	bottom = shape_vertex(&mesh, 0.0f, 0.0f, -1.0f);
	for (uint32_t x = 0; x < round; x++) {
		uint32_t next = (x + 1) % round, last = (n - 2) * round;

		shape_triangle(&mesh, top, x, next);
		for (uint32_t y = 0; y + 2 < n; y++) {
			uint32_t a = y * round + x, b = y * round + next;

			shape_triangle(&mesh, a, a + round, b);
			shape_triangle(&mesh, b, a + round, b + round);
		}
		shape_triangle(&mesh, bottom, last + next, last + x);
	}
	return mesh;
}

/* An open relief of 2 n^2 triangles with a square hole in it. */
static inline struct mesh shape_relief(uint32_t n)
{
	struct mesh mesh;

	shape_room(&mesh, (n + 1) * (n + 1), 2 * n * n);
	for (uint32_t y = 0; y <= n; y++)
		for (uint32_t x = 0; x <= n; x++) {
			float u = (float)x / (float)n, v = (float)y / (float)n;

			shape_vertex(&mesh, 2.0f * u, 2.0f * v,
				     0.05f * sinf(20.0f * u) * cosf(23.0f * v) +
					     0.01f * sinf(90.0f * u * v));
		}
	for (uint32_t y = 0; y < n; y++)
		for (uint32_t x = 0; x < n; x++) {
			uint32_t a = y * (n + 1) + x;

			if (x > n / 3 && x < n / 2 && y > n / 3 && y < n / 2)
				continue;
			shape_triangle(&mesh, a, a + 1, a + n + 1);
			shape_triangle(&mesh, a + n + 1, a + 1, a + n + 2);
		}
	return mesh;
}

static inline void shape_add_box(struct mesh *mesh, float x, float y, float z, float size)
{
	static const uint8_t faces[6][4] = { { 0, 2, 3, 1 }, { 4, 5, 7, 6 }, { 0, 1, 5, 4 },
					     { 2, 6, 7, 3 }, { 0, 4, 6, 2 }, { 1, 3, 7, 5 } };
	uint32_t corners[8];

	for (uint32_t i = 0; i < 8; i++)
		corners[i] = shape_vertex(mesh, x + (i & 1 ? size : 0.0f),
					  y + (i & 2 ? size : 0.0f), z + (i & 4 ? size : 0.0f));
	for (int f = 0; f < 6; f++) {
		shape_triangle(mesh, corners[faces[f][0]], corners[faces[f][1]],
			       corners[faces[f][2]]);
		shape_triangle(mesh, corners[faces[f][0]], corners[faces[f][2]],
			       corners[faces[f][3]]);
	}
}

/* count loose stones, 12 triangles each: nothing is connected to anything. */
static inline struct mesh shape_stones(uint32_t count)
{
	struct mesh mesh;

	shape_room(&mesh, 8 * count, 12 * count);
	for (uint32_t i = 0; i < count; i++)
		shape_add_box(&mesh, (float)(i % 40), (float)(i / 40 % 40), (float)(i / 1600),
			      0.3f + 0.4f * (float)(i * 7919 % 97) / 97.0f);
	return mesh;
}

#endif
