/* Where an eye may be: an octree over the space around the model whose cells are free or full. In a
 * free cell, no surface is within room_m of the eye along any axis. Everything else is full: stone,
 * what is too near to it, and what no way leads to. The idea is that of paper P1, section 7; the
 * bytes are described in docs/solid.md. geometry/solid_space.h has the questions about ways.
 *
 * Nodes are in breadth-first order. A node is a cell that is divided in eight; child i lies on the
 * high side along axis a where bit a of i is set. */
#ifndef GOPURA_FORMAT_SOLID_H
#define GOPURA_FORMAT_SOLID_H

#include "base/bytes.h"

enum solid_state { SOLID_FREE, SOLID_FULL, SOLID_DIVIDED };

enum { SOLID_DEPTH_MAX = 12, SOLID_NODES_MAX = 1 << 19, SOLID_CHILDREN = 8 };

struct solid_node {
	uint32_t first;  /* index of the node of its first divided child; the others follow */
	uint16_t states; /* two bits for each child, those of child 0 lowest */
};

struct solid {
	float low_m[3];           /* corner of the root cell */
	float cell_m;             /* side of the smallest cells; the root's is cell_m * 2^depth */
	float room_m;             /* at least 0 */
	uint32_t depth;           /* 1 to SOLID_DEPTH_MAX */
	uint32_t node_count;      /* 1 to SOLID_NODES_MAX; node 0 is the root */
	struct solid_node *nodes; /* owned */
};

/* A cell of the tree, in steps of cell_m from low_m. */
struct solid_cell {
	int32_t low[3], side;   /* side: a power of two */
	enum solid_state state; /* SOLID_FREE or SOLID_FULL */
	/* 8 times its parent's node and its number there: different for each cell of the tree, and
	 * below 8 * node_count */
	uint32_t id;
};

/* Returns the state of a child of a node. */
static inline enum solid_state solid_child_state(const struct solid_node *node, uint32_t child)
{
	return (enum solid_state)(node->states >> 2 * child & 3);
}
/* Returns the index of the node of a child that is SOLID_DIVIDED. */
uint32_t solid_child_node(const struct solid_node *node, uint32_t child);

/* Finds the cell that holds a place, in steps of cell_m from low_m. Every axis is within 0 to
 * 2^depth - 1. */
void solid_find(const struct solid *solid, const int32_t place[3], struct solid_cell *out);

/* Appends the object. Returns -EINVAL if *solid breaks a rule above or has a node whose children
 * are all free or all full, -ENOMEM, or the error of out. */
must_check int solid_encode(struct buffer *out, const struct solid *solid);
/* The caller ends *out with solid_finish(); it is zeroed on failure. Returns -EBADMSG for anything
 * that the encoder cannot have written, or -ENOMEM. */
must_check int solid_decode(struct solid *out, struct bytes object);
void solid_finish(struct solid *solid); /* NULL and zeroed are fine */

#endif
