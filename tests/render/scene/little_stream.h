/* Adds the streaming mesh of its hierarchy to a little release. */
#ifndef GOPURA_TESTS_RENDER_SCENE_LITTLE_STREAM_H
#define GOPURA_TESTS_RENDER_SCENE_LITTLE_STREAM_H

#include "format/stream_page.h"
#include "pipeline/release/publish_stream.h"
#include "tests/render/scene/little_release.h"

static inline struct bytes little_object_bytes(const struct little_release *r, struct hash hash)
{
	for (uint32_t i = 0; i < r->object_count; i++)
		if (hash_equal(r->objects[i].hash, hash))
			return (struct bytes){ r->objects[i].bytes, r->objects[i].size };
	fail_msg("no such object");
	return (struct bytes){ NULL, 0 };
}

/* Adds the stream of a cut, with a small base, and says that every block improves it. */
static inline struct page_child little_stream_page(struct little_release *r,
						   const struct stream_cut *cut, bool spoiled)
{
	const struct stream_options options = { .base_vertices = 300, .loose = true };
	static struct stream_stats stats;
	struct page_child children[16], child;
	struct buffer stream, block, payload;
	struct bytes start;
	float errors_m[17];
	uint32_t blocks;
	size_t at;

	buffer_init(&stream, OBJECT_BYTES_MAX);
	buffer_init(&block, OBJECT_BYTES_MAX);
	buffer_init(&payload, PAGE_BYTES_MAX);
	CHECK(stream_make(&stream, &stats, cut->vertices, cut->vertex_count,
			  (const uint32_t(*)[3])cut->triangles, cut->triangle_count,
			  &options) == 0);
	blocks = stream_block_count(stats.record_count);
	CHECK(blocks >= 2 && blocks <= 16);
	start = (struct bytes){ stream.data, stream_start_bytes(buffer_bytes(&stream)) };
	at = start.size;
	for (uint32_t i = 0; i < blocks; i++) {
		struct bytes left = { stream.data + at, stream.size - at };

		left.size = stream_block_bytes(left);
		at += left.size;
		buffer_put(&block, left.data, left.size);
		block.data[left.size / 2] ^= spoiled && i == 1 ? 0xff : 0;
		children[i] = little_add(r, &block, false);
	}
	for (uint32_t i = 0; i <= blocks; i++)
		errors_m[i] = (float)(blocks - i) * (float)(blocks - i);
	stream_page_encode(&payload, cut->group_count, errors_m, blocks, start);
	child = little_page(r, PAGE_STREAM, children, blocks, &payload);
	buffer_finish(&stream);
	buffer_finish(&block);
	buffer_finish(&payload);
	return child;
}

/* Gives the release a new root, with a stream. spoiled: its second block does not decode. */
static inline void little_stream(struct little_release *r, bool spoiled)
{
	struct page_child children[ROOT_CHILDREN_MAX], child;
	struct object_store *objects;
	struct stream_cut cut;
	struct root_page root;
	struct buffer payload;
	struct page page;

	CHECK(page_decode(&page, little_object_bytes(r, r->root)) == 0);
	CHECK(root_page_decode(&root, page.payload) == 0);
	memcpy(children, page.children, page.child_count * sizeof(*children));
	CHECK(object_store_create(&objects) == 0);
	for (uint32_t i = 0; i < r->object_count; i++)
		CHECK(object_store_add(objects,
				       (struct bytes){ r->objects[i].bytes, r->objects[i].size },
				       NULL) == 0);
	CHECK(stream_cut_read(&cut, objects, &root.lattice, &children[ROOT_CHILD_HIERARCHY],
			      UINT32_MAX) == 0);
	children[page.child_count] = little_stream_page(r, &cut, spoiled);
	root.has_stream = 1;
	buffer_init(&payload, PAGE_BYTES_MAX);
	root_page_encode(&payload, &root);
	child = little_page(r, PAGE_ROOT, children, page.child_count + 1, &payload);
	r->root = child.hash;
	r->root_bytes = child.size;
	buffer_finish(&payload);
	stream_cut_finish(&cut);
	page_finish(&page);
	object_store_destroy(objects);
}

#endif
