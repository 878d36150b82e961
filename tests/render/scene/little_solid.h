/* A little release that says where an eye may be. */
#ifndef GOPURA_TESTS_RENDER_SCENE_LITTLE_SOLID_H
#define GOPURA_TESTS_RENDER_SCENE_LITTLE_SOLID_H

#include "pipeline/release/publish_solid.h"
#include "tests/render/scene/little_stream.h"

/* Gives the release a new root, with an octree. spoiled: it does not decode. */
static inline void little_solid(struct little_release *r, bool spoiled)
{
	struct page_child children[ROOT_CHILDREN_MAX], child;
	struct object_store *objects;
	struct root_page root;
	struct buffer bytes;
	struct page page;

	CHECK(page_decode(&page, little_object_bytes(r, r->root)) == 0);
	CHECK(root_page_decode(&root, page.payload) == 0);
	memcpy(children, page.children, page.child_count * sizeof(*children));
	CHECK(object_store_create(&objects) == 0);
	for (uint32_t i = 0; i < r->object_count; i++)
		CHECK(object_store_add(objects,
				       (struct bytes){ r->objects[i].bytes, r->objects[i].size },
				       NULL) == 0);
	CHECK(publish_solid(objects, &root, &children[ROOT_CHILD_HIERARCHY], NULL, &child) == 1);
	buffer_init(&bytes, OBJECT_BYTES_MAX);
	CHECK(object_store_read(objects, child.hash, &bytes) == 0);
	if (spoiled)
		bytes.data[bytes.size / 2] ^= 1;
	children[page.child_count] = little_add(r, &bytes, false);
	root.has_solid = 1;
	root_page_encode(&bytes, &root);
	child = little_page(r, PAGE_ROOT, children, page.child_count + 1, &bytes);
	r->root = child.hash;
	r->root_bytes = child.size;
	buffer_finish(&bytes);
	page_finish(&page);
	object_store_destroy(objects);
}

#endif
