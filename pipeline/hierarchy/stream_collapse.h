/* Reduces a mesh by half-edge collapses, for the streaming mesh (paper P3, sections 3.5 and 3.6),
 * and keeps what undoes each. */
#ifndef GOPURA_PIPELINE_HIERARCHY_STREAM_COLLAPSE_H
#define GOPURA_PIPELINE_HIERARCHY_STREAM_COLLAPSE_H

#include "format/stream_mesh.h"

struct stream_options {
	uint32_t base_vertices; /* collapsing stops at so many */
	/* false: a collapse that the paper's checks refuse is impossible, so every prefix of a
	 * surface is a surface. true: it only costs more. */
	bool loose;
};

/* One collapse: vertex `gone` went to `target`. Or, with target STREAM_NONE, a loose piece of the
 * surface vanished. */
struct stream_collapse {
	uint32_t target, gone, round;
	double cost; /* squared distance times area by which it moves the surface */
	uint32_t piece[STREAM_PIECE_VERTICES]; /* a piece's vertices, then STREAM_NONE */
	/* In lists from first on: the triangles of which a corner changed, then for each that
	 * vanished its number and its corners before. */
	uint32_t first, moved_count, vanished_count;
};

struct stream_collapses {
	uint32_t count, room, list_count, list_room;
	double area;                   /* of the whole mesh, as often as the costs count it */
	struct stream_collapse *items; /* owned; in the order in which they happened */
	uint32_t *lists;               /* owned; numbers of triangles */
};

/* Collapses edges of the mesh in rounds: in each round those that cost least, in the order of their
 * quadric error, of which none touches the neighbourhood of another. So splits of one round may be
 * sorted by their targets, which then take few bits.
 *
 * A collapse is impossible if no record can express it. The paper's checks (section 3.5) fail where
 * the ends have a neighbour in common that is no corner of a triangle at the edge, where a vertex
 * of a border or of an edge with three triangles would leave that line, or where a triangle folds
 * over; see stream_options. A loose piece of at most four vertices vanishes as a whole.
 *
 * Triangles are changed in place: those that are gone have three corners STREAM_NONE; vertices keep
 * their numbers. Returns -ENOMEM or -EFBIG. */
must_check int stream_collapse(struct stream_collapses *out, const struct patch_vertex *vertices,
			       uint32_t vertex_count, uint32_t (*triangles)[3],
			       uint32_t triangle_count, const struct stream_options *options);
void stream_collapses_finish(struct stream_collapses *collapses); /* zeroed is fine */

#endif
