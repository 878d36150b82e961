/* Codes the base and the records of a streaming mesh; see docs/stream.md. */
#include "format/stream_code.h"

#include <errno.h>
#include <string.h>

#include "format/root_page.h"

enum { INDEX_BITS = 21, POSITION_BITS = 25, RING_VERTICES_MAX = 2 * STREAM_RING_MAX };

/* The triangles at a vertex in the order of its list: of each the next vertex and the one before.
 */
struct ring {
	uint32_t degree, next[STREAM_RING_MAX], before[STREAM_RING_MAX];
};

static bool get_ring(struct ring *ring, const struct stream_mesh *mesh, uint32_t vertex)
{
	ring->degree = 0;
	for (uint32_t at = mesh->first[vertex]; at != STREAM_NONE; at = mesh->next[at]) {
		const uint32_t *corners = mesh->triangles[at / 3];
		uint32_t c = at % 3;

		if (ring->degree == STREAM_RING_MAX)
			return false;
		ring->next[ring->degree] = corners[c == 2 ? 0 : c + 1];
		ring->before[ring->degree++] = corners[c == 0 ? 2 : c - 1];
	}
	return true;
}

/* ---- which triangles move, and which are new */

/* The model is chosen by what the triangles that share an edge with this one do, as far as known,
 * and by the number of triangles: in a surface, those that move lie side by side. */
static force_inline void code_moved(struct stream_coder *c, struct symbol_coder *coder,
				    const struct ring *ring, struct stream_record *record)
{
	uint32_t moved = 0, size = ring->degree < 9 ? ring->degree : 9;

	for (uint32_t i = 0; i < ring->degree; i++) {
		uint32_t beside[2] = { 0, 0 };

		for (uint32_t j = 0; j < i; j++)
			if (ring->next[j] == ring->before[i] || ring->before[j] == ring->next[i])
				beside[moved >> j & 1]++;
		for (int side = 0; side < 2; side++)
			beside[side] = beside[side] < 2 ? beside[side] : 2;
		moved |= symbol_code(coder, &c->moved[(beside[0] * 3 + beside[1]) * 9 + size - 1],
				     2, record->moved >> i & 1)
			 << i;
	}
	record->moved = moved;
}

/* How many more triangles run from the vertex to x than back, among those that move or stay; at
 * most 1 either way. */
static force_inline int balance(const struct ring *ring, uint32_t members, uint32_t x)
{
	int sum = 0;

	for (uint32_t i = 0; i < ring->degree; i++)
		if (members >> i & 1)
			sum += (ring->next[i] == x) - (ring->before[i] == x);
	return sum < -1 ? -1 : sum > 1 ? 1 : sum;
}

static bool has_face(const struct stream_record *record, uint32_t face)
{
	for (int f = 0; f < STREAM_FACES_MAX; f++)
		if (record->faces[f] == face)
			return true;
	return false;
}

/* For each neighbour x one of four symbols: no new triangle, old-new-x, new-old-x, both. The model
 * is chosen by the balances of the edges to x, which inside a surface say it for certain. */
static force_inline int code_faces(struct stream_coder *c, struct symbol_coder *coder,
				   const struct ring *ring, struct stream_record *record)
{
	uint32_t seen[RING_VERTICES_MAX], seen_count = 0, face_count = 0;
	uint8_t faces[STREAM_FACES_MAX] = { 0 };

	for (uint32_t slot = 0; slot < 2 * ring->degree; slot++) {
		uint32_t i = slot / 2, x = slot & 1 ? ring->before[i] : ring->next[i], known = 0;
		uint32_t face = STREAM_FACE | i | (slot & 1 ? STREAM_FACE_BEFORE : 0), model;
		uint32_t symbol;

		while (known < seen_count && seen[known] != x)
			known++;
		if (known < seen_count)
			continue;
		seen[seen_count++] = x;
		model = (uint32_t)(3 * (balance(ring, ~record->moved, x) + 1) +
				   balance(ring, record->moved, x) + 1);
		symbol = symbol_code(coder, &c->faces[model], 4,
				     (has_face(record, face) ? 1 : 0) |
					     (has_face(record, face | STREAM_FACE_BACK) ? 2 : 0));
		for (uint32_t back = 0; back < 2; back++) {
			if (!(symbol >> back & 1))
				continue;
			if (face_count == STREAM_FACES_MAX)
				return -EBADMSG;
			faces[face_count++] = (uint8_t)(face | (back ? STREAM_FACE_BACK : 0));
		}
	}
	memcpy(record->faces, faces, sizeof(faces));
	return 0;
}

/* ---- vertices: predicted from neighbours with smaller numbers */

/* What is known around a vertex: the neighbours with smaller numbers, or the vertex before. */
struct around {
	int64_t sum[3];
	int32_t low[3], high[3];
	int32_t colour[4], colour_low[4], colour_high[4];
	uint32_t count;
};

static force_inline void around_add(struct around *around, const struct patch_vertex *vertex)
{
	for (int i = 0; i < 3; i++) {
		int32_t at = vertex->position[i];

		around->sum[i] += at;
		around->low[i] = around->count && around->low[i] < at ? around->low[i] : at;
		around->high[i] = around->count && around->high[i] > at ? around->high[i] : at;
	}
	for (int i = 0; i < 4; i++) {
		int32_t at = vertex->colour[i];

		around->colour[i] += at;
		around->colour_low[i] =
			around->count && around->colour_low[i] < at ? around->colour_low[i] : at;
		around->colour_high[i] =
			around->count && around->colour_high[i] > at ? around->colour_high[i] : at;
	}
	around->count++;
}

static force_inline void look_around(struct around *around, const struct stream_mesh *mesh,
				     uint32_t vertex)
{
	*around = (struct around){ 0 };
	for (uint32_t at = mesh->first[vertex]; at != STREAM_NONE; at = mesh->next[at])
		for (uint32_t c = 0; c < 3; c++) {
			uint32_t other = mesh->triangles[at / 3][c];

			if (other < vertex && around->count < 4 * STREAM_RING_MAX)
				around_add(around, &mesh->vertices[other]);
		}
	if (around->count == 0 && vertex > 0)
		around_add(around, &mesh->vertices[vertex - 1]);
}

static force_inline int code_position(struct stream_coder *c, struct symbol_coder *coder,
				      struct stream_mesh *mesh, uint32_t vertex,
				      const struct around *around)
{
	int32_t *position = mesh->vertices[vertex].position, largest = 0, extents[3];
	uint8_t zeros = c->precision.position_zeros;
	bool alone = around->count < 2;

	for (int i = 0; i < 3; i++) {
		extents[i] = (around->high[i] - around->low[i]) >> zeros;
		largest = extents[i] > largest ? extents[i] : largest;
	}
	for (int i = 0; i < 3; i++) {
		int32_t guess =
			around->count ? (int32_t)(around->sum[i] / around->count) >> zeros : 0;
		uint32_t model =
			alone ? around->count : predict_position_model(extents[i], largest);
		int64_t at = guess +
			     (int64_t)symbol_unfold(symbol_code_number(
				     coder, &c->positions[model],
				     symbol_fold((position[i] >> zeros) - guess), POSITION_BITS));

		if (at < 0 || at > (LATTICE_PLACES_MAX - 1) >> zeros)
			return -EBADMSG;
		position[i] = (int32_t)at << zeros;
	}
	return 0;
}

/* The area-weighted normal of the vertex' triangles. Of a base's vertices with many triangles, the
 * first ones, so that the sum does not overflow. */
static force_inline void code_normal(struct stream_coder *c, struct symbol_coder *coder,
				     struct stream_mesh *mesh, uint32_t vertex)
{
	int bits = c->precision.normal_bits;
	uint32_t count = 0;
	int64_t sum[3] = { 0 };
	int8_t *normal = mesh->vertices[vertex].normal, guess[2];

	for (uint32_t at = mesh->first[vertex]; at != STREAM_NONE && count < 2 * STREAM_RING_MAX;
	     at = mesh->next[at], count++) {
		const uint32_t *corners = mesh->triangles[at / 3];

		predict_add_cross(sum, mesh->vertices[corners[0]].position,
				  mesh->vertices[corners[1]].position,
				  mesh->vertices[corners[2]].position);
	}
	predict_octahedral(guess, sum);
	for (int i = 0; i < 2; i++) {
		int32_t value = precision_shorten_normal(guess[i], bits);

		value += symbol_code_difference(coder, &c->normals[i],
						precision_shorten_normal(normal[i], bits) - value,
						bits);
		normal[i] = precision_widen_normal(
			(int8_t)((int8_t)(uint8_t)((uint32_t)value << (8 - bits)) >> (8 - bits)),
			bits);
	}
}

/* Red and blue change with green. */
static force_inline void code_colour(struct stream_coder *c, struct symbol_coder *coder,
				     struct stream_mesh *mesh, uint32_t vertex,
				     const struct around *around)
{
	int bits = c->precision.colour_bits, open_bits = c->precision.open_bits;
	int32_t mask = (1 << bits) - 1, open_mask = (1 << open_bits) - 1;
	int32_t guess[4], differences[4];
	uint8_t *colour = mesh->vertices[vertex].colour;
	uint32_t spread[4];

	for (int i = 0; i < 4; i++) {
		int drop = 8 - (i < 3 ? bits : open_bits);

		guess[i] = around->count ? around->colour[i] / (int32_t)around->count >> drop : 0;
		spread[i] = (uint32_t)(around->colour_high[i] - around->colour_low[i]) >> drop;
		differences[i] = (colour[i] >> drop) - guess[i];
	}
	spread[1] = predict_bit_length((int32_t)spread[1]);
	spread[1] = spread[1] < PREDICT_COLOUR_MODELS ? spread[1] : PREDICT_COLOUR_MODELS - 1;
	spread[3] = spread[3] < PREDICT_OPEN_MODELS ? spread[3] : PREDICT_OPEN_MODELS - 1;
	differences[1] = symbol_code_difference(coder, &c->greens[spread[1]], differences[1], bits);
	for (int i = 0; i < 3; i += 2)
		differences[i] = differences[1] +
				 symbol_code_difference(coder, &c->tints[i / 2],
							differences[i] - differences[1], bits);
	differences[3] =
		symbol_code_difference(coder, &c->opens[spread[3]], differences[3], open_bits);
	for (int i = 0; i < 4; i++)
		colour[i] = precision_widen(
			(uint8_t)((guess[i] + differences[i]) & (i < 3 ? mask : open_mask)),
			i < 3 ? bits : open_bits);
}

/* Codes all positions of some new vertices, then the rest, which is predicted from them. */
static force_inline int code_vertices(struct stream_coder *c, struct symbol_coder *coder,
				      struct stream_mesh *mesh, uint32_t first)
{
	struct around around = { 0 };
	int rc = 0;

	for (uint32_t v = first; rc == 0 && v < mesh->vertex_count; v++) {
		look_around(&around, mesh, v);
		rc = code_position(c, coder, mesh, v, &around);
	}
	for (uint32_t v = first; rc == 0 && v < mesh->vertex_count; v++) {
		if (mesh->vertex_count > first + 1)
			look_around(&around, mesh, v);
		code_normal(c, coder, mesh, v);
		code_colour(c, coder, mesh, v, &around);
		memset(mesh->vertices[v].zero, 0, sizeof(mesh->vertices[v].zero));
	}
	return rc;
}

/* ---- base and records */

/* A corner is 0 if it is the next vertex, or how far back from there its vertex is. */
static force_inline int code_base_of(struct stream_coder *c, struct symbol_coder *coder,
				     struct stream_mesh *mesh, uint32_t vertex_count,
				     uint32_t triangle_count)
{
	uint32_t next = 0;

	if (!coder->encoder)
		for (uint32_t v = 0; v < vertex_count; v++)
			stream_mesh_add_vertex(mesh);
	for (uint32_t t = 0; t < triangle_count; t++) {
		uint32_t corners[3] = { 0 };

		if (coder->encoder)
			memcpy(corners, mesh->triangles[t], sizeof(corners));
		for (int i = 0; i < 3; i++) {
			uint32_t back = symbol_code_number(coder, &c->corner, next - corners[i],
							   INDEX_BITS);

			if (back > next || next - back >= vertex_count)
				return -EBADMSG;
			corners[i] = next - back;
			next += back == 0;
		}
		if (corners[0] == corners[1] || corners[1] == corners[2] ||
		    corners[2] == corners[0])
			return -EBADMSG;
		if (!coder->encoder)
			stream_mesh_add_triangle(mesh, corners);
	}
	return code_vertices(c, coder, mesh, 0);
}

static force_inline int code_split(struct stream_coder *c, struct symbol_coder *coder,
				   const struct stream_mesh *mesh, struct stream_record *record)
{
	uint32_t count = mesh->vertex_count;
	struct ring ring;
	uint32_t gap = (record->target + count - c->last_target) % (count ? count : 1);

	gap = symbol_code_number(coder, &c->gap, gap, INDEX_BITS);
	if (gap >= count)
		return -EBADMSG;
	record->target = (uint32_t)((c->last_target + (uint64_t)gap) % count);
	if (!get_ring(&ring, mesh, record->target))
		return -EBADMSG;
	code_moved(c, coder, &ring, record);
	return code_faces(c, coder, &ring, record);
}

static force_inline int code_record_of(struct stream_coder *c, struct symbol_coder *coder,
				       struct stream_mesh *mesh, struct stream_record *record)
{
	uint32_t piece = symbol_code(coder, &c->kind, 2, record->target == STREAM_NONE);
	uint32_t first = mesh->vertex_count;
	int rc = 0;

	if (piece) {
		record->target = STREAM_NONE;
		record->moved = 3 + symbol_code(coder, &c->piece_size, 2, record->moved - 3);
		record->faces[0] = (uint8_t)symbol_code_bits(coder, record->faces[0], 8);
		record->faces[1] = record->faces[2] = record->faces[3] = 0;
	} else {
		rc = code_split(c, coder, mesh, record);
	}
	if (rc < 0)
		return rc;
	if (!stream_record_fits(mesh, record))
		return -EBADMSG;
	stream_mesh_apply(mesh, record);
	rc = code_vertices(c, coder, mesh, first);
	if (rc < 0)
		stream_mesh_undo(mesh, record);
	else if (!piece)
		c->last_target = record->target;
	return rc;
}

int stream_code_base(struct stream_coder *coder, struct stream_mesh *mesh, uint32_t vertex_count,
		     uint32_t triangle_count)
{
	return code_base_of(coder, &coder->coder, mesh, vertex_count, triangle_count);
}

int stream_code_record(struct stream_coder *coder, struct stream_mesh *mesh,
		       struct stream_record *record)
{
	struct symbol_coder copy = { NULL, coder->coder.decoder };
	int rc;

	if (coder->coder.encoder)
		return code_record_of(coder, &coder->coder, mesh, record);
	rc = code_record_of(coder, &copy, mesh, record);
	coder->coder.decoder = copy.decoder;
	return rc;
}
