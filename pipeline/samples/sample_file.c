/* Encodes and decodes the files of the sample store. */
#include "pipeline/samples/sample_file.h"

#include <errno.h>
#include <string.h>

enum { VERSION = 1 };

/* ---- the frame */

void sample_file_begin(struct buffer *file, const char magic[4], struct hash key)
{
	buffer_put(file, magic, 4);
	buffer_put_u32(file, VERSION);
	buffer_put(file, key.bytes, HASH_BYTES);
}

void sample_file_seal(struct buffer *file)
{
	struct hash hash = hash_of(buffer_bytes(file));

	buffer_put(file, hash.bytes, HASH_BYTES);
}

bool sample_file_open(struct reader *reader, struct bytes file, const char magic[4],
		      struct hash *key)
{
	struct bytes head, body = { file.data, file.size - HASH_BYTES };
	struct hash hash;

	if (file.size < SAMPLE_FILE_HEAD_BYTES + HASH_BYTES)
		return false;
	hash = hash_of(body);
	if (memcmp(hash.bytes, file.data + body.size, HASH_BYTES) != 0)
		return false;
	reader_init(reader, body);
	head = reader_bytes(reader, 4);
	if (memcmp(head.data, magic, 4) != 0 || reader_u32(reader) != VERSION)
		return false;
	memcpy(key->bytes, reader_bytes(reader, HASH_BYTES).data, HASH_BYTES);
	return true;
}

/* ---- a point */

static uint32_t choices_of(const struct sample_grid *grid)
{
	return grid->choice_count > 1 ? grid->choice_count : 1;
}

static uint32_t scales_of(const struct sample_grid *grid)
{
	return grid->choice_count > 1 ? grid->scale_count : 0;
}

static void put_face_head(struct buffer *file, const struct sample_face *face)
{
	buffer_put_u8(file, (uint8_t)face->face);
	buffer_put_u8(file, (uint8_t)face->level_count);
	buffer_put_u16(file, face->coverage);
	buffer_put_f32(file, face->near_m);
	buffer_put_f32(file, face->far_m);
	buffer_put_u32(file, face->tile_count);
}

static void read_face_head(struct reader *reader, struct sample_face *out)
{
	*out = (struct sample_face){ 0 };
	out->face = reader_u8(reader);
	out->level_count = reader_u8(reader);
	out->coverage = reader_u16(reader);
	out->near_m = reader_f32(reader);
	out->far_m = reader_f32(reader);
	out->tile_count = reader_u32(reader);
}

static void put_tile(struct buffer *file, const struct sample_grid *grid,
		     const struct sample_face *face, uint32_t tile)
{
	const uint32_t choices = choices_of(grid);

	buffer_put_u16(file, face->tiles[tile]);
	for (uint32_t scale = 0; scale < scales_of(grid); scale++)
		buffer_put_u32(file, face->features[tile][scale]);
	if (choices > 1)
		buffer_put_u16(file, face->windows[tile]);
	for (uint32_t choice = 0; choice < choices; choice++) {
		const struct bytes object = face->objects[tile * choices + choice];

		if (choices > 1)
			buffer_put_u32(file, face->losses[tile * SAMPLE_CHOICES_MAX + choice]);

		buffer_put_u32(file, (uint32_t)object.size);
		buffer_put(file, object.data, object.size);
	}
}

void sample_file_put_point(struct buffer *file, const struct sample_grid *grid,
			   enum sample_state state, const struct sample_face *faces,
			   uint32_t face_count)
{
	buffer_put_u8(file, (uint8_t)state);
	buffer_put_u8(file, (uint8_t)face_count);
	for (uint32_t n = 0; n < face_count; n++) {
		const struct sample_face *face = &faces[n];

		put_face_head(file, face);
		for (uint32_t i = 0; i < face->tile_count; i++)
			put_tile(file, grid, face, i);
	}
}

/* ---- its summary */

/* The feature points and the qualities of a tile. */
static void summarize_tile(struct buffer *out, struct reader *contents,
			   const struct sample_grid *grid)
{
	for (uint32_t scale = 0; scale < scales_of(grid); scale++)
		buffer_put_u32(out, reader_u32(contents));
	if (choices_of(grid) > 1)
		buffer_put_u16(out, reader_u16(contents));
	for (uint32_t choice = 0; choice < choices_of(grid); choice++) {
		uint32_t loss = choices_of(grid) > 1 ? reader_u32(contents) : 0;
		uint32_t size = reader_u32(contents);
		struct hash hash = hash_of(reader_bytes(contents, size));

		if (choices_of(grid) > 1)
			buffer_put_u32(out, loss);
		buffer_put_u32(out, size);
		buffer_put(out, hash.bytes, HASH_BYTES);
	}
}

static int summarize_face(struct buffer *out, struct reader *contents,
			  const struct sample_grid *grid)
{
	struct sample_face face;
	uint32_t places;
	int before = -1;

	read_face_head(contents, &face);
	if (contents->failed || face.face >= CUBE_FACES || face.level_count < 1 ||
	    face.level_count > grid->level_count)
		return -EBADMSG;
	places = face_tile_index(face.level_count, 0, 0);
	if (face.tile_count < 1 || face.tile_count > places)
		return -EBADMSG;
	put_face_head(out, &face);
	for (uint32_t i = 0; i < face.tile_count; i++) {
		uint16_t tile = reader_u16(contents);

		if (contents->failed || tile >= places || tile <= before)
			return -EBADMSG;
		before = tile;
		buffer_put_u16(out, tile);
		summarize_tile(out, contents, grid);
	}
	return contents->failed ? -EBADMSG : 0;
}

int sample_file_summarize(struct buffer *out, struct reader *contents,
			  const struct sample_grid *grid)
{
	uint8_t state = reader_u8(contents), face_count = reader_u8(contents);
	int rc = 0;

	if (contents->failed || state >= SAMPLE_STATES || face_count > CUBE_FACES)
		return -EBADMSG;
	buffer_put_u8(out, state);
	buffer_put_u8(out, face_count);
	for (uint8_t i = 0; rc == 0 && i < face_count; i++)
		rc = summarize_face(out, contents, grid);
	return rc < 0 ? rc : out->error;
}

bool sample_summary_open(struct sample_summary *summary, struct bytes bytes,
			 const struct sample_grid *grid)
{
	uint8_t state;

	reader_init(&summary->reader, bytes);
	state = reader_u8(&summary->reader);
	summary->faces_left = reader_u8(&summary->reader);
	summary->at = SAMPLE_FILE_HEAD_BYTES + 2;
	summary->choice_count = choices_of(grid);
	summary->scale_count = scales_of(grid);
	if (summary->reader.failed || state >= SAMPLE_STATES || summary->faces_left > CUBE_FACES)
		return false;
	summary->state = state;
	return true;
}

/* Reads a tile, of which a quality was chosen. */
static void read_tile(struct sample_summary *summary, uint32_t i, uint32_t chosen)
{
	struct reader *reader = &summary->reader;

	summary->tiles[i] = reader_u16(reader);
	summary->at += 2 + 4 * summary->scale_count;
	for (uint32_t scale = 0; scale < summary->scale_count; scale++)
		summary->features[i][scale] = reader_u32(reader);
	if (summary->choice_count > 1) {
		summary->windows[i] = reader_u16(reader);
		summary->at += 2;
	}
	for (uint32_t choice = 0; choice < summary->choice_count; choice++) {
		uint32_t loss = summary->choice_count > 1 ? reader_u32(reader) : 0;
		uint32_t size = reader_u32(reader);
		struct bytes hash = reader_bytes(reader, HASH_BYTES);

		if (reader->failed)
			return;
		summary->at += summary->choice_count > 1 ? 4 : 0;
		summary->losses[i * SAMPLE_CHOICES_MAX + choice] = loss;
		summary->choice_sizes[i * SAMPLE_CHOICES_MAX + choice] = size;
		if (choice == chosen) {
			summary->sizes[i] = size;
			summary->offsets[i] = summary->at + 4;
			memcpy(summary->hashes[i].bytes, hash.data, HASH_BYTES);
		}
		summary->at += 4 + (uint64_t)size;
	}
}

bool sample_summary_next(struct sample_summary *summary, struct sample_face *out,
			 const uint8_t *choices, uint32_t choices_left)
{
	struct reader *reader = &summary->reader;
	const uint32_t best = summary->choice_count - 1;

	summary->faces_left--;
	read_face_head(reader, out);
	summary->at += 16;
	if (reader->failed || out->face >= CUBE_FACES || out->tile_count > FACE_TILES_MAX)
		return false;
	for (uint32_t i = 0; i < out->tile_count; i++) {
		uint32_t chosen = i < choices_left && choices[i] < best ? choices[i] : best;

		read_tile(summary, i, chosen);
		if (reader->failed)
			return false;
	}
	out->tiles = summary->tiles;
	out->sizes = summary->sizes;
	out->hashes = summary->hashes;
	out->offsets = summary->offsets;
	out->choice_sizes = summary->choice_sizes;
	out->windows = summary->windows;
	out->losses = summary->losses;
	out->features = summary->scale_count > 0
				? (const uint32_t(*)[SAMPLE_SCALES_MAX])summary->features
				: NULL;
	return true;
}
