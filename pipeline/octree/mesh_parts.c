/* Finds connected parts by union-find over the vertices. */
#include "pipeline/octree/mesh_parts.h"

#include <errno.h>
#include <string.h>

#include "base/spill.h"

static uint32_t root_of(uint32_t *parents, uint32_t vertex)
{
	while (parents[vertex] != vertex) {
		parents[vertex] = parents[parents[vertex]];
		vertex = parents[vertex];
	}
	return vertex;
}

/* Returns for each vertex one of its part with a lower or equal number; NULL with errno. */
static uint32_t *find_parts(const struct mesh *mesh, uint32_t *count)
{
	uint32_t *parents = spill_alloc((mesh->vertex_count + (size_t)1) * sizeof(*parents));

	if (!parents)
		return NULL;
	*count = mesh->vertex_count;
	for (uint32_t i = 0; i < mesh->vertex_count; i++)
		parents[i] = i;
	for (uint32_t t = 0; t < mesh->triangle_count; t++) {
		for (int k = 0; k < 2; k++) {
			const uint32_t a = root_of(parents, mesh->triangles[t][k]);
			const uint32_t b = root_of(parents, mesh->triangles[t][k + 1]);

			*count -= a != b;
			parents[a > b ? a : b] = a < b ? a : b;
		}
		spill_pass(t);
	}
	return parents;
}

int mesh_parts_count(const struct mesh *mesh, uint32_t *out)
{
	uint32_t *parents = find_parts(mesh, out);

	spill_free(parents);
	return parents ? 0 : -errno;
}

int mesh_parts_find(const struct mesh *mesh, uint32_t **out)
{
	uint32_t parts;

	*out = find_parts(mesh, &parts);
	if (!*out)
		return -errno;
	for (uint32_t i = 0; i < mesh->vertex_count; i++) {
		(*out)[i] = root_of(*out, i);
		spill_pass(i);
	}
	return 0;
}

/* Removes vertices and triangles whose part is small, and numbers the vertices that stay anew.
 * parents: the root of each vertex; numbers: room for one each. */
static void compact(struct mesh *mesh, const uint32_t *parents, const uint32_t *sizes,
		    uint32_t *numbers, double least)
{
	uint32_t triangles = 0, vertices = 0;

	for (uint32_t i = 0; i < mesh->vertex_count; i++) {
		if (sizes[parents[i]] < least)
			continue;
		memmove(mesh->positions[vertices], mesh->positions[i], sizeof(mesh->positions[0]));
		if (mesh->colours)
			memmove(mesh->colours[vertices], mesh->colours[i],
				sizeof(mesh->colours[0]));
		numbers[i] = vertices++;
		spill_pass(i);
	}
	for (uint32_t t = 0; t < mesh->triangle_count; t++) {
		if (sizes[parents[mesh->triangles[t][0]]] < least)
			continue;
		for (int k = 0; k < 3; k++)
			mesh->triangles[triangles][k] = numbers[mesh->triangles[t][k]];
		triangles++;
		spill_pass(t);
	}
	mesh->triangle_count = triangles;
	mesh->vertex_count = vertices;
}

/* Sets the sizes of cavities to 0: of parts that enclose a volume below 0. parents: the root of
 * each vertex. */
static int forget_cavities(const struct mesh *mesh, const uint32_t *parents, uint32_t *sizes)
{
	double *volumes = spill_alloc((mesh->vertex_count + (size_t)1) * sizeof(*volumes));

	if (!volumes)
		return -errno;
	for (uint32_t t = 0; t < mesh->triangle_count; t++) {
		const uint32_t root = parents[mesh->triangles[t][0]];
		double p[3][3];

		/* from the part's own vertex, so that small volumes stay exact */
		for (int i = 0; i < 3; i++)
			for (int k = 0; k < 3; k++)
				p[i][k] = (double)mesh->positions[mesh->triangles[t][i]][k] -
					  (double)mesh->positions[root][k];
		for (int k = 0; k < 3; k++)
			volumes[root] += p[0][k] * (p[1][(k + 1) % 3] * p[2][(k + 2) % 3] -
						    p[1][(k + 2) % 3] * p[2][(k + 1) % 3]);
		spill_pass(t);
	}
	for (uint32_t i = 0; i < mesh->vertex_count; i++)
		if (parents[i] == i && volumes[i] < 0)
			sizes[i] = 0;
	spill_free(volumes);
	return 0;
}

int mesh_parts_drop(struct mesh *mesh, double share, bool with_cavities, uint32_t *dropped)
{
	const size_t bytes = (mesh->vertex_count + (size_t)1) * sizeof(uint32_t);
	uint32_t parts, largest = 0;
	uint32_t *parents = find_parts(mesh, &parts);
	uint32_t *sizes = parents ? spill_alloc(bytes) : NULL;
	uint32_t *numbers = sizes ? spill_alloc(bytes) : NULL;
	int rc = numbers ? 0 : -errno;

	*dropped = 0;
	for (uint32_t i = 0; i < mesh->vertex_count && rc == 0; i++) {
		parents[i] = root_of(parents, i);
		spill_pass(i);
	}
	for (uint32_t t = 0; t < mesh->triangle_count && rc == 0; t++) {
		sizes[parents[mesh->triangles[t][0]]]++;
		spill_pass(t);
	}
	if (rc == 0 && with_cavities)
		rc = forget_cavities(mesh, parents, sizes);
	for (uint32_t i = 0; i < mesh->vertex_count && rc == 0; i++)
		largest = sizes[i] > largest ? sizes[i] : largest;
	for (uint32_t i = 0; i < mesh->vertex_count && rc == 0; i++) {
		*dropped += parents[i] == i && sizes[i] < share * largest;
		spill_pass(i);
	}
	if (*dropped > 0)
		compact(mesh, parents, sizes, numbers, share * largest);
	spill_free(parents);
	spill_free(sizes);
	spill_free(numbers);
	return rc;
}
