/* Collects the edges of all faces by counting sort over their lower end, so that equal edges become
 * neighbours. */
#include "pipeline/import/mesh_edges.h"

#include <errno.h>
#include <stdlib.h>

#include "pipeline/import/mesh_places.h"

/* Up to this many are sorted by insertion. A vertex has six edges on average, and half of them are
 * stored here. */
enum { FEW = 64 };

static void sort_few(uint64_t *values, uint64_t count)
{
	for (uint64_t i = 1; i < count; i++) {
		uint64_t value = values[i], at = i;

		for (; at > 0 && values[at - 1] > value; at--)
			values[at] = values[at - 1];
		values[at] = value;
	}
}

static int compare_u64(const void *a, const void *b)
{
	uint64_t x = *(const uint64_t *)a, y = *(const uint64_t *)b;

	return x < y ? -1 : x > y;
}

/* Returns the lower end of edge k of the face; *item is as in the header. */
static uint32_t edge_of(const struct mesh *mesh, const uint32_t *place, uint32_t face, int k,
			uint64_t *item)
{
	uint32_t a = place[mesh->triangles[face][k]];
	uint32_t b = place[mesh->triangles[face][(k + 1) % 3]];

	*item = (uint64_t)(a < b ? b : a) << 33 | (uint64_t)(a < b) << 32 | face;
	return a < b ? a : b;
}

/* Counting sort: first counts the items of each vertex, then puts each item in its place. */
static void file_all(struct mesh_edges *edges, const struct mesh *mesh, const uint32_t *place)
{
	uint64_t item, *start = edges->start;

	for (uint32_t i = 0; i < mesh->triangle_count; i++)
		for (int k = 0; k < 3; k++)
			start[edge_of(mesh, place, i, k, &item) + 2]++;
	for (uint32_t i = 0; i < mesh->vertex_count; i++)
		start[i + 2] += start[i + 1];
	for (uint32_t i = 0; i < mesh->triangle_count; i++)
		for (int k = 0; k < 3; k++) {
			uint32_t low = edge_of(mesh, place, i, k, &item);

			edges->items[start[low + 1]++] = item;
		}
	for (uint32_t i = 0; i < mesh->vertex_count; i++) {
		uint64_t count = start[i + 1] - start[i];

		if (count > FEW)
			qsort(edges->items + start[i], count, sizeof(item), compare_u64);
		else
			sort_few(edges->items + start[i], count);
	}
}

int mesh_edges_init(struct mesh_edges *out, const struct mesh *mesh)
{
	uint32_t *place = mesh_places(mesh);

	*out = (struct mesh_edges){ .vertex_count = mesh->vertex_count };
	out->start = calloc((size_t)mesh->vertex_count + 2, sizeof(*out->start));
	out->items = malloc(((size_t)mesh->triangle_count * 3 + 1) * sizeof(*out->items));
	if (!place || !out->start || !out->items) {
		free(place);
		mesh_edges_finish(out);
		return -ENOMEM;
	}
	file_all(out, mesh, place);
	free(place);
	return 0;
}

void mesh_edges_finish(struct mesh_edges *edges)
{
	if (!edges)
		return;
	free(edges->start);
	free(edges->items);
	*edges = (struct mesh_edges){ 0 };
}

void mesh_edges_each(const struct mesh_edges *edges,
		     void (*visit)(void *data, const struct mesh_edge *edge), void *data)
{
	for (uint32_t vertex = 0; vertex < edges->vertex_count; vertex++) {
		uint64_t end = edges->start[vertex + 1], next;

		for (uint64_t i = edges->start[vertex]; i < end; i = next) {
			const uint64_t *items = edges->items + i;
			struct mesh_edge edge = { .ends = { vertex, (uint32_t)(items[0] >> 33) },
						  .faces = { (uint32_t)items[0] } };

			for (next = i + 1; next < end && edges->items[next] >> 33 == *items >> 33;)
				next++;
			edge.face_count = (uint32_t)(next - i);
			if (edge.face_count > 1)
				edge.faces[1] = (uint32_t)items[1];
			edge.turned = edge.face_count == 2 && items[0] >> 32 == items[1] >> 32;
			visit(data, &edge);
		}
	}
}
