/* Encodes, decodes and checks the payload of the stream page. */
#include "format/stream_page.h"

#include <errno.h>
#include <math.h>

void stream_page_encode(struct buffer *out, uint32_t group_count, const float *errors_m,
			uint32_t block_count, struct bytes start)
{
	buffer_put_u32(out, group_count);
	for (uint32_t i = 0; i <= block_count; i++)
		buffer_put_f32(out, errors_m[i]);
	buffer_put(out, start.data, start.size);
}

int stream_page_decode(struct stream_page *out, struct bytes payload, uint32_t block_count)
{
	struct stream_page page = { .block_count = block_count };
	struct reader reader;
	float before = INFINITY;

	*out = (struct stream_page){ 0 };
	reader_init(&reader, payload);
	page.group_count = reader_u32(&reader);
	if (reader.failed || page.group_count == 0 || reader_left(&reader) / 4 <= block_count)
		return -EBADMSG;
	page.errors = reader_bytes(&reader, 4 * ((size_t)block_count + 1));
	page.start = reader_bytes(&reader, reader_left(&reader));
	for (uint32_t i = 0; i <= block_count; i++) {
		float error_m = stream_page_error_m(&page, i);

		if (!isfinite(error_m) || error_m < 0 || error_m > before)
			return -EBADMSG;
		before = error_m;
	}
	*out = page;
	return 0;
}

float stream_page_error_m(const struct stream_page *page, uint32_t blocks)
{
	struct reader reader;

	reader_init(&reader, (struct bytes){ page->errors.data + 4 * (size_t)blocks, 4 });
	return reader_f32(&reader);
}
