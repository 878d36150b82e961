#include "pipeline/hierarchy/stream_encode.h"

#include <errno.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "format/normal.h"
#include "tests/check.h"

enum { SIDE = 40, TILES = SIDE * SIDE, PIECES = 60 };

struct soup {
	struct patch_vertex *vertices;
	uint32_t (*triangles)[3];
	uint32_t vertex_count, triangle_count;
};

static uint32_t add_vertex(struct soup *soup, double x, double y, double z)
{
	struct patch_vertex *vertex = &soup->vertices[soup->vertex_count];
	float normal[3] = { (float)sin(x), (float)cos(y), 1.0f };

	vertex->position[0] = (int32_t)x;
	vertex->position[1] = (int32_t)y;
	vertex->position[2] = (int32_t)z;
	normal_encode(vertex->normal, normal);
	for (int i = 0; i < 4; i++)
		vertex->colour[i] = (uint8_t)(x / (i + 3));
	return soup->vertex_count++;
}

static void add_triangle(struct soup *soup, uint32_t a, uint32_t b, uint32_t c)
{
	uint32_t *corners = soup->triangles[soup->triangle_count++];

	corners[0] = a;
	corners[1] = b;
	corners[2] = c;
}

/* A bumpy torus (closed, of genus 1) or a sheet with a border. */
static void add_surface(struct soup *soup, bool closed)
{
	uint32_t base = soup->vertex_count, last = closed ? SIDE : SIDE - 1;

	for (uint32_t i = 0; i < TILES; i++) {
		double u = i % SIDE * 2 * M_PI / SIDE, v = i / SIDE * 2 * M_PI / SIDE;
		double r = 4000 + 1500 * cos(v) + i * 7919 % 31;

		if (closed)
			add_vertex(soup, 9000 + r * cos(u), 9000 + r * sin(u),
				   3000 + 1500 * sin(v));
		else
			add_vertex(soup, 20000 + 300 * (i % SIDE), 300 * (i / SIDE),
				   500 + 200 * sin(3 * u) + i * 7919 % 31);
	}
	for (uint32_t y = 0; y < last; y++)
		for (uint32_t x = 0; x < last; x++) {
			uint32_t a = base + y * SIDE + x, b = base + y * SIDE + (x + 1) % SIDE;
			uint32_t c = base + (y + 1) % SIDE * SIDE + x;
			uint32_t d = base + (y + 1) % SIDE * SIDE + (x + 1) % SIDE;

			add_triangle(soup, a, b, c);
			add_triangle(soup, b, d, c);
		}
}

/* An octahedron, small. */
static void add_piece(struct soup *soup, double x)
{
	uint32_t v[6];

	for (int i = 0; i < 6; i++) {
		double at[3] = { x, 40000, 500 };

		at[i / 2] += i % 2 ? 60 : -60;
		v[i] = add_vertex(soup, at[0], at[1], at[2]);
	}
	for (int i = 0; i < 8; i++) {
		uint32_t a = v[i & 1], b = v[2 + (i >> 1 & 1)], c = v[4 + (i >> 2)];
		bool even = __builtin_popcount((unsigned)i) % 2;

		add_triangle(soup, a, even ? b : c, even ? c : b);
	}
}

/* Three sides around, open at both ends: no edge fulfils the link condition. */
static void add_tube(struct soup *soup, double x)
{
	uint32_t v[6];

	for (int i = 0; i < 6; i++)
		v[i] = add_vertex(soup, x + 60 * (i % 3), 40000 + 90 * (i % 3 == 1),
				  500 + i / 3 * 80);
	for (uint32_t i = 0; i < 3; i++) {
		add_triangle(soup, v[i], v[(i + 1) % 3], v[3 + i]);
		add_triangle(soup, v[(i + 1) % 3], v[3 + (i + 1) % 3], v[3 + i]);
	}
}

static void soup_init(struct soup *soup)
{
	*soup = (struct soup){ 0 };
	soup->vertices = calloc(8 * TILES, sizeof(*soup->vertices));
	soup->triangles = calloc(16 * TILES, sizeof(*soup->triangles));
}

static void soup_finish(struct soup *soup)
{
	free(soup->vertices);
	free(soup->triangles);
}

/* Torus, sheet, pieces, and a wing on an edge of the torus, so that three triangles meet there. */
static void everything(struct soup *soup)
{
	soup_init(soup);
	add_surface(soup, true);
	add_surface(soup, false);
	for (int i = 0; i < PIECES; i++)
		add_piece(soup, 300 + 400 * i);
	add_triangle(soup, 0, 1, add_vertex(soup, 30000, 30000, 30000));
	add_vertex(soup, 1, 2, 3); /* of no triangle */
}

static int compare_triangles(const void *a, const void *b)
{
	return memcmp(a, b, 3 * sizeof(struct patch_vertex));
}

static struct patch_vertex *sorted(const struct patch_vertex *vertices,
				   const uint32_t (*triangles)[3], uint32_t count)
{
	size_t bytes = 3 * sizeof(struct patch_vertex);
	struct patch_vertex *out = malloc(count * bytes + 1);

	for (uint32_t t = 0; t < count; t++) {
		struct patch_vertex turned[5];

		for (int i = 0; i < 5; i++)
			turned[i] = vertices[triangles[t][i % 3]];
		memcpy(&out[3 * t], turned, bytes);
		for (int i = 1; i < 3; i++)
			if (compare_triangles(&turned[i], &out[3 * t]) < 0)
				memcpy(&out[3 * t], &turned[i], bytes);
	}
	qsort(out, count, bytes, compare_triangles);
	return out;
}

static void check_whole(const struct stream_mesh *mesh, const struct soup *soup)
{
	struct patch_vertex *a, *b;

	CHECK(mesh->vertex_count == soup->vertex_count);
	CHECK(mesh->triangle_count == soup->triangle_count);
	a = sorted(mesh->vertices, (const uint32_t(*)[3])mesh->triangles, mesh->triangle_count);
	b = sorted(soup->vertices, (const uint32_t(*)[3])soup->triangles, soup->triangle_count);
	CHECK(memcmp(a, b, 3 * (size_t)soup->triangle_count * sizeof(*a)) == 0);
	free(a);
	free(b);
}

/* Corners are three different vertices. Returns the number of edges of more or less than two
 * triangles. */
static uint32_t check_valid(const struct stream_mesh *mesh)
{
	uint32_t odd = 0;

	for (uint32_t v = 0; v < mesh->vertex_count; v++)
		for (uint32_t at = mesh->first[v]; at != STREAM_NONE; at = mesh->next[at]) {
			const uint32_t *corners = mesh->triangles[at / 3];
			uint32_t next = corners[(at % 3 + 1) % 3], uses = 0;

			CHECK(at / 3 < mesh->triangle_count && corners[at % 3] == v);
			CHECK(next != v && next < mesh->vertex_count);
			for (uint32_t to = mesh->first[v]; to != STREAM_NONE; to = mesh->next[to])
				uses += mesh->triangles[to / 3][(to % 3 + 1) % 3] == next ||
					mesh->triangles[to / 3][(to % 3 + 2) % 3] == next;
			odd += uses != 2;
		}
	return odd;
}

static void make_as(struct buffer *out, struct stream_stats *stats, const struct soup *soup,
		    uint32_t base_vertices, bool loose)
{
	const struct stream_options options = { base_vertices, loose };

	buffer_init(out, 64 << 20);
	CHECK(stream_make(out, stats, soup->vertices, soup->vertex_count,
			  (const uint32_t(*)[3])soup->triangles, soup->triangle_count,
			  &options) == 0);
}

static void make(struct buffer *out, struct stream_stats *stats, const struct soup *soup)
{
	make_as(out, stats, soup, 256, false);
}

static void the_whole_stream_is_the_input_bit_for_bit(void **state)
{
	struct stream_decoder *decoder;
	struct stream_stats stats;
	struct buffer bytes;
	struct soup soup;

	(void)state;
	everything(&soup);
	make(&bytes, &stats, &soup);
	CHECK(stats.piece_count >= PIECES / 2);
	CHECK(stats.base_vertices <= 256);
	/* Normals are noise here: two bytes of each vertex. */
	CHECK(bytes.size < 14 * soup.vertex_count);
	CHECK(stream_decoder_create(&decoder) == 0);
	CHECK(stream_decoder_advance(decoder, buffer_bytes(&bytes)) == 0);
	CHECK(stream_decoder_complete(decoder));
	check_whole(stream_decoder_mesh(decoder), &soup);
	/* Back to the base and forth again. */
	stream_decoder_show(decoder, 0);
	CHECK(stream_decoder_mesh(decoder)->triangle_count == stats.base_triangles);
	stream_decoder_show(decoder, stats.record_count);
	check_whole(stream_decoder_mesh(decoder), &soup);
	stream_decoder_destroy(decoder);
	buffer_finish(&bytes);
	soup_finish(&soup);
}

static void every_prefix_of_a_closed_surface_is_closed(void **state)
{
	struct stream_decoder *decoder;
	struct stream_stats stats;
	struct buffer bytes;
	struct soup soup;

	(void)state;
	soup_init(&soup);
	add_surface(&soup, true);
	add_piece(&soup, 300);
	make(&bytes, &stats, &soup);
	CHECK(stream_decoder_create(&decoder) == 0);
	CHECK(stream_decoder_advance(decoder, buffer_bytes(&bytes)) == 0);
	for (uint32_t r = 0; r <= stats.record_count; r += 1 + r / 40) {
		stream_decoder_show(decoder, r);
		CHECK(check_valid(stream_decoder_mesh(decoder)) == 0);
	}
	stream_decoder_destroy(decoder);
	buffer_finish(&bytes);
	soup_finish(&soup);
}

static void loose_pieces_become_smaller_where_that_is_allowed(void **state)
{
	struct stream_stats strict, loose;
	struct stream_decoder *decoder;
	struct buffer bytes;
	struct soup soup;

	(void)state;
	soup_init(&soup);
	for (int i = 0; i < PIECES; i++)
		add_tube(&soup, 300 + 400 * i);
	make_as(&bytes, &strict, &soup, 16, false);
	CHECK(strict.base_vertices == soup.vertex_count);
	buffer_finish(&bytes);
	make_as(&bytes, &loose, &soup, 16, true);
	CHECK(loose.base_vertices <= 16);
	CHECK(stream_decoder_create(&decoder) == 0);
	CHECK(stream_decoder_advance(decoder, buffer_bytes(&bytes)) == 0);
	check_whole(stream_decoder_mesh(decoder), &soup);
	for (uint32_t r = 0; r <= loose.record_count; r++) {
		stream_decoder_show(decoder, r);
		check_valid(stream_decoder_mesh(decoder));
	}
	stream_decoder_destroy(decoder);
	buffer_finish(&bytes);
	soup_finish(&soup);
}

/* Whatever triangles share vertices: fans, sheets from both sides, edges of five triangles. */
static void any_tangle_of_triangles_can_be_streamed(void **state)
{
	(void)state;
	for (uint32_t seed = 1; seed <= 400; seed++) {
		struct stream_decoder *decoder;
		struct stream_stats stats;
		struct buffer bytes;
		struct soup soup;
		uint32_t number = seed * 2654435761u;

		soup_init(&soup);
		for (uint32_t i = 0; i < 10 + seed % 30; i++) {
			number = number * 1664525 + 1013904223;
			add_vertex(&soup, number >> 24, number >> 16 & 255, number >> 8 & 255);
		}
		for (uint32_t i = 0; i < 2 * soup.vertex_count; i++) {
			uint32_t c[3];
			bool known = false;

			for (int k = 0; k < 3; k++) {
				number = number * 1664525 + 1013904223;
				c[k] = (number >> 16) % soup.vertex_count;
			}
			if (c[0] == c[1] || c[1] == c[2] || c[2] == c[0])
				continue;
			for (uint32_t t = 0; t < soup.triangle_count; t++)
				for (int k = 0; k < 3; k++)
					known |= soup.triangles[t][k] == c[0] &&
						 soup.triangles[t][(k + 1) % 3] == c[1] &&
						 soup.triangles[t][(k + 2) % 3] == c[2];
			if (known)
				continue;
			add_triangle(&soup, c[0], c[1], c[2]);
			if (i % 4 == 0)
				add_triangle(&soup, c[0], c[2], c[1]); /* its back */
		}
		make_as(&bytes, &stats, &soup, 4, true);
		CHECK(stream_decoder_create(&decoder) == 0);
		CHECK(stream_decoder_advance(decoder, buffer_bytes(&bytes)) == 0);
		check_whole(stream_decoder_mesh(decoder), &soup);
		stream_decoder_show(decoder, stats.record_count / 2);
		check_valid(stream_decoder_mesh(decoder));
		stream_decoder_destroy(decoder);
		buffer_finish(&bytes);
		soup_finish(&soup);
	}
}

static void errors_say_how_much_each_block_adds(void **state)
{
	static struct stream_stats stats;
	struct buffer bytes;
	struct soup soup;
	uint32_t blocks;

	(void)state;
	everything(&soup);
	make_as(&bytes, &stats, &soup, 64, true);
	blocks = stream_block_count(stats.record_count);
	CHECK(blocks >= 3 && stats.errors[blocks] == 0.0);
	for (uint32_t i = 0; i < blocks; i++)
		CHECK(stats.errors[i] > stats.errors[i + 1]);
	/* The cheap collapses come first, so the first block of the stream adds most. */
	CHECK(stats.errors[0] > 2 * stats.errors[1]);
	CHECK(stats.errors[0] < 5000); /* the torus is 11000 wide */
	buffer_finish(&bytes);
	soup_finish(&soup);
}

static void a_truncated_stream_keeps_its_whole_blocks(void **state)
{
	struct stream_decoder *growing;
	struct stream_stats stats;
	uint32_t last = 0, steps = 0;
	struct buffer bytes;
	struct soup soup;

	(void)state;
	everything(&soup);
	make(&bytes, &stats, &soup);
	CHECK(stream_decoder_create(&growing) == 0);
	for (size_t size = 0; size <= bytes.size; size++) {
		uint8_t *exact = malloc(size ? size : 1); /* no slack for ASan */

		memcpy(exact, bytes.data, size);
		CHECK(stream_decoder_advance(growing, (struct bytes){ exact, size }) == 0);
		free(exact);
		CHECK(stream_decoder_records(growing) >= last);
		CHECK(stream_decoder_complete(growing) == (size == bytes.size));
		steps += stream_decoder_records(growing) > last;
		if (stream_decoder_records(growing) > last)
			check_valid(stream_decoder_mesh(growing));
		last = stream_decoder_records(growing);
	}
	CHECK(steps == (stats.record_count + STREAM_BLOCK_RECORDS - 1) / STREAM_BLOCK_RECORDS);
	check_whole(stream_decoder_mesh(growing), &soup);
	stream_decoder_destroy(growing);
	buffer_finish(&bytes);
	soup_finish(&soup);
}

static void a_damaged_block_is_refused_and_the_prefix_kept(void **state)
{
	struct stream_stats stats;
	uint32_t kept = 0;
	struct buffer bytes;
	struct soup soup;

	(void)state;
	everything(&soup);
	make(&bytes, &stats, &soup);
	for (size_t at = 0; at < bytes.size; at += 1 + at / 30) {
		struct stream_decoder *decoder;

		bytes.data[at] ^= 0x10;
		CHECK(stream_decoder_create(&decoder) == 0);
		/* A block that seems longer than the stream has only not arrived. */
		CHECK(stream_decoder_advance(decoder, buffer_bytes(&bytes)) <= 0);
		CHECK(!stream_decoder_complete(decoder));
		check_valid(stream_decoder_mesh(decoder));
		kept = stream_decoder_records(decoder) > kept ? stream_decoder_records(decoder)
							      : kept;
		bytes.data[at] ^= 0x10;
		/* What was refused once stays so, and what is there can still be shown. */
		if (stream_decoder_advance(decoder, buffer_bytes(&bytes)) < 0)
			stream_decoder_show(decoder, stream_decoder_records(decoder) / 2);
		check_valid(stream_decoder_mesh(decoder));
		stream_decoder_destroy(decoder);
	}
	CHECK(kept >= STREAM_BLOCK_RECORDS);
	buffer_finish(&bytes);
	soup_finish(&soup);
}

static void refuses_what_is_no_mesh(void **state)
{
	const struct stream_options options = { .base_vertices = 256 };
	const uint32_t beyond[1][3] = { { 0, 1, 3 } }, twice[1][3] = { { 0, 1, 1 } };
	struct patch_vertex vertices[3] = { 0 };
	struct stream_stats stats;
	struct buffer out;

	(void)state;
	buffer_init(&out, 1 << 20);
	CHECK(stream_make(&out, &stats, vertices, 3, beyond, 1, &options) == -EINVAL);
	CHECK(stream_make(&out, &stats, vertices, 3, twice, 1, &options) == -EINVAL);
	CHECK(stream_make(&out, &stats, vertices, STREAM_VERTICES_MAX + 1, twice, 0, &options) ==
	      -EINVAL);
	buffer_finish(&out);
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(the_whole_stream_is_the_input_bit_for_bit),
		cmocka_unit_test(every_prefix_of_a_closed_surface_is_closed),
		cmocka_unit_test(loose_pieces_become_smaller_where_that_is_allowed),
		cmocka_unit_test(any_tangle_of_triangles_can_be_streamed),
		cmocka_unit_test(errors_say_how_much_each_block_adds),
		cmocka_unit_test(a_truncated_stream_keeps_its_whole_blocks),
		cmocka_unit_test(a_damaged_block_is_refused_and_the_prefix_kept),
		cmocka_unit_test(refuses_what_is_no_mesh),
	};

	return cmocka_run_group_tests(tests, NULL, NULL);
}
