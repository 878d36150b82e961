/* Pictures on surfaces of scenery: as textures, within a budget, or a warning. */
#include <errno.h>
#include <fcntl.h>
#include <math.h>
#include <sodium.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/mman.h>
#include <unistd.h>

#include "format/scenery_texture_code.h"
#include "pipeline/scene/gltf_scenery.h"
#include "pipeline/scene/scenery_texture.h"
#include "tests/close_once.h"
#include "tests/pipeline/scene/little_vrml.h"

enum { SIDE = 64 };

static const struct scenery_node root = {
	.parent = SCENERY_NONE,
	.layer = SCENERY_NONE,
	.place = { .turn = { 0, 0, 0, 1 }, .scale = { 1, 1, 1 }, .stretch = { 0, 0, 0, 1 } }
};

/* Its upper half is red; the lower one is green on the left and blue on the right. */
static struct picture make_picture(void)
{
	struct picture picture = { SIDE, SIDE, calloc(SIDE * SIDE, 4) };

	for (uint32_t i = 0; i < SIDE * SIDE; i++) {
		const uint32_t x = i % SIDE, y = i / SIDE;

		picture.rgba[4 * i + (y < SIDE / 2 ? 0 : x < SIDE / 2 ? 1 : 2)] = 255;
		picture.rgba[4 * i + 3] = 255;
	}
	return picture;
}

static struct buffer make_png(void)
{
	struct picture picture = make_picture();
	struct buffer png;

	buffer_init(&png, 1 << 20);
	CHECK(picture_encode_png(&png, &picture) == 0);
	picture_finish(&picture);
	return png;
}

/* A square of a metre with the whole picture on it. */
static void make_square(struct soup_triangle out[2])
{
	static const float uvs[2][3][2] = { { { 0, 0 }, { 1, 0 }, { 1, 1 } },
					    { { 0, 0 }, { 1, 1 }, { 0, 1 } } };

	memset(out, 0, 2 * sizeof(*out));
	for (int t = 0; t < 2; t++)
		for (int k = 0; k < 3; k++) {
			struct soup_corner *corner = &out[t].corners[k];

			memcpy(corner->uv, uvs[t][k], sizeof(corner->uv));
			memcpy(corner->position, uvs[t][k], sizeof(corner->uv));
			memset(corner->rgb, 255, 3);
		}
}

/* Finds the triangle of a mesh that lies over a place in x and y; shares of its corners, or false.
 */
static bool find_triangle(const struct scenery_mesh *mesh, float x, float y, const uint16_t **out,
			  float shares[3])
{
	for (uint32_t t = 0; t < mesh->triangle_count; t++) {
		float at[3][2], area;

		for (int k = 0; k < 3; k++)
			for (int i = 0; i < 2; i++)
				at[k][i] =
					mesh->origin_m[i] +
					mesh->step_m * (float)mesh->vertices[mesh->triangles[t][k]]
							       .place[i];
		area = (at[1][0] - at[0][0]) * (at[2][1] - at[0][1]) -
		       (at[1][1] - at[0][1]) * (at[2][0] - at[0][0]);
		for (int k = 0; k < 3; k++) {
			const float *a = at[(k + 1) % 3], *b = at[(k + 2) % 3];

			shares[k] =
				((b[0] - a[0]) * (y - a[1]) - (b[1] - a[1]) * (x - a[0])) / area;
		}
		*out = mesh->triangles[t];
		if (shares[0] >= 0 && shares[1] >= 0 && shares[2] >= 0)
			return true;
	}
	return false;
}

/* The colour at a place of the first mesh: that of its corners times its picture. */
static void colour_at(uint8_t rgb[3], const struct scenery *s, float x, float y)
{
	const struct scenery_mesh *mesh = &s->meshes[0];
	const uint16_t number = s->materials[mesh->material].texture;
	const struct scenery_texture *texture = number ? &s->textures[number - 1] : NULL;
	const uint16_t *corners;
	float shares[3], at[2];
	int pixel[2];

	CHECK(find_triangle(mesh, x, y, &corners, shares));
	memcpy(rgb, mesh->vertices[corners[0]].rgb, 3);
	if (!texture)
		return;
	for (int i = 0; i < 2; i++) {
		const int px = i == 0 ? texture->width : texture->height;

		at[i] = mesh->uv_origin[i];
		for (int k = 0; k < 3; k++)
			at[i] += mesh->uv_step[i] * shares[k] * (float)mesh->uvs[corners[k]][i];
		pixel[i] = (int)((at[i] - floorf(at[i])) * (float)px);
	}
	for (int k = 0; k < 3; k++)
		rgb[k] = (uint8_t)(rgb[k] *
				   texture->rgba[4 * (pixel[1] * texture->width + pixel[0]) + k] /
				   255);
}

static bool is_colour(const struct scenery *s, float x, float y, int strongest)
{
	uint8_t rgb[3];

	colour_at(rgb, s, x, y);
	for (int k = 0; k < 3; k++)
		if (k == strongest ? rgb[k] < 240 : rgb[k] > 20)
			return false;
	return true;
}

static bool shows_the_picture(struct scenery *s)
{
	CHECK(scenery_decode_textures(s) == 0);
	return is_colour(s, 0.2f, 0.8f, 0) && is_colour(s, 0.8f, 0.8f, 0) &&
	       is_colour(s, 0.2f, 0.2f, 1) && is_colour(s, 0.8f, 0.2f, 2);
}

static void a_picture_is_kept_once_with_sides_that_are_powers_of_two(void **state)
{
	struct picture picture = { 48, 150, calloc(48 * 150, 4) };
	const struct scenery_paint paint = { .picture = &picture };
	struct scenery_material glass = scenery_plain;
	struct scenery_maker maker = { 0 };
	struct soup_triangle square[2];
	struct scenery s;
	uint32_t node;

	(void)state;
	glass.opacity = 0.5f;
	make_square(square);
	CHECK(scenery_add_node(&maker, &root, &node) == 0);
	for (int i = 0; i < 3; i++)
		CHECK(scenery_add_surface(&maker, node, i == 2 ? &glass : &scenery_plain, square, 2,
					  0, &paint) == 0);
	/* where it repeats it is another one, and so are other pixels */
	square[0].corners[1].uv[0] = 2.5f;
	CHECK(scenery_add_surface(&maker, node, &scenery_plain, square, 2, 0, &paint) == 0);
	picture.rgba[0] = 9;
	CHECK(scenery_add_surface(&maker, node, &scenery_plain, square, 2, 0, &paint) == 0);
	CHECK(scenery_maker_end(&maker, &s) == 0 && scenery_is_sane(&s));
	CHECK(s.texture_count == 3 && s.material_count == 4 && scenery_triangles(&s) == 10);
	for (uint32_t i = 0; i < 3; i++)
		CHECK(s.textures[i].width == 64 && s.textures[i].height == 128 &&
		      s.textures[i].repeats == (i > 0));
	scenery_finish(&s);
	picture_finish(&picture);
}

static void all_pictures_stay_within_their_budget(void **state)
{
	struct picture picture = { 4096, 4096, calloc(4096 * 4096, 4) };
	const struct scenery_paint paint = { .picture = &picture };
	struct scenery_maker maker = { 0 };
	struct soup_triangle square[2];
	uint32_t node;
	int rc = 0;

	(void)state;
	make_square(square);
	square[0].corners[0].uv[0] = NAN; /* of a broken file */
	square[0].corners[1].uv[1] = 1e30f;
	CHECK(scenery_add_node(&maker, &root, &node) == 0);
	for (uint32_t i = 0; i < 6; i++) {
		picture.rgba[0] = (uint8_t)i;
		rc = scenery_add_surface(&maker, node, &scenery_plain, square, 2, 0, &paint);
		CHECK(rc == 0);
		CHECK(maker.out.textures[i].width <= SCENERY_TEXTURE_PX_MAX);
		CHECK(scenery_texels(&maker.out) <= SCENERY_TEXELS_MAX);
	}
	CHECK(scenery_texels(&maker.out) > SCENERY_TEXELS_MAX / 2);
	scenery_maker_finish(&maker);
	picture_finish(&picture);
}

/* A white bar in the middle of a black picture stays there, and as bright, at any size. */
static void a_resized_picture_keeps_its_places(void **state)
{
	static const uint32_t widths[] = { 100, 128, 90, 300 };

	(void)state;
	for (size_t c = 0; c < 4; c++) {
		const uint32_t width = widths[c];
		struct picture in = { width, 2, calloc(width, 8) };
		struct scenery_texture out;
		struct picture back;
		double sum = 0, moment = 0;

		for (uint32_t i = 0; i < 2 * width; i++)
			if (i % width >= width / 2 - 20 && i % width < width / 2)
				memset(&in.rgba[4 * i], 255, 4);
		CHECK(scenery_texture_make(&out, &in, false, false, 1 << 20) == 0);
		CHECK(out.width == (c == 3 ? 256 : c == 2 ? 64 : 128) && out.height == 2);
		CHECK(picture_decode(&back, (struct bytes){ out.jpeg, out.jpeg_bytes }) == 0);
		for (uint32_t i = 0; i < back.width; i++) {
			sum += back.rgba[4 * i];
			moment += back.rgba[4 * i] * (i + 0.5);
		}
		moment *= (double)width / out.width / sum;
		sum *= (double)width / out.width / 255;
		if (fabs(sum - 20) > 1 || fabs(moment - (width / 2.0 - 10)) > 0.5)
			fail_msg("%u: %.2f wide at %.2f", width, sum, moment);
		free(out.jpeg);
		picture_finish(&back);
		picture_finish(&in);
	}
}

/* Gives the PNG in data, by a name. */
static int open_picture(void *data, const char *name)
{
	const struct buffer *png = data;
	int fd;

	if (strcmp(name, "a b.png") != 0)
		return -ENOENT;
	fd = memfd_create("picture", MFD_CLOEXEC);
	CHECK(fd >= 0 && write(fd, png->data, png->size) == (ssize_t)png->size);
	CHECK(lseek(fd, 0, SEEK_SET) == 0);
	return fd;
}

static void make_vrml(struct scenery *out, const char *text, struct diagnostics *warnings)
{
	struct buffer png = make_png();
	const struct vrml_options options = { .open_file = open_picture, .data = &png };
	struct diagnostics diagnostics = { 0 };

	CHECK(little_vrml_make(out, text, &options, NULL, 0, &diagnostics, warnings) == 0);
	buffer_finish(&png);
}

#define SQUARE(texture)                                                                                 \
	"#VRML V2.0 utf8\nShape { appearance Appearance { material Material {\n"                        \
	"  diffuseColor 0.2 0.2 0.2 }\n  texture " texture " }\n"                                       \
	"  geometry IndexedFaceSet { coord DEF C Coordinate { point [ 0 0 0, 1 0 0, 1 1 0, 0 1 0 ] }\n" \
	"    coordIndex [ 0 1 2 3 ]\n"                                                                  \
	"    texCoord TextureCoordinate { point [ 0 0, 1 0, 1 1, 0 1 ] } } }"

static void an_image_texture_takes_the_place_of_the_colour(void **state)
{
	struct diagnostics warnings = { 0 };
	struct scenery s;

	(void)state;
	make_vrml(&s, SQUARE("ImageTexture { url \"a b.png\" }"), &warnings);
	CHECK(warnings.count == 0 && shows_the_picture(&s));
	scenery_finish(&s);
}

/* Gives a scene in a folder, and the PNG in data beside that. */
static int open_in_folder(void *data, const char *name)
{
	static const char wall[] = SQUARE("ImageTexture { url \"a b.png\" }");
	int fd;

	if (strncmp(name, "walls/", 6) != 0)
		return -ENOENT;
	if (strcmp(name + 6, "east.wrl") != 0)
		return open_picture(data, name + 6);
	fd = memfd_create("wall", MFD_CLOEXEC);
	CHECK(fd >= 0 && write(fd, wall, sizeof(wall) - 1) == (ssize_t)sizeof(wall) - 1);
	CHECK(lseek(fd, 0, SEEK_SET) == 0);
	return fd;
}

static void a_picture_lies_beside_the_file_that_names_it(void **state)
{
	struct buffer png = make_png();
	const struct vrml_options options = { .open_file = open_in_folder, .data = &png };
	struct diagnostics diagnostics = { 0 }, warnings = { 0 };
	struct scenery s;

	(void)state;
	CHECK(little_vrml_make(&s, "#VRML V2.0 utf8\nInline { url \"walls/east.wrl\" }", &options,
			       NULL, 0, &diagnostics, &warnings) == 0);
	if (warnings.count > 0)
		fail_msg("%s", warnings.first.text);
	CHECK(shows_the_picture(&s));
	scenery_finish(&s);
	buffer_finish(&png);
}

static void a_picture_that_cannot_be_read_is_a_warning(void **state)
{
	static const char *const cases[][2] = {
		{ SQUARE("ImageTexture { url \"none.png\" }"),
		  "a.wrl:4: the picture none.png is left out: it is not there; put it beside" },
		{ SQUARE("PixelTexture { image 1 1 1 0xFF }"), "a.wrl:4: PixelTexture is left" },
	};

	(void)state;
	for (size_t i = 0; i < 2; i++) {
		struct diagnostics warnings = { 0 };
		struct scenery s;
		uint8_t rgb[3];

		make_vrml(&s, cases[i][0], &warnings);
		if (!strstr(warnings.first.text, cases[i][1]))
			fail_msg("case %zu: %s", i, warnings.first.text);
		colour_at(rgb, &s, 0.5f, 0.25f);
		CHECK(scenery_triangles(&s) == 2 && s.texture_count == 0 && rgb[0] == 51);
		scenery_finish(&s);
	}
}

/* Where a disk fails: it may be read at the next try. */
static int open_what_fails(void *data, const char *name)
{
	(void)data;
	(void)name;
	return open("/proc/self/mem", O_RDONLY | O_CLOEXEC); /* nothing is mapped at 0 */
}

static void a_picture_that_cannot_be_read_now_is_an_error(void **state)
{
	const struct vrml_options options = { .open_file = open_what_fails };
	struct diagnostics diagnostics = { 0 };
	struct scenery s;

	(void)state;
	CHECK(little_vrml_make(&s, SQUARE("ImageTexture { url \"a b.png\" }"), &options, NULL, 0,
			       &diagnostics, &diagnostics) == -EIO);
	CHECK(diagnostics.error_count == 1);
	if (!strstr(diagnostics.first.text, "a.wrl:4: the picture a b.png cannot be read:"))
		fail_msg("%s", diagnostics.first.text);
}

/* By the formula of VRML97, 6.49: with a quarter turn about its middle the picture is seen turned
 * clockwise; half a scale shows its lower left quarter. */
static void a_texture_transform_of_vrml_moves_the_picture_too(void **state)
{
	struct diagnostics warnings = { 0 };
	struct scenery s;

	(void)state;
	make_vrml(&s,
		  SQUARE("ImageTexture { url \"a b.png\" } textureTransform TextureTransform { "
			 "center 0.5 0.5 rotation 1.5707963 }"),
		  &warnings);
	CHECK(scenery_decode_textures(&s) == 0 && warnings.count == 0 && s.textures[0].repeats);
	CHECK(is_colour(&s, 0.2f, 0.8f, 1) && is_colour(&s, 0.2f, 0.2f, 2));
	CHECK(is_colour(&s, 0.8f, 0.8f, 0) && is_colour(&s, 0.8f, 0.2f, 0));
	scenery_finish(&s);
	make_vrml(&s,
		  SQUARE("ImageTexture { url \"a b.png\" } textureTransform TextureTransform { "
			 "scale 0.5 0.5 }"),
		  &warnings);
	CHECK(scenery_decode_textures(&s) == 0 && warnings.count == 0 && !s.textures[0].repeats);
	for (int i = 0; i < 4; i++)
		CHECK(is_colour(&s, i % 2 ? 0.1f : 0.9f, i / 2 ? 0.1f : 0.9f, 1));
	scenery_finish(&s);
}

/* Numbers of glTF: the same square as a strip, whose v counts from the top; a lift of its upper
 * side; times, and a weight at each. */
static const float numbers[] = { 0, 0, 0, 1, 0, 0, 0, 1, 0, 1, 1, 0, 0, 1, 1, 1, 0,
				 0, 1, 0, 0, 0, 0, 0, 0, 0, 0, 0, 1, 0, 0, 1, 0, 1 };

#define LAYING  "\"baseColorTexture\": {\"index\": 0, \"texCoord\": 1"
#define PAINTED "\"pbrMetallicRoughness\": {" LAYING "}}"

/* Reads the square with a picture and a material; more: what follows the lists. */
static void make_gltf(struct scenery *out, const char *image, const char *material,
		      const char *more, struct diagnostics *warnings)
{
	static const char rest[] =
		"\"bufferViews\": [{\"buffer\": 0, \"byteLength\": 136}],\n"
		"\"accessors\": [{\"bufferView\": 0, \"componentType\": 5126, \"count\": 4, "
		"\"type\": \"VEC3\"}, {\"bufferView\": 0, \"byteOffset\": 48, \"componentType\": "
		"5126, \"count\": 4, \"type\": \"VEC2\"}, {\"bufferView\": 0, \"byteOffset\": 80, "
		"\"componentType\": 5126, \"count\": 4, \"type\": \"VEC3\"}, {\"bufferView\": 0, "
		"\"byteOffset\": 128, \"componentType\": 5126, \"count\": 2, \"type\": "
		"\"SCALAR\"}],\n"
		"\"meshes\": [{\"primitives\": [{\"mode\": 5, \"material\": 0, \"attributes\": "
		"{\"POSITION\": 0, \"TEXCOORD_1\": 1}, \"targets\": [{\"POSITION\": 2}]}]}],\n"
		"\"nodes\": [{\"mesh\": 0}],\n"
		"\"textures\": [{\"source\": 0}], \"scenes\": [{\"nodes\": [0]}],\n";
	struct buffer png = make_png();
	const struct gltf_options options = { .open_file = open_picture, .data = &png };
	const char *cut = strstr(image, "%s");
	const int before = (int)(cut ? cut - image : (long)strlen(image));
	char *base64 = malloc(2 * png.size + 8), places[200];
	const struct gltf_choice choice = { 0 };
	struct diagnostics diagnostics = { 0 };
	struct scenery_maker maker = { 0 };
	static char text[1 << 16];
	struct gltf gltf;
	uint32_t node;

	CHECK(sizeof(numbers) == 136);
	sodium_bin2base64(base64, 2 * png.size + 8, png.data, png.size,
			  sodium_base64_VARIANT_ORIGINAL);
	sodium_bin2base64(places, sizeof(places), (const uint8_t *)numbers, sizeof(numbers),
			  sodium_base64_VARIANT_ORIGINAL);
	CHECK(snprintf(
		      text, sizeof(text),
		      "{\"asset\": {\"version\": \"2.0\"}, \"buffers\": [{\"uri\": "
		      "\"data:;base64,%s\"}],\n\"images\": [%.*s%s%s],\n%s%s\"materials\": [{%s}]}",
		      places, before, image, cut ? base64 : "", cut ? cut + 2 : "", rest, more,
		      material) < (int)sizeof(text));
	CHECK(scenery_add_node(&maker, &root, &node) == 0);
	if (gltf_read(&gltf, (struct bytes){ (const uint8_t *)text, strlen(text) }, "a.gltf",
		      &options, &diagnostics) != 0 ||
	    gltf_scenery_add(&maker, &gltf, node, &choice, warnings) != 0)
		fail_msg("%s", diagnostics.first.text);
	CHECK(scenery_maker_end(&maker, out) == 0 && scenery_is_sane(out));
	gltf_finish(&gltf);
	free(base64);
	buffer_finish(&png);
}

static void a_picture_whose_name_is_too_long_is_a_warning(void **state)
{
	struct diagnostics warnings = { 0 };
	char image[1024];
	struct scenery s;

	(void)state;
	snprintf(image, sizeof(image), "{\"uri\": \"%0900d.png\"}", 7);
	make_gltf(&s, image, PAINTED, "", &warnings);
	CHECK(warnings.count == 1 &&
	      strstr(warnings.first.text, "is left out: File name too long"));
	scenery_finish(&s);
}

static void a_base_colour_texture_is_shown(void **state)
{
	static const char *const images[] = { "{\"uri\": \"a%20b.png\"}",
					      "{\"uri\": \"data:image/png;base64,%s\"}",
					      "{\"uri\": \"none.png\"}", "{\"bufferView\": 0}",
					      "{\"uri\": \"50%al%00%2.png\"}" };

	(void)state;
	for (size_t i = 0; i < ARRAY_COUNT(images); i++) {
		struct diagnostics warnings = { 0 };
		struct scenery s;

		make_gltf(&s, images[i], PAINTED, "", &warnings);
		CHECK(shows_the_picture(&s) == (i < 2) && (warnings.count == 0) == (i < 2));
		if (i == 2)
			CHECK(strstr(warnings.first.text,
				     "a.gltf:2: the picture none.png is left"));
		if (i == 3)
			CHECK(strstr(warnings.first.text, "it is neither JPEG nor PNG"));
		if (i == 4) /* a % that begins no byte stands for itself */
			CHECK(strstr(warnings.first.text, "the picture 50%al%00%2.png is left"));
		scenery_finish(&s);
	}
}

static const char there[] = "{\"uri\": \"a%20b.png\"}";

/* KHR_texture_transform's own example shows the lower left quarter of a picture, which is green
 * here; with the whole picture its turn is clockwise. */
static void a_texture_transform_moves_the_picture(void **state)
{
	struct diagnostics warnings = { 0 };
	struct scenery s;

	(void)state;
	make_gltf(&s, there,
		  "\"pbrMetallicRoughness\": {" LAYING
		  ", \"extensions\": {\"KHR_texture_transform\": {\"offset\": [0, 1], "
		  "\"rotation\": 1.57079632679, \"scale\": [0.5, 0.5]}}}}",
		  "", &warnings);
	CHECK(scenery_decode_textures(&s) == 0);
	for (int i = 0; i < 4; i++)
		CHECK(is_colour(&s, i % 2 ? 0.1f : 0.9f, i / 2 ? 0.1f : 0.9f, 1));
	scenery_finish(&s);
	make_gltf(&s, there,
		  "\"pbrMetallicRoughness\": {\"baseColorTexture\": {\"index\": 0, "
		  "\"texCoord\": 7, \"extensions\": {\"KHR_texture_transform\": {\"texCoord\": 1, "
		  "\"offset\": [0, 1], \"rotation\": 1.57079632679}}}}",
		  "", &warnings);
	CHECK(scenery_decode_textures(&s) == 0 && warnings.count == 0);
	CHECK(is_colour(&s, 0.2f, 0.8f, 1) && is_colour(&s, 0.2f, 0.2f, 2));
	CHECK(is_colour(&s, 0.8f, 0.8f, 0) && is_colour(&s, 0.8f, 0.2f, 0));
	scenery_finish(&s);
}

static void a_normal_map_lies_where_the_picture_does(void **state)
{
	static const char map[] = "\"normalTexture\": {\"index\": 0, \"texCoord\": 1, "
				  "\"scale\": 0.5}, ";
	struct diagnostics warnings = { 0 };
	const uint8_t *red;
	char both[512];
	struct scenery s;

	(void)state;
	snprintf(both, sizeof(both), "%s%s", map, PAINTED);
	make_gltf(&s, there, both, "", &warnings);
	CHECK(warnings.count == 0 && s.texture_count == 2 && shows_the_picture(&s));
	CHECK(s.materials[0].by_pixel && s.materials[0].normals == 2);
	/* Red is 1 to the right and -1 down and inwards; half as deep, 1/2, -1/2 and -1. */
	red = &s.textures[1].rgba[4 * (10 * SIDE + 10)];
	CHECK(abs(red[0] - 180) < 4 && abs(red[1] - 75) < 4 && abs(red[2] - 23) < 4);
	scenery_finish(&s);
	/* without a picture it has its own place */
	snprintf(both, sizeof(both), "%s\"name\": \"plaster\"", map);
	make_gltf(&s, there, both, "", &warnings);
	CHECK(warnings.count == 0 && s.texture_count == 1 && s.materials[0].normals == 1 &&
	      s.materials[0].texture == 0 && s.meshes[0].uvs);
	scenery_finish(&s);
	snprintf(both, sizeof(both), "\"name\": \"plaster\", \"normalTexture\": {\"index\": 0}, %s",
		 PAINTED);
	make_gltf(&s, there, both, "", &warnings);
	CHECK(strstr(warnings.first.text, "the normal map of material \"plaster\" lies otherwise"));
	CHECK(s.materials[0].normals == 0 && shows_the_picture(&s));
	scenery_finish(&s);
}

/* What bends has its picture in every shape: a morph target here, an interpolator there. */
static void what_bends_keeps_its_picture(void **state)
{
	static const char lifting[] =
		"\"animations\": [{\"channels\": [{\"sampler\": 0, \"target\": {\"node\": 0, "
		"\"path\": \"weights\"}}], \"samplers\": [{\"input\": 3, \"output\": 3}]}],\n";
	struct diagnostics warnings = { 0 };
	struct scenery s;

	(void)state;
	make_gltf(&s, there, PAINTED, lifting, &warnings);
	CHECK(warnings.count == 0 && s.meshes[0].shape_count == 2 && shows_the_picture(&s));
	scenery_finish(&s);
	make_vrml(
		&s,
		SQUARE("ImageTexture { url \"a b.png\" }") "DEF T TimeSensor { loop TRUE cycleInterval 2 }\n"
							   "DEF I CoordinateInterpolator { key [ 0 1 ] keyValue [ 0 0 0, 1 0 0, 1 1 0, "
							   "0 1 0, 0 0 0, 1 0 0, 1 1 1, 0 1 1 ] }\n"
							   "ROUTE T.fraction_changed TO I.set_fraction\n"
							   "ROUTE I.value_changed TO C.point",
		&warnings);
	CHECK(warnings.count == 0 && s.meshes[0].shape_count == 2 && shows_the_picture(&s));
	scenery_finish(&s);
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(a_picture_is_kept_once_with_sides_that_are_powers_of_two),
		cmocka_unit_test(all_pictures_stay_within_their_budget),
		cmocka_unit_test(a_resized_picture_keeps_its_places),
		cmocka_unit_test(an_image_texture_takes_the_place_of_the_colour),
		cmocka_unit_test(a_picture_lies_beside_the_file_that_names_it),
		cmocka_unit_test(a_picture_that_cannot_be_read_is_a_warning),
		cmocka_unit_test(a_picture_that_cannot_be_read_now_is_an_error),
		cmocka_unit_test(a_texture_transform_of_vrml_moves_the_picture_too),
		cmocka_unit_test(a_base_colour_texture_is_shown),
		cmocka_unit_test(a_picture_whose_name_is_too_long_is_a_warning),
		cmocka_unit_test(a_texture_transform_moves_the_picture),
		cmocka_unit_test(a_normal_map_lies_where_the_picture_does),
		cmocka_unit_test(what_bends_keeps_its_picture),
	};

	return cmocka_run_group_tests(tests, NULL, NULL);
}
