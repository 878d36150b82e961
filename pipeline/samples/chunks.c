/* Sorts triangles by texture and Morton code and cuts the sequence into chunks; computes winding
 * numbers from them. */
#include "pipeline/samples/chunks.h"

#include <errno.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/array.h"

/* A triangle's position in the order in which chunks are cut. */
struct place {
	uint64_t key; /* texture, then Morton code of its centre */
	uint32_t triangle;
};

struct builder {
	const struct mesh *mesh;
	struct chunks *out;
	const uint8_t *colour;
	float (*normals)[3]; /* for each vertex of the mesh, not normalised */
	struct place *places;
	uint32_t *local; /* for each vertex of the mesh: its index in the last chunk that used it */
	uint32_t *seen_by; /* the number of that chunk plus one */
	uint32_t room, vertex_room, uv_room;
};

static void cross_of(const struct mesh *mesh, uint32_t triangle, double out[3])
{
	const uint32_t *t = mesh->triangles[triangle];
	double a[3], b[3];

	for (int i = 0; i < 3; i++) {
		a[i] = (double)mesh->positions[t[1]][i] - mesh->positions[t[0]][i];
		b[i] = (double)mesh->positions[t[2]][i] - mesh->positions[t[0]][i];
	}
	out[0] = a[1] * b[2] - a[2] * b[1];
	out[1] = a[2] * b[0] - a[0] * b[2];
	out[2] = a[0] * b[1] - a[1] * b[0];
}

static void sum_normals(struct builder *builder)
{
	const struct mesh *mesh = builder->mesh;

	for (uint32_t t = 0; t < mesh->triangle_count; t++) {
		double cross[3];

		cross_of(mesh, t, cross);
		for (int k = 0; k < 3; k++)
			for (int i = 0; i < 3; i++)
				builder->normals[mesh->triangles[t][k]][i] += (float)cross[i];
	}
}

/* Spreads 16 bits, with two zeros after each. */
static uint64_t spread(uint32_t x)
{
	uint64_t v = x & 0xffff;

	v = (v | v << 16) & 0x0000ff0000ffull;
	v = (v | v << 8) & 0x00f00f00f00full;
	v = (v | v << 4) & 0x0c30c30c30c3ull;
	return (v | v << 2) & 0x249249249249ull;
}

static int compare_places(const void *a, const void *b)
{
	const struct place *x = a, *y = b;

	if (x->key != y->key)
		return x->key < y->key ? -1 : 1;
	return x->triangle < y->triangle ? -1 : 1;
}

static void find_box(struct builder *builder)
{
	const struct mesh *mesh = builder->mesh;
	struct chunks *out = builder->out;

	for (int i = 0; i < 3; i++) {
		out->low_m[i] = INFINITY;
		out->high_m[i] = -INFINITY;
	}
	for (uint32_t t = 0; t < mesh->triangle_count; t++) {
		for (int k = 0; k < 3; k++) {
			const float *p = mesh->positions[mesh->triangles[t][k]];

			for (int i = 0; i < 3; i++) {
				out->low_m[i] = fminf(out->low_m[i], p[i]);
				out->high_m[i] = fmaxf(out->high_m[i], p[i]);
			}
		}
	}
}

static void find_places(struct builder *builder)
{
	const struct mesh *mesh = builder->mesh;
	const struct chunks *out = builder->out;
	float side = 1e-9f;

	for (int i = 0; i < 3; i++)
		side = fmaxf(side, out->high_m[i] - out->low_m[i]);
	for (uint32_t t = 0; t < mesh->triangle_count; t++) {
		uint64_t key = mesh->materials ? (uint64_t)mesh->materials[t] << 48 : 0;

		for (int i = 0; i < 3; i++) {
			float sum = 0;

			for (int k = 0; k < 3; k++)
				sum += mesh->positions[mesh->triangles[t][k]][i];
			key |= spread((uint32_t)((sum / 3 - out->low_m[i]) / side * 65535)) << i;
		}
		builder->places[t] = (struct place){ key, t };
	}
	qsort(builder->places, mesh->triangle_count, sizeof(*builder->places), compare_places);
}

static int8_t signed_byte(float x)
{
	return (int8_t)lrintf(x * 127);
}

static void add_vertex(struct builder *builder, uint32_t vertex)
{
	const struct mesh *mesh = builder->mesh;
	struct chunk_vertex *to = &builder->out->vertices[builder->out->vertex_count];
	const float *n = builder->normals[vertex];
	float size = sqrtf(n[0] * n[0] + n[1] * n[1] + n[2] * n[2]);

	*to = (struct chunk_vertex){ 0 };
	memcpy(to->position_m, mesh->positions[vertex], sizeof(to->position_m));
	for (int i = 0; i < 3; i++)
		to->normal[i] = size > 0 ? signed_byte(n[i] / size) : (i == 2 ? 127 : 0);
	if (mesh->colours) {
		memcpy(to->colour, mesh->colours[vertex], 4);
	} else {
		memcpy(to->colour, builder->colour, 3);
		to->colour[3] = 255;
	}
	if (builder->out->uvs)
		memcpy(builder->out->uvs[builder->out->vertex_count], mesh->uvs[vertex],
		       2 * sizeof(float));
	builder->out->vertex_count++;
}

/* Makes room for one more chunk, even if its triangles share no vertices. */
static int reserve(struct builder *builder)
{
	struct chunks *out = builder->out;
	uint64_t wanted = (uint64_t)out->vertex_count + 3 * CHUNK_TRIANGLES_MAX;
	int rc = ARRAY_RESERVE(out->items, builder->room, out->count + 1, UINT32_MAX);

	if (rc == 0)
		rc = ARRAY_RESERVE(out->vertices, builder->vertex_room, wanted, UINT32_MAX);
	if (rc == 0 && builder->mesh->uvs)
		rc = ARRAY_RESERVE(out->uvs, builder->uv_room, wanted, UINT32_MAX);
	return rc;
}

/* Sets the bounding box and the far-field values of a chunk. */
static void finish_chunk(const struct builder *builder, struct chunk *chunk,
			 const struct place *places, uint32_t count)
{
	double area[3] = { 0 }, middle[3] = { 0 }, weight = 0;

	for (int i = 0; i < 3; i++) {
		chunk->low_m[i] = INFINITY;
		chunk->high_m[i] = -INFINITY;
	}
	for (uint32_t n = 0; n < count; n++) {
		const uint32_t *t = builder->mesh->triangles[places[n].triangle];
		double cross[3], size;

		cross_of(builder->mesh, places[n].triangle, cross);
		size = sqrt(cross[0] * cross[0] + cross[1] * cross[1] + cross[2] * cross[2]) / 2;
		weight += size;
		for (int i = 0; i < 3; i++) {
			area[i] += cross[i] / 2;
			for (int k = 0; k < 3; k++) {
				float p = builder->mesh->positions[t[k]][i];

				middle[i] += size * p / 3;
				chunk->low_m[i] = fminf(chunk->low_m[i], p);
				chunk->high_m[i] = fmaxf(chunk->high_m[i], p);
			}
		}
	}
	for (int i = 0; i < 3; i++) {
		float low = chunk->low_m[i], high = chunk->high_m[i], reach;

		chunk->area_m2[i] = (float)area[i];
		chunk->middle_m[i] = weight > 0 ? (float)(middle[i] / weight) : (low + high) / 2;
		reach = fmaxf(high - chunk->middle_m[i], chunk->middle_m[i] - low);
		chunk->radius_m += reach * reach;
	}
	chunk->radius_m = sqrtf(chunk->radius_m);
}

/* Adds a chunk of triangles along the curve: all of one texture, at most CHUNK_TRIANGLES_MAX.
 * Returns how many were taken. */
static uint32_t add_chunk(struct builder *builder, const struct place *places, uint32_t left)
{
	struct chunks *out = builder->out;
	struct chunk *chunk = &out->items[out->count++];
	uint32_t count = 0;

	*chunk = (struct chunk){ .first_vertex = out->vertex_count,
				 .first_index = out->index_count,
				 .texture = (uint16_t)(places->key >> 48) };
	while (count < left && count < CHUNK_TRIANGLES_MAX &&
	       places[count].key >> 48 == places->key >> 48) {
		const uint32_t *t = builder->mesh->triangles[places[count].triangle];

		for (int k = 0; k < 3; k++) {
			if (builder->seen_by[t[k]] != out->count) {
				builder->seen_by[t[k]] = out->count;
				builder->local[t[k]] = out->vertex_count - chunk->first_vertex;
				add_vertex(builder, t[k]);
			}
			out->indices[out->index_count++] = (uint16_t)builder->local[t[k]];
		}
		count++;
	}
	chunk->vertex_count = out->vertex_count - chunk->first_vertex;
	chunk->index_count = 3 * count;
	finish_chunk(builder, chunk, places, count);
	return count;
}

static int build(struct builder *builder)
{
	const struct mesh *mesh = builder->mesh;
	uint32_t vertices = mesh->vertex_count ? mesh->vertex_count : 1;

	builder->normals = calloc(vertices, sizeof(*builder->normals));
	builder->local = malloc(vertices * sizeof(*builder->local));
	builder->seen_by = calloc(vertices, sizeof(*builder->seen_by));
	builder->places = malloc(mesh->triangle_count * sizeof(*builder->places));
	builder->out->indices =
		malloc((size_t)mesh->triangle_count * 3 * sizeof(*builder->out->indices));
	if (!builder->normals || !builder->local || !builder->seen_by || !builder->places ||
	    !builder->out->indices)
		return -ENOMEM;
	sum_normals(builder);
	find_box(builder);
	find_places(builder);
	for (uint32_t t = 0; t < mesh->triangle_count;) {
		int rc = reserve(builder);

		if (rc < 0)
			return rc;
		t += add_chunk(builder, builder->places + t, mesh->triangle_count - t);
	}
	return 0;
}

int chunks_init(struct chunks *out, const struct mesh *mesh, const uint8_t colour[3])
{
	struct builder builder = { .mesh = mesh, .out = out, .colour = colour };
	int rc;

	*out = (struct chunks){ 0 };
	if (mesh->triangle_count == 0)
		return -EINVAL;
	rc = build(&builder);
	free(builder.normals);
	free(builder.local);
	free(builder.seen_by);
	free(builder.places);
	if (rc < 0)
		chunks_finish(out);
	return rc;
}

void chunks_finish(struct chunks *chunks)
{
	if (!chunks)
		return;
	free(chunks->items);
	free(chunks->vertices);
	free(chunks->uvs);
	free(chunks->indices);
	*chunks = (struct chunks){ 0 };
}

static double dot(const double a[3], const double b[3])
{
	return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

/* Half the solid angle of a triangle, signed (Van Oosterom and Strackee 1983). */
static double half_angle(double v[3][3])
{
	double size[3], determinant, below;

	for (int k = 0; k < 3; k++)
		size[k] = sqrt(dot(v[k], v[k]));
	determinant = v[0][0] * (v[1][1] * v[2][2] - v[1][2] * v[2][1]) +
		      v[0][1] * (v[1][2] * v[2][0] - v[1][0] * v[2][2]) +
		      v[0][2] * (v[1][0] * v[2][1] - v[1][1] * v[2][0]);
	below = size[0] * size[1] * size[2] + dot(v[0], v[1]) * size[2] +
		dot(v[1], v[2]) * size[0] + dot(v[2], v[0]) * size[1];
	return atan2(determinant, below);
}

static double chunk_angle(const struct chunks *chunks, const struct chunk *chunk,
			  const float point_m[3])
{
	const struct chunk_vertex *vertices = chunks->vertices + chunk->first_vertex;
	double sum = 0;

	for (uint32_t i = 0; i < chunk->index_count; i += 3) {
		double v[3][3];

		for (int k = 0; k < 3; k++) {
			uint16_t index = chunks->indices[chunk->first_index + i + (uint32_t)k];

			for (int c = 0; c < 3; c++)
				v[k][c] = (double)vertices[index].position_m[c] - point_m[c];
		}
		sum += half_angle(v);
	}
	return 2 * sum;
}

double chunks_winding(const struct chunks *chunks, const float point_m[3])
{
	double sum = 0;

	for (uint32_t n = 0; n < chunks->count; n++) {
		const struct chunk *chunk = &chunks->items[n];
		double away[3], area[3], distance;

		for (int i = 0; i < 3; i++) {
			away[i] = (double)chunk->middle_m[i] - point_m[i];
			area[i] = chunk->area_m2[i];
		}
		distance = sqrt(dot(away, away));
		if (distance > 3.0 * chunk->radius_m)
			sum += dot(area, away) / (distance * distance * distance);
		else
			sum += chunk_angle(chunks, chunk, point_m);
	}
	return sum / (4 * M_PI);
}
