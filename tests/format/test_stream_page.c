#include "format/stream_page.h"

#include <errno.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "tests/check.h"

static const uint8_t start_bytes[] = { 'G', 'P', 's', 'm', 1, 2, 3 };
static const struct bytes start = { start_bytes, sizeof(start_bytes) };

static int decode_with(uint32_t group_count, const float *errors_m, uint32_t blocks)
{
	struct stream_page page;
	struct buffer payload;
	int rc;

	buffer_init(&payload, 4096);
	stream_page_encode(&payload, group_count, errors_m, blocks, start);
	rc = stream_page_decode(&page, buffer_bytes(&payload), blocks);
	buffer_finish(&payload);
	return rc;
}

static void gives_back_every_field(void **state)
{
	static const float errors_m[] = { 2.5f, 0.5f, 0.5f, 0 };
	struct stream_page page;
	struct buffer payload;

	(void)state;
	buffer_init(&payload, 4096);
	stream_page_encode(&payload, 5, errors_m, 3, start);
	CHECK(payload.error == 0);
	CHECK(stream_page_decode(&page, buffer_bytes(&payload), 3) == 0);
	CHECK(page.group_count == 5 && page.block_count == 3);
	for (uint32_t i = 0; i < 4; i++)
		CHECK(stream_page_error_m(&page, i) == errors_m[i]);
	CHECK(page.start.size == start.size);
	CHECK(memcmp(page.start.data, start.data, start.size) == 0);
	/* Truncated within the numbers; what is missing of the stream, its decoder notices. */
	for (size_t n = 0; n < 4 + 4 * 4; n++) {
		uint8_t *exact = malloc(n ? n : 1);

		memcpy(exact, payload.data, n);
		CHECK(stream_page_decode(&page, (struct bytes){ exact, n }, 3) == -EBADMSG);
		free(exact);
	}
	buffer_finish(&payload);
}

static void refuses_counts_and_errors_that_cannot_be(void **state)
{
	(void)state;
	CHECK(decode_with(1, (const float[]){ 1, 0 }, 1) == 0);
	CHECK(decode_with(0, (const float[]){ 1, 0 }, 1) == -EBADMSG);
	CHECK(decode_with(1, (const float[]){ 1, 1.5f }, 1) == -EBADMSG);
	CHECK(decode_with(1, (const float[]){ 1, -1 }, 1) == -EBADMSG);
	CHECK(decode_with(1, (const float[]){ INFINITY, 0 }, 1) == -EBADMSG);
	CHECK(decode_with(1, (const float[]){ NAN, 0 }, 1) == -EBADMSG);
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(gives_back_every_field),
		cmocka_unit_test(refuses_counts_and_errors_that_cannot_be),
	};

	return cmocka_run_group_tests(tests, NULL, NULL);
}
