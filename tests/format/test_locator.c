#include "format/locator.h"

#include <errno.h>
#include <string.h>

#include "tests/check.h"
#include "tests/format/bend.h"

static struct hash packs[] = { { { 7 } }, { { 8 } } };
static struct locator_block blocks[] = {
	{ .page = { { 0 } }, .pack = 0, .offset = 0, .size = 300 },
	{ .page = { { 1, 1 } }, .pack = 1, .offset = 4000, .size = 20 },
	{ .page = { { 1, 2 } }, .pack = 0, .offset = 300, .size = UINT32_MAX - 300 },
};
static const struct locator sample = {
	.pack_count = 2, .block_count = 3, .packs = packs, .blocks = blocks
};

/* As version 1 wrote it. */
static void encode_first_version(struct buffer *out)
{
	struct hash check;

	buffer_put(out, "GLoc", 4);
	buffer_put_u32(out, 1);
	buffer_put_u32(out, sample.pack_count);
	buffer_put_u32(out, sample.block_count);
	for (uint32_t i = 0; i < sample.pack_count; i++)
		buffer_put(out, packs[i].bytes, HASH_BYTES);
	for (uint32_t i = 0; i < sample.block_count; i++) {
		buffer_put(out, blocks[i].page.bytes, HASH_BYTES);
		buffer_put_u32(out, blocks[i].pack);
		buffer_put_u32(out, blocks[i].offset);
		buffer_put_u32(out, blocks[i].size);
	}
	check = hash_of(buffer_bytes(out));
	buffer_put(out, check.bytes, HASH_BYTES);
}

static int decode(struct bytes bytes, void *data)
{
	struct locator locator;
	int rc = locator_decode(&locator, bytes);

	(void)data;
	if (rc < 0)
		CHECK(rc == -EBADMSG && !locator.packs && !locator.blocks);
	locator_finish(&locator);
	return rc;
}

static void check_blocks(void (*encode)(struct buffer *out))
{
	struct buffer buffer;
	struct locator back;

	buffer_init(&buffer, 4096);
	encode(&buffer);
	CHECK(locator_decode(&back, buffer_bytes(&buffer)) == 0);
	CHECK(back.pack_count == 2 && hash_equal(back.packs[1], packs[1]));
	for (int i = 0; i < 3; i++) {
		const struct locator_block *block = locator_find(&back, blocks[i].page);

		CHECK(block && block->pack == blocks[i].pack);
		CHECK(block->offset == blocks[i].offset && block->size == blocks[i].size);
	}
	CHECK(locator_find(&back, (struct hash){ { 1 } }) == NULL);
	CHECK(locator_find(&back, (struct hash){ { 255 } }) == NULL);
	locator_finish(&back);
	locator_finish(NULL);
	buffer_finish(&buffer);
}

static void encode_sample(struct buffer *out)
{
	locator_encode(out, &sample);
}

static void finds_every_block_and_no_other(void **state)
{
	(void)state;
	check_blocks(encode_sample);
	check_blocks(encode_first_version);
}

/* 12 bytes a block that lies beside the last one, and names that are long enough. */
static void is_as_short_as_its_names_allow(void **state)
{
	enum { COUNT = 100, ALIKE = 11 };
	static struct locator_block many[COUNT];
	struct locator locator = { .pack_count = 2, .packs = packs, .blocks = many };
	struct locator back;
	struct buffer buffer;

	(void)state;
	locator.block_count = COUNT;
	for (uint32_t i = 0; i < COUNT; i++) {
		many[i] = (struct locator_block){ .offset = 10 * i, .size = 10 };
		many[i].page.bytes[3] = (uint8_t)i;
	}
	buffer_init(&buffer, 4096);
	locator_encode(&buffer, &locator);
	assert_int_equal(buffer.size, 24 + 2 * 16 + 12 + COUNT * 12 + 16);
	buffer_clear(&buffer);
	many[1].page = many[0].page;
	many[1].page.bytes[ALIKE] = 1;
	locator_encode(&buffer, &locator);
	assert_int_equal(buffer.size, 24 + 2 * 16 + 12 + COUNT * (ALIKE + 1 + 4) + 16);
	CHECK(locator_decode(&back, buffer_bytes(&buffer)) == 0);
	for (uint32_t i = 0; i < COUNT; i++)
		CHECK(locator_find(&back, many[i].page)->offset == 10 * i);
	locator_finish(&back);
	buffer_finish(&buffer);
}

static void any_damage_is_found(void **state)
{
	struct buffer buffer;

	(void)state;
	buffer_init(&buffer, 4096);
	encode_first_version(&buffer);
	refuses_every_truncation(decode, NULL, buffer_bytes(&buffer));
	CHECK(count_accepted_flips(decode, NULL, buffer_bytes(&buffer)) == 0);
	buffer_clear(&buffer);
	locator_encode(&buffer, &sample);
	refuses_every_truncation(decode, NULL, buffer_bytes(&buffer));
	CHECK(count_accepted_flips(decode, NULL, buffer_bytes(&buffer)) == 0);
	buffer_put_u8(&buffer, 0);
	CHECK(decode(buffer_bytes(&buffer), NULL) == -EBADMSG);
	buffer_finish(&buffer);
}

/* Sealed as an honest locator is, but with one block that is wrong. */
static int decode_with(uint32_t at, struct locator_block block)
{
	struct locator_block changed[3];
	struct locator locator = sample;
	struct buffer buffer;
	int rc;

	memcpy(changed, blocks, sizeof(changed));
	changed[at] = block;
	locator.blocks = changed;
	buffer_init(&buffer, 4096);
	locator_encode(&buffer, &locator);
	rc = decode(buffer_bytes(&buffer), NULL);
	buffer_finish(&buffer);
	return rc;
}

static void refuses_sealed_nonsense(void **state)
{
	struct locator_block block = blocks[1];

	(void)state;
	CHECK(decode_with(1, block) == 0);
	block.pack = 2;
	CHECK(decode_with(1, block) == -EBADMSG);
	block = blocks[1];
	block.size = 0;
	CHECK(decode_with(1, block) == -EBADMSG);
	block = blocks[2];
	block.offset = 301; /* ends past 4 GiB */
	CHECK(decode_with(2, block) == -EBADMSG);
	CHECK(decode_with(1, blocks[2]) == -EBADMSG); /* named twice */
	CHECK(decode_with(1, blocks[0]) == -EBADMSG);
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(finds_every_block_and_no_other),
		cmocka_unit_test(is_as_short_as_its_names_allow),
		cmocka_unit_test(any_damage_is_found),
		cmocka_unit_test(refuses_sealed_nonsense),
	};

	return cmocka_run_group_tests(tests, NULL, NULL);
}
