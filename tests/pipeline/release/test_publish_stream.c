/* What a release may have beside its patches: the streaming mesh, and where an eye may be. */
#include "pipeline/release/publish_stream.h"

#include <errno.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "format/stream_page.h"
#include "geometry/solid_space.h"
#include "geometry/tour_path.h"
#include "geometry/vec.h"
#include "pipeline/release/publish_solid.h"
#include "pipeline/release/verify.h"
#include "tests/pipeline/release/tiny_fixture.h"

static struct verify_report verified;

enum { SIDE = 41, PLACES = SIDE * SIDE, TILES = 2 * (SIDE - 1) * (SIDE - 1) };

/* A sheet of hills; two groups of one patch each, of which the second is twice as fine. */
static void add_sheet(struct object_store *objects, struct page_child *out, int step)
{
	static struct patch_vertex vertices[PLACES];
	static uint16_t indices[3 * TILES];
	const int side = (SIDE - 1) / step + 1;
	struct patch_mesh mesh = { .vertices = vertices, .indices = indices };
	struct buffer object;

	memset(vertices, 0, sizeof(vertices));
	for (int i = 0; i < side * side; i++) {
		int x = i % side * step, y = i / side * step;

		vertices[i].position[0] = 1000 * x;
		vertices[i].position[1] = 1000 * y;
		vertices[i].position[2] = (int32_t)(3000 + 2000 * sin(x / 4.0) * cos(y / 5.0));
		vertices[i].colour[0] = (uint8_t)(x * 6);
	}
	mesh.vertex_count = (uint32_t)(side * side);
	for (int y = 0; y + 1 < side; y++)
		for (int x = 0; x + 1 < side; x++) {
			const int a = y * side + x;
			const int corners[6] = {
				a, a + 1, a + side, a + 1, a + side + 1, a + side
			};

			for (int c = 0; c < 6; c++)
				indices[3 * mesh.triangle_count + (uint32_t)c] =
					(uint16_t)corners[c];
			mesh.triangle_count += 2;
		}
	buffer_init(&object, 1 << 20);
	CHECK(patch_group_encode(&object, &mesh, 1) == 0);
	CHECK(object_store_add(objects, buffer_bytes(&object), out) == 0);
	buffer_finish(&object);
}

static void add_hierarchy(struct object_store *objects, struct page_child *out)
{
	struct hierarchy_group groups[2] = {
		{ .first_patch = 0, .patch_count = 1, .error_m = INFINITY, .radius_m = 90 },
		{ .first_patch = 1, .patch_count = 1, .error_m = 0.5f, .radius_m = 80 }
	};
	struct hierarchy_patch patches[2] = {
		{ .group = 0, .finer = 1, .triangle_count = TILES / 4, .vertex_count = 21 * 21 },
		{ .group = 1,
		  .finer = HIERARCHY_NONE,
		  .triangle_count = TILES,
		  .vertex_count = PLACES }
	};
	const struct hierarchy hierarchy = { 2, 2, groups, patches };
	struct page_child children[2];
	struct page page = { .kind = PAGE_HIERARCHY, .child_count = 2, .children = children };
	struct buffer payload;

	for (int i = 0; i < 2; i++) {
		patches[i].radius_m = 70;
		patches[i].cone_axis[2] = 1;
		patches[i].cone_cos = -1;
		add_sheet(objects, &children[i], 2 - i);
	}
	buffer_init(&payload, 1 << 20);
	CHECK(hierarchy_encode(&payload, &hierarchy) == 0);
	page.payload = buffer_bytes(&payload);
	CHECK(object_store_add_page(objects, &page, out) == 0);
	buffer_finish(&payload);
}

static void read_page(struct object_store *objects, struct hash hash, struct page *page,
		      struct buffer *bytes)
{
	buffer_init(bytes, 1 << 22);
	CHECK(object_store_read(objects, hash, bytes) == 0);
	CHECK(page_decode(page, buffer_bytes(bytes)) == 0);
}

static void the_base_and_the_blocks_are_the_cut(void **state)
{
	struct object_store *objects;
	struct page_child hierarchy, child;
	struct stream_decoder *decoder;
	struct buffer bytes, stream;
	struct stream_page payload;
	struct stream_cut cut;
	struct page page;

	(void)state;
	CHECK(object_store_create(&objects) == 0);
	add_hierarchy(objects, &hierarchy);
	CHECK(publish_stream(objects, &tiny.root.lattice, &hierarchy, &child) == 1);
	CHECK(child.is_page && child.size < 20000);
	CHECK(stream_cut_read(&cut, objects, &tiny.root.lattice, &hierarchy, 20000) == 0);
	CHECK(cut.group_count == 2 && cut.vertex_count == PLACES && cut.triangle_count == TILES);
	read_page(objects, child.hash, &page, &bytes);
	CHECK(page.kind == PAGE_STREAM && page.child_count > 0);
	CHECK(stream_page_decode(&payload, page.payload, page.child_count) == 0);
	CHECK(payload.group_count == 2);
	CHECK(stream_page_error_m(&payload, 0) > 0);
	CHECK(stream_page_error_m(&payload, page.child_count) == 0);
	buffer_init(&stream, 1 << 22);
	buffer_put(&stream, payload.start.data, payload.start.size);
	CHECK(stream_decoder_create(&decoder) == 0);
	CHECK(stream_decoder_advance(decoder, buffer_bytes(&stream)) == 0);
	CHECK(stream_decoder_mesh(decoder)->vertex_count <= stream_publish_options.base_vertices);
	for (uint32_t i = 0; i < page.child_count; i++) {
		uint32_t before = stream_decoder_records(decoder);

		CHECK(object_store_read(objects, page.children[i].hash, &stream) == 0);
		CHECK(stream_decoder_advance(decoder, buffer_bytes(&stream)) == 0);
		CHECK(stream_decoder_records(decoder) > before);
	}
	CHECK(stream_decoder_complete(decoder));
	CHECK(stream_decoder_mesh(decoder)->triangle_count == TILES);
	stream_decoder_destroy(decoder);
	buffer_finish(&stream);
	page_finish(&page);
	buffer_finish(&bytes);
	stream_cut_finish(&cut);
	/* Less room: the coarse group alone. */
	CHECK(stream_cut_read(&cut, objects, &tiny.root.lattice, &hierarchy, TILES / 2) == 0);
	CHECK(cut.group_count == 1 && cut.triangle_count == TILES / 4);
	stream_cut_finish(&cut);
	object_store_destroy(objects);
}

/* ---- where an eye may be */

static float height_m(const struct root_page *root, const float point_m[3])
{
	const double x = ((double)point_m[0] - root->lattice.origin_m[0]) / root->lattice.step_m;
	const double y = ((double)point_m[1] - root->lattice.origin_m[1]) / root->lattice.step_m;

	return (float)(root->lattice.origin_m[2] +
		       root->lattice.step_m * (3000 + 2000 * sin(x / 4000) * cos(y / 5000)));
}

/* The root page of the hills alone. */
static struct root_page hills(void)
{
	const int32_t low[3] = { 0, 0, 1000 }, high[3] = { 40000, 40000, 5000 };
	struct root_page root = tiny.root;
	double low_m[3], high_m[3];

	lattice_metres(low_m, &root.lattice, low);
	lattice_metres(high_m, &root.lattice, high);
	for (int axis = 0; axis < 3; axis++) {
		root.box_min_m[axis] = (float)low_m[axis];
		root.box_max_m[axis] = (float)high_m[axis];
		root.start_eye_m[axis] = (float)high_m[axis];
	}
	return root;
}

static void an_eye_stays_above_the_hills(void **state)
{
	const struct root_page root = hills();
	const float room_m = tour_path_clearance_m(vec_distance(root.box_min_m, root.box_max_m));
	struct object_store *objects;
	struct page_child hierarchy, child;
	struct buffer object;
	struct solid solid;

	(void)state;
	CHECK(object_store_create(&objects) == 0);
	add_hierarchy(objects, &hierarchy);
	CHECK(publish_solid(objects, &root, &hierarchy, NULL, &child) == 1);
	CHECK(!child.is_page);
	CHECK(child.size <= SOLID_BYTES_MOST);
	buffer_init(&object, OBJECT_BYTES_MAX);
	CHECK(object_store_read(objects, child.hash, &object) == 0);
	CHECK(solid_decode(&solid, buffer_bytes(&object)) == 0);
	CHECK(solid.room_m == room_m && solid.cell_m >= room_m / 2);
	for (int i = 0; i < 50 * 50; i++) {
		float point[3] = { 0 };
		float ground;

		vec_mix(point, root.box_min_m, root.box_max_m, (float)(i % 50 + 1) / 52);
		point[1] = root.box_min_m[1] +
			   (root.box_max_m[1] - root.box_min_m[1]) * (float)(i / 50 + 1) / 52;
		ground = height_m(&root, point);
		point[2] = ground + 0.7f * room_m;
		CHECK(!solid_is_free(&solid, point));
		point[2] = ground + 5 * room_m;
		CHECK(solid_is_free(&solid, point));
	}
	solid_finish(&solid);
	buffer_finish(&object);
	object_store_destroy(objects);
}

/* ---- in a release */

static bool spoil_solid;

static void add_solid(struct object_store *objects, const struct root_page *root,
		      const struct page_child *hierarchy, struct page_child *out)
{
	static uint8_t copy[1 << 16]; /* it is made once, and one byte longer is damaged */
	static size_t size;
	struct buffer object;

	if (size == 0) {
		CHECK(publish_solid(objects, root, hierarchy, NULL, out) == 1);
		buffer_init(&object, OBJECT_BYTES_MAX);
		CHECK(object_store_read(objects, out->hash, &object) == 0);
		size = object.size;
		CHECK(size < sizeof(copy));
		memcpy(copy, object.data, size);
		buffer_finish(&object);
	}
	CHECK(object_store_add(objects, (struct bytes){ copy, size + spoil_solid }, out) == 0);
}

/* Publishes with a stream page that `change` (may be NULL) has altered, and verifies. */
static int publish_and_verify(void (*change)(struct object_store *, struct page *))
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
	struct root_page root = hills();
	struct publish_report report;
	struct info_built built;
	struct object_store *objects;
	int rc;

	root.published_triangles = TILES + TILES / 4;
	root.source_triangles = 10 * TILES;
	root.has_stream = root.has_solid = 1;
	CHECK(object_store_create(&objects) == 0);
	add_hierarchy(objects, &children[ROOT_CHILD_HIERARCHY]);
	CHECK(tiny_publish_samples(&tiny, objects, &children[ROOT_CHILD_SAMPLES]) == 0);
	CHECK(info_build(&built, &info) == 0);
	CHECK(publish_info(objects, &built, tiny.content, &children[ROOT_CHILD_INFO]) == 0);
	CHECK(publish_stream(objects, &root.lattice, &children[ROOT_CHILD_HIERARCHY],
			     &children[ROOT_CHILD_COUNT]) == 1);
	add_solid(objects, &root, &children[ROOT_CHILD_HIERARCHY], &children[ROOT_CHILD_COUNT + 1]);
	if (change) {
		struct buffer bytes;
		struct page page;

		read_page(objects, children[ROOT_CHILD_COUNT].hash, &page, &bytes);
		change(objects, &page);
		CHECK(object_store_add_page(objects, &page, &children[ROOT_CHILD_COUNT]) == 0);
		page_finish(&page);
		buffer_finish(&bytes);
	}
	CHECK(publish_parts(&report, &target, objects, &root, children, ROOT_CHILD_COUNT + 2) == 0);
	info_built_finish(&built);
	object_store_destroy(objects);
	CHECK(release_reader_create(&verify.reader, &options) == 0);
	rc = verify_release(&verified, &verify);
	release_reader_destroy(verify.reader);
	return rc;
}

static void a_release_with_both_is_whole(void **state)
{
	(void)state;
	CHECK(publish_and_verify(NULL) == 0);
	CHECK(verified.pages[PAGE_STREAM].count == 1 && verified.stream_blocks.count > 0);
	CHECK(verified.root.has_stream == 1 && verified.root.has_solid == 1);
	CHECK(verified.solid.count == 1);
}

static void drop_last(struct object_store *objects, struct page *page)
{
	static uint8_t copy[1 << 16];
	const size_t errors = 4 * (size_t)page->child_count;

	(void)objects;
	/* Without the error of the block that goes. */
	CHECK(page->payload.size <= sizeof(copy));
	memcpy(copy, page->payload.data, 4 + errors);
	memcpy(copy + 4 + errors, page->payload.data + 8 + errors, page->payload.size - 8 - errors);
	page->payload = (struct bytes){ copy, page->payload.size - 4 };
	page->child_count--;
}

static void damage_block(struct object_store *objects, struct page *page)
{
	struct buffer block;

	buffer_init(&block, 1 << 20);
	CHECK(object_store_read(objects, page->children[0].hash, &block) == 0);
	block.data[block.size / 2] ^= 1;
	CHECK(object_store_add(objects, buffer_bytes(&block), &page->children[0]) == 0);
	buffer_finish(&block);
}

static void cut_base(struct object_store *objects, struct page *page)
{
	(void)objects;
	page->payload.size -= 1;
}

static void name_more_groups(struct object_store *objects, struct page *page)
{
	static uint8_t copy[1 << 16];

	(void)objects;
	memcpy(copy, page->payload.data, page->payload.size);
	copy[0] = 3;
	page->payload.data = copy;
}

static void faults_of_both_are_found(void **state)
{
	(void)state;
	CHECK(publish_and_verify(drop_last) == -EBADMSG);
	CHECK(strstr(verified.diagnostics.first.text, "lacks blocks"));
	CHECK(publish_and_verify(damage_block) == -EBADMSG);
	CHECK(strstr(verified.diagnostics.first.text, "block of the streaming mesh"));
	CHECK(publish_and_verify(cut_base) == -EBADMSG);
	CHECK(strstr(verified.diagnostics.first.text, "no whole base"));
	CHECK(publish_and_verify(name_more_groups) == -EBADMSG);
	CHECK(strstr(verified.diagnostics.first.text, "more patch groups"));
	spoil_solid = true;
	CHECK(publish_and_verify(NULL) == -EBADMSG);
	CHECK(strstr(verified.diagnostics.first.text, "where an eye may be"));
	spoil_solid = false;
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test_setup_teardown(the_base_and_the_blocks_are_the_cut, set_up,
						tear_down),
		cmocka_unit_test_setup_teardown(a_release_with_both_is_whole, set_up, tear_down),
		cmocka_unit_test_setup_teardown(an_eye_stays_above_the_hills, set_up, tear_down),
		cmocka_unit_test_setup_teardown(faults_of_both_are_found, set_up, tear_down),
	};

	return cmocka_run_group_tests(tests, NULL, NULL);
}
