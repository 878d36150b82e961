/* What a scan names and what of it is read: a file in or below the scan's own folder, and nothing
 * else of the machine that imports it. */
#include "pipeline/import/import.h"

#include <errno.h>
#include <fcntl.h>
#include <limits.h>
#include <sys/stat.h>
#include <unistd.h>

#include "format/picture.h"
#include "pipeline/import/import_files.h"
#include "tests/check.h"
#include "tests/pipeline/import/scan_text.h"

#define SECRET                                                                                     \
	"gopura-key-1 release "                                                                    \
	"abababababababababababababababababababababababababababababababab\n"

/* A folder with secrets and another one with scans, in which links and a FIFO lie:
 *
 *   secret.bin  keys/release.key
 *   scans/plain.bin  link.bin -> ../secret.bin  link -> ../keys  fifo.bin  .hidden/secret.bin
 *   scans/ours.key  deep/plain.bin */
static char top[] = "/tmp/gopura-import-XXXXXX";

static void at(char path[PATH_MAX], const char *name)
{
	snprintf(path, PATH_MAX, "%s/%s", top, name);
}

static void put(const char *name, const char *text)
{
	char path[PATH_MAX];
	FILE *file;

	at(path, name);
	file = fopen(path, "wb");
	CHECK(file && fputs(text, file) >= 0 && fclose(file) == 0);
}

static int set_up(void **state)
{
	static const char *const folders[] = { "keys", "scans", "scans/.hidden", "scans/deep" };
	char path[PATH_MAX];
	(void)state;

	CHECK(mkdtemp(top) != NULL);
	for (size_t i = 0; i < ARRAY_COUNT(folders); i++) {
		at(path, folders[i]);
		CHECK(mkdir(path, 0700) == 0);
	}
	put("keys/release.key", SECRET);
	put("scans/ours.key", SECRET);
	for (size_t i = 0; i < 4; i++) {
		static const char *const files[] = { "secret.bin", "scans/plain.bin",
						     "scans/.hidden/secret.bin",
						     "scans/deep/plain.bin" };

		put(files[i], "0123456789012345678901234567890123456789");
	}
	at(path, "scans/link.bin");
	CHECK(symlink("../secret.bin", path) == 0);
	at(path, "scans/link");
	CHECK(symlink("../keys", path) == 0);
	at(path, "scans/fifo.bin");
	CHECK(mkfifo(path, 0600) == 0);
	return 0;
}

static int tear_down(void **state)
{
	char command[PATH_MAX];
	(void)state;

	snprintf(command, sizeof(command), "rm -rf '%s'", top);
	return system(command);
}

/* A triangle whose colours are the first bytes of the file uri. */
static void put_gltf(const char *name, const char *uri)
{
	char text[PATH_MAX + 2000];

	snprintf(text, sizeof(text),
		 "{\"asset\":{\"version\":\"2.0\"},\"scene\":0,\"scenes\":[{\"nodes\":[0]}],"
		 "\"nodes\":[{\"mesh\":0}],\"meshes\":[{\"primitives\":[{\"attributes\":"
		 "{\"POSITION\":0,\"COLOR_0\":1}}]}],\"buffers\":[{\"byteLength\":36,\"uri\":"
		 "\"data:application/octet-stream;base64,"
		 "AAAAAAAAAAAAAAAAAACAPwAAAAAAAAAAAAAAAAAAgD8AAAAA\"},"
		 "{\"byteLength\":36,\"uri\":\"%s\"}],\"bufferViews\":[{\"buffer\":0,"
		 "\"byteLength\":36},{\"buffer\":1,\"byteLength\":36}],\"accessors\":["
		 "{\"bufferView\":0,\"componentType\":5126,\"count\":3,\"type\":\"VEC3\","
		 "\"min\":[0,0,0],\"max\":[1,1,0]},{\"bufferView\":1,\"componentType\":5121,"
		 "\"normalized\":true,\"count\":3,\"type\":\"VEC3\"}]}",
		 uri);
	put(name, text);
}

static int import(const char *name, struct mesh *mesh, struct import_report *report,
		  struct diagnostics *diagnostics)
{
	const struct import_options options = { 0 };
	char path[PATH_MAX];

	*diagnostics = (struct diagnostics){ 0 };
	at(path, name);
	return import_scan(mesh, path, &options, report, diagnostics);
}

/* %s stands for the top folder. */
static const struct {
	const char *name, *says;
} outside[] = {
	{ "../secret.bin", "outside the scan's folder" },
	{ "../keys/release.key", "outside the scan's folder" },
	{ "deep/../../secret.bin", "outside the scan's folder" },
	{ "%s/secret.bin", "outside the scan's folder" },
	{ "/etc/passwd", "outside the scan's folder" },
	{ "/proc/self/environ", "outside the scan's folder" },
	{ ".hidden/secret.bin", "outside the scan's folder" },
	{ "link.bin", "a link" },
	{ "link/release.key", "behind one" },
	{ "fifo.bin", "not a regular file" },
	{ "deep", "not a regular file" },
	{ "ours.key", "a signing key" },
};

static void outside_name(char name[PATH_MAX], size_t i)
{
	if (outside[i].name[0] == '%')
		snprintf(name, PATH_MAX, "%s%s", top, outside[i].name + 2);
	else
		snprintf(name, PATH_MAX, "%s", outside[i].name);
}

static void must_be_refused(const char *scan, const char *name, const char *says)
{
	struct diagnostics diagnostics = { 0 };
	struct mesh mesh;
	int rc = import(scan, &mesh, NULL, &diagnostics);

	if (rc >= 0 || !strstr(diagnostics.first.text, scan) ||
	    !strstr(diagnostics.first.text, name) || !strstr(diagnostics.first.text, says))
		fail_msg("%s with %s: rc %d, '%s'", scan, name, rc, diagnostics.first.text);
}

static void refuses_a_gltf_buffer_from_elsewhere(void **state)
{
	char name[PATH_MAX];
	(void)state;

	for (size_t i = 0; i < ARRAY_COUNT(outside); i++) {
		outside_name(name, i);
		put_gltf("scans/a.gltf", name);
		must_be_refused("scans/a.gltf", name, outside[i].says);
	}
}

static void refuses_an_obj_material_file_from_elsewhere(void **state)
{
	char name[PATH_MAX], text[PATH_MAX + 100];
	(void)state;

	for (size_t i = 0; i < ARRAY_COUNT(outside); i++) {
		outside_name(name, i);
		snprintf(text, sizeof(text), "mtllib %s\nv 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n",
			 name);
		put("scans/a.obj", text);
		must_be_refused("scans/a.obj", name, outside[i].says);
	}
}

static void reads_a_buffer_below_and_one_that_was_copied_beside(void **state)
{
	static const char *const names[] = { "plain.bin", "./deep/plain.bin",
					     "../elsewhere/plain.bin", "/somewhere/plain.bin" };
	(void)state;

	for (size_t i = 0; i < ARRAY_COUNT(names); i++) {
		struct import_report report;
		struct diagnostics diagnostics;
		struct mesh mesh;

		put_gltf("scans/b.gltf", names[i]);
		if (import("scans/b.gltf", &mesh, &report, &diagnostics) < 0)
			fail_msg("%s: %s", names[i], diagnostics.first.text);
		CHECK(report.had_colours && mesh.triangle_count == 1);
		mesh_finish(&mesh);
	}
}

static void a_missing_file_is_told_as_missing(void **state)
{
	struct diagnostics diagnostics = { 0 };
	struct mesh mesh;
	(void)state;

	put_gltf("scans/c.gltf", "nowhere.bin");
	CHECK(import("scans/c.gltf", &mesh, NULL, &diagnostics) < 0);
	if (!strstr(diagnostics.first.text, "'nowhere.bin', which is not beside it; copy"))
		fail_msg("'%s'", diagnostics.first.text);
	/* As always, where only colours are lost; a drive's name is no place of this machine. */
	put("scans/c.obj",
	    "mtllib C:\\Users\\me\\c.mtl\nmtllib gone.mtl\nv 0 0 0\nv 1 0 0\nv 0 1 0\n"
	    "f 1 2 3\n");
	CHECK(import("scans/c.obj", &mesh, NULL, &diagnostics) == 0);
	mesh_finish(&mesh);
}

/* The secrets as pictures: each would be read, if it were reached. */
static void put_pictures(void)
{
	static const char *const names[] = { "secret.bin", "keys/picture.png",
					     "scans/.hidden/secret.bin" };
	uint8_t red[4] = { 255, 0, 0, 255 };
	struct picture picture = { 1, 1, red };
	struct buffer png;
	char path[PATH_MAX];

	buffer_init(&png, 1 << 16);
	CHECK(picture_encode_png(&png, &picture) == 0);
	for (size_t i = 0; i < ARRAY_COUNT(names); i++) {
		at(path, names[i]);
		CHECK(bytes_write_file(buffer_bytes(&png), path) == 0);
	}
	buffer_finish(&png);
}

static void pictures_from_elsewhere_are_not_read(void **state)
{
	static const char *const scans[] = { "scans/d.ply", "scans/d.obj" };
	char name[PATH_MAX], text[2 * PATH_MAX];
	(void)state;

	put_pictures();
	for (size_t i = 0; i < ARRAY_COUNT(outside); i++) {
		outside_name(name, i);
		snprintf(text, sizeof(text),
			 "ply\nformat ascii 1.0\ncomment TextureFile %s\nelement vertex 3\n"
			 "property float x\nproperty float y\nproperty float z\nproperty float s\n"
			 "property float t\nelement face 1\n"
			 "property list uchar int vertex_indices\nend_header\n"
			 "0 0 0 0 0\n1 0 0 1 0\n0 1 0 0 1\n3 0 1 2\n",
			 name);
		put("scans/d.ply", text);
		snprintf(text, sizeof(text), "newmtl skin\nKd 1 1 1\nmap_Kd %s\n", name);
		put("scans/d.mtl", text);
		put("scans/d.obj", "mtllib d.mtl\nv 0 0 0\nv 1 0 0\nv 1 1 0\nvt 0 0\nusemtl skin\n"
				   "f 1/1 2/1 3/1\n");
		for (size_t k = 0; k < ARRAY_COUNT(scans); k++) {
			struct import_report report;
			struct diagnostics diagnostics;
			struct mesh mesh;

			if (import(scans[k], &mesh, &report, &diagnostics) < 0)
				fail_msg("%s with %s: %s", scans[k], name, diagnostics.first.text);
			if (report.textures != 0 || !strstr(report.warning.first.text, name) ||
			    !strstr(report.warning.first.text, outside[i].says))
				fail_msg("%s with %s: '%s'", scans[k], name,
					 report.warning.first.text);
			mesh_finish(&mesh);
		}
	}
}

/* A file that a scene names by Inline may lie in a folder with pictures of its own. */
static void a_picture_lies_beside_the_file_of_the_scene_that_names_it(void **state)
{
	struct import_report report;
	struct diagnostics diagnostics;
	struct mesh mesh;
	char from[PATH_MAX], to[PATH_MAX];
	(void)state;

	put_pictures();
	at(from, "keys/picture.png");
	at(to, "scans/deep/own.png");
	CHECK(link(from, to) == 0);
	put("scans/site.wrl", "#VRML V2.0 utf8\nInline { url \"deep/wall.wrl\" }");
	put("scans/deep/wall.wrl",
	    "#VRML V2.0 utf8\nShape { appearance Appearance { texture ImageTexture { "
	    "url \"own.png\" } } geometry Box {} }");
	if (import("scans/site.wrl", &mesh, &report, &diagnostics) < 0)
		fail_msg("%s", diagnostics.first.text);
	if (report.textures != 1)
		fail_msg("%s", report.warning.first.text);
	mesh_finish(&mesh);
}

/* As glTF writes them. A name that has the % itself comes first. */
static void names_are_decoded_if_they_are_not_there_as_written(void **state)
{
	static const struct {
		const char *name, *text; /* NULL: not opened, with rc */
		int rc;
	} cases[] = {
		{ "my%20skin.bin", "decoded", 0 },
		{ "C:/scans/my%20skin.bin", "decoded", 0 },
		{ "as%20written.bin", "as written", 0 },
		{ "no%20such.bin", NULL, -ENOENT },
		{ "%2e%2e/secret.bin", NULL, -EXDEV },
		{ "..%2fsecret.bin", NULL, -EXDEV },
		{ "%2ehidden/secret.bin", NULL, -EXDEV },
	};
	char path[PATH_MAX], text[20];
	int folder;
	(void)state;

	put("scans/my skin.bin", "decoded");
	put("scans/as%20written.bin", "as written");
	put("scans/as written.bin", "decoded");
	at(path, "scans/f.ply");
	folder = import_files_open_folder(path);
	CHECK(folder >= 0);
	for (size_t i = 0; i < ARRAY_COUNT(cases); i++) {
		const char *right = cases[i].text ? cases[i].text : "";
		int fd = import_files_open_at(folder, cases[i].name);

		memset(text, 0, sizeof(text));
		if (cases[i].text ? fd < 0 || read(fd, text, sizeof(text) - 1) < 0
				  : fd != cases[i].rc)
			fail_msg("%s: %d", cases[i].name, fd);
		if (strcmp(text, right) != 0)
			fail_msg("%s: '%s'", cases[i].name, text);
		if (fd >= 0)
			close(fd);
	}
	close(folder);
}

/* Nobody who exports on Windows sees that a name is written otherwise in the scan. */
static void the_case_of_letters_decides_only_where_it_must(void **state)
{
	static const struct {
		const char *name, *text; /* NULL: not found */
	} cases[] = {
		{ "skin.jpg", "skin" },   { "DEEP/Coat.BIN", "coat" }, { "Two.bin", NULL },
		{ "two.bin", "exactly" }, { "skin.jpeg", NULL },
	};
	char path[PATH_MAX], text[20];
	int folder;
	(void)state;

	put("scans/Skin.JPG", "skin");
	put("scans/deep/coat.bin", "coat");
	put("scans/two.bin", "exactly");
	put("scans/TWO.bin", "otherwise");
	at(path, "scans/f.ply");
	folder = import_files_open_folder(path);
	CHECK(folder >= 0);
	for (size_t i = 0; i < ARRAY_COUNT(cases); i++) {
		int fd = import_files_open_at(folder, cases[i].name);

		memset(text, 0, sizeof(text));
		if (cases[i].text ? fd < 0 || read(fd, text, sizeof(text) - 1) < 0 : fd != -ENOENT)
			fail_msg("%s: %d", cases[i].name, fd);
		if (cases[i].text && strcmp(text, cases[i].text) != 0)
			fail_msg("%s: '%s'", cases[i].name, text);
		if (fd >= 0)
			close(fd);
	}
	close(folder);
}

static void a_file_counts_once_however_often_it_is_named(void **state)
{
	static struct import_files_counted counted;
	char path[PATH_MAX];
	int folder, fds[2];
	(void)state;

	at(path, "scans/f.ply");
	put("scans/counted.bin", "twelve bytes");
	folder = import_files_open_folder(path);
	CHECK(folder >= 0);
	for (int i = 0; i < 2; i++)
		fds[i] = import_files_open_at(folder, "counted.bin");
	CHECK(fds[0] >= 0 && fds[1] >= 0);
	CHECK(import_files_count(&counted, fds[0]) == 12);
	CHECK(import_files_count(&counted, fds[1]) == 0);
	close(fds[0]);
	close(fds[1]);
	close(folder);
}

/* One picture that a scan names again and again, each time decoded. */
static void pictures_have_a_limit_together(void **state)
{
	const struct import_options options = { .memory_bytes = 100 };
	uint8_t grey[5 * 5 * 4];
	struct picture picture = { 5, 5, grey };
	struct import_report report;
	struct diagnostics diagnostics = { 0 };
	struct buffer png;
	struct mesh mesh;
	char path[PATH_MAX];
	(void)state;

	memset(grey, 99, sizeof(grey));
	buffer_init(&png, 1 << 16);
	CHECK(picture_encode_png(&png, &picture) == 0);
	at(path, "scans/five.png");
	CHECK(bytes_write_file(buffer_bytes(&png), path) == 0);
	buffer_finish(&png);
	put("scans/f.ply",
	    "ply\nformat ascii 1.0\ncomment TextureFile five.png\n"
	    "comment TextureFile five.png\ncomment TextureFile five.png\n"
	    "element vertex 3\nproperty float x\nproperty float y\nproperty float z\n"
	    "property float s\nproperty float t\nelement face 1\n"
	    "property list uchar int vertex_indices\nend_header\n"
	    "0 0 0 0 0\n1 0 0 1 0\n0 1 0 0 1\n3 0 1 2\n");
	at(path, "scans/f.ply");
	CHECK(import_scan(&mesh, path, &options, &report, &diagnostics) == 0);
	CHECK(report.textures == 1 && mesh.texture_count == 3);
	CHECK(mesh.textures[0].width == 5 && mesh.textures[1].width == 1 &&
	      mesh.textures[2].width == 1);
	CHECK(strstr(report.warning.first.text, "too large in total"));
	mesh_finish(&mesh);
}

static void a_fifo_is_no_scan(void **state)
{
	struct diagnostics diagnostics = { 0 };
	struct mesh mesh;
	(void)state;

	CHECK(import("scans/fifo.bin", &mesh, NULL, &diagnostics) == -EINVAL);
	CHECK(strstr(diagnostics.first.text, "not a regular file"));
}

/* assimp knows some fifty formats: a name must not lead to a reader that is not meant. */
static void the_name_does_not_choose_another_reader(void **state)
{
	static const char *const names[] = { "scans/e.blend", "scans/e.fbx", "scans/e" };
	struct import_report report;
	struct diagnostics diagnostics = { 0 };
	struct mesh mesh;
	(void)state;

	for (size_t i = 0; i < ARRAY_COUNT(names); i++) {
		put(names[i], "solid s\nfacet normal 0 0 1\nouter loop\nvertex 0 0 0\n"
			      "vertex 1 0 0\nvertex 0 1 0\nendloop\nendfacet\nendsolid s\n");
		if (import(names[i], &mesh, &report, &diagnostics) < 0)
			fail_msg("%s: %s", names[i], diagnostics.first.text);
		CHECK(mesh.triangle_count == 1 && strcmp(report.format, "STL") == 0);
		mesh_finish(&mesh);
	}
}

/* The same rules without assimp: names as long as names can be, and odd ones. */
static void opens_only_plain_names(void **state)
{
	char path[PATH_MAX], name[PATH_MAX + 100];
	int folder, fd;
	(void)state;

	at(path, "scans/a.ply");
	folder = import_files_open_folder(path);
	CHECK(folder >= 0);
	fd = import_files_open_at(folder, "deep//./plain.bin");
	CHECK(fd >= 0 && close(fd) == 0);
	fd = import_files_open_at(folder, ".\\deep\\plain.bin");
	CHECK(fd >= 0 && close(fd) == 0);
	CHECK(import_files_open_at(folder, "") == -ENOENT);
	CHECK(import_files_open_at(folder, "plain.bin/x") == -ENOTDIR);
	CHECK(import_files_open_at(folder, "deep/") < 0 && import_files_open_at(folder, ".") < 0 &&
	      import_files_open_at(folder, "/") < 0 && import_files_open_at(folder, "..") < 0);
	memset(name, 'a', sizeof(name));
	name[sizeof(name) - 1] = '\0';
	CHECK(import_files_open_at(folder, name) == -ENAMETOOLONG);
	name[300] = '\0';
	CHECK(import_files_open_at(folder, name) == -ENAMETOOLONG);
	name[299] = '/';
	CHECK(import_files_open_at(folder, name) == -ENAMETOOLONG);
	close(folder);
}

/* A file that a moment's lack of memory, or a slow disk, kept from being read is not "not there".
 */
static void what_may_be_read_at_the_next_try_is_an_error(void **state)
{
	const int of_the_scan[] = {
		3, 0, -ENOENT, -EXDEV, -ELOOP, -EINVAL, -EKEYREJECTED, -EACCES
	};
	struct import_files_failure failure = { 0 };
	struct diagnostics diagnostics = { 0 };

	(void)state;
	for (size_t i = 0; i < ARRAY_COUNT(of_the_scan); i++)
		import_files_note(&failure, of_the_scan[i], "stone.png");
	CHECK(import_files_judge(&failure, 0, "scan.obj", &diagnostics) == 0);
	import_files_note(&failure, -EIO, "stone.png");
	import_files_note(&failure, -EMFILE, "moss.png"); /* the first counts */
	CHECK(import_files_judge(&failure, -EBADMSG, "scan.obj", &diagnostics) == -EBADMSG);
	CHECK(diagnostics.count == 0);
	CHECK(import_files_judge(&failure, 0, "scan.obj", &diagnostics) == -EIO);
	CHECK(strstr(diagnostics.first.text, "scan.obj: 'stone.png'"));
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(refuses_a_gltf_buffer_from_elsewhere),
		cmocka_unit_test(refuses_an_obj_material_file_from_elsewhere),
		cmocka_unit_test(reads_a_buffer_below_and_one_that_was_copied_beside),
		cmocka_unit_test(a_missing_file_is_told_as_missing),
		cmocka_unit_test(pictures_from_elsewhere_are_not_read),
		cmocka_unit_test(a_picture_lies_beside_the_file_of_the_scene_that_names_it),
		cmocka_unit_test(names_are_decoded_if_they_are_not_there_as_written),
		cmocka_unit_test(the_case_of_letters_decides_only_where_it_must),
		cmocka_unit_test(a_file_counts_once_however_often_it_is_named),
		cmocka_unit_test(pictures_have_a_limit_together),
		cmocka_unit_test(a_fifo_is_no_scan),
		cmocka_unit_test(the_name_does_not_choose_another_reader),
		cmocka_unit_test(opens_only_plain_names),
		cmocka_unit_test(what_may_be_read_at_the_next_try_is_an_error),
	};

	return cmocka_run_group_tests(tests, set_up, tear_down);
}
