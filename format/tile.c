/* Encodes and decodes one tile with libwebp, without the RIFF container. */
#include "format/tile.h"

#include <errno.h>
#include <string.h>

#include <webp/encode.h>

#include "format/unpack.h"

enum {
	SIDE_PX_MAX = 4096,
	CONTAINER_BYTES = 20, /* "RIFF" size "WEBP" "VP8 " size */
	FRAME_HEADER_BYTES = 10
};

/* These settings minimise the error for a given size, not the error seen from a fixed distance. A
 * tile is magnified, shrunk and blended with others, so spatial noise shaping (sns) is off, and
 * blocks are smoothed a little (docs/samples.md). */
static bool set_up(WebPConfig *config, int quality, enum tile_effort effort)
{
	if (!WebPConfigInit(config))
		return false;
	config->quality = (float)quality;
	config->method = effort == TILE_QUICK ? 5 : 6;
	config->sns_strength = 0;
	config->filter_strength = 20;
	config->segments = 1; /* they would have the same quality, and cost time and bytes */
	return WebPValidateConfig(config);
}

/* Returns the frame within libwebp's file. Its chunk is padded to an even size. */
static struct bytes frame_of(const WebPMemoryWriter *file)
{
	const uint8_t *size = file->mem + CONTAINER_BYTES - 4;

	return (struct bytes){ file->mem + CONTAINER_BYTES,
			       size[0] | (size_t)size[1] << 8 | (size_t)size[2] << 16 };
}

int tile_encode(struct buffer *out, const uint8_t *rgb, uint32_t side_px, int quality,
		enum tile_effort effort)
{
	WebPConfig config;
	WebPPicture picture;
	WebPMemoryWriter file;
	int rc = -ENOMEM;

	if (side_px == 0 || side_px > SIDE_PX_MAX || !set_up(&config, quality, effort) ||
	    !WebPPictureInit(&picture))
		return -EINVAL;
	picture.width = picture.height = (int)side_px;
	WebPMemoryWriterInit(&file);
	picture.writer = WebPMemoryWrite;
	picture.custom_ptr = &file;
	if (WebPPictureImportRGB(&picture, rgb, (int)side_px * 3) &&
	    WebPEncode(&config, &picture)) {
		struct bytes frame = frame_of(&file);

		buffer_put(out, frame.data, frame.size);
		rc = out->error;
	}
	WebPPictureFree(&picture);
	WebPMemoryWriterClear(&file);
	return rc;
}

/* Accepts only the header of a key frame of that size (RFC 6386, 9.1). libwebp alone would also
 * take a container or a lossless picture. */
static bool acceptable(struct bytes object, uint32_t side_px)
{
	static const uint8_t start_code[3] = { 0x9d, 0x01, 0x2a };
	const uint8_t *d = object.data;

	return object.size > FRAME_HEADER_BYTES && !(d[0] & 1) &&
	       memcmp(d + 3, start_code, 3) == 0 && (d[6] | (uint32_t)d[7] << 8) == side_px &&
	       (d[8] | (uint32_t)d[9] << 8) == side_px;
}

int tile_decode(uint8_t *rgb, uint32_t side_px, struct bytes object)
{
	size_t stride = (size_t)side_px * 3;

	if (side_px == 0 || side_px > SIDE_PX_MAX)
		return -EINVAL;
	if (!acceptable(object, side_px))
		return -EBADMSG;
	return unpack_webp(rgb, stride * side_px, side_px, false, object);
}
