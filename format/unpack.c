/* libzstd and libwebp, and what their errors mean here. */
#include "format/unpack.h"

#include <errno.h>

#include <webp/decode.h>
#include <zstd.h>
#include <zstd_errors.h>

bool unpack_zstd_fits(size_t bytes, struct bytes packed)
{
	return packed.size > 0 && ZSTD_getFrameContentSize(packed.data, packed.size) == bytes &&
	       ZSTD_findFrameCompressedSize(packed.data, packed.size) == packed.size;
}

int unpack_zstd(uint8_t *out, size_t bytes, struct bytes packed)
{
	const size_t got = ZSTD_decompress(out, bytes, packed.data, packed.size);

	if (got == bytes)
		return 0;
	return ZSTD_getErrorCode(got) == ZSTD_error_memory_allocation ? -ENOMEM : -EBADMSG;
}

int unpack_webp(uint8_t *out, size_t bytes, uint32_t width_px, bool alpha, struct bytes file)
{
	WebPDecoderConfig config;
	VP8StatusCode status;

	if (!WebPInitDecoderConfig(&config))
		return -EINVAL;
	config.output.colorspace = alpha ? MODE_RGBA : MODE_RGB;
	config.output.is_external_memory = 1;
	config.output.u.RGBA.rgba = out;
	config.output.u.RGBA.stride = (int)width_px * (alpha ? 4 : 3);
	config.output.u.RGBA.size = bytes;
	status = WebPDecode(file.data, file.size, &config);
	if (status == VP8_STATUS_OK)
		return 0;
	/* Nobody aborts: libwebp says so if there is no memory for its rows. */
	return status == VP8_STATUS_OUT_OF_MEMORY || status == VP8_STATUS_USER_ABORT ? -ENOMEM
										     : -EBADMSG;
}
