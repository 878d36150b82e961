/* spoiled_release KEYS RELEASE: publishes a correctly signed release with invalid patches into the
 * folder RELEASE. All hashes are right, so only decoding finds the fault. */
#include <stdio.h>

#include "pipeline/content/info_build.h"
#include "pipeline/release/publish_info.h"
#include "pipeline/release/publish_samples.h"
#include "tests/pipeline/release/tiny_release.h"

static void spoiled_hierarchy(struct object_store *objects, struct page_child *out)
{
	static const char *const stones[2] = { "no patch group", "nor this" };
	struct hierarchy_group groups[2] = {
		{ .first_patch = 0, .patch_count = 1, .error_m = INFINITY, .radius_m = 9 },
		{ .first_patch = 1, .patch_count = 1, .error_m = 0.5f, .radius_m = 8 }
	};
	struct hierarchy_patch patches[2] = { { .group = 0, .finer = 1 },
					      { .group = 1, .finer = HIERARCHY_NONE } };
	const struct hierarchy hierarchy = { 2, 2, groups, patches };
	struct page_child children[2];
	struct page page = { .kind = PAGE_HIERARCHY, .child_count = 2, .children = children };
	struct buffer payload;

	for (int i = 0; i < 2; i++) {
		patches[i].triangle_count = 2;
		patches[i].vertex_count = 4;
		patches[i].radius_m = 1;
		patches[i].cone_axis[2] = 1;
		patches[i].cone_cos = 0.5f;
		CHECK(object_store_add(
			      objects,
			      (struct bytes){ (const uint8_t *)stones[i], strlen(stones[i]) },
			      &children[i]) == 0);
	}
	buffer_init(&payload, 1 << 20);
	CHECK(hierarchy_encode(&payload, &hierarchy) == 0);
	page.payload = buffer_bytes(&payload);
	CHECK(object_store_add_page(objects, &page, out) == 0);
	buffer_finish(&payload);
}

int main(int argc, char **argv)
{
	static const char *const languages[] = { "en" };
	struct diagnostics diagnostics = { 0 };
	struct info_build_options info = { .languages = languages,
					   .language_count = 1,
					   .diagnostics = &diagnostics };
	struct page_child children[ROOT_CHILD_COUNT];
	struct publisher_keys keys;
	struct publish_target target = { .keys = &keys, .pack_bytes = 1 << 20 };
	struct publish_report report;
	struct info_built built;
	struct object_store *objects;
	struct tiny tiny;

	if (argc != 3) {
		fputs("usage: spoiled_release KEYS RELEASE\n", stderr);
		return 2;
	}
	tiny_make(&tiny); /* pages and samples that are as they should be */
	CHECK(keys_load(&keys, argv[1]) == 0);
	target.keys_folder = argv[1];
	target.release = argv[2];
	target.comment = "spoiled";
	info.folder = tiny.content;
	CHECK(object_store_create(&objects) == 0);
	spoiled_hierarchy(objects, &children[ROOT_CHILD_HIERARCHY]);
	CHECK(tiny_publish_samples(&tiny, objects, &children[ROOT_CHILD_SAMPLES]) == 0);
	CHECK(info_build(&built, &info) == 0);
	CHECK(publish_info(objects, &built, tiny.content, &children[ROOT_CHILD_INFO]) == 0);
	CHECK(publish_parts(&report, &target, objects, &tiny.root, children, ROOT_CHILD_COUNT) ==
	      0);
	info_built_finish(&built);
	object_store_destroy(objects);
	keys_finish(&keys);
	tiny_remove(&tiny);
	return 0;
}
