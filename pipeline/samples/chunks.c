/* Sorts triangles by texture and Morton code and cuts the sequence into chunks. */
#include "pipeline/samples/chunks.h"

#include <errno.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/array.h"
#include "base/spill.h"

/* A triangle's position in the order in which chunks are cut. */
struct place {
	uint64_t key; /* texture, then Morton code of its centre */
	uint32_t triangle;
};

enum { KEY_BYTES = 8 };

/* Where the triangles of a chunk are. */
struct range {
	uint32_t first_vertex, vertex_count;
	uint64_t first_index;
	uint32_t index_count;
};

struct chunks {
	struct model model;
	struct range *ranges; /* owned; one per piece */
	/* owned, of spill_alloc */
	struct model_vertex *vertices;
	float (*uvs)[2]; /* NULL: the mesh has no texture coordinates */
	uint16_t *indices;
};

struct builder {
	const struct mesh *mesh;
	struct chunks *out;
	const uint8_t *colour;
	/* of spill_alloc */
	float (*normals)[3]; /* for each vertex of the mesh, not normalised */
	struct place *places;
	uint32_t *local; /* for each vertex of the mesh: its index in the last chunk that used it */
	uint32_t *seen_by; /* the number of that chunk plus one */
	uint32_t piece_room, range_room;
	uint32_t vertex_count, vertex_room;
	uint64_t index_count;
};

/* ---- as a surface */

static uint32_t choose_all(const struct model *model, const float eye_m[3], float detail_rad,
			   uint32_t *pieces)
{
	(void)eye_m;
	(void)detail_rad;
	for (uint32_t n = 0; n < model->piece_count; n++)
		pieces[n] = n;
	return model->piece_count;
}

static int load(struct model *model, uint32_t piece, struct model_mesh *out)
{
	const struct chunks *chunks = (const struct chunks *)model;
	const struct range *range = &chunks->ranges[piece];

	spill_breathe();
	*out = (struct model_mesh){
		.vertex_count = range->vertex_count,
		.index_count = range->index_count,
		.vertices = chunks->vertices + range->first_vertex,
		.uvs = chunks->uvs ? (const float(*)[2])chunks->uvs + range->first_vertex : NULL,
		.indices = chunks->indices + range->first_index,
	};
	return 0;
}

static void destroy(struct model *model)
{
	struct chunks *chunks = (struct chunks *)model;

	free(chunks->model.pieces);
	free(chunks->ranges);
	spill_free(chunks->vertices);
	spill_free(chunks->uvs);
	spill_free(chunks->indices);
	free(chunks);
}

static const struct model_methods methods = { choose_all, load, destroy };

/* ---- cutting */

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
		spill_pass(t);
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

static void find_box(struct builder *builder)
{
	const struct mesh *mesh = builder->mesh;
	struct model *out = &builder->out->model;

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
		spill_pass(t);
	}
}

static uint64_t key_of(const struct builder *builder, uint32_t triangle, float side)
{
	const struct mesh *mesh = builder->mesh;
	uint64_t key = mesh->materials ? (uint64_t)mesh->materials[triangle] << 48 : 0;

	for (int i = 0; i < 3; i++) {
		float sum = 0;

		for (int k = 0; k < 3; k++)
			sum += mesh->positions[mesh->triangles[triangle][k]][i];
		key |= spread((uint32_t)((sum / 3 - builder->out->model.low_m[i]) / side * 65535))
		       << i;
	}
	return key;
}

/* Sorts by one byte of the key, stably; the arrays swap. Does nothing if all have the same byte. */
static void sort_by_byte(struct place **from, struct place **to, uint32_t count, int byte)
{
	uint32_t start[257] = { 0 };
	struct place *swap = *from;

	for (uint32_t i = 0; i < count; i++) {
		start[((*from)[i].key >> (8 * byte) & 255) + 1]++;
		spill_pass(i);
	}
	for (int i = 0; i < 256; i++) {
		if (start[i + 1] == count)
			return;
		start[i + 1] += start[i];
	}
	for (uint32_t i = 0; i < count; i++) {
		(*to)[start[(*from)[i].key >> (8 * byte) & 255]++] = (*from)[i];
		spill_pass(i);
	}
	*from = *to;
	*to = swap;
}

static int find_places(struct builder *builder)
{
	const struct model *out = &builder->out->model;
	uint32_t count = builder->mesh->triangle_count;
	struct place *other = spill_alloc((size_t)count * sizeof(*other));
	float side = 1e-9f;

	if (!other)
		return -errno;
	for (int i = 0; i < 3; i++)
		side = fmaxf(side, out->high_m[i] - out->low_m[i]);
	for (uint32_t t = 0; t < count; t++) {
		builder->places[t] = (struct place){ key_of(builder, t, side), t };
		spill_pass(t);
	}
	for (int byte = 0; byte < KEY_BYTES; byte++)
		sort_by_byte(&builder->places, &other, count, byte);
	spill_free(other);
	return 0;
}

static int8_t signed_byte(float x)
{
	return (int8_t)lrintf(x * 127);
}

static void add_vertex(struct builder *builder, uint32_t vertex)
{
	const struct mesh *mesh = builder->mesh;
	struct model_vertex *to = &builder->out->vertices[builder->vertex_count];
	const float *n = builder->normals[vertex];
	float size = sqrtf(n[0] * n[0] + n[1] * n[1] + n[2] * n[2]);

	*to = (struct model_vertex){ 0 };
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
		memcpy(builder->out->uvs[builder->vertex_count], mesh->uvs[vertex],
		       2 * sizeof(float));
	builder->vertex_count++;
}

/* Makes room for one more chunk, even if its triangles share no vertices. */
static int reserve(struct builder *builder)
{
	struct chunks *out = builder->out;
	uint64_t wanted = (uint64_t)builder->vertex_count + 3 * CHUNK_TRIANGLES_MAX;
	uint64_t room = wanted + wanted / 2;
	int rc = ARRAY_RESERVE(out->model.pieces, builder->piece_room, out->model.piece_count + 1,
			       UINT32_MAX);

	if (rc == 0)
		rc = ARRAY_RESERVE(out->ranges, builder->range_room, out->model.piece_count + 1,
				   UINT32_MAX);
	if (rc < 0 || wanted <= builder->vertex_room)
		return rc;
	if (wanted > UINT32_MAX)
		return -EFBIG;
	room = room < UINT32_MAX ? room : UINT32_MAX;
	rc = SPILL_RESIZE(out->vertices, builder->vertex_room, room);
	if (rc == 0 && builder->mesh->uvs)
		rc = SPILL_RESIZE(out->uvs, builder->vertex_room, room);
	if (rc == 0)
		builder->vertex_room = (uint32_t)room;
	return rc;
}

/* Adds a chunk of triangles along the curve: all of one texture, at most CHUNK_TRIANGLES_MAX.
 * Returns how many were taken. */
static uint32_t add_chunk(struct builder *builder, const struct place *places, uint32_t left)
{
	struct chunks *out = builder->out;
	uint32_t number = out->model.piece_count++, count = 0;
	struct model_piece *piece = &out->model.pieces[number];
	struct range *range = &out->ranges[number];
	struct model_mesh mesh;

	*piece = (struct model_piece){ .texture = (uint16_t)(places->key >> 48) };
	*range = (struct range){ .first_vertex = builder->vertex_count,
				 .first_index = builder->index_count };
	while (count < left && count < CHUNK_TRIANGLES_MAX &&
	       places[count].key >> 48 == places->key >> 48) {
		const uint32_t *t = builder->mesh->triangles[places[count].triangle];

		for (int k = 0; k < 3; k++) {
			if (builder->seen_by[t[k]] != number + 1) {
				builder->seen_by[t[k]] = number + 1;
				builder->local[t[k]] = builder->vertex_count - range->first_vertex;
				add_vertex(builder, t[k]);
			}
			out->indices[builder->index_count++] = (uint16_t)builder->local[t[k]];
		}
		count++;
	}
	range->vertex_count = builder->vertex_count - range->first_vertex;
	range->index_count = 3 * count;
	if (load(&out->model, number, &mesh) == 0) {
		model_bound(piece, &mesh);
		model_sum(piece, &mesh);
	}
	return count;
}

static int build(struct builder *builder)
{
	const struct mesh *mesh = builder->mesh;
	size_t vertices = mesh->vertex_count, triangles = mesh->triangle_count;
	int rc;

	builder->normals = spill_alloc(vertices * sizeof(*builder->normals));
	builder->local = spill_alloc(vertices * sizeof(*builder->local));
	builder->seen_by = spill_alloc(vertices * sizeof(*builder->seen_by));
	builder->places = spill_alloc(triangles * sizeof(*builder->places));
	builder->out->indices = spill_alloc(triangles * 3 * sizeof(*builder->out->indices));
	if (!builder->normals || !builder->local || !builder->seen_by || !builder->places ||
	    !builder->out->indices)
		return -errno;
	sum_normals(builder);
	find_box(builder);
	rc = find_places(builder);
	for (uint32_t t = 0; t < mesh->triangle_count && rc == 0;) {
		rc = reserve(builder);
		if (rc == 0)
			t += add_chunk(builder, builder->places + t, mesh->triangle_count - t);
	}
	return rc;
}

int chunks_create(struct model **out, const struct mesh *mesh, const uint8_t colour[3])
{
	struct chunks *chunks = calloc(1, sizeof(*chunks));
	struct builder builder = { .mesh = mesh, .out = chunks, .colour = colour };
	int rc;

	*out = NULL;
	if (!chunks || mesh->triangle_count == 0) {
		free(chunks);
		return chunks ? -EINVAL : -ENOMEM;
	}
	chunks->model.methods = &methods;
	rc = build(&builder);
	spill_free(builder.normals);
	spill_free(builder.local);
	spill_free(builder.seen_by);
	spill_free(builder.places);
	if (rc < 0)
		destroy(&chunks->model);
	else
		*out = &chunks->model;
	return rc;
}
