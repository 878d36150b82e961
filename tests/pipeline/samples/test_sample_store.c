#include <errno.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

#include "base/clock.h"
#include "pipeline/samples/sample_store.h"
#include "tests/check.h"
#include "tests/pipeline/samples/tile_of.h"

static char dir[64];
static const struct sample_grid grid = {
	.origin_m = { -1, -1, 0 }, .spacing_m = { 1, 1, 2 }, .count = { 5, 2, 1 }, .level_count = 2
};
static const struct hash key = { { 1, 2, 3 } }, other_key = { { 9 } };

static int make_dir(void **state)
{
	(void)state;
	snprintf(dir, sizeof(dir), "/tmp/gopura-store-XXXXXX");
	return mkdtemp(dir) ? 0 : -1;
}

static int remove_dir(void **state)
{
	char command[128];

	(void)state;
	snprintf(command, sizeof(command), "rm -rf %s", dir);
	return system(command);
}

/* Faces +x and -z; tiles whose bytes tell where they belong. */
static int put_point(uint32_t x, uint32_t y, struct hash with)
{
	static const uint16_t tiles[] = { 0, 2, 4 };
	uint8_t text[2] = { (uint8_t)('a' + x), (uint8_t)('0' + y) };
	const struct bytes objects[] = { { text, 2 }, { text, 1 }, { text + 1, 1 } };
	const uint32_t point[3] = { x, y, 0 };
	struct sample_face faces[2] = { { .face = 0,
					  .level_count = 2,
					  .coverage = 0x8001,
					  .near_m = 1,
					  .far_m = 2.5f,
					  .tile_count = 3,
					  .tiles = tiles,
					  .objects = objects } };

	faces[1] = faces[0];
	faces[1].face = 5;
	faces[1].tile_count = 1;
	return samples_store_put(dir, with, &grid, SAMPLE_RENDERED, point, faces, 2);
}

static bool has(const uint32_t point[3])
{
	struct samples_store *store;
	bool is_there;

	CHECK(samples_store_look(&store, dir) == 0);
	is_there = samples_store_has(store, point);
	samples_store_close(store);
	return is_there;
}

static void is_incomplete_until_every_point_is_there(void **state)
{
	struct samples_store *store;
	const uint32_t last[3] = { 4, 1, 0 };

	(void)state;
	CHECK(samples_store_open(&store, dir) == -ENOENT && !store);
	CHECK(samples_store_begin(dir, &grid, key) == 0);
	CHECK(samples_store_open(&store, dir) == -ENOENT && !store);
	for (uint32_t y = 0; y < 2; y++)
		for (uint32_t x = 0; x < 5; x++)
			if (x != 4 || y != 1)
				CHECK(put_point(x, y, key) == 0);
	CHECK(samples_store_open(&store, dir) == -ENOENT && !store);
	CHECK(!has(last));
	CHECK(samples_store_put(dir, other_key, &grid, SAMPLE_INSIDE, last, NULL, 0) == 0);
	CHECK(samples_store_open(&store, dir) == -ENOENT && !store); /* of another key */
	CHECK(!has(last));
	CHECK(samples_store_put(dir, key, &grid, SAMPLE_INSIDE, last, NULL, 0) == 0);
	CHECK(samples_store_open(&store, dir) == 0);
	samples_store_close(store);
}

static void gives_faces_brick_by_brick(void **state)
{
	static const uint8_t order[][2] = { { 0, 0 }, { 1, 0 }, { 2, 0 }, { 3, 0 }, { 0, 1 },
					    { 1, 1 }, { 2, 1 }, { 3, 1 }, { 4, 0 } };
	struct samples_store *store;
	struct sample_face face;
	uint32_t states[SAMPLE_STATES];

	(void)state;
	CHECK(samples_store_open(&store, dir) == 0);
	CHECK(memcmp(samples_store_grid(store), &grid, sizeof(grid)) == 0);
	CHECK(hash_equal(samples_store_key(store), key));
	samples_store_states(store, states);
	CHECK(states[SAMPLE_RENDERED] == 9 && states[SAMPLE_INSIDE] == 1);
	for (int pass = 0; pass < 2; pass++) {
		for (size_t i = 0; i < 2 * ARRAY_COUNT(order); i++) {
			CHECK(samples_store_next(store, &face) == 1);
			CHECK(face.point[0] == order[i / 2][0] && face.point[1] == order[i / 2][1]);
			CHECK(face.face == (i % 2 ? 5 : 0) && face.coverage == 0x8001);
			CHECK(face.near_m == 1 && face.far_m == 2.5f);
			CHECK(face.tile_count == (i % 2 ? 1 : 3) && face.tiles[0] == 0);
			CHECK(tile_of(&face, 0).size == 2);
			CHECK(tile_of(&face, 0).data[0] == 'a' + face.point[0]);
			CHECK(tile_of(&face, 0).data[1] == '0' + face.point[1]);
			if (i % 2 == 0)
				CHECK(tile_of(&face, 2).data[0] == '0' + face.point[1]);
		}
		CHECK(samples_store_next(store, &face) == 0);
		samples_store_rewind(store);
	}
	samples_store_close(store);
}

static void notices_damage_anywhere(void **state)
{
	const uint32_t point[3] = { 2, 1, 0 };
	struct samples_store *store;
	char path[128];
	struct buffer file;

	(void)state;
	snprintf(path, sizeof(path), "%s/.work/samples/02-01-00", dir);
	buffer_init(&file, 10000);
	CHECK(buffer_read_file(&file, path) == 0);
	for (size_t i = 0; i < file.size; i++) {
		file.data[i] ^= 0x10;
		CHECK(bytes_write_file(buffer_bytes(&file), path) == 0);
		CHECK(!has(point));
		file.data[i] ^= 0x10;
	}
	for (size_t n = 0; n < file.size; n += 7) {
		CHECK(bytes_write_file((struct bytes){ file.data, n }, path) == 0);
		CHECK(!has(point));
	}
	CHECK(samples_store_open(&store, dir) == -ENOENT);
	CHECK(bytes_write_file(buffer_bytes(&file), path) == 0);
	CHECK(has(point));
	buffer_finish(&file);
}

/* Sets the time of change of a point's file to so many seconds ago. */
static void age(uint32_t x, uint32_t y, int64_t seconds)
{
	const struct timespec then = { .tv_sec = clock_wall_s() - seconds };
	char path[128];

	snprintf(path, sizeof(path), "%s/.work/samples/%02u-%02u-00", dir, x, y);
	CHECK(utimensat(AT_FDCWD, path, (struct timespec[]){ then, then }, 0) == 0);
}

/* Changes a byte of a point's file and nothing of what stat tells. */
static void spoil(uint32_t x, uint32_t y)
{
	char path[128];
	struct stat status;
	int fd;

	snprintf(path, sizeof(path), "%s/.work/samples/%02u-%02u-00", dir, x, y);
	CHECK(stat(path, &status) == 0);
	fd = open(path, O_WRONLY | O_CLOEXEC);
	CHECK(fd >= 0 && pwrite(fd, "!", 1, 30) == 1);
	CHECK(futimens(fd, (struct timespec[]){ status.st_atim, status.st_mtim }) == 0);
	close(fd);
}

static int open_and_close(void)
{
	struct samples_store *store;
	int rc = samples_store_open(&store, dir);

	samples_store_close(store);
	return rc;
}

static void reads_a_file_again_only_when_it_changed(void **state)
{
	const uint32_t point[3] = { 1, 0, 0 };

	(void)state;
	for (uint32_t y = 0; y < 2; y++)
		for (uint32_t x = 0; x < 5; x++)
			age(x, y, 100);
	CHECK(open_and_close() == 0);
	spoil(1, 0);
	CHECK(open_and_close() == 0 && has(point)); /* nobody looked into it */
	age(1, 0, 50);
	CHECK(open_and_close() == -ENOENT && !has(point));
	CHECK(put_point(1, 0, key) == 0);
	CHECK(open_and_close() == 0 && has(point));
}

/* Within the same moment a file may change without another time. */
static void reads_a_young_file_again(void **state)
{
	const uint32_t point[3] = { 1, 0, 0 };

	(void)state;
	CHECK(put_point(1, 0, key) == 0);
	CHECK(open_and_close() == 0);
	spoil(1, 0);
	CHECK(open_and_close() == -ENOENT && !has(point));
	CHECK(put_point(1, 0, key) == 0);
}

static void a_damaged_index_is_made_again(void **state)
{
	char path[128];
	struct buffer file;

	(void)state;
	CHECK(open_and_close() == 0);
	snprintf(path, sizeof(path), "%s/.work/samples/index", dir);
	buffer_init(&file, 10000);
	CHECK(buffer_read_file(&file, path) == 0);
	for (size_t n = 0; n < file.size; n += 5) {
		CHECK(bytes_write_file((struct bytes){ file.data, n }, path) == 0);
		CHECK(open_and_close() == 0);
	}
	for (size_t i = 0; i < file.size; i += 3) {
		file.data[i] ^= 0x10;
		CHECK(bytes_write_file(buffer_bytes(&file), path) == 0);
		file.data[i] ^= 0x10;
		CHECK(open_and_close() == 0);
	}
	buffer_finish(&file);
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(is_incomplete_until_every_point_is_there),
		cmocka_unit_test(gives_faces_brick_by_brick),
		cmocka_unit_test(notices_damage_anywhere),
		cmocka_unit_test(reads_a_file_again_only_when_it_changed),
		cmocka_unit_test(reads_a_young_file_again),
		cmocka_unit_test(a_damaged_index_is_made_again),
	};

	return cmocka_run_group_tests(tests, make_dir, remove_dir);
}
