/* Surfaces for the tests of simplifiers, and what is asked of them. */
#ifndef GOPURA_TESTS_PIPELINE_HIERARCHY_SUBJECT_H
#define GOPURA_TESTS_PIPELINE_HIERARCHY_SUBJECT_H

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "pipeline/hierarchy/simplify.h"
#include "tests/check.h"
#include "tests/pipeline/on_lattice.h"
#include "tests/pipeline/shapes.h"

struct subject {
	struct lattice_mesh mesh;
	struct simplify_surface surface;
};

/* The mesh is taken. */
static inline void subject_init(struct subject *subject, struct mesh mesh)
{
	struct lattice_counts counts;

	CHECK(on_lattice(&subject->mesh, &counts, &mesh) == 0);
	mesh_finish(&mesh);
	subject->surface = (struct simplify_surface){
		.vertex_count = subject->mesh.vertex_count,
		.triangle_count = subject->mesh.triangle_count,
		.vertices = subject->mesh.vertices,
		.locked = calloc(subject->mesh.vertex_count, 1),
		.triangles = subject->mesh.triangles,
	};
}

static inline void subject_finish(struct subject *subject)
{
	free(subject->surface.locked);
	lattice_mesh_finish(&subject->mesh);
}

static inline void subject_place(double out[3], const struct simplify_surface *surface, uint32_t t,
				 int corner)
{
	for (int i = 0; i < 3; i++)
		out[i] = surface->vertices[surface->triangles[t][corner]].position[i];
}

static inline void subject_cross(double out[3], const struct simplify_surface *surface, uint32_t t)
{
	double at[3][3], u[3], v[3];

	for (int corner = 0; corner < 3; corner++)
		subject_place(at[corner], surface, t, corner);
	for (int i = 0; i < 3; i++) {
		u[i] = at[1][i] - at[0][i];
		v[i] = at[2][i] - at[0][i];
	}
	for (int i = 0; i < 3; i++)
		out[i] = u[(i + 1) % 3] * v[(i + 2) % 3] - u[(i + 2) % 3] * v[(i + 1) % 3];
}

static inline double subject_area(const struct simplify_surface *surface)
{
	double sum = 0.0, n[3];

	for (uint32_t t = 0; t < surface->triangle_count; t++) {
		subject_cross(n, surface, t);
		sum += sqrt(n[0] * n[0] + n[1] * n[1] + n[2] * n[2]) / 2.0;
	}
	return sum;
}

/* A flat sheet with a square hole in it. */
static inline struct mesh subject_flat(uint32_t n)
{
	struct mesh mesh = shape_relief(n);

	for (uint32_t v = 0; v < mesh.vertex_count; v++) {
		mesh.positions[v][2] = 0.0f;
		memset(mesh.colours[v], 200, 4);
	}
	return mesh;
}

static inline int subject_compare_keys(const void *left, const void *right)
{
	uint64_t a = *(const uint64_t *)left, b = *(const uint64_t *)right;

	return a < b ? -1 : a > b;
}

/* The directed edges without another the other way, sorted; returns how many. */
static inline uint32_t subject_open_edges(uint64_t **out, const struct simplify_surface *surface)
{
	uint32_t count = 3 * surface->triangle_count, kept = 0;
	uint64_t *edges = malloc(count * sizeof(*edges)), *open = malloc(count * sizeof(*open));

	for (uint32_t c = 0; c < count; c++)
		edges[c] = (uint64_t)surface->triangles[c / 3][c % 3] << 32 |
			   surface->triangles[c / 3][(c % 3 + 1) % 3];
	qsort(edges, count, sizeof(*edges), subject_compare_keys);
	for (uint32_t c = 0; c < count; c++) {
		uint64_t back = edges[c] << 32 | edges[c] >> 32;

		if (!bsearch(&back, edges, count, sizeof(*edges), subject_compare_keys))
			open[kept++] = edges[c];
	}
	free(edges);
	*out = open;
	return kept;
}

/* Vertices less edges plus triangles; every edge must have two triangles. */
static inline int subject_euler(const struct simplify_surface *surface)
{
	uint32_t corners = 3 * surface->triangle_count;
	uint64_t *edges = malloc(corners * sizeof(*edges));
	uint8_t *used = calloc(surface->vertex_count, 1);
	int vertices = 0, distinct = 0;

	for (uint32_t c = 0; c < corners; c++) {
		uint64_t a = surface->triangles[c / 3][c % 3];
		uint64_t b = surface->triangles[c / 3][(c % 3 + 1) % 3];

		vertices += !used[a];
		used[a] = 1;
		edges[c] = a < b ? a << 32 | b : b << 32 | a;
	}
	qsort(edges, corners, sizeof(*edges), subject_compare_keys);
	for (uint32_t c = 0; c < corners; c += 2) {
		CHECK(edges[c] == edges[c + 1]);
		CHECK(c == 0 || edges[c] != edges[c - 1]);
		distinct++;
	}
	free(edges);
	free(used);
	return vertices - distinct + (int)surface->triangle_count;
}

/* A torus of 2 n^2 triangles. */
static inline struct mesh subject_ring(uint32_t n)
{
	struct mesh mesh;

	shape_room(&mesh, n * n, 2 * n * n);
	for (uint32_t y = 0; y < n; y++)
		for (uint32_t x = 0; x < n; x++) {
			float u = 6.2831853f * (float)x / (float)n;
			float v = 6.2831853f * (float)y / (float)n, r = 2.0f + 0.7f * cosf(v);

			shape_vertex(&mesh, r * cosf(u), r * sinf(u), 0.7f * sinf(v));
		}
	for (uint32_t y = 0; y < n; y++)
		for (uint32_t x = 0; x < n; x++) {
			uint32_t right = (x + 1) % n, up = (y + 1) % n;

			shape_triangle(&mesh, y * n + x, y * n + right, up * n + x);
			shape_triangle(&mesh, up * n + x, y * n + right, up * n + right);
		}
	return mesh;
}

/* What a group promises to its neighbours: border edges as they were, ends and all. */
struct subject_border {
	uint64_t *edges;
	uint32_t count;
};

/* Locks the border as it is between two groups: locked, and no border of the scan. */
static inline void subject_lock_border(struct subject *subject, struct subject_border *out)
{
	for (uint32_t v = 0; v < subject->surface.vertex_count; v++) {
		subject->surface.locked[v] = subject->surface.vertices[v].border;
		subject->surface.vertices[v].border = 0;
	}
	out->count = subject_open_edges(&out->edges, &subject->surface);
	CHECK(out->count > 160);
}

/* Checks that it is still there, and frees it. */
static inline void subject_check_border(const struct subject *subject,
					struct subject_border *border)
{
	uint64_t *now;

	CHECK(subject_open_edges(&now, &subject->surface) == border->count);
	CHECK(memcmp(border->edges, now, border->count * sizeof(*now)) == 0);
	free(border->edges);
	free(now);
}

#endif
