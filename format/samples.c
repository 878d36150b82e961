/* Encodes and decodes the three kinds of sample page: grid, brick and face. */
#include "format/samples.h"

#include <assert.h>
#include <errno.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

/* Writes one bit per child: whether it exists. The number of a child is the count of children
 * before it, so numbers need no bytes. Children must be numbered in order. */
static void put_presence(struct buffer *out, const uint32_t *children, uint32_t count)
{
	uint32_t next = 0;

	for (uint32_t i = 0; i < count; i += 8) {
		uint8_t bits = 0;

		for (uint32_t k = i; k < count && k < i + 8; k++) {
			if (children[k] == SAMPLE_NONE)
				continue;
			assert(children[k] == next);
			next++;
			bits |= (uint8_t)(1u << (k - i));
		}
		buffer_put_u8(out, bits);
	}
}

static bool read_presence(struct reader *reader, uint32_t *children, uint32_t count)
{
	uint32_t next = 0;

	for (uint32_t i = 0; i < count; i += 8) {
		uint8_t bits = reader_u8(reader);
		uint32_t used = count - i < 8 ? count - i : 8;

		if (used < 8 && bits >> used)
			return false;
		for (uint32_t k = 0; k < used; k++)
			children[i + k] = bits >> k & 1 ? next++ : SAMPLE_NONE;
	}
	return !reader->failed;
}

/* Of the grid. */
static uint32_t brick_total(const struct samples_page *samples)
{
	return samples->bricks[0] * samples->bricks[1] * samples->bricks[2];
}

uint32_t samples_page_bricks(const struct samples_page *samples)
{
	return brick_total(samples) + (samples->vantage_count > 0);
}

/* Their brick is the child after those of the grid, so its number needs no bytes. */
static void put_vantages(struct buffer *out, const struct samples_page *samples)
{
	if (samples->vantage_count == 0)
		return;
	assert(samples->brick_child[brick_total(samples)] != SAMPLE_NONE);
	buffer_put_u8(out, (uint8_t)samples->vantage_count);
	for (uint32_t i = 0; i < samples->vantage_count; i++)
		for (int k = 0; k < 3; k++)
			buffer_put_f32(out, samples->vantage_m[i][k]);
}

/* Reads them where the page goes on after its bricks. */
static bool read_vantages(struct reader *reader, struct samples_page *out)
{
	const uint32_t total = brick_total(out);
	uint32_t next = 0;

	if (reader_left(reader) == 0)
		return true;
	out->vantage_count = reader_u8(reader);
	if (out->vantage_count < 1 || out->vantage_count > SAMPLE_VANTAGES_MAX)
		return false;
	for (uint32_t i = 0; i < out->vantage_count; i++)
		for (int k = 0; k < 3; k++) {
			out->vantage_m[i][k] = reader_f32(reader);
			if (!isfinite(out->vantage_m[i][k]))
				return false;
		}
	for (uint32_t i = 0; i < total; i++)
		next += out->brick_child[i] != SAMPLE_NONE;
	out->brick_child[total] = next;
	return !reader->failed;
}

void samples_page_encode(struct buffer *out, const struct samples_page *samples)
{
	for (int i = 0; i < 3; i++)
		buffer_put_f32(out, samples->origin_m[i]);
	for (int i = 0; i < 3; i++)
		buffer_put_f32(out, samples->spacing_m[i]);
	for (int i = 0; i < 3; i++) {
		assert(samples->bricks[i] == (samples->count[i] + BRICK_SIDE - 1u) / BRICK_SIDE);
		buffer_put_u8(out, samples->count[i]);
	}
	buffer_put_u8(out, samples->level_count);
	put_presence(out, samples->brick_child, brick_total(samples));
	put_vantages(out, samples);
}

static bool read_grid(struct reader *reader, struct samples_page *out)
{
	bool good = true;

	for (int i = 0; i < 3; i++) {
		out->origin_m[i] = reader_f32(reader);
		good = good && isfinite(out->origin_m[i]);
	}
	for (int i = 0; i < 3; i++) {
		out->spacing_m[i] = reader_f32(reader);
		good = good && isfinite(out->spacing_m[i]) && out->spacing_m[i] > 0;
	}
	for (int i = 0; i < 3; i++) {
		out->count[i] = reader_u8(reader);
		good = good && out->count[i] >= 1 && out->count[i] <= SAMPLE_GRID_MAX;
		out->bricks[i] = (out->count[i] + BRICK_SIDE - 1u) / BRICK_SIDE;
	}
	out->level_count = reader_u8(reader);
	good = good && out->level_count >= 1 && out->level_count <= SAMPLE_LEVELS_MAX;
	return good && !reader->failed;
}

int samples_page_decode(struct samples_page *out, struct bytes payload)
{
	struct reader reader;

	*out = (struct samples_page){ 0 };
	reader_init(&reader, payload);
	if (!read_grid(&reader, out))
		goto bad;
	out->brick_child = malloc((brick_total(out) + 1) * sizeof(*out->brick_child));
	if (!out->brick_child) {
		*out = (struct samples_page){ 0 };
		return -ENOMEM;
	}
	if (!read_presence(&reader, out->brick_child, brick_total(out)) ||
	    !read_vantages(&reader, out) || reader_left(&reader))
		goto bad;
	return 0;
bad:
	samples_page_finish(out);
	return -EBADMSG;
}

void samples_page_finish(struct samples_page *samples)
{
	if (!samples)
		return;
	free(samples->brick_child);
	*samples = (struct samples_page){ 0 };
}

/* The upper half of a float, a precision of 1/128. That is enough if near is rounded towards the
 * eye and far away from it. */
static uint16_t half_of(float metres, bool up)
{
	uint32_t bits;

	memcpy(&bits, &metres, sizeof(bits));
	return (uint16_t)((bits >> 16) + (up && (bits & 0xffff)));
}

static float from_half(uint16_t half)
{
	uint32_t bits = (uint32_t)half << 16;
	float metres;

	memcpy(&metres, &bits, sizeof(metres));
	return metres;
}

void brick_page_encode(struct buffer *out, const struct brick_page *brick)
{
	put_presence(out, &brick->face_child[0][0], BRICK_POINTS * CUBE_FACES);
	for (uint32_t p = 0; p < BRICK_POINTS; p++) {
		for (uint32_t f = 0; f < CUBE_FACES; f++) {
			if (brick->face_child[p][f] == SAMPLE_NONE)
				continue;
			assert(brick->coverage[p][f]);
			buffer_put_u16(out, brick->coverage[p][f]);
			buffer_put_u16(out, half_of(brick->near_m[p][f], false));
			buffer_put_u16(out, half_of(brick->far_m[p][f], true));
		}
	}
}

int brick_page_decode(struct brick_page *out, struct bytes payload)
{
	struct reader reader;

	*out = (struct brick_page){ 0 };
	reader_init(&reader, payload);
	if (!read_presence(&reader, &out->face_child[0][0], BRICK_POINTS * CUBE_FACES))
		return -EBADMSG;
	for (uint32_t p = 0; p < BRICK_POINTS; p++) {
		for (uint32_t f = 0; f < CUBE_FACES; f++) {
			if (out->face_child[p][f] == SAMPLE_NONE)
				continue;
			out->coverage[p][f] = reader_u16(&reader);
			out->near_m[p][f] = from_half(reader_u16(&reader));
			out->far_m[p][f] = from_half(reader_u16(&reader));
			if (!out->coverage[p][f] || !(out->near_m[p][f] > 0) ||
			    !(out->far_m[p][f] >= out->near_m[p][f]) || !isfinite(out->far_m[p][f]))
				return -EBADMSG;
		}
	}
	return reader.failed || reader_left(&reader) ? -EBADMSG : 0;
}

static uint32_t tiles_of(uint32_t level_count)
{
	return face_tile_index(level_count, 0, 0);
}

void face_page_encode(struct buffer *out, const struct face_page *face)
{
	buffer_put_u8(out, face->level_count);
	put_presence(out, face->tile_child, tiles_of(face->level_count));
}

int face_page_decode(struct face_page *out, struct bytes payload)
{
	struct reader reader;

	memset(out->tile_child, 0xff, sizeof(out->tile_child));
	reader_init(&reader, payload);
	out->level_count = reader_u8(&reader);
	if (out->level_count < 1 || out->level_count > SAMPLE_LEVELS_MAX)
		return -EBADMSG;
	if (!read_presence(&reader, out->tile_child, tiles_of(out->level_count)))
		return -EBADMSG;
	return reader_left(&reader) ? -EBADMSG : 0;
}

uint32_t face_tile_index(uint32_t level, uint32_t row, uint32_t column)
{
	uint32_t index =
		((1u << 2 * level) - 1) / 3; /* 1 + 4 + 16 + ...: the tiles of all coarser levels */

	for (uint32_t bit = 0; bit < level; bit++)
		index += (row >> bit & 1) << (2 * bit + 1) | (column >> bit & 1) << 2 * bit;
	return index;
}

uint32_t face_tile_level(uint32_t index)
{
	uint32_t level = 0;

	while (index >= face_tile_index(level + 1, 0, 0))
		level++;
	return level;
}

void face_tile_place(uint32_t level, uint32_t index, uint32_t *row, uint32_t *column)
{
	index -= face_tile_index(level, 0, 0);
	*row = *column = 0;
	for (uint32_t bit = 0; bit < level; bit++) {
		*row |= (index >> (2 * bit + 1) & 1) << bit;
		*column |= (index >> 2 * bit & 1) << bit;
	}
}
