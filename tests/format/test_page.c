#include "format/page.h"

#include <errno.h>
#include <stdlib.h>
#include <string.h>

#include "tests/check.h"
#include "tests/format/bend.h"

static struct page_child children[] = {
	{ .hash.bytes = { 1 }, .size = 100, .is_page = true },
	{ .hash.bytes = { 2, 9 }, .size = OBJECT_BYTES_MAX, .is_page = false },
	{ .hash.bytes = { 3 }, .size = 1, .is_page = false },
};

static struct page sample_page(void)
{
	return (struct page){ .kind = PAGE_BRICK,
			      .child_count = 3,
			      .children = children,
			      .payload = { (const uint8_t *)"payload", 7 } };
}

static int decode(struct bytes bytes, void *data)
{
	struct page page;
	int rc = page_decode(&page, bytes);

	(void)data;
	if (rc < 0) {
		CHECK(rc == -EBADMSG);
		CHECK(page.children == NULL && page.child_count == 0);
	}
	page_finish(&page);
	return rc;
}

static void gives_back_children_and_payload(void **state)
{
	struct page page = sample_page(), back;
	struct buffer buffer;

	(void)state;
	buffer_init(&buffer, 4096);
	page_encode(&buffer, &page);
	CHECK(buffer.size == PAGE_HEADER_BYTES + 3 * PAGE_CHILD_BYTES + 7);
	CHECK(page_decode(&back, buffer_bytes(&buffer)) == 0);
	CHECK(back.kind == PAGE_BRICK && back.child_count == 3);
	for (int i = 0; i < 3; i++) {
		CHECK(hash_equal(back.children[i].hash, children[i].hash));
		CHECK(back.children[i].size == children[i].size);
		CHECK(back.children[i].is_page == children[i].is_page);
	}
	CHECK(back.payload.size == 7 && memcmp(back.payload.data, "payload", 7) == 0);
	CHECK(page_child_offset(&back, 0) == 0);
	CHECK(page_child_offset(&back, 2) == 100 + OBJECT_BYTES_MAX);
	page_finish(&back);
	page_finish(NULL);
	buffer_finish(&buffer);
}

static void a_page_may_be_empty(void **state)
{
	struct page page = { .kind = PAGE_INFO }, back;
	struct buffer buffer;

	(void)state;
	buffer_init(&buffer, 4096);
	page_encode(&buffer, &page);
	CHECK(buffer.size == PAGE_HEADER_BYTES);
	CHECK(page_decode(&back, buffer_bytes(&buffer)) == 0);
	CHECK(back.child_count == 0 && back.payload.size == 0);
	page_finish(&back);
	buffer_finish(&buffer);
}

static void refuses_truncated_trailing_and_flipped(void **state)
{
	struct page page = sample_page();
	struct buffer buffer;

	(void)state;
	buffer_init(&buffer, 4096);
	page_encode(&buffer, &page);
	refuses_every_truncation(decode, NULL, buffer_bytes(&buffer));
	count_accepted_flips(decode, NULL, buffer_bytes(&buffer));
	buffer_put_u8(&buffer, 0);
	CHECK(decode(buffer_bytes(&buffer), NULL) == -EBADMSG);
	buffer_finish(&buffer);
}

/* Encodes the sample, sets one byte, and says what decoding thinks of it. */
static int decode_with(size_t at, uint8_t value)
{
	struct page page = sample_page();
	struct buffer buffer;
	int rc;

	buffer_init(&buffer, 4096);
	page_encode(&buffer, &page);
	buffer.data[at] = value;
	rc = decode(buffer_bytes(&buffer), NULL);
	buffer_finish(&buffer);
	return rc;
}

static void refuses_what_no_encoder_writes(void **state)
{
	(void)state;
	CHECK(decode_with(0, 'g') == -EBADMSG);     /* magic */
	CHECK(decode_with(4, 0) == -EBADMSG);       /* kind */
	CHECK(decode_with(4, 9) == -EBADMSG);       /* kind */
	CHECK(decode_with(6, 2) == -EBADMSG);       /* version */
	CHECK(decode_with(8, 4) == -EBADMSG);       /* more children than bytes */
	CHECK(decode_with(11, 0xff) == -EBADMSG);   /* absurdly more */
	CHECK(decode_with(15, 0xff) == -EBADMSG);   /* absurd payload */
	CHECK(decode_with(16, 0) == -EBADMSG);      /* an empty child */
	CHECK(decode_with(18, 0x41) == -EBADMSG);   /* a page above PAGE_BYTES_MAX */
	CHECK(decode_with(16 + 20, 1) == -EBADMSG); /* above OBJECT_BYTES_MAX */
	CHECK(decode_with(16 + 4, 0) == -EBADMSG);  /* the zero hash */
	CHECK(decode_with(16 + 40 + 3, 0x80) == 0); /* another flag is another page */
}

static void refuses_to_write_too_large_a_page(void **state)
{
	static uint8_t payload[PAGE_BYTES_MAX];
	struct page page = { .kind = PAGE_INFO, .payload = { payload, sizeof(payload) } };
	struct buffer buffer;

	(void)state;
	buffer_init(&buffer, 16 << 20);
	page_encode(&buffer, &page);
	CHECK(buffer.error == -EFBIG);
	buffer_finish(&buffer);
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(gives_back_children_and_payload),
		cmocka_unit_test(a_page_may_be_empty),
		cmocka_unit_test(refuses_truncated_trailing_and_flipped),
		cmocka_unit_test(refuses_what_no_encoder_writes),
		cmocka_unit_test(refuses_to_write_too_large_a_page),
	};

	return cmocka_run_group_tests(tests, NULL, NULL);
}
