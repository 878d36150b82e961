/* Encodes and decodes the locator file, and finds a page's block in it by binary search. */
#include "format/locator.h"

#include <errno.h>
#include <stdlib.h>
#include <string.h>

static const uint8_t locator_magic[4] = { 'G', 'L', 'o', 'c' };

enum {
	LOCATOR_VERSION = 1,
	LOCATOR_HEADER_BYTES = 16,
	LOCATOR_BLOCK_BYTES = HASH_BYTES + 12,
};

void locator_encode(struct buffer *out, const struct locator *locator)
{
	size_t start = out->size;
	struct hash check;

	buffer_put(out, locator_magic, sizeof(locator_magic));
	buffer_put_u32(out, LOCATOR_VERSION);
	buffer_put_u32(out, locator->pack_count);
	buffer_put_u32(out, locator->block_count);
	for (uint32_t i = 0; i < locator->pack_count; i++)
		buffer_put(out, locator->packs[i].bytes, HASH_BYTES);
	for (uint32_t i = 0; i < locator->block_count; i++) {
		const struct locator_block *block = &locator->blocks[i];

		buffer_put(out, block->page.bytes, HASH_BYTES);
		buffer_put_u32(out, block->pack);
		buffer_put_u32(out, block->offset);
		buffer_put_u32(out, block->size);
	}
	if (out->error)
		return;
	check = hash_of((struct bytes){ out->data + start, out->size - start });
	buffer_put(out, check.bytes, HASH_BYTES);
}

static struct hash read_hash(struct reader *reader)
{
	struct bytes bytes = reader_bytes(reader, HASH_BYTES);
	struct hash hash = { 0 };

	if (bytes.size == HASH_BYTES)
		memcpy(hash.bytes, bytes.data, HASH_BYTES);
	return hash;
}

static int read_tables(struct reader *reader, struct locator *locator)
{
	locator->packs = calloc((size_t)locator->pack_count + 1, sizeof(*locator->packs));
	locator->blocks = calloc((size_t)locator->block_count + 1, sizeof(*locator->blocks));
	if (!locator->packs || !locator->blocks)
		return -ENOMEM;
	for (uint32_t i = 0; i < locator->pack_count; i++) {
		locator->packs[i] = read_hash(reader);
		if (hash_is_zero(locator->packs[i]))
			return -EBADMSG;
	}
	for (uint32_t i = 0; i < locator->block_count; i++) {
		struct locator_block *block = &locator->blocks[i];

		block->page = read_hash(reader);
		block->pack = reader_u32(reader);
		block->offset = reader_u32(reader);
		block->size = reader_u32(reader);
		if (block->pack >= locator->pack_count || block->size == 0 ||
		    block->size > UINT32_MAX - block->offset ||
		    (i > 0 && hash_compare(block[-1].page, block->page) >= 0))
			return -EBADMSG;
	}
	return 0;
}

/* Checks the header: its counts must account for every byte of the file, and the last hash must
 * match all bytes before it. */
static int read_header(struct reader *reader, struct locator *locator, struct bytes file)
{
	struct bytes magic = reader_bytes(reader, sizeof(locator_magic));
	uint32_t version = reader_u32(reader);
	uint64_t expected;
	struct hash check;

	locator->pack_count = reader_u32(reader);
	locator->block_count = reader_u32(reader);
	if (reader->failed || memcmp(magic.data, locator_magic, sizeof(locator_magic)) != 0 ||
	    version != LOCATOR_VERSION)
		return -EBADMSG;
	expected = LOCATOR_HEADER_BYTES + (uint64_t)locator->pack_count * HASH_BYTES +
		   (uint64_t)locator->block_count * LOCATOR_BLOCK_BYTES + HASH_BYTES;
	if (file.size != expected)
		return -EBADMSG;
	memcpy(check.bytes, file.data + file.size - HASH_BYTES, HASH_BYTES);
	if (!hash_equal(check, hash_of((struct bytes){ file.data, file.size - HASH_BYTES })))
		return -EBADMSG;
	return 0;
}

int locator_decode(struct locator *out, struct bytes file)
{
	struct locator locator = { 0 };
	struct reader reader;
	int rc;

	*out = locator;
	reader_init(&reader, file);
	rc = read_header(&reader, &locator, file);
	if (rc == 0)
		rc = read_tables(&reader, &locator);
	if (rc < 0) {
		locator_finish(&locator);
		return rc;
	}
	*out = locator;
	return 0;
}

const struct locator_block *locator_find(const struct locator *locator, struct hash page)
{
	uint32_t low = 0, high = locator->block_count;

	while (low < high) {
		uint32_t middle = low + (high - low) / 2;
		int order = hash_compare(locator->blocks[middle].page, page);

		if (order == 0)
			return &locator->blocks[middle];
		if (order < 0)
			low = middle + 1;
		else
			high = middle;
	}
	return NULL;
}

void locator_finish(struct locator *locator)
{
	if (!locator)
		return;
	free(locator->packs);
	free(locator->blocks);
	*locator = (struct locator){ 0 };
}
