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

static void finds_every_block_and_no_other(void **state)
{
	struct buffer buffer;
	struct locator back;

	(void)state;
	buffer_init(&buffer, 4096);
	locator_encode(&buffer, &sample);
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

static void any_damage_is_found(void **state)
{
	struct buffer buffer;

	(void)state;
	buffer_init(&buffer, 4096);
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
	CHECK(decode_with(1, blocks[0]) == -EBADMSG); /* not sorted */
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(finds_every_block_and_no_other),
		cmocka_unit_test(any_damage_is_found),
		cmocka_unit_test(refuses_sealed_nonsense),
	};

	return cmocka_run_group_tests(tests, NULL, NULL);
}
