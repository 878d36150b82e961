/* Decodes and encodes whole pictures with libpng and libjpeg, within limits on size and progressive
 * scans. */
#include "format/picture.h"

#include <errno.h>
#include <setjmp.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <jerror.h>
#include <jpeglib.h>
#include <png.h>

#include "format/jpeg_to_buffer.h"

/* Allocates width x height pixels; -EBADMSG for an empty picture, -EFBIG past the limits. */
static int allocate(struct picture *out, uint32_t width, uint32_t height, uint32_t side_most_px)
{
	if (width == 0 || height == 0)
		return -EBADMSG;
	if (width > side_most_px || height > side_most_px ||
	    (uint64_t)width * height > PICTURE_PIXELS_MAX)
		return -EFBIG;
	out->rgba = malloc((size_t)width * height * 4);
	if (!out->rgba)
		return -ENOMEM;
	out->width = width;
	out->height = height;
	return 0;
}

void picture_finish(struct picture *picture)
{
	if (!picture)
		return;
	free(picture->rgba);
	*picture = (struct picture){ 0 };
}

/* ---- PNG, with libpng's simplified interface, which handles its own errors */

enum { PNG_START_BYTES = 8, PNG_CHUNK_BYTES = 12 /* length, name, check */ };

/* libpng tells what was wrong in words only; all that have it mean a lack of it. */
static int png_failure(const png_image *image)
{
	return strstr(image->message, "memory") ? -ENOMEM : -EBADMSG;
}

/* libpng makes room for what a chunk says it has before it reads it: 2 GiB for a file of a hundred
 * bytes. */
static bool chunks_fit(struct bytes file)
{
	size_t at = PNG_START_BYTES;

	while (file.size - at >= PNG_CHUNK_BYTES) {
		const size_t left = file.size - at - PNG_CHUNK_BYTES;
		const uint32_t bytes = png_get_uint_32(file.data + at);

		if (memcmp(file.data + at + 4, "IEND", 4) == 0)
			return true;
		if (bytes > left)
			return false;
		at += PNG_CHUNK_BYTES + bytes;
	}
	return true;
}

static int decode_png(struct picture *out, struct bytes file, uint32_t side_most_px)
{
	png_image image = { .version = PNG_IMAGE_VERSION };
	int rc;

	if (!chunks_fit(file))
		return -EBADMSG;
	if (!png_image_begin_read_from_memory(&image, file.data, file.size))
		return png_failure(&image);
	image.format = PNG_FORMAT_RGBA;
	rc = allocate(out, image.width, image.height, side_most_px);
	if (rc == 0 && !png_image_finish_read(&image, NULL, out->rgba, 0, NULL))
		rc = png_failure(&image);
	png_image_free(&image);
	return rc;
}

int picture_encode_png(struct buffer *out, const struct picture *picture)
{
	png_image image = {
		.version = PNG_IMAGE_VERSION,
		.width = picture->width,
		.height = picture->height,
		.format = PNG_FORMAT_RGBA,
		.flags = PNG_IMAGE_FLAG_FAST,
	};
	png_alloc_size_t size = PNG_IMAGE_PNG_SIZE_MAX(image);
	size_t before = out->size;
	uint8_t *to = buffer_extend(out, size);

	if (!to)
		return out->error;
	if (!png_image_write_to_memory(&image, to, &size, 0, picture->rgba, 0, NULL)) {
		out->size = before;
		return -ENOMEM;
	}
	out->size = before + size;
	return 0;
}

/* ---- JPEG */

enum { SCANS_MAX = 64 /* of a progressive file; encoders write about ten */ };

struct jpeg_failure {
	struct jpeg_error_mgr manager;
	jmp_buf jump;
	struct jpeg_progress_mgr progress;
};

static void jpeg_fail(j_common_ptr codec)
{
	struct jpeg_failure *failure = (struct jpeg_failure *)codec->err;

	longjmp(failure->jump, 1);
}

/* Counts warnings and prints nothing: code in format/ never logs. */
static void jpeg_quiet(j_common_ptr codec, int level)
{
	if (level < 0)
		codec->err->num_warnings++;
}

static struct jpeg_error_mgr *jpeg_errors(struct jpeg_failure *failure)
{
	jpeg_std_error(&failure->manager);
	failure->manager.error_exit = jpeg_fail;
	failure->manager.emit_message = jpeg_quiet;
	return &failure->manager;
}

/* Stops after SCANS_MAX scans. Each scan processes the whole picture, so a small file with a
 * thousand empty scans would take very long. */
static void jpeg_count_scans(j_common_ptr codec)
{
	if (codec->is_decompressor &&
	    ((struct jpeg_decompress_struct *)codec)->input_scan_number > SCANS_MAX)
		jpeg_fail(codec);
}

static void read_rgba_rows(struct jpeg_decompress_struct *codec, struct picture *out)
{
	while (codec->output_scanline < codec->output_height) {
		JSAMPROW row = out->rgba + (size_t)codec->output_scanline * out->width * 4;

		jpeg_read_scanlines(codec, &row, 1);
	}
}

static int decode_jpeg(struct picture *out, struct bytes file, uint32_t side_most_px)
{
	struct jpeg_decompress_struct codec;
	struct jpeg_failure failure;
	int rc;

	memset(&codec, 0, sizeof(codec)); /* may be destroyed before it is made */
	codec.err = jpeg_errors(&failure);
	if (setjmp(failure.jump)) {
		jpeg_destroy_decompress(&codec);
		return failure.manager.msg_code == JERR_OUT_OF_MEMORY ? -ENOMEM : -EBADMSG;
	}
	jpeg_create_decompress(&codec);
	jpeg_mem_src(&codec, file.data, file.size);
	jpeg_read_header(&codec, TRUE);
	codec.out_color_space = JCS_EXT_RGBA;
	/* Checked before libjpeg allocates: the coefficients of a progressive file need twice as
	 * much. */
	rc = allocate(out, codec.image_width, codec.image_height, side_most_px);
	if (rc == 0) {
		failure.progress.progress_monitor = jpeg_count_scans;
		codec.progress = &failure.progress;
		jpeg_start_decompress(&codec);
		read_rgba_rows(&codec, out);
		/* If a file ends early, libjpeg pads it with grey and counts a warning. */
		if (failure.manager.num_warnings > 0)
			rc = -EBADMSG;
		else
			jpeg_finish_decompress(&codec);
	}
	jpeg_destroy_decompress(&codec);
	return rc;
}

static int encode_jpeg(struct buffer *out, const struct picture *picture, int quality,
		       bool halves_colour)
{
	const size_t size_before = out->size;
	struct jpeg_compress_struct codec;
	struct jpeg_to_buffer destination;
	struct jpeg_failure failure;

	memset(&codec, 0, sizeof(codec)); /* likewise */
	codec.err = jpeg_errors(&failure);
	if (setjmp(failure.jump)) {
		jpeg_destroy_compress(&codec);
		out->size = size_before;
		return -ENOMEM;
	}
	jpeg_create_compress(&codec);
	jpeg_to_buffer(&destination, &codec, out);
	codec.image_width = picture->width;
	codec.image_height = picture->height;
	codec.input_components = 4;
	codec.in_color_space = JCS_EXT_RGBA;
	jpeg_set_defaults(&codec);
	jpeg_set_quality(&codec, quality, TRUE);
	if (!halves_colour)
		codec.comp_info[0].h_samp_factor = codec.comp_info[0].v_samp_factor = 1;
	codec.optimize_coding = TRUE;
	jpeg_start_compress(&codec, TRUE);
	while (codec.next_scanline < codec.image_height) {
		JSAMPROW row = picture->rgba + (size_t)codec.next_scanline * picture->width * 4;

		jpeg_write_scanlines(&codec, &row, 1);
	}
	jpeg_finish_compress(&codec);
	jpeg_destroy_compress(&codec);
	if (out->error)
		out->size = size_before;
	return out->error;
}

int picture_encode_jpeg(struct buffer *out, const struct picture *picture, int quality)
{
	return encode_jpeg(out, picture, quality, true);
}

int picture_encode_fine_jpeg(struct buffer *out, const struct picture *picture, int quality)
{
	return encode_jpeg(out, picture, quality, false);
}

static int decode(struct picture *out, struct bytes file, uint32_t side_most_px)
{
	static const uint8_t png_start[] = { 0x89, 'P', 'N', 'G', '\r', '\n', 0x1a, '\n' };
	int rc = -EBADMSG;

	*out = (struct picture){ 0 };
	_Static_assert(sizeof(png_start) == PNG_START_BYTES, "decode_png skips it");
	if (file.size >= sizeof(png_start) && memcmp(file.data, png_start, sizeof(png_start)) == 0)
		rc = decode_png(out, file, side_most_px);
	else if (file.size >= 2 && file.data[0] == 0xff && file.data[1] == 0xd8)
		rc = decode_jpeg(out, file, side_most_px);
	if (rc < 0)
		picture_finish(out);
	return rc;
}

int picture_decode(struct picture *out, struct bytes file)
{
	return decode(out, file, PICTURE_SIDE_MOST_PX);
}

int picture_decode_for_page(struct picture *out, struct bytes file)
{
	return decode(out, file, PICTURE_PAGE_SIDE_MOST_PX);
}
