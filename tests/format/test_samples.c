#include <errno.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "format/samples.h"
#include "tests/check.h"

static uint32_t children[8];

static struct samples_page a_page(void)
{
	struct samples_page page = { .origin_m = { -1, -2, 0 },
				     .spacing_m = { 0.5f, 0.5f, 0.25f },
				     .count = { 8, 5, 3 },
				     .level_count = 3,
				     .bricks = { 2, 2, 1 },
				     .brick_child = children };

	children[0] = 0;
	children[1] = SAMPLE_NONE;
	children[2] = 1;
	children[3] = 2;
	return page;
}

/* Decodes every proper prefix of wire in an allocation of its exact size. */
static void refuses_prefixes(struct bytes wire, int (*decode)(struct bytes))
{
	for (size_t n = 0; n < wire.size; n++) {
		uint8_t *exact = malloc(n ? n : 1);

		memcpy(exact, wire.data, n);
		CHECK(decode((struct bytes){ exact, n }) == -EBADMSG);
		free(exact);
	}
}

static int decode_samples(struct bytes payload)
{
	struct samples_page page;
	int rc = samples_page_decode(&page, payload);

	samples_page_finish(&page);
	return rc;
}

static int decode_brick(struct bytes payload)
{
	static struct brick_page brick;

	return brick_page_decode(&brick, payload);
}

static int decode_face(struct bytes payload)
{
	static struct face_page face;

	return face_page_decode(&face, payload);
}

static void keeps_vantage_points(void **state)
{
	struct samples_page page = a_page(), back;
	struct bytes wire;
	struct buffer out;

	(void)state;
	page.vantage_count = 2;
	page.vantage_m[1][0] = 4.5f;
	children[4] = 3;
	buffer_init(&out, 1000);
	samples_page_encode(&out, &page);
	wire = buffer_bytes(&out);
	CHECK(samples_page_bricks(&page) == 5);
	CHECK(samples_page_decode(&back, wire) == 0);
	CHECK(back.vantage_count == 2 && back.vantage_m[1][0] == 4.5f && back.brick_child[4] == 3);
	samples_page_finish(&back);
	/* Without its end it is a page without vantage points; between the two it is none. */
	for (size_t less = 1; less < 25; less++) {
		const int rc = decode_samples((struct bytes){ wire.data, wire.size - less });

		CHECK(rc == -EBADMSG);
	}
	CHECK(decode_samples((struct bytes){ wire.data, wire.size - 25 }) == 0);
	out.data[wire.size - 25] = SAMPLE_VANTAGES_MAX + 1;
	CHECK(decode_samples(wire) == -EBADMSG);
	out.data[wire.size - 25] = 0;
	CHECK(decode_samples(wire) == -EBADMSG);
	out.data[wire.size - 25] = 2;
	memcpy(&out.data[wire.size - 4], "\0\0\xc0\x7f", 4); /* not a number */
	CHECK(decode_samples(wire) == -EBADMSG);
	buffer_finish(&out);
}

static void keeps_the_samples_page(void **state)
{
	struct samples_page page = a_page(), back;
	struct buffer wire;

	(void)state;
	buffer_init(&wire, 1000);
	samples_page_encode(&wire, &page);
	CHECK(wire.error == 0);
	CHECK(samples_page_decode(&back, buffer_bytes(&wire)) == 0);
	CHECK(memcmp(back.origin_m, page.origin_m, sizeof(page.origin_m)) == 0);
	CHECK(memcmp(back.spacing_m, page.spacing_m, sizeof(page.spacing_m)) == 0);
	CHECK(memcmp(back.count, page.count, 3) == 0 && back.level_count == 3);
	CHECK(memcmp(back.bricks, page.bricks, sizeof(page.bricks)) == 0);
	CHECK(memcmp(back.brick_child, children, 4 * sizeof(*children)) == 0);
	samples_page_finish(&back);
	refuses_prefixes(buffer_bytes(&wire), decode_samples);
	buffer_put_u8(&wire, 0);
	CHECK(decode_samples(buffer_bytes(&wire)) == -EBADMSG);
	buffer_finish(&wire);
}

static void refuses_impossible_grids(void **state)
{
	static const struct {
		size_t at;
		uint8_t byte;
	} faults[] = {
		{ 15, 0xbf }, /* spacing below nought */
		{ 3, 0x7f },  /* origin beyond what is finite, with the next byte */
		{ 24, 0 },    /* no points */
		{ 25, 65 },   /* too many */
		{ 27, 0 },    /* no level */
		{ 27, SAMPLE_LEVELS_MAX + 1 }, /* too many levels */
		{ 28, 0x1d },                  /* a fifth brick of four */
	};
	struct samples_page page = a_page();
	struct buffer wire;

	(void)state;
	for (size_t i = 0; i < ARRAY_COUNT(faults); i++) {
		buffer_init(&wire, 1000);
		samples_page_encode(&wire, &page);
		CHECK(decode_samples(buffer_bytes(&wire)) == 0);
		wire.data[faults[i].at] = faults[i].byte;
		if (faults[i].at == 3)
			wire.data[2] = 0xff;
		CHECK(decode_samples(buffer_bytes(&wire)) == -EBADMSG);
		buffer_finish(&wire);
	}
}

static void keeps_a_brick_and_errs_on_the_safe_side(void **state)
{
	static struct brick_page brick, back;
	struct buffer wire;
	uint32_t next = 0;

	(void)state;
	for (uint32_t i = 0; i < BRICK_POINTS * CUBE_FACES; i++) {
		uint32_t p = i / CUBE_FACES, f = i % CUBE_FACES;
		bool there = i % 5 != 0;

		brick.face_child[p][f] = there ? next++ : SAMPLE_NONE;
		brick.coverage[p][f] = there ? (uint16_t)(i + 1) : 0;
		brick.near_m[p][f] = there ? 0.1f + (float)i * 0.0371f : 0;
		brick.far_m[p][f] = there ? brick.near_m[p][f] * 3.3f : 0;
	}
	buffer_init(&wire, 10000);
	brick_page_encode(&wire, &brick);
	CHECK(brick_page_decode(&back, buffer_bytes(&wire)) == 0);
	CHECK(memcmp(back.face_child, brick.face_child, sizeof(back.face_child)) == 0);
	CHECK(memcmp(back.coverage, brick.coverage, sizeof(back.coverage)) == 0);
	for (uint32_t i = 0; i < BRICK_POINTS * CUBE_FACES; i++) {
		float near = (&brick.near_m[0][0])[i], far = (&brick.far_m[0][0])[i];

		CHECK((&back.near_m[0][0])[i] <= near);
		CHECK((&back.near_m[0][0])[i] >= near * 127 / 128);
		CHECK((&back.far_m[0][0])[i] >= far && (&back.far_m[0][0])[i] <= far * 129 / 128);
	}
	refuses_prefixes(buffer_bytes(&wire), decode_brick);
	wire.data[48] = wire.data[49] = 0; /* the first face there, showing nothing */
	CHECK(decode_brick(buffer_bytes(&wire)) == -EBADMSG);
	buffer_finish(&wire);
}

static void keeps_a_face(void **state)
{
	static struct face_page face, back;
	struct buffer wire;
	uint32_t next = 0;

	(void)state;
	face.level_count = 3;
	for (uint32_t i = 0; i < FACE_TILES_MAX; i++)
		face.tile_child[i] = i < 21 && i % 3 ? next++ : SAMPLE_NONE;
	buffer_init(&wire, 1000);
	face_page_encode(&wire, &face);
	CHECK(wire.size == 4);
	CHECK(face_page_decode(&back, buffer_bytes(&wire)) == 0);
	CHECK(back.level_count == 3);
	CHECK(memcmp(back.tile_child, face.tile_child, sizeof(back.tile_child)) == 0);
	refuses_prefixes(buffer_bytes(&wire), decode_face);
	wire.data[3] |= 0x80; /* a tile past the last */
	CHECK(decode_face(buffer_bytes(&wire)) == -EBADMSG);
	buffer_finish(&wire);
}

static void numbers_tiles_from_the_coarsest(void **state)
{
	uint32_t expected = 0;

	(void)state;
	for (uint32_t level = 0; level < SAMPLE_LEVELS_MAX; level++) {
		for (uint32_t n = 0; n < 1u << 2 * level; n++) {
			uint32_t row, column;

			face_tile_place(level, expected, &row, &column);
			CHECK(row < 1u << level && column < 1u << level);
			CHECK(face_tile_index(level, row, column) == expected++);
		}
	}
	CHECK(expected == FACE_TILES_MAX);
}

static void numbers_of_a_square_of_tiles_follow_one_another(void **state)
{
	(void)state;
	for (uint32_t row = 0; row < 16; row += 4)
		for (uint32_t column = 0; column < 16; column += 4) {
			uint32_t first = face_tile_index(4, row, column);

			for (uint32_t k = 0; k < 16; k++)
				CHECK(face_tile_index(4, row + k / 4, column + k % 4) - first < 16);
		}
	CHECK(face_tile_index(2, 0, 3) == 1 + 4 + 5 && face_tile_index(2, 3, 0) == 1 + 4 + 10);
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(keeps_the_samples_page),
		cmocka_unit_test(keeps_vantage_points),
		cmocka_unit_test(refuses_impossible_grids),
		cmocka_unit_test(keeps_a_brick_and_errs_on_the_safe_side),
		cmocka_unit_test(keeps_a_face),
		cmocka_unit_test(numbers_tiles_from_the_coarsest),
		cmocka_unit_test(numbers_of_a_square_of_tiles_follow_one_another),
	};

	return cmocka_run_group_tests(tests, NULL, NULL);
}
