/* Writes and reads the header and the blocks of a streaming mesh; docs/stream.md. */
#include "format/stream.h"

#include <errno.h>
#include <stdlib.h>
#include <string.h>

#include "format/hash.h"
#include "format/stream_code.h"

enum { VERSION = 1, CHECK_BYTES = 8, HEADER_BYTES = 4 + 1 + 4 + 5 * 4, BLOCK_HEADER_BYTES = 8 };

static const uint8_t magic[4] = { 'G', 'P', 's', 'm' };

/* ---- encoding */

static void put_check(struct buffer *out, size_t from)
{
	struct hash hash;

	if (out->error)
		return;
	hash = hash_of((struct bytes){ out->data + from, out->size - from });
	buffer_put(out, hash.bytes, CHECK_BYTES);
}

static void put_header(struct buffer *out, const struct stream_source *source,
		       const struct vertex_precision *precision)
{
	size_t from = out->size;

	buffer_put(out, magic, sizeof(magic));
	buffer_put_u8(out, VERSION);
	precision_put(out, precision);
	buffer_put_u32(out, source->vertex_count);
	buffer_put_u32(out, source->triangle_count);
	buffer_put_u32(out, source->base_vertices);
	buffer_put_u32(out, source->base_triangles);
	buffer_put_u32(out, source->record_count);
	put_check(out, from);
}

static int put_block(struct buffer *out, struct symbol_encoder *encoder, uint32_t records)
{
	struct buffer payload;
	size_t from = out->size;
	int rc;

	buffer_init(&payload, UINT32_MAX);
	rc = symbol_encoder_put(encoder, &payload);
	buffer_put_u32(out, (uint32_t)payload.size);
	buffer_put_u32(out, records);
	buffer_put(out, payload.data, payload.size);
	put_check(out, from);
	buffer_finish(&payload);
	symbol_encoder_finish(encoder);
	symbol_encoder_init(encoder);
	return rc < 0 ? rc : out->error;
}

static int put_records(struct buffer *out, struct stream_coder *coder, struct stream_mesh *mesh,
		       const struct stream_source *source)
{
	int rc = 0;

	for (uint32_t r = 0; rc == 0 && r < source->record_count;) {
		uint32_t count = 0;

		while (rc == 0 && count < STREAM_BLOCK_RECORDS && r < source->record_count) {
			struct stream_record record = source->records[r++];

			rc = stream_code_record(coder, mesh, &record);
			count++;
		}
		if (rc == 0)
			rc = put_block(out, coder->coder.encoder, count);
	}
	if (rc == 0 && (mesh->vertex_count != source->vertex_count ||
			mesh->triangle_count != source->triangle_count))
		rc = -EINVAL;
	return rc;
}

int stream_encode(struct buffer *out, const struct stream_source *source)
{
	struct stream_coder *coder = calloc(1, sizeof(*coder));
	struct symbol_encoder encoder;
	struct stream_mesh mesh;
	int rc;

	if (!coder)
		return -ENOMEM;
	symbol_encoder_init(&encoder);
	coder->coder.encoder = &encoder;
	rc = stream_mesh_init(&mesh, source->vertex_count, source->triangle_count);
	if (rc == 0 && (source->base_vertices > source->vertex_count ||
			source->base_triangles > source->triangle_count))
		rc = -EINVAL;
	if (rc == 0) {
		memcpy(mesh.vertices, source->vertices,
		       source->vertex_count * sizeof(*mesh.vertices));
		for (uint32_t v = 0; v < source->base_vertices; v++)
			stream_mesh_add_vertex(&mesh);
		for (uint32_t t = 0; t < source->base_triangles; t++)
			stream_mesh_add_triangle(&mesh, source->base[t]);
		coder->precision = precision_of(source->vertices, source->vertex_count);
		put_header(out, source, &coder->precision);
		rc = stream_code_base(coder, &mesh, source->base_vertices, source->base_triangles);
	}
	if (rc == 0)
		rc = put_block(out, &encoder, 0);
	if (rc == 0)
		rc = put_records(out, coder, &mesh, source);
	symbol_encoder_finish(&encoder);
	stream_mesh_finish(&mesh);
	free(coder);
	return rc == -EBADMSG ? -EINVAL : rc;
}

size_t stream_block_bytes(struct bytes blocks)
{
	struct reader reader;

	reader_init(&reader, blocks);
	return BLOCK_HEADER_BYTES + (size_t)reader_u32(&reader) + CHECK_BYTES;
}

size_t stream_start_bytes(struct bytes stream)
{
	const size_t header = HEADER_BYTES + CHECK_BYTES;

	return header +
	       stream_block_bytes((struct bytes){ stream.data + header, stream.size - header });
}

/* ---- decoding */

struct stream_decoder {
	struct stream_coder coder;
	struct stream_mesh mesh;
	struct stream_record *records; /* owned; room for record_total */
	uint32_t record_total, record_count, applied;
	uint32_t base_vertices, base_triangles;
	size_t at; /* bytes that are decoded */
	bool has_header, has_base;
	int error; /* kept: 0 or -EBADMSG */
};

int stream_decoder_create(struct stream_decoder **out)
{
	*out = calloc(1, sizeof(**out));
	return *out ? 0 : -ENOMEM;
}

void stream_decoder_destroy(struct stream_decoder *decoder)
{
	if (!decoder)
		return;
	stream_mesh_finish(&decoder->mesh);
	free(decoder->records);
	free(decoder);
}

static bool check_holds(struct bytes bytes)
{
	struct hash hash = hash_of((struct bytes){ bytes.data, bytes.size - CHECK_BYTES });

	return memcmp(hash.bytes, bytes.data + bytes.size - CHECK_BYTES, CHECK_BYTES) == 0;
}

static int get_header(struct stream_decoder *d, struct bytes bytes)
{
	struct reader reader;
	uint32_t vertices, triangles;
	struct bytes start;
	int rc;

	reader_init(&reader, bytes);
	start = reader_bytes(&reader, sizeof(magic));
	if (!check_holds(bytes) || memcmp(start.data, magic, sizeof(magic)) != 0 ||
	    reader_u8(&reader) != VERSION || !precision_get(&reader, &d->coder.precision))
		return -EBADMSG;
	vertices = reader_u32(&reader);
	triangles = reader_u32(&reader);
	d->base_vertices = reader_u32(&reader);
	d->base_triangles = reader_u32(&reader);
	d->record_total = reader_u32(&reader);
	if (vertices > STREAM_VERTICES_MAX || triangles > STREAM_TRIANGLES_MAX ||
	    d->base_vertices > vertices || d->base_triangles > triangles ||
	    d->record_total > vertices - d->base_vertices)
		return -EBADMSG;
	rc = stream_mesh_init(&d->mesh, vertices, triangles);
	if (rc < 0)
		return rc;
	d->records = calloc((size_t)d->record_total + 1, sizeof(*d->records));
	if (!d->records) {
		stream_mesh_finish(&d->mesh);
		return -ENOMEM;
	}
	d->has_header = true;
	return 0;
}

/* Records of a block that turns out to be damaged are undone. */
static int get_records(struct stream_decoder *d, uint32_t count)
{
	uint32_t before = d->record_count;
	int rc = 0;

	while (rc == 0 && d->record_count < before + count) {
		rc = stream_code_record(&d->coder, &d->mesh, &d->records[d->record_count]);
		d->record_count += rc == 0;
	}
	if (rc == 0 && !symbol_decoder_complete(&d->coder.coder.decoder))
		rc = -EBADMSG;
	if (rc == 0 && d->record_count == d->record_total &&
	    (d->mesh.vertex_count != d->mesh.vertex_room ||
	     d->mesh.triangle_count != d->mesh.triangle_room))
		rc = -EBADMSG;
	d->applied = d->record_count;
	if (rc < 0) {
		stream_decoder_show(d, before);
		d->record_count = before;
	}
	return rc;
}

static int get_base(struct stream_decoder *d)
{
	int rc = stream_code_base(&d->coder, &d->mesh, d->base_vertices, d->base_triangles);

	if (rc == 0 && !symbol_decoder_complete(&d->coder.coder.decoder))
		rc = -EBADMSG;
	if (rc < 0)
		d->mesh.vertex_count = d->mesh.triangle_count = 0;
	else
		d->has_base = true;
	return rc;
}

/* block is whole: header, payload and check. */
static int get_block(struct stream_decoder *d, struct bytes block, uint32_t count)
{
	struct reader reader;
	int rc;

	if (!check_holds(block) || (d->has_base ? count < 1 : count != 0) ||
	    count > STREAM_BLOCK_RECORDS || count > d->record_total - d->record_count)
		return -EBADMSG;
	reader_init(&reader, (struct bytes){ block.data + BLOCK_HEADER_BYTES,
					     block.size - BLOCK_HEADER_BYTES - CHECK_BYTES });
	rc = symbol_decoder_init(&d->coder.coder.decoder, &reader);
	if (rc == 0 && reader_left(&reader) != 0)
		rc = -EBADMSG;
	if (rc < 0)
		return rc;
	return d->has_base ? get_records(d, count) : get_base(d);
}

/* Returns 1 after a part was decoded, 0 if it has not arrived whole, or an error. */
static int get_part(struct stream_decoder *d, struct bytes bytes)
{
	struct bytes left = { bytes.data + d->at, bytes.size - d->at };
	struct reader reader;
	uint32_t size, count;
	size_t part = HEADER_BYTES + CHECK_BYTES;
	int rc;

	if (stream_decoder_complete(d))
		return left.size ? -EBADMSG : 0;
	if (!d->has_header) {
		if (left.size < part)
			return 0;
		rc = get_header(d, (struct bytes){ left.data, part });
	} else {
		if (left.size < BLOCK_HEADER_BYTES)
			return 0;
		reader_init(&reader, left);
		size = reader_u32(&reader);
		count = reader_u32(&reader);
		part = (size_t)BLOCK_HEADER_BYTES + size + CHECK_BYTES;
		if (left.size < part)
			return 0;
		rc = get_block(d, (struct bytes){ left.data, part }, count);
	}
	if (rc < 0)
		return rc;
	d->at += part;
	return 1;
}

int stream_decoder_advance(struct stream_decoder *decoder, struct bytes bytes)
{
	int rc = decoder->error;

	if (rc == 0) {
		stream_decoder_show(decoder, decoder->record_count);
		do
			rc = get_part(decoder, bytes);
		while (rc > 0);
	}
	if (rc == -EBADMSG)
		decoder->error = rc;
	return rc;
}

bool stream_decoder_complete(const struct stream_decoder *decoder)
{
	return decoder->has_base && decoder->record_count == decoder->record_total;
}

uint32_t stream_decoder_records(const struct stream_decoder *decoder)
{
	return decoder->record_count;
}

const struct stream_record *stream_decoder_list(const struct stream_decoder *decoder)
{
	return decoder->records;
}

void stream_decoder_show(struct stream_decoder *decoder, uint32_t record_count)
{
	if (record_count > decoder->record_count)
		record_count = decoder->record_count;
	while (decoder->applied < record_count)
		stream_mesh_apply(&decoder->mesh, &decoder->records[decoder->applied++]);
	while (decoder->applied > record_count)
		stream_mesh_undo(&decoder->mesh, &decoder->records[--decoder->applied]);
}

const struct stream_mesh *stream_decoder_mesh(const struct stream_decoder *decoder)
{
	return &decoder->mesh;
}
