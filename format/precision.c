/* Finds, writes and reads the precision of vertices. */
#include "format/precision.h"

static uint8_t bits_of_normal(int8_t value, uint8_t bits)
{
	while (bits < 8 && precision_round_normal(value, bits) != value)
		bits++;
	return bits;
}

static uint8_t bits_of(uint8_t value, uint8_t bits)
{
	while (precision_widen((uint8_t)(value >> (8 - bits)), bits) != value)
		bits++;
	return bits;
}

static void allow_vertex(struct vertex_precision *precision, const struct patch_vertex *vertex)
{
	int digits = vertex->position[0] | vertex->position[1] | vertex->position[2];

	while (digits & ((1 << precision->position_zeros) - 1))
		precision->position_zeros--;
	for (int i = 0; i < 2; i++)
		precision->normal_bits = bits_of_normal(vertex->normal[i], precision->normal_bits);
	for (int i = 0; i < 3; i++)
		precision->colour_bits = bits_of(vertex->colour[i], precision->colour_bits);
	precision->open_bits = bits_of(vertex->colour[3], precision->open_bits);
}

struct vertex_precision precision_of(const struct patch_vertex *vertices, uint32_t vertex_count)
{
	struct vertex_precision precision = { PRECISION_ZEROS_MAX, PRECISION_BITS_MIN,
					      PRECISION_BITS_MIN, PRECISION_BITS_MIN };

	for (uint32_t v = 0; v < vertex_count; v++)
		allow_vertex(&precision, &vertices[v]);
	return precision;
}

void precision_put(struct buffer *out, const struct vertex_precision *precision)
{
	buffer_put_u8(out, precision->position_zeros);
	buffer_put_u8(out, precision->normal_bits);
	buffer_put_u8(out, precision->colour_bits);
	buffer_put_u8(out, precision->open_bits);
}

static bool bits_fit(uint8_t bits)
{
	return bits >= PRECISION_BITS_MIN && bits <= 8;
}

bool precision_get(struct reader *reader, struct vertex_precision *out)
{
	out->position_zeros = reader_u8(reader);
	out->normal_bits = reader_u8(reader);
	out->colour_bits = reader_u8(reader);
	out->open_bits = reader_u8(reader);
	return out->position_zeros <= PRECISION_ZEROS_MAX && bits_fit(out->normal_bits) &&
	       bits_fit(out->colour_bits) && bits_fit(out->open_bits);
}
