/* A box of six colours, sampled from all around, against rays cast by hand. */
#include <dirent.h>
#include <errno.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

#include "format/tile.h"
#include "pipeline/samples/sampler.h"
#include "tests/check.h"
#include "tests/pipeline/samples/tile_of.h"

static char dir[3][64]; /* whole, shards, textured */
static const uint8_t six[6][3] = { { 200, 40, 40 },  { 40, 200, 40 },  { 40, 40, 200 },
				   { 200, 200, 40 }, { 40, 200, 200 }, { 200, 40, 200 } };

/* The box -1..1 as PLY, 24 vertices. */
static void put_box(const char *folder)
{
	char path[256];
	FILE *file;

	snprintf(path, sizeof(path), "%s/box.ply", folder);
	file = fopen(path, "w");
	CHECK(file != NULL);
	fputs("ply\nformat ascii 1.0\nelement vertex 24\nproperty float x\nproperty float y\n"
	      "property float z\nproperty uchar red\nproperty uchar green\nproperty uchar blue\n"
	      "element face 6\nproperty list uchar int vertex_indices\nend_header\n",
	      file);
	for (int side = 0; side < 6; side++) {
		for (int k = 0; k < 4; k++) {
			int p[3], axis = side / 2, u = (axis + 1) % 3, v = (axis + 2) % 3;
			int turn = side % 2 ? 3 - k : k; /* counter-clockwise from outside */

			p[axis] = side % 2 ? -1 : 1;
			p[u] = turn == 1 || turn == 2 ? 1 : -1;
			p[v] = turn >= 2 ? 1 : -1;
			fprintf(file, "%d %d %d %d %d %d\n", p[0], p[1], p[2], six[side][0],
				six[side][1], six[side][2]);
		}
	}
	for (int side = 0; side < 6; side++)
		fprintf(file, "4 %d %d %d %d\n", 4 * side, 4 * side + 1, 4 * side + 2,
			4 * side + 3);
	fclose(file);
	snprintf(path, sizeof(path), "%s/temple.ini", folder);
	file = fopen(path, "w");
	CHECK(file != NULL);
	fputs("[model]\nscans = box.ply\nlit = no\n[grid]\npoints = 8\nface_px = 256\n"
	      "quality = 95\n",
	      file);
	fclose(file);
}

static void sample(const char *folder, uint32_t jobs, uint32_t shard, uint32_t shards)
{
	const struct sampler_options options = { .jobs = jobs, .shard = { shard, shards } };
	struct diagnostics diagnostics = { .max = SETTINGS_DIAGNOSTICS_MAX };
	struct content content;
	struct scans *scans;

	CHECK(content_read(&content, folder, &diagnostics) == 0);
	CHECK(scans_create(&scans, &content) == 0);
	content.grid_points = 6; /* -1.5 -0.9 -0.3 0.3 0.9 1.5: none on the surface */
	CHECK(sampler_run(scans, &options, &diagnostics) == 0);
	scans_destroy(scans);
	content_release(&content);
}

static int make_dirs(void **state)
{
	(void)state;
	for (int i = 0; i < 2; i++) {
		snprintf(dir[i], sizeof(dir[i]), "/tmp/gopura-sampler-XXXXXX");
		if (!mkdtemp(dir[i]))
			return -1;
		put_box(dir[i]);
	}
	sample(dir[0], 2, 0, 1);
	return 0;
}

static int remove_dirs(void **state)
{
	char command[512];

	(void)state;
	snprintf(command, sizeof(command), "rm -rf %s %s", dir[0], dir[1]);
	return system(command);
}

/* The side of the box that a ray meets from outside, and how far along; -1: none. */
static int cast(const float from[3], const float direction[3], float *distance)
{
	float enter = 0, leave = INFINITY;
	int side = -1;

	for (int i = 0; i < 3; i++) {
		float a = (-1 - from[i]) / direction[i], b = (1 - from[i]) / direction[i];

		if (fminf(a, b) > enter) {
			enter = fminf(a, b);
			side = 2 * i + (direction[i] > 0);
		}
		leave = fminf(leave, fmaxf(a, b));
	}
	*distance = enter;
	return enter < leave ? side : -1;
}

static void plans_grids_by_the_longest_side(void **state)
{
	struct sample_grid grid;
	float place[3];

	(void)state;
	sampler_grid(&grid, (float[3]){ 0, 0, 0 }, (float[3]){ 42, 42, 24 }, 8, 1024, false);
	CHECK(grid.count[0] == 8 && grid.count[1] == 8 && grid.count[2] == 3);
	CHECK(grid.level_count == 4 && grid.origin_m[0] == -10.5f && grid.spacing_m[0] == 9);
	CHECK(grid.origin_m[2] == 5 && grid.spacing_m[2] == 10);
	sampler_point(place, &grid, (uint32_t[3]){ 7, 0, 2 });
	CHECK(place[0] == 52.5f && place[1] == -10.5f && place[2] == 25);
	sampler_grid(&grid, (float[3]){ 0, 0, 0 }, (float[3]){ 42, 42, 24 }, 8, 512, true);
	CHECK(grid.count[2] == 5 && grid.origin_m[2] == -6 && grid.level_count == 3);
	sampler_grid(&grid, (float[3]){ 0, 0, 0 }, (float[3]){ 1, 1, 0 }, 8, 128, false);
	CHECK(grid.count[2] == 1 && grid.spacing_m[2] > 0 && grid.level_count == 1);
}

/* A wall 7 m wide and a centimetre thick, and the same as a floor: seen from their own plane they
 * would show nothing. */
static void sees_flat_things_from_before(void **state)
{
	const float wall[2][3] = { { 0, -0.01f, 0 }, { 7, 0, 4 } }, floor_m[3] = { 7, 7, 0.01f };
	struct sample_grid grid;
	float place[3];

	(void)state;
	for (uint32_t points = 4; points <= 32; points *= 2) {
		const float distance = 1.5f * 7 / (float)(points - 1);

		sampler_grid(&grid, wall[0], wall[1], points, 512, false);
		CHECK(grid.count[1] == 2);
		for (uint32_t y = 0; y < 2; y++) {
			sampler_point(place, &grid, (uint32_t[3]){ 0, y, 0 });
			CHECK(fabsf(place[1] - (y ? 0 : -0.01f)) > 0.2f * distance);
		}
		sampler_grid(&grid, (float[3]){ 0, 0, 0 }, floor_m, points, 512, false);
		CHECK(grid.count[2] == 1 && grid.origin_m[2] > 0.2f * distance);
	}
}

static void finds_the_points_inside(void **state)
{
	uint32_t states[SAMPLE_STATES];
	struct samples_store *store;
	struct sample_face face;

	(void)state;
	CHECK(samples_store_open(&store, dir[0]) == 0);
	samples_store_states(store, states);
	CHECK(states[SAMPLE_INSIDE] == 4 * 4 * 3);
	CHECK(states[SAMPLE_RENDERED] == 6 * 6 * 4 - 48 + 1); /* and the first view */
	while (samples_store_next(store, &face) == 1) {
		float place[3];

		sampler_point(place, samples_store_grid(store), face.point);
		CHECK(fabsf(place[0]) > 1 || fabsf(place[1]) > 1 || fabsf(place[2]) > 1);
	}
	samples_store_close(store);
}

/* Does any ray through the square of the face hit? Counts along x and y. */
static bool any_hit(const float place[3], int face, float low_u, float low_v, float side)
{
	for (int i = 0; i < 17 * 17; i++) {
		float direction[3], distance;

		cube_direction(direction, face, low_u + side * (float)(i % 17) / 16,
			       low_v + side * (float)(i / 17) / 16);
		if (cast(place, direction, &distance) >= 0)
			return true;
	}
	return false;
}

static void knows_what_each_face_covers(void **state)
{
	/* by place in the grid; the last is the vantage point's, which lies behind all others */
	bool seen[6 * 6 * 4 + 1][CUBE_FACES] = { { false } };
	const struct sample_grid *grid;
	struct samples_store *store;
	struct sample_face face;

	(void)state;
	CHECK(samples_store_open(&store, dir[0]) == 0);
	grid = samples_store_grid(store);
	while (samples_store_next(store, &face) == 1) {
		float place[3];

		seen[(face.point[2] * 6 + face.point[1]) * 6 + face.point[0]][face.face] = true;
		sampler_point(place, grid, face.point);
		for (int cell = 0; cell < 16; cell++) {
			float u = -1 + 0.5f * (float)(cell % 4),
			      v = 0.5f - 0.5f * (float)(cell / 4);

			if (any_hit(place, face.face, u, v, 0.5f))
				CHECK(face.coverage >> cell & 1);
			else if (!any_hit(place, face.face, u - 0.02f, v - 0.02f, 0.54f))
				CHECK(!(face.coverage >> cell & 1));
		}
	}
	for (uint32_t n = 0; n < 6 * 6 * 4; n++) {
		const uint32_t point[3] = { n % 6, n / 6 % 6, n / 36 };
		float place[3];

		sampler_point(place, grid, point);
		if (fabsf(place[0]) < 1 && fabsf(place[1]) < 1 && fabsf(place[2]) < 1)
			continue;
		for (int f = 0; f < CUBE_FACES; f++)
			if (!seen[n][f])
				CHECK(!any_hit(place, f, -1, -1, 2));
	}
	samples_store_close(store);
}

static void knows_near_and_far(void **state)
{
	struct samples_store *store;
	struct sample_face face;
	int seen = 0;

	(void)state;
	CHECK(samples_store_open(&store, dir[0]) == 0);
	while (samples_store_next(store, &face) == 1) {
		float near = INFINITY, far = 0, place[3];
		int hits = 0;

		sampler_point(place, samples_store_grid(store), face.point);
		for (int i = 0; i < 101 * 101; i++) {
			float direction[3], distance;

			cube_direction(direction, face.face, 0.985f * ((float)(i % 101) / 50 - 1),
				       0.985f * ((float)(i / 101) / 50 - 1));
			if (cast(place, direction, &distance) < 0)
				continue;
			hits++;
			near = fminf(near, distance);
			far = fmaxf(far, distance);
		}
		if (hits == 0)
			continue;
		/* Far ends are seen at a grazing angle, between pixels. */
		CHECK(face.near_m <= 1.001f * near && face.far_m >= 0.98f * far);
		if (far > 1.5f * near)
			continue;
		CHECK(face.near_m > 0.9f * near && face.far_m < 1.1f * far); /* aprons see more */
		seen++;
	}
	CHECK(seen > 50);
	samples_store_close(store);
}

/* Same side within two pixels all around? */
static int plain_side(const float place[3], int face, float x, float y, float px)
{
	int first = -2;

	for (int i = 0; i < 9; i++) {
		float u = 2 * (x + 3 * (float)(i % 3 - 1)) / px - 1;
		float v = 1 - 2 * (y + 3 * (float)(i / 3 - 1)) / px, distance, direction[3];
		int side;

		cube_direction(direction, face, u, v);
		side = cast(place, direction, &distance);
		if (first != -2 && side != first)
			return -1;
		first = side;
	}
	return first;
}

/* Tile by index: level, row, column. */
static void find_place(uint16_t tile, uint32_t *level, uint32_t *row, uint32_t *column)
{
	for (*level = 0; face_tile_index(*level + 1, 0, 0) <= tile; ++*level)
		;
	face_tile_place(*level, tile, row, column);
}

static void tiles_show_what_rays_meet(void **state)
{
	static uint8_t rgb[SAMPLE_IMAGE_PX * SAMPLE_IMAGE_PX * 3];
	struct samples_store *store;
	struct sample_face face;
	int checked = 0;

	(void)state;
	CHECK(samples_store_open(&store, dir[0]) == 0);
	for (int n = 0; samples_store_next(store, &face) == 1; n++) {
		float place[3];

		sampler_point(place, samples_store_grid(store), face.point);
		for (uint32_t t = 0; n % 5 == 0 && t < face.tile_count; t++) {
			uint32_t level, row, column;

			find_place(face.tiles[t], &level, &row, &column);
			CHECK(tile_decode(rgb, SAMPLE_IMAGE_PX, tile_of(&face, t)) == 0);
			for (int i = 0; i < SAMPLE_IMAGE_PX * SAMPLE_IMAGE_PX; i += 41) {
				float x = (float)(i % SAMPLE_IMAGE_PX - SAMPLE_APRON_PX +
						  (int)column * SAMPLE_TILE_PX) +
					  0.5f;
				float y = (float)(i / SAMPLE_IMAGE_PX - SAMPLE_APRON_PX +
						  (int)row * SAMPLE_TILE_PX) +
					  0.5f;
				int side = plain_side(place, face.face, x, y,
						      (float)(SAMPLE_TILE_PX << level));

				if (side < 0)
					continue;
				checked++;
				for (int c = 0; c < 3; c++)
					CHECK(abs(rgb[3 * i + c] - six[side][c]) < 28);
			}
		}
	}
	CHECK(checked > 10000);
	samples_store_close(store);
}

/* What a tile's apron holds is what its neighbour holds there. */
static void aprons_continue_into_the_neighbour(void **state)
{
	static uint8_t left[SAMPLE_IMAGE_PX * SAMPLE_IMAGE_PX * 3], right[sizeof(left)];
	struct samples_store *store;
	struct sample_face face;
	const int shared = 2 * SAMPLE_APRON_PX * 3;
	double sum = 0, count = 0;

	(void)state;
	CHECK(samples_store_open(&store, dir[0]) == 0);
	while (samples_store_next(store, &face) == 1) {
		for (uint32_t t = 0; t + 1 < face.tile_count; t++) {
			/* Tile 1 is row 0, column 0 of level 1, tile 2 the one right of it. */
			if (face.tiles[t] != 1 || face.tiles[t + 1] != 2)
				continue;
			CHECK(tile_decode(left, SAMPLE_IMAGE_PX, tile_of(&face, t)) == 0);
			CHECK(tile_decode(right, SAMPLE_IMAGE_PX, tile_of(&face, t + 1)) == 0);
			for (int i = 0; i < SAMPLE_IMAGE_PX * shared; i++) {
				int row = i / shared * SAMPLE_IMAGE_PX * 3;
				int edge = row + SAMPLE_TILE_PX * 3;

				sum += abs(left[edge + i % shared] - right[row + i % shared]);
				count++;
			}
		}
	}
	CHECK(count > 25000);
	CHECK(sum / count < 3);
	samples_store_close(store);
}

static void compare_files(const char *a, const char *b)
{
	struct buffer first, second;
	char path[2][320];
	struct dirent *entry;
	DIR *folder;
	int files = 0;

	snprintf(path[0], sizeof(path[0]), "%s/.work/samples", a);
	folder = opendir(path[0]);
	CHECK(folder != NULL);
	buffer_init(&first, 64 << 20);
	buffer_init(&second, 64 << 20);
	while ((entry = readdir(folder))) {
		if (entry->d_name[0] == '.' || strcmp(entry->d_name, "index") == 0)
			continue; /* the index has the files' times */
		snprintf(path[0], sizeof(path[0]), "%s/.work/samples/%.50s", a, entry->d_name);
		snprintf(path[1], sizeof(path[1]), "%s/.work/samples/%.50s", b, entry->d_name);
		CHECK(buffer_read_file(&first, path[0]) == 0);
		CHECK(buffer_read_file(&second, path[1]) == 0);
		CHECK(first.size == second.size);
		/* The key holds the scan's time of change; pictures must be equal. */
		CHECK(memcmp(first.data + 24, second.data + 24, first.size - 24 - HASH_BYTES) == 0);
		files++;
	}
	CHECK(files == 6 * 6 * 4 + 2); /* and the first view, and the grid */
	closedir(folder);
	buffer_finish(&first);
	buffer_finish(&second);
}

static void shards_add_up_to_the_whole(void **state)
{
	struct samples_store *store;

	(void)state;
	sample(dir[1], 1, 1, 2);
	CHECK(samples_store_open(&store, dir[1]) < 0); /* half is missing */
	sample(dir[1], 1, 0, 2);
	compare_files(dir[0], dir[1]);
}

static void makes_only_what_is_missing(void **state)
{
	const uint32_t point[3] = { 3, 0, 1 };
	struct samples_store *store;
	char path[256];

	(void)state;
	snprintf(path, sizeof(path), "%s/.work/samples/03-00-01", dir[0]);
	CHECK(remove(path) == 0);
	snprintf(path, sizeof(path), "%s/.work/samples/04-00-01", dir[0]);
	CHECK(bytes_write_file((struct bytes){ (const uint8_t *)"damage", 6 }, path) == 0);
	sample(dir[0], 1, 0, 1);
	CHECK(samples_store_look(&store, dir[0]) == 0);
	CHECK(samples_store_has(store, point));
	samples_store_close(store);
	compare_files(dir[0], dir[1]);
}

static uint32_t count_points(void)
{
	char path[256];
	uint32_t count = 0;
	DIR *entries;

	snprintf(path, sizeof(path), "%s/.work/samples", dir[0]);
	entries = opendir(path);
	CHECK(entries != NULL);
	while (readdir(entries))
		count++;
	closedir(entries);
	return count;
}

/* Files of other first views and of larger grids are of no use; nothing else is removed. */
static void removes_points_that_the_grid_does_not_have(void **state)
{
	static const struct {
		const char *name;
		bool stays;
	} files[] = {
		{ "05-05-03", true },        { "06-00-00", false },
		{ "00-00-31", false },       { "at-00000000-3f800000-40000000-102030", false },
		{ "00-00-31.Ab3dEf", true }, { "05-05-03.txt", true },
		{ "at-home", true },
	};
	char path[256];
	uint32_t counts[2] = { 0 };

	(void)state;
	for (size_t i = 1; i < ARRAY_COUNT(files); i++) {
		snprintf(path, sizeof(path), "%s/.work/samples/%s", dir[0], files[i].name);
		CHECK(bytes_write_file((struct bytes){ (const uint8_t *)"x", 1 }, path) == 0);
	}
	counts[0] = count_points();
	sample(dir[0], 2, 0, 1);
	counts[1] = count_points();
	for (size_t i = 0; i < ARRAY_COUNT(files); i++) {
		snprintf(path, sizeof(path), "%s/.work/samples/%s", dir[0], files[i].name);
		if ((access(path, F_OK) == 0) != files[i].stays)
			fail_msg("%s", files[i].name);
	}
	assert_int_equal(counts[1] + 3, counts[0]);
}

/* A child that fails is not told as an error of the disk, whatever it was. */
static void tells_why_a_child_failed(void **state)
{
	const struct sampler_options options = { .jobs = 2 };
	struct diagnostics diagnostics = { 0 };
	struct content content;
	struct scans *scans;
	char path[256];

	(void)state;
	snprintf(path, sizeof(path), "%s/.work/samples/05-05-03", dir[0]);
	CHECK(unlink(path) == 0 && mkdir(path, 0777) == 0);
	CHECK(content_read(&content, dir[0], &diagnostics) == 0);
	CHECK(scans_create(&scans, &content) == 0);
	content.grid_points = 6;
	assert_int_equal(sampler_run(scans, &options, &diagnostics), -EISDIR);
	CHECK(strstr(diagnostics.first.text, strerror(EISDIR)) != NULL);
	CHECK(rmdir(path) == 0);
	diagnostics = (struct diagnostics){ 0 };
	CHECK(sampler_run(scans, &options, &diagnostics) == 0);
	scans_destroy(scans);
	content_release(&content);
}

static bool is_current(const char *lines)
{
	struct diagnostics diagnostics = { 0 };
	struct content content;
	struct scans *scans;
	char path[256], ini[512];
	bool current;

	snprintf(path, sizeof(path), "%s/temple.ini", dir[0]);
	snprintf(ini, sizeof(ini),
		 "[model]\nscans = box.ply\n%s\n[grid]\npoints = 8\nface_px = 256\n"
		 "quality = 95\n",
		 lines);
	CHECK(bytes_write_file((struct bytes){ (const uint8_t *)ini, strlen(ini) }, path) == 0);
	CHECK(content_read(&content, dir[0], &diagnostics) == 0);
	CHECK(scans_create(&scans, &content) == 0);
	content.grid_points = 6;
	current = sampler_is_current(scans, NULL);
	scans_destroy(scans);
	content_release(&content);
	return current;
}

static void knows_samples_of_other_settings(void **state)
{
	(void)state;
	CHECK(is_current("lit = no"));
	CHECK(is_current("lit = no\nsun = 1 0 0\nname = x")); /* unlit */
	CHECK(!is_current("lit = yes"));
	CHECK(!is_current("lit = no\ncolours = marble"));
	CHECK(!is_current("lit = no\nunit = cm"));
	CHECK(!is_current("lit = no\nbackground = #102030")); /* behind the first view */
	CHECK(!is_current("lit = no\n[view]\nstart = eye 9 9 9 target 0 0 0"));
	CHECK(is_current("lit = no"));
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(plans_grids_by_the_longest_side),
		cmocka_unit_test(sees_flat_things_from_before),
		cmocka_unit_test(finds_the_points_inside),
		cmocka_unit_test(knows_what_each_face_covers),
		cmocka_unit_test(knows_near_and_far),
		cmocka_unit_test(tiles_show_what_rays_meet),
		cmocka_unit_test(aprons_continue_into_the_neighbour),
		cmocka_unit_test(shards_add_up_to_the_whole),
		cmocka_unit_test(makes_only_what_is_missing),
		cmocka_unit_test(removes_points_that_the_grid_does_not_have),
		cmocka_unit_test(tells_why_a_child_failed),
		cmocka_unit_test(knows_samples_of_other_settings),
	};

	return cmocka_run_group_tests(tests, make_dirs, remove_dirs);
}
