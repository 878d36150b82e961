#include "pipeline/hierarchy/block_cells.h"

#include <errno.h>
#include <stdlib.h>
#include <string.h>

#include "tests/check.h"

enum { CELL_STEPS = 65536 / BLOCK_CELLS_SIDE, CROWD = 20 };

static struct block_counts *no_triangles(void)
{
	struct block_counts *counts = calloc(1, sizeof(*counts));

	CHECK(counts != NULL);
	return counts;
}

static uint32_t cell_of(uint32_t x, uint32_t y)
{
	const uint16_t at[3] = { (uint16_t)(x * CELL_STEPS), (uint16_t)(y * CELL_STEPS), 0 };

	return block_cell(at);
}

/* A floor, and a crowd in one corner of it. Every cell touches the next. */
static struct block_counts *crowded_floor(void)
{
	struct block_counts *counts = no_triangles();

	for (uint32_t y = 0; y < BLOCK_CELLS_SIDE; y++)
		for (uint32_t x = 0; x < BLOCK_CELLS_SIDE; x++) {
			counts->triangles[cell_of(x, y)] = x < CROWD && y < CROWD ? 500 : 7;
			counts->crossings[0][cell_of(x, y)] = 10;
			counts->crossings[1][cell_of(x, y)] = 10;
		}
	return counts;
}

static void blocks_are_alike_and_few(void **state)
{
	struct block_counts *counts = crowded_floor();
	struct block_cells cells;
	uint64_t total = 0, *held;

	(void)state;
	CHECK(block_cells_create(&cells, counts, 10000) == 0);
	held = calloc(cells.block_count, sizeof(*held));
	for (uint32_t c = 0; c < BLOCK_CELLS; c++) {
		CHECK(cells.block_of_cell[c] < cells.block_count);
		held[cells.block_of_cell[c]] += counts->triangles[c];
		total += counts->triangles[c];
	}
	CHECK(cells.block_count == (total + 9999) / 10000);
	for (uint32_t b = 0; b < cells.block_count; b++) {
		CHECK(held[b] == cells.triangle_counts[b]);
		CHECK(held[b] > 8000 && held[b] < 12000);
	}
	free(held);
	block_cells_finish(&cells);
	free(counts);
}

/* Two rooms with a narrow door: that is where to cut, though the rooms are not equal. */
static void the_cut_goes_through_the_door(void **state)
{
	struct block_counts *counts = no_triangles();
	struct block_cells cells;
	uint32_t wrong = 0;

	(void)state;
	for (uint32_t y = 0; y < 40; y++)
		for (uint32_t x = 0; x < 81; x++) {
			counts->triangles[cell_of(x, y)] = 100;
			counts->crossings[0][cell_of(x, y)] = x == 40 ? 1 : 50;
			counts->crossings[1][cell_of(x, y)] = 50;
		}
	CHECK(block_cells_create(&cells, counts, 81 * 40 * 50 + 100) == 0);
	CHECK(cells.block_count == 2);
	for (uint32_t y = 0; y < 40; y++)
		for (uint32_t x = 0; x < 81; x++)
			wrong += (cells.block_of_cell[cell_of(x, y)] ==
				  cells.block_of_cell[cell_of(0, 0)]) != (x <= 40);
	CHECK(wrong < 20);
	block_cells_finish(&cells);
	free(counts);
}

static void a_small_model_is_one_block(void **state)
{
	struct block_counts *counts = crowded_floor();
	struct block_cells cells;

	(void)state;
	CHECK(block_cells_create(&cells, counts, UINT32_MAX) == 0);
	CHECK(cells.block_count == 1);
	block_cells_finish(&cells);
	free(counts);
}

static void a_crowded_cell_stays_whole(void **state)
{
	struct block_counts *counts = no_triangles();
	struct block_cells cells;

	(void)state;
	CHECK(block_cells_create(&cells, counts, 100) == -EINVAL);
	CHECK(!cells.block_of_cell && !cells.triangle_counts);
	counts->triangles[77] = 1000;
	CHECK(block_cells_create(&cells, counts, 100) == 0);
	CHECK(cells.block_count == 1 && cells.triangle_counts[0] == 1000);
	block_cells_finish(&cells);
	counts->triangles[90] = 50;
	CHECK(block_cells_create(&cells, counts, 100) == 0);
	CHECK(cells.block_count == 2);
	CHECK(cells.block_of_cell[77] != cells.block_of_cell[90]);
	/* A corner beside a cell of triangles belongs to its block. */
	CHECK(cells.block_of_cell[91] == cells.block_of_cell[90]);
	CHECK(cells.block_of_cell[77 + BLOCK_CELLS_SIDE] == cells.block_of_cell[77]);
	block_cells_finish(&cells);
	free(counts);
}

static void turning_a_triangle_changes_nothing(void **state)
{
	const uint16_t places[4][3] = {
		{ 0, 0, 0 }, { 60000, 3, 9 }, { 60001, 4, 9 }, { 700, 50000, 20000 }
	};

	(void)state;
	for (int i = 0; i < 64; i++) {
		uint16_t at[3][3], turned[3][3];

		for (int c = 0; c < 3; c++)
			memcpy(at[c], places[i >> (2 * c) & 3], sizeof(at[c]));
		for (int c = 0; c < 3; c++)
			memcpy(turned[c], at[(c + 1) % 3], sizeof(at[c]));
		CHECK(block_cell_of_triangle((const uint16_t(*)[3])at) ==
		      block_cell_of_triangle((const uint16_t(*)[3])turned));
	}
	CHECK(block_cell_of_triangle(places) == block_cell(places[1]));
}

static void what_crosses_is_counted(void **state)
{
	const uint16_t inside[3][3] = { { 1, 1, 1 }, { 2, 1, 1 }, { 1, 2, 1 } };
	const uint16_t across[3][3] = { { 511, 1, 1 }, { 512, 1, 1 }, { 511, 2, 1 } };
	const uint16_t up[3][3] = { { 1, 1, 511 }, { 1, 1, 512 }, { 2, 1, 512 } };
	struct block_counts *counts = no_triangles();

	(void)state;
	block_counts_add(counts, inside);
	CHECK(counts->triangles[0] == 1 && counts->crossings[0][0] == 0);
	block_counts_add(counts, across);
	CHECK(counts->triangles[0] == 2 && counts->crossings[0][0] == 2);
	block_counts_add(counts, up);
	CHECK(counts->triangles[block_cell(up[1])] == 1 && counts->crossings[2][0] == 2);
	CHECK(counts->crossings[1][0] == 0);
	free(counts);
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(blocks_are_alike_and_few),
		cmocka_unit_test(the_cut_goes_through_the_door),
		cmocka_unit_test(a_small_model_is_one_block),
		cmocka_unit_test(a_crowded_cell_stays_whole),
		cmocka_unit_test(turning_a_triangle_changes_nothing),
		cmocka_unit_test(what_crosses_is_counted),
	};

	return cmocka_run_group_tests(tests, NULL, NULL);
}
