/* Reads the header of a PLY: lines of words, from "ply" to "end_header". */
#include "pipeline/import/ply_header.h"

#include <errno.h>
#include <inttypes.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

size_t ply_type_bytes(enum ply_type type)
{
	static const uint8_t bytes[] = { 1, 1, 2, 2, 4, 4, 4, 8, 0 };

	return bytes[type];
}

static enum ply_type type_named(const char *word)
{
	static const struct {
		const char *word;
		enum ply_type type;
	} names[] = {
		{ "char", PLY_INT8 },       { "int8", PLY_INT8 },       { "uchar", PLY_UINT8 },
		{ "uint8", PLY_UINT8 },     { "short", PLY_INT16 },     { "int16", PLY_INT16 },
		{ "ushort", PLY_UINT16 },   { "uint16", PLY_UINT16 },   { "int", PLY_INT32 },
		{ "int32", PLY_INT32 },     { "uint", PLY_UINT32 },     { "uint32", PLY_UINT32 },
		{ "float", PLY_FLOAT32 },   { "float32", PLY_FLOAT32 }, { "double", PLY_FLOAT64 },
		{ "float64", PLY_FLOAT64 },
	};

	for (size_t i = 0; i < ARRAY_COUNT(names); i++)
		if (strcmp(names[i].word, word) == 0)
			return names[i].type;
	return PLY_TYPE_NONE;
}

static enum ply_slot slot_named(enum ply_kind kind, const char *name, bool is_list)
{
	static const struct {
		const char *name;
		enum ply_slot slot;
		bool of_faces, is_list;
	} names[] = {
		{ "x", PLY_SLOT_X, false, false },
		{ "y", PLY_SLOT_Y, false, false },
		{ "z", PLY_SLOT_Z, false, false },
		{ "red", PLY_SLOT_RED, false, false },
		{ "green", PLY_SLOT_GREEN, false, false },
		{ "blue", PLY_SLOT_BLUE, false, false },
		{ "alpha", PLY_SLOT_ALPHA, false, false },
		{ "r", PLY_SLOT_RED, false, false },
		{ "g", PLY_SLOT_GREEN, false, false },
		{ "b", PLY_SLOT_BLUE, false, false },
		{ "a", PLY_SLOT_ALPHA, false, false },
		{ "diffuse_red", PLY_SLOT_RED, false, false },
		{ "diffuse_green", PLY_SLOT_GREEN, false, false },
		{ "diffuse_blue", PLY_SLOT_BLUE, false, false },
		{ "diffuse_alpha", PLY_SLOT_ALPHA, false, false },
		{ "s", PLY_SLOT_U, false, false },
		{ "t", PLY_SLOT_V, false, false },
		{ "u", PLY_SLOT_U, false, false },
		{ "v", PLY_SLOT_V, false, false },
		{ "texture_u", PLY_SLOT_U, false, false },
		{ "texture_v", PLY_SLOT_V, false, false },
		{ "texture_s", PLY_SLOT_U, false, false },
		{ "texture_t", PLY_SLOT_V, false, false },
		{ "nx", PLY_SLOT_NORMAL_X, false, false },
		{ "ny", PLY_SLOT_NORMAL_Y, false, false },
		{ "nz", PLY_SLOT_NORMAL_Z, false, false },
		{ "confidence", PLY_SLOT_CONFIDENCE, false, false },
		{ "vertex_indices", PLY_SLOT_CORNERS, true, true },
		{ "vertex_index", PLY_SLOT_CORNERS, true, true },
		{ "texcoord", PLY_SLOT_CORNER_UVS, true, true },
		{ "texnumber", PLY_SLOT_TEXTURE, true, false },
	};

	if (kind == PLY_KIND_OTHER)
		return PLY_SLOT_NONE;
	for (size_t i = 0; i < ARRAY_COUNT(names); i++)
		if (strcmp(names[i].name, name) == 0 && names[i].is_list == is_list &&
		    names[i].of_faces == (kind != PLY_KIND_VERTEX))
			return names[i].slot;
	return PLY_SLOT_NONE;
}

static int line_fault(struct ply *ply, struct diagnostics *diagnostics, const char *what)
{
	return diagnostics_add(diagnostics, -EBADMSG, ply->name, (unsigned)ply->input.line, "%s",
			       what);
}

/* Reads a line without its end. A line ends with LF or CR LF, or with CR if the first line did
 * (then a LF after end_header is data). */
static int read_line(struct ply *ply, char line[PLY_LINE_MAX], struct diagnostics *diagnostics)
{
	struct ply_input *input = &ply->input;
	size_t length = 0;
	int c;

	while ((c = ply_input_peek(input)) >= 0 && c != '\n' && c != '\r') {
		if (length == PLY_LINE_MAX - 1)
			return line_fault(ply, diagnostics,
					  "a header line of over 4095 bytes; is this a PLY?");
		line[length++] = (char)c;
		input->at++;
	}
	line[length] = '\0';
	if (c < 0)
		return line_fault(ply, diagnostics,
				  "the file ends within its header; copy it again from the source");
	if (ply_input_offset(input) > PLY_HEADER_MAX)
		return line_fault(ply, diagnostics,
				  "the header goes on for over 1 MiB; is this a PLY?");
	input->at++;
	if (c == '\r' && input->line == 1)
		input->cr_only = ply_input_peek(input) != '\n';
	if (c == '\r' && !input->cr_only && ply_input_peek(input) == '\n')
		input->at++;
	return 0;
}

static int read_format(struct ply *ply, const char *words, struct diagnostics *diagnostics)
{
	char name[32] = "", version[16] = "";

	sscanf(words, "%31s %15s", name, version);
	if (strcmp(name, "ascii") == 0)
		ply->encoding = PLY_ASCII;
	else if (strcmp(name, "binary_little_endian") == 0)
		ply->encoding = PLY_LITTLE;
	else if (strcmp(name, "binary_big_endian") == 0)
		ply->encoding = PLY_BIG;
	else
		return line_fault(
			ply, diagnostics,
			"format must be ascii, binary_little_endian or binary_big_endian");
	if (strcmp(version, "1.0") != 0)
		return line_fault(ply, diagnostics,
				  "the format's version must be 1.0; export it again");
	return 0;
}

static enum ply_kind kind_named(const char *name)
{
	if (strcmp(name, "vertex") == 0)
		return PLY_KIND_VERTEX;
	if (strcmp(name, "face") == 0)
		return PLY_KIND_FACE;
	if (strcmp(name, "range_grid") == 0)
		return PLY_KIND_GRID;
	return strcmp(name, "tristrips") == 0 ? PLY_KIND_STRIP : PLY_KIND_OTHER;
}

static int read_element(struct ply *ply, const char *words, struct diagnostics *diagnostics)
{
	struct ply_element *element = &ply->elements[ply->element_count];
	char count[24] = "", more[2] = "", *end;

	if (ply->element_count == PLY_ELEMENTS_MAX)
		return line_fault(ply, diagnostics, "over 32 kinds of elements; remove some");
	*element = (struct ply_element){ 0 };
	if (sscanf(words, "%63s %23s %1s", element->name, count, more) != 2)
		return line_fault(ply, diagnostics, "expected: element NAME COUNT");
	errno = 0;
	element->count = strtoull(count, &end, 10);
	if (errno || *end || count[0] < '0' || count[0] > '9')
		return line_fault(ply, diagnostics, "the element's count is not a number");
	element->kind = kind_named(element->name);
	for (uint32_t i = 0; i < ply->element_count; i++)
		if (strcmp(ply->elements[i].name, element->name) == 0)
			return line_fault(ply, diagnostics,
					  "this element stands in the header twice");
	ply->element_count++;
	return 0;
}

static int read_property(struct ply *ply, const char *words, struct diagnostics *diagnostics)
{
	struct ply_element *element;
	struct ply_property property = { .count_type = PLY_TYPE_NONE };
	char first[16] = "", second[16] = "", third[16] = "";

	if (ply->element_count == 0)
		return line_fault(ply, diagnostics, "a property before the first element");
	element = &ply->elements[ply->element_count - 1];
	if (element->property_count == PLY_PROPERTIES_MAX)
		return line_fault(ply, diagnostics,
				  "over 128 properties in one element; remove some");
	if (sscanf(words, "%15s", first) == 1 && strcmp(first, "list") == 0) {
		if (sscanf(words, "%*s %15s %15s %63s", second, third, property.name) != 3)
			return line_fault(ply, diagnostics,
					  "expected: property list TYPE TYPE NAME");
		property.count_type = type_named(second);
		property.type = type_named(third);
		if (property.count_type >= PLY_FLOAT32)
			return line_fault(ply, diagnostics,
					  "a list's length must be of an integer type");
	} else if (sscanf(words, "%15s %63s", first, property.name) == 2) {
		property.type = type_named(first);
	} else {
		return line_fault(ply, diagnostics, "expected: property TYPE NAME");
	}
	if (property.type == PLY_TYPE_NONE)
		return line_fault(ply, diagnostics,
				  "unknown type; expected char, uchar, short, ushort, "
				  "int, uint, float or double");
	property.slot =
		slot_named(element->kind, property.name, property.count_type != PLY_TYPE_NONE);
	if (property.slot == PLY_SLOT_CORNERS && property.type >= PLY_FLOAT32)
		return line_fault(ply, diagnostics, "vertex indices must be of an integer type");
	element->properties[element->property_count++] = property;
	return 0;
}

static int read_comment(struct ply *ply, const char *words, struct diagnostics *diagnostics)
{
	char name[512];

	if (strncmp(words, "gopura open", 11) == 0)
		ply->gopura_open = true;
	if (sscanf(words, "TextureFile %511[^\r\n]", name) != 1)
		return 0;
	if (ply->summary.texture_count == PLY_TEXTURES_MAX)
		return line_fault(ply, diagnostics, "over 256 textures; merge some");
	ply->textures[ply->summary.texture_count] = strdup(name);
	if (!ply->textures[ply->summary.texture_count])
		return -ENOMEM;
	ply->summary.texture_count++;
	return 0;
}

/* Of the many facts that scanners write there, the size of the grid of a range image. */
static void read_info(struct ply *ply, const char *words)
{
	unsigned number;

	if (sscanf(words, "num_cols %u", &number) == 1)
		ply->summary.grid_columns = number;
	else if (sscanf(words, "num_rows %u", &number) == 1)
		ply->summary.grid_rows = number;
}

/* Returns what follows the word if the line begins with it, otherwise NULL. */
static const char *after_word(const char *line, const char *word)
{
	size_t length = strlen(word);

	if (strncmp(line, word, length) != 0 ||
	    (line[length] && line[length] != ' ' && line[length] != '\t'))
		return NULL;
	line += length;
	return line + strspn(line, " \t");
}

static int read_header_line(struct ply *ply, const char *line, bool *has_format,
			    struct diagnostics *diagnostics)
{
	const char *words;

	if ((words = after_word(line, "format"))) {
		*has_format = true;
		return read_format(ply, words, diagnostics);
	}
	if ((words = after_word(line, "element")))
		return read_element(ply, words, diagnostics);
	if ((words = after_word(line, "property")))
		return read_property(ply, words, diagnostics);
	if ((words = after_word(line, "comment")))
		return read_comment(ply, words, diagnostics);
	if ((words = after_word(line, "obj_info")))
		read_info(ply, words);
	else if (line[0])
		ply->summary.strange_lines++;
	return 0;
}

int ply_read_header(struct ply *ply, struct diagnostics *diagnostics)
{
	char line[PLY_LINE_MAX];
	bool has_format = false;
	int rc;

	if (ply_input_peek(&ply->input) < 0)
		return diagnostics_add(diagnostics, -EBADMSG, ply->name, 0,
				       "the file is empty; copy it again from the source");
	rc = read_line(ply, line, diagnostics);
	if (rc < 0)
		return rc;
	if (strcmp(line, "ply") != 0)
		return line_fault(ply, diagnostics, "not a PLY: its first line is not 'ply'");
	for (;;) {
		ply->input.line++;
		rc = read_line(ply, line, diagnostics);
		if (rc < 0)
			return rc;
		if (after_word(line, "end_header"))
			break;
		rc = read_header_line(ply, line, &has_format, diagnostics);
		if (rc < 0)
			return rc;
	}
	ply->input.line++;
	return has_format ? 0 : line_fault(ply, diagnostics, "the header has no 'format' line");
}

/* ---- checking the header against the file */

static bool has_slot(const struct ply_element *element, enum ply_slot slot)
{
	for (uint32_t i = 0; i < element->property_count; i++)
		if (element->properties[i].slot == slot)
			return true;
	return false;
}

/* Computes offsets and stride. Returns the minimum number of bytes of one element. */
static uint64_t lay_out(struct ply_element *element, enum ply_encoding encoding)
{
	uint64_t least = 0;
	bool has_list = false;

	for (uint32_t i = 0; i < element->property_count; i++) {
		struct ply_property *property = &element->properties[i];
		bool is_list = property->count_type != PLY_TYPE_NONE;

		property->offset = (uint32_t)least;
		has_list |= is_list;
		if (encoding == PLY_ASCII)
			least += 2; /* a digit and a separator */
		else
			least += ply_type_bytes(is_list ? property->count_type : property->type);
	}
	element->stride = has_list || encoding == PLY_ASCII ? 0 : (uint32_t)least;
	return least;
}

static int judge_vertices(struct ply *ply, const struct ply_element *element,
			  struct diagnostics *diagnostics)
{
	struct ply_summary *summary = &ply->summary;

	for (enum ply_slot slot = PLY_SLOT_X; slot <= PLY_SLOT_Z; slot++)
		if (!has_slot(element, slot))
			return diagnostics_add(
				diagnostics, -EBADMSG, ply->name, 0,
				"its vertices have no property %c; export x, y and z",
				'x' + (int)(slot - PLY_SLOT_X));
	if (element->count >= UINT32_MAX)
		return diagnostics_add(diagnostics, -EFBIG, ply->name, 0,
				       "%" PRIu64
				       " vertices are more than a 32-bit index can name; "
				       "split the scan into several files",
				       element->count);
	summary->vertex_count = element->count;
	summary->has_colour = has_slot(element, PLY_SLOT_RED) &&
			      has_slot(element, PLY_SLOT_GREEN) && has_slot(element, PLY_SLOT_BLUE);
	summary->has_open_sky = ply->gopura_open && has_slot(element, PLY_SLOT_ALPHA);
	summary->has_uv = has_slot(element, PLY_SLOT_U) && has_slot(element, PLY_SLOT_V);
	summary->has_normal = has_slot(element, PLY_SLOT_NORMAL_X) &&
			      has_slot(element, PLY_SLOT_NORMAL_Y) &&
			      has_slot(element, PLY_SLOT_NORMAL_Z);
	summary->has_confidence = has_slot(element, PLY_SLOT_CONFIDENCE);
	return 0;
}

static void note_why_points_only(struct ply *ply)
{
	if (ply->summary.face_count > 0)
		return;
	ply->summary.points_only =
		ply->summary.grid_cells > 0
			? "it is one range image (a range_grid of points), not a surface; make one "
			  "of all aligned range images: name them as scans in temple.ini, or use "
			  "gopura-content reconstruct"
			: "it holds points or lines but no faces; a cloud with normals becomes a surface as a scan of "
			  "temple.ini, or by gopura-content reconstruct";
}

int ply_judge_header(struct ply *ply, struct diagnostics *diagnostics)
{
	uint64_t left = ply->input.file_bytes - ply_input_offset(&ply->input) + 1;

	for (uint32_t i = 0; i < ply->element_count; i++) {
		struct ply_element *element = &ply->elements[i];
		uint64_t least = lay_out(element, ply->encoding);
		int rc = 0;

		if (element->count > 0 && least == 0)
			return diagnostics_add(diagnostics, -EBADMSG, ply->name, 0,
					       "element %s has no property; export it again",
					       element->name);
		if (element->count > 0 && element->count > left / least)
			return diagnostics_add(diagnostics, -EBADMSG, ply->name, 0,
					       "its header promises %" PRIu64 " of element %s, but "
					       "only %" PRIu64
					       " bytes are left in the file; it was cut off, or "
					       "its header is wrong: copy it again from the source",
					       element->count, element->name, left - 1);
		left -= element->count * least;
		if (element->kind == PLY_KIND_VERTEX)
			rc = judge_vertices(ply, element, diagnostics);
		else if (element->kind == PLY_KIND_GRID && has_slot(element, PLY_SLOT_CORNERS))
			ply->summary.grid_cells = element->count;
		else if (element->kind != PLY_KIND_OTHER && has_slot(element, PLY_SLOT_CORNERS))
			ply->summary.face_count += element->count;
		ply->summary.has_corner_uv |=
			element->kind == PLY_KIND_FACE && has_slot(element, PLY_SLOT_CORNER_UVS);
		if (rc < 0)
			return rc;
	}
	note_why_points_only(ply);
	return 0;
}
