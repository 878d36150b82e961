/* Sums over the triangles of a mesh. */
#include "pipeline/deform/mesh_measure.h"

#include <math.h>

#include "base/spill.h"
#include "pipeline/import/mesh_edges.h"

/* Adds a triangle: its area, and the volume between it and the middle of the box, so that numbers
 * stay small for a scan far from the origin. */
static void add_triangle(struct mesh_measure *out, const struct mesh *mesh, uint32_t t,
			 const double middle[3])
{
	const float *const a = mesh->positions[mesh->triangles[t][0]];
	const float *const b = mesh->positions[mesh->triangles[t][1]];
	const float *const c = mesh->positions[mesh->triangles[t][2]];
	double ab[3], ac[3], cross[3], volume6 = 0;

	for (int k = 0; k < 3; k++) {
		ab[k] = (double)b[k] - (double)a[k];
		ac[k] = (double)c[k] - (double)a[k];
	}
	for (int k = 0; k < 3; k++) {
		const int i = (k + 1) % 3, j = (k + 2) % 3;

		cross[k] = ab[i] * ac[j] - ab[j] * ac[i];
		volume6 += ((double)a[k] - middle[k]) * cross[k];
	}
	out->area += sqrt(cross[0] * cross[0] + cross[1] * cross[1] + cross[2] * cross[2]) / 2;
	out->volume += volume6 / 6;
}

static void count_border(void *data, const struct mesh_edge *edge)
{
	*(uint32_t *)data += edge->face_count == 1;
}

int mesh_measure(struct mesh_measure *out, const struct mesh *mesh, uint32_t jobs)
{
	struct mesh_edges edges;
	double middle[3];
	int rc;

	*out = (struct mesh_measure){ .vertices = mesh->vertex_count,
				      .triangles = mesh->triangle_count };
	mesh_box(mesh, out->low, out->high);
	for (int k = 0; k < 3; k++)
		middle[k] = ((double)out->low[k] + (double)out->high[k]) / 2;
	for (uint32_t t = 0; t < mesh->triangle_count; t++) {
		add_triangle(out, mesh, t, middle);
		spill_pass(t);
	}
	rc = mesh_edges_init(&edges, mesh, jobs);
	if (rc == 0)
		rc = mesh_edges_each(&edges, count_border, &out->border_edges);
	mesh_edges_finish(&edges);
	return rc;
}
