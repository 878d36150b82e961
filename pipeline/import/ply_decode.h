/* Decodes binary numbers and vertices of a PLY file. Private to pipeline/import/ply*.c. */
#ifndef GOPURA_PIPELINE_IMPORT_PLY_DECODE_H
#define GOPURA_PIPELINE_IMPORT_PLY_DECODE_H

#include <string.h>

#include "base/compiler.h"
#include "pipeline/import/ply_header.h"

static force_inline uint64_t ply_word(const uint8_t *bytes, uint32_t size, bool big)
{
	uint64_t word = 0;

	for (uint32_t i = 0; i < size; i++)
		word |= (uint64_t)bytes[big ? size - 1 - i : i] << (8 * i);
	return word;
}

/* type: not PLY_TYPE_NONE. Each case has a size of its own, so that it becomes one load. */
static force_inline double ply_number(const uint8_t *bytes, enum ply_type type, bool big)
{
	double wide;
	float narrow;
	uint64_t word;
	uint32_t half;

	switch (type) {
	case PLY_INT8:
		return (int8_t)bytes[0];
	case PLY_UINT8:
		return bytes[0];
	case PLY_INT16:
		return (int16_t)ply_word(bytes, 2, big);
	case PLY_UINT16:
		return (uint16_t)ply_word(bytes, 2, big);
	case PLY_INT32:
		return (int32_t)ply_word(bytes, 4, big);
	case PLY_UINT32:
		return (uint32_t)ply_word(bytes, 4, big);
	case PLY_FLOAT32:
		half = (uint32_t)ply_word(bytes, 4, big);
		memcpy(&narrow, &half, sizeof(narrow));
		return narrow;
	default:
		word = ply_word(bytes, 8, big);
		memcpy(&wide, &word, sizeof(wide));
		return wide;
	}
}

/* Makes a vertex of the values of its properties; types: those of the file. */
void ply_vertex_from(struct ply_vertex *out, const struct ply_summary *summary,
		     const double values[PLY_SLOT_NONE], const enum ply_type types[PLY_SLOT_NONE]);
/* Fills types with the type of each slot that element has. */
void ply_types_of(enum ply_type types[PLY_SLOT_NONE], const struct ply_element *element);
/* Returns the number of a picture, or 0 if the value is none. */
uint32_t ply_texture_from(double value);

#endif
