/* A content folder as small as one can be, with everything a release has: two patch groups, samples
 * in two bricks, a part with a page and a picture. */
#ifndef GOPURA_TESTS_PIPELINE_RELEASE_TINY_RELEASE_H
#define GOPURA_TESTS_PIPELINE_RELEASE_TINY_RELEASE_H

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

#include "format/hierarchy.h"
#include "format/patch.h"
#include "format/picture.h"
#include "format/tile.h"
#include "pipeline/release/publish.h"
#include "pipeline/release/publish_info.h"
#include "pipeline/release/publish_samples.h"
#include "pipeline/samples/sample_store.h"
#include "tests/check.h"

struct tiny {
	char folder[64];   /* a temporary one that holds all */
	char content[80];  /* folder/content */
	char release[80];  /* folder/release */
	char keys_at[100]; /* content/keys */
	struct publisher_keys keys;
	struct root_page root;
};

static inline void tiny_write(const struct tiny *tiny, const char *name, struct bytes bytes)
{
	char path[200];

	snprintf(path, sizeof(path), "%s/%s", tiny->content, name);
	CHECK(bytes_write_file(bytes, path) == 0);
}

static inline void tiny_text(const struct tiny *tiny, const char *name, const char *text)
{
	tiny_write(tiny, name, (struct bytes){ (const uint8_t *)text, strlen(text) });
}

static inline void tiny_picture(const struct tiny *tiny)
{
	uint8_t rgba[8 * 6 * 4];
	struct picture picture = { 8, 6, rgba };
	struct buffer png;

	memset(rgba, 120, sizeof(rgba));
	buffer_init(&png, 1 << 20);
	CHECK(picture_encode_png(&png, &picture) == 0);
	tiny_write(tiny, "pictures/a.png", buffer_bytes(&png));
	buffer_finish(&png);
}

static inline void tiny_parts(const struct tiny *tiny, const char *title)
{
	char text[400];

	snprintf(text, sizeof(text),
		 "{\"parts\":[{\"id\":\"tower\",\"region\":{\"kind\":\"sphere\",\"centre\":[0,0,1],"
		 "\"radius\":1},\"anchor\":[0,0,1],\"title\":{\"en\":\"%s\"},"
		 "\"thumbnail\":\"pictures/a.png\"}]}",
		 title);
	tiny_text(tiny, "parts.json", text);
}

/* Grey tiles; shade tells them apart. */
static inline void tiny_samples(const struct tiny *tiny, uint8_t shade, uint8_t key)
{
	static uint8_t rgb[SAMPLE_IMAGE_PX * SAMPLE_IMAGE_PX * 3];
	const struct sample_grid grid = { .spacing_m = { 1, 1, 1 },
					  .count = { 5, 1, 1 },
					  .level_count = 2 };
	static const uint16_t tiles[] = { 0, 3 };
	struct buffer encoded[2];

	CHECK(samples_store_begin(tiny->content, &grid, (struct hash){ { key } }) == 0);
	for (uint32_t x = 0; x < 5; x++) {
		struct bytes objects[2];
		struct sample_face faces[2];

		for (int i = 0; i < 2; i++) {
			/* Only the last point changes with shade. */
			memset(rgb, (x == 4 ? shade : 10 * (int)x) + i, sizeof(rgb));
			buffer_init(&encoded[i], 1 << 20);
			CHECK(tile_encode(&encoded[i], rgb, SAMPLE_IMAGE_PX, 75, TILE_THOROUGH) ==
			      0);
			objects[i] = buffer_bytes(&encoded[i]);
		}
		faces[0] = (struct sample_face){ .face = 1,
						 .level_count = 2,
						 .coverage = 1,
						 .near_m = 1,
						 .far_m = 2,
						 .tile_count = 2,
						 .tiles = tiles,
						 .objects = objects };
		faces[1] = faces[0];
		faces[1].face = 4;
		faces[1].tile_count = 1;
		CHECK(samples_store_put(tiny->content, (struct hash){ { key } }, &grid,
					SAMPLE_RENDERED, (uint32_t[3]){ x, 0, 0 }, faces, 2) == 0);
		buffer_finish(&encoded[0]);
		buffer_finish(&encoded[1]);
	}
}

static inline int tiny_publish_samples(const struct tiny *tiny, struct object_store *objects,
				       struct page_child *out)
{
	struct samples_store *store;
	int rc = samples_store_open(&store, tiny->content);

	if (rc == 0)
		rc = publish_samples(objects, store, out);
	samples_store_close(store);
	return rc;
}

static inline void tiny_group(struct object_store *objects, struct page_child *out, uint16_t seed)
{
	static const uint16_t indices[6] = { 0, 1, 2, 2, 1, 3 };
	struct patch_vertex vertices[4] = { 0 };
	struct patch_mesh mesh = { .vertex_count = 4,
				   .triangle_count = 2,
				   .vertices = vertices,
				   .indices = (uint16_t *)indices };
	struct buffer object;

	for (uint16_t i = 0; i < 4; i++) {
		vertices[i].position[0] = i % 2 * 1000 + seed;
		vertices[i].position[1] = i / 2 * 1000;
		vertices[i].normal[0] = 1;
	}
	buffer_init(&object, 1 << 20);
	CHECK(patch_group_encode(&object, &mesh, 1) == 0);
	CHECK(object_store_add(objects, buffer_bytes(&object), out) == 0);
	buffer_finish(&object);
}

static inline void tiny_hierarchy(struct object_store *objects, struct page_child *out)
{
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
		tiny_group(objects, &children[i], (uint16_t)i);
	}
	buffer_init(&payload, 1 << 20);
	CHECK(hierarchy_encode(&payload, &hierarchy) == 0);
	page.payload = buffer_bytes(&payload);
	CHECK(object_store_add_page(objects, &page, out) == 0);
	buffer_finish(&payload);
}

static inline void tiny_make(struct tiny *tiny)
{
	static const char *const folders[] = { "", "pages", "pictures" };
	char path[200];

	*tiny = (struct tiny){ .folder = "/tmp/gopura-tiny-XXXXXX" };
	CHECK(mkdtemp(tiny->folder) != NULL);
	snprintf(tiny->content, sizeof(tiny->content), "%s/content", tiny->folder);
	snprintf(tiny->release, sizeof(tiny->release), "%s/release", tiny->folder);
	snprintf(tiny->keys_at, sizeof(tiny->keys_at), "%s/keys", tiny->content);
	for (size_t i = 0; i < ARRAY_COUNT(folders); i++) {
		snprintf(path, sizeof(path), "%s/%s", tiny->content, folders[i]);
		CHECK(mkdir(path, 0755) == 0);
	}
	tiny_picture(tiny);
	tiny_parts(tiny, "Tower");
	tiny_text(tiny, "pages/tower.en.html", "<h1>Tower</h1><p>Stone.</p>");
	tiny_samples(tiny, 200, 1);
	CHECK(keys_make(tiny->keys_at) == 0);
	CHECK(keys_load(&tiny->keys, tiny->keys_at) == 0);
	tiny->root = (struct root_page){ .name = "Tiny",
					 .lattice = { .step_m = 0.001 },
					 .box_max_m = { 1, 1, 1 },
					 .sun = { 0, 0, 1 },
					 .source_triangles = 40,
					 .published_triangles = 4 };
}

static inline void tiny_remove(struct tiny *tiny)
{
	char command[200];

	keys_finish(&tiny->keys);
	snprintf(command, sizeof(command), "rm -rf '%s'", tiny->folder);
	CHECK(system(command) == 0);
}

static inline struct publish_target tiny_target(const struct tiny *tiny)
{
	return (struct publish_target){ .release = tiny->release,
					.keys_folder = tiny->keys_at,
					.keys = &tiny->keys };
}

static inline struct publish_report tiny_publish_as(const struct tiny *tiny,
						    struct publish_target target)
{
	static const char *const languages[] = { "en" };
	struct diagnostics diagnostics = { 0 };
	const struct info_build_options info = { .folder = tiny->content,
						 .languages = languages,
						 .language_count = 1,
						 .diagnostics = &diagnostics };
	struct page_child children[ROOT_CHILD_COUNT];
	struct publish_report report;
	struct info_built built;
	struct object_store *objects;

	target.pack_bytes = 3000; /* several packs even of this */
	CHECK(object_store_create(&objects) == 0);
	tiny_hierarchy(objects, &children[ROOT_CHILD_HIERARCHY]);
	CHECK(tiny_publish_samples(tiny, objects, &children[ROOT_CHILD_SAMPLES]) == 0);
	CHECK(info_build(&built, &info) == 0);
	CHECK(publish_info(objects, &built, tiny->content, &children[ROOT_CHILD_INFO]) == 0);
	CHECK(publish_parts(&report, &target, objects, &tiny->root, children, ROOT_CHILD_COUNT) ==
	      0);
	info_built_finish(&built);
	object_store_destroy(objects);
	return report;
}

static inline struct publish_report tiny_publish(const struct tiny *tiny, const char *comment)
{
	struct publish_target target = tiny_target(tiny);

	target.comment = comment;
	return tiny_publish_as(tiny, target);
}

#endif
