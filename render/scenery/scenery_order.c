/* Sorts triangles by the distance of their middles. Triangles that cut through each other have no
 * order; content must not make them. */
#include "render/scenery/scenery_order.h"

#include <stdlib.h>

#include "base/array.h"
#include "geometry/vec.h"

int scenery_order_add(struct scenery_order *order, const struct pose *pose, uint32_t mesh,
		      const float eye_m[3])
{
	const struct scenery_mesh *of = &pose->scenery->meshes[mesh];
	const struct scenery_vertex *vertices = bend_vertices(&pose->bend, pose->scenery, mesh);
	const float *m = pose->nodes[of->node].matrix;
	int rc = ARRAY_RESERVE(order->triangles, order->room,
			       (uint64_t)order->count + of->triangle_count,
			       SCENERY_CLEAR_TRIANGLES_MAX);

	for (uint32_t t = 0; rc == 0 && t < of->triangle_count; t++) {
		float middle[3] = { 0 }, at[3];

		for (int corner = 0; corner < 3; corner++)
			for (int k = 0; k < 3; k++)
				middle[k] += vertices[of->triangles[t][corner]].place[k] / 3.0f;
		for (int k = 0; k < 3; k++)
			middle[k] = of->origin_m[k] + of->step_m * middle[k];
		matrix_place(at, m, middle);
		order->triangles[order->count++] = (struct scenery_ordered){
			.distance_m = vec_distance(at, eye_m), .mesh = mesh, .triangle = t
		};
	}
	return rc;
}

static int from_far(const void *left, const void *right)
{
	const struct scenery_ordered *a = left, *b = right;

	if (a->distance_m != b->distance_m)
		return a->distance_m < b->distance_m ? 1 : -1;
	if (a->mesh != b->mesh)
		return a->mesh < b->mesh ? -1 : 1;
	return a->triangle < b->triangle ? -1 : a->triangle > b->triangle;
}

void scenery_order_sort(struct scenery_order *order)
{
	if (order->count > 0)
		qsort(order->triangles, order->count, sizeof(*order->triangles), from_far);
}

void scenery_order_finish(struct scenery_order *order)
{
	free(order->triangles);
	*order = (struct scenery_order){ 0 };
}
