/* verify looks into labels: that they are of their groups, and of parts that there are. */
#include "pipeline/content/info_build.h"
#include "pipeline/release/publish_info.h"
#include "pipeline/release/publish_samples.h"
#include "pipeline/release/verify.h"

#include <errno.h>

#include "format/label.h"
#include "tests/pipeline/release/tiny_fixture.h"

static struct verify_report verified;

/* All triangles of a patch belong to the part. */
static void add_labels(struct object_store *objects, const char *part, uint32_t triangles,
		       struct page_child *out)
{
	struct label_part parts[1] = { { .area_m2 = 1 } };
	struct label_set sets[2] = { { 0, 0 }, { 0, 1 } };
	uint16_t members[1] = { 0 }, in[8] = { 1, 1, 1, 1, 1, 1, 1, 1 };
	struct label_patch patch = { triangles, in, 0, NULL };
	const struct label_group group = { .part_count = 1,
					   .set_count = 2,
					   .member_count = 1,
					   .patch_count = 1,
					   .parts = parts,
					   .sets = sets,
					   .members = members,
					   .patches = &patch };
	struct buffer object;

	snprintf(parts[0].id, sizeof(parts[0].id), "%s", part);
	buffer_init(&object, 1 << 16);
	CHECK(label_group_encode(&object, &group) == 0);
	CHECK(object_store_add(objects, buffer_bytes(&object), out) == 0);
	buffer_finish(&object);
}

/* The second of the two groups has labels. */
static void add_page(struct object_store *objects, const char *part, uint32_t triangles,
		     uint32_t groups, struct page_child *out)
{
	static const uint32_t child_of_group[9] = { LABEL_NONE, 0,          LABEL_NONE,
						    LABEL_NONE, LABEL_NONE, LABEL_NONE,
						    LABEL_NONE, LABEL_NONE, LABEL_NONE };
	struct page_child labels;
	struct page page = { .kind = PAGE_LABELS, .child_count = 1, .children = &labels };
	struct buffer payload;

	add_labels(objects, part, triangles, &labels);
	buffer_init(&payload, 1 << 16);
	label_page_encode(&payload, child_of_group, groups);
	page.payload = buffer_bytes(&payload);
	CHECK(object_store_add_page(objects, &page, out) == 0);
	buffer_finish(&payload);
}

static int publish_and_verify(const char *part, uint32_t triangles, uint32_t groups)
{
	static const char *const languages[] = { "en" };
	struct diagnostics diagnostics = { 0 };
	const struct info_build_options info = { .folder = tiny.content,
						 .languages = languages,
						 .language_count = 1,
						 .diagnostics = &diagnostics };
	const struct publish_target target = tiny_target(&tiny);
	const struct release_reader_options options = { .place = tiny.release };
	struct verify_options verify = { 0 };
	struct page_child children[ROOT_CHILDREN_MAX];
	struct publish_report report;
	struct info_built built;
	struct object_store *objects;
	int rc;

	CHECK(object_store_create(&objects) == 0);
	tiny_hierarchy(objects, &children[ROOT_CHILD_HIERARCHY]);
	CHECK(tiny_publish_samples(&tiny, objects, &children[ROOT_CHILD_SAMPLES]) == 0);
	CHECK(info_build(&built, &info) == 0);
	CHECK(publish_info(objects, &built, tiny.content, &children[ROOT_CHILD_INFO]) == 0);
	add_page(objects, part, triangles, groups, &children[ROOT_CHILD_LABELS]);
	CHECK(publish_parts(&report, &target, objects, &tiny.root, children,
			    ROOT_CHILD_LABELS + 1) == 0);
	info_built_finish(&built);
	object_store_destroy(objects);
	CHECK(release_reader_create(&verify.reader, &options) == 0);
	rc = verify_release(&verified, &verify);
	release_reader_destroy(verify.reader);
	return rc;
}

static void labels_that_fit_are_counted(void **state)
{
	(void)state;
	CHECK(publish_and_verify("tower", 2, 2) == 0);
	CHECK(verified.labels.count == 1 && verified.labels.bytes > 0);
	CHECK(verified.pages[PAGE_LABELS].count == 1);
}

static void labels_of_other_triangles_are_found(void **state)
{
	(void)state;
	CHECK(publish_and_verify("tower", 3, 2) == -EBADMSG);
	CHECK(strstr(verified.diagnostics.first.text, "another number of triangles"));
}

static void a_part_that_there_is_not_is_found(void **state)
{
	(void)state;
	CHECK(publish_and_verify("gate", 2, 2) == -EBADMSG);
	CHECK(strstr(verified.diagnostics.first.text, "database lacks"));
}

static void a_page_for_another_hierarchy_is_found(void **state)
{
	(void)state;
	CHECK(publish_and_verify("tower", 2, 9) == -EBADMSG);
	CHECK(strstr(verified.diagnostics.first.text, "page"));
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test_setup_teardown(labels_that_fit_are_counted, set_up, tear_down),
		cmocka_unit_test_setup_teardown(labels_of_other_triangles_are_found, set_up,
						tear_down),
		cmocka_unit_test_setup_teardown(a_part_that_there_is_not_is_found, set_up,
						tear_down),
		cmocka_unit_test_setup_teardown(a_page_for_another_hierarchy_is_found, set_up,
						tear_down),
	};

	return cmocka_run_group_tests(tests, NULL, NULL);
}
