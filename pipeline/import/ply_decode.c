/* Decodes vertices of a PLY file. */
#include "pipeline/import/ply_decode.h"

/* Converts a colour of any type to 0..255. Floats range over 0..1, 16-bit integers up to 65535. */
static uint8_t colour_byte(double value, enum ply_type type)
{
	if (type >= PLY_FLOAT32)
		value *= 255;
	else if (type == PLY_UINT16 || type == PLY_INT16)
		value /= 257;
	if (!(value > 0))
		return 0;
	return value < 255 ? (uint8_t)(value + 0.5) : 255;
}

void ply_vertex_from(struct ply_vertex *out, const struct ply_summary *summary,
		     const double values[PLY_SLOT_NONE], const enum ply_type types[PLY_SLOT_NONE])
{
	*out = (struct ply_vertex){ .colour = { 255, 255, 255, 255 }, .confidence = 1 };
	for (int k = 0; k < 3; k++)
		out->position[k] = values[PLY_SLOT_X + k];
	for (int k = 0; k < 3 && summary->has_colour; k++)
		out->colour[k] = colour_byte(values[PLY_SLOT_RED + k], types[PLY_SLOT_RED + k]);
	if (summary->has_open_sky)
		out->colour[3] = colour_byte(values[PLY_SLOT_ALPHA], types[PLY_SLOT_ALPHA]);
	for (int k = 0; k < 2 && summary->has_uv; k++)
		out->uv[k] = (float)values[PLY_SLOT_U + k];
	for (int k = 0; k < 3 && summary->has_normal; k++)
		out->normal[k] = (float)values[PLY_SLOT_NORMAL_X + k];
	if (summary->has_confidence)
		out->confidence = (float)values[PLY_SLOT_CONFIDENCE];
}

void ply_types_of(enum ply_type types[PLY_SLOT_NONE], const struct ply_element *element)
{
	for (int slot = 0; slot < PLY_SLOT_NONE; slot++)
		types[slot] = PLY_INT8;
	for (uint32_t i = 0; i < element->property_count; i++)
		if (element->properties[i].slot != PLY_SLOT_NONE)
			types[element->properties[i].slot] = element->properties[i].type;
}

uint32_t ply_texture_from(double value)
{
	return value > 0 && value < PLY_TEXTURES_MAX ? (uint32_t)value : 0;
}
