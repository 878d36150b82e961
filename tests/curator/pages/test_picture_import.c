#include "curator/pages/picture_import.h"

#include <errno.h>
#include <stdlib.h>
#include <string.h>
#include <webp/encode.h>

#include "curator/pages/exif_orientation.h"
#include "format/jpeg_to_buffer.h"
#include "format/picture.h"
#include "tests/check.h"

/* Red at the left, blue at the right; the upper half is bright. */
static struct picture make_picture(uint32_t width, uint32_t height)
{
	struct picture picture = { width, height, malloc((size_t)width * height * 4) };

	CHECK(picture.rgba);
	for (uint32_t y = 0; y < height; y++)
		for (uint32_t x = 0; x < width; x++) {
			const uint8_t light = y < height / 2 ? 250 : 120;
			uint8_t *p = picture.rgba + 4 * ((size_t)y * width + x);

			p[0] = x < width / 2 ? light : 0;
			p[1] = 0;
			p[2] = x < width / 2 ? 0 : light;
			p[3] = 255;
		}
	return picture;
}

/* A JPEG of 64 by 32, whose EXIF says that orientation; 0: it has none. */
static void make_jpeg(struct buffer *out, uint8_t orientation)
{
	const uint8_t exif[] = { 0xff, 0xe1, 0, 34, 'E', 'x',         'i', 'f', 0, 0,    'M', 'M',
				 0,    42,   0, 0,  0,   8,           0,   1,   1, 0x12, 0,   3,
				 0,    0,    0, 1,  0,   orientation, 0,   0,   0, 0,    0,   0 };
	struct picture picture = make_picture(64, 32);
	struct buffer jpeg;

	buffer_init(&jpeg, 1 << 20);
	buffer_init(out, 1 << 20);
	CHECK(picture_encode_jpeg(&jpeg, &picture, 95) == 0);
	buffer_put(out, jpeg.data, 2);
	if (orientation)
		buffer_put(out, exif, sizeof(exif));
	buffer_put(out, jpeg.data + 2, jpeg.size - 2);
	CHECK(out->error == 0);
	buffer_finish(&jpeg);
	picture_finish(&picture);
}

static struct picture imported(const struct buffer *file, bool png)
{
	struct picture picture;
	struct buffer out;
	bool is_png;

	buffer_init(&out, 16 << 20);
	CHECK(picture_import(&out, &is_png, buffer_bytes(file), NULL) == 0);
	CHECK(is_png == png);
	CHECK(!memmem(out.data, out.size, "Exif", 4));
	CHECK(picture_decode(&picture, buffer_bytes(&out)) == 0);
	buffer_finish(&out);
	return picture;
}

/* Whether the corner is red or blue, bright or dark. Shares of the picture. */
static bool corner_is(const struct picture *picture, float x, float y, bool red, bool bright)
{
	const uint32_t column = (uint32_t)(x * (float)picture->width),
		       row = (uint32_t)(y * (float)picture->height);
	const uint8_t *p = picture->rgba + 4 * ((size_t)row * picture->width + column);
	const uint8_t light = p[0] > p[2] ? p[0] : p[2];

	return (p[0] > p[2]) == red && (light > 180) == bright;
}

/* What is at the upper left and upper right of the upright picture, of the file's four corners. */
static void photographs_are_turned_upright(void **state)
{
	static const struct {
		bool left_red, left_bright, right_red, right_bright;
	} tops[] = {
		{ true, true, false, true },   { false, true, true, true },
		{ false, false, true, false }, { true, false, false, false },
		{ true, true, true, false },   { true, false, true, true },
		{ false, false, false, true }, { false, true, false, false },
	};

	(void)state;
	for (uint8_t n = 1; n <= 8; n++) {
		struct picture picture;
		struct buffer file;

		make_jpeg(&file, n);
		CHECK(exif_orientation(buffer_bytes(&file)) == n);
		picture = imported(&file, false);
		CHECK(picture.width == (n < 5 ? 64 : 32) && picture.height == (n < 5 ? 32 : 64));
		CHECK(corner_is(&picture, 0.2f, 0.2f, tops[n - 1].left_red,
				tops[n - 1].left_bright));
		CHECK(corner_is(&picture, 0.8f, 0.2f, tops[n - 1].right_red,
				tops[n - 1].right_bright));
		picture_finish(&picture);
		buffer_finish(&file);
	}
}

static void orientations_that_do_not_exist_mean_nothing(void **state)
{
	struct buffer file;

	(void)state;
	make_jpeg(&file, 9);
	CHECK(exif_orientation(buffer_bytes(&file)) == 1);
	for (size_t n = 0; n < 60; n++) { /* every truncation of the head */
		uint8_t *exact = malloc(n ? n : 1);

		memcpy(exact, file.data, n);
		CHECK(exif_orientation((struct bytes){ exact, n }) == 1);
		free(exact);
	}
	buffer_finish(&file);
	make_jpeg(&file, 0);
	CHECK(exif_orientation(buffer_bytes(&file)) == 1);
	buffer_finish(&file);
}

/* A photograph for printing is complete, so to save it again as it is would not help. */
static void a_picture_for_printing_is_refused_by_its_colours(void **state)
{
	struct diagnostics diagnostics = { 0 };
	struct jpeg_compress_struct codec;
	struct jpeg_error_mgr errors;
	unsigned char *bytes = NULL;
	unsigned long size = 0;
	JSAMPLE cmyk[8] = { 0 };
	JSAMPROW row = cmyk;
	struct buffer out;
	bool is_png;

	(void)state;
	codec.err = jpeg_std_error(&errors);
	jpeg_create_compress(&codec);
	jpeg_mem_dest(&codec, &bytes, &size);
	codec.image_width = 2;
	codec.image_height = 1;
	codec.input_components = 4;
	codec.in_color_space = JCS_CMYK;
	jpeg_set_defaults(&codec);
	jpeg_start_compress(&codec, TRUE);
	jpeg_write_scanlines(&codec, &row, 1);
	jpeg_finish_compress(&codec);
	jpeg_destroy_compress(&codec);
	buffer_init(&out, 1 << 20);
	CHECK(picture_import(&out, &is_png, (struct bytes){ bytes, size }, &diagnostics) ==
	      -EBADMSG);
	CHECK(strstr(diagnostics.first.text, "CMYK"));
	buffer_finish(&out);
	free(bytes);
}

static void a_webp_becomes_what_pages_take(void **state)
{
	struct picture picture = make_picture(64, 32), again;
	struct buffer file;
	uint8_t *webp;
	size_t bytes;

	(void)state;
	buffer_init(&file, 1 << 20);
	bytes = WebPEncodeRGBA(picture.rgba, 64, 32, 256, 90, &webp);
	buffer_put(&file, webp, bytes);
	WebPFree(webp);
	again = imported(&file, false);
	CHECK(again.width == 64 && corner_is(&again, 0.2f, 0.2f, true, true));
	picture_finish(&again);
	buffer_clear(&file);
	bytes = WebPEncodeLosslessRGBA(picture.rgba, 64, 32, 256, &webp);
	buffer_put(&file, webp, bytes);
	WebPFree(webp);
	again = imported(&file, true);
	CHECK(again.width == 64 && memcmp(again.rgba, picture.rgba, 64 * 32 * 4) == 0);
	picture_finish(&again);
	picture_finish(&picture);
	buffer_finish(&file);
}

static void a_large_picture_is_made_smaller(void **state)
{
	struct picture picture = make_picture(4000, 20), again;
	struct buffer file;

	(void)state;
	buffer_init(&file, 1 << 20);
	CHECK(picture_encode_png(&file, &picture) == 0);
	again = imported(&file, true);
	CHECK(again.width == PICTURE_IMPORT_SIDE_MAX_PX && again.height == 19);
	CHECK(corner_is(&again, 0.2f, 0.2f, true, true));
	picture_finish(&again);
	picture_finish(&picture);
	buffer_finish(&file);
}

static void what_is_no_picture_is_refused(void **state)
{
	struct diagnostics diagnostics = { 0 };
	struct buffer file, out;
	bool is_png;

	(void)state;
	buffer_init(&out, 1 << 20);
	make_jpeg(&file, 0);
	CHECK(picture_import(&out, &is_png, (struct bytes){ 0 }, &diagnostics) == -EBADMSG);
	CHECK(diagnostics.first.text[0]);
	CHECK(picture_import(&out, &is_png, (struct bytes){ (const uint8_t *)"GIF89a", 6 }, NULL) ==
	      -EBADMSG);
	CHECK(picture_import(&out, &is_png, (struct bytes){ file.data, file.size / 2 }, NULL) ==
	      -EBADMSG);
	CHECK(out.size == 0);
	buffer_finish(&file);
	buffer_finish(&out);
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(photographs_are_turned_upright),
		cmocka_unit_test(orientations_that_do_not_exist_mean_nothing),
		cmocka_unit_test(a_picture_for_printing_is_refused_by_its_colours),
		cmocka_unit_test(a_webp_becomes_what_pages_take),
		cmocka_unit_test(a_large_picture_is_made_smaller),
		cmocka_unit_test(what_is_no_picture_is_refused),
	};

	return cmocka_run_group_tests(tests, NULL, NULL);
}
