/* Scenery on the wire: what comes back is what went in, and nothing else is taken. */
#include <errno.h>
#include <math.h>
#include <stdlib.h>

#include <zstd.h>

#include "format/picture.h"
#include "format/scenery_code.h"
#include "format/scenery_texture_code.h"
#include "tests/check.h"
#include "tests/format/little_scenery.h"

static struct buffer encoded(const struct scenery *scenery)
{
	struct buffer out;

	buffer_init(&out, 1 << 20);
	CHECK(scenery_encode(&out, scenery) == 0);
	return out;
}

static void comes_back_as_it_went(void **state)
{
	struct little_scenery s;
	struct scenery back;
	struct buffer bytes, again;

	(void)state;
	little_scenery_init(&s);
	s.material = (struct scenery_material){
		.has_two_sides = true,
		.by_pixel = true,
		.opacity = 0.5f,
		.emissive = { 0, 7 },
		.specular = { 0, 0, 9 },
		.shininess = 40,
		.substance = 2,
		.relief_m = 0.01f,
		.mirror = 0.25f,
		.grain = { 1, 0, 0 },
	};
	s.scenery.fog = (struct scenery_fog){ 30, true, { 11 }, 1 };
	bytes = encoded(&s.scenery);
	CHECK(scenery_decode(&back, buffer_bytes(&bytes)) == 0);
	CHECK(back.node_count == 3 && back.nodes[1].parent == 0 && back.nodes[2].layer == 1);
	CHECK(memcmp(back.nodes, s.nodes, sizeof(s.nodes)) == 0);
	CHECK(back.mesh_count == 2 && back.materials[0].has_two_sides &&
	      scenery_triangles(&back) == 4);
	CHECK(back.material_count == 1 && back.materials[0].by_pixel &&
	      back.materials[0].opacity == 0.5f && back.materials[0].emissive[1] == 7 &&
	      back.materials[0].specular[2] == 9 && back.materials[0].shininess == 40);
	CHECK(back.materials[0].substance == 2 && back.materials[0].relief_m == 0.01f &&
	      back.materials[0].mirror == 0.25f && back.materials[0].grain[0] == 1);
	CHECK(back.fog.range_m == 30 && back.fog.is_exponential && back.fog.rgb[0] == 11 &&
	      back.fog.layer == 1);
	CHECK(memcmp(back.meshes[1].vertices, s.vertices[1], sizeof(s.vertices[1])) == 0);
	CHECK(memcmp(back.meshes[1].triangles, s.triangles[1], sizeof(s.triangles[1])) == 0);
	CHECK(back.touches[0].node == 0 && back.motions[0].returns &&
	      back.motions[0].duration_s == 2);
	CHECK(back.tracks[1].target == SCENERY_OPACITY && back.tracks[1].first == 10);
	CHECK(memcmp(back.numbers, s.numbers, sizeof(s.numbers)) == 0);
	CHECK(strcmp(back.titles[back.layers[1].first_title].text, "As built") == 0);
	again = encoded(&back);
	CHECK(again.size == bytes.size && memcmp(again.data, bytes.data, bytes.size) == 0);
	scenery_finish(&back);
	buffer_finish(&bytes);
	buffer_finish(&again);
}

static void shapes_and_drags_come_back_too(void **state)
{
	struct little_scenery s;
	struct scenery back;
	struct buffer bytes;

	(void)state;
	little_scenery_init(&s);
	little_scenery_add_drag(&s);
	little_scenery_add_shapes(&s);
	s.drag.offset[2] = 0.25f;
	s.drag.low[1] = -1;
	s.drag.disc_rad = 0.5f;
	s.tracks[1].target = SCENERY_SHAPE;
	bytes = encoded(&s.scenery);
	CHECK(scenery_decode(&back, buffer_bytes(&bytes)) == 0);
	CHECK(back.drag_count == 1 && memcmp(back.drags, &s.drag, sizeof(s.drag)) == 0);
	CHECK(back.meshes[0].shape_count == 0 && back.meshes[1].shape_count == 2);
	CHECK(memcmp(back.meshes[1].shapes, s.shapes, sizeof(s.shapes)) == 0);
	CHECK(scenery_sets(&back, 1, SCENERY_SHAPE) && !scenery_sets(&back, 1, SCENERY_COLOUR));
	scenery_finish(&back);
	buffer_finish(&bytes);
}

/* Puts a picture of 2 x 1 pixels on the door. jpeg and uvs are the caller's. */
static void add_picture(struct little_scenery *s, struct scenery_texture *texture,
			uint16_t (*uvs)[2], struct buffer *jpeg)
{
	static uint8_t pixels[8] = { 250, 250, 250, 255, 10, 10, 10, 255 };

	buffer_init(jpeg, 1 << 16);
	CHECK(picture_encode_jpeg(jpeg, &(struct picture){ 2, 1, pixels }, 95) == 0);
	*texture = (struct scenery_texture){ .width = 2,
					     .height = 1,
					     .repeats = true,
					     .jpeg = jpeg->data,
					     .jpeg_bytes = (uint32_t)jpeg->size };
	s->scenery.textures = texture;
	s->scenery.texture_count = 1;
	s->material.by_pixel = true;
	s->material.texture = 1;
	for (int m = 0; m < 2; m++) {
		s->meshes[m].uvs = uvs;
		s->meshes[m].uv_step[0] = 0.25f;
		s->meshes[m].uv_origin[1] = -3;
	}
}

static void pictures_come_back_too(void **state)
{
	uint16_t uvs[4][2] = { { 1, 2 }, { 3, 4 }, { 5, 6 }, { 7, 65535 } };
	struct scenery_texture texture;
	struct buffer object, jpeg;
	struct little_scenery s;
	struct scenery out;

	(void)state;
	little_scenery_init(&s);
	buffer_init(&object, 1 << 20);
	CHECK(scenery_encode(&object, &s.scenery) == 0);
	CHECK(object.data[4] == 3); /* without pictures, what an older terminal reads */
	add_picture(&s, &texture, uvs, &jpeg);
	buffer_clear(&object);
	CHECK(scenery_encode(&object, &s.scenery) == 0 && object.data[4] == 4);
	CHECK(scenery_decode(&out, buffer_bytes(&object)) == 0);
	CHECK(out.texture_count == 1 && out.textures[0].repeats && out.materials[0].texture == 1);
	CHECK(memcmp(out.meshes[1].uvs, uvs, sizeof(uvs)) == 0);
	CHECK(out.meshes[0].uv_step[0] == 0.25f && out.meshes[0].uv_origin[1] == -3);
	CHECK(scenery_decode_textures(&out) == 0);
	CHECK(out.textures[0].rgba[0] > 200 && out.textures[0].rgba[4] < 50);
	scenery_finish(&out);
	for (size_t n = 0; n < object.size; n++)
		CHECK(scenery_decode(&out, (struct bytes){ object.data, n }) == -EBADMSG);
	/* a picture of another size, and one that is none, are found when they are decoded */
	texture.height = 2;
	buffer_clear(&object);
	CHECK(scenery_encode(&object, &s.scenery) == 0);
	CHECK(scenery_decode(&out, buffer_bytes(&object)) == 0);
	CHECK(scenery_decode_textures(&out) == -EBADMSG);
	out.textures[0].jpeg[0] = 0;
	CHECK(scenery_decode_textures(&out) == -EBADMSG);
	scenery_finish(&out);
	buffer_finish(&object);
	buffer_finish(&jpeg);
}

static void normal_maps_come_back_too(void **state)
{
	uint16_t uvs[4][2] = { { 1, 2 }, { 3, 4 }, { 5, 6 }, { 7, 65535 } };
	struct scenery_texture texture;
	struct buffer object, jpeg;
	struct little_scenery s;
	struct scenery out;

	(void)state;
	little_scenery_init(&s);
	add_picture(&s, &texture, uvs, &jpeg);
	s.material.texture = 0; /* where a picture lies is known, as its normal map needs it */
	s.material.normals = 1;
	buffer_init(&object, 1 << 20);
	CHECK(scenery_encode(&object, &s.scenery) == 0 && object.data[4] == 5);
	CHECK(scenery_decode(&out, buffer_bytes(&object)) == 0);
	CHECK(out.materials[0].texture == 0 && out.materials[0].normals == 1);
	CHECK(memcmp(out.meshes[1].uvs, uvs, sizeof(uvs)) == 0);
	scenery_finish(&out);
	for (size_t n = 0; n < object.size; n++)
		CHECK(scenery_decode(&out, (struct bytes){ object.data, n }) == -EBADMSG);
	buffer_clear(&object);
	s.material.normals = 2;
	CHECK(scenery_encode(&object, &s.scenery) == -EINVAL);
	s.material.normals = 1;
	s.material.by_pixel = false;
	CHECK(scenery_encode(&object, &s.scenery) == -EINVAL);
	buffer_finish(&object);
	buffer_finish(&jpeg);
}

static void sights_come_back_too(void **state)
{
	struct little_scenery s;
	struct buffer object;
	struct scenery out;

	(void)state;
	little_scenery_init(&s);
	s.nodes[0].sight = (struct scenery_sight){ SCENERY_SIGHT_FACES, { 0, 1, 0 }, 0, 0 };
	s.nodes[2].sight = (struct scenery_sight){ SCENERY_SIGHT_LEVEL, { 3, 0, 9 }, 8, INFINITY };
	object = encoded(&s.scenery);
	CHECK(object.data[4] == 6);
	CHECK(scenery_decode(&out, buffer_bytes(&object)) == 0);
	CHECK(memcmp(out.nodes, s.nodes, sizeof(s.nodes)) == 0 && out.texture_count == 0);
	scenery_finish(&out);
	for (size_t n = 0; n < object.size; n++)
		CHECK(scenery_decode(&out, (struct bytes){ object.data, n }) == -EBADMSG);
	object.data[4] = 5; /* which has none, but always a picture */
	CHECK(scenery_decode(&out, buffer_bytes(&object)) == -EBADMSG);
	buffer_finish(&object);
}

/* Packs the last object again after its last number of bytes became others. */
static int decode_with(const struct scenery *scenery, size_t from_end, uint32_t value)
{
	struct buffer object = encoded(scenery), again;
	struct reader in;
	struct scenery out;
	struct bytes packed;
	uint8_t *raw, room[4096];
	size_t size;
	int rc;

	reader_init(&in, buffer_bytes(&object));
	(void)reader_bytes(&in, 5);
	size = reader_u32(&in);
	packed = reader_bytes(&in, reader_left(&in));
	raw = malloc(size);
	CHECK(raw && ZSTD_decompress(raw, size, packed.data, packed.size) == size);
	for (int k = 0; k < 4; k++)
		raw[size - from_end + (size_t)k] = (uint8_t)(value >> 8 * k);
	buffer_init(&again, 1 << 20);
	buffer_put(&again, object.data, 9);
	buffer_put(&again, room, ZSTD_compress(room, sizeof(room), raw, size, 1));
	rc = scenery_decode(&out, buffer_bytes(&again));
	scenery_finish(&out);
	free(raw);
	buffer_finish(&object);
	buffer_finish(&again);
	return rc;
}

/* The last sight: count, and node, kind, a place, from, to. */
static void faulty_sights_are_not_read(void **state)
{
	const uint32_t nan = 0x7fc00000, one = 0x3f800000;
	struct little_scenery s;

	(void)state;
	little_scenery_init(&s);
	s.nodes[2].sight = (struct scenery_sight){ SCENERY_SIGHT_LEVEL, { 3, 0, 9 }, 8, INFINITY };
	CHECK(decode_with(&s.scenery, 29, 1) == 0);
	CHECK(decode_with(&s.scenery, 29, 0) == -EBADMSG);          /* version 6 for nothing */
	CHECK(decode_with(&s.scenery, 29, 2) == -EBADMSG);          /* there is one */
	CHECK(decode_with(&s.scenery, 29, UINT32_MAX) == -EBADMSG); /* nor so many */
	CHECK(decode_with(&s.scenery, 25, 3) == -EBADMSG);          /* no such node */
	CHECK(decode_with(&s.scenery, 20, nan) == -EBADMSG);
	CHECK(decode_with(&s.scenery, 8, nan) == -EBADMSG);
	CHECK(decode_with(&s.scenery, 8, one | 0x80000000) == -EBADMSG); /* less than 0 */
	CHECK(decode_with(&s.scenery, 4, nan) == -EBADMSG);
	CHECK(decode_with(&s.scenery, 4, one) == -EBADMSG); /* before it begins */
	for (uint32_t kind = 0; kind < 256; kind++)         /* 3.0f has no low bits */
		CHECK(decode_with(&s.scenery, 21, kind) == (kind == 2 ? 0 : -EBADMSG));
}

static void pictures_that_break_a_rule_are_not_written(void **state)
{
	uint16_t uvs[4][2] = { { 0 } };

	(void)state;
	for (int i = 0; i < 8; i++) {
		struct scenery_texture texture;
		struct buffer object, jpeg;
		struct little_scenery s;

		little_scenery_init(&s);
		add_picture(&s, &texture, uvs, &jpeg);
		texture.width = i == 1 ? 3 : i == 2 ? 4096 : i == 3 ? 0 : 2;
		s.material.texture = i == 4 ? 2 : 1;
		s.material.by_pixel = i != 5;
		if (i == 6)
			s.meshes[1].uvs = NULL;
		if (i == 7)
			s.meshes[0].uv_step[1] = NAN;
		buffer_init(&object, 1 << 20);
		CHECK(scenery_encode(&object, &s.scenery) == (i == 0 ? 0 : -EINVAL));
		buffer_finish(&object);
		buffer_finish(&jpeg);
	}
}

static void refuses_every_truncation_and_survives_every_bit(void **state)
{
	struct little_scenery s;
	struct scenery back;
	struct buffer bytes;

	(void)state;
	little_scenery_init(&s);
	little_scenery_add_drag(&s);
	little_scenery_add_shapes(&s);
	bytes = encoded(&s.scenery);
	for (size_t n = 0; n < bytes.size; n++) {
		uint8_t *exact = malloc(n ? n : 1);

		memcpy(exact, bytes.data, n);
		CHECK(scenery_decode(&back, (struct bytes){ exact, n }) == -EBADMSG);
		CHECK(back.nodes == NULL);
		free(exact);
	}
	for (size_t bit = 0; bit < 8 * bytes.size; bit++) {
		bytes.data[bit / 8] ^= (uint8_t)(1 << bit % 8);
		if (scenery_decode(&back, buffer_bytes(&bytes)) == 0)
			scenery_finish(&back); /* other numbers, as good */
		bytes.data[bit / 8] ^= (uint8_t)(1 << bit % 8);
	}
	buffer_put_u8(&bytes, 0);
	CHECK(scenery_decode(&back, buffer_bytes(&bytes)) == -EBADMSG);
	buffer_finish(&bytes);
}

static bool is_written(struct little_scenery *s)
{
	struct buffer out;
	int rc;

	buffer_init(&out, 1 << 20);
	rc = scenery_encode(&out, &s->scenery);
	buffer_finish(&out);
	little_scenery_init(s);
	CHECK(rc == 0 || rc == -EINVAL);
	return rc == 0;
}

static void what_breaks_a_rule_is_not_written(void **state)
{
	struct little_scenery s;

	(void)state;
	little_scenery_init(&s);
	CHECK(is_written(&s));
	s.nodes[1].parent = 1; /* its own parent */
	CHECK(!is_written(&s));
	s.nodes[1].layer = 0; /* its parent has none */
	CHECK(!is_written(&s));
	s.nodes[2].layer = 2; /* no such layer */
	CHECK(!is_written(&s));
	s.nodes[0].place.turn[3] = 0.5f; /* no unit quaternion */
	CHECK(!is_written(&s));
	s.nodes[0].place.move_m[0] = NAN;
	CHECK(!is_written(&s));
	s.nodes[0].sight = (struct scenery_sight){ SCENERY_SIGHT_FACES, { 0, 2, 0 }, 0, 0 };
	CHECK(!is_written(&s));
	s.nodes[0].sight = (struct scenery_sight){ SCENERY_SIGHT_FACES, { 0 }, 0, 0 };
	CHECK(is_written(&s));
	s.nodes[0].sight = (struct scenery_sight){ SCENERY_SIGHT_FACES, { 0 }, 0, 1 };
	CHECK(!is_written(&s));
	s.nodes[0].sight = (struct scenery_sight){ SCENERY_SIGHT_NONE, { 0, 1, 0 }, 0, 0 };
	CHECK(!is_written(&s));
	s.nodes[0].sight = (struct scenery_sight){ SCENERY_SIGHT_LEVEL, { 0 }, 2, 2 };
	CHECK(!is_written(&s));
	s.nodes[0].sight.kind = SCENERY_SIGHT_KINDS;
	CHECK(!is_written(&s));
	s.meshes[1].node = 3;
	CHECK(!is_written(&s));
	s.meshes[1].material = 1;
	CHECK(!is_written(&s));
	s.material.opacity = 0; /* nobody can see it */
	CHECK(!is_written(&s));
	s.material.opacity = NAN;
	CHECK(!is_written(&s));
	s.material.specular[1] = 1; /* and no shininess */
	CHECK(!is_written(&s));
	s.material.shininess = 129;
	CHECK(!is_written(&s));
	s.material.substance = 2; /* without light at each pixel */
	CHECK(!is_written(&s));
	s.material.by_pixel = true;
	s.material.substance = SCENERY_SUBSTANCES;
	CHECK(!is_written(&s));
	s.material.by_pixel = true;
	s.material.relief_m = 0.2f;
	CHECK(!is_written(&s));
	s.material.by_pixel = true;
	s.material.mirror = -1;
	CHECK(!is_written(&s));
	s.material.grain[0] = 1; /* not a unit vector any more */
	CHECK(!is_written(&s));
	s.scenery.fog = (struct scenery_fog){ .range_m = 9, .layer = 2 }; /* no such layer */
	CHECK(!is_written(&s));
	s.scenery.fog.range_m = INFINITY;
	CHECK(!is_written(&s));
	s.triangles[0][1][2] = 4;
	CHECK(!is_written(&s));
	s.motion.duration_s = 0;
	CHECK(!is_written(&s));
	s.scenery.touch_count = 0; /* always, and yet only once */
	CHECK(!is_written(&s));
	s.touch.motion = 1;
	CHECK(!is_written(&s));
	s.motion.loops = true; /* and returns */
	CHECK(!is_written(&s));
	s.numbers[1] = 1.5f; /* after the end */
	CHECK(!is_written(&s));
	s.numbers[10] = 1; /* both keys at the end: a step */
	CHECK(is_written(&s));
	s.numbers[10] = 1;
	s.numbers[11] = 0; /* back in time */
	CHECK(!is_written(&s));
	s.numbers[13] = 2; /* more than solid */
	CHECK(!is_written(&s));
	s.scenery.layer_count = 1; /* nothing to choose from */
	s.scenery.title_count = 2;
	CHECK(!is_written(&s));
	s.titles[2].text[0] = '\0';
	CHECK(!is_written(&s));
	s.tracks[1].target = SCENERY_SHAPE;
	CHECK(is_written(&s));
	s.tracks[1].target = SCENERY_SHAPE;
	s.numbers[12] = SCENERY_SHAPES_MAX; /* no mesh has so many */
	CHECK(!is_written(&s));
	little_scenery_add_drag(&s);
	CHECK(is_written(&s));
	little_scenery_add_drag(&s);
	s.drag.node = 3;
	CHECK(!is_written(&s));
	little_scenery_add_drag(&s);
	s.drag.kind = SCENERY_DRAG_SPHERE; /* its offset is no turn */
	CHECK(!is_written(&s));
	little_scenery_add_drag(&s);
	s.drag.disc_rad = 2;
	CHECK(!is_written(&s));
	little_scenery_add_drag(&s);
	s.drag.high[1] = NAN;
	CHECK(!is_written(&s));
	memcpy(s.titles[2].text, "\xff\xfe", 3); /* not UTF-8 */
	CHECK(!is_written(&s));
}

static void read_version(struct scenery *out, const char *path, uint8_t version)
{
	struct buffer file;

	buffer_init(&file, 1 << 20);
	CHECK(buffer_read_file(&file, path) == 0 && file.data[4] == version);
	CHECK(scenery_decode(out, buffer_bytes(&file)) == 0);
	buffer_finish(&file);
}

/* The glass of the fuzzer's corpus was written by the second version. */
static void reads_what_was_published_before_there_were_shapes(void **state)
{
	struct scenery back;

	(void)state;
	read_version(&back, "tests/fuzz/corpus/scenery/glass", 2);
	CHECK(back.mesh_count > 0 && back.drag_count == 0 && back.meshes[0].shape_count == 0);
	scenery_finish(&back);
}

/* The door of the fuzzer's corpus was written by the first version. */
static void reads_what_was_published_before_there_were_materials(void **state)
{
	struct scenery back;

	(void)state;
	read_version(&back, "tests/fuzz/corpus/scenery/door", 1);
	CHECK(back.material_count == 2 && back.mesh_count == 2);
	for (uint32_t i = 0; i < 2; i++)
		CHECK(back.materials[i].has_two_sides == (i == 1) &&
		      back.materials[i].opacity == 1 && !back.materials[i].by_pixel);
	CHECK(back.meshes[0].material == 1 && back.fog.range_m == 0);
	scenery_finish(&back);
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(comes_back_as_it_went),
		cmocka_unit_test(shapes_and_drags_come_back_too),
		cmocka_unit_test(reads_what_was_published_before_there_were_shapes),
		cmocka_unit_test(reads_what_was_published_before_there_were_materials),
		cmocka_unit_test(refuses_every_truncation_and_survives_every_bit),
		cmocka_unit_test(pictures_come_back_too),
		cmocka_unit_test(normal_maps_come_back_too),
		cmocka_unit_test(sights_come_back_too),
		cmocka_unit_test(faulty_sights_are_not_read),
		cmocka_unit_test(pictures_that_break_a_rule_are_not_written),
		cmocka_unit_test(what_breaks_a_rule_is_not_written),
	};

	return cmocka_run_group_tests(tests, NULL, NULL);
}
