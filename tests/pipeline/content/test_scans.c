/* What a build takes of .work, and what it makes again. */
#include "pipeline/content/scans.h"

#include <errno.h>
#include <sys/stat.h>
#include <unistd.h>

#include "format/picture.h"
#include "pipeline/content/scan_key.h"
#include "tests/check.h"
#include "tests/pipeline/import/scan_text.h"

static char ini_path[256];

static int make_folder(void **state)
{
	static const char ini[] = "[model]\nscans = scan.obj\n",
			  obj[] = "mtllib scan.mtl\nv 0 0 0\nv 1 0 0\nv 1 1 0\nvt 0 0\n"
				  "usemtl skin\nf 1/1 2/1 3/1\n",
			  mtl[] = "newmtl skin\nKd 0.2 0.4 0.6\nmap_Kd textures/skin.png\n";
	char path[300];

	(void)state;
	scan_write(ini_path, "temple.ini", ini, strlen(ini));
	scan_write_beside(ini_path, "scan.obj", obj, strlen(obj));
	scan_write_beside(ini_path, "scan.mtl", mtl, strlen(mtl));
	for (const char *const *name = (const char *const[]){ "textures", "pictures", NULL }; *name;
	     name++) {
		snprintf(path, sizeof(path), "%.*s/%s", (int)(strrchr(ini_path, '/') - ini_path),
			 ini_path, *name);
		CHECK(mkdir(path, 0755) == 0);
	}
	return 0;
}

static int remove_folder(void **state)
{
	(void)state;
	scan_remove(ini_path);
	return 0;
}

static void write_picture(const char *name, uint32_t side)
{
	uint8_t rgba[64] = { 0 };
	const struct picture picture = { side, side, rgba };
	struct buffer png;

	buffer_init(&png, 1 << 16);
	CHECK(picture_encode_png(&png, &picture) == 0);
	scan_write_beside(ini_path, name, png.data, png.size);
	buffer_finish(&png);
}

/* As a build does: returns how wide the scan's picture is in the mesh, and its key. */
static uint32_t width_in_mesh(struct hash *key)
{
	char folder[256];
	struct diagnostics diagnostics = { 0 };
	struct content content;
	struct scans *scans;
	const struct mesh *mesh;
	uint32_t width;

	snprintf(folder, sizeof(folder), "%.*s", (int)(strrchr(ini_path, '/') - ini_path),
		 ini_path);
	CHECK(content_read(&content, folder, &diagnostics) == 0);
	CHECK(scans_create(&scans, &content) == 0);
	CHECK(scans_key(scans, key, &diagnostics) == 0);
	CHECK(scans_get_mesh(scans, &mesh, &diagnostics) == 0);
	width = mesh->textures[mesh->materials[0]].width;
	scans_destroy(scans);
	content_release(&content);
	return width;
}

static void a_picture_below_is_seen_when_it_comes_or_changes(void **state)
{
	struct hash first, second, third;
	(void)state;

	CHECK(width_in_mesh(&first) == 1); /* a plain colour stands for it */
	write_picture("textures/skin.png", 2);
	CHECK(width_in_mesh(&second) == 2);
	CHECK(memcmp(&first, &second, sizeof(first)) != 0);
	write_picture("textures/skin.png", 4);
	CHECK(width_in_mesh(&third) == 4);
	CHECK(memcmp(&second, &third, sizeof(first)) != 0);
}

static void a_picture_of_a_page_makes_no_scan_anew(void **state)
{
	struct hash before, after;
	(void)state;

	(void)width_in_mesh(&before);
	write_picture("pictures/page.png", 3);
	(void)width_in_mesh(&after);
	CHECK(memcmp(&before, &after, sizeof(before)) == 0);
}

static struct hash key_of(const char *scan)
{
	struct diagnostics diagnostics = { 0 };
	char folder[256], ini[100];
	struct content content;
	struct scans *scans;
	struct hash key;

	snprintf(folder, sizeof(folder), "%.*s", (int)(strrchr(ini_path, '/') - ini_path),
		 ini_path);
	snprintf(ini, sizeof(ini), "[model]\nscans = %s\n", scan);
	scan_write_beside(ini_path, "temple.ini", ini, strlen(ini));
	CHECK(content_read(&content, folder, &diagnostics) == 0);
	CHECK(scans_create(&scans, &content) == 0);
	CHECK(scans_key(scans, &key, &diagnostics) == 0);
	scans_destroy(scans);
	content_release(&content);
	return key;
}

/* A photograph that somebody puts there must not cost a hierarchy and all samples. */
static void a_picture_makes_no_scan_anew_that_names_none(void **state)
{
	static const char corners[] = "0 0 0\n1 0 0\n0 1 0\n3 0 1 2\n",
			  ply[] = "element vertex 3\nproperty float x\nproperty float y\n"
				  "property float z\nelement face 1\n"
				  "property list uchar int vertex_indices\nend_header\n";
	static const struct {
		const char *name, *head, *middle;
		bool names;
	} cases[] = {
		{ "plain.ply", "ply\nformat ascii 1.0\n", ply, false },
		{ "skin.ply", "ply\nformat ascii 1.0\ncomment TextureFile skin.png\n", ply, true },
		{ "plain.off", "OFF\n3 1 0\n", "", false },
		{ "plain.stl", "solid x\n", "", false },
		{ "cut.ply", "ply\nformat ascii 1.0\n", "", true }, /* it cannot be told */
	};
	char text[400];
	(void)state;

	for (size_t i = 0; i < ARRAY_COUNT(cases); i++) {
		struct hash before, after;

		snprintf(text, sizeof(text), "%s%s%s", cases[i].head, cases[i].middle, corners);
		scan_write_beside(ini_path, cases[i].name, text, strlen(text));
		before = key_of(cases[i].name);
		write_picture("textures/photo.png", 2 + (uint32_t)i % 2);
		after = key_of(cases[i].name);
		if (hash_equal(before, after) == cases[i].names)
			fail_msg("%s", cases[i].name);
	}
}

/* Half an import, as a full disk or a power cut leaves it, is none. */
static void pictures_are_known_even_if_the_reports_were_lost(void **state)
{
	static const char ini[] = "[model]\nscans = scan.obj\n[hierarchy]\nsurface = octree\n"
				  "cell_mm = 60\n";
	static const char *const lost[] = { "imported", "shape" };
	const struct scans_shape *shape;
	struct diagnostics diagnostics = { 0 };
	struct content content;
	struct scans *scans;
	char folder[256], path[300];
	(void)state;

	scan_write_beside(ini_path, "temple.ini", ini, strlen(ini));
	write_picture("textures/skin.png", 2);
	snprintf(folder, sizeof(folder), "%.*s", (int)(strrchr(ini_path, '/') - ini_path),
		 ini_path);
	CHECK(content_read(&content, folder, &diagnostics) == 0);
	for (int i = 0; i < 2; i++) {
		CHECK(scans_create(&scans, &content) == 0);
		if (scans_get_shape(scans, &shape, &diagnostics) < 0)
			fail_msg("%s", diagnostics.first.text);
		CHECK(!shape->has_textures && shape->had_pictures);
		scans_destroy(scans);
		for (size_t k = 0; k < ARRAY_COUNT(lost); k++) {
			snprintf(path, sizeof(path), "%s/.work/%s", folder, lost[k]);
			CHECK(unlink(path) == 0);
		}
	}
	content_release(&content);
}

/* Half a file, as it is while it is copied, must not stay for the whole one. */
static void a_scan_that_changes_meanwhile_is_not_kept(void **state)
{
	static const char half[] = "v 0 0 0\nv 1 0 0\nv 1 1 0\nf 1 2 3\n";
	struct diagnostics diagnostics = { 0 };
	struct content content;
	struct scans *scans;
	const struct mesh *mesh;
	struct hash key, later;
	char folder[256];
	(void)state;

	snprintf(folder, sizeof(folder), "%.*s", (int)(strrchr(ini_path, '/') - ini_path),
		 ini_path);
	CHECK(content_read(&content, folder, &diagnostics) == 0);
	CHECK(scans_create(&scans, &content) == 0);
	CHECK(scans_key(scans, &key, &diagnostics) == 0);
	scan_write_beside(ini_path, "scan.obj", half, strlen(half));
	CHECK(scans_get_mesh(scans, &mesh, &diagnostics) == -ESTALE && !mesh);
	CHECK(strstr(diagnostics.first.text, "changed while it was read"));
	CHECK(scans_key(scans, &later, &diagnostics) == 0 && !hash_equal(key, later));
	CHECK(scans_get_mesh(scans, &mesh, &diagnostics) == 0 && mesh->triangle_count == 1);
	scans_destroy(scans);
	content_release(&content);
}

static void a_folder_of_many_scans_is_listed_once(void **state)
{
	static const char plain[] = "solid x\n", obj[] = "v 0 0 0\n";
	struct diagnostics diagnostics = { 0 };
	struct content content = { .scan_count = 0 };
	size_t sizes[4] = { 0 };
	struct buffer text;
	char folder[256], path[300];
	(void)state;

	scan_write_beside(ini_path, "a.stl", plain, strlen(plain));
	scan_write_beside(ini_path, "b.obj", obj, strlen(obj));
	scan_write_beside(ini_path, "c.obj", obj, strlen(obj));
	snprintf(folder, sizeof(folder), "%.*s", (int)(strrchr(ini_path, '/') - ini_path),
		 ini_path);
	for (uint32_t i = 0; i < 20; i++) {
		snprintf(path, sizeof(path), "textures/%u.png", i);
		write_picture(path, 2);
	}
	snprintf(path, sizeof(path), "[model]\nscans = a.stl b.obj c.obj textures/d.obj\n");
	scan_write_beside(ini_path, "temple.ini", path, strlen(path));
	scan_write_beside(ini_path, "textures/d.obj", obj, strlen(obj));
	CHECK(content_read(&content, folder, &diagnostics) == 0);
	buffer_init(&text, 1 << 20);
	for (uint32_t i = 0; i < content.scan_count; i++) {
		const size_t before = text.size;

		CHECK(scan_key_put(&text, &content, i) == 0 && text.error == 0);
		sizes[i] = text.size - before;
	}
	CHECK(sizes[1] > 20 * 24 &&
	      sizes[3] > 20 * 24); /* all pictures, after one that names none */
	CHECK(sizes[0] < 100 && sizes[2] == sizes[0]);
	buffer_finish(&text);
	content_release(&content);
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test_setup_teardown(a_picture_below_is_seen_when_it_comes_or_changes,
						make_folder, remove_folder),
		cmocka_unit_test_setup_teardown(pictures_are_known_even_if_the_reports_were_lost,
						make_folder, remove_folder),
		cmocka_unit_test_setup_teardown(a_picture_of_a_page_makes_no_scan_anew, make_folder,
						remove_folder),
		cmocka_unit_test_setup_teardown(a_scan_that_changes_meanwhile_is_not_kept,
						make_folder, remove_folder),
		cmocka_unit_test_setup_teardown(a_picture_makes_no_scan_anew_that_names_none,
						make_folder, remove_folder),
		cmocka_unit_test_setup_teardown(a_folder_of_many_scans_is_listed_once, make_folder,
						remove_folder),
	};

	return cmocka_run_group_tests(tests, NULL, NULL);
}
