/* Quantises a scan to its lattice: merges vertices at one place, drops bad triangles, finds normals
 * and open borders. */
#include "pipeline/hierarchy/lattice_mesh.h"

#include <errno.h>
#include <math.h>
#include <stdbool.h>
#include <stdlib.h>
#include <string.h>

#define NO_VERTEX   UINT32_MAX
#define NO_TRIANGLE UINT32_MAX

int lattice_of_box(struct lattice *out, const float min_m[3], const float max_m[3],
		   double step_max_m)
{
	double longest = 0.0;

	for (int i = 0; i < 3; i++) {
		out->origin_m[i] = min_m[i];
		longest = fmax(longest, (double)max_m[i] - min_m[i]);
	}
	out->fine_bits = 0;
	while (out->fine_bits < LATTICE_FINE_BITS_MAX && longest / lattice_last(out) > step_max_m)
		out->fine_bits++;
	out->step_m = longest / lattice_last(out);
	return longest > 0.0 && isfinite(longest) ? 0 : -EINVAL;
}

void lattice_place(int32_t out[3], const struct lattice *lattice, const float at_m[3])
{
	const int32_t last = lattice_last(lattice);

	for (int i = 0; i < 3; i++) {
		/* Half a step is added and the rest cut off: this is rounding, as no place is
		 * negative. */
		double steps = (at_m[i] - lattice->origin_m[i]) / lattice->step_m + 0.5;

		out[i] = (int32_t)(steps < 0 ? 0 : steps > last ? last : steps);
	}
}

void lattice_coarse(uint16_t out[3], const struct lattice *lattice, const int32_t place[3])
{
	for (int i = 0; i < 3; i++)
		out[i] = (uint16_t)(place[i] >> lattice->fine_bits);
}

int32_t lattice_last(const struct lattice *lattice)
{
	return (1 << (LATTICE_BITS + lattice->fine_bits)) - 1;
}

map_key lattice_key(const int32_t place[3])
{
	return (map_key)(uint32_t)place[2] << 64 | (uint64_t)(uint32_t)place[1] << 32 |
	       (uint32_t)place[0];
}

struct merged {
	uint32_t *to;       /* for each vertex of the scan, its vertex on the lattice */
	uint32_t (*sum)[4]; /* sums of colours */
	uint32_t *count;
};

/* Vertices by their place: open addressing, at most half full, as there is no more than one for
 * each vertex of the scan. */
struct places {
	uint32_t *slots; /* indices of vertices, or NO_VERTEX */
	size_t mask;
};

static int places_init(struct places *places, uint32_t vertex_count)
{
	size_t capacity = 64;

	while (capacity < 2 * (size_t)vertex_count)
		capacity *= 2;
	places->mask = capacity - 1;
	places->slots = malloc(capacity * sizeof(*places->slots));
	if (!places->slots)
		return -ENOMEM;
	memset(places->slots, 0xff, capacity * sizeof(*places->slots));
	return 0;
}

/* Returns the slot of the vertex at that position, or the free one where it would be. */
static uint32_t *places_slot(const struct places *places, const struct lattice_vertex *vertices,
			     const int32_t position[3])
{
	uint64_t place =
		(uint64_t)position[0] ^ (uint64_t)position[1] << 20 ^ (uint64_t)position[2] << 40;
	size_t at = (size_t)(place * 0x9e3779b97f4a7c15u >> 32) & places->mask;
	uint32_t *slot;

	for (;;) {
		slot = &places->slots[at];
		if (*slot == NO_VERTEX ||
		    memcmp(vertices[*slot].position, position, sizeof(int32_t[3])) == 0)
			return slot;
		at = (at + 1) & places->mask;
	}
}

/* Merges vertices at one place, in the order of their first appearance. */
static int merge_vertices(struct lattice_mesh *out, struct merged *merged, const struct mesh *mesh,
			  const uint8_t colour[3])
{
	const uint8_t plain[4] = { colour[0], colour[1], colour[2], 255 };
	struct places places;
	int rc = places_init(&places, mesh->vertex_count);

	if (rc < 0)
		return rc;
	for (uint32_t v = 0; v < mesh->vertex_count; v++) {
		const uint8_t *own = mesh->colours ? mesh->colours[v] : plain;
		int32_t position[3];
		uint32_t *slot;

		lattice_place(position, &out->lattice, mesh->positions[v]);
		slot = places_slot(&places, out->vertices, position);
		if (*slot == NO_VERTEX) {
			*slot = out->vertex_count++;
			memcpy(out->vertices[*slot].position, position, sizeof(position));
		}
		merged->to[v] = *slot;
		merged->count[*slot]++;
		for (int i = 0; i < 4; i++)
			merged->sum[*slot][i] += own[i];
	}
	free(places.slots);
	for (uint32_t v = 0; v < out->vertex_count; v++) {
		out->vertices[v].seen = 255;
		for (int i = 0; i < 4; i++)
			out->vertices[v].colour[i] =
				(uint8_t)((merged->sum[v][i] + merged->count[v] / 2) /
					  merged->count[v]);
	}
	return 0;
}

static void turn_smallest_first(uint32_t triangle[3])
{
	while (triangle[0] > triangle[1] || triangle[0] > triangle[2]) {
		uint32_t first = triangle[0];

		triangle[0] = triangle[1];
		triangle[1] = triangle[2];
		triangle[2] = first;
	}
}

/* Whether two triangles whose smallest vertex is the same one have the same corners, on whichever
 * side. A sheet that is there from both sides encloses nothing: its normals are no direction, and
 * collapses cancel it (collapse.h). One side is enough, because both are drawn. */
static bool is_copy(const uint32_t a[3], const uint32_t b[3])
{
	return (a[1] == b[1] && a[2] == b[2]) || (a[1] == b[2] && a[2] == b[1]);
}

static int keep_triangles(struct lattice_mesh *out, struct lattice_counts *counts,
			  const struct mesh *mesh, const uint32_t *to)
{
	/* Of each vertex, a list of the triangles that have it as their smallest. */
	uint32_t *first = malloc((out->vertex_count + (size_t)1) * sizeof(*first));
	uint32_t *next = malloc((mesh->triangle_count + (size_t)1) * sizeof(*next));
	int rc = first && next ? 0 : -ENOMEM;

	if (rc == 0)
		memset(first, 0xff, out->vertex_count * sizeof(*first));
	for (uint32_t t = 0; rc == 0 && t < mesh->triangle_count; t++) {
		uint32_t *kept = out->triangles[out->triangle_count], other;

		for (int corner = 0; corner < 3; corner++)
			kept[corner] = to[mesh->triangles[t][corner]];
		if (kept[0] == kept[1] || kept[1] == kept[2] || kept[2] == kept[0]) {
			counts->degenerate_triangles++;
			continue;
		}
		turn_smallest_first(kept);
		other = first[kept[0]];
		while (other != NO_TRIANGLE && !is_copy(out->triangles[other], kept))
			other = next[other];
		if (other != NO_TRIANGLE) {
			counts->duplicate_triangles++;
			continue;
		}
		next[out->triangle_count] = first[kept[0]];
		first[kept[0]] = out->triangle_count++;
	}
	free(first);
	free(next);
	if (rc < 0)
		return rc;
	return out->triangle_count > 0 ? 0 : -EINVAL;
}

/* A vertex without triangles would be in no patch. Drops such vertices, so that indices are
 * dense. */
static int drop_unused(struct lattice_mesh *mesh)
{
	uint32_t *to = calloc(mesh->vertex_count, sizeof(*to)), kept = 0;

	if (!to)
		return -ENOMEM;
	for (uint32_t t = 0; t < mesh->triangle_count; t++)
		for (int corner = 0; corner < 3; corner++)
			to[mesh->triangles[t][corner]] = 1;
	for (uint32_t v = 0; v < mesh->vertex_count; v++)
		if (to[v]) {
			mesh->vertices[kept] = mesh->vertices[v];
			to[v] = kept++;
		}
	mesh->vertex_count = kept;
	for (uint32_t t = 0; t < mesh->triangle_count; t++)
		for (int corner = 0; corner < 3; corner++)
			mesh->triangles[t][corner] = to[mesh->triangles[t][corner]];
	free(to);
	return 0;
}

static void add_normals(struct lattice_mesh *mesh)
{
	for (uint32_t t = 0; t < mesh->triangle_count; t++) {
		const uint32_t *triangle = mesh->triangles[t];
		double u[3], v[3];

		for (int i = 0; i < 3; i++) {
			double a = mesh->vertices[triangle[0]].position[i];

			u[i] = mesh->vertices[triangle[1]].position[i] - a;
			v[i] = mesh->vertices[triangle[2]].position[i] - a;
		}
		for (int i = 0; i < 3; i++) {
			double cross =
				u[(i + 1) % 3] * v[(i + 2) % 3] - u[(i + 2) % 3] * v[(i + 1) % 3];

			for (int corner = 0; corner < 3; corner++)
				mesh->vertices[triangle[corner]].normal[i] += (float)cross;
		}
	}
	for (uint32_t v = 0; v < mesh->vertex_count; v++) {
		float *n = mesh->vertices[v].normal;
		float length = sqrtf(n[0] * n[0] + n[1] * n[1] + n[2] * n[2]);

		for (int i = 0; i < 3; i++)
			n[i] = length > 0.0f ? n[i] / length : (i == 2);
	}
}

int lattice_mesh_find_borders(struct lattice_mesh *mesh, struct lattice_counts *counts,
			      const uint8_t *shared)
{
	struct incidence incidence;
	double crowded = 0.0;
	int rc = incidence_create(&incidence, mesh->triangles, mesh->triangle_count,
				  mesh->vertex_count);

	if (rc < 0)
		return rc;
	for (uint32_t t = 0; t < mesh->triangle_count; t++)
		for (int corner = 0; corner < 3; corner++) {
			uint32_t a = mesh->triangles[t][corner];
			uint32_t b = mesh->triangles[t][(corner + 1) % 3];
			uint32_t runs[2];

			if (shared && shared[a] && shared[b])
				continue;
			incidence_edge(runs, &incidence, mesh->triangles, a, b);
			/* The edge is visited once from each of its triangles but counts as one. */
			if (runs[0] + runs[1] > 2)
				crowded += 1.0 / (runs[0] + runs[1]);
			if (runs[0] == runs[1])
				continue;
			counts->border_edges++;
			mesh->vertices[a].border = mesh->vertices[b].border = 1;
		}
	counts->crowded_edges = (uint32_t)lrint(crowded);
	incidence_finish(&incidence);
	return 0;
}

static int build(struct lattice_mesh *out, struct lattice_counts *counts, const struct mesh *mesh,
		 const uint8_t colour[3])
{
	struct merged merged = {
		.to = malloc((mesh->vertex_count + 1) * sizeof(*merged.to)),
		.sum = calloc(mesh->vertex_count + 1, sizeof(*merged.sum)),
		.count = calloc(mesh->vertex_count + 1, sizeof(*merged.count)),
	};
	int rc = -ENOMEM;

	out->vertices = calloc(mesh->vertex_count + 1, sizeof(*out->vertices));
	out->triangles = malloc((mesh->triangle_count + 1) * sizeof(*out->triangles));
	if (merged.to && merged.sum && merged.count && out->vertices && out->triangles)
		rc = merge_vertices(out, &merged, mesh, colour);
	if (rc == 0) {
		counts->merged_vertices = mesh->vertex_count - out->vertex_count;
		rc = keep_triangles(out, counts, mesh, merged.to);
	}
	free(merged.to);
	free(merged.sum);
	free(merged.count);
	if (rc == 0)
		rc = drop_unused(out);
	if (rc == 0)
		add_normals(out);
	return rc;
}

int lattice_mesh_create(struct lattice_mesh *out, struct lattice_counts *counts,
			const struct mesh *mesh, const struct lattice *lattice,
			const uint8_t colour[3])
{
	int rc;

	*out = (struct lattice_mesh){ .lattice = *lattice };
	*counts = (struct lattice_counts){ 0 };
	rc = build(out, counts, mesh, colour);
	if (rc < 0)
		lattice_mesh_finish(out);
	return rc;
}

void lattice_mesh_finish(struct lattice_mesh *mesh)
{
	if (!mesh)
		return;
	free(mesh->vertices);
	free(mesh->triangles);
	*mesh = (struct lattice_mesh){ 0 };
}

void lattice_vertex_put(struct buffer *out, const struct lattice_vertex *vertex)
{
	for (int i = 0; i < 3; i++)
		buffer_put_u32(out, (uint32_t)vertex->position[i]);
	buffer_put_u8(out, vertex->border);
	buffer_put(out, vertex->colour, sizeof(vertex->colour));
	buffer_put_u8(out, vertex->seen);
	for (int i = 0; i < 3; i++)
		buffer_put_f32(out, vertex->normal[i]);
}

void lattice_vertex_get(struct lattice_vertex *out, struct reader *reader)
{
	for (int i = 0; i < 3; i++) {
		uint32_t place = reader_u32(reader);

		reader->failed |= place >= LATTICE_PLACES_MAX;
		out->position[i] = (int32_t)(place % LATTICE_PLACES_MAX);
	}
	out->border = reader_u8(reader);
	for (int i = 0; i < 4; i++)
		out->colour[i] = reader_u8(reader);
	out->seen = reader_u8(reader);
	for (int i = 0; i < 3; i++)
		out->normal[i] = reader_f32(reader);
}

int incidence_create(struct incidence *out, uint32_t (*triangles)[3], uint32_t triangle_count,
		     uint32_t vertex_count)
{
	out->first = calloc((size_t)vertex_count + 2, sizeof(*out->first));
	out->items = malloc(3 * (size_t)triangle_count * sizeof(*out->items) + 1);
	if (!out->first || !out->items) {
		incidence_finish(out);
		return -ENOMEM;
	}
	/* Counts are stored two places further on. Filling then leaves the starts one place further
	 * on, and no second array is needed. */
	for (uint32_t t = 0; t < triangle_count; t++)
		for (int corner = 0; corner < 3; corner++)
			out->first[triangles[t][corner] + 2]++;
	for (uint32_t v = 2; v < vertex_count + 2; v++)
		out->first[v] += out->first[v - 1];
	for (uint32_t t = 0; t < triangle_count; t++)
		for (int corner = 0; corner < 3; corner++)
			out->items[out->first[triangles[t][corner] + 1]++] = t;
	return 0;
}

void incidence_finish(struct incidence *incidence)
{
	if (!incidence)
		return;
	free(incidence->first);
	free(incidence->items);
	*incidence = (struct incidence){ 0 };
}

void incidence_edge(uint32_t counts[2], const struct incidence *incidence, uint32_t (*triangles)[3],
		    uint32_t a, uint32_t b)
{
	counts[0] = counts[1] = 0;
	for (uint32_t i = incidence->first[a]; i < incidence->first[a + 1]; i++) {
		const uint32_t *triangle = triangles[incidence->items[i]];
		int corner = triangle[0] == a ? 0 : triangle[1] == a ? 1 : 2;

		counts[0] += triangle[(corner + 1) % 3] == b;
		counts[1] += triangle[(corner + 2) % 3] == b;
	}
}
