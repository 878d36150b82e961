/* Makes a streaming mesh (paper P3, section 3.6; format/stream.h) of an indexed mesh. */
#ifndef GOPURA_PIPELINE_HIERARCHY_STREAM_ENCODE_H
#define GOPURA_PIPELINE_HIERARCHY_STREAM_ENCODE_H

#include "base/bytes.h"
#include "format/stream.h"
#include "pipeline/hierarchy/stream_collapse.h"

enum { STREAM_BLOCKS_MAX = STREAM_VERTICES_MAX / STREAM_BLOCK_RECORDS };

struct stream_stats {
	uint32_t base_vertices, base_triangles, record_count, piece_count;
	/* For each number of blocks, how far the mesh after them is from the whole one: the root of
	 * the mean square distance by the quadrics, in lattice steps. */
	double errors[STREAM_BLOCKS_MAX + 1];
};

/* Appends the stream of a mesh to out: vertices on the lattice, at most STREAM_VERTICES_MAX, and
 * triangles of three different vertices each, borrowed. Decoded, it has the same vertices and
 * triangles, bit for bit, in the order of the stream. Surfaces with borders, edges of three
 * triangles and loose pieces are fine; what cannot be collapsed stays in the base. Returns -EINVAL
 * if the mesh is larger or a triangle is none, -ENOMEM, or the error of out. */
must_check int stream_make(struct buffer *out, struct stream_stats *stats,
			   const struct patch_vertex *vertices, uint32_t vertex_count,
			   const uint32_t (*triangles)[3], uint32_t triangle_count,
			   const struct stream_options *options);

#endif
