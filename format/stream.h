/* A streaming mesh as bytes (paper P3, section 3.6): a header, the base, and blocks of records,
 * each with a check of its own. docs/stream.md describes the bytes. What has arrived of a stream
 * can be decoded at any time: all whole blocks. */
#ifndef GOPURA_FORMAT_STREAM_H
#define GOPURA_FORMAT_STREAM_H

#include "base/bytes.h"
#include "format/stream_mesh.h"

enum { STREAM_BLOCK_RECORDS = 512 };

/* A whole stream, before it is encoded. */
struct stream_source {
	/* Borrowed: all vertices, those of the base first, then those of each record in turn. Base
	 * triangles name vertices in the order in which they first appear; the base's other
	 * vertices follow. */
	const struct patch_vertex *vertices;
	uint32_t vertex_count, triangle_count; /* of the whole mesh */
	const uint32_t (*base)[3];             /* borrowed */
	uint32_t base_vertices, base_triangles;
	const struct stream_record *records; /* borrowed */
	uint32_t record_count;
};

/* Appends the stream. Returns -EINVAL if a record does not fit or the source is too large, -ENOMEM,
 * or the error of out. */
must_check int stream_encode(struct buffer *out, const struct stream_source *source);

/* The parts of a whole stream, for objects of their own: the header with the base; then blocks of
 * records. Return the bytes of the first part of stream, and of the block at the beginning of
 * blocks. Both must be as stream_encode made them. */
size_t stream_start_bytes(struct bytes stream);
size_t stream_block_bytes(struct bytes blocks);
/* Returns how many blocks so many records take. */
static inline uint32_t stream_block_count(uint32_t record_count)
{
	return record_count / STREAM_BLOCK_RECORDS + (record_count % STREAM_BLOCK_RECORDS > 0);
}

struct stream_decoder; /* private to stream.c */

/* *out is owned by the caller; NULL on failure: -ENOMEM. */
must_check int stream_decoder_create(struct stream_decoder **out);
void stream_decoder_destroy(struct stream_decoder *decoder); /* NULL is fine */
/* Decodes and applies what has arrived: bytes are the stream from its beginning, at least as much
 * as in the call before. Returns -EBADMSG if the next block is damaged, here and from then on, or
 * -ENOMEM; the mesh is then what the blocks before it gave. */
must_check int stream_decoder_advance(struct stream_decoder *decoder, struct bytes bytes);
/* Returns whether every record of the stream has been decoded. */
bool stream_decoder_complete(const struct stream_decoder *decoder);
/* Returns how many records were decoded so far. */
uint32_t stream_decoder_records(const struct stream_decoder *decoder);
/* Applies or undoes records until so many are applied, at most what was decoded. */
void stream_decoder_show(struct stream_decoder *decoder, uint32_t record_count);
/* The records that were decoded so far, in order; borrowed until the next advance. */
const struct stream_record *stream_decoder_list(const struct stream_decoder *decoder);
/* The mesh as it is now, borrowed; empty before the base has arrived. */
const struct stream_mesh *stream_decoder_mesh(const struct stream_decoder *decoder);

#endif
