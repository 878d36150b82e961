#include "format/picture.h"

#include <errno.h>
#include <stdlib.h>
#include <string.h>

#include "tests/check.h"

enum { SIDE = 24 };

static struct picture gradient(void)
{
	struct picture picture = { .width = SIDE, .height = SIDE, .rgba = malloc(SIDE * SIDE * 4) };

	for (int i = 0; i < SIDE * SIDE; i++) {
		picture.rgba[4 * i] = (uint8_t)(i % SIDE * 10);
		picture.rgba[4 * i + 1] = (uint8_t)(i / SIDE * 10);
		picture.rgba[4 * i + 2] = 90;
		picture.rgba[4 * i + 3] = i % 7 ? 255 : 40;
	}
	return picture;
}

static void png_gives_every_pixel_back(void **state)
{
	struct picture picture = gradient(), back;
	struct buffer file;

	(void)state;
	buffer_init(&file, 1 << 20);
	CHECK(picture_encode_png(&file, &picture) == 0);
	CHECK(picture_decode(&back, buffer_bytes(&file)) == 0);
	CHECK(back.width == SIDE && back.height == SIDE);
	CHECK(memcmp(back.rgba, picture.rgba, SIDE * SIDE * 4) == 0);
	picture_finish(&back);
	picture_finish(&picture);
	buffer_finish(&file);
}

static void jpeg_is_near_and_opaque(void **state)
{
	struct picture picture = gradient(), back;
	struct buffer file;

	(void)state;
	buffer_init(&file, 1 << 20);
	CHECK(picture_encode_jpeg(&file, &picture, 95) == 0);
	CHECK(picture_decode(&back, buffer_bytes(&file)) == 0);
	for (int i = 0; i < SIDE * SIDE; i++) {
		CHECK(abs(back.rgba[4 * i] - picture.rgba[4 * i]) < 16);
		CHECK(back.rgba[4 * i + 3] == 255);
	}
	picture_finish(&back);
	picture_finish(&picture);
	buffer_finish(&file);
}

/* Every truncation, in memory of its exact size. */
static void a_full_buffer_keeps_what_it_had(void **state)
{
	struct picture picture = { 400, 300, malloc(4 * 400 * 300) };
	struct buffer file;

	(void)state;
	for (uint32_t i = 0; i < 4 * 400 * 300; i++)
		picture.rgba[i] = (uint8_t)(i * 2654435761u >> 24);
	buffer_init(&file, 40000); /* chunks of 16 KiB: two fit */
	buffer_put_text(&file, "before");
	assert_int_equal(picture_encode_jpeg(&file, &picture, 95), -EFBIG);
	CHECK(file.size == 6 && memcmp(file.data, "before", 6) == 0);
	buffer_finish(&file);
	picture_finish(&picture);
}

static void check_truncations(const struct buffer *file, size_t may_miss)
{
	for (size_t n = 0; n + may_miss < file->size; n++) {
		uint8_t *exact = malloc(n ? n : 1);
		struct picture back;

		memcpy(exact, file->data, n);
		CHECK(picture_decode(&back, (struct bytes){ exact, n }) == -EBADMSG);
		CHECK(back.rgba == NULL);
		free(exact);
	}
}

/* The frame header of a JPEG: 0xff 0xc0, u16 size, u8 bits, u16 height, u16 width, big endian. */
static uint8_t *frame_header(struct buffer *file)
{
	for (size_t i = 0; i + 9 < file->size; i++)
		if (file->data[i] == 0xff && file->data[i + 1] == 0xc0)
			return file->data + i;
	return NULL;
}

/* A progressive picture of 65500 pixels square would have libjpeg take 24 GiB. */
static void refuses_a_huge_jpeg_before_room_is_made_for_it(void **state)
{
	struct picture picture = gradient(), back;
	struct buffer file;
	uint8_t *frame;

	(void)state;
	buffer_init(&file, 1 << 20);
	CHECK(picture_encode_jpeg(&file, &picture, 95) == 0);
	frame = frame_header(&file);
	CHECK(frame);
	frame[1] = 0xc2; /* progressive */
	frame[5] = frame[7] = 0xff;
	frame[6] = frame[8] = 0xdc;
	CHECK(picture_decode(&back, buffer_bytes(&file)) == -EFBIG);
	CHECK(back.rgba == NULL);
	frame[5] = 0x10; /* 4097 rows: a texture may, a page's picture may not */
	frame[6] = 0x01;
	frame[7] = 0;
	frame[8] = 16;
	CHECK(picture_decode_for_page(&back, buffer_bytes(&file)) == -EFBIG);
	CHECK(picture_decode(&back, buffer_bytes(&file)) == -EBADMSG); /* it has not as many */
	picture_finish(&picture);
	buffer_finish(&file);
}

/* libpng would make room for 2 GiB. */
static void refuses_a_png_with_a_chunk_longer_than_the_file(void **state)
{
	static const uint8_t chunk[] = { 0x7f, 0xff, 0xff, 0xff, 'z', 'T', 'X', 't', 'k', 0, 0, 1 };
	enum { HEADER_BYTES = 8 + 12 + 13 };
	struct picture picture = gradient(), back;
	struct buffer file, longer;

	(void)state;
	buffer_init(&file, 1 << 20);
	buffer_init(&longer, 1 << 20);
	CHECK(picture_encode_png(&file, &picture) == 0);
	buffer_put(&longer, file.data, HEADER_BYTES);
	buffer_put(&longer, chunk, sizeof(chunk));
	buffer_put(&longer, file.data + HEADER_BYTES, file.size - HEADER_BYTES);
	CHECK(picture_decode(&back, buffer_bytes(&longer)) == -EBADMSG);
	CHECK(back.rgba == NULL);
	picture_finish(&picture);
	buffer_finish(&longer);
	buffer_finish(&file);
}

static void refuses_every_truncated_file(void **state)
{
	struct picture picture = gradient();
	struct buffer file;

	(void)state;
	buffer_init(&file, 1 << 20);
	CHECK(picture_encode_png(&file, &picture) == 0);
	check_truncations(&file, 12); /* the IEND chunk says nothing more */
	buffer_clear(&file);
	CHECK(picture_encode_jpeg(&file, &picture, 90) == 0);
	check_truncations(&file, 2); /* the end-of-image marker */
	picture_finish(&picture);
	buffer_finish(&file);
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(png_gives_every_pixel_back),
		cmocka_unit_test(jpeg_is_near_and_opaque),
		cmocka_unit_test(a_full_buffer_keeps_what_it_had),
		cmocka_unit_test(refuses_a_huge_jpeg_before_room_is_made_for_it),
		cmocka_unit_test(refuses_a_png_with_a_chunk_longer_than_the_file),
		cmocka_unit_test(refuses_every_truncated_file),
	};

	return cmocka_run_group_tests(tests, NULL, NULL);
}
