/* Dirty scans, made: boxes that overlap, are inside out, have holes or faces that are there twice.
 */
#ifndef GOPURA_TESTS_PIPELINE_OCTREE_DIRTY_BOXES_H
#define GOPURA_TESTS_PIPELINE_OCTREE_DIRTY_BOXES_H

#include <stdbool.h>
#include <stdlib.h>

#include "tests/pipeline/shapes.h"

enum { BOXES_VERTICES = 200000, BOXES_TRIANGLES = 400000 };

/* Room for what a test needs; random numbers begin anew. */
static inline struct mesh boxes_begin(void)
{
	struct mesh mesh;

	shape_room(&mesh, BOXES_VERTICES, BOXES_TRIANGLES);
	srand(1);
	return mesh;
}

static inline bool box_chance(double share)
{
	return rand() < share * RAND_MAX;
}

struct box {
	float low[3], size[3];
	uint32_t steps;  /* squares along an edge */
	double missing;  /* share of its squares that are not there */
	double doubled;  /* share of its triangles that are there twice, the second time turned */
	bool is_turned;  /* inside out */
	bool is_lidless; /* without its upper side */
};

static inline void box_add_square(struct mesh *mesh, const struct box *box,
				  const uint32_t corners[4])
{
	for (int half = 0; half < 2; half++) {
		const uint32_t a = corners[0], b = corners[1 + half], c = corners[2 + half];

		shape_triangle(mesh, a, box->is_turned ? c : b, box->is_turned ? b : c);
		if (box_chance(box->doubled))
			shape_triangle(mesh, b, a, c);
	}
}

/* Exactly the same on both sides of an edge. */
static inline float box_place(const struct box *box, int axis, uint32_t step)
{
	return step == box->steps
		       ? box->low[axis] + box->size[axis]
		       : box->low[axis] + box->size[axis] * (float)step / (float)box->steps;
}

/* Its vertices are not shared between sides, as at the seams of a texture. */
static inline void box_add(struct mesh *mesh, const struct box *box)
{
	const uint32_t n = box->steps, row = n + 1;

	for (int side = 0; side < 6; side++) {
		const int axis = side / 2, u = (axis + 1) % 3, v = (axis + 2) % 3;
		const uint32_t first = mesh->vertex_count;

		if (box->is_lidless && side == 5)
			continue;
		for (uint32_t i = 0; i < row * row; i++) {
			float at[3];

			at[axis] = box_place(box, axis, side % 2 ? n : 0);
			at[u] = box_place(box, u, i % row);
			at[v] = box_place(box, v, i / row);
			shape_vertex(mesh, at[0], at[1], at[2]);
		}
		for (uint32_t i = 0; i < n * n; i++) {
			const uint32_t a = first + i / n * row + i % n;
			const uint32_t out[4] = { a, a + 1, a + row + 1, a + row };
			const uint32_t in[4] = { a, a + row, a + row + 1, a + 1 };

			if (!box_chance(box->missing))
				box_add_square(mesh, box, side % 2 ? out : in);
		}
	}
}

#endif
