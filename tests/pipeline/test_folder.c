#include <errno.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "pipeline/folder.h"
#include "tests/check.h"

static char dir[64];

static int make_dir(void **state)
{
	(void)state;
	snprintf(dir, sizeof(dir), "/tmp/gopura-folder-XXXXXX");
	return mkdtemp(dir) ? 0 : -1;
}

static int remove_dir(void **state)
{
	char command[128];

	(void)state;
	snprintf(command, sizeof(command), "rm -rf %s", dir);
	return system(command);
}

static void put(const char *name, const char *text)
{
	char path[128];

	snprintf(path, sizeof(path), "%s/%s", dir, name);
	CHECK(bytes_write_file((struct bytes){ (const uint8_t *)text, strlen(text) }, path) == 0);
}

static void reads_every_key(void **state)
{
	struct fault fault = { "" };
	struct folder folder;

	(void)state;
	put("temple.ini", "[model]\nname = Prasat\nscans = a.ply, b.obj c.ply\nup = y\nunit = cm\n"
			  "colours = \"#102030\"\nlit = no\nsun = 0 3 4\nbackground = #ffffff\n"
			  "[view]\nstart = eye 1 2 3 target 4 5 6.5\n"
			  "[grid]\npoints = 12\nface_px = 1024\nquality = 80\nbelow_ground = yes\n"
			  "[hierarchy]\nkind = tree\npatch_triangles = 500\n"
			  "[release]\npublish_share = 0.25\nlanguages = en fr km\n");
	CHECK(folder_open(&folder, dir, &fault) == 0);
	CHECK(strcmp(folder.name, "Prasat") == 0 && folder.scan_count == 3);
	CHECK(strcmp(folder.scans[1], "b.obj") == 0 && strcmp(folder.scans[2], "c.ply") == 0);
	CHECK(folder.import.up == IMPORT_Y_UP && folder.import.metres_per_unit == 0.01);
	CHECK(folder.colours == FOLDER_ONE_COLOUR && folder.colour[1] == 0x20);
	CHECK(folder.import.override_colour && folder.import.default_colour[2] == 0x30);
	CHECK(folder.lit == FOLDER_NO && fabsf(folder.sun[2] - 0.8f) < 1e-6f);
	CHECK(folder.background[0] == 255);
	CHECK(folder.has_start && folder.start_eye_m[2] == 3 && folder.start_target_m[2] == 6.5f);
	CHECK(folder.grid_points == 12 && folder.face_px == 1024 && folder.quality == 80);
	CHECK(folder.below_ground && folder.tree && folder.patch_triangles == 500);
	CHECK(fabs(folder.publish_share - 0.25) < 1e-6);
	CHECK(folder.language_count == 3 && strcmp(folder.languages[2], "km") == 0);
}

static void has_defaults_for_all_but_scans(void **state)
{
	struct fault fault = { "" };
	struct folder folder;

	(void)state;
	put("temple.ini", "[model]\nscans = a.ply\n");
	CHECK(folder_open(&folder, dir, &fault) == 0);
	CHECK(folder.grid_points == 8 && folder.face_px == 512 && folder.quality == 75);
	CHECK(folder.colours == FOLDER_SCAN_COLOURS && folder.lit == FOLDER_BY_SCAN);
	put("temple.ini", "[grid]\npoints = 8\n");
	CHECK(folder_open(&folder, dir, &fault) == -EINVAL && strstr(fault.text, "scans"));
	CHECK(folder_open(&folder, "/nonexistent", &fault) == -ENOENT);
}

static void names_line_and_cure(void **state)
{
	static const char *const faults[] = {
		"[model]\nscans = a\nup = w\n",
		"[model]\nscans = a\nunit = feet\n",
		"[model]\nscans = a\nsun = 0 0 0\n",
		"[model]\nscans = a\nsun = 1 2\n",
		"[model]\nscans = a\nlit = maybe\n",
		"[model]\nscans = a\ncolours = red\n",
		"[model]\nscans = a\ncolour = scan\n",
		"[model]\nscans = a\nbackground = #12345\n",
		"[grid]\n\npoints = 1\n",
		"[grid]\n\nface_px = 500\n",
		"[grid]\n\nquality = -3\n",
		"[hierarchy]\n\nkind = forest\n",
		"[release]\n\npublish_share = 2\n",
		"[view]\n\nstart = 1 2 3\n",
		"[nothing]\n\nkey = 1\n",
	};

	(void)state;
	for (size_t i = 0; i < ARRAY_COUNT(faults); i++) {
		struct fault fault = { "" };
		struct folder folder;

		put("temple.ini", faults[i]);
		CHECK(folder_open(&folder, dir, &fault) == -EINVAL);
		CHECK(strstr(fault.text, "temple.ini, line 3:"));
	}
}

static const char ply[] = "ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\n"
			  "property float y\nproperty float z\nelement face 1\n"
			  "property list uchar int vertex_indices\nend_header\n"
			  "0 0 0\n100 0 0\n0 100 0\n3 0 1 2\n";

static void imports_once_and_keeps_it(void **state)
{
	struct fault fault = { "" };
	struct folder folder;
	struct mesh mesh;
	struct hash key, again, other;
	char path[128];

	(void)state;
	put("temple.ini", "[model]\nscans = a.ply b.ply\nunit = cm\n");
	put("a.ply", ply);
	CHECK(folder_open(&folder, dir, &fault) == 0);
	CHECK(folder_mesh(&folder, &mesh, &key, &fault) == -ENOENT && strstr(fault.text, "b.ply"));
	put("b.ply", ply);
	CHECK(folder_mesh(&folder, &mesh, &key, &fault) == 0);
	CHECK(mesh.triangle_count == 2 && mesh.positions[1][0] == 1);
	CHECK(folder_lit(&folder, &mesh));
	mesh_finish(&mesh);
	snprintf(path, sizeof(path), "%s/.work/mesh", dir);
	CHECK(access(path, R_OK) == 0);
	CHECK(folder_mesh(&folder, &mesh, &again, &fault) == 0);
	CHECK(hash_equal(key, again) && mesh.triangle_count == 2);
	mesh_finish(&mesh);
	folder.import.up = IMPORT_Y_UP;
	CHECK(folder_mesh(&folder, &mesh, &other, &fault) == 0 && !hash_equal(key, other));
	mesh_finish(&mesh);
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(reads_every_key),
		cmocka_unit_test(has_defaults_for_all_but_scans),
		cmocka_unit_test(names_line_and_cure),
		cmocka_unit_test(imports_once_and_keeps_it),
	};

	return cmocka_run_group_tests(tests, make_dir, remove_dir);
}
