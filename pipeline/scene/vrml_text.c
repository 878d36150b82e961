/* Unpacks gzip'd scenes with zlib, up to a ceiling. */
#include "pipeline/scene/vrml_text.h"

#include <errno.h>
#include <string.h>
#include <zlib.h>

enum { STEP_BYTES = 256 << 10, GZIP_WINDOW = 15 + 16 };

static int unpack(struct buffer *out, struct bytes file)
{
	z_stream stream = { .next_in = (Bytef *)file.data, .avail_in = (uInt)file.size };
	int code = inflateInit2(&stream, GZIP_WINDOW);

	if (code != Z_OK)
		return -ENOMEM;
	while (code == Z_OK) {
		uint8_t *to = buffer_extend(out, STEP_BYTES);

		if (!to)
			break;
		stream.next_out = to;
		stream.avail_out = STEP_BYTES;
		code = inflate(&stream, Z_NO_FLUSH);
		out->size -= stream.avail_out;
	}
	inflateEnd(&stream);
	if (out->error || code == Z_STREAM_END)
		return out->error;
	return code == Z_MEM_ERROR ? -ENOMEM : -EBADMSG;
}

int vrml_text(struct buffer *out, struct bytes file)
{
	int rc = 0;

	if (file.size > VRML_TEXT_BYTES_MAX)
		return -EFBIG;
	if (file.size >= 2 && file.data[0] == 0x1f && file.data[1] == 0x8b)
		rc = unpack(out, file);
	else
		buffer_put(out, file.data, file.size);
	if (rc == 0 && out->size > 0 && memchr(out->data, 0, out->size))
		rc = -EBADMSG;
	buffer_put_u8(out, 0);
	return rc < 0 ? rc : out->error;
}
