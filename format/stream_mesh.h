/* The streaming mesh (paper P3, section 3.6): a base mesh, and records that each undo one half-edge
 * collapse, in one order. Applying the first n records gives a valid mesh for every n; all of them
 * give the whole mesh, bit for bit. Here: the mesh while records are applied and undone. It needs
 * no memory beyond its arrays, which have room for the whole mesh from the beginning.
 *
 * The paper's record (Figure 3-15) names a face, a corner of it and a number of turns around the
 * vertex, which needs a surface. Scans have edges with three triangles and vertices where two
 * sheets touch. So here the triangles of a vertex are a list, whose order both sides know, and a
 * record says for each of them whether it moves to the new vertex. */
#ifndef GOPURA_FORMAT_STREAM_MESH_H
#define GOPURA_FORMAT_STREAM_MESH_H

#include <stdbool.h>

#include "base/compiler.h"
#include "format/patch_mesh.h"

#define STREAM_NONE UINT32_MAX

enum {
	STREAM_VERTICES_MAX = 1 << 20,
	STREAM_TRIANGLES_MAX = 1 << 21,
	STREAM_RING_MAX = 32, /* triangles at a vertex that is split */
	STREAM_FACES_MAX = 4, /* triangles that a split adds */
	STREAM_PIECE_VERTICES = 4,
	STREAM_PIECE_FACES = 4,
	STREAM_RECORD_BYTES = 30 /* of a split: 12 here, 18 for place, normal and colour */
};

/* A new triangle of a split, as one byte: the corner of the list and its side name the third
 * vertex; the triangle runs from the old vertex to the new one (and then the third), or back. */
enum {
	STREAM_FACE_CORNER = 31,
	STREAM_FACE_BEFORE = 32, /* the vertex before the corner in its triangle; else the next */
	STREAM_FACE_BACK = 64,   /* new, old, third; else old, new, third */
	STREAM_FACE = 128        /* there is one; 0: no more */
};

/* A split of a vertex, or a loose piece of the surface that appears: three or four vertices, and
 * those of the eight triangles over them (see stream_piece_face) whose bit is set. */
struct stream_record {
	uint32_t target; /* split: the vertex; piece: STREAM_NONE */
	uint32_t moved;  /* split: bit i: triangle i of the list moves; piece: number of vertices */
	uint8_t faces[STREAM_FACES_MAX]; /* split: new triangles; piece: faces[0] is the set */
};
_Static_assert(sizeof(struct stream_record) + 18 == STREAM_RECORD_BYTES, "the paper's limit");

struct stream_mesh {
	uint32_t vertex_count, triangle_count; /* now */
	uint32_t vertex_room, triangle_room;
	struct patch_vertex *vertices; /* owned; entries past vertex_count are kept by undo */
	uint32_t (*triangles)[3];      /* owned; counter-clockwise from outside */
	uint32_t *first;               /* owned; for each vertex, a corner, or STREAM_NONE */
	uint32_t *next; /* owned; for each corner (3 * triangle + 0..2), the next of its vertex */
};

/* Allocates an empty mesh. Returns -EINVAL if there are more than STREAM_..._MAX, or -ENOMEM;
 * nothing is owned then. */
must_check int stream_mesh_init(struct stream_mesh *mesh, uint32_t vertex_room,
				uint32_t triangle_room);
void stream_mesh_finish(struct stream_mesh *mesh); /* NULL and zeroed are fine */

/* Adds a vertex without triangles; the caller fills vertices[] of it. Room is asserted. */
void stream_mesh_add_vertex(struct stream_mesh *mesh);
/* Adds a triangle to the lists of its corners. Room and corners are asserted. */
void stream_mesh_add_triangle(struct stream_mesh *mesh, const uint32_t corners[3]);
/* Takes away what was added last. */
void stream_mesh_drop_triangle(struct stream_mesh *mesh);

/* Sets out to the corners of one of a piece's eight possible triangles, 0..3 of its vertices:
 * triangle face % 4 lacks vertex face % 4, and 4..7 are the same from behind. */
void stream_piece_face(uint32_t out[3], uint32_t face);
/* Returns whether a record can be applied to the mesh as it is: the vertex exists, its list has no
 * more than STREAM_RING_MAX triangles, the bits and faces name some of them, and there is room. The
 * third vertex of a new triangle is then always a neighbour of the old one. */
bool stream_record_fits(const struct stream_mesh *mesh, const struct stream_record *record);
/* Applies a record that fits. The new vertex is number vertex_count; the caller has filled
 * vertices[] of it, or does so afterwards. */
void stream_mesh_apply(struct stream_mesh *mesh, const struct stream_record *record);
/* Undoes the record that was applied last: every list is then what it was. */
void stream_mesh_undo(struct stream_mesh *mesh, const struct stream_record *record);

#endif
