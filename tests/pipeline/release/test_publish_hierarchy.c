/* The page and the objects that the published part of a master becomes. */
#include <errno.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "format/page.h"
#include "format/patch.h"
#include "pipeline/release/publish_hierarchy.h"
#include "tests/check.h"

enum { GROUPS = 6, PATCHES = 12 };

static struct hierarchy_group groups[GROUPS];
static struct hierarchy_patch patches[PATCHES];
static uint64_t places[GROUPS];
static uint32_t sizes[GROUPS];
static float losses_m4[GROUPS];
static struct master master;
static struct object_store *objects;

/* Colours and normals with more digits than are published; a triangle that is a little steep. */
static int put_object(uint32_t group)
{
	struct patch_vertex vertices[3] = {
		{ .position = { (int32_t)group, 9, 7 },
		  .normal = { 127, -127 },
		  .colour = { 0, 255, 100, 255 } },
		{ .position = { 1001, 9, 7 }, .normal = { 1, -2 }, .colour = { 1, 2, 3, 9 } },
		{ .position = { 1001, 907, 20 },
		  .normal = { 2, -1 },
		  .colour = { 252, 253, 254, 0 } },
	};
	uint16_t indices[3] = { 0, 1, 2 };
	struct patch_mesh mesh = { 3, 1, vertices, indices };
	struct buffer object;
	int rc;

	buffer_init(&object, OBJECT_BYTES_MAX);
	rc = patch_group_encode(&object, &mesh, 1);
	places[group] = group == 0 ? 0 : places[group - 1] + sizes[group - 1];
	sizes[group] = (uint32_t)object.size;
	if (rc == 0 && write(master.fd, object.data, object.size) != (ssize_t)object.size)
		rc = -EIO;
	buffer_finish(&object);
	return rc;
}

/* Two patches a group, 100 triangles each. 1 and 2 refine one patch of group 0 each; 3 refines one
 * of 1 and one of 2; 4 the other of 1; 5 the other of 2. The object of group g holds a
 * triangle that begins at x = g; counts are the page's to tell, verify compares them. */
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
	static const float errors[GROUPS] = { INFINITY, 4, 3, 2, 1, 0.5f };
	char path[] = "/tmp/gopura-master-XXXXXX";

	(void)state;
	for (uint32_t i = 0; i < PATCHES; i++)
		patches[i] = (struct hierarchy_patch){ .group = i / 2,
						       .finer = finer[i],
						       .triangle_count = 100,
						       .vertex_count = 60,
						       .radius_m = 1,
						       .cone_axis = { 0, 0, 1 },
						       .cone_cos = 0.9998f };
	for (uint32_t i = 0; i < GROUPS; i++) {
		groups[i] = (struct hierarchy_group){ .first_patch = 2 * i,
						      .patch_count = 2,
						      .error_m = errors[i],
						      .radius_m = 20 - (float)i };
		losses_m4[i] = errors[i];
	}
	master = (struct master){ .lattice = { .step_m = 1 },
				  .source_triangles = 10000,
				  .hierarchy = { GROUPS, PATCHES, groups, patches },
				  .places = places,
				  .sizes = sizes,
				  .losses_m4 = losses_m4,
				  .fd = mkstemp(path) };
	unlink(path);
	for (uint32_t i = 0; i < GROUPS; i++)
		if (put_object(i) < 0)
			return -1;
	return object_store_create(&objects);
}

static int tear_down(void **state)
{
	(void)state;
	object_store_destroy(objects);
	return close(master.fd);
}

/* Publishes, and decodes what came of it. */
static uint64_t publish(double share, struct page *page, struct hierarchy *back)
{
	static struct buffer object;
	struct page_child child;
	struct published_patches published;

	buffer_finish(&object);
	buffer_init(&object, PAGE_BYTES_MAX);
	CHECK(publish_hierarchy(objects, &master, share, &child, &published) == 0);
	CHECK(child.is_page);
	CHECK(object_store_read(objects, child.hash, &object) == 0);
	CHECK(page_decode(page, buffer_bytes(&object)) == 0);
	CHECK(page->kind == PAGE_HIERARCHY);
	for (uint32_t i = 0; i < page->child_count; i++)
		published.bytes -= page->children[i].size;
	CHECK(published.bytes == 0);
	CHECK(hierarchy_decode(back, page->payload) == 0); /* checks every rule */
	CHECK(page->child_count == back->group_count);
	for (uint32_t i = 0; i < page->child_count; i++)
		CHECK(object_store_has(objects, page->children[i].hash));
	return published.triangle_count;
}

static void what_is_published_is_a_hierarchy_within_the_share(void **state)
{
	struct hierarchy back;
	struct page page;

	(void)state;
	for (int percent = 2; percent <= 12; percent++) {
		uint64_t triangles = publish(percent / 100.0, &page, &back), counted = 0;

		CHECK(triangles <= (uint64_t)percent * 100);
		CHECK(triangles >= (uint64_t)percent * 100 - 199 || triangles == 1200);
		for (uint32_t i = 0; i < back.patch_count; i++)
			counted += back.patches[i].triangle_count;
		CHECK(counted == triangles);
		hierarchy_finish(&back);
		page_finish(&page);
	}
}

/* The corners of a published group that holds the triangle of put_object. */
static void read_triangle(struct patch_vertex corners[3], struct hash hash)
{
	struct patch_mesh meshes[GROUP_PATCHES_MAX];
	struct buffer object;
	uint32_t count;

	buffer_init(&object, OBJECT_BYTES_MAX);
	CHECK(object_store_read(objects, hash, &object) == 0);
	CHECK(patch_group_decode(meshes, &count, buffer_bytes(&object)) == 0);
	CHECK(count == 1 && meshes[0].vertex_count == 3);
	for (int i = 0; i < 3; i++)
		corners[i] = meshes[0].vertices[meshes[0].indices[i]];
	patch_mesh_finish(&meshes[0]);
	buffer_finish(&object);
}

static struct patch_vertex read_object(struct hash hash)
{
	struct patch_vertex corners[3];

	read_triangle(corners, hash);
	return corners[0];
}

/* Whether a cone holds the normal of a triangle. */
static bool holds_normal(const struct hierarchy_patch *patch, const struct patch_vertex corners[3])
{
	double u[3], v[3], normal[3], square = 0, along = 0;

	for (int i = 0; i < 3; i++) {
		u[i] = corners[1].position[i] - corners[0].position[i];
		v[i] = corners[2].position[i] - corners[0].position[i];
	}
	for (int i = 0; i < 3; i++) {
		normal[i] = u[(i + 1) % 3] * v[(i + 2) % 3] - u[(i + 2) % 3] * v[(i + 1) % 3];
		square += normal[i] * normal[i];
		along += normal[i] * patch->cone_axis[i];
	}
	return along >= patch->cone_cos * sqrt(square);
}

static void objects_go_with_their_groups(void **state)
{
	struct hierarchy back;
	struct page page;

	(void)state;
	CHECK(publish(1.0, &page, &back) == 1200);
	CHECK(back.group_count == GROUPS);
	for (uint32_t i = 0; i < GROUPS; i++) {
		uint16_t expected = 0;

		for (uint16_t g = 0; g < GROUPS; g++)
			if (groups[g].error_m == back.groups[i].error_m)
				expected = g;
		CHECK(read_object(page.children[i].hash).position[0] == expected);
	}
	hierarchy_finish(&back);
	page_finish(&page);
}

static void colours_are_rounded_and_places_are_not(void **state)
{
	struct patch_vertex vertex;
	struct hierarchy back;
	struct page page;

	(void)state;
	CHECK(publish(0.02, &page, &back) == 200);
	vertex = read_object(page.children[0].hash);
	CHECK(vertex.position[0] == 0 && vertex.position[1] == 9 && vertex.position[2] == 7);
	CHECK(vertex.normal[0] == 127 && vertex.normal[1] == -127);
	CHECK(vertex.colour[0] == 0 && vertex.colour[1] == 255 && vertex.colour[3] == 255);
	CHECK(vertex.colour[2] == 99); /* 12 of 31 */
	hierarchy_finish(&back);
	page_finish(&page);
}

/* Group 0 alone is wrong by 3 m and 4 m: an eighth of 3 m are 37 steps, so positions are multiples
 * of 32, and the spheres hold what moved. With everything, nothing is wrong, and nothing is
 * rounded. */
static void places_are_rounded_as_the_finest_is_wrong(void **state)
{
	struct patch_vertex vertex;
	struct hierarchy back;
	struct page page;

	(void)state;
	master.lattice.step_m = 0.01;
	CHECK(publish(0.02, &page, &back) == 200);
	vertex = read_object(page.children[0].hash);
	CHECK(vertex.position[0] % 32 == 0 && vertex.position[1] % 32 == 0);
	CHECK(back.patches[0].radius_m >= 1 + sqrtf(3) * 0.16f && back.patches[0].radius_m < 1.3f);
	CHECK(back.groups[0].radius_m > 20.27f);
	hierarchy_finish(&back);
	page_finish(&page);
	CHECK(publish(1.0, &page, &back) == 1200);
	vertex = read_object(page.children[0].hash);
	CHECK(vertex.position[1] == 9 && back.patches[0].radius_m == 1);
	hierarchy_finish(&back);
	page_finish(&page);
}

/* Rounding makes the triangle twice as steep. */
static void cones_hold_the_normals_of_what_was_rounded(void **state)
{
	struct patch_vertex corners[3];
	struct hierarchy back;
	struct page page;

	(void)state;
	CHECK(publish(1.0, &page, &back) == 1200);
	read_triangle(corners, page.children[0].hash);
	CHECK(back.patches[0].cone_cos == 0.9998f && holds_normal(&back.patches[0], corners));
	hierarchy_finish(&back);
	page_finish(&page);
	master.lattice.step_m = 0.01;
	CHECK(publish(0.02, &page, &back) == 200);
	read_triangle(corners, page.children[0].hash);
	CHECK(!holds_normal(&patches[0], corners)); /* what the master says is wrong now */
	CHECK(holds_normal(&back.patches[0], corners));
	hierarchy_finish(&back);
	page_finish(&page);
}

/* Group 2 is less wrong than 1 and costs more where it is missing: it goes first. */
static void what_costs_most_goes_first(void **state)
{
	struct hierarchy back;
	struct page page;

	(void)state;
	losses_m4[2] = 2 * losses_m4[1];
	CHECK(publish(0.04, &page, &back) == 400);
	CHECK(back.group_count == 2 && back.groups[1].error_m == groups[2].error_m);
	hierarchy_finish(&back);
	page_finish(&page);
}

static void the_top_is_published_whatever_the_share(void **state)
{
	struct hierarchy back;
	struct page page;

	(void)state;
	CHECK(publish(0.001, &page, &back) == 200);
	CHECK(back.group_count == 1 && back.patches[0].finer == HIERARCHY_NONE);
	hierarchy_finish(&back);
	page_finish(&page);
}

static void a_master_that_was_cut_off_is_found(void **state)
{
	struct page_child child;
	struct published_patches published;

	(void)state;
	CHECK(ftruncate(master.fd, 0) == 0);
	CHECK(publish_hierarchy(objects, &master, 0.1, &child, &published) == -EBADMSG);
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test_setup_teardown(what_is_published_is_a_hierarchy_within_the_share,
						set_up, tear_down),
		cmocka_unit_test_setup_teardown(objects_go_with_their_groups, set_up, tear_down),
		cmocka_unit_test_setup_teardown(colours_are_rounded_and_places_are_not, set_up,
						tear_down),
		cmocka_unit_test_setup_teardown(places_are_rounded_as_the_finest_is_wrong, set_up,
						tear_down),
		cmocka_unit_test_setup_teardown(cones_hold_the_normals_of_what_was_rounded, set_up,
						tear_down),
		cmocka_unit_test_setup_teardown(what_costs_most_goes_first, set_up, tear_down),
		cmocka_unit_test_setup_teardown(the_top_is_published_whatever_the_share, set_up,
						tear_down),
		cmocka_unit_test_setup_teardown(a_master_that_was_cut_off_is_found, set_up,
						tear_down),
	};

	return cmocka_run_group_tests(tests, NULL, NULL);
}
