#include "pipeline/import/mesh.h"

#include <errno.h>
#include <fcntl.h>
#include <sys/mman.h>
#include <unistd.h>

#include "base/spill.h"
#include "pipeline/import/mesh_colour.h"
#include "pipeline/import/mesh_file.h"
#include "tests/check.h"
#include "tests/pipeline/import/scan_text.h"

static const struct hash key = { { 1, 2, 3 } };

/* Owned: everything a mesh can have, two triangles on four vertices. */
static struct mesh make_mesh(bool with_texture)
{
	static const float positions[4][3] = { { 0, 0, 0 }, { 1, 0, 0 }, { 1, 1, 0 }, { 0, 1, 2 } };
	static const float uvs[4][2] = { { 0, 0 }, { 0.99f, 0 }, { 0.99f, 0.99f }, { 0, 0.99f } };
	static const uint32_t triangles[2][3] = { { 0, 1, 2 }, { 0, 2, 3 } };
	struct mesh mesh = { .vertex_count = 4, .triangle_count = 2 };

	mesh.positions = malloc(sizeof(positions));
	mesh.triangles = malloc(sizeof(triangles));
	mesh.colours = malloc(16);
	CHECK(mesh.positions && mesh.triangles && mesh.colours);
	memcpy(mesh.positions, positions, sizeof(positions));
	memcpy(mesh.triangles, triangles, sizeof(triangles));
	memset(mesh.colours, 77, 16);
	mesh.scan_count = 1;
	mesh.scans[0] = (struct mesh_scan){ 2, 7 };
	if (!with_texture)
		return mesh;
	mesh.faces = malloc(2 * sizeof(*mesh.faces));
	CHECK(mesh.faces);
	mesh.faces[0] = 6;
	mesh.faces[1] = MESH_NO_FACE;
	mesh.uvs = malloc(sizeof(uvs));
	mesh.materials = calloc(2, sizeof(*mesh.materials));
	mesh.textures = calloc(1, sizeof(*mesh.textures));
	CHECK(mesh.uvs && mesh.materials && mesh.textures);
	memcpy(mesh.uvs, uvs, sizeof(uvs));
	mesh.texture_count = 1;
	mesh.textures[0] = (struct mesh_texture){ 2, 2, malloc(12) };
	CHECK(mesh.textures[0].rgb);
	memcpy(mesh.textures[0].rgb, "abcdefghijkl", 12);
	return mesh;
}

static void a_texel_repeats_and_counts_from_the_bottom(void **state)
{
	static const struct {
		float uv[2];
		char first;
	} cases[] = { { { 0, 0 }, 'g' },        { { 0.9f, 0.1f }, 'j' }, { { 0.1f, 0.9f }, 'a' },
		      { { 1.9f, -0.1f }, 'd' }, { { 1, 1 }, 'g' },       { { -1e-9f, 0 }, 'j' } };
	const struct mesh_texture texture = { 2, 2, (uint8_t *)"abcdefghijkl" };
	uint8_t rgb[3];
	(void)state;

	for (size_t i = 0; i < ARRAY_COUNT(cases); i++) {
		mesh_texel(&texture, cases[i].uv, rgb);
		if (rgb[0] != cases[i].first)
			fail_msg("case %zu: %c", i, rgb[0]);
	}
	mesh_texel(&texture, (float[2]){ 1e30f, -1e30f }, rgb);
	mesh_texel(&texture, (float[2]){ 0.0f / 1.0f, 1.0f }, rgb);
	CHECK(rgb[0] == 'g');
}

static void vertex_colours_come_from_the_texture_and_keep_the_sky(void **state)
{
	struct mesh mesh = make_mesh(true);
	(void)state;

	memset(mesh.textures[0].rgb, 40, 12);
	CHECK(mesh_colours_from_textures(&mesh, 2) == 0);
	for (int i = 0; i < 4; i++)
		CHECK(mesh.colours[i][1] == 40 && mesh.colours[i][3] == 77);
	mesh_finish(&mesh);
	CHECK(mesh.positions == NULL && mesh.vertex_count == 0);
	mesh_finish(&mesh);
	mesh_finish(NULL);
}

/* A chart that fills the lower left of its picture, everything beyond black: the vertices lie on
 * the border, their colours come from within. And the same place on another chart takes part. */
static void no_vertex_takes_the_colour_between_charts(void **state)
{
	enum { SIDE = 64 };
	static uint8_t rgb[SIDE * SIDE * 3];
	struct mesh mesh = make_mesh(true);
	(void)state;

	for (int y = 0; y < SIDE; y++)
		for (int x = 0; x < SIDE; x++)
			memset(rgb + (y * SIDE + x) * 3, x < SIDE / 2 && y >= SIDE / 2 ? 200 : 0,
			       3);
	free(mesh.textures[0].rgb);
	mesh.textures[0] = (struct mesh_texture){ SIDE, SIDE, malloc(sizeof(rgb)) };
	CHECK(mesh.textures[0].rgb);
	memcpy(mesh.textures[0].rgb, rgb, sizeof(rgb));
	for (int i = 0; i < 4; i++)
		for (int axis = 0; axis < 2; axis++)
			mesh.uvs[i][axis] = mesh.uvs[i][axis] > 0 ? 0.5f : 0;
	CHECK(mesh_colours_from_textures(&mesh, 2) == 0);
	for (int i = 0; i < 4; i++)
		CHECK(mesh.colours[i][0] == 200);

	memcpy(mesh.positions[3], mesh.positions[1], sizeof(mesh.positions[1]));
	for (int axis = 0; axis < 2; axis++)
		mesh.uvs[3][axis] = 0.9f; /* into the black */
	CHECK(mesh_colours_from_textures(&mesh, 2) == 0);
	CHECK(memcmp(mesh.colours[3], mesh.colours[1], 3) == 0);
	CHECK(mesh.colours[1][0] > 20 && mesh.colours[1][0] < 180);
	mesh_finish(&mesh);
}

static void appending_shifts_indices_and_fills_what_is_missing(void **state)
{
	struct mesh textured = make_mesh(true), plain = make_mesh(false), all = { 0 };
	float low[3], high[3];
	(void)state;

	CHECK(mesh_append(&all, &plain) == 0 && all.vertex_count == 4 && !all.textures);
	CHECK(mesh_append(&all, &textured) == 0);
	CHECK(all.vertex_count == 8 && all.triangle_count == 4 && all.texture_count == 2);
	CHECK(all.triangles[2][1] == 5 && all.triangles[3][2] == 7);
	CHECK(all.materials[0] == 0 && all.materials[3] == 1);
	CHECK(all.textures[0].width == 1 && all.textures[0].rgb[0] == 77);
	CHECK(memcmp(all.textures[1].rgb, "abcdefghijkl", 12) == 0);
	CHECK(all.uvs[0][0] == 0 && all.uvs[6][0] == 0.99f);
	CHECK(all.scan_count == 2 && all.scans[1].face_count == 7);
	CHECK(all.faces[0] == MESH_NO_FACE && all.faces[2] == 6 && all.faces[3] == MESH_NO_FACE);
	free(plain.colours);
	plain.colours = NULL;
	CHECK(mesh_append(&all, &plain) == 0 && all.colours[8][0] == 255 &&
	      all.colours[7][0] == 77);
	CHECK(all.texture_count == 3 && all.materials[5] == 2);
	mesh_box(&all, low, high);
	CHECK(low[2] == 0 && high[2] == 2 && high[0] == 1);
	mesh_finish(&all);
	mesh_finish(&plain);
	mesh_finish(&textured);
}

static bool same_mesh(const struct mesh *a, const struct mesh *b)
{
	return a->vertex_count == b->vertex_count && a->triangle_count == b->triangle_count &&
	       a->texture_count == b->texture_count && !a->uvs == !b->uvs &&
	       memcmp(a->positions, b->positions, a->vertex_count * 12) == 0 &&
	       memcmp(a->colours, b->colours, a->vertex_count * 4) == 0 &&
	       memcmp(a->triangles, b->triangles, a->triangle_count * 12) == 0 &&
	       a->scan_count == b->scan_count && !a->faces == !b->faces &&
	       memcmp(a->scans, b->scans, a->scan_count * sizeof(*a->scans)) == 0 &&
	       (!a->faces || memcmp(a->faces, b->faces, a->triangle_count * 4) == 0) &&
	       (!a->uvs || (memcmp(a->uvs, b->uvs, a->vertex_count * 8) == 0 &&
			    memcmp(a->materials, b->materials, a->triangle_count * 2) == 0 &&
			    memcmp(a->textures[0].rgb, b->textures[0].rgb, 12) == 0));
}

static void a_saved_mesh_loads_equal_under_its_key_only(void **state)
{
	const struct hash other = { { 9 } };
	char path[256];
	(void)state;

	for (int textured = 0; textured < 2; textured++) {
		struct mesh mesh = make_mesh(textured), loaded;

		scan_write(path, "mesh", "", 0);
		CHECK(mesh_file_save(&mesh, key, path) == 0);
		CHECK(mesh_file_load(&loaded, key, path) == 0);
		CHECK(same_mesh(&mesh, &loaded));
		mesh_finish(&loaded);
		CHECK(mesh_file_load(&loaded, other, path) == -ESTALE && !loaded.positions);
		scan_remove(path);
		CHECK(mesh_file_load(&loaded, key, path) == -ENOENT);
		mesh_finish(&mesh);
	}
}

static struct mesh make_large_mesh(void)
{
	enum { COUNT = 3000000 }; /* positions and triangles are larger than SPILL_MIN_BYTES */
	struct mesh mesh = { .vertex_count = COUNT,
			     .triangle_count = COUNT,
			     .positions = spill_alloc(COUNT * sizeof(*mesh.positions)),
			     .triangles = spill_alloc(COUNT * sizeof(*mesh.triangles)),
			     .scan_count = 1,
			     .scans = { { COUNT, 0 } } };

	CHECK(mesh.positions && mesh.triangles);
	for (uint32_t i = 0; i < COUNT; i++)
		for (uint32_t k = 0; k < 3; k++) {
			mesh.positions[i][k] = (float)i + 0.25f * (float)k;
			mesh.triangles[i][k] = (i * 7 + k) % COUNT;
		}
	return mesh;
}

static void check_large_mesh(const struct mesh *mesh)
{
	struct mesh right = make_large_mesh();

	CHECK(mesh->vertex_count == right.vertex_count &&
	      mesh->triangle_count == right.triangle_count);
	CHECK(memcmp(mesh->positions, right.positions,
		     right.vertex_count * sizeof(*right.positions)) == 0);
	CHECK(memcmp(mesh->triangles, right.triangles,
		     right.triangle_count * sizeof(*right.triangles)) == 0);
	mesh_finish(&right);
}

enum { LARGE_SIDE = 4096 };

static void check_large_picture(const struct mesh *mesh)
{
	const struct mesh_texture *picture = &mesh->textures[0];
	size_t wrong = 0;

	CHECK(picture->width == LARGE_SIDE && picture->height == LARGE_SIDE);
	for (size_t i = 0; i < (size_t)3 * LARGE_SIDE * LARGE_SIDE; i++)
		wrong += picture->rgb[i] != (uint8_t)(i % 251);
	CHECK(wrong == 0);
}

/* As a reader process returns it: the picture lies in an array of its own, as large ones do. */
static void a_moved_picture_is_its_file(void **state)
{
	struct mesh mesh = make_mesh(true), loaded;
	const size_t bytes = (size_t)3 * LARGE_SIDE * LARGE_SIDE;
	char path[256];
	(void)state;

	free(mesh.textures[0].rgb);
	mesh.textures[0] = (struct mesh_texture){ LARGE_SIDE, LARGE_SIDE, spill_alloc(bytes) };
	CHECK(bytes >= SPILL_MIN_BYTES && mesh.textures[0].rgb);
	for (size_t i = 0; i < bytes; i++)
		mesh.textures[0].rgb[i] = (uint8_t)(i % 251);
	scan_write(path, "mesh", "", 0);
	CHECK(mesh_file_move(&mesh, key, path) == 0);
	check_large_picture(&mesh);
	mesh_finish(&mesh);
	CHECK(mesh_file_load(&loaded, key, path) == 0);
	check_large_picture(&loaded);
	mesh_finish(&loaded);
	scan_remove(path);
}

/* Its chunks are hashed by several threads. */
static void a_moved_mesh_is_its_file(void **state)
{
	static const off_t places[] = { 100, (1 << 20) - 1, 1 << 20, 40 << 20, 60 << 20 };
	struct mesh mesh = make_large_mesh(), loaded;
	char path[256];
	int fd;
	(void)state;

	scan_write(path, "mesh", "", 0);
	CHECK(mesh_file_move(&mesh, key, path) == 0);
	check_large_mesh(&mesh);
	mesh_finish(&mesh);
	CHECK(mesh_file_load(&loaded, key, path) == 0);
	check_large_mesh(&loaded);
	mesh_finish(&loaded);
	fd = open(path, O_RDWR | O_CLOEXEC);
	for (size_t i = 0; i < sizeof(places) / sizeof(places[0]); i++) {
		uint8_t byte;

		CHECK(pread(fd, &byte, 1, places[i]) == 1);
		byte ^= 1;
		CHECK(pwrite(fd, &byte, 1, places[i]) == 1);
		CHECK(mesh_file_load(&loaded, key, path) == -EBADMSG && !loaded.positions);
		byte ^= 1;
		CHECK(pwrite(fd, &byte, 1, places[i]) == 1);
	}
	close(fd);
	scan_remove(path);
}

/* As the import does with what a reader process made: it places, repairs and appends it. */
static void a_mesh_that_is_read_can_be_changed_however_large(void **state)
{
	struct mesh mesh = make_large_mesh(), read;
	const size_t count = mesh.triangle_count;
	int fd = memfd_create("mesh", MFD_CLOEXEC);
	(void)state;

	CHECK(fd >= 0 && mesh_file_write(fd, &mesh, key) == 0 && lseek(fd, 0, SEEK_SET) == 0);
	mesh_finish(&mesh);
	CHECK(mesh_file_read(&read, key, fd) == 0);
	close(fd);
	check_large_mesh(&read);
	read.positions[0][0] = 7;
	read.triangles[count - 1][2] = 5;
	CHECK(SPILL_RESIZE(read.triangles, count, count + 1) == 0);
	CHECK(read.positions[0][0] == 7 && read.triangles[count - 1][2] == 5);
	mesh_finish(&read);
}

static int read_back(const uint8_t *bytes, size_t size)
{
	int fd = memfd_create("mesh", MFD_CLOEXEC);
	struct mesh mesh;
	int rc;

	CHECK(fd >= 0 && write(fd, bytes, size) == (ssize_t)size && lseek(fd, 0, SEEK_SET) == 0);
	rc = mesh_file_read(&mesh, key, fd);
	close(fd);
	CHECK(rc == 0 || (!mesh.positions && !mesh.textures));
	mesh_finish(&mesh);
	return rc;
}

static void every_truncation_and_every_flipped_byte_is_noticed(void **state)
{
	struct mesh mesh = make_mesh(true);
	int fd = memfd_create("mesh", MFD_CLOEXEC);
	uint8_t bytes[1024];
	ssize_t size;
	(void)state;

	CHECK(fd >= 0 && mesh_file_write(fd, &mesh, key) == 0 && lseek(fd, 0, SEEK_SET) == 0);
	size = read(fd, bytes, sizeof(bytes));
	close(fd);
	CHECK(size > 200 && size < (ssize_t)sizeof(bytes));
	CHECK(read_back(bytes, (size_t)size) == 0);
	for (ssize_t n = 0; n < size; n++)
		CHECK(read_back(bytes, (size_t)n) == -EBADMSG);
	for (ssize_t n = 0; n < size; n++) {
		bytes[n] ^= 0x81;
		if (read_back(bytes, (size_t)size) == 0)
			fail_msg("byte %zd was flipped and nobody noticed", n);
		bytes[n] ^= 0x81;
	}
	CHECK(read_back(bytes, (size_t)size + 1) == -EBADMSG);
	mesh_finish(&mesh);
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(a_texel_repeats_and_counts_from_the_bottom),
		cmocka_unit_test(vertex_colours_come_from_the_texture_and_keep_the_sky),
		cmocka_unit_test(no_vertex_takes_the_colour_between_charts),
		cmocka_unit_test(appending_shifts_indices_and_fills_what_is_missing),
		cmocka_unit_test(a_saved_mesh_loads_equal_under_its_key_only),
		cmocka_unit_test(a_moved_picture_is_its_file),
		cmocka_unit_test(a_moved_mesh_is_its_file),
		cmocka_unit_test(a_mesh_that_is_read_can_be_changed_however_large),
		cmocka_unit_test(every_truncation_and_every_flipped_byte_is_noticed),
	};

	return cmocka_run_group_tests(tests, NULL, NULL);
}
