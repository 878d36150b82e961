/* Reduces a mesh by half-edge collapses, for the streaming mesh (paper P3, sections 3.5 and 3.6),
 * and keeps what undoes each. */
#ifndef GOPURA_PIPELINE_HIERARCHY_STREAM_COLLAPSE_H
#define GOPURA_PIPELINE_HIERARCHY_STREAM_COLLAPSE_H

#include "format/stream_mesh.h"

enum { STREAM_BASE_VERTICES = 256 /* then it stops: enough to recognise the shape */ };

/* One collapse: vertex `gone` went to `target`. Or, with target STREAM_NONE, a loose piece of the
 * surface vanished. */
struct stream_collapse {
	uint32_t target, gone, round;
	uint32_t piece[STREAM_PIECE_VERTICES]; /* a piece's vertices, then STREAM_NONE */
	/* In lists from first on: the triangles of which a corner changed, then for each that
	 * vanished its number and its corners before. */
	uint32_t first, moved_count, vanished_count;
};

struct stream_collapses {
	uint32_t count, room, list_count, list_room;
	struct stream_collapse *items; /* owned; in the order in which they happened */
	uint32_t *lists;               /* owned; numbers of triangles */
};

/* Collapses edges of the mesh in rounds: in each round those that cost least, in the order of their
 * quadric error, of which none touches the neighbourhood of another. So splits of one round may be
 * sorted by their targets, which then take few bits.
 *
 * A collapse is refused (section 3.5) if the link condition fails (the ends have a neighbour in
 * common that is no corner of a triangle at the edge, or the same opposite edge), if a vertex of a
 * border or of an edge with three triangles would leave that line, if a triangle folds over, or if
 * no record can express it. A loose piece of at most four vertices vanishes as a whole.
 *
 * Triangles are changed in place: those that are gone have three corners STREAM_NONE; vertices keep
 * their numbers. Returns -ENOMEM or -EFBIG. */
must_check int stream_collapse(struct stream_collapses *out, const struct patch_vertex *vertices,
			       uint32_t vertex_count, uint32_t (*triangles)[3],
			       uint32_t triangle_count);
void stream_collapses_finish(struct stream_collapses *collapses); /* zeroed is fine */

#endif
