/* Applies and undoes the records of a streaming mesh (paper P3, section 3.6.1). */
#include "format/stream_mesh.h"

#include <assert.h>
#include <errno.h>
#include <stdlib.h>

int stream_mesh_init(struct stream_mesh *mesh, uint32_t vertex_room, uint32_t triangle_room)
{
	*mesh = (struct stream_mesh){ .vertex_room = vertex_room, .triangle_room = triangle_room };
	if (vertex_room > STREAM_VERTICES_MAX || triangle_room > STREAM_TRIANGLES_MAX)
		return -EINVAL;
	mesh->vertices = calloc(vertex_room + 1, sizeof(*mesh->vertices));
	mesh->triangles = calloc(triangle_room + 1, sizeof(*mesh->triangles));
	mesh->first = calloc(vertex_room + 1, sizeof(*mesh->first));
	mesh->next = calloc(triangle_room + 1, 3 * sizeof(*mesh->next));
	if (mesh->vertices && mesh->triangles && mesh->first && mesh->next)
		return 0;
	stream_mesh_finish(mesh);
	return -ENOMEM;
}

void stream_mesh_finish(struct stream_mesh *mesh)
{
	if (!mesh)
		return;
	free(mesh->vertices);
	free(mesh->triangles);
	free(mesh->first);
	free(mesh->next);
	*mesh = (struct stream_mesh){ 0 };
}

void stream_mesh_add_vertex(struct stream_mesh *mesh)
{
	assert(mesh->vertex_count < mesh->vertex_room);
	mesh->first[mesh->vertex_count++] = STREAM_NONE;
}

void stream_mesh_add_triangle(struct stream_mesh *mesh, const uint32_t corners[3])
{
	uint32_t triangle = mesh->triangle_count++;

	assert(triangle < mesh->triangle_room);
	for (uint32_t c = 0; c < 3; c++) {
		uint32_t v = corners[c];

		assert(v < mesh->vertex_count);
		mesh->triangles[triangle][c] = v;
		mesh->next[3 * triangle + c] = mesh->first[v];
		mesh->first[v] = 3 * triangle + c;
	}
}

/* Its corners are the first of their lists, because it was added last. */
void stream_mesh_drop_triangle(struct stream_mesh *mesh)
{
	uint32_t triangle = --mesh->triangle_count;

	for (uint32_t c = 0; c < 3; c++)
		mesh->first[mesh->triangles[triangle][c]] = mesh->next[3 * triangle + c];
}

void stream_piece_face(uint32_t out[3], uint32_t face)
{
	static const uint8_t corners[4][3] = { { 1, 2, 3 }, { 0, 3, 2 }, { 0, 1, 3 }, { 0, 2, 1 } };

	for (uint32_t c = 0; c < 3; c++)
		out[c] = corners[face % 4][face < 4 ? c : 2 - c];
}

static bool piece_fits(const struct stream_mesh *mesh, const struct stream_record *record)
{
	uint32_t count = record->moved, faces = record->faces[0];

	/* Of three vertices, only the triangle that lacks the fourth. */
	return (count == STREAM_PIECE_VERTICES || (count == 3 && !(faces & 0x77))) &&
	       record->faces[1] == 0 && record->faces[2] == 0 && record->faces[3] == 0 &&
	       mesh->vertex_room - mesh->vertex_count >= count &&
	       mesh->triangle_room - mesh->triangle_count >= (uint32_t)__builtin_popcount(faces);
}

bool stream_record_fits(const struct stream_mesh *mesh, const struct stream_record *record)
{
	uint32_t degree = 0, face_count = 0;

	if (record->target == STREAM_NONE)
		return piece_fits(mesh, record);
	if (record->target >= mesh->vertex_count || mesh->vertex_count == mesh->vertex_room)
		return false;
	for (uint32_t at = mesh->first[record->target]; at != STREAM_NONE; at = mesh->next[at])
		if (++degree > STREAM_RING_MAX)
			return false;
	if (degree < 32 && record->moved >> degree)
		return false;
	for (uint32_t f = 0; f < STREAM_FACES_MAX; f++) {
		uint8_t face = record->faces[f];

		if (face == 0)
			continue;
		if (!(face & STREAM_FACE) || (face & STREAM_FACE_CORNER) >= degree ||
		    f != face_count)
			return false;
		face_count++;
	}
	return mesh->triangle_room - mesh->triangle_count >= face_count;
}

static void apply_piece(struct stream_mesh *mesh, const struct stream_record *record)
{
	uint32_t base = mesh->vertex_count, corners[3];

	for (uint32_t v = 0; v < record->moved; v++)
		stream_mesh_add_vertex(mesh);
	for (uint32_t face = 0; face < 2 * STREAM_PIECE_FACES; face++) {
		if (!(record->faces[0] >> face & 1))
			continue;
		stream_piece_face(corners, face);
		for (int c = 0; c < 3; c++)
			corners[c] += base;
		stream_mesh_add_triangle(mesh, corners);
	}
}

void stream_mesh_apply(struct stream_mesh *mesh, const struct stream_record *record)
{
	uint32_t old = record->target, new = mesh->vertex_count, at, i = 0;
	uint32_t *stays, *moves, thirds[STREAM_FACES_MAX] = { 0 };

	if (old == STREAM_NONE) {
		apply_piece(mesh, record);
		return;
	}
	for (at = mesh->first[old]; at != STREAM_NONE; at = mesh->next[at], i++)
		for (int f = 0; f < STREAM_FACES_MAX && record->faces[f]; f++)
			if ((record->faces[f] & STREAM_FACE_CORNER) == i) {
				uint32_t turn = record->faces[f] & STREAM_FACE_BEFORE ? 2 : 1;

				thirds[f] = mesh->triangles[at / 3][(at % 3 + turn) % 3];
			}
	/* Part the list in two, each in the order of the one. */
	mesh->vertex_count++;
	at = mesh->first[old];
	stays = &mesh->first[old];
	moves = &mesh->first[new];
	for (i = 0; at != STREAM_NONE; at = mesh->next[at], i++) {
		if (record->moved >> i & 1) {
			mesh->triangles[at / 3][at % 3] = new;
			*moves = at;
			moves = &mesh->next[at];
		} else {
			*stays = at;
			stays = &mesh->next[at];
		}
	}
	*stays = *moves = STREAM_NONE;
	for (int f = 0; f < STREAM_FACES_MAX && record->faces[f]; f++) {
		bool back = record->faces[f] & STREAM_FACE_BACK;
		const uint32_t corners[3] = { back ? new : old, back ? old : new, thirds[f] };

		stream_mesh_add_triangle(mesh, corners);
	}
}

void stream_mesh_undo(struct stream_mesh *mesh, const struct stream_record *record)
{
	uint32_t old = record->target, new, at, other, i = 0, *end;

	if (old == STREAM_NONE) {
		for (int face = 0; face < __builtin_popcount(record->faces[0]); face++)
			stream_mesh_drop_triangle(mesh);
		mesh->vertex_count -= record->moved;
		return;
	}
	for (int f = 0; f < STREAM_FACES_MAX && record->faces[f]; f++)
		stream_mesh_drop_triangle(mesh);
	new = --mesh->vertex_count;
	/* Merge the two lists in the order of the bits. */
	at = mesh->first[old];
	other = mesh->first[new];
	end = &mesh->first[old];
	for (; at != STREAM_NONE || other != STREAM_NONE; i++) {
		uint32_t corner;

		if (record->moved >> i & 1) {
			corner = other;
			mesh->triangles[corner / 3][corner % 3] = old;
			other = mesh->next[corner];
		} else {
			corner = at;
			at = mesh->next[corner];
		}
		*end = corner;
		end = &mesh->next[corner];
	}
	*end = STREAM_NONE;
}
