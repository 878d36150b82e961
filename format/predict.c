/* Predicts positions, normals and colours of patch vertices from those already coded, in
 * integers. */
#include "format/predict.h"

#include <errno.h>
#include <stdbool.h>
#include <stdlib.h>
#include <string.h>

/* Hash table (open addressing) of the directed edges of the triangles so far, with the opposite
 * vertex of each. Its size is known and a slot takes 6 bytes, so it stays in the nearest cache;
 * docs/patch.md has what base/map would cost. */
struct edge_table {
	uint32_t *keys; /* (from << 16 | to) + 1; 0: free */
	uint16_t *apexes;
	uint32_t mask;
};

static int edge_table_init(struct edge_table *table, uint32_t edge_count)
{
	uint32_t size = 16;

	while (size < 2 * edge_count)
		size *= 2;
	*table = (struct edge_table){
		.keys = calloc(size, sizeof(*table->keys)),
		.apexes = malloc(size * sizeof(*table->apexes)),
		.mask = size - 1,
	};
	return table->keys && table->apexes ? 0 : -ENOMEM;
}

static void edge_table_finish(struct edge_table *table)
{
	free(table->keys);
	free(table->apexes);
}

static uint32_t edge_slot(const struct edge_table *table, uint16_t from, uint16_t to)
{
	uint32_t key = ((uint32_t)from << 16 | to) + 1;
	uint32_t at = key * 2654435761u >> 7 & table->mask;

	while (table->keys[at] != 0 && table->keys[at] != key)
		at = (at + 1) & table->mask;
	return at;
}

static void edge_table_put(struct edge_table *table, uint16_t from, uint16_t to, uint16_t apex)
{
	uint32_t at = edge_slot(table, from, to);

	table->keys[at] = ((uint32_t)from << 16 | to) + 1;
	table->apexes[at] = apex;
}

/* Finds the apex of a directed edge. The edge a-b of this triangle runs as b-a in its neighbour. */
static bool edge_table_find(const struct edge_table *table, uint16_t from, uint16_t to,
			    uint16_t *apex)
{
	uint32_t at = edge_slot(table, from, to);

	*apex = table->apexes[at];
	return table->keys[at] != 0;
}

static void step_in_triangle(struct predict_step *step, const struct edge_table *table,
			     const bool *known, const uint16_t triangle[3], int corner)
{
	uint16_t a = triangle[(corner + 1) % 3], b = triangle[(corner + 2) % 3], apex;

	*step = (struct predict_step){ .vertex = triangle[corner] };
	if (known[a])
		step->from[step->known_count++] = a;
	if (known[b] && b != a)
		step->from[step->known_count++] = b;
	if (step->known_count == 2 && edge_table_find(table, b, a, &apex))
		step->from[step->known_count++] = apex;
}

/* If no vertex of the triangle is known, the vertex coded before is the best guess. */
static void step_after(struct predict_step *step, const struct predict_step *first)
{
	if (step->known_count != 0 || step == first)
		return;
	step->known_count = 1;
	step->from[0] = (step - 1)->vertex;
}

int predict_steps(struct predict_step *steps, const struct patch_mesh *mesh)
{
	struct edge_table table;
	bool *known = calloc(mesh->vertex_count, sizeof(*known));
	struct predict_step *step = steps;
	int rc = edge_table_init(&table, 3 * mesh->triangle_count);

	if (!known)
		rc = -ENOMEM;
	for (uint32_t t = 0; rc == 0 && t < mesh->triangle_count; t++) {
		const uint16_t *triangle = mesh->indices + 3 * (size_t)t;

		for (int corner = 0; corner < 3; corner++) {
			if (known[triangle[corner]])
				continue;
			step_in_triangle(step, &table, known, triangle, corner);
			step_after(step, steps);
			known[triangle[corner]] = true;
			step++;
		}
		for (int corner = 0; corner < 3; corner++)
			edge_table_put(&table, triangle[corner], triangle[(corner + 1) % 3],
				       triangle[(corner + 2) % 3]);
	}
	for (uint32_t v = 0; rc == 0 && v < mesh->vertex_count; v++) {
		if (known[v])
			continue;
		*step = (struct predict_step){ .vertex = (uint16_t)v };
		step_after(step, steps);
		step++;
	}
	edge_table_finish(&table);
	free(known);
	return rc;
}

void predict_position(int32_t out[3], const struct predict_step *step,
		      const struct patch_vertex *vertices, const struct predict_range *range)
{
	for (int axis = 0; axis < 3; axis++) {
		const int32_t least = range->base[axis], last = least + range->most;
		int32_t at[3] = { least, 0, 0 }, guess;

		for (int i = 0; i < step->known_count; i++)
			at[i] = vertices[step->from[i]].position[axis];
		if (step->known_count == 3)
			guess = at[0] + at[1] - at[2];
		else if (step->known_count == 2)
			guess = (at[0] + at[1]) / 2;
		else
			guess = at[0];
		out[axis] = guess < least ? least : guess > last ? last : guess;
	}
}

void predict_colour(uint8_t out[4], const struct predict_step *step,
		    const struct patch_vertex *vertices)
{
	for (int i = 0; i < 4; i++) {
		if (step->known_count == 0)
			out[i] = i < 3 ? 128 : 255;
		else if (step->known_count == 1)
			out[i] = vertices[step->from[0]].colour[i];
		else
			out[i] = (uint8_t)((vertices[step->from[0]].colour[i] +
					    vertices[step->from[1]].colour[i]) /
					   2);
	}
}

/* The normal with the length of twice the area; at most 2^49 per axis, and 2^33 where places have
 * 16 bits. */
static void triangle_cross(int64_t out[3], const int32_t *a, const int32_t *b, const int32_t *c)
{
	int64_t u[3], v[3];

	for (int i = 0; i < 3; i++) {
		u[i] = b[i] - a[i];
		v[i] = c[i] - a[i];
	}
	for (int i = 0; i < 3; i++)
		out[i] = u[(i + 1) % 3] * v[(i + 2) % 3] - u[(i + 2) % 3] * v[(i + 1) % 3];
}

static int64_t divide_rounded(int64_t value, int64_t by)
{
	return value >= 0 ? (value + by / 2) / by : -((-value + by / 2) / by);
}

static int64_t magnitude(int64_t value)
{
	return value < 0 ? -value : value;
}

/* normal_encode in integers. 127 times a sum must fit in 64 bits; only the sums of large triangles
 * on a large site are halved for it. */
static void octahedral(int8_t out[2], int64_t n[3])
{
	int64_t sum, x, y;

	while (magnitude(n[0]) >> 49 || magnitude(n[1]) >> 49 || magnitude(n[2]) >> 49)
		for (int i = 0; i < 3; i++)
			n[i] /= 2;
	sum = magnitude(n[0]) + magnitude(n[1]) + magnitude(n[2]);
	if (sum == 0) {
		out[0] = out[1] = 0;
		return;
	}
	x = n[0];
	y = n[1];
	if (n[2] < 0) {
		x = (sum - magnitude(n[1])) * (n[0] >= 0 ? 1 : -1);
		y = (sum - magnitude(n[0])) * (n[1] >= 0 ? 1 : -1);
	}
	out[0] = (int8_t)divide_rounded(127 * x, sum);
	out[1] = (int8_t)divide_rounded(127 * y, sum);
}

int predict_normals(int8_t (*out)[2], const struct patch_mesh *mesh)
{
	int64_t(*sums)[3] = calloc(mesh->vertex_count, sizeof(*sums));

	if (!sums)
		return -ENOMEM;
	for (uint32_t t = 0; t < mesh->triangle_count; t++) {
		const uint16_t *triangle = mesh->indices + 3 * (size_t)t;
		int64_t cross[3];

		triangle_cross(cross, mesh->vertices[triangle[0]].position,
			       mesh->vertices[triangle[1]].position,
			       mesh->vertices[triangle[2]].position);
		for (int corner = 0; corner < 3; corner++)
			for (int i = 0; i < 3; i++)
				sums[triangle[corner]][i] += cross[i];
	}
	for (uint32_t v = 0; v < mesh->vertex_count; v++)
		octahedral(out[v], sums[v]);
	free(sums);
	return 0;
}
