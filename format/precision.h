/* The fewest bits that express the attributes of a set of vertices without loss, for the codecs of
 * patches and of the streaming mesh (docs/patch.md, "Bytes"). While vertices are coded, they are
 * without the bits that are omitted. Private to format/; inline, because the decoders' loops call
 * it for each vertex. */
#ifndef GOPURA_FORMAT_PRECISION_H
#define GOPURA_FORMAT_PRECISION_H

#include "base/bytes.h"
#include "format/patch_mesh.h"

enum {
	PRECISION_ZEROS_MAX = 12,
	PRECISION_BITS_MIN = 4 /* fewer bits cannot fill eight by one repetition */
};

struct vertex_precision {
	uint8_t position_zeros; /* low bits that are zero in all of them, 0 to 12 */
	uint8_t normal_bits, colour_bits, open_bits; /* 4 to 8 */
};

/* Returns the precision that vertices need; with none of them, the lowest there is. */
struct vertex_precision precision_of(const struct patch_vertex *vertices, uint32_t vertex_count);
/* Appends the four bytes; reads them. Returns false if they are out of range. */
void precision_put(struct buffer *out, const struct vertex_precision *precision);
must_check bool precision_get(struct reader *reader, struct vertex_precision *out);

/* Widens a value of bits bits to eight by repeating its bits, so that all zeros and all ones stay
 * so. */
static force_inline uint8_t precision_widen(uint8_t value, int bits)
{
	return bits == 8 ? value : (uint8_t)(value << (8 - bits) | value >> (2 * bits - 8));
}

static force_inline uint8_t precision_round_colour(uint8_t value, int bits)
{
	int most = (1 << bits) - 1;

	return precision_widen((uint8_t)((value * most + 127) / 255), bits);
}

/* -127, 0 and 127 stay what they are. -128 is no normal, and needs 8 bits. */
static force_inline int8_t precision_shorten_normal(int8_t value, int bits)
{
	int most = (1 << (bits - 1)) - 1;

	if (bits == 8)
		return value;
	return (int8_t)((value * most + (value < 0 ? -63 : 63)) / 127);
}

static force_inline int8_t precision_widen_normal(int8_t value, int bits)
{
	int most = (1 << (bits - 1)) - 1;

	if (bits == 8)
		return value;
	return (int8_t)((value * 127 + (value < 0 ? -most / 2 : most / 2)) / most);
}

static force_inline int8_t precision_round_normal(int8_t value, int bits)
{
	return precision_widen_normal(precision_shorten_normal(value, bits), bits);
}

/* Returns a vertex without the bits that are omitted; its position counts from base. */
static force_inline struct patch_vertex precision_shorten(const struct vertex_precision *precision,
							  const int32_t base[3],
							  const struct patch_vertex *vertex)
{
	struct patch_vertex out = *vertex;

	for (int i = 0; i < 3; i++)
		out.position[i] = (out.position[i] - base[i]) >> precision->position_zeros;
	for (int i = 0; i < 2; i++)
		out.normal[i] = precision_shorten_normal(out.normal[i], precision->normal_bits);
	for (int i = 0; i < 4; i++)
		out.colour[i] >>= 8 - (i < 3 ? precision->colour_bits : precision->open_bits);
	return out;
}

/* Undoes it. In place: a copy that is read in one piece would wait for the bytes that were just
 * written. */
static force_inline void precision_lengthen(const struct vertex_precision *precision,
					    const int32_t base[3], struct patch_vertex *vertex)
{
	for (int i = 0; i < 3; i++)
		vertex->position[i] = base[i] + (vertex->position[i] << precision->position_zeros);
	for (int i = 0; i < 2; i++)
		vertex->normal[i] =
			precision_widen_normal(vertex->normal[i], precision->normal_bits);
	for (int i = 0; i < 4; i++)
		vertex->colour[i] = precision_widen(
			vertex->colour[i], i < 3 ? precision->colour_bits : precision->open_bits);
}

#endif
