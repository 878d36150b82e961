/* Compresses a picture once, keeps its coefficients, and writes them with each fragment rounded to
 * the quantization steps of its own quality. */
#include "pipeline/texmesh/fragment_jpeg.h"

#include <errno.h>
#include <setjmp.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <jerror.h>
#include <jpeglib.h>

#include "base/log.h"
#include "format/jpeg_to_buffer.h"
#include "pipeline/texmesh/coefficient_bytes.h"

struct fragment_jpeg {
	struct coefficients coefficients;
	uint32_t *bytes; /* [fragment][COEFFICIENT_KNOTS] */
};

/* ---- libjpeg: its errors, and its output into a buffer */

struct errors {
	struct jpeg_error_mgr manager;
	jmp_buf jump;
	int rc;
};

struct writer {
	struct jpeg_compress_struct codec;
	struct errors errors;
	struct jpeg_to_buffer destination;
	struct buffer *out;
};

struct reading {
	struct jpeg_decompress_struct codec;
	struct errors errors;
};

static void fail(j_common_ptr codec)
{
	struct errors *errors = (struct errors *)codec->err;
	char text[JMSG_LENGTH_MAX];

	errors->manager.format_message(codec, text);
	log_error("pipeline", "JPEG of a texture: %s", text);
	errors->rc = errors->manager.msg_code == JERR_OUT_OF_MEMORY ? -ENOMEM : -EIO;
	longjmp(errors->jump, 1);
}

static void keep_quiet(j_common_ptr codec, int level)
{
	(void)codec;
	(void)level;
}

static struct jpeg_error_mgr *errors_init(struct errors *errors)
{
	jpeg_std_error(&errors->manager);
	errors->manager.error_exit = fail;
	errors->manager.emit_message = keep_quiet;
	errors->rc = 0;
	return &errors->manager;
}

/* Sets all that both files have in common: size, 4:2:0, the steps of the best quality. */
static void writer_begin(struct writer *writer, const struct coefficients *coefficients)
{
	j_compress_ptr codec = &writer->codec;

	jpeg_create_compress(codec);
	jpeg_to_buffer(&writer->destination, codec, writer->out);
	codec->image_width = coefficients->width_px;
	codec->image_height = coefficients->height_px;
	codec->input_components = COEFFICIENT_PLANES;
	codec->in_color_space = JCS_RGB;
	jpeg_set_defaults(codec);
	jpeg_set_quality(codec, coefficients->best, TRUE);
}

static void writer_init(struct writer *writer, struct buffer *out)
{
	memset(&writer->codec, 0, sizeof(writer->codec)); /* may be destroyed before it is made */
	writer->codec.err = errors_init(&writer->errors);
	writer->out = out;
}

/* ---- the picture to coefficients */

/* A step that is no multiple of the best quality's would be rounded a second time: from 90 to 92,
 * that made larger files with more error than 89. */
static void take_factors(struct coefficients *coefficients, j_compress_ptr codec)
{
	uint32_t best[2][COEFFICIENTS_OF_BLOCK];

	memset(coefficients->factors, 1, sizeof(coefficients->factors));
	for (int quality = coefficients->best; quality > 0; quality--) {
		jpeg_set_quality(codec, quality, TRUE);
		for (int table = 0; table < 2; table++)
			for (int k = 0; k < COEFFICIENTS_OF_BLOCK; k++) {
				uint32_t step = codec->quant_tbl_ptrs[table]->quantval[k];

				if (quality == coefficients->best)
					best[table][k] = step;
				coefficients->factors[quality][table][k] =
					(uint8_t)((step + best[table][k] / 2) / best[table][k]);
			}
	}
	jpeg_set_quality(codec, coefficients->best, TRUE);
}

static int compress(struct writer *writer, struct coefficients *coefficients, const uint8_t *rgb)
{
	j_compress_ptr codec = &writer->codec;

	if (setjmp(writer->errors.jump) == 0) {
		writer_begin(writer, coefficients);
		take_factors(coefficients, codec);
		jpeg_start_compress(codec, TRUE);
		while (codec->next_scanline < codec->image_height) {
			JSAMPROW row = (JSAMPROW)rgb +
				       (size_t)codec->next_scanline * coefficients->width_px * 3;

			jpeg_write_scanlines(codec, &row, 1);
		}
		jpeg_finish_compress(codec);
	}
	jpeg_destroy_compress(codec);
	return writer->errors.rc < 0 ? writer->errors.rc : writer->out->error;
}

static void copy_plane(j_decompress_ptr codec, const struct coefficient_plane *plane,
		       jvirt_barray_ptr array)
{
	for (uint32_t row = 0; row < plane->rows; row++) {
		JBLOCKARRAY blocks =
			codec->mem->access_virt_barray((j_common_ptr)codec, array, row, 1, FALSE);

		memcpy(coefficients_of(plane, 0, row), blocks[0], plane->columns * sizeof(JBLOCK));
	}
}

static int take_coefficients(struct reading *reading, struct coefficients *coefficients,
			     struct bytes file)
{
	j_decompress_ptr codec = &reading->codec;

	memset(codec, 0, sizeof(*codec));
	codec->err = errors_init(&reading->errors);
	if (setjmp(reading->errors.jump) == 0) {
		jvirt_barray_ptr *arrays;

		jpeg_create_decompress(codec);
		jpeg_mem_src(codec, file.data, file.size);
		jpeg_read_header(codec, TRUE);
		arrays = jpeg_read_coefficients(codec);
		for (int i = 0; i < COEFFICIENT_PLANES; i++)
			copy_plane(codec, &coefficients->planes[i], arrays[i]);
	}
	jpeg_destroy_decompress(codec);
	return reading->errors.rc;
}

static int read_picture(struct coefficients *coefficients, const uint8_t *rgb)
{
	struct writer writer;
	struct reading reading;
	struct buffer file;
	int rc;

	/* Noise takes fewer bytes than its pixels; the rest is for the headers. */
	buffer_init(&file,
		    (size_t)coefficients->width_px * coefficients->height_px * 4 + (1 << 16));
	writer_init(&writer, &file);
	rc = compress(&writer, coefficients, rgb);
	if (rc == 0)
		rc = take_coefficients(&reading, coefficients, buffer_bytes(&file));
	buffer_finish(&file);
	return rc;
}

/* Empties the fragments that are not used; their means are set when the file is written. */
static void drop_unused(struct coefficients *coefficients)
{
	for (int i = 0; i < COEFFICIENT_PLANES; i++) {
		const struct coefficient_plane *plane = &coefficients->planes[i];

		for (uint32_t row = 0; row < plane->rows; row++)
			for (uint32_t column = 0; column < plane->columns; column++)
				if (!coefficients->used[coefficients_fragment(
					    coefficients, column / plane->unit_blocks,
					    row / plane->unit_blocks)])
					memset(coefficients_of(plane, column, row), 0,
					       sizeof(JBLOCK));
	}
}

int fragment_jpeg_create(struct fragment_jpeg **out, const uint8_t *rgb, uint32_t width_px,
			 uint32_t height_px, uint32_t fragment_px, const bool *used, uint8_t best)
{
	struct fragment_jpeg *jpeg;
	int rc;

	*out = NULL;
	if (width_px == 0 || height_px == 0 || width_px > FRAGMENT_JPEG_SIDE_MOST_PX ||
	    height_px > FRAGMENT_JPEG_SIDE_MOST_PX || fragment_px == 0 ||
	    fragment_px % FRAGMENT_JPEG_UNIT_PX != 0 || best == 0 ||
	    best > FRAGMENT_JPEG_QUALITY_MOST)
		return -EINVAL;
	jpeg = calloc(1, sizeof(*jpeg));
	if (!jpeg)
		return -ENOMEM;
	rc = coefficients_init(&jpeg->coefficients, width_px, height_px,
			       fragment_px / FRAGMENT_JPEG_UNIT_PX, used);
	jpeg->coefficients.best = best;
	if (rc == 0)
		rc = read_picture(&jpeg->coefficients, rgb);
	if (rc == 0) {
		drop_unused(&jpeg->coefficients);
		rc = coefficient_bytes(&jpeg->bytes, &jpeg->coefficients);
	}
	if (rc < 0) {
		fragment_jpeg_destroy(jpeg);
		return rc;
	}
	*out = jpeg;
	return 0;
}

void fragment_jpeg_destroy(struct fragment_jpeg *jpeg)
{
	if (!jpeg)
		return;
	coefficients_finish(&jpeg->coefficients);
	free(jpeg->bytes);
	free(jpeg);
}

uint32_t fragment_jpeg_count(const struct fragment_jpeg *jpeg)
{
	return jpeg->coefficients.columns * jpeg->coefficients.rows;
}

static uint8_t within(uint8_t quality)
{
	if (quality < 1)
		return 1;
	return quality < FRAGMENT_JPEG_QUALITY_MOST ? quality : FRAGMENT_JPEG_QUALITY_MOST;
}

uint32_t fragment_jpeg_bytes(const struct fragment_jpeg *jpeg, uint32_t fragment, uint8_t quality)
{
	return coefficient_bytes_at(jpeg->bytes + (size_t)fragment * COEFFICIENT_KNOTS,
				    within(quality));
}

/* ---- coefficients to the file */

/* The first scan has the mean of each block, then each component has one. A division as libjpeg
 * makes it by default saves 2 to 4 % at quality 95, but adds far more where most
 * coefficients are zero: each bit of a mean in a scan of its own is not compressed. */
static const jpeg_scan_info scans[] = {
	{ .comps_in_scan = 3, .component_index = { 0, 1, 2 }, .Ss = 0, .Se = 0 },
	{ .comps_in_scan = 1, .component_index = { 0 }, .Ss = 1, .Se = 63 },
	{ .comps_in_scan = 1, .component_index = { 1 }, .Ss = 1, .Se = 63 },
	{ .comps_in_scan = 1, .component_index = { 2 }, .Ss = 1, .Se = 63 },
};

/* Writes the blocks of a row of units. mean: of the block before, which unused fragments repeat. */
static void put_unit_row(const struct fragment_jpeg *jpeg, const uint8_t *qualities,
			 const struct coefficient_plane *plane, uint32_t unit_row, JBLOCKARRAY rows,
			 JCOEF *mean)
{
	const struct coefficients *coefficients = &jpeg->coefficients;
	struct unit_order at = { .unit_row = unit_row };

	while (unit_order_next(&at, coefficients, plane)) {
		uint32_t fragment = coefficients_fragment(coefficients, at.unit_column, unit_row);
		const uint8_t *factors =
			coefficients->factors[within(qualities[fragment])][plane->table];
		const int16_t *from = coefficients_of(plane, at.column, at.row);
		JCOEF *to = rows[at.row - unit_row * plane->unit_blocks][at.column];

		for (int k = 0; k < COEFFICIENTS_OF_BLOCK; k++)
			to[k] = (JCOEF)(from[k] == 0 ? 0 : coefficient_round(from[k], factors[k]));
		if (!coefficients->used[fragment])
			to[0] = *mean;
		*mean = to[0];
	}
}

static void put_plane(const struct fragment_jpeg *jpeg, const uint8_t *qualities, int plane_index,
		      j_compress_ptr codec, jvirt_barray_ptr array)
{
	const struct coefficient_plane *plane = &jpeg->coefficients.planes[plane_index];
	JCOEF mean = 0;

	for (uint32_t row = 0; row < jpeg->coefficients.unit_rows; row++)
		put_unit_row(jpeg, qualities, plane, row,
			     codec->mem->access_virt_barray((j_common_ptr)codec, array,
							    row * plane->unit_blocks,
							    plane->unit_blocks, TRUE),
			     &mean);
}

static int write_coefficients(struct writer *writer, const struct fragment_jpeg *jpeg,
			      const uint8_t *qualities)
{
	j_compress_ptr codec = &writer->codec;

	if (setjmp(writer->errors.jump) == 0) {
		jvirt_barray_ptr arrays[COEFFICIENT_PLANES];

		writer_begin(writer, &jpeg->coefficients);
		codec->scan_info = scans;
		codec->num_scans = ARRAY_COUNT(scans);
		codec->optimize_coding = TRUE;
		for (int i = 0; i < COEFFICIENT_PLANES; i++) {
			uint32_t side = jpeg->coefficients.planes[i].unit_blocks;

			arrays[i] = codec->mem->request_virt_barray(
				(j_common_ptr)codec, JPOOL_IMAGE, TRUE,
				jpeg->coefficients.unit_columns * side,
				jpeg->coefficients.unit_rows * side, side);
		}
		/* This gives the arrays their memory; the file is written by the last call. */
		jpeg_write_coefficients(codec, arrays);
		for (int i = 0; i < COEFFICIENT_PLANES; i++)
			put_plane(jpeg, qualities, i, codec, arrays[i]);
		jpeg_finish_compress(codec);
	}
	jpeg_destroy_compress(codec);
	return writer->errors.rc < 0 ? writer->errors.rc : writer->out->error;
}

int fragment_jpeg_write(const struct fragment_jpeg *jpeg, const uint8_t *qualities,
			struct buffer *out)
{
	struct writer writer;
	size_t before = out->size;
	int rc;

	writer_init(&writer, out);
	rc = write_coefficients(&writer, jpeg, qualities);
	if (rc < 0)
		out->size = before;
	return rc;
}
