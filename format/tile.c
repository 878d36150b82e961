#include "format/tile.h"

#include <errno.h>
#include <setjmp.h>
#include <stddef.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <jpeglib.h>

enum { SIDE_PX_MOST = 4096, OUTPUT_CHUNK_BYTES = 16 * 1024 };

/* libjpeg leaves by longjmp; this is the one door through which it does. */
struct jpeg_door {
	struct jpeg_error_mgr manager; /* first: libjpeg hands us only this */
	jmp_buf out;
};

struct jpeg_sink {
	struct jpeg_destination_mgr manager; /* first */
	uint8_t chunk[OUTPUT_CHUNK_BYTES];
	struct buffer *buffer; /* borrowed */
};

struct tile_codec {
	bool encoding;
	struct jpeg_door door;
	struct jpeg_sink sink;
	struct jpeg_compress_struct encoder;
	struct jpeg_decompress_struct decoder;
	bool chroma_full;
	int quality;
	uint8_t *tables; /* owned; of a decoder */
	size_t tables_size;
};

static void leave(j_common_ptr info)
{
	struct jpeg_door *door = (struct jpeg_door *)info->err;

	longjmp(door->out, 1);
}

/* A warning means damaged data: libjpeg would go on and draw grey. */
static void judge_message(j_common_ptr info, int level)
{
	if (level < 0)
		leave(info);
}

static void stay_silent(j_common_ptr info)
{
	(void)info;
}

static struct jpeg_error_mgr *open_door(struct jpeg_door *door)
{
	jpeg_std_error(&door->manager);
	door->manager.error_exit = leave;
	door->manager.emit_message = judge_message;
	door->manager.output_message = stay_silent;
	return &door->manager;
}

static void sink_start(j_compress_ptr encoder)
{
	struct jpeg_sink *sink = (struct jpeg_sink *)encoder->dest;

	sink->manager.next_output_byte = sink->chunk;
	sink->manager.free_in_buffer = sizeof(sink->chunk);
}

static boolean sink_full(j_compress_ptr encoder)
{
	struct jpeg_sink *sink = (struct jpeg_sink *)encoder->dest;

	buffer_put(sink->buffer, sink->chunk, sizeof(sink->chunk));
	sink_start(encoder);
	return TRUE;
}

static void sink_end(j_compress_ptr encoder)
{
	struct jpeg_sink *sink = (struct jpeg_sink *)encoder->dest;

	buffer_put(sink->buffer, sink->chunk, sizeof(sink->chunk) - sink->manager.free_in_buffer);
}

static void source_nothing(j_decompress_ptr decoder)
{
	(void)decoder;
}

/* The object ends before the picture does. */
static boolean source_empty(j_decompress_ptr decoder)
{
	leave((j_common_ptr)decoder);
	return FALSE;
}

static void source_skip(j_decompress_ptr decoder, long count)
{
	struct jpeg_source_mgr *source = decoder->src;

	if (count <= 0)
		return;
	if ((size_t)count > source->bytes_in_buffer)
		leave((j_common_ptr)decoder);
	source->next_input_byte += count;
	source->bytes_in_buffer -= (size_t)count;
}

static void source_set(struct jpeg_source_mgr *source, struct bytes bytes)
{
	*source = (struct jpeg_source_mgr){
		.next_input_byte = bytes.data,
		.bytes_in_buffer = bytes.size,
		.init_source = source_nothing,
		.fill_input_buffer = source_empty,
		.skip_input_data = source_skip,
		.resync_to_restart = jpeg_resync_to_restart,
		.term_source = source_nothing,
	};
}

/* Nearly flat, colour as fine as light: a tile is seen from any distance and blended with others,
 * so the tables that JPEG's authors made for an eye before a screen do not fit (docs/samples.md:
 * 1.2 dB for the same bytes). */
static void set_quantisation(struct jpeg_compress_struct *encoder, int quality)
{
	unsigned table[DCTSIZE2];

	for (unsigned i = 0; i < DCTSIZE2; i++)
		table[i] = 24 + (i / DCTSIZE + i % DCTSIZE) * 6 / 5;
	for (int which = 0; which < 2; which++)
		jpeg_add_quant_table(encoder, which, table, jpeg_quality_scaling(quality), TRUE);
}

/* Everything that shapes the tables, so that tables and tiles agree. */
static void set_up_encoder(struct tile_codec *codec, uint32_t side_px)
{
	struct jpeg_compress_struct *encoder = &codec->encoder;

	encoder->image_width = side_px;
	encoder->image_height = side_px;
	encoder->input_components = 3;
	encoder->in_color_space = JCS_RGB;
	jpeg_set_defaults(encoder);
	set_quantisation(encoder, codec->quality);
	encoder->arith_code = TRUE; /* docs/samples.md: 7 % fewer bytes for 0.3 ms */
	encoder->write_JFIF_header = FALSE;
	encoder->dct_method = JDCT_ISLOW;
	encoder->comp_info[0].h_samp_factor = codec->chroma_full ? 1 : 2;
	encoder->comp_info[0].v_samp_factor = codec->chroma_full ? 1 : 2;
}

int tile_encoder_create(struct tile_codec **out, int quality, bool chroma_full)
{
	struct tile_codec *codec = calloc(1, sizeof(*codec));

	*out = NULL;
	if (!codec)
		return -ENOMEM;
	codec->encoding = true;
	codec->quality = quality;
	codec->chroma_full = chroma_full;
	codec->encoder.err = open_door(&codec->door);
	if (setjmp(codec->door.out)) {
		tile_codec_destroy(codec);
		return -ENOMEM;
	}
	jpeg_create_compress(&codec->encoder);
	codec->sink.manager.init_destination = sink_start;
	codec->sink.manager.empty_output_buffer = sink_full;
	codec->sink.manager.term_destination = sink_end;
	codec->encoder.dest = &codec->sink.manager;
	set_up_encoder(codec, 8);
	*out = codec;
	return 0;
}

int tile_encoder_tables(struct tile_codec *codec, struct buffer *out)
{
	codec->sink.buffer = out;
	if (setjmp(codec->door.out)) {
		jpeg_abort_compress(&codec->encoder);
		return -EIO;
	}
	set_up_encoder(codec, 8);
	jpeg_suppress_tables(&codec->encoder, FALSE);
	jpeg_write_tables(&codec->encoder);
	return out->error;
}

int tile_encode(struct tile_codec *codec, struct buffer *out, const uint8_t *rgb, uint32_t side_px)
{
	struct jpeg_compress_struct *encoder = &codec->encoder;

	if (side_px == 0 || side_px > SIDE_PX_MOST)
		return -EINVAL;
	codec->sink.buffer = out;
	if (setjmp(codec->door.out)) {
		jpeg_abort_compress(encoder);
		return -EIO;
	}
	set_up_encoder(codec, side_px);
	jpeg_suppress_tables(encoder, TRUE);
	jpeg_start_compress(encoder, FALSE);
	while (encoder->next_scanline < side_px) {
		JSAMPROW row =
			(JSAMPROW)(uintptr_t)(rgb + (size_t)encoder->next_scanline * side_px * 3);

		jpeg_write_scanlines(encoder, &row, 1);
	}
	jpeg_finish_compress(encoder);
	return out->error;
}

/* Into the decoder's state; inside the door. Each tile starts from the shared tables again, so
 * that a tile with tables of its own spoils no other. */
static bool read_tables(struct tile_codec *codec)
{
	struct jpeg_source_mgr source;
	bool only_tables;

	source_set(&source, (struct bytes){ codec->tables, codec->tables_size });
	codec->decoder.src = &source;
	only_tables = jpeg_read_header(&codec->decoder, FALSE) == JPEG_HEADER_TABLES_ONLY;
	codec->decoder.src = NULL;
	return only_tables && source.bytes_in_buffer == 0;
}

int tile_decoder_create(struct tile_codec **out, struct bytes tables)
{
	struct tile_codec *codec = calloc(1, sizeof(*codec));

	*out = NULL;
	if (!codec)
		return -ENOMEM;
	codec->tables = malloc(tables.size ? tables.size : 1);
	if (!codec->tables) {
		free(codec);
		return -ENOMEM;
	}
	if (tables.size)
		memcpy(codec->tables, tables.data, tables.size);
	codec->tables_size = tables.size;
	codec->decoder.err = open_door(&codec->door);
	if (setjmp(codec->door.out)) {
		tile_codec_destroy(codec);
		return -EBADMSG;
	}
	jpeg_create_decompress(&codec->decoder);
	if (!read_tables(codec)) {
		tile_codec_destroy(codec);
		return -EBADMSG;
	}
	*out = codec;
	return 0;
}

/* Sequential, one scan, three components: what bounds the time a hostile tile can take. */
static bool acceptable(const struct jpeg_decompress_struct *decoder, uint32_t side_px)
{
	return decoder->image_width == side_px && decoder->image_height == side_px &&
	       decoder->num_components == 3 && decoder->data_precision == 8 &&
	       !decoder->progressive_mode && decoder->comps_in_scan == 3;
}

int tile_decode(struct tile_codec *codec, uint8_t *rgb, uint32_t side_px, struct bytes object)
{
	struct jpeg_decompress_struct *decoder = &codec->decoder;
	struct jpeg_source_mgr source;

	if (side_px == 0 || side_px > SIDE_PX_MOST)
		return -EINVAL;
	if (setjmp(codec->door.out))
		goto bad;
	if (!read_tables(codec))
		goto bad;
	source_set(&source, object);
	decoder->src = &source;
	if (jpeg_read_header(decoder, TRUE) != JPEG_HEADER_OK || !acceptable(decoder, side_px))
		goto bad;
	decoder->out_color_space = JCS_RGB;
	jpeg_start_decompress(decoder);
	while (decoder->output_scanline < side_px) {
		JSAMPROW row = rgb + (size_t)decoder->output_scanline * side_px * 3;

		jpeg_read_scanlines(decoder, &row, 1);
	}
	jpeg_finish_decompress(decoder);
	decoder->src = NULL;
	if (source.bytes_in_buffer == 0)
		return 0;
bad:
	jpeg_abort_decompress(decoder);
	decoder->src = NULL;
	return -EBADMSG;
}

void tile_codec_destroy(struct tile_codec *codec)
{
	if (!codec)
		return;
	if (codec->encoding)
		jpeg_destroy_compress(&codec->encoder);
	else
		jpeg_destroy_decompress(&codec->decoder);
	free(codec->tables);
	free(codec);
}
