#include "render/patches/stream_growth.h"

#include <errno.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "pipeline/hierarchy/stream_encode.h"
#include "tests/check.h"

enum { SIDE = 60, PLACES = SIDE * SIDE, TILES = 2 * (SIDE - 1) * (SIDE - 1), BLOCKS_MAX = 8 };

struct made {
	struct buffer page, stream;
	struct bytes blocks[BLOCKS_MAX];
	uint32_t block_count;
};

/* A sheet of hills and a loose piece, as the page and blocks of a release. */
static void make(struct made *made)
{
	static struct patch_vertex vertices[PLACES + 3];
	static uint32_t triangles[TILES + 1][3];
	const struct stream_options options = { .base_vertices = 500, .loose = true };
	static struct stream_stats stats;
	struct page_child children[BLOCKS_MAX];
	struct page page = { .kind = PAGE_STREAM, .children = children };
	float errors_m[BLOCKS_MAX + 1];
	struct buffer payload;
	struct bytes start;
	uint32_t count = 0;
	size_t at;

	for (uint32_t i = 0; i < PLACES; i++) {
		const double x = i % SIDE, y = i / SIDE;

		vertices[i].position[0] = (int32_t)(500 * x);
		vertices[i].position[1] = (int32_t)(500 * y);
		vertices[i].position[2] = (int32_t)(5000 + 2000 * sin(x / 5) * cos(y / 7));
		vertices[i].colour[0] = (uint8_t)(4 * x);
	}
	for (uint32_t i = 0; i < 3; i++)
		for (int k = 0; k < 3; k++)
			vertices[PLACES + i].position[k] = 40000 + (i == (uint32_t)k ? 30 : 0);
	for (uint32_t y = 0; y + 1 < SIDE; y++)
		for (uint32_t x = 0; x + 1 < SIDE; x++) {
			const uint32_t a = y * SIDE + x;

			memcpy(triangles[count++], (uint32_t[]){ a, a + 1, a + SIDE }, 12);
			memcpy(triangles[count++], (uint32_t[]){ a + 1, a + SIDE + 1, a + SIDE },
			       12);
		}
	memcpy(triangles[count++], (uint32_t[]){ PLACES, PLACES + 1, PLACES + 2 }, 12);
	buffer_init(&made->stream, 1 << 22);
	buffer_init(&made->page, PAGE_BYTES_MAX);
	buffer_init(&payload, PAGE_BYTES_MAX);
	CHECK(stream_make(&made->stream, &stats, vertices, PLACES + 3,
			  (const uint32_t(*)[3])triangles, count, &options) == 0);
	CHECK(stats.piece_count > 0);
	made->block_count = page.child_count = stream_block_count(stats.record_count);
	CHECK(page.child_count >= 3 && page.child_count <= BLOCKS_MAX);
	start = (struct bytes){ made->stream.data,
				stream_start_bytes(buffer_bytes(&made->stream)) };
	at = start.size;
	for (uint32_t i = 0; i < page.child_count; i++) {
		struct bytes left = { made->stream.data + at, made->stream.size - at };

		made->blocks[i] = (struct bytes){ left.data, stream_block_bytes(left) };
		at += made->blocks[i].size;
		children[i] = (struct page_child){ hash_of(made->blocks[i]),
						   (uint32_t)made->blocks[i].size, false };
	}
	for (uint32_t i = 0; i <= page.child_count; i++)
		errors_m[i] = (float)stats.errors[i] / 1000;
	stream_page_encode(&payload, 1, errors_m, page.child_count, start);
	page.payload = buffer_bytes(&payload);
	page_encode(&made->page, &page);
	buffer_finish(&payload);
}

static void made_finish(struct made *made)
{
	buffer_finish(&made->page);
	buffer_finish(&made->stream);
}

/* The area of what is shown, which moving vertices may change only little by little. */
static double area(const struct stream_growth *growth)
{
	double sum = 0;

	for (uint32_t t = 0; t < growth->triangle_count; t++) {
		const float *p[3];
		double u[3], v[3], square = 0;

		for (int c = 0; c < 3; c++) {
			CHECK(growth->indices[3 * t + (uint32_t)c] < growth->vertex_count);
			p[c] = growth->shown[growth->indices[3 * t + (uint32_t)c]].place;
		}
		for (int i = 0; i < 3; i++) {
			u[i] = (double)(p[1][i] - p[0][i]);
			v[i] = (double)(p[2][i] - p[0][i]);
		}
		for (int i = 0; i < 3; i++) {
			const double n = u[i] * v[(i + 1) % 3] - u[(i + 1) % 3] * v[i];

			square += n * n;
		}
		sum += sqrt(square) / 2;
	}
	return sum;
}

static void grow(struct stream_growth *growth)
{
	struct stream_change change;

	for (int i = 0; i < 1000 && stream_growth_moves(growth); i++)
		stream_growth_step(growth, 50, &change);
	CHECK(!stream_growth_moves(growth));
}

static void grows_without_a_jump(void **state)
{
	struct stream_growth growth;
	struct stream_change change;
	struct made made;
	uint32_t base;

	(void)state;
	make(&made);
	CHECK(stream_growth_open(&growth, buffer_bytes(&made.page)) == 0);
	CHECK(stream_growth_moves(&growth) && growth.triangle_count == 0);
	stream_growth_step(&growth, 16, &change);
	CHECK(change.triangles && change.vertices == growth.vertex_count);
	CHECK(growth.triangle_count > 0 && !stream_growth_moves(&growth));
	base = growth.triangle_count;
	for (uint32_t i = 0; i < made.block_count; i++) {
		const double whole = area(&growth);
		double before = whole;

		CHECK(stream_growth_give(&growth, i, made.blocks[i]) == 0);
		stream_growth_step(&growth, 16, &change);
		/* More triangles, and still the same picture. */
		CHECK(change.triangles && growth.triangle_count > base);
		CHECK(fabs(area(&growth) - whole) < 1e-4 * whole);
		base = growth.triangle_count;
		while (stream_growth_moves(&growth)) {
			stream_growth_step(&growth, 10, &change);
			CHECK(!change.triangles && change.first_vertex > 0);
			CHECK(fabs(area(&growth) - before) < 0.05 * whole);
			before = area(&growth);
		}
	}
	CHECK(growth.triangle_count == TILES + 1 && growth.vertex_count == PLACES + 3);
	for (uint32_t v = 0; v < growth.vertex_count; v++)
		for (int i = 0; i < 3; i++)
			CHECK(growth.shown[v].place[i] ==
			      (float)stream_decoder_mesh(growth.decoder)->vertices[v].position[i]);
	stream_growth_finish(&growth);
	made_finish(&made);
}

static void takes_blocks_in_any_order(void **state)
{
	struct stream_growth growth;
	struct made made;

	(void)state;
	make(&made);
	CHECK(stream_growth_open(&growth, buffer_bytes(&made.page)) == 0);
	grow(&growth);
	for (uint32_t i = made.block_count; i-- > 1;)
		CHECK(stream_growth_give(&growth, i, made.blocks[i]) == 0);
	CHECK(!stream_growth_moves(&growth) && growth.block_count == 0);
	CHECK(stream_growth_give(&growth, 0, made.blocks[0]) == 0);
	CHECK(stream_growth_give(&growth, 0, made.blocks[0]) == 0); /* twice is fine */
	CHECK(growth.block_count == made.block_count);
	grow(&growth);
	CHECK(growth.triangle_count == TILES + 1);
	stream_growth_finish(&growth);
	made_finish(&made);
}

static void keeps_what_came_before_a_damaged_block(void **state)
{
	struct stream_growth growth;
	struct made made;
	uint32_t shown;

	(void)state;
	make(&made);
	CHECK(stream_growth_open(&growth, buffer_bytes(&made.page)) == 0);
	CHECK(stream_growth_give(&growth, 0, made.blocks[0]) == 0);
	grow(&growth);
	shown = growth.triangle_count;
	CHECK(stream_growth_give(&growth, 1, made.blocks[2]) == -EBADMSG);
	grow(&growth);
	CHECK(growth.triangle_count == shown && growth.damaged && growth.block_count == 1);
	CHECK(stream_growth_give(&growth, 2, made.blocks[2]) == 0); /* ignored */
	stream_growth_finish(&growth);
	CHECK(stream_growth_open(&growth, made.blocks[0]) == -EBADMSG);
	made.page.data[made.page.size - 20] ^= 1;
	CHECK(stream_growth_open(&growth, buffer_bytes(&made.page)) == -EBADMSG);
	made_finish(&made);
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(grows_without_a_jump),
		cmocka_unit_test(takes_blocks_in_any_order),
		cmocka_unit_test(keeps_what_came_before_a_damaged_block),
	};

	return cmocka_run_group_tests(tests, NULL, NULL);
}
