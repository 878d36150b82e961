/* Encodes and decodes the locator file, and finds a page's block in it by binary search. */
#include "format/locator.h"

#include <errno.h>
#include <stdlib.h>
#include <string.h>

static const uint8_t locator_magic[4] = { 'G', 'L', 'o', 'c' };

enum {
	LOCATOR_VERSION = 2,
	LOCATOR_NAME_BYTES = 8, /* the least */
	LOCATOR_HEADER_BYTES = 24,
	LOCATOR_RUN_BYTES = 12,
	LOCATOR_FIRST_HEADER_BYTES = 16, /* of version 1 */
	LOCATOR_FIRST_BLOCK_BYTES = HASH_BYTES + 12,
};

/* Instead of the number of runs, in version 1. No file has so many. */
static const uint32_t no_runs = UINT32_MAX;

static int compare_pages(const void *a, const void *b)
{
	return hash_compare(((const struct locator_block *)a)->page,
			    ((const struct locator_block *)b)->page);
}

/* ---- encoding */

static int compare_places(const void *left, const void *right)
{
	const struct locator_block *a = left, *b = right;

	if (a->pack != b->pack)
		return a->pack < b->pack ? -1 : 1;
	return (a->offset > b->offset) - (a->offset < b->offset);
}

/* Returns how many bytes tell all names apart. The blocks are sorted by them. */
static uint32_t find_name_bytes(const struct locator_block *blocks, uint32_t count)
{
	uint32_t most = LOCATOR_NAME_BYTES;

	for (uint32_t i = 1; i < count; i++)
		while (most < HASH_BYTES &&
		       memcmp(blocks[i - 1].page.bytes, blocks[i].page.bytes, most) == 0)
			most++;
	return most;
}

/* Returns the first block after a run that begins at a block. The blocks are sorted by place. */
static uint32_t end_of_run(const struct locator_block *blocks, uint32_t count, uint32_t first)
{
	uint32_t i = first + 1;

	while (i < count && blocks[i].pack == blocks[first].pack &&
	       blocks[i].offset == blocks[i - 1].offset + blocks[i - 1].size)
		i++;
	return i;
}

static void put_runs(struct buffer *out, const struct locator_block *blocks, uint32_t count)
{
	for (uint32_t i = 0, end; i < count; i = end) {
		end = end_of_run(blocks, count, i);
		buffer_put_u32(out, blocks[i].pack);
		buffer_put_u32(out, blocks[i].offset);
		buffer_put_u32(out, end - i);
	}
}

static void put_tables(struct buffer *out, const struct locator *locator,
		       const struct locator_block *blocks, uint32_t name_bytes)
{
	const uint32_t count = locator->block_count;
	uint32_t runs = 0;

	for (uint32_t i = 0; i < count; i = end_of_run(blocks, count, i))
		runs++;
	buffer_put(out, locator_magic, sizeof(locator_magic));
	buffer_put_u32(out, LOCATOR_VERSION);
	buffer_put_u32(out, locator->pack_count);
	buffer_put_u32(out, runs);
	buffer_put_u32(out, count);
	buffer_put_u32(out, name_bytes);
	for (uint32_t i = 0; i < locator->pack_count; i++)
		buffer_put(out, locator->packs[i].bytes, HASH_BYTES);
	put_runs(out, blocks, count);
	for (uint32_t i = 0; i < count; i++) {
		buffer_put(out, blocks[i].page.bytes, name_bytes);
		buffer_put_u32(out, blocks[i].size);
	}
}

void locator_encode(struct buffer *out, const struct locator *locator)
{
	const size_t start = out->size;
	struct locator_block *blocks = calloc((size_t)locator->block_count + 1, sizeof(*blocks));
	uint32_t name_bytes;
	struct hash check;

	if (!blocks) {
		out->error = out->error ? out->error : -ENOMEM;
		return;
	}
	if (locator->block_count > 0)
		memcpy(blocks, locator->blocks, locator->block_count * sizeof(*blocks));
	qsort(blocks, locator->block_count, sizeof(*blocks), compare_pages);
	name_bytes = find_name_bytes(blocks, locator->block_count);
	qsort(blocks, locator->block_count, sizeof(*blocks), compare_places);
	put_tables(out, locator, blocks, name_bytes);
	free(blocks);
	if (out->error)
		return;
	check = hash_of((struct bytes){ out->data + start, out->size - start });
	buffer_put(out, check.bytes, HASH_BYTES);
}

/* ---- decoding */

/* Reads the first bytes of a hash; the others are 0. */
static struct hash read_name(struct reader *reader, uint32_t name_bytes)
{
	struct bytes bytes = reader_bytes(reader, name_bytes);
	struct hash hash = { 0 };

	if (bytes.size == name_bytes)
		memcpy(hash.bytes, bytes.data, name_bytes);
	return hash;
}

/* Returns whether the block may be there: it is not empty and ends within 4 GiB of a known pack. */
static bool is_possible(const struct locator *locator, const struct locator_block *block)
{
	return block->pack < locator->pack_count && block->size > 0 &&
	       block->size <= UINT32_MAX - block->offset;
}

/* Reads the blocks of a run, up to `most` of them. Returns how many, or -EBADMSG. */
static int64_t read_run(struct reader *runs, struct reader *names, const struct locator *locator,
			struct locator_block *blocks, uint32_t most)
{
	struct locator_block at;
	uint32_t count;

	at.pack = reader_u32(runs);
	at.offset = reader_u32(runs);
	count = reader_u32(runs);
	if (count == 0 || count > most)
		return -EBADMSG;
	for (uint32_t i = 0; i < count; i++) {
		at.page = read_name(names, locator->name_bytes);
		at.size = reader_u32(names);
		if (!is_possible(locator, &at))
			return -EBADMSG;
		blocks[i] = at;
		at.offset += at.size;
	}
	return count;
}

static int read_runs(struct reader *reader, struct locator *locator, uint32_t run_count)
{
	struct reader runs;
	uint32_t read = 0;

	reader_init(&runs, reader_bytes(reader, (size_t)run_count * LOCATOR_RUN_BYTES));
	for (uint32_t i = 0; i < run_count; i++) {
		const int64_t count = read_run(&runs, reader, locator, locator->blocks + read,
					       locator->block_count - read);

		if (count < 0)
			return (int)count;
		read += (uint32_t)count;
	}
	return read == locator->block_count ? 0 : -EBADMSG;
}

/* Those of version 1. */
static int read_blocks(struct reader *reader, struct locator *locator)
{
	for (uint32_t i = 0; i < locator->block_count; i++) {
		struct locator_block *block = &locator->blocks[i];

		block->page = read_name(reader, HASH_BYTES);
		block->pack = reader_u32(reader);
		block->offset = reader_u32(reader);
		block->size = reader_u32(reader);
		if (!is_possible(locator, block))
			return -EBADMSG;
	}
	return 0;
}

static int read_tables(struct reader *reader, struct locator *locator, uint32_t run_count)
{
	int rc;

	locator->packs = calloc((size_t)locator->pack_count + 1, sizeof(*locator->packs));
	locator->blocks = calloc((size_t)locator->block_count + 1, sizeof(*locator->blocks));
	if (!locator->packs || !locator->blocks)
		return -ENOMEM;
	for (uint32_t i = 0; i < locator->pack_count; i++) {
		locator->packs[i] = read_name(reader, HASH_BYTES);
		if (hash_is_zero(locator->packs[i]))
			return -EBADMSG;
	}
	rc = run_count == no_runs ? read_blocks(reader, locator)
				  : read_runs(reader, locator, run_count);
	if (rc < 0)
		return rc;
	qsort(locator->blocks, locator->block_count, sizeof(*locator->blocks), compare_pages);
	for (uint32_t i = 1; i < locator->block_count; i++)
		if (compare_pages(&locator->blocks[i - 1], &locator->blocks[i]) == 0)
			return -EBADMSG; /* named twice */
	return 0;
}

/* Reads the counts of either version. Returns the bytes that a file with them has; 0: it is none.
 */
static uint64_t read_counts(struct reader *reader, struct locator *locator, uint32_t *run_count)
{
	const struct bytes magic = reader_bytes(reader, sizeof(locator_magic));
	const uint32_t version = reader_u32(reader);
	uint64_t bytes;

	locator->pack_count = reader_u32(reader);
	*run_count = version == 1 ? no_runs : reader_u32(reader);
	locator->block_count = reader_u32(reader);
	locator->name_bytes = version == 1 ? HASH_BYTES : reader_u32(reader);
	if (reader->failed || memcmp(magic.data, locator_magic, sizeof(locator_magic)) != 0 ||
	    version < 1 || version > LOCATOR_VERSION || locator->name_bytes > HASH_BYTES ||
	    locator->name_bytes < LOCATOR_NAME_BYTES)
		return 0;
	bytes = (uint64_t)locator->pack_count * HASH_BYTES + HASH_BYTES;
	if (version == 1)
		return bytes + LOCATOR_FIRST_HEADER_BYTES +
		       (uint64_t)locator->block_count * LOCATOR_FIRST_BLOCK_BYTES;
	return bytes + LOCATOR_HEADER_BYTES + (uint64_t)*run_count * LOCATOR_RUN_BYTES +
	       (uint64_t)locator->block_count * (locator->name_bytes + 4);
}

/* Checks the header: its counts must account for every byte of the file, and the last hash must
 * match all bytes before it. */
static int read_header(struct reader *reader, struct locator *locator, struct bytes file,
		       uint32_t *run_count)
{
	const uint64_t expected = read_counts(reader, locator, run_count);
	struct hash check;

	if (expected == 0 || file.size != expected)
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
	uint32_t run_count;
	int rc;

	*out = locator;
	reader_init(&reader, file);
	rc = read_header(&reader, &locator, file, &run_count);
	if (rc == 0)
		rc = read_tables(&reader, &locator, run_count);
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
		int order =
			memcmp(locator->blocks[middle].page.bytes, page.bytes, locator->name_bytes);

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
