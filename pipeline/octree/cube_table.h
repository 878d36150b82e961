/* The 256 cases of a marching cube (Lorensen and Cline 1987; paper P1, section 2.2.1): which of its
 * edges the surface crosses, and with which triangles. Made by rule, not listed: on each face the
 * crossings are joined so that corners inside are separated, which both cubes of the face do alike;
 * so there are no holes between cubes. No diagonal of a polygon lies in a face of the cube; so no
 * edge has more than two triangles.
 *
 * Corner c lies at x = c & 1, y = c >> 1 & 1, z = c >> 2. Edge 4 a + i runs along axis a; bit 0 of
 * i is the place on the axis after a (x y z x ...), bit 1 on the one after that. */
#ifndef GOPURA_PIPELINE_OCTREE_CUBE_TABLE_H
#define GOPURA_PIPELINE_OCTREE_CUBE_TABLE_H

#include <stdint.h>

enum { CUBE_EDGES = 12, CUBE_TRIANGLES_MAX = 5, CUBE_NO_EDGE = 255 };

/* Outlines of the surface in the cube, counter-clockwise seen from outside. */
struct cube_case {
	uint8_t next[CUBE_EDGES]; /* edge that follows in its outline, or CUBE_NO_EDGE: not crossed
				   */
	uint8_t triangle_count;
	uint8_t triangles[CUBE_TRIANGLES_MAX][3]; /* edges */
};

/* Returns the case of a cube; bit c of inside: corner c lies inside. Valid for ever. Any thread. */
const struct cube_case *cube_case_of(uint8_t inside);
/* Returns the lower corner of an edge; the upper one is that plus 1 << (edge / 4). */
uint8_t cube_edge_corner(int edge);
/* Returns the edge between two corners that differ along one axis. */
int cube_edge_between(int a, int b);
/* Sets the corners of the face on side 0 or 1 of an axis, in counter-clockwise order seen from
 * outside. */
void cube_face_corners(int corners[4], int axis, int side);
/* Returns whether two edges belong to one face. */
int cube_edges_share_face(int a, int b);

#endif
