/* Estimates the counts of a scan from its header or, where the format has none, from windows that
 * are spread over the file. */
#include "pipeline/import/scan_look.h"

#include <ctype.h>
#include <errno.h>
#include <fcntl.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "base/bytes.h"
#include "pipeline/import/ply_header.h"

enum {
	WINDOW_BYTES = 8 << 10,
	WINDOWS_MAX = 128,
	LINE_VALUES_MAX = 16,
	STL_HEAD_BYTES = 84,
	STL_TRIANGLE_BYTES = 50,
	GLTF_JSON_BYTES_MAX = 8 << 20,
};

struct look {
	struct scan_look *out;
	const struct import_options *options;
	int fd;
};

static void add_place(struct look *look, const float place[3])
{
	struct scan_look *out = look->out;

	if (out->place_count == SCAN_LOOK_PLACES_MAX || !isfinite(place[0]) ||
	    !isfinite(place[1]) || !isfinite(place[2]))
		return;
	import_place(out->places_m[out->place_count++], place, look->options);
}

/* ---- text: lines in windows */

/* Called for each whole line of a window, without its end. */
typedef void line_visitor(void *data, char *line);

/* Visits lines of windows that are spread over the bytes from `from` to the file's end. Returns the
 * number of bytes of these lines, or a negative errno. */
static int64_t visit_lines(const struct look *look, uint64_t from, line_visitor *visit, void *data)
{
	uint64_t size = look->out->file_bytes - from;
	uint32_t count = size / WINDOW_BYTES < WINDOWS_MAX ? (uint32_t)(size / WINDOW_BYTES) + 1
							   : WINDOWS_MAX;
	char window[WINDOW_BYTES + 1];
	int64_t visited = 0;

	for (uint32_t i = 0; i < count; i++) {
		uint64_t at = from + size / count * i;
		ssize_t got = pread(look->fd, window, WINDOW_BYTES, (off_t)at);
		char *line = window, *end;

		if (got < 0)
			return -errno;
		window[got] = '\0';
		if (at > from) { /* the first line is cut off */
			end = strchr(line, '\n');
			line = end ? end + 1 : line + strlen(line);
		}
		for (; (end = strchr(line, '\n')); line = end + 1) {
			*end = '\0';
			visited += end - line + 1;
			visit(data, line);
		}
	}
	return visited;
}

/* Reads the numbers of a line; returns how many there are, at most LINE_VALUES_MAX. */
static unsigned read_values(const char *line, float values[LINE_VALUES_MAX])
{
	unsigned count = 0;

	while (count < LINE_VALUES_MAX) {
		char *end;

		values[count] = strtof(line, &end);
		if (end == line)
			break;
		count++;
		line = end;
	}
	return count;
}

/* What the visited lines of a format with text hold. */
struct lines {
	struct look *look;
	uint64_t vertices, triangles, pictures;
	unsigned slots[3]; /* where a vertex has x, y and z */
	uint32_t every;    /* one vertex of so many is taken as a place */
};

static void take_vertex(struct lines *lines, const char *text)
{
	float values[LINE_VALUES_MAX], place[3];
	unsigned count = read_values(text, values);

	for (int k = 0; k < 3; k++) {
		if (lines->slots[k] >= count)
			return;
		place[k] = values[lines->slots[k]];
	}
	if (lines->vertices++ % lines->every == 0)
		add_place(lines->look, place);
}

/* Spreads the places over all windows. */
static struct lines lines_of(struct look *look)
{
	uint64_t bytes = (uint64_t)WINDOW_BYTES * WINDOWS_MAX;
	uint64_t seen = look->out->file_bytes < bytes ? look->out->file_bytes : bytes;

	return (struct lines){ .look = look,
			       .slots = { 0, 1, 2 },
			       .every = (uint32_t)(seen / 30 / SCAN_LOOK_PLACES_MAX) + 1 };
}

/* Estimates a count of the whole file from that of the visited lines. */
static uint64_t scale(const struct look *look, uint64_t count, int64_t visited)
{
	double share = (double)visited / (double)look->out->file_bytes;
	double all = visited > 0 ? (double)count / (share < 1 ? share : 1) : 0;

	return all < 1 ? 1 : (uint64_t)all;
}

static void visit_obj(void *data, char *line)
{
	struct lines *lines = data;
	unsigned corners = 0;

	if (line[0] == 'v' && isspace((unsigned char)line[1])) {
		take_vertex(lines, line + 1);
	} else if (line[0] == 'f' && isspace((unsigned char)line[1])) {
		for (line++; *(line += strspn(line, " \t\r")); corners++)
			line += strcspn(line, " \t\r");
		lines->triangles += corners > 2 ? corners - 2 : 0;
	} else if (line[0] == 'v' && line[1] == 't') {
		lines->pictures++;
	}
}

static int look_obj(struct look *look)
{
	struct lines lines = lines_of(look);
	int64_t visited = visit_lines(look, 0, visit_obj, &lines);

	if (visited < 0)
		return (int)visited;
	look->out->is_text = true;
	look->out->triangle_count = scale(look, lines.triangles, visited);
	look->out->vertex_count = scale(look, lines.vertices, visited);
	look->out->has_pictures = lines.pictures > 0;
	return 0;
}

/* ---- STL and OFF */

static void visit_stl(void *data, char *line)
{
	struct lines *lines = data;

	line += strspn(line, " \t");
	if (strncmp(line, "vertex", 6) == 0)
		take_vertex(lines, line + 6);
	lines->triangles += strncmp(line, "endfacet", 8) == 0;
}

static int look_stl(struct look *look)
{
	struct scan_look *out = look->out;
	struct lines lines = lines_of(look);
	uint8_t head[STL_HEAD_BYTES] = { 0 };
	struct reader reader;
	int64_t visited;
	uint64_t step;

	if (pread(look->fd, head, sizeof(head), 0) < 0)
		return -errno;
	reader_init(&reader, (struct bytes){ head + 80, 4 });
	out->triangle_count = reader_u32(&reader);
	if (STL_HEAD_BYTES + out->triangle_count * STL_TRIANGLE_BYTES != out->file_bytes) {
		visited = visit_lines(look, 0, visit_stl, &lines);
		if (visited < 0)
			return (int)visited;
		out->is_text = true;
		out->triangle_count = scale(look, lines.triangles, visited);
	} else {
		out->is_counted = true;
		step = out->triangle_count / SCAN_LOOK_PLACES_MAX + 1;
		for (uint64_t i = 0; i < out->triangle_count; i += step) {
			uint8_t corner[12];
			float place[3];

			if (bytes_read_at(look->fd, corner, sizeof(corner),
					  STL_HEAD_BYTES + i * STL_TRIANGLE_BYTES + 12) < 0)
				return -EIO;
			reader_init(&reader, (struct bytes){ corner, sizeof(corner) });
			for (int k = 0; k < 3; k++)
				place[k] = reader_f32(&reader);
			add_place(look, place);
		}
	}
	out->vertex_count = out->triangle_count / 2 + 1;
	return 0;
}

/* A line of a vertex has a point or an exponent; a line of a face has whole numbers. */
static void visit_numbers(void *data, char *line)
{
	if (strpbrk(line, ".eE"))
		take_vertex(data, line);
}

static int look_off(struct look *look)
{
	struct lines lines = lines_of(look);
	char head[256] = "";
	uint64_t vertices = 0, faces = 0;
	ssize_t got = pread(look->fd, head, sizeof(head) - 1, 0);
	char *at = strpbrk(head, "\r\n");

	while (at && (isspace((unsigned char)*at) || *at == '#'))
		at = *at == '#' ? strpbrk(at, "\r\n") : at + 1;
	if (got < 0)
		return -errno;
	if (at) {
		char *end;

		vertices = strtoull(at, &end, 10);
		faces = strtoull(end, NULL, 10);
	}
	if (visit_lines(look, 0, visit_numbers, &lines) < 0)
		return -EIO;
	look->out->is_text = look->out->is_counted = true;
	look->out->triangle_count = faces;
	look->out->vertex_count = vertices;
	return 0;
}

/* ---- glTF */

/* Returns the sum of the lengths of its buffers, or the size of the file if it holds them. */
static uint64_t buffer_bytes_of(const char *json, uint64_t file_bytes)
{
	const char *at = strstr(json, "\"buffers\"");
	const char *end = at ? strchr(at, ']') : NULL;
	uint64_t bytes = 0;

	while (at && end && (at = strstr(at, "\"byteLength\"")) && at < end) {
		at += strcspn(at, "0123456789]");
		bytes += strtoull(at, NULL, 10);
	}
	return bytes > 0 ? bytes : file_bytes;
}

/* Adds the corners of boxes: accessors of positions, and few others, have min and max. */
static void add_boxes(struct look *look, const char *json)
{
	static const char *const names[] = { "\"min\"", "\"max\"" };

	for (int n = 0; n < 2; n++)
		for (const char *at = json; (at = strstr(at, names[n]));) {
			float place[3];

			at += 5;
			if (sscanf(at, " : [ %f , %f , %f ]", &place[0], &place[1], &place[2]) == 3)
				add_place(look, place);
		}
}

/* Counts a triangle as three indices of 4 bytes and half a vertex of 32. */
static int look_gltf(struct look *look)
{
	enum { TRIANGLE_BYTES = 28 };
	struct scan_look *out = look->out;
	size_t size = out->file_bytes < GLTF_JSON_BYTES_MAX ? (size_t)out->file_bytes
							    : GLTF_JSON_BYTES_MAX;
	char *json = calloc(1, size + 1);
	size_t from = 0;
	int rc = json ? bytes_read_at(look->fd, json, size, 0) : -ENOMEM;

	if (rc == 0) {
		if (size > 20 && memcmp(json, "glTF", 4) == 0)
			from = 20; /* the JSON is the first chunk of a GLB; it has no zero bytes */
		out->has_pictures = strstr(json + from, "\"images\"") != NULL;
		out->triangle_count =
			buffer_bytes_of(json + from, out->file_bytes) / TRIANGLE_BYTES;
		out->vertex_count = out->triangle_count / 2 + 1;
		add_boxes(look, json + from);
	}
	free(json);
	return rc;
}

/* ---- VRML97 */

/* A triangle and its half of a vertex are about 40 bytes of text, which gzip packs to a fifth. The
 * places of its shapes are known only once they are made. */
static int look_vrml(struct look *look)
{
	enum { TRIANGLE_BYTES = 40, PACKED_BYTES = 8 };
	uint8_t head[2] = { 0 };
	bool is_packed;

	if (pread(look->fd, head, sizeof(head), 0) < 0)
		return -errno;
	is_packed = head[0] == 0x1f && head[1] == 0x8b;
	look->out->is_text = true;
	look->out->triangle_count =
		look->out->file_bytes / (is_packed ? PACKED_BYTES : TRIANGLE_BYTES) + 1;
	look->out->vertex_count = look->out->triangle_count / 2 + 1;
	return 0;
}

/* ---- PLY */

static unsigned slot_index(const struct ply_element *element, enum ply_slot slot)
{
	for (uint32_t i = 0; i < element->property_count; i++)
		if (element->properties[i].slot == slot)
			return i;
	return LINE_VALUES_MAX;
}

static int look_at_vertices(struct look *look, const struct ply *ply,
			    const struct ply_element *element)
{
	uint64_t from = ply_input_offset(&ply->input);
	uint64_t step = element->count / SCAN_LOOK_PLACES_MAX + 1;
	struct lines lines = lines_of(look);

	if (element->stride == 0) {
		for (int k = 0; k < 3; k++)
			lines.slots[k] = slot_index(element, (enum ply_slot)((int)PLY_SLOT_X + k));
		return visit_lines(look, from, visit_numbers, &lines) < 0 ? -EIO : 0;
	}
	for (uint64_t i = 0; i < element->count; i += step) {
		float place[3];
		int rc = ply_place(place, ply, element, look->fd, from + i * element->stride);

		if (rc < 0)
			return rc;
		add_place(look, place);
	}
	return 0;
}

/* The bytes that faces have beyond triangles are further corners. */
static uint64_t count_triangles(const struct look *look, const struct ply *ply, uint64_t before)
{
	const struct ply_element *faces = NULL;
	uint64_t bytes = look->out->file_bytes - before, count = ply->summary.face_count;
	uint64_t list = 0, others = 0;

	for (uint32_t i = 0; i < ply->element_count; i++)
		if (ply->elements[i].kind == PLY_KIND_FACE ||
		    ply->elements[i].kind == PLY_KIND_STRIP)
			faces = &ply->elements[i];
	if (!faces || ply->encoding == PLY_ASCII || ply->element_count != 2)
		return count;
	for (uint32_t i = 0; i < faces->property_count; i++) {
		const struct ply_property *property = &faces->properties[i];

		if (property->slot == PLY_SLOT_CORNERS)
			list = ply_type_bytes(property->type);
		else if (property->count_type != PLY_TYPE_NONE)
			return count; /* another list, of unknown length */
		others += ply_type_bytes(property->count_type == PLY_TYPE_NONE
						 ? property->type
						 : property->count_type);
	}
	if (list == 0 || bytes < count * (others + 2 * list))
		return count;
	return (bytes - count * (others + 2 * list)) / list;
}

static int look_ply(struct look *look, const char *path, struct diagnostics *diagnostics)
{
	struct scan_look *out = look->out;
	const struct ply_element *first;
	struct ply *ply;
	uint64_t before;
	int rc = ply_open(&ply, path, diagnostics);

	if (rc < 0)
		return rc;
	first = &ply->elements[0];
	before = ply_input_offset(&ply->input) + first->count * first->stride;
	out->is_counted = true;
	out->is_text = ply->summary.is_ascii;
	out->vertex_count = ply->summary.vertex_count;
	out->triangle_count = count_triangles(look, ply, before);
	out->has_colours = ply->summary.has_colour;
	out->has_pictures = ply->summary.texture_count > 0 &&
			    (ply->summary.has_uv || ply->summary.has_corner_uv);
	if (first->kind == PLY_KIND_VERTEX)
		rc = look_at_vertices(look, ply, first);
	ply_close(ply);
	return rc;
}

int scan_look(struct scan_look *out, const char *path, const struct import_options *options,
	      struct diagnostics *diagnostics)
{
	struct look look = { .out = out, .options = options };
	enum scan_format format;
	uint64_t points;
	int rc;

	*out = (struct scan_look){ .format = "" };
	out->is_points = import_is_points(path, &points);
	rc = out->is_points ? 0 : import_check(path, diagnostics);
	if (rc == 0)
		rc = import_detect(&format, &out->file_bytes, path, diagnostics);
	if (rc < 0)
		return rc;
	out->format = import_format_name(format);
	look.fd = open(path, O_RDONLY | O_CLOEXEC);
	if (look.fd < 0)
		return diagnostics_add(diagnostics, -errno, path, 0, "%s", strerror(errno));
	switch (format) {
	case SCAN_PLY:
		rc = look_ply(&look, path, diagnostics);
		break;
	case SCAN_OBJ:
		rc = look_obj(&look);
		break;
	case SCAN_STL:
		rc = look_stl(&look);
		break;
	case SCAN_OFF:
		rc = look_off(&look);
		break;
	case SCAN_VRML:
		rc = look_vrml(&look);
		break;
	default:
		rc = look_gltf(&look);
	}
	close(look.fd);
	if (rc < 0 && (!diagnostics || diagnostics->count == 0))
		diagnostics_add(diagnostics, rc, path, 0, "%s", strerror(-rc));
	if (options->override_colour)
		out->has_pictures = false;
	if (out->triangle_count == 0)
		out->triangle_count = 1;
	return rc;
}
