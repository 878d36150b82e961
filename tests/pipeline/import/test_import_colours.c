/* Which colours an imported scan has: of its pictures, of its materials, or of its vertices. */
#include "pipeline/import/import.h"

#include <math.h>
#include <stdlib.h>

#include "base/bytes.h"
#include "format/picture.h"
#include "tests/check.h"
#include "tests/pipeline/import/import_text.h"

/* Two by two: red green on top, blue white at the bottom. */
static void write_picture(const char *path, const char *name)
{
	uint8_t rgba[16] = { 255, 0, 0, 255, 0, 255, 0, 255, 0, 0, 255, 255, 255, 255, 255, 255 };
	const struct picture picture = { 2, 2, rgba };
	struct buffer png;

	buffer_init(&png, 1 << 16);
	CHECK(picture_encode_png(&png, &picture) == 0);
	scan_write_beside(path, name, png.data, png.size);
	buffer_finish(&png);
}

static uint32_t vertex_at(const struct mesh *mesh, float x, float y)
{
	for (uint32_t i = 0; i < mesh->vertex_count; i++)
		if (is_near(mesh->positions[i], x, y, 0))
			return i;
	fail_msg("no vertex at %g %g", x, y);
	return 0;
}

static int distance(const uint8_t a[3], const uint8_t b[3])
{
	return abs(a[0] - b[0]) + abs(a[1] - b[1]) + abs(a[2] - b[2]);
}

/* A square whose corners have the picture's corners, x as u and y as v from the bottom. */
static void check_square(const struct mesh *mesh, const struct import_report *report)
{
	static const uint8_t corner[4][3] = {
		{ 0, 0, 255 }, { 255, 255, 255 }, { 255, 0, 0 }, { 0, 255, 0 }
	};

	CHECK(report->textures == 1 && report->warning.first.text[0] == '\0');
	CHECK(mesh->triangle_count == 2 && mesh->vertex_count == 4);
	CHECK(mesh->texture_count > 0 && mesh->textures[mesh->materials[0]].width == 2);
	for (int i = 0; i < 4; i++) {
		uint32_t vertex = vertex_at(mesh, i % 2 ? 1.0f : 0.0f, i / 2 ? 1.0f : 0.0f);

		CHECK(fabsf(mesh->uvs[vertex][1] - (i / 2 ? 0.9f : 0.1f)) < 1e-5f);
		for (int other = 0; other < 4; other++)
			CHECK(other == i || distance(mesh->colours[vertex], corner[i]) <
						    distance(mesh->colours[vertex], corner[other]));
	}
}

static void obj_pictures_are_upright_and_found_past_foreign_paths(void **state)
{
	static const char obj[] = "mtllib skin.mtl\nv 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\n"
				  "vt 0.1 0.1\nvt 0.9 0.1\nvt 0.9 0.9\nvt 0.1 0.9\nusemtl skin\n"
				  "f 1/1 2/2 3/3 4/4\n";
	static const char *const names[] = { "skin.png", "./skin.png", "C:\\Users\\eng\\skin.png",
					     "/home/eng/skin.png", "../../skin.png" };
	(void)state;

	for (size_t i = 0; i < ARRAY_COUNT(names); i++) {
		const struct import_options options = { 0 };
		struct import_report report;
		struct diagnostics diagnostics = { 0 };
		struct mesh mesh;
		char path[256], mtl[256];

		snprintf(mtl, sizeof(mtl), "newmtl skin\nKd 1 1 1\nmap_Kd %s\n", names[i]);
		scan_write(path, "square.obj", obj, strlen(obj));
		scan_write_beside(path, "skin.mtl", mtl, strlen(mtl));
		write_picture(path, "skin.png");
		if (import_scan(&mesh, path, &options, &report, &diagnostics) < 0)
			fail_msg("%s: %s", names[i], diagnostics.first.text);
		check_square(&mesh, &report);
		mesh_finish(&mesh);
		scan_remove(path);
	}
}

static void ply_pictures_are_upright_by_vertex_and_by_corner(void **state)
{
	static const char *const texts[] = {
		"ply\nformat ascii 1.0\ncomment TextureFile skin.png\nelement vertex 4\n"
		"property float x\nproperty float y\nproperty float z\nproperty float s\n"
		"property float t\nelement face 1\nproperty list uchar int vertex_indices\n"
		"end_header\n0 0 0 .1 .1\n1 0 0 .9 .1\n1 1 0 .9 .9\n0 1 0 .1 .9\n4 0 1 2 3\n",
		"ply\nformat ascii 1.0\ncomment TextureFile skin.png\nelement vertex 4\n"
		"property float x\nproperty float y\nproperty float z\n"
		"element face 1\nproperty list uchar int vertex_indices\n"
		"property list uchar float texcoord\nend_header\n0 0 0\n1 0 0\n1 1 0\n0 1 0\n"
		"4 0 1 2 3 8 .1 .1 .9 .1 .9 .9 .1 .9\n",
	};
	(void)state;

	for (size_t i = 0; i < ARRAY_COUNT(texts); i++) {
		const struct import_options options = { 0 };
		struct import_report report;
		struct diagnostics diagnostics = { 0 };
		struct mesh mesh;
		char path[256];

		scan_write(path, "square.ply", texts[i], strlen(texts[i]));
		write_picture(path, "skin.png");
		CHECK(import_scan(&mesh, path, &options, &report, &diagnostics) == 0);
		check_square(&mesh, &report);
		mesh_finish(&mesh);
		scan_remove(path);
	}
}

/* A square that may show my skin.png. %s: attributes, and the material. Names are URIs. */
static const char gltf_format[] =
	"{\"extensionsUsed\":[\"KHR_texture_transform\","
	"\"KHR_materials_pbrSpecularGlossiness\"],\"asset\":{\"version\":\"2.0\"},"
	"\"scene\":0,\"scenes\":[{\"nodes\":[0]}],\"nodes\":[{\"mesh\":0,\"translation\":[-2,0,0]}],"
	"\"meshes\":[{\"primitives\":[{\"attributes\":{\"POSITION\":0%s},"
	"\"indices\":2,\"material\":0}]}],"
	"\"materials\":[{%s}],"
	"\"textures\":[{\"source\":0}],\"images\":[{\"uri\":\"my%%20skin.png\"}],"
	"\"buffers\":[{\"uri\":\"my%%20square.bin\",\"byteLength\":92}],"
	"\"bufferViews\":[{\"buffer\":0,\"byteOffset\":0,\"byteLength\":48},"
	"{\"buffer\":0,\"byteOffset\":48,\"byteLength\":32},"
	"{\"buffer\":0,\"byteOffset\":80,\"byteLength\":12}],"
	"\"accessors\":[{\"bufferView\":0,\"componentType\":5126,\"count\":4,"
	"\"type\":\"VEC3\",\"min\":[2,0,0],\"max\":[3,1,0]},"
	"{\"bufferView\":1,\"componentType\":5126,\"count\":4,\"type\":\"VEC2\"},"
	"{\"bufferView\":2,\"componentType\":5123,\"count\":6,\"type\":\"SCALAR\"},"
	"{\"bufferView\":0,\"componentType\":5126,\"count\":4,\"type\":\"VEC2\"},"
	"{\"bufferView\":0,\"componentType\":5126,\"count\":4,\"type\":\"VEC3\"}]}";

struct gltf_square {
	const char *attributes, *material;
	float uvs[4][2];
};

static void import_square(const struct gltf_square *square, struct mesh *mesh,
			  struct import_report *report)
{
	struct {
		float positions[4][3], uvs[4][2];
		uint16_t indices[6];
	} data = { { { 2, 0, 0 }, { 3, 0, 0 }, { 3, 1, 0 }, { 2, 1, 0 } },
		   { { 0 } },
		   { 0, 1, 2, 0, 2, 3 } };
	const struct import_options options = { 0 };
	struct diagnostics diagnostics = { 0 };
	char path[256], gltf[2048];

	memcpy(data.uvs, square->uvs, sizeof(data.uvs));
	CHECK(snprintf(gltf, sizeof(gltf), gltf_format, square->attributes, square->material) <
	      (int)sizeof(gltf));
	scan_write(path, "square.gltf", gltf, strlen(gltf));
	scan_write_beside(path, "my square.bin", &data, 92);
	write_picture(path, "my skin.png");
	if (import_scan(mesh, path, &options, report, &diagnostics) < 0)
		fail_msg("%s", diagnostics.first.text);
	scan_remove(path);
}

/* glTF counts v from the top: 0.1 there is 0.9 here. A KHR_texture_transform that turns, halves and
 * moves lays other numbers at the same places. A picture may lie by the second coordinates. */
static void gltf_pictures_lie_where_the_file_has_them(void **state)
{
	static const struct gltf_square squares[] = {
		{ ",\"TEXCOORD_0\":1",
		  "\"pbrMetallicRoughness\":{\"baseColorTexture\":{\"index\":0}}",
		  { { .1f, .9f }, { .9f, .9f }, { .9f, .1f }, { .1f, .1f } } },
		{ ",\"TEXCOORD_0\":1",
		  "\"pbrMetallicRoughness\":{\"baseColorTexture\":{\"index\":0,\"extensions\":{"
		  "\"KHR_texture_transform\":{\"offset\":[0.05,0.95],\"rotation\":1.57079632679,"
		  "\"scale\":[0.5,0.5]}}}}",
		  { { .1f, .1f }, { .1f, 1.7f }, { 1.7f, 1.7f }, { 1.7f, .1f } } },
		{ ",\"TEXCOORD_0\":3,\"TEXCOORD_1\":1",
		  "\"pbrMetallicRoughness\":{\"baseColorTexture\":{\"index\":0,\"texCoord\":1}}",
		  { { .1f, .9f }, { .9f, .9f }, { .9f, .1f }, { .1f, .1f } } },
	};
	(void)state;

	for (size_t i = 0; i < ARRAY_COUNT(squares); i++) {
		struct import_report report;
		struct mesh mesh;

		import_square(&squares[i], &mesh, &report);
		check_square(&mesh, &report);
		mesh_finish(&mesh);
	}
}

/* Half of the light is 188 in sRGB. Sketchfab gave glossy materials for years. */
static void gltf_multiplies_pictures_with_the_colour(void **state)
{
	static const char *const materials[] = {
		"\"pbrMetallicRoughness\":{\"baseColorTexture\":{\"index\":0},"
		"\"baseColorFactor\":[0.5,0.5,0,1]}",
		"\"extensions\":{\"KHR_materials_pbrSpecularGlossiness\":{\"diffuseTexture\":{"
		"\"index\":0},\"diffuseFactor\":[0.5,0.5,0,1]}}",
	};
	static const uint8_t skin[12] = { 188, 0, 0, 0, 188, 0, 0, 0, 0, 188, 188, 0 };
	(void)state;

	for (size_t i = 0; i < ARRAY_COUNT(materials); i++) {
		const struct gltf_square square = { ",\"TEXCOORD_0\":1", materials[i], { { 0 } } };
		struct import_report report;
		struct mesh mesh;

		import_square(&square, &mesh, &report);
		CHECK(report.textures == 1 && mesh.textures[mesh.materials[0]].width == 2);
		CHECK(memcmp(mesh.textures[mesh.materials[0]].rgb, skin, sizeof(skin)) == 0);
		mesh_finish(&mesh);
	}
}

/* Positions stand for colours of vertices, of 1 and more. */
static void gltf_multiplies_colours_with_the_colour(void **state)
{
	static const struct {
		const char *attributes, *material;
		uint8_t colour[3]; /* at 1 1 */
	} cases[] = {
		{ ",\"COLOR_0\":4",
		  "\"pbrMetallicRoughness\":{\"baseColorFactor\":[0.5,0.5,0,1]}",
		  { 255, 188, 0 } },
		{ "",
		  "\"pbrMetallicRoughness\":{\"baseColorFactor\":[0.5,0.5,0,1]}",
		  { 188, 188, 0 } },
		{ "",
		  "\"extensions\":{\"KHR_materials_pbrSpecularGlossiness\":{"
		  "\"diffuseFactor\":[0.5,0.5,0,1]}}",
		  { 188, 188, 0 } },
	};
	(void)state;

	for (size_t i = 0; i < ARRAY_COUNT(cases); i++) {
		const struct gltf_square square = { cases[i].attributes,
						    cases[i].material,
						    { { 0 } } };
		struct import_report report;
		struct mesh mesh;

		import_square(&square, &mesh, &report);
		CHECK(report.textures == 0 && report.had_colours);
		CHECK(memcmp(mesh.colours[vertex_at(&mesh, 1, 1)], cases[i].colour, 3) == 0);
		mesh_finish(&mesh);
	}
}

static void a_missing_or_damaged_picture_is_a_warning(void **state)
{
	static const char obj[] = "mtllib skin.mtl\nv 0 0 0\nv 1 0 0\nv 1 1 0\nvt 0 0\n"
				  "usemtl skin\nf 1/1 2/1 3/1\n";
	static const char mtl[] = "newmtl skin\nKd 0.2 0.4 0.6\nmap_Kd skin.jpg\n";
	static const char *const says[] = { "'skin.jpg' is not beside it",
					    "'skin.jpg' is damaged" };
	(void)state;

	for (int damaged = 0; damaged < 2; damaged++) {
		const struct import_options options = { 0 };
		struct import_report report;
		struct diagnostics diagnostics = { 0 };
		struct mesh mesh;
		char path[256];

		scan_write(path, "plain.obj", obj, strlen(obj));
		scan_write_beside(path, "skin.mtl", mtl, strlen(mtl));
		if (damaged)
			scan_write_beside(path, "skin.jpg", "\xff\xd8\xff\xe0 no more", 12);
		CHECK(import_scan(&mesh, path, &options, &report, &diagnostics) == 0);
		CHECK(strstr(report.warning.first.text, says[damaged]));
		CHECK(strstr(report.warning.first.text, "plain.obj"));
		CHECK(mesh.colours[0][0] == 51 && mesh.colours[0][1] == 102);
		mesh_finish(&mesh);
		scan_remove(path);
	}
}

/* MeshLab writes both. */
static void without_its_picture_a_ply_has_the_colours_of_its_vertices(void **state)
{
	static const char ply[] =
		"ply\nformat ascii 1.0\ncomment TextureFile gone.png\nelement vertex 3\n"
		"property float x\nproperty float y\nproperty float z\nproperty uchar red\n"
		"property uchar green\nproperty uchar blue\nelement face 1\n"
		"property list uchar int vertex_indices\nproperty list uchar float texcoord\n"
		"end_header\n0 0 0 10 20 30\n1 0 0 10 20 30\n0 1 0 40 50 60\n"
		"3 0 1 2 6 0 0 1 0 0 1\n";
	const struct import_options options = { 0 };
	struct diagnostics diagnostics;
	struct import_report report;
	struct mesh mesh;
	(void)state;

	CHECK(import_text(&mesh, &report, "both.ply", ply, &options, &diagnostics) == 0);
	CHECK(strstr(report.warning.first.text, "'gone.png' is not beside it"));
	CHECK(report.textures == 0 && report.had_colours && !mesh.textures && !mesh.uvs);
	CHECK(mesh.vertex_count == 3 && mesh.colours[0][0] == 10 && mesh.colours[2][2] == 60);
	mesh_finish(&mesh);
}

/* MeshLab writes bytes in OFF; in OBJ there are both. */
static void colours_of_vertices_may_be_bytes_or_shares(void **state)
{
	static const struct {
		const char *name, *text;
	} cases[] = {
		{ "bytes.off", "COFF\n3 1 0\n0 0 0 51 102 0 255\n1 0 0 51 102 0 255\n"
			       "0 1 0 0 1 255 255\n3 0 1 2\n" },
		{ "bytes.obj", "v 0 0 0 51 102 0\nv 1 0 0 51 102 0\nv 0 1 0 0 1 255\nf 1 2 3\n" },
		{ "shares.obj",
		  "v 0 0 0 0.2 0.4 0\nv 1 0 0 0.2 0.4 0\nv 0 1 0 0 0.004 1\nf 1 2 3\n" },
		{ "rounded.obj",
		  "v 0 0 0 0.2 0.4 0\nv 1 0 0 0.2 0.4 0\nv 0 1 0 0 0.004 1.0039\nf 1 2 3\n" },
	};
	const struct import_options options = { 0 };
	struct diagnostics diagnostics;
	struct import_report report;
	struct mesh mesh;
	(void)state;

	for (size_t i = 0; i < ARRAY_COUNT(cases); i++) {
		const uint8_t *first, *last;

		CHECK(import_text(&mesh, &report, cases[i].name, cases[i].text, &options,
				  &diagnostics) == 0);
		first = mesh.colours[vertex_at(&mesh, 1, 0)];
		last = mesh.colours[vertex_at(&mesh, 0, 1)];
		if (first[0] != 51 || first[1] != 102 || first[2] != 0 || last[1] != 1 ||
		    last[2] != 255)
			fail_msg("%s: %u %u %u, %u %u %u", cases[i].name, first[0], first[1],
				 first[2], last[0], last[1], last[2]);
		mesh_finish(&mesh);
	}
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(obj_pictures_are_upright_and_found_past_foreign_paths),
		cmocka_unit_test(ply_pictures_are_upright_by_vertex_and_by_corner),
		cmocka_unit_test(gltf_pictures_lie_where_the_file_has_them),
		cmocka_unit_test(gltf_multiplies_pictures_with_the_colour),
		cmocka_unit_test(gltf_multiplies_colours_with_the_colour),
		cmocka_unit_test(a_missing_or_damaged_picture_is_a_warning),
		cmocka_unit_test(without_its_picture_a_ply_has_the_colours_of_its_vertices),
		cmocka_unit_test(colours_of_vertices_may_be_bytes_or_shares),
	};

	return cmocka_run_group_tests(tests, NULL, NULL);
}
