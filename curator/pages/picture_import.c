/* Decodes, turns, shrinks and encodes a picture, in a sandboxed child. */
#include "curator/pages/picture_import.h"

#include <errno.h>
#include <stdlib.h>
#include <string.h>
#include <webp/decode.h>

#include "base/shared_memory.h"
#include "curator/pages/exif_orientation.h"
#include "format/page.h"
#include "format/picture.h"
#include "format/unpack.h"
#include "pipeline/import/sandbox.h"

enum {
	QUALITY = 90,
	TIMEOUT_S = 60,
	MEMORY_MB = 3072, /* 16384 by 16384 pixels twice, and the codec's own */
};

/* ---- decoding */

static int decode_webp(struct picture *out, struct bytes file, bool *is_png)
{
	WebPBitstreamFeatures features;

	if (WebPGetFeatures(file.data, file.size, &features) != VP8_STATUS_OK ||
	    features.has_animation)
		return -EBADMSG;
	if (features.width > PICTURE_SIDE_MOST_PX || features.height > PICTURE_SIDE_MOST_PX)
		return -EFBIG;
	out->width = (uint32_t)features.width;
	out->height = (uint32_t)features.height;
	out->rgba = malloc((size_t)out->width * out->height * 4);
	if (!out->rgba)
		return -ENOMEM;
	*is_png = features.has_alpha || features.format == 2;
	return unpack_webp(out->rgba, (size_t)out->width * out->height * 4, out->width, true, file);
}

static int decode(struct picture *out, struct bytes file, bool *is_png)
{
	if (file.size >= 12 && memcmp(file.data, "RIFF", 4) == 0 &&
	    memcmp(file.data + 8, "WEBP", 4) == 0)
		return decode_webp(out, file, is_png);
	*is_png = file.size > 0 && file.data[0] == 0x89;
	return picture_decode(out, file);
}

/* ---- turning and shrinking */

/* Where the pixel of the upright picture is in the file's. Orientations as EXIF numbers them. */
static size_t turned(const struct picture *from, unsigned orientation, uint32_t x, uint32_t y)
{
	const uint32_t right = from->width - 1, bottom = from->height - 1;
	uint32_t column = x, row = y;

	if (orientation >= 5) {
		column = y;
		row = x;
	}
	if (orientation == 2 || orientation == 3 || orientation == 7 || orientation == 8)
		column = right - column;
	if (orientation == 3 || orientation == 4 || orientation == 6 || orientation == 7)
		row = bottom - row;
	return (size_t)row * from->width + column;
}

static int turn(struct picture *picture, unsigned orientation)
{
	struct picture to = { picture->width, picture->height, NULL };

	if (orientation <= 1)
		return 0;
	if (orientation >= 5) {
		to.width = picture->height;
		to.height = picture->width;
	}
	to.rgba = malloc((size_t)to.width * to.height * 4);
	if (!to.rgba)
		return -ENOMEM;
	for (uint32_t y = 0; y < to.height; y++)
		for (uint32_t x = 0; x < to.width; x++)
			memcpy(to.rgba + 4 * ((size_t)y * to.width + x),
			       picture->rgba + 4 * turned(picture, orientation, x, y), 4);
	picture_finish(picture);
	*picture = to;
	return 0;
}

/* The mean of the pixels x0..x1, y0..y1, weighted by their alpha. */
static void mean(const struct picture *from, uint32_t x0, uint32_t x1, uint32_t y0, uint32_t y1,
		 uint8_t out[4])
{
	uint64_t sum[3] = { 0 }, alpha = 0, count = (uint64_t)(x1 - x0) * (y1 - y0);

	for (uint32_t y = y0; y < y1; y++)
		for (uint32_t x = x0; x < x1; x++) {
			const uint8_t *p = from->rgba + 4 * ((size_t)y * from->width + x);

			for (int i = 0; i < 3; i++)
				sum[i] += (uint64_t)p[i] * p[3];
			alpha += p[3];
		}
	for (int i = 0; i < 3; i++)
		out[i] = alpha ? (uint8_t)((sum[i] + alpha / 2) / alpha) : 0;
	out[3] = (uint8_t)((alpha + count / 2) / count);
}

static int shrink(struct picture *picture)
{
	const uint32_t side = picture->width > picture->height ? picture->width : picture->height;
	struct picture to = { 0 };

	if (side <= PICTURE_IMPORT_SIDE_MAX_PX)
		return 0;
	to.width = (uint32_t)((uint64_t)picture->width * PICTURE_IMPORT_SIDE_MAX_PX / side);
	to.height = (uint32_t)((uint64_t)picture->height * PICTURE_IMPORT_SIDE_MAX_PX / side);
	to.width += to.width == 0;
	to.height += to.height == 0;
	to.rgba = malloc((size_t)to.width * to.height * 4);
	if (!to.rgba)
		return -ENOMEM;
	for (uint32_t y = 0; y < to.height; y++)
		for (uint32_t x = 0; x < to.width; x++)
			mean(picture, (uint32_t)((uint64_t)x * picture->width / to.width),
			     (uint32_t)((uint64_t)(x + 1) * picture->width / to.width),
			     (uint32_t)((uint64_t)y * picture->height / to.height),
			     (uint32_t)((uint64_t)(y + 1) * picture->height / to.height),
			     to.rgba + 4 * ((size_t)y * to.width + x));
	picture_finish(picture);
	*picture = to;
	return 0;
}

int picture_import_here(struct buffer *out, bool *is_png, struct bytes file)
{
	struct picture picture = { 0 };
	int rc = decode(&picture, file, is_png);

	if (rc == 0)
		rc = turn(&picture, exif_orientation(file));
	if (rc == 0)
		rc = shrink(&picture);
	if (rc == 0)
		rc = *is_png ? picture_encode_png(out, &picture)
			     : picture_encode_jpeg(out, &picture, QUALITY);
	picture_finish(&picture);
	return rc;
}

/* ---- the child */

/* In shared memory. */
struct job {
	struct bytes file; /* the child has a copy of the parent's memory */
	uint32_t bytes;
	bool is_png;
	uint8_t data[OBJECT_BYTES_MAX];
};

static int work(void *shared, struct diagnostics *diagnostics)
{
	struct job *job = shared;
	struct buffer out;
	bool is_png = false;
	int rc;

	(void)diagnostics;
	buffer_init(&out, sizeof(job->data));
	rc = picture_import_here(&out, &is_png, job->file);
	if (rc < 0)
		return rc;
	memcpy(job->data, out.data, out.size);
	job->bytes = (uint32_t)out.size;
	job->is_png = is_png;
	return 0;
}

static int explain(int rc, struct diagnostics *diagnostics)
{
	if (rc == -EFBIG)
		return diagnostics_add(diagnostics, rc, NULL, 0,
				       "the picture is too large: at most %d pixels a side and %d "
				       "MB; save it smaller",
				       PICTURE_SIDE_MOST_PX, OBJECT_BYTES_MAX >> 20);
	if (rc == -ENOMEM)
		return diagnostics_add(diagnostics, rc, NULL, 0,
				       "the picture needs more memory than there is: save it "
				       "smaller");
	return diagnostics_add(
		diagnostics, rc, NULL, 0,
		"this is not a complete JPEG, PNG or WebP picture in RGB: save it again "
		"as one (CMYK is for printing)");
}

int picture_import(struct buffer *out, bool *is_png, struct bytes file,
		   struct diagnostics *diagnostics)
{
	struct sandbox_options options = { .limits.timeout_s = TIMEOUT_S };
	struct job *job = shared_memory_create(sizeof(*job));
	struct diagnostics told = { 0 };
	int rc;

	if (!job)
		return explain(-ENOMEM, diagnostics);
	options.limits.memory_bytes = sandbox_memory_bytes((uint64_t)MEMORY_MB << 20);
	job->file = file;
	rc = sandbox_run(work, job, &options, "picture", &told);
	if (rc == 0 && (job->bytes == 0 || job->bytes > sizeof(job->data)))
		rc = -EBADMSG;
	if (rc == 0) {
		*is_png = job->is_png;
		buffer_put(out, job->data, job->bytes);
		rc = out->error;
	}
	if (rc < 0)
		explain(rc, diagnostics);
	diagnostics_finish(&told);
	shared_memory_destroy(job, sizeof(*job));
	return rc;
}
