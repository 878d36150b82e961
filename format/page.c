/* Encodes and decodes the outer form that all pages share: header, child list, payload. */
#include "format/page.h"

#include <assert.h>
#include <errno.h>
#include <stdlib.h>
#include <string.h>

static const uint8_t page_magic[4] = { 'G', 'P', 'a', 'g' };

#define PAGE_VERSION    1
#define CHILD_IS_A_PAGE (1u << 31)

bool page_is(struct bytes object)
{
	return object.size >= PAGE_HEADER_BYTES &&
	       memcmp(object.data, page_magic, sizeof(page_magic)) == 0;
}

void page_encode(struct buffer *out, const struct page *page)
{
	uint64_t size = PAGE_HEADER_BYTES + (uint64_t)page->child_count * PAGE_CHILD_BYTES +
			page->payload.size;

	assert(page->kind >= PAGE_ROOT && page->kind < PAGE_KINDS);
	if (size > PAGE_BYTES_MAX) {
		out->error = out->error ? out->error : -EFBIG;
		return;
	}
	buffer_put(out, page_magic, sizeof(page_magic));
	buffer_put_u16(out, (uint16_t)page->kind);
	buffer_put_u16(out, PAGE_VERSION);
	buffer_put_u32(out, page->child_count);
	buffer_put_u32(out, (uint32_t)page->payload.size);
	for (uint32_t i = 0; i < page->child_count; i++) {
		const struct page_child *child = &page->children[i];

		assert(child->size > 0 && child->size <= OBJECT_BYTES_MAX);
		buffer_put_u32(out, child->size | (child->is_page ? CHILD_IS_A_PAGE : 0));
		buffer_put(out, child->hash.bytes, HASH_BYTES);
	}
	buffer_put(out, page->payload.data, page->payload.size);
}

static bool read_child(struct reader *reader, struct page_child *child)
{
	uint32_t size_and_flag = reader_u32(reader);
	struct bytes hash = reader_bytes(reader, HASH_BYTES);

	if (reader->failed)
		return false;
	memcpy(child->hash.bytes, hash.data, HASH_BYTES);
	child->size = size_and_flag & ~CHILD_IS_A_PAGE;
	child->is_page = (size_and_flag & CHILD_IS_A_PAGE) != 0;
	return child->size > 0 && !hash_is_zero(child->hash) &&
	       child->size <= (child->is_page ? PAGE_BYTES_MAX : OBJECT_BYTES_MAX);
}

static int read_children(struct reader *reader, struct page *page)
{
	/* One element more, so that NULL always means that memory ran out. */
	page->children = calloc((size_t)page->child_count + 1, sizeof(*page->children));
	if (!page->children)
		return -ENOMEM;
	for (uint32_t i = 0; i < page->child_count; i++)
		if (!read_child(reader, &page->children[i]))
			return -EBADMSG;
	return 0;
}

int page_decode(struct page *out, struct bytes object)
{
	struct page page = { 0 };
	struct reader reader;
	struct bytes magic;
	uint32_t payload_bytes;
	uint16_t version;
	int rc = -EBADMSG;

	*out = page;
	if (object.size < PAGE_HEADER_BYTES || object.size > PAGE_BYTES_MAX)
		return rc;
	reader_init(&reader, object);
	magic = reader_bytes(&reader, sizeof(page_magic));
	page.kind = reader_u16(&reader);
	version = reader_u16(&reader);
	page.child_count = reader_u32(&reader);
	payload_bytes = reader_u32(&reader);
	if (memcmp(magic.data, page_magic, sizeof(page_magic)) != 0 || version != PAGE_VERSION ||
	    page.kind < PAGE_ROOT || page.kind >= PAGE_KINDS)
		return rc;
	/* The counts must account for every byte before memory is allocated for them. */
	if ((uint64_t)page.child_count * PAGE_CHILD_BYTES + payload_bytes != reader_left(&reader))
		return rc;
	rc = read_children(&reader, &page);
	if (rc < 0) {
		page_finish(&page);
		return rc;
	}
	page.payload = reader_bytes(&reader, payload_bytes);
	*out = page;
	return 0;
}

void page_finish(struct page *page)
{
	if (!page)
		return;
	free(page->children);
	*page = (struct page){ 0 };
}

uint64_t page_child_offset(const struct page *page, uint32_t child)
{
	uint64_t offset = 0;

	assert(child <= page->child_count);
	for (uint32_t i = 0; i < child; i++)
		offset += page->children[i].size;
	return offset;
}
