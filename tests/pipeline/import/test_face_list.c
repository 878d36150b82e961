/* Lists of faces as people and tools write them: what they mean, and where they are wrong. */
#include "pipeline/import/face_list.h"

#include <errno.h>
#include <stdlib.h>
#include <string.h>

#include "tests/check.h"
#include "tests/pipeline/import/scan_text.h"

static struct face_list list;
static struct diagnostics diagnostics;

static int read_text(const char *text)
{
	char path[256];
	int rc;

	scan_write(path, "lintel.faces", text, strlen(text));
	diagnostics = (struct diagnostics){ 0 };
	rc = face_list_read(&list, path, "lintel.faces", 100, &diagnostics);
	scan_remove(path);
	return rc;
}

static void numbers_ranges_and_comments_are_read(void **state)
{
	(void)state;
	CHECK(read_text("# the lintel\n17 20-31\n\n99 # its corner\r\n0") == 0);
	CHECK(list.count == 4);
	CHECK(list.ranges[0].first == 0 && list.ranges[0].last == 0);
	CHECK(list.ranges[2].first == 20 && list.ranges[2].last == 31);
	CHECK(list.ranges[3].first == 99 && list.ranges[3].last == 99);
	face_list_finish(&list);
}

static void what_is_named_twice_is_meant_once(void **state)
{
	(void)state;
	CHECK(read_text("30-40 5 6 35-50 7-8 5") == 0);
	CHECK(list.count == 2);
	CHECK(list.ranges[0].first == 5 && list.ranges[0].last == 8);
	CHECK(list.ranges[1].first == 30 && list.ranges[1].last == 50);
	face_list_finish(&list);
}

static void a_fault_names_file_line_and_cure(void **state)
{
	static const struct {
		const char *text, *says;
	} cases[] = {
		{ "", "lintel.faces: names no face" },
		{ "# nothing\n", "names no face" },
		{ "1\n2\nx\n3", "lintel.faces:3: 'x' is not a face" },
		{ "1\n100", "lintel.faces:2: face 100 is not in the scan, which has 100" },
		{ "99999999999999999999999", "is not in the scan" },
		{ "\n9-4", "lintel.faces:2: 9-4 runs backwards" },
		{ "1,2", "put spaces between faces" },
		{ "3-", "is not a face" },
		{ "-3", "is not a face" },
	};

	(void)state;
	for (size_t i = 0; i < ARRAY_COUNT(cases); i++) {
		CHECK(read_text(cases[i].text) == -EINVAL);
		if (!strstr(diagnostics.first.text, cases[i].says))
			fail_msg("\"%s\" says: %s", cases[i].text, diagnostics.first.text);
		CHECK(list.ranges == NULL);
	}
}

static void a_file_that_is_not_there_is_named(void **state)
{
	(void)state;
	diagnostics = (struct diagnostics){ 0 };
	CHECK(face_list_read(&list, "/nonexistent/a.faces", "a.faces", 100, &diagnostics) ==
	      -ENOENT);
	CHECK(strstr(diagnostics.first.text, "a.faces: ") != NULL);
}

/* Faces are of one scan; a polygon's triangles all come from its one face. */
static void faces_become_the_triangles_of_their_scan(void **state)
{
	uint32_t faces[7] = { 0, 1, 1, MESH_NO_FACE, 0, 1, 2 }, *triangles, count;
	struct mesh mesh = { .triangle_count = 7, .faces = faces, .scan_count = 2 };

	(void)state;
	mesh.scans[0] = (struct mesh_scan){ 4, 2 };
	mesh.scans[1] = (struct mesh_scan){ 3, 3 };
	CHECK(read_text("1") == 0);
	CHECK(face_list_triangles(&triangles, &count, &list, &mesh, 0) == 0);
	CHECK(count == 2 && triangles[0] == 1 && triangles[1] == 2);
	free(triangles);
	CHECK(face_list_triangles(&triangles, &count, &list, &mesh, 1) == 0);
	CHECK(count == 1 && triangles[0] == 5);
	free(triangles);
	mesh.faces = NULL;
	CHECK(face_list_triangles(&triangles, &count, &list, &mesh, 1) == 0 && count == 0);
	free(triangles);
	face_list_finish(&list);
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(numbers_ranges_and_comments_are_read),
		cmocka_unit_test(what_is_named_twice_is_meant_once),
		cmocka_unit_test(a_fault_names_file_line_and_cure),
		cmocka_unit_test(a_file_that_is_not_there_is_named),
		cmocka_unit_test(faces_become_the_triangles_of_their_scan),
	};

	return cmocka_run_group_tests(tests, NULL, NULL);
}
