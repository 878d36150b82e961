#include "pipeline/import/import.h"

#include <errno.h>
#include <math.h>
#include <sys/mman.h>
#include <unistd.h>

#include "base/bytes.h"
#include "tests/check.h"
#include "tests/pipeline/import/import_text.h"

/* Above 0 if a face shows its outside to +z. */
static float up_of(const struct mesh *mesh, uint32_t i)
{
	const float *a = mesh->positions[mesh->triangles[i][0]];
	const float *b = mesh->positions[mesh->triangles[i][1]];
	const float *c = mesh->positions[mesh->triangles[i][2]];

	return (b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0]);
}

static void repairs_and_counts(void **state)
{
	static const char text[] =
		"ply\nformat ascii 1.0\nelement vertex 9\nproperty float x\nproperty float y\n"
		"property float z\nelement face 6\nproperty list uchar int vertex_indices\n"
		"end_header\n0 0 0\n1 0 0\n0 1 0\n0 0 1\n1 0 0\n-0 0 0\nnan 0 0\n5 5 5\n0 -1 0\n"
		"3 0 1 2\n" /* kept */
		"3 5 3 4\n" /* kept, on merged vertices */
		"3 0 1 4\n" /* degenerate: 1 and 4 are one place */
		"3 2 2 3\n" /* degenerate */
		"3 6 1 2\n" /* not finite */
		"3 4 0 8\n" /* kept: the third on the edge 0-1 */;
	const struct import_options options = { 0 };
	struct import_report report;
	struct diagnostics diagnostics = { 0 };
	struct mesh mesh;
	(void)state;

	CHECK(import_text(&mesh, &report, "odd.ply", text, &options, &diagnostics) == 0);
	CHECK(mesh.triangle_count == 3 && mesh.vertex_count == 5);
	CHECK(report.repairs.degenerate_faces == 2 && report.repairs.lost_faces == 1);
	CHECK(report.repairs.merged_vertices == 2 && report.repairs.unused_vertices == 2);
	CHECK(report.repairs.non_manifold_edges == 1 && report.repairs.border_edges == 6);
	CHECK(report.repairs.turned_edges == 0);
	CHECK(mesh.triangles[1][0] == 0 && mesh.triangles[1][2] == 1);
	/* Lists of faces count as the file does. */
	CHECK(mesh.scan_count == 1 && mesh.scans[0].triangle_count == 3);
	CHECK(mesh.scans[0].face_count == 6);
	CHECK(mesh.faces[0] == 0 && mesh.faces[1] == 1 && mesh.faces[2] == 5);
	CHECK(mesh.colours && mesh.colours[0][0] == 186 && mesh.colours[0][3] == 255);
	CHECK(!report.had_colours && strcmp(report.format, "PLY") == 0);
	mesh_finish(&mesh);
}

/* A strip of five squares, its first face (and the last square) showing the other side. */
static void turns_the_smaller_part_to_the_side_of_the_larger(void **state)
{
	static const char off[] =
		"OFF\n12 10 0\n0 0 0\n0 1 0\n1 0 0\n1 1 0\n2 0 0\n2 1 0\n3 0 0\n3 1 0\n4 0 0\n"
		"4 1 0\n5 0 0\n5 1 0\n3 1 2 0\n3 1 2 3\n3 2 4 3\n3 3 4 5\n3 4 6 5\n3 5 6 7\n"
		"3 6 8 7\n3 7 8 9\n3 9 10 8\n3 9 11 10\n";
	const struct import_options options = { 0 };
	struct import_report report;
	struct diagnostics diagnostics = { 0 };
	struct mesh mesh;
	(void)state;

	CHECK(import_text(&mesh, &report, "strip.off", off, &options, &diagnostics) == 0);
	CHECK(report.repairs.turned_faces == 3 && report.repairs.turned_edges == 0);
	CHECK(report.repairs.border_edges == 12 && mesh.triangle_count == 10);
	for (uint32_t i = 0; i < mesh.triangle_count; i++)
		if (!(up_of(&mesh, i) > 0))
			fail_msg("face %u shows the wrong side", i);
	mesh_finish(&mesh);
}

/* Five triangles around: a band with half a twist, which has one side only. */
static void a_surface_with_one_side_stays_as_it_is(void **state)
{
	static const char off[] = "OFF\n5 5 0\n0 0 0\n2 0 1\n2 2 0\n1 3 1\n-1 2 2\n3 0 1 2\n"
				  "3 1 3 2\n3 2 3 4\n3 3 0 4\n3 4 0 1\n";
	const struct import_options options = { 0 };
	struct import_report report;
	struct diagnostics diagnostics = { 0 };
	struct mesh mesh;
	(void)state;

	CHECK(import_text(&mesh, &report, "band.off", off, &options, &diagnostics) == 0);
	CHECK(report.repairs.turned_faces == 0 && report.repairs.turned_edges == 1);
	mesh_finish(&mesh);
}

static void colours_part_what_is_at_one_place(void **state)
{
	static const char text[] =
		"ply\nformat ascii 1.0\nelement vertex 6\nproperty float x\nproperty float y\n"
		"property float z\nproperty uchar red\nproperty uchar green\nproperty uchar blue\n"
		"element face 2\nproperty list uchar int vertex_indices\nend_header\n"
		"0 0 0 1 1 1\n1 0 0 1 1 1\n0 1 0 1 1 1\n1 0 0 1 1 1\n0 0 0 9 9 9\n0 -1 0 1 1 1\n"
		"3 0 1 2\n3 3 4 5\n";
	struct import_options options = { 0 };
	struct import_report report;
	struct diagnostics diagnostics = { 0 };
	struct mesh mesh;
	(void)state;

	CHECK(import_text(&mesh, &report, "two.ply", text, &options, &diagnostics) == 0);
	/* 1 and 3 are one; 0 and 4 differ in colour, but the edge between is no border. */
	CHECK(mesh.vertex_count == 5 && report.repairs.merged_vertices == 1);
	CHECK(report.repairs.border_edges == 4 && report.had_colours);
	mesh_finish(&mesh);

	options.override_colour = true;
	options.default_colour[0] = 200;
	CHECK(import_text(&mesh, &report, "two.ply", text, &options, &diagnostics) == 0);
	CHECK(mesh.vertex_count == 4 && mesh.colours[3][0] == 200 && mesh.colours[3][1] == 0);
	mesh_finish(&mesh);
}

static void turns_up_and_scales_to_metres(void **state)
{
	static const char obj[] = "v 1 2 3\nv 4 2 3\nv 1 5 3\nf 1 2 3\n";
	static const struct {
		enum import_axis up;
		float first[3], normal[3];
	} cases[] = {
		{ IMPORT_Z_UP, { 1, 2, 3 }, { 0, 0, 1 } },
		{ IMPORT_Y_UP, { 1, -3, 2 }, { 0, -1, 0 } },
		{ IMPORT_X_UP, { 2, 3, 1 }, { 0, 1, 0 } },
	};
	struct diagnostics diagnostics = { 0 };
	struct mesh mesh;
	(void)state;

	for (size_t i = 0; i < ARRAY_COUNT(cases); i++) {
		const struct import_options options = { .up = cases[i].up,
							.metres_per_unit = 0.01 };
		const float *n = cases[i].normal, *f = cases[i].first;
		float a[3], b[3], cross[3];

		CHECK(import_text(&mesh, NULL, "t.obj", obj, &options, &diagnostics) == 0);
		CHECK(mesh.triangle_count == 1 && mesh.vertex_count == 3);
		CHECK(is_near(mesh.positions[0], f[0] / 100, f[1] / 100, f[2] / 100));
		for (int k = 0; k < 3; k++) {
			a[k] = mesh.positions[1][k] - mesh.positions[0][k];
			b[k] = mesh.positions[2][k] - mesh.positions[0][k];
		}
		for (int k = 0; k < 3; k++)
			cross[k] =
				a[(k + 1) % 3] * b[(k + 2) % 3] - a[(k + 2) % 3] * b[(k + 1) % 3];
		/* still counter-clockwise: nothing was mirrored */
		CHECK(is_near(cross, n[0] * 9e-4f, n[1] * 9e-4f, n[2] * 9e-4f));
		mesh_finish(&mesh);
	}
}

/* First the matrix, in the file's unit and axes, then axes and unit: a quarter turn about x, and a
 * shift. */
static void places_a_scan_before_turning_and_scaling_it(void **state)
{
	static const char *const names[] = { "t.obj", "t.ply" };
	static const char *const texts[] = {
		"v 1 2 3\nv 4 2 3\nv 1 5 3\nf 1 2 3\n",
		"ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty float y\n"
		"property float z\nelement face 1\nproperty list uchar int vertex_indices\n"
		"end_header\n1 2 3\n4 2 3\n1 5 3\n3 0 1 2\n",
	};
	static const struct transform turn = {
		{ { 1, 0, 0, 10 }, { 0, 0, -1, 20 }, { 0, 1, 0, 30 } }
	};
	const struct import_options options = { .up = IMPORT_Y_UP,
						.metres_per_unit = 0.01,
						.transform = &turn };
	struct diagnostics diagnostics;
	struct mesh mesh;
	(void)state;

	for (size_t i = 0; i < ARRAY_COUNT(names); i++) {
		CHECK(import_text(&mesh, NULL, names[i], texts[i], &options, &diagnostics) == 0);
		/* 1 2 3 is placed at 11 17 32, which with y up is 11 -32 17 */
		CHECK(is_near(mesh.positions[0], 0.11f, -0.32f, 0.17f));
		CHECK(is_near(mesh.positions[1], 0.14f, -0.32f, 0.17f));
		CHECK(is_near(mesh.positions[2], 0.11f, -0.35f, 0.17f));
		CHECK(up_of(&mesh, 0) < 0);
		mesh_finish(&mesh);
	}
}

/* A mirrored scan still shows its outside. */
static void a_mirrored_scan_keeps_its_outside(void **state)
{
	static const char *const names[] = { "t.off", "t.ply" };
	static const char *const texts[] = {
		"OFF\n4 2 0\n0 0 0\n1 0 0\n1 1 0\n0 1 0\n3 0 1 2\n3 0 2 3\n",
		"ply\nformat ascii 1.0\nelement vertex 4\nproperty float x\nproperty float y\n"
		"property float z\nelement face 2\nproperty list uchar int vertex_indices\n"
		"end_header\n0 0 0\n1 0 0\n1 1 0\n0 1 0\n3 0 1 2\n3 0 2 3\n",
	};
	static const struct transform mirror = {
		{ { -1, 0, 0, 0 }, { 0, 1, 0, 0 }, { 0, 0, 1, 0 } }
	};
	const struct import_options options = { .transform = &mirror };
	struct diagnostics diagnostics;
	struct import_report report;
	struct mesh mesh;
	(void)state;

	for (size_t i = 0; i < ARRAY_COUNT(names); i++) {
		CHECK(import_text(&mesh, &report, names[i], texts[i], &options, &diagnostics) == 0);
		CHECK(mesh.triangle_count == 2 && up_of(&mesh, 0) > 0 && up_of(&mesh, 1) > 0);
		CHECK(report.low_m[0] == -1 && report.high_m[0] == 0);
		mesh_finish(&mesh);
	}
}

/* A float knows places there to 0.1 m: the file's doubles are moved before they become floats. */
static void a_ply_of_doubles_is_placed_with_all_its_digits(void **state)
{
	static const char ply[] =
		"ply\nformat ascii 1.0\nelement vertex 3\nproperty double x\nproperty double y\n"
		"property double z\nelement face 1\nproperty list uchar int vertex_indices\n"
		"end_header\n448210.001 1484770.002 0\n448211.003 1484770.002 0\n"
		"448210.001 1484771.004 0\n3 0 1 2\n";
	static const struct transform home = {
		{ { 1, 0, 0, -448210 }, { 0, 1, 0, -1484770 }, { 0, 0, 1, 0 } }
	};
	const struct import_options options = { .transform = &home };
	struct diagnostics diagnostics;
	struct import_report report;
	struct mesh mesh;
	(void)state;

	CHECK(import_text(&mesh, &report, "far.ply", ply, &options, &diagnostics) == 0);
	CHECK(is_near(mesh.positions[0], 0.001f, 0.002f, 0));
	CHECK(is_near(mesh.positions[1], 1.003f, 0.002f, 0));
	CHECK(is_near(mesh.positions[2], 0.001f, 1.004f, 0));
	CHECK(report.warning.count == 0);
	mesh_finish(&mesh);
}

/* As the second scan of a folder: the reader process begins with what the first one takes. */
static void a_small_scan_is_read_beside_a_large_one(void **state)
{
	static const char obj[] = "v 0 0 0\nv 1 0 0\nv 1 1 0\nf 1 2 3\n";
	const size_t large = (size_t)8 << 30;
	void *other =
		mmap(NULL, large, PROT_NONE, MAP_PRIVATE | MAP_ANONYMOUS | MAP_NORESERVE, -1, 0);
	const struct import_options options = { 0 };
	struct diagnostics diagnostics;
	struct mesh mesh;
	(void)state;

	CHECK(other != MAP_FAILED);
	if (import_text(&mesh, NULL, "small.obj", obj, &options, &diagnostics) < 0)
		fail_msg("%s", diagnostics.first.text);
	CHECK(mesh.triangle_count == 1);
	mesh_finish(&mesh);
	munmap(other, large);
}

static void what_was_left_out_is_a_warning(void **state)
{
	static const struct {
		const char *name, *text, *says;
	} cases[] = {
		{ "mtl.obj", "mtllib gone.mtl\nv 0 0 0\nv 1 0 0\nv 1 1 0\nusemtl skin\nf 1 2 3\n",
		  "mtl.obj: it names 'gone.mtl', which is not beside it: its colours are left out; "
		  "copy" },
		{ "line.obj", "v 0 0 0\nv 1 0 0\nv 1 1 0\nf 1 2 3\nl 1 2\np 3\n",
		  "line.obj: 2 points or lines in it were left out" },
		{ "site.obj", "v 4000000 0 0\nv 4005000 0 0\nv 4005000 5000 0\nf 1 2 3\n",
		  "site.obj: it lies 4005000 m from the origin and is 5000.00 m large, so places "
		  "are known to 240.3 mm" },
		{ "edge.ply",
		  "ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty float y\n"
		  "property float z\nelement face 3\nproperty list uchar int vertex_indices\n"
		  "element edge 2\nproperty int vertex1\nproperty int vertex2\nend_header\n"
		  "0 0 0\n1 0 0\n0 1 0\n3 0 1 2\n2 0 1\n1 0\n0 1\n1 2\n",
		  "edge.ply: 4 points or lines in it were left out" },
	};
	const struct import_options options = { 0 };
	struct diagnostics diagnostics;
	struct import_report report;
	struct mesh mesh;
	(void)state;

	for (size_t i = 0; i < ARRAY_COUNT(cases); i++) {
		CHECK(import_text(&mesh, &report, cases[i].name, cases[i].text, &options,
				  &diagnostics) == 0);
		CHECK(mesh.triangle_count == 1);
		if (!strstr(report.warning.first.text, cases[i].says))
			fail_msg("%s: '%s'", cases[i].name, report.warning.first.text);
		mesh_finish(&mesh);
	}
}

static void reads_stl_and_off(void **state)
{
	static const char stl[] = "solid s\nfacet normal 0 0 1\nouter loop\nvertex 0 0 0\n"
				  "vertex 1 0 0\nvertex 0 1 0\nendloop\nendfacet\nendsolid s\n";
	static const char off[] = "OFF\n4 2 0\n0 0 0\n1 0 0\n1 1 0\n0 1 0\n3 0 1 2\n3 0 2 3\n";
	const struct import_options options = { 0 };
	struct import_report report;
	struct diagnostics diagnostics = { 0 };
	struct mesh mesh;
	(void)state;

	CHECK(import_text(&mesh, &report, "a.stl", stl, &options, &diagnostics) == 0);
	CHECK(mesh.triangle_count == 1 && strcmp(report.format, "STL") == 0);
	mesh_finish(&mesh);
	CHECK(import_text(&mesh, &report, "a.off", off, &options, &diagnostics) == 0);
	CHECK(mesh.triangle_count == 2 && mesh.vertex_count == 4 && !report.had_colours);
	mesh_finish(&mesh);
}

static void refuses_what_is_no_surface(void **state)
{
	static const struct {
		const char *name, *text, *says;
	} cases[] = {
		{ "empty.obj", "", "empty" },
		{ "scan.txt", "hello", "not a supported scan format" },
		{ "nan.ply",
		  "ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty float y\n"
		  "property float z\nelement face 1\nproperty list uchar int vertex_indices\n"
		  "end_header\nnan 0 0\n1 0 0\n0 1 0\n3 0 1 2\n",
		  "none of its faces is usable" },
		{ "line.obj", "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 2 2 2\nl 1 2\nl 3 4\n", "no faces" },
		{ "index.obj", "v 0 0 0\nv 1 0 0\nv 1 1 0\nf 1 2 9\n", "OBJ reader says" },
		{ "half.gltf", "{\"asset\":{\"version\":\"2.0\"},",
		  "glTF reader says: it is damaged, or its name tells another format; export" },
		{ "half.glb", "glTF\2\0\0\0", "GLB reader says: it is damaged" },
		{ "edges.ply",
		  "ply\nformat ascii 1.0\nelement vertex 2\nproperty float x\nproperty float y\n"
		  "property float z\nelement edge 1\nproperty int vertex1\nproperty int vertex2\n"
		  "end_header\n0 0 0\n1 0 0\n0 1\n",
		  "points or lines but no faces; a cloud with normals becomes a surface as a scan" },
		{ "draco.gltf", "{\"extensionsRequired\":[\"KHR_draco_mesh_compression\"]}",
		  "npx @gltf-transform/cli copy IN.glb OUT.glb" },
		{ "quantised.gltf",
		  "{ \"extensionsRequired\" : [ \"KHR_materials_unlit\", "
		  "\"KHR_mesh_quantization\" ] }",
		  "cli dequantize" },
		{ "shorts.gltf",
		  "{\"accessors\":[{\"componentType\":5126},{\"componentType\":5123}],\"meshes\":[{"
		  "\"primitives\":[{\"attributes\":{\"POSITION\":0,\"TEXCOORD_0\":1}}]}]}",
		  "texture coordinates are quantised, which is not read here; convert it" },
		{ "strange.gltf",
		  "{\"accessors\":{\"a\":[7]},\"meshes\":[{\"primitives\":[{\"attributes\":"
		  "{\"TEXCOORD_0\":1e300}},{\"attributes\":[3]},4]},5]}",
		  "glTF reader says" },
		{ "buffer.gltf",
		  "{\"asset\":{\"version\":\"2.0\"},\"scene\":0,\"scenes\":[{\"nodes\":[0]}],\"nodes\":["
		  "{\"mesh\":0}],\"buffers\":[{\"uri\":\"scene.bin\","
		  "\"byteLength\":4}],\"bufferViews\":[{\"buffer\":0,\"byteLength\":4}],"
		  "\"accessors\":[{\"bufferView\":0,\"componentType\":5126,\"count\":1,"
		  "\"type\":\"SCALAR\"}],\"meshes\":[{\"primitives\":[{\"attributes\":{"
		  "\"POSITION\":0}}]}]}",
		  "it names 'scene.bin', which is not beside it; copy that file beside the scan" },
		{ "webp.gltf", "{\"extensionsRequired\":[\"EXT_texture_webp\"]}",
		  "png --formats webp" },
		{ "new.gltf", "{\"extensionsRequired\":[\"ACME_of_tomorrow\"]}",
		  "requires the extension ACME_of_tomorrow" },
		{ "harmless.gltf", "{\"extensionsRequired\":[\"KHR_materials_unlit\"],",
		  "glTF reader says" },
		{ "unended.gltf", "{\"extensionsRequired\":[\"KHR_draco", "glTF reader says" },
	};
	const struct import_options options = { 0 };
	struct diagnostics diagnostics = { 0 };
	struct mesh mesh;
	(void)state;

	for (size_t i = 0; i < ARRAY_COUNT(cases); i++) {
		int rc = import_text(&mesh, NULL, cases[i].name, cases[i].text, &options,
				     &diagnostics);

		if (rc >= 0 || !strstr(diagnostics.first.text, cases[i].says) || mesh.positions)
			fail_msg("%s: rc %d, '%s'", cases[i].name, rc, diagnostics.first.text);
	}
	diagnostics = (struct diagnostics){ 0 };
	CHECK(import_scan(&mesh, "/nowhere.ply", &options, NULL, &diagnostics) == -ENOENT);
	CHECK(import_scan(&mesh, "/tmp", &options, NULL, &diagnostics) == -EINVAL);
}

/* A scan that names what its reader would read wrong behind 64 MB of something else. */
static void looks_at_all_of_a_gltf(void **state)
{
	static const char head[] = "{\"asset\":{\"version\":\"2.0\",\"copyright\":\"",
			  tail[] = "\"},\"extensionsRequired\":[\"KHR_mesh_quantization\"]}";
	const size_t middle = 65 << 20, size = sizeof(head) - 1 + middle + sizeof(tail) - 1;
	char *text = malloc(size), path[256];
	struct diagnostics diagnostics = { 0 };
	(void)state;

	CHECK(text != NULL);
	memcpy(text, head, sizeof(head) - 1);
	memset(text + sizeof(head) - 1, 'a', middle);
	memcpy(text + size - (sizeof(tail) - 1), tail, sizeof(tail) - 1);
	scan_write(path, "long.gltf", text, size);
	free(text);
	CHECK(import_check(path, &diagnostics) == -ENOTSUP);
	CHECK(strstr(diagnostics.first.text, "cli dequantize"));
	scan_remove(path);
}

/* Its arrays need files, and the cure is no other scan. */
static void names_the_folder_where_no_temporary_file_can_be_made(void **state)
{
	static const char ply[] =
		"ply\nformat binary_little_endian 1.0\nelement vertex 3000000\nproperty float x\n"
		"property float y\nproperty float z\nelement face 1\n"
		"property list uchar int vertex_indices\nend_header\n";
	const char *was = getenv("TMPDIR");
	char *before = was ? strdup(was) : NULL, path[256];
	const struct import_options options = { 0 };
	struct diagnostics diagnostics = { 0 };
	struct mesh mesh;
	(void)state;

	scan_write(path, "large.ply", ply, strlen(ply));
	CHECK(truncate(path, (off_t)strlen(ply) + 3000000 * 12 + 13) == 0);
	CHECK(setenv("TMPDIR", "/nowhere/at/all", 1) == 0);
	CHECK(import_scan(&mesh, path, &options, NULL, &diagnostics) == -ENOENT);
	if (!strstr(diagnostics.first.text, "large.ply: no temporary file can be made in TMPDIR"))
		fail_msg("%s", diagnostics.first.text);
	CHECK(before ? setenv("TMPDIR", before, 1) == 0 : unsetenv("TMPDIR") == 0);
	free(before);
	scan_remove(path);
}

/* ---- several threads */

enum { SIDE = 400 }; /* several ranges of vertices and faces */

static void put_f32(struct buffer *file, float value)
{
	buffer_put(file, &value, sizeof(value));
}

static void put_face(struct buffer *file, uint32_t a, uint32_t b, uint32_t c)
{
	const uint32_t corners[3] = { a, b, c };

	buffer_put_u8(file, 3);
	buffer_put(file, corners, sizeof(corners));
}

/* A hill whose every square has vertices of its own, with all that is repaired: vertices at one
 * place of equal and of different colours, not finite, or unused; faces turned, or without area. */
static void write_dirty_hill(struct buffer *file)
{
	static char head[1024];
	const uint32_t squares = SIDE * SIDE;

	buffer_put(
		file, head,
		(size_t)snprintf(head, sizeof(head),
				 "ply\nformat binary_little_endian 1.0\nelement vertex %u\n"
				 "property float x\nproperty float y\nproperty float z\n"
				 "property uchar red\nproperty uchar green\nproperty uchar blue\n"
				 "element face %u\nproperty list uchar uint vertex_indices\n"
				 "end_header\n",
				 5 * squares, 2 * squares));
	for (uint32_t i = 0; i < 5 * squares; i++) {
		uint32_t x = i / 5 % SIDE + (i % 5 == 1 || i % 5 == 2);
		uint32_t y = i / 5 / SIDE + (i % 5 == 2 || i % 5 == 3);

		put_f32(file, i % 9973 == 0 ? NAN : (float)x);
		put_f32(file, (float)y * -1 + 0);
		put_f32(file, (float)((x * 31 + y * 17) % 5) * 0.1f);
		for (int k = 0; k < 3; k++)
			buffer_put_u8(file, i % 5 == 4 ? 7 : (uint8_t)(i % 30 == 0));
	}
	for (uint32_t i = 0; i < squares; i++) {
		uint32_t at = 5 * i;
		bool turned = i % 1000 > 980;

		put_face(file, at, turned ? at + 2 : at + 1, turned ? at + 1 : at + 2);
		put_face(file, at, at + 2, i % 777 == 0 ? at + 2 : at + 3);
	}
}

static void any_number_of_threads_makes_the_same_mesh(void **state)
{
	struct import_options options = { .jobs = 1, .up = IMPORT_Y_UP, .metres_per_unit = 0.5 };
	struct import_report first_report, report;
	struct diagnostics diagnostics = { 0 };
	struct mesh first, mesh;
	struct buffer file;
	char path[256];
	(void)state;

	buffer_init(&file, 32 << 20);
	write_dirty_hill(&file);
	CHECK(!file.error);
	scan_write(path, "hill.ply", file.data, file.size);
	buffer_finish(&file);
	CHECK(import_scan(&first, path, &options, &first_report, &diagnostics) == 0);
	CHECK(first_report.repairs.lost_faces > 0 && first_report.repairs.degenerate_faces > 200 &&
	      first_report.repairs.merged_vertices > SIDE * SIDE &&
	      first_report.repairs.unused_vertices > 0 &&
	      first_report.repairs.turned_faces > 1000 && first_report.repairs.place_count > 0);
	for (options.jobs = 2; options.jobs <= 5; options.jobs += 3) {
		CHECK(import_scan(&mesh, path, &options, &report, &diagnostics) == 0);
		report.duration_ms = first_report.duration_ms;
		CHECK(memcmp(&report, &first_report, sizeof(report)) == 0);
		CHECK(mesh.vertex_count == first.vertex_count &&
		      mesh.triangle_count == first.triangle_count);
		CHECK(memcmp(mesh.positions, first.positions,
			     mesh.vertex_count * sizeof(*mesh.positions)) == 0);
		CHECK(memcmp(mesh.colours, first.colours,
			     mesh.vertex_count * sizeof(*mesh.colours)) == 0);
		CHECK(memcmp(mesh.triangles, first.triangles,
			     mesh.triangle_count * sizeof(*mesh.triangles)) == 0);
		CHECK(memcmp(mesh.faces, first.faces, mesh.triangle_count * sizeof(*mesh.faces)) ==
		      0);
		mesh_finish(&mesh);
	}
	mesh_finish(&first);
	scan_remove(path);
}

static void names_of_axes_and_units(void **state)
{
	enum import_axis axis = IMPORT_Z_UP;
	double unit = 0;
	(void)state;

	CHECK(import_axis_named("x", &axis) && axis == IMPORT_X_UP &&
	      !import_axis_named("w", &axis));
	CHECK(import_unit_named("in", &unit) && unit == 0.0254);
	CHECK(import_unit_named("0.3048", &unit) && unit == 0.3048);
	CHECK(!import_unit_named("-1", &unit) && !import_unit_named("nan", &unit) &&
	      !import_unit_named("inf", &unit) && !import_unit_named("1m", &unit));
	CHECK(unit == 0.3048);
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(repairs_and_counts),
		cmocka_unit_test(turns_the_smaller_part_to_the_side_of_the_larger),
		cmocka_unit_test(a_surface_with_one_side_stays_as_it_is),
		cmocka_unit_test(colours_part_what_is_at_one_place),
		cmocka_unit_test(turns_up_and_scales_to_metres),
		cmocka_unit_test(places_a_scan_before_turning_and_scaling_it),
		cmocka_unit_test(a_mirrored_scan_keeps_its_outside),
		cmocka_unit_test(a_ply_of_doubles_is_placed_with_all_its_digits),
		cmocka_unit_test(a_small_scan_is_read_beside_a_large_one),
		cmocka_unit_test(what_was_left_out_is_a_warning),
		cmocka_unit_test(reads_stl_and_off),
		cmocka_unit_test(refuses_what_is_no_surface),
		cmocka_unit_test(looks_at_all_of_a_gltf),
		cmocka_unit_test(names_the_folder_where_no_temporary_file_can_be_made),
		cmocka_unit_test(any_number_of_threads_makes_the_same_mesh),
		cmocka_unit_test(names_of_axes_and_units),
	};

	return cmocka_run_group_tests(tests, NULL, NULL);
}
