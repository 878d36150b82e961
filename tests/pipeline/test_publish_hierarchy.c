/* Which groups are published: the coarse ones, within the share, and never one without its base. */
#include <errno.h>
#include <math.h>
#include <string.h>

#include "format/hierarchy.h"
#include "format/page.h"
#include "pipeline/publish_sources.h"
#include "tests/check.h"

enum { GROUPS = 6, PATCHES = 12 };

static struct hierarchy_group groups[GROUPS];
static struct hierarchy_patch patches[PATCHES];
static const struct hierarchy hierarchy = { GROUPS, PATCHES, groups, patches };

/* Two patches a group, 100 triangles each. 1 and 2 refine one patch of group 0 each; 3 refines one
 * of 1 and one of 2; 4 the other of 1; 5 the other of 2 and has the error of 4. */
static int set_up(void **state)
{
	static const uint32_t finer[PATCHES] = { 1,
						 2,
						 3,
						 4,
						 3,
						 5,
						 HIERARCHY_NONE,
						 HIERARCHY_NONE,
						 HIERARCHY_NONE,
						 HIERARCHY_NONE,
						 HIERARCHY_NONE,
						 HIERARCHY_NONE };
	static const float errors[GROUPS] = { INFINITY, 4, 3, 2, 1, 1 };

	(void)state;
	for (uint32_t i = 0; i < PATCHES; i++)
		patches[i] = (struct hierarchy_patch){ .group = i / 2,
						       .finer = finer[i],
						       .triangle_count = 100,
						       .vertex_count = 60,
						       .radius_m = 1,
						       .cone_axis = { 0, 0, 1 },
						       .cone_cos = 0.5f };
	for (uint32_t i = 0; i < GROUPS; i++)
		groups[i] = (struct hierarchy_group){ .first_patch = 2 * i,
						      .patch_count = 2,
						      .error_m = errors[i],
						      .radius_m = 20 - (float)i };
	return 0;
}

static int read_group(void *data, uint32_t group, struct buffer *out)
{
	(void)data;
	buffer_put_u8(out, (uint8_t)group); /* told apart; not decoded here */
	return out->error;
}

static const struct publish_master master = { .hierarchy = &hierarchy,
					      .source_triangles = 10000,
					      .read_group = read_group };

/* Bit g: group g is published. */
static unsigned chosen_with(double share, uint64_t *triangles)
{
	bool chosen[GROUPS];
	unsigned bits = 0;

	CHECK(publish_choose_groups(chosen, &master, share, triangles) == 0);
	for (int i = 0; i < GROUPS; i++)
		bits |= (unsigned)chosen[i] << i;
	return bits;
}

static void the_share_is_never_passed_but_by_the_top(void **state)
{
	uint64_t triangles;

	(void)state;
	CHECK(chosen_with(0.001, &triangles) == 0x01 && triangles == 200);
	CHECK(chosen_with(0.039, &triangles) == 0x01 && triangles == 200);
	CHECK(chosen_with(0.040, &triangles) == 0x03 && triangles == 400);
	CHECK(chosen_with(0.060, &triangles) == 0x07 && triangles == 600);
	CHECK(chosen_with(0.080, &triangles) == 0x0f && triangles == 800);
	CHECK(chosen_with(1.0, &triangles) == 0x3f && triangles == 1200);
}

static void a_group_that_does_not_fit_keeps_out_what_refines_it(void **state)
{
	uint64_t triangles;

	(void)state;
	/* Group 2 is large: 3 and 5 need it, 4 does not and still fits. */
	patches[4].triangle_count = 4000;
	CHECK(chosen_with(0.06, &triangles) == 0x13 && triangles == 600);
}

static void what_is_published_is_a_hierarchy(void **state)
{
	struct object_store *objects;
	struct hierarchy back;
	struct page_child child;
	struct buffer object;
	struct page page;
	uint64_t triangles;

	(void)state;
	CHECK(object_store_create(&objects) == 0);
	patches[2].triangle_count = 3000; /* group 1 stays home, 2 and 5 go */
	CHECK(publish_hierarchy(objects, &master, 0.06, &child, &triangles) == 0);
	CHECK(triangles == 600);
	buffer_init(&object, PAGE_BYTES_MOST);
	CHECK(object_store_read(objects, child.hash, &object) == 0);
	CHECK(page_decode(&page, buffer_bytes(&object)) == 0);
	CHECK(page.kind == PAGE_HIERARCHY && page.child_count == 3);
	CHECK(hierarchy_decode(&back, page.payload) == 0); /* checks every rule */
	CHECK(back.group_count == 3 && back.patch_count == 6);
	CHECK(back.patches[0].finer == HIERARCHY_NONE); /* was 1 */
	CHECK(back.patches[1].finer == 1);              /* was 2 */
	CHECK(back.patches[2].finer == HIERARCHY_NONE); /* was 3 */
	CHECK(back.patches[3].finer == 2);              /* was 5 */
	/* Objects in the same order: group 5's is the byte 5. */
	CHECK(hash_equal(page.children[2].hash, hash_of((struct bytes){ (uint8_t *)"\5", 1 })));
	hierarchy_finish(&back);
	page_finish(&page);
	buffer_finish(&object);
	object_store_destroy(objects);
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test_setup(the_share_is_never_passed_but_by_the_top, set_up),
		cmocka_unit_test_setup(a_group_that_does_not_fit_keeps_out_what_refines_it, set_up),
		cmocka_unit_test_setup(what_is_published_is_a_hierarchy, set_up),
	};

	return cmocka_run_group_tests(tests, NULL, NULL);
}
