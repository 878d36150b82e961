#include "format/root_page.h"

#include <errno.h>
#include <math.h>
#include <string.h>

#include "tests/check.h"
#include "tests/format/bend.h"

static struct root_page sample_root(void)
{
	return (struct root_page){
		.name = "Prasat \xe1\x9e\x94",
		.lattice = { .origin_m = { -10, -20, 0.5 }, .step_m = 0.001 },
		.box_min_m = { -10, -20, 0 },
		.box_max_m = { 10, 20, 30 },
		.start_eye_m = { 50, 0, 10 },
		.start_target_m = { 0, 0, 8 },
		.sun = { 0.6f, 0, 0.8f },
		.lit = 1,
		.background = { 1, 2, 255 },
		.source_triangles = 12345678901234ull,
		.published_triangles = 99,
	};
}

static int decode(struct bytes bytes, void *data)
{
	struct root_page root;
	int rc = root_page_decode(&root, bytes);

	(void)data;
	CHECK(rc == 0 || rc == -EBADMSG);
	return rc;
}

static int decode_changed(const struct root_page *root)
{
	struct buffer buffer;
	int rc;

	buffer_init(&buffer, 4096);
	root_page_encode(&buffer, root);
	rc = decode(buffer_bytes(&buffer), NULL);
	buffer_finish(&buffer);
	return rc;
}

static void gives_back_every_field(void **state)
{
	struct root_page root = sample_root(), back;
	struct buffer buffer;

	(void)state;
	buffer_init(&buffer, 4096);
	root_page_encode(&buffer, &root);
	CHECK(root_page_decode(&back, buffer_bytes(&buffer)) == 0);
	CHECK(strcmp(back.name, root.name) == 0);
	CHECK(back.lattice.origin_m[1] == -20 && back.lattice.step_m == 0.001);
	CHECK(back.lattice.fine_bits == 0);
	CHECK(back.box_min_m[1] == -20 && back.box_max_m[2] == 30);
	CHECK(back.start_eye_m[0] == 50 && back.start_target_m[2] == 8);
	CHECK(back.sun[0] == 0.6f && back.lit == 1 && back.background[2] == 255);
	CHECK(back.source_triangles == root.source_triangles && back.published_triangles == 99);
	refuses_every_truncation(decode, NULL, buffer_bytes(&buffer));
	count_accepted_flips(decode, NULL, buffer_bytes(&buffer));
	buffer_put_u8(&buffer, 0);
	CHECK(decode(buffer_bytes(&buffer), NULL) == -EBADMSG);
	buffer_finish(&buffer);
}

/* Releases from before there were streams and scenery end before the byte that says so. */
static void says_whether_there_is_a_stream_or_scenery(void **state)
{
	struct root_page root = sample_root(), back;
	struct buffer buffer;

	(void)state;
	root.has_stream = 1;
	buffer_init(&buffer, 4096);
	root_page_encode(&buffer, &root);
	CHECK(root_page_decode(&back, buffer_bytes(&buffer)) == 0 && back.has_stream == 1);
	CHECK(root_page_decode(&back, (struct bytes){ buffer.data, buffer.size - 1 }) == 0);
	CHECK(back.has_stream == 0);
	buffer.data[buffer.size - 1] = 2; /* scenery alone */
	CHECK(root_page_decode(&back, buffer_bytes(&buffer)) == 0);
	CHECK(back.has_stream == 0 && back.has_scenery == 1);
	CHECK(root_page_plain(&back, 5) == 4);
	buffer.data[buffer.size - 1] = 7; /* an octree too */
	CHECK(root_page_decode(&back, buffer_bytes(&buffer)) == 0);
	CHECK(back.has_stream == 1 && back.has_scenery == 1 && back.has_solid == 1);
	CHECK(root_page_plain(&back, 7) == 4 && root_page_scenery(&back, 7) == 5);
	buffer.data[buffer.size - 1] = 8 * ROOT_CUT_MAX + 2; /* and what a section shows */
	CHECK(root_page_decode(&back, buffer_bytes(&buffer)) == 0);
	CHECK(back.cut == ROOT_CUT_MAX && back.has_scenery == 1 && back.has_stream == 0);
	buffer.data[buffer.size - 1] = 8 * ROOT_CUT_MAX + 8; /* a substance that there is not */
	CHECK(decode(buffer_bytes(&buffer), NULL) == -EBADMSG);
	buffer.data[buffer.size - 1] = 0;
	CHECK(decode(buffer_bytes(&buffer), NULL) == -EBADMSG);
	buffer.data[buffer.size - 1] = 1;
	buffer_put_u8(&buffer, 1);
	CHECK(decode(buffer_bytes(&buffer), NULL) == -EBADMSG);
	buffer_finish(&buffer);
}

static void refuses_values_that_would_break_a_picture(void **state)
{
	struct root_page root;

	(void)state;
	root = sample_root();
	root.lattice.step_m = 0;
	CHECK(decode_changed(&root) == -EBADMSG);
	root = sample_root();
	root.lattice.origin_m[2] = NAN;
	CHECK(decode_changed(&root) == -EBADMSG);
	root = sample_root();
	root.box_max_m[0] = -11;
	CHECK(decode_changed(&root) == -EBADMSG);
	root = sample_root();
	root.start_eye_m[1] = INFINITY;
	CHECK(decode_changed(&root) == -EBADMSG);
	root = sample_root();
	root.sun[0] = 0;
	CHECK(decode_changed(&root) == -EBADMSG);
	root = sample_root();
	root.lit = 2;
	CHECK(decode_changed(&root) == -EBADMSG);
	root = sample_root();
	root.name[0] = '\0';
	CHECK(decode_changed(&root) == -EBADMSG);
	root = sample_root();
	root.source_triangles = 0;
	CHECK(decode_changed(&root) == -EBADMSG);
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(gives_back_every_field),
		cmocka_unit_test(says_whether_there_is_a_stream_or_scenery),
		cmocka_unit_test(refuses_values_that_would_break_a_picture),
	};

	return cmocka_run_group_tests(tests, NULL, NULL);
}
