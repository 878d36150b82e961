#include "pipeline/import/ply.h"

#include <errno.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/mman.h>
#include <unistd.h>

#include "tests/check.h"

enum { MOST = 64 };

/* What a visitor saw. */
struct seen {
	uint32_t vertices, triangles;
	struct ply_vertex vertex[MOST];
	struct ply_triangle triangle[MOST];
	struct ply_summary summary;
	char texture[64];
	uint64_t trailing;
	struct diagnostics diagnostics;
};

static int see_vertex(void *data, uint32_t index, const struct ply_vertex *vertex)
{
	struct seen *seen = data;

	CHECK(index == seen->vertices);
	if (seen->vertices < MOST)
		seen->vertex[seen->vertices] = *vertex;
	seen->vertices++;
	return 0;
}

static int see_triangle(void *data, uint64_t index, const struct ply_triangle *triangle)
{
	struct seen *seen = data;

	CHECK(index == seen->triangles);
	if (seen->triangles < MOST)
		seen->triangle[seen->triangles] = *triangle;
	seen->triangles++;
	return 0;
}

static int read_bytes(struct seen *seen, const void *data, size_t size)
{
	const struct ply_visitor visitor = { .data = seen,
					     .vertex = see_vertex,
					     .triangle = see_triangle };
	int fd = memfd_create("ply", MFD_CLOEXEC);
	struct ply *ply;
	int rc;

	*seen = (struct seen){ 0 };
	CHECK(fd >= 0 && write(fd, data, size) == (ssize_t)size && lseek(fd, 0, SEEK_SET) == 0);
	rc = ply_open_fd(&ply, fd, "scan.ply", &seen->diagnostics);
	if (rc < 0)
		return rc;
	seen->summary = *ply_summary(ply);
	if (seen->summary.texture_count > 0)
		snprintf(seen->texture, sizeof(seen->texture), "%s", seen->summary.textures[0]);
	rc = ply_read(ply, &visitor, &seen->diagnostics);
	seen->trailing = ply_bytes_trailing(ply);
	ply_close(ply);
	return rc;
}

static int read_text(struct seen *seen, const char *text)
{
	return read_bytes(seen, text, strlen(text));
}

static bool corners_are(const struct ply_triangle *triangle, uint32_t a, uint32_t b, uint32_t c)
{
	return triangle->corner[0] == a && triangle->corner[1] == b && triangle->corner[2] == c;
}

#define XYZ   "property float x\nproperty float y\nproperty float z\n"
#define FACES "property list uchar int vertex_indices\nend_header\n"

static void reads_ascii_and_fans_polygons(void **state)
{
	static const char text[] = "ply\nformat ascii 1.0\nelement vertex 5\n" XYZ
				   "element face 2\n" FACES "0 0 0\n1 0 0\n1 1.5e0 0\n0 1 -0.25\n"
				   "nan 5 5\n5 0 1 2 3 4\n3 2 1 0\n";
	struct seen seen;
	(void)state;

	CHECK(read_text(&seen, text) == 0);
	CHECK(seen.vertices == 5 && seen.triangles == 4);
	CHECK(seen.vertex[2].position[1] == 1.5 && seen.vertex[3].position[2] == -0.25);
	CHECK(isnan(seen.vertex[4].position[0]));
	CHECK(corners_are(&seen.triangle[0], 0, 1, 2) && corners_are(&seen.triangle[1], 0, 2, 3));
	CHECK(corners_are(&seen.triangle[2], 0, 3, 4) && corners_are(&seen.triangle[3], 2, 1, 0));
	CHECK(seen.summary.is_ascii && !seen.summary.has_colour && seen.trailing == 0);
}

/* The same little scan in any encoding: types and order unlike the usual, strange properties
 * between, an element that nobody knows, a list in the vertices. */
static size_t write_odd_scan(uint8_t *out, bool big)
{
	size_t n = (size_t)snprintf(
		(char *)out, 1024,
		"ply\r\nformat binary_%s_endian 1.0\r\ncomment x\r\nelement stray 2\r\n"
		"property list uint16 double junk\r\nproperty char more\r\n"
		"element vertex 3\r\nproperty ushort red\r\nproperty double z\r\n"
		"property short y\r\nproperty float green\r\nproperty list uchar short tags\r\n"
		"property uchar blue\r\nproperty int x\r\n"
		"element face 1\r\nproperty float quality\r\n"
		"property list int ushort vertex_index\r\nend_header\r\n",
		big ? "big" : "little");

#define PUT(type, value)                                                                           \
	do {                                                                                       \
		type v_ = (value);                                                                 \
		for (size_t b_ = 0; b_ < sizeof(v_); b_++)                                         \
			out[n + b_] = ((uint8_t *)&v_)[big ? sizeof(v_) - 1 - b_ : b_];            \
		n += sizeof(v_);                                                                   \
	} while (0)
	for (int i = 0; i < 2; i++) {
		PUT(uint16_t, (uint16_t)i);
		for (int k = 0; k < i; k++)
			PUT(double, 0.5);
		PUT(int8_t, -3);
	}
	for (int i = 0; i < 3; i++) {
		PUT(uint16_t, 65535);
		PUT(double, 1e-3 * i);
		PUT(int16_t, (int16_t)(-300 * i));
		PUT(float, 0.5f);
		PUT(uint8_t, (uint8_t)i);
		for (int k = 0; k < i; k++)
			PUT(int16_t, 7);
		PUT(uint8_t, 9);
		PUT(int32_t, 100000 * i);
	}
	PUT(float, 1);
	PUT(int32_t, 3);
	for (int i = 0; i < 3; i++)
		PUT(uint16_t, (uint16_t)(2 - i));
#undef PUT
	return n;
}

static void reads_both_byte_orders_any_type_and_skips_strangers(void **state)
{
	uint8_t bytes[2048];
	struct seen seen;
	(void)state;

	for (int big = 0; big < 2; big++) {
		size_t size = write_odd_scan(bytes, big);

		CHECK(read_bytes(&seen, bytes, size) == 0);
		CHECK(seen.vertices == 3 && seen.triangles == 1 && seen.summary.has_colour);
		CHECK(seen.vertex[2].position[0] == 200000 && seen.vertex[2].position[1] == -600);
		CHECK(seen.vertex[2].position[2] == 2e-3);
		CHECK(seen.vertex[1].colour[0] == 255 && seen.vertex[1].colour[1] == 128);
		CHECK(seen.vertex[1].colour[2] == 9 && seen.vertex[1].colour[3] == 255);
		CHECK(corners_are(&seen.triangle[0], 2, 1, 0));
	}
}

static void refuses_every_truncation(void **state)
{
	uint8_t bytes[2048];
	size_t size = write_odd_scan(bytes, false);
	struct seen seen;
	(void)state;

	for (size_t n = 0; n < size; n++) {
		CHECK(read_bytes(&seen, bytes, n) == -EBADMSG);
		CHECK(strstr(seen.diagnostics.first.text, "scan.ply"));
	}
}

static void strips_turn_every_other_triangle_and_start_anew(void **state)
{
	static const char text[] = "ply\nformat ascii 1.0\nelement vertex 6\n" XYZ
				   "element tristrips 1\nproperty list int int vertex_indices\n"
				   "end_header\n0 0 0\n1 0 0\n0 1 0\n1 1 0\n0 2 0\n1 2 0\n"
				   "9 0 1 2 3 -1\n3 2 5 4\n";
	struct seen seen;
	(void)state;

	CHECK(read_text(&seen, text) == 0);
	CHECK(seen.triangles == 4);
	CHECK(corners_are(&seen.triangle[0], 0, 1, 2) && corners_are(&seen.triangle[1], 2, 1, 3));
	CHECK(corners_are(&seen.triangle[2], 3, 2, 5) && corners_are(&seen.triangle[3], 5, 2, 4));
}

static void alpha_is_open_sky_only_by_our_comment(void **state)
{
	static const char body[] = "element vertex 3\n" XYZ
				   "property uchar red\nproperty uchar green\nproperty uchar blue\n"
				   "property uchar alpha\nelement face 1\n" FACES
				   "0 0 0 1 2 3 40\n1 0 0 1 2 3 40\n0 1 0 1 2 3 40\n3 0 1 2\n";
	char text[1024];
	struct seen seen;
	(void)state;

	snprintf(text, sizeof(text), "ply\nformat ascii 1.0\n%s", body);
	CHECK(read_text(&seen, text) == 0 && seen.vertex[0].colour[3] == 255);
	snprintf(text, sizeof(text), "ply\nformat ascii 1.0\ncomment gopura open\n%s", body);
	CHECK(read_text(&seen, text) == 0 && seen.vertex[0].colour[3] == 40);
	CHECK(seen.summary.has_open_sky && seen.vertex[0].colour[2] == 3);
}

static void reads_places_in_pictures(void **state)
{
	static const char corners[] =
		"ply\nformat ascii 1.0\ncomment TextureFile skin one.png\nelement vertex 3\n" XYZ
		"element face 1\nproperty list uchar int vertex_indices\n"
		"property list uchar float texcoord\nproperty int texnumber\nend_header\n"
		"0 0 0\n1 0 0\n0 1 0\n3 0 1 2 6 0 0 1 0 0.25 1 0\n";
	static const char vertices[] =
		"ply\nformat ascii 1.0\ncomment TextureFile skin.png\nelement vertex 3\n" XYZ
		"property float texture_u\nproperty float texture_v\nelement face 1\n" FACES
		"0 0 0 0.5 0.75\n1 0 0 0 0\n0 1 0 1 1\n3 0 1 2\n";
	struct seen seen;
	(void)state;

	CHECK(read_text(&seen, corners) == 0 && seen.summary.has_corner_uv);
	CHECK(strcmp(seen.texture, "skin one.png") == 0 && seen.triangle[0].uv[2][0] == 0.25f);
	CHECK(read_text(&seen, vertices) == 0 && seen.summary.has_uv);
	CHECK(seen.vertex[0].uv[0] == 0.5f && seen.vertex[0].uv[1] == 0.75f);
}

static void ends_of_header_lines_do_not_eat_data(void **state)
{
	/* x of the first vertex begins with the byte 0x0a. */
	static const struct {
		const char *line_end, *last_end;
	} cases[] = { { "\n", "\n" }, { "\r\n", "\r\n" }, { "\r", "\r" }, { "\n", "\r\n" } };
	uint8_t bytes[512];
	struct seen seen;
	(void)state;

	for (size_t i = 0; i < ARRAY_COUNT(cases); i++) {
		const char *e = cases[i].line_end;
		size_t n =
			(size_t)snprintf((char *)bytes, 200,
					 "ply%sformat binary_little_endian 1.0%selement vertex 1%s"
					 "property uchar x%sproperty uchar y%sproperty uchar z%s"
					 "end_header%s",
					 e, e, e, e, e, e, cases[i].last_end);

		memcpy(bytes + n, "\n\r\n", 3);
		CHECK(read_bytes(&seen, bytes, n + 3) == 0);
		CHECK(seen.vertex[0].position[0] == 10 && seen.vertex[0].position[1] == 13);
		CHECK(seen.vertex[0].position[2] == 10 && seen.trailing == 0);
	}
}

/* As Windows, Unix and old Macs write them. */
static void lines_of_text_end_as_those_of_the_header_do(void **state)
{
	static const char *const ends[] = { "\n", "\r\n", "\r" };
	static const char *const lines[] = {
		"ply",
		"format ascii 1.0",
		"element vertex 3",
		"property float x",
		"property float y",
		"property float z",
		"element face 1",
		"property list uchar int vertex_indices",
		"end_header",
		"0 0 1",
		"1 0 2 ",
		"0 1 3",
		"3 0 1 2",
	};
	struct seen seen;
	char text[512];
	(void)state;

	for (size_t i = 0; i < ARRAY_COUNT(ends); i++) {
		size_t size = 0;

		for (size_t k = 0; k < ARRAY_COUNT(lines); k++)
			size += (size_t)snprintf(text + size, sizeof(text) - size, "%s%s", lines[k],
						 ends[i]);
		if (read_text(&seen, text) < 0)
			fail_msg("%zu: %s", i, seen.diagnostics.first.text);
		CHECK(seen.vertex[2].position[2] == 3 && seen.trailing == 0);
		CHECK(corners_are(&seen.triangle[0], 0, 1, 2));
		/* and a fault has its line */
		text[size - strlen(ends[i]) - 1] = 'x';
		CHECK(read_text(&seen, text) == -EBADMSG);
		CHECK(strstr(seen.diagnostics.first.text, ":13: face 0: 'x' is not a number"));
	}
}

/* Each is refused, with words that say where and what. */
static void refuses_what_cannot_be_right(void **state)
{
#define HEAD     "ply\nformat ascii 1.0\n"
#define TRIANGLE HEAD "element vertex 3\n" XYZ "element face 1\n" FACES
	static const struct {
		const char *name, *text, *says;
	} cases[] = {
		{ "empty", "", "empty" },
		{ "no-magic", "solid\n", ":1: not a PLY" },
		{ "version", "ply\nformat ascii 2.0\nend_header\n", ":2:" },
		{ "encoding", "ply\nformat morse 1.0\nend_header\n", ":2: format must be" },
		{ "no-format", "ply\nend_header\n", "no 'format'" },
		{ "type", HEAD "element vertex 1\nproperty quad x\n", ":4: unknown type" },
		{ "count", HEAD "element vertex many\n", ":3: the element's count" },
		{ "negative-count", HEAD "element vertex -1\n", ":3: the element's count" },
		{ "twice", HEAD "element vertex 1\nelement vertex 1\n", ":4: this element" },
		{ "orphan", HEAD "property float x\n", ":3: a property before" },
		{ "no-z",
		  HEAD "element vertex 1\nproperty float x\nproperty float y\nend_header\n1 1\n",
		  "no property z" },
		{ "no-property", HEAD "element vertex 4000000000\nend_header\n", "no property" },
		{ "promise", HEAD "element vertex 4000000000\n" XYZ "end_header\n0 0 0\n",
		  "promises 4000000000" },
		{ "huge", HEAD "element vertex 18446744073709551615\n" XYZ "end_header\n",
		  "promises 18446744073709551615" },
		{ "index", TRIANGLE "0 0 0\n1 0 0\n0 1 0\n3 0 1 3\n", "face 0: names vertex 3" },
		{ "negative-index", TRIANGLE "0 0 0\n1 0 0\n0 1 0\n3 0 1 -1\n", "names vertex -1" },
		{ "fraction", TRIANGLE "0 0 0\n1 0 0\n0 1 0\n3 0 1 1.5\n", "names vertex 1.5" },
		{ "no-count", TRIANGLE "0 0 0\n1 0 0\n0 1 0\n-3 0 1 2\n", "length of its list" },
		{ "short-line", TRIANGLE "0 0 0\n1 0\n0 1 0\n3 0 1 2\n",
		  ":11: vertex 1: its line has fewer" },
		{ "long-line", TRIANGLE "0 0 0\n1 0 0 7\n0 1 0\n3 0 1 2\n",
		  "vertex 1: its line has more" },
		{ "word", TRIANGLE "0 0 0\n1 zero 0\n0 1 0\n3 0 1 2\n", "'zero' is not a number" },
		{ "float-index", HEAD "element face 1\nproperty list uchar float vertex_indices\n",
		  "integer type" },
		{ "ends-in-body", TRIANGLE "0 0 0\n1 0 0\n0 1 0\n9 0 1 2 0\n", "ends here" },
	};
	struct seen seen;
	(void)state;

	for (size_t i = 0; i < ARRAY_COUNT(cases); i++) {
		int rc = read_text(&seen, cases[i].text);

		if (rc != -EBADMSG || !strstr(seen.diagnostics.first.text, cases[i].says) ||
		    strncmp(seen.diagnostics.first.text, "scan.ply", 8) != 0)
			fail_msg("%s: rc %d, '%s'", cases[i].name, rc, seen.diagnostics.first.text);
	}
}

static void says_why_a_scan_has_no_surface(void **state)
{
	struct seen seen;
	(void)state;

	CHECK(read_text(&seen, HEAD "element vertex 1\n" XYZ "end_header\n0 0 0\n") == 0);
	CHECK(seen.summary.points_only && strstr(seen.summary.points_only, "points"));
	CHECK(read_text(&seen, HEAD "bye\nelement vertex 1\n" XYZ "element range_grid 1\n" FACES
				    "0 0 0\n1 0\n") == 0);
	CHECK(strstr(seen.summary.points_only, "range image") && seen.summary.strange_lines == 1);
}

static int see_cell(void *data, uint64_t index, int64_t vertex)
{
	int64_t *cells = data;

	CHECK(index < 6);
	cells[index] = vertex;
	return 0;
}

static int pass_vertex(void *data, uint32_t index, const struct ply_vertex *vertex)
{
	(void)data;
	CHECK(vertex->confidence == (index == 0 ? 0.5f : 0.25f));
	CHECK(vertex->normal[2] == (index == 0 ? 1 : -1));
	return 0;
}

static void reads_range_grids_normals_and_confidence(void **state)
{
	static const char text[] =
		HEAD "obj_info is_mesh 0\nobj_info num_cols 3\nobj_info num_rows 2\n"
		     "element vertex 2\n" XYZ "property float nx\nproperty float ny\n"
		     "property float nz\nproperty float confidence\nelement range_grid 6\n" FACES
		     "0 0 0 0 0 1 0.5\n1 0 0 0 0 -1 0.25\n0\n1 1\n0\n0\n1 0\n0\n";
	static const int64_t expected[6] = { -1, 1, -1, -1, 0, -1 };
	int64_t cells[6];
	const struct ply_visitor visitor = {
		.data = cells, .vertex = pass_vertex, .triangle = see_triangle, .cell = see_cell
	};
	struct diagnostics diagnostics = { 0 };
	int fd = memfd_create("ply", MFD_CLOEXEC);
	struct ply *ply;
	(void)state;

	CHECK(write(fd, text, strlen(text)) > 0 && lseek(fd, 0, SEEK_SET) == 0);
	CHECK(ply_open_fd(&ply, fd, "scan.ply", &diagnostics) == 0);
	CHECK(ply_summary(ply)->grid_columns == 3 && ply_summary(ply)->grid_rows == 2);
	CHECK(ply_summary(ply)->grid_cells == 6 && ply_summary(ply)->face_count == 0);
	CHECK(ply_summary(ply)->has_normal && ply_summary(ply)->has_confidence);
	CHECK(ply_read(ply, &visitor, &diagnostics) == 0);
	CHECK(memcmp(cells, expected, sizeof(cells)) == 0);
	ply_close(ply);
}

static void refills_its_buffer_without_losing_its_place(void **state)
{
	struct seen seen;
	(void)state;

	enum { VERTICES = 40000 }; /* more than the buffer holds */
	static uint8_t bytes[200 + VERTICES * 12];
	size_t n = (size_t)snprintf((char *)bytes, 200,
				    "ply\nformat binary_little_endian 1.0\nelement vertex %d\n" XYZ
				    "end_header\n",
				    VERTICES);

	for (int i = 0; i < VERTICES; i++)
		for (int k = 0; k < 3; k++) {
			float value = (float)(3 * i + k);

			memcpy(bytes + n + 12 * (size_t)i + 4 * (size_t)k, &value, 4);
		}
	CHECK(read_bytes(&seen, bytes, n + VERTICES * 12) == 0);
	CHECK(seen.vertices == VERTICES && seen.vertex[63].position[2] == 191);
}

/* ---- several threads */

enum { GRID_FACES = 150000, GRID_VERTICES = 100000 }; /* several ranges */

/* What each index got last. */
struct grid {
	uint8_t *bytes;
	size_t size;
	double x[GRID_VERTICES];
	struct ply_triangle triangle[GRID_FACES + 64];
	uint64_t triangles;
	struct diagnostics diagnostics;
};

static int keep_vertex(void *data, uint32_t index, const struct ply_vertex *vertex)
{
	struct grid *grid = data;

	grid->x[index] = vertex->position[0];
	return 0;
}

static int keep_triangle(void *data, uint64_t index, const struct ply_triangle *triangle)
{
	struct grid *grid = data;

	if (index >= GRID_FACES + 64)
		return -ERANGE;
	grid->triangle[index] = *triangle;
	return 0;
}

static void put_bytes(struct grid *grid, const void *bytes, size_t size, bool big)
{
	for (size_t i = 0; i < size; i++)
		grid->bytes[grid->size++] = ((const uint8_t *)bytes)[big ? size - 1 - i : i];
}

static uint32_t grid_corner(uint32_t face, uint32_t k)
{
	return (face * 7 + k * 1013) % GRID_VERTICES;
}

/* Faces with texture coordinates and the number of a picture. The face `odd` has odd_corners. */
static void write_grid(struct grid *grid, bool big, uint32_t odd, uint8_t odd_corners)
{
	grid->size = (size_t)snprintf(
		(char *)grid->bytes, 1000,
		"ply\nformat binary_%s_endian 1.0\ncomment TextureFile a.png\nelement vertex %d\n"
		"property uchar stray\nproperty double x\nproperty float y\nproperty float z\n"
		"element face %d\nproperty list uchar uint vertex_indices\n"
		"property list uchar float texcoord\nproperty short texnumber\nend_header\n",
		big ? "big" : "little", GRID_VERTICES, GRID_FACES);
	for (uint32_t i = 0; i < GRID_VERTICES; i++) {
		double x = i + 0.5;

		put_bytes(grid, "!", 1, big);
		put_bytes(grid, &x, 8, big);
		put_bytes(grid, &(float){ 1 }, 4, big);
		put_bytes(grid, &(float){ 2 }, 4, big);
	}
	for (uint32_t face = 0; face < GRID_FACES; face++) {
		uint8_t corners = face == odd ? odd_corners : 3, numbers = (uint8_t)(2 * corners);

		put_bytes(grid, &corners, 1, big);
		for (uint32_t k = 0; k < corners; k++)
			put_bytes(grid, &(uint32_t){ grid_corner(face, k) }, 4, big);
		put_bytes(grid, &numbers, 1, big);
		for (uint32_t k = 0; k < numbers; k++)
			put_bytes(grid, &(float){ (float)(face + k) }, 4, big);
		put_bytes(grid, &(int16_t){ (int16_t)(face % 7) }, 2, big);
	}
}

static int read_grid(struct grid *grid, uint32_t jobs)
{
	const struct ply_visitor visitor = {
		.data = grid, .vertex = keep_vertex, .triangle = keep_triangle, .jobs = jobs
	};
	int fd = memfd_create("ply", MFD_CLOEXEC), rc;
	struct ply *ply;

	CHECK(fd >= 0 && write(fd, grid->bytes, grid->size) == (ssize_t)grid->size &&
	      lseek(fd, 0, SEEK_SET) == 0);
	grid->diagnostics = (struct diagnostics){ 0 };
	CHECK(ply_open_fd(&ply, fd, "grid.ply", &grid->diagnostics) == 0);
	rc = ply_read(ply, &visitor, &grid->diagnostics);
	grid->triangles = ply_triangles(ply);
	ply_close(ply);
	return rc;
}

static void check_grid(const struct grid *grid, uint32_t odd, uint32_t odd_corners)
{
	uint64_t at = 0;

	CHECK(grid->triangles == GRID_FACES + odd_corners - 3);
	for (uint32_t i = 0; i < GRID_VERTICES; i++)
		CHECK(grid->x[i] == i + 0.5);
	for (uint32_t face = 0; face < GRID_FACES; face++)
		for (uint32_t fan = 2; fan < (face == odd ? odd_corners : 3); fan++, at++) {
			const struct ply_triangle *triangle = &grid->triangle[at];

			CHECK(triangle->face == face && triangle->texture == face % 7);
			CHECK(corners_are(triangle, grid_corner(face, 0),
					  grid_corner(face, fan - 1), grid_corner(face, fan)));
			CHECK(triangle->uv[0][1] == (float)(face + 1) &&
			      triangle->uv[2][1] == (float)(face + 2 * fan + 1));
		}
}

/* A face that is no triangle ends what is read in parallel. */
static void any_number_of_threads_delivers_the_same(void **state)
{
	static const struct {
		uint32_t face;
		uint8_t corners;
	} odds[] = { { 0, 3 }, { 0, 5 }, { 70000, 5 }, { 70000, 2 }, { GRID_FACES - 1, 4 } };
	struct grid *grid = calloc(1, sizeof(*grid));
	(void)state;

	CHECK(grid);
	grid->bytes = malloc(1000 + GRID_VERTICES * 17 + GRID_FACES * 40 + 1000);
	CHECK(grid->bytes);
	for (size_t i = 0; i < sizeof(odds) / sizeof(odds[0]); i++)
		for (uint32_t jobs = 0; jobs <= 3; jobs += 3) {
			write_grid(grid, i % 2, odds[i].face, odds[i].corners);
			CHECK(read_grid(grid, jobs) == 0);
			check_grid(grid, odds[i].face, odds[i].corners);
		}
	free(grid->bytes);
	free(grid);
}

static void a_fault_is_told_alike_by_any_number_of_threads(void **state)
{
	struct grid *grid = calloc(1, sizeof(*grid));
	char told[DIAGNOSTIC_BYTES];
	(void)state;

	CHECK(grid);
	grid->bytes = malloc(1000 + GRID_VERTICES * 17 + GRID_FACES * 40 + 1000);
	CHECK(grid->bytes);
	write_grid(grid, false, 0, 3);
	memset(grid->bytes + grid->size - 40 * 20000 + 1, 0xff, 4); /* the first corner of a face */
	CHECK(read_grid(grid, 0) == -EBADMSG &&
	      strstr(grid->diagnostics.first.text, "face 130000 (at byte "));
	snprintf(told, sizeof(told), "%s", grid->diagnostics.first.text);
	CHECK(read_grid(grid, 3) == -EBADMSG && strcmp(told, grid->diagnostics.first.text) == 0);
	free(grid->bytes);
	free(grid);
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(reads_ascii_and_fans_polygons),
		cmocka_unit_test(reads_both_byte_orders_any_type_and_skips_strangers),
		cmocka_unit_test(refuses_every_truncation),
		cmocka_unit_test(strips_turn_every_other_triangle_and_start_anew),
		cmocka_unit_test(alpha_is_open_sky_only_by_our_comment),
		cmocka_unit_test(reads_places_in_pictures),
		cmocka_unit_test(ends_of_header_lines_do_not_eat_data),
		cmocka_unit_test(lines_of_text_end_as_those_of_the_header_do),
		cmocka_unit_test(refuses_what_cannot_be_right),
		cmocka_unit_test(says_why_a_scan_has_no_surface),
		cmocka_unit_test(reads_range_grids_normals_and_confidence),
		cmocka_unit_test(refills_its_buffer_without_losing_its_place),
		cmocka_unit_test(any_number_of_threads_delivers_the_same),
		cmocka_unit_test(a_fault_is_told_alike_by_any_number_of_threads),
	};

	return cmocka_run_group_tests(tests, NULL, NULL);
}
