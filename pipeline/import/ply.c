/* Reads the body of a PLY: one element after another; each property is decoded or skipped. */
#include "pipeline/import/ply_decode.h"
#include "pipeline/import/ply_header.h"
#include "pipeline/import/ply_input.h"
#include "pipeline/import/ply_runs.h"

#include <ctype.h>
#include <errno.h>
#include <fcntl.h>
#include <inttypes.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "base/bytes.h"

/* State of one pass over the body. */
struct pass {
	struct ply *ply;
	const struct ply_visitor *visitor;
	struct diagnostics *diagnostics;
	const struct ply_element *element;
	uint64_t index;     /* of the current element */
	uint64_t faces;     /* faces and strips in earlier elements */
	uint64_t triangles; /* delivered */
	uint64_t told;      /* the visitor knows that the file was read up to this offset */
	double values[PLY_SLOT_NONE];
	struct ply_triangle triangle;
	/* the last two corners of the current strip, and its length */
	uint32_t strip[2], strip_length;
};

/* Adds a diagnostic such as "file.ply:40: face 12: ...". */
static int element_fault(const struct pass *pass, int error, const char *what)
{
	struct ply *ply = pass->ply;

	if (ply->encoding == PLY_ASCII)
		return diagnostics_add(pass->diagnostics, error, ply->name,
				       (unsigned)ply->input.line, "%s %" PRIu64 ": %s",
				       pass->element->name, pass->index, what);
	return diagnostics_add(pass->diagnostics, error, ply->name, 0,
			       "%s %" PRIu64 " (at byte %" PRIu64 "): %s", pass->element->name,
			       pass->index, ply_input_offset(&ply->input), what);
}

static int ends_early(const struct pass *pass)
{
	if (pass->ply->input.error)
		return diagnostics_add(pass->diagnostics, pass->ply->input.error, pass->ply->name,
				       0, "reading it fails: %s",
				       strerror(-pass->ply->input.error));
	return element_fault(pass, -EBADMSG,
			     "the file ends here, short of what its header promises; copy it again "
			     "from the source");
}

static int next_number(struct pass *pass, enum ply_type type, bool cross_lines, double *out)
{
	struct ply *ply = pass->ply;
	char text[PLY_TOKEN_BYTES], what[PLY_TOKEN_BYTES + 64];
	const uint8_t *bytes;

	if (ply->encoding != PLY_ASCII) {
		bytes = ply_input_take(&ply->input, ply_type_bytes(type));
		if (!bytes)
			return ends_early(pass);
		*out = ply_number(bytes, type, ply->encoding == PLY_BIG);
		return 0;
	}
	switch (ply_input_number(&ply->input, cross_lines, out, text)) {
	case PLY_TOKEN_NUMBER:
		return 0;
	case PLY_TOKEN_LINE_END:
		return element_fault(
			pass, -EBADMSG,
			"its line has fewer numbers than its properties need; correct or "
			"remove it");
	case PLY_TOKEN_BAD:
		snprintf(what, sizeof(what), "'%.40s' is not a number; correct or remove it", text);
		return element_fault(pass, -EBADMSG, what);
	default:
		return ends_early(pass);
	}
}

/* ---- turning corners into triangles */

static int emit(struct pass *pass, uint32_t a, uint32_t b, uint32_t c)
{
	pass->triangle.corner[0] = a;
	pass->triangle.corner[1] = b;
	pass->triangle.corner[2] = c;
	pass->triangle.face = (uint32_t)(pass->faces + pass->index);
	return pass->visitor->triangle(pass->visitor->data, pass->triangles++, &pass->triangle);
}

static int check_corner(struct pass *pass, double value)
{
	char what[160];

	if (value >= 0 && value < (double)pass->ply->summary.vertex_count && value == floor(value))
		return 0;
	snprintf(what, sizeof(what),
		 "names vertex %.10g, but the file has %" PRIu64
		 " (the first is 0); correct or remove "
		 "it",
		 value, pass->ply->summary.vertex_count);
	return element_fault(pass, -EBADMSG, what);
}

/* Adds a corner of a strip; -1 starts a new strip. Every second triangle has its corners in reverse
 * order. */
static int strip_corner(struct pass *pass, double value)
{
	uint32_t corner, a = pass->strip[0], b = pass->strip[1];
	int rc;

	if (value == -1) {
		pass->strip_length = 0;
		return 0;
	}
	rc = check_corner(pass, value);
	if (rc < 0)
		return rc;
	corner = (uint32_t)value;
	pass->strip[0] = b;
	pass->strip[1] = corner;
	pass->strip_length++;
	if (pass->strip_length < 3)
		return 0;
	return pass->strip_length % 2 ? emit(pass, a, b, corner) : emit(pass, b, a, corner);
}

static int face_corner(struct pass *pass, double value)
{
	struct ply *ply = pass->ply;
	int rc = check_corner(pass, value);

	if (rc < 0)
		return rc;
	if (ply->corner_count == PLY_CORNERS_MAX)
		return element_fault(pass, -EFBIG, "over 65536 corners; triangulate it");
	ply->corners[ply->corner_count++] = (uint32_t)value;
	return 0;
}

static int end_face(struct pass *pass)
{
	struct ply *ply = pass->ply;
	bool has_uv = ply->corner_uv_floats > 0;

	if (has_uv && ply->corner_uv_floats != 2 * ply->corner_count)
		return element_fault(
			pass, -EBADMSG,
			"its texcoord list must hold two numbers a corner; export it again");
	ply->lines_skipped += ply->corner_count < 3;
	pass->triangle.texture = ply_texture_from(pass->values[PLY_SLOT_TEXTURE]);
	for (uint32_t i = 2; i < ply->corner_count; i++) {
		const uint32_t at[3] = { 0, i - 1, i };
		int rc;

		for (int k = 0; k < 3; k++)
			memcpy(pass->triangle.uv[k],
			       has_uv ? ply->corner_uvs[at[k]] : (float[2]){ 0, 0 },
			       sizeof(pass->triangle.uv[k]));
		rc = emit(pass, ply->corners[0], ply->corners[i - 1], ply->corners[i]);
		if (rc)
			return rc;
	}
	return 0;
}

static int end_cell(struct pass *pass)
{
	const struct ply *ply = pass->ply;

	/* Without a list of vertices they are no cells, and the summary counts none. */
	if (!pass->visitor->cell || ply->summary.grid_cells == 0)
		return 0;
	return pass->visitor->cell(pass->visitor->data, pass->index,
				   ply->corner_count > 0 ? (int64_t)ply->corners[0] : -1);
}

/* ---- elements */

static int list_item(struct pass *pass, enum ply_slot slot, double value)
{
	struct ply *ply = pass->ply;

	if (slot == PLY_SLOT_CORNERS)
		return pass->element->kind == PLY_KIND_STRIP ? strip_corner(pass, value)
							     : face_corner(pass, value);
	if (slot != PLY_SLOT_CORNER_UVS || pass->element->kind != PLY_KIND_FACE)
		return 0;
	if (ply->corner_uv_floats == 2 * PLY_CORNERS_MAX)
		return element_fault(pass, -EFBIG, "over 65536 corners; triangulate it");
	((float *)ply->corner_uvs)[ply->corner_uv_floats++] = (float)value;
	return 0;
}

static int read_list(struct pass *pass, const struct ply_property *property, bool is_first)
{
	double count, value;
	int rc = next_number(pass, property->count_type, is_first, &count);

	if (rc < 0)
		return rc;
	if (!(count >= 0 && count <= UINT32_MAX) || count != floor(count))
		return element_fault(pass, -EBADMSG,
				     "the length of its list is not a count; correct or remove it");
	for (uint64_t i = 0; i < (uint64_t)count; i++) {
		rc = next_number(pass, property->type, true, &value);
		if (rc == 0)
			rc = list_item(pass, property->slot, value);
		if (rc)
			return rc;
	}
	return 0;
}

static int end_vertex(struct pass *pass, const enum ply_type types[PLY_SLOT_NONE])
{
	struct ply_vertex vertex;

	ply_vertex_from(&vertex, &pass->ply->summary, pass->values, types);
	return pass->visitor->vertex(pass->visitor->data, (uint32_t)pass->index, &vertex);
}

/* Reads a binary element without lists; decodes only the properties that we use. */
static int read_packed(struct pass *pass)
{
	const struct ply_element *element = pass->element;
	const uint8_t *bytes = ply_input_take(&pass->ply->input, element->stride);

	if (!bytes)
		return ends_early(pass);
	for (uint32_t i = 0; i < element->property_count; i++) {
		const struct ply_property *property = &element->properties[i];

		if (property->slot != PLY_SLOT_NONE)
			pass->values[property->slot] =
				ply_number(bytes + property->offset, property->type,
					   pass->ply->encoding == PLY_BIG);
	}
	return 0;
}

static int read_properties(struct pass *pass)
{
	for (uint32_t i = 0; i < pass->element->property_count; i++) {
		const struct ply_property *property = &pass->element->properties[i];
		double value;
		int rc;

		if (property->count_type != PLY_TYPE_NONE) {
			rc = read_list(pass, property, i == 0);
		} else {
			/* Only the first property of an element may follow a line break. */
			rc = next_number(pass, property->type, i == 0, &value);
			if (rc == 0 && property->slot != PLY_SLOT_NONE)
				pass->values[property->slot] = value;
		}
		if (rc)
			return rc;
	}
	return 0;
}

/* After the last number of an element only the end of its line may follow. */
static int end_line(struct pass *pass)
{
	struct ply_input *input = &pass->ply->input;
	double ignored;
	char text[PLY_TOKEN_BYTES];

	if (pass->ply->encoding != PLY_ASCII)
		return 0;
	switch (ply_input_number(input, false, &ignored, text)) {
	case PLY_TOKEN_LINE_END:
	case PLY_TOKEN_FILE_END:
		return 0;
	default:
		return element_fault(pass, -EBADMSG,
				     "its line has more than its properties; correct or remove it");
	}
}

static int read_one(struct pass *pass, const enum ply_type types[PLY_SLOT_NONE])
{
	struct ply *ply = pass->ply;
	int rc;

	ply->corner_count = ply->corner_uv_floats = 0;
	pass->strip_length = 0;
	rc = pass->element->stride ? read_packed(pass) : read_properties(pass);
	if (rc == 0)
		rc = end_line(pass);
	if (rc == 0 && pass->element->kind == PLY_KIND_VERTEX)
		rc = end_vertex(pass, types);
	if (rc == 0 && pass->element->kind == PLY_KIND_FACE)
		rc = end_face(pass);
	if (rc == 0 && pass->element->kind == PLY_KIND_GRID)
		rc = end_cell(pass);
	return rc;
}

/* The visitor learns how far the reading is once for so many elements. */
enum { ELEMENTS_PER_ADVANCE = 1 << 14 };

static void advance(struct pass *pass)
{
	uint64_t offset = ply_input_offset(&pass->ply->input);

	if (pass->visitor->advance)
		pass->visitor->advance(pass->visitor->data, offset - pass->told);
	pass->told = offset;
}

/* Reads what several threads can read. */
static int read_run(struct pass *pass)
{
	int rc;

	/* the index of a triangle is known in advance only if all before are triangles too */
	if (pass->element->kind == PLY_KIND_FACE && pass->faces > 0)
		return 0;
	rc = ply_runs_read(&pass->index, pass->ply, pass->element, pass->visitor);
	if (pass->element->kind == PLY_KIND_FACE)
		pass->triangles += pass->index;
	pass->told = ply_input_offset(&pass->ply->input);
	return rc;
}

static int read_element(struct pass *pass, const struct ply_element *element)
{
	enum ply_type types[PLY_SLOT_NONE];
	int rc;

	pass->element = element;
	memset(pass->values, 0, sizeof(pass->values));
	memset(&pass->triangle, 0, sizeof(pass->triangle));
	ply_types_of(types, element);
	pass->index = 0;
	rc = read_run(pass);
	for (; pass->index < element->count && rc == 0; pass->index++) {
		rc = read_one(pass, types);
		if (pass->index % ELEMENTS_PER_ADVANCE == 0)
			advance(pass);
	}
	if (element->kind == PLY_KIND_FACE || element->kind == PLY_KIND_STRIP)
		pass->faces += element->count;
	if (strcmp(element->name, "edge") == 0)
		pass->ply->lines_skipped += element->count;
	return rc;
}

int ply_place(float out[3], const struct ply *ply, const struct ply_element *element, int fd,
	      uint64_t offset)
{
	uint8_t bytes[sizeof(double)];
	int rc = 0;

	for (uint32_t i = 0; rc == 0 && i < element->property_count; i++) {
		const struct ply_property *property = &element->properties[i];

		if (property->slot > PLY_SLOT_Z)
			continue;
		rc = bytes_read_at(fd, bytes, ply_type_bytes(property->type),
				   offset + property->offset);
		if (rc == 0)
			out[property->slot - PLY_SLOT_X] =
				(float)ply_number(bytes, property->type, ply->encoding == PLY_BIG);
	}
	return rc;
}

int ply_read(struct ply *ply, const struct ply_visitor *visitor, struct diagnostics *diagnostics)
{
	struct pass pass = { .ply = ply, .visitor = visitor, .diagnostics = diagnostics };

	for (uint32_t i = 0; i < ply->element_count; i++) {
		int rc = read_element(&pass, &ply->elements[i]);

		if (rc)
			return rc;
	}
	ply->triangles = pass.triangles;
	while (ply->encoding == PLY_ASCII && isspace(ply_input_peek(&ply->input)))
		ply_input_take(&ply->input, 1);
	ply->trailing = ply->input.file_bytes > ply_input_offset(&ply->input)
				? ply->input.file_bytes - ply_input_offset(&ply->input)
				: 0;
	return 0;
}

/* ---- opening */

static int start(struct ply *ply, int fd, struct diagnostics *diagnostics)
{
	int rc = ply_input_init(&ply->input, fd);

	if (rc == -EISDIR || rc == -ESPIPE)
		return diagnostics_add(diagnostics, rc, ply->name, 0,
				       "not a regular file; give a PLY file");
	ply->corners = malloc(PLY_CORNERS_MAX * sizeof(*ply->corners));
	ply->corner_uvs = malloc(PLY_CORNERS_MAX * sizeof(*ply->corner_uvs));
	if (rc == 0 && (!ply->corners || !ply->corner_uvs))
		rc = -ENOMEM;
	if (rc < 0)
		return diagnostics_add(diagnostics, rc, ply->name, 0, "%s", strerror(-rc));
	rc = ply_read_header(ply, diagnostics);
	if (rc == 0)
		rc = ply_judge_header(ply, diagnostics);
	ply->summary.textures = (const char *const *)ply->textures;
	ply->summary.is_ascii = ply->encoding == PLY_ASCII;
	return rc;
}

int ply_open_fd(struct ply **out, int fd, const char *name, struct diagnostics *diagnostics)
{
	struct ply *ply = calloc(1, sizeof(*ply));
	int rc;

	*out = NULL;
	if (!ply) {
		close(fd);
		return diagnostics_add(diagnostics, -ENOMEM, name, 0, "%s", strerror(ENOMEM));
	}
	snprintf(ply->name, sizeof(ply->name), "%s", name);
	rc = start(ply, fd, diagnostics);
	if (rc < 0) {
		ply_close(ply);
		return rc;
	}
	*out = ply;
	return 0;
}

int ply_open(struct ply **out, const char *path, struct diagnostics *diagnostics)
{
	int fd = open(path, O_RDONLY | O_CLOEXEC);

	*out = NULL;
	if (fd < 0)
		return diagnostics_add(diagnostics, -errno, path, 0, "%s", strerror(errno));
	return ply_open_fd(out, fd, path, diagnostics);
}

void ply_close(struct ply *ply)
{
	if (!ply)
		return;
	ply_input_finish(&ply->input);
	for (uint32_t i = 0; i < PLY_TEXTURES_MAX; i++)
		free(ply->textures[i]);
	free(ply->corners);
	free(ply->corner_uvs);
	free(ply);
}

const struct ply_summary *ply_summary(const struct ply *ply)
{
	return &ply->summary;
}

uint64_t ply_bytes_total(const struct ply *ply)
{
	return ply->input.file_bytes;
}

uint64_t ply_triangles(const struct ply *ply)
{
	return ply->triangles;
}

uint64_t ply_lines_skipped(const struct ply *ply)
{
	return ply->lines_skipped;
}

uint64_t ply_bytes_trailing(const struct ply *ply)
{
	return ply->trailing;
}
