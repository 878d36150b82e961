/* Flips the signs of corners beside small parts of a surface. */
#include "pipeline/octree/field_flip.h"

#include <errno.h>
#include <math.h>

#include "base/spill.h"
#include "pipeline/octree/mesh_parts.h"

/* The distance that a flipped corner gets, in cells. */
static const float flipped = 0.5f;

/* Adds up six times the volume of each part, in cells, above 0 for a body and below for a cavity.
 */
static void add_volumes(const struct corner_field *field, const struct mesh *mesh,
			const uint32_t *parts, float *volumes)
{
	for (uint32_t t = 0; t < mesh->triangle_count; t++) {
		double p[3][3], sum = 0;

		for (int i = 0; i < 3; i++)
			for (int k = 0; k < 3; k++)
				/* from the part's own vertex, so that small volumes stay exact */
				p[i][k] =
					((double)mesh->positions[mesh->triangles[t][i]][k] -
					 (double)mesh->positions[parts[mesh->triangles[t][0]]][k]) /
					field->cell;
		for (int k = 0; k < 3; k++)
			sum += p[0][k] * (p[1][(k + 1) % 3] * p[2][(k + 2) % 3] -
					  p[1][(k + 2) % 3] * p[2][(k + 1) % 3]);
		volumes[parts[mesh->triangles[t][0]]] += (float)sum;
		spill_pass(t);
	}
}

/* A vertex lies on an edge: one of its coordinates is between two corners, the others at one. Flips
 * both ends to the sign that removes the part. */
static int flip_at(struct corner_field *field, const float position[3], bool is_body)
{
	double at[3], farthest = -1;
	int axis = 0;

	for (int k = 0; k < 3; k++) {
		double off;

		at[k] = ((double)position[k] - field->origin[k]) / field->cell;
		off = fabs(at[k] - round(at[k]));
		if (off > farthest) {
			farthest = off;
			axis = k;
		}
	}
	for (int end = 0; end < 2; end++) {
		int32_t corner[3];
		int rc;

		for (int k = 0; k < 3; k++)
			corner[k] = (int32_t)(k == axis ? floor(at[k]) + end : round(at[k]));
		rc = corner_field_set(field, corner, is_body ? flipped : -flipped);
		if (rc < 0)
			return rc;
	}
	return 0;
}

int field_flip_small(struct corner_field *field, const struct mesh *mesh, double share,
		     uint32_t *parts)
{
	const size_t room = mesh->vertex_count + (size_t)1;
	uint32_t *sizes = spill_alloc(room * sizeof(*sizes));
	float *volumes = sizes ? spill_alloc(room * sizeof(*volumes)) : NULL;
	uint32_t *roots = NULL, largest = 0;
	int rc = volumes ? mesh_parts_find(mesh, &roots) : -errno;

	*parts = 0;
	if (rc == 0) {
		for (uint32_t t = 0; t < mesh->triangle_count; t++) {
			uint32_t *size = &sizes[roots[mesh->triangles[t][0]]];

			largest = ++*size > largest ? *size : largest;
		}
		add_volumes(field, mesh, roots, volumes);
	}
	for (uint32_t i = 0; i < mesh->vertex_count && rc == 0; i++) {
		if (sizes[roots[i]] >= share * largest)
			continue;
		*parts += roots[i] == i;
		rc = flip_at(field, mesh->positions[i], volumes[roots[i]] > 0);
		spill_pass(i);
	}
	spill_free(roots);
	spill_free(sizes);
	spill_free(volumes);
	return rc;
}
