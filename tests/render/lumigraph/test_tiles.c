#include <errno.h>
#include <stdlib.h>
#include <string.h>

#include "render/display/headless.h"
#include "render/lumigraph/tiles.h"
#include "tests/check.h"

enum { SMALL_BUDGET = 1 }; /* gives the least: 4 x 4 slots */

struct table {
	struct headless *headless;
	struct tiles tiles;
	uint8_t rgb[SAMPLE_IMAGE_PX * SAMPLE_IMAGE_PX * 3];
};

static int lay(void **state)
{
	struct table *table = calloc(1, sizeof(*table));
	*state = table;
	if (!table || headless_create(&table->headless) < 0)
		return -1;
	return tiles_init(&table->tiles, SMALL_BUDGET, 8, TILES_FACES_MAX / 8);
}

static int clear_away(void **state)
{
	struct table *table = *state;
	tiles_finish(&table->tiles);
	headless_destroy(table->headless);
	free(table);
	return 0;
}

static struct tile_name name_of(face_key face, int level, int row, int column)
{
	return (struct tile_name){ face, (uint8_t)level, (uint8_t)row, (uint8_t)column };
}

static int put(struct table *table, struct tile_name name)
{
	return tiles_put(&table->tiles, name, table->rgb);
}

static void the_finest_tile_of_a_place_is_found(void **state)
{
	struct table *table = *state;
	struct tiles *tiles = &table->tiles;
	CHECK(tiles_level_at(tiles, 7, 0, 0) == -1);
	CHECK(put(table, name_of(7, 0, 0, 0)) == 0);
	CHECK(put(table, name_of(7, 2, 0, 3)) == 0); /* top right sixteenth */
	CHECK(tiles_level_at(tiles, 7, 0.9f, 0.9f) == 2);
	CHECK(tiles_level_at(tiles, 7, 0.9f, -0.9f) == 0);
	CHECK(tiles_level_at(tiles, 7, -0.9f, 0.9f) == 0);
	CHECK(tiles_level_at(tiles, 8, 0.9f, 0.9f) == -1);
	/* A coarser one that comes later does not cover it. */
	CHECK(put(table, name_of(7, 1, 0, 1)) == 0);
	CHECK(tiles_level_at(tiles, 7, 0.9f, 0.9f) == 2);
	CHECK(tiles_level_at(tiles, 7, 0.4f, 0.9f) == 1);
	CHECK(tiles_face_slot(tiles, 7) >= 0 && tiles->key_count == 1);
}

static void what_is_in_use_stays_and_the_rest_goes_by_age(void **state)
{
	struct table *table = *state;
	struct tiles *tiles = &table->tiles;
	CHECK(tiles->slot_count == 16);
	for (int i = 0; i < 16; i++) {
		tiles_begin(tiles);
		CHECK(put(table, name_of(3, 2, i / 4, i % 4)) == 0);
	}
	tiles_begin(tiles);
	tiles_touch(tiles, 3, -1, -1, 1, 0); /* the lower half */
	CHECK(tiles_room(tiles) == 8);
	for (int i = 0; i < 8; i++) {
		CHECK(put(table, name_of(4, 2, i / 4, i % 4)) == 0);
		CHECK(!tiles_has(tiles, name_of(3, 2, i / 4, i % 4))); /* oldest first */
	}
	/* All that is there was touched or has just come. */
	CHECK(tiles_room(tiles) == 0);
	CHECK(put(table, name_of(5, 0, 0, 0)) == -ENOSPC);
	CHECK(tiles_face_slot(tiles, 5) == -1);
	for (int i = 8; i < 16; i++)
		CHECK(tiles_has(tiles, name_of(3, 2, i / 4, i % 4)));
	CHECK(tiles_level_at(tiles, 3, 0, 0.9f) == -1);
	CHECK(tiles_level_at(tiles, 3, 0, -0.9f) == 2);
}

static void a_coarser_tile_shows_again_where_a_finer_went(void **state)
{
	struct table *table = *state;
	struct tiles *tiles = &table->tiles;
	tiles_begin(tiles);
	CHECK(put(table, name_of(9, 2, 1, 1)) == 0);
	tiles_begin(tiles);
	CHECK(put(table, name_of(9, 0, 0, 0)) == 0);
	for (int i = 0; i < 15; i++)
		CHECK(put(table, name_of(10, 2, i / 4, i % 4)) == 0);
	CHECK(!tiles_has(tiles, name_of(9, 2, 1, 1)));
	CHECK(tiles_level_at(tiles, 9, -0.4f, 0.4f) == 0);
}

static void what_came_and_went_is_declined_for_a_season(void **state)
{
	struct table *table = *state;
	struct tiles *tiles = &table->tiles;
	tiles_begin_season(tiles);
	tiles_begin(tiles);
	CHECK(put(table, name_of(1, 0, 0, 0)) == 0);
	tiles_begin(tiles);
	for (int i = 0; i < 16; i++)
		CHECK(put(table, name_of(2, 2, i / 4, i % 4)) == 0);
	CHECK(put(table, name_of(6, 0, 0, 0)) == -ENOSPC);
	CHECK(tiles_is_declined(tiles, name_of(1, 0, 0, 0)));
	CHECK(tiles_is_declined(tiles, name_of(6, 0, 0, 0)));
	CHECK(!tiles_is_declined(tiles, name_of(2, 2, 0, 0)));
	tiles_begin_season(tiles);
	CHECK(!tiles_is_declined(tiles, name_of(1, 0, 0, 0)));
}

static void faces_past_the_slots_take_the_oldest(void **state)
{
	struct table *table = *state;
	struct tiles tiles;
	CHECK(tiles_init(&tiles, 3ull * 4096 * 4096, 8, TILES_FACES_MAX / 8) == 0);
	for (face_key face = 0; face < TILES_FACES_MAX + 10; face++) {
		tiles_begin(&tiles);
		CHECK(tiles_put(&tiles, name_of(face, 0, 0, 0), table->rgb) == 0);
	}
	CHECK(tiles.key_count == TILES_FACES_MAX);
	for (face_key face = 0; face < TILES_FACES_MAX + 10; face++)
		CHECK((tiles_face_slot(&tiles, face) >= 0) == (face >= 10));
	tiles_clear(&tiles);
	CHECK(tiles.key_count == 0 && !tiles_has(&tiles, name_of(20, 0, 0, 0)));
	CHECK(gl_check("the test") == 0);
	tiles_finish(&tiles);
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test_setup_teardown(the_finest_tile_of_a_place_is_found, lay,
						clear_away),
		cmocka_unit_test_setup_teardown(what_is_in_use_stays_and_the_rest_goes_by_age, lay,
						clear_away),
		cmocka_unit_test_setup_teardown(a_coarser_tile_shows_again_where_a_finer_went, lay,
						clear_away),
		cmocka_unit_test_setup_teardown(what_came_and_went_is_declined_for_a_season, lay,
						clear_away),
		cmocka_unit_test_setup_teardown(faces_past_the_slots_take_the_oldest, lay,
						clear_away),
	};
	return cmocka_run_group_tests(tests, NULL, NULL);
}
