/* glTF scenes as scenery: what animations move becomes nodes and motions, what is refused is named.
 */
#include "pipeline/scene/gltf_scenery.h"

#include <errno.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "format/normal.h"
#include "format/scenery_code.h"
#include "tests/check.h"
#include "tests/pipeline/scene/little_gltf.h"

/* The numbers of all examples: 3 places; times 0 1 2; 3 moves; 2 turns; a spline of 2 keys. */
static const float numbers[] = {
	0, 0, 0, 2, 0, 0, 0, 2,     0,                            /* accessor 0 */
	0, 1, 2,                                                  /* 1 */
	0, 0, 0, 0, 4, 0, 0, 4,     8,                            /* 2 */
	0, 0, 0, 1, 0, 1, 0, 1e-8f,                               /* 3, with the times of 4 */
	0, 0, 0, 1, 1, 1, 3, 0,     0, 0, 0, 0, 2, 2, 2, 0, 0, 0, /* 5: tangent, value, tangent */
};

#define ACCESSORS                                                                                  \
	"\"bufferViews\": [{\"buffer\": 0, \"byteLength\": 188}],\n"                               \
	"\"accessors\": [\n"                                                                       \
	"{\"bufferView\": 0, \"componentType\": 5126, \"count\": 3, \"type\": \"VEC3\"},\n"        \
	"{\"bufferView\": 0, \"byteOffset\": 36, \"componentType\": 5126, \"count\": 3,"           \
	" \"type\": \"SCALAR\"},\n"                                                                \
	"{\"bufferView\": 0, \"byteOffset\": 48, \"componentType\": 5126, \"count\": 3,"           \
	" \"type\": \"VEC3\"},\n"                                                                  \
	"{\"bufferView\": 0, \"byteOffset\": 84, \"componentType\": 5126, \"count\": 2,"           \
	" \"type\": \"VEC4\"},\n"                                                                  \
	"{\"bufferView\": 0, \"byteOffset\": 36, \"componentType\": 5126, \"count\": 2,"           \
	" \"type\": \"SCALAR\"},\n"                                                                \
	"{\"bufferView\": 0, \"byteOffset\": 116, \"componentType\": 5126, \"count\": 6,"          \
	" \"type\": \"VEC3\"}],\n"
#define MESHES                                                                                        \
	"\"meshes\": [{\"name\": \"leaf\","                                                           \
	" \"primitives\": [{\"attributes\": {\"POSITION\": 0}, \"material\": 0}]}],\n"                \
	"\"materials\": [{\"doubleSided\": true, \"alphaMode\": \"BLEND\", \"pbrMetallicRoughness\":" \
	" {\"baseColorFactor\": [1, 0.214, 0, 0.5]}}],\n"
/* A frame that stands, a hinge in it that animations move, and a leaf on the hinge. */
#define NODES                                                                                      \
	"\"nodes\": [\n"                                                                           \
	"{\"name\": \"frame\", \"translation\": [10, 0, 0], \"mesh\": 0, \"children\": [1]},\n"    \
	"{\"name\": \"hinge\", \"translation\": [0, 1, 0], \"children\": [2]},\n"                  \
	"{\"name\": \"leaf\", \"matrix\": [2,0,0,0, 0,2,0,0, 0,0,2,0, 1,0,0,1], \"mesh\": 0}],\n"
#define ANIMATION(target, sampler)                                                                 \
	"\"animations\": [{\"name\": \"open\", \"channels\": [{\"sampler\": 0, \"target\": "       \
	"{\"node\": 1, \"path\": \"" target "\"}}], \"samplers\": [{" sampler "}]}],\n"
#define SCENES "\"scenes\": [{\"name\": \"a\", \"nodes\": [0]}, {\"name\": \"b\", \"nodes\": [2]}]"

static int make(struct scenery *out, const char *lists, const struct gltf_choice *choice,
		struct diagnostics *diagnostics, struct diagnostics *warnings)
{
	const struct scenery_node root = { .parent = SCENERY_NONE,
					   .layer = SCENERY_NONE,
					   .place = scenery_at_rest };
	struct scenery_look beam = { .name = "beam", .substance = SUBSTANCE_WOOD };
	struct scenery_maker maker = { .looks = &beam, .look_count = 1 };
	struct gltf gltf;
	uint32_t node = 0;
	int rc;

	CHECK(sizeof(numbers) == 188);
	*out = (struct scenery){ 0 };
	CHECK(scenery_add_node(&maker, &root, &node) == 0);
	rc = little_gltf_read(&gltf, numbers, sizeof(numbers), lists, diagnostics);
	if (rc == 0)
		rc = gltf_scenery_add(&maker, &gltf, node, choice, warnings);
	if (rc == 0)
		CHECK(scenery_maker_end(&maker, out) == 0 && scenery_is_sane(out));
	scenery_maker_finish(&maker);
	gltf_finish(&gltf);
	return rc;
}

static const char moving[] =
	ACCESSORS MESHES NODES ANIMATION("translation", "\"input\": 1, \"output\": 2") SCENES;
static const char stepping[] = ACCESSORS MESHES NODES ANIMATION(
	"translation", "\"input\": 1, \"output\": 2, \"interpolation\": \"STEP\"") SCENES;
static const char turning[] =
	ACCESSORS MESHES NODES ANIMATION("rotation", "\"input\": 4, \"output\": 3") SCENES;
static const char bowing[] = ACCESSORS MESHES NODES ANIMATION(
	"scale", "\"input\": 4, \"output\": 5, \"interpolation\": \"CUBICSPLINE\"") SCENES;

static void an_animation_moves_its_node_when_that_is_touched(void **state)
{
	const struct gltf_choice choice = { 0 };
	struct diagnostics diagnostics = { 0 }, warnings = { 0 };
	const float *times, *values;
	struct scenery s;

	(void)state;
	if (make(&s, moving, &choice, &diagnostics, &warnings) != 0)
		fail_msg("%s", diagnostics.first.text);
	CHECK(warnings.count == 0);
	/* The root, the frame, since something moves below it, and the hinge; the leaf's place is
	 * in its triangles. */
	CHECK(s.node_count == 3 && s.nodes[1].parent == 0 && s.nodes[2].parent == 1);
	CHECK(s.nodes[1].place.move_m[0] == 10 && s.nodes[2].place.move_m[1] == 1);
	CHECK(s.mesh_count == 2 && s.meshes[0].node == 1 && s.meshes[1].node == 2);
	CHECK(s.meshes[1].origin_m[0] == 1);
	CHECK(s.material_count == 1 && s.materials[0].has_two_sides &&
	      s.materials[0].opacity == 0.5f);
	CHECK(s.meshes[1].step_m * 65535 > 3.9f); /* 2 long, and twice as large */
	CHECK(s.meshes[0].vertices[0].rgb[0] == 255 && s.meshes[0].vertices[0].rgb[2] == 0);
	CHECK(abs(s.meshes[0].vertices[0].rgb[1] - 128) <= 1); /* linear 0.214 is half in sRGB */
	CHECK(s.motion_count == 1 && s.motions[0].duration_s == 2);
	CHECK(s.motions[0].returns && !s.motions[0].loops);
	CHECK(s.touch_count == 1 && s.touches[0].node == 2);
	CHECK(s.track_count == 1 && s.tracks[0].node == 2 && s.tracks[0].target == SCENERY_MOVE);
	times = &s.numbers[s.tracks[0].first];
	values = times + s.tracks[0].key_count;
	CHECK(s.tracks[0].key_count == 3 && times[1] == 0.5f && values[4] == 4 && values[8] == 8);
	scenery_finish(&s);
}

static void what_plays_always_loops_and_needs_no_touch(void **state)
{
	const struct gltf_choice choice = { .plays_always = true };
	struct diagnostics diagnostics = { 0 }, warnings = { 0 };
	struct scenery s;

	(void)state;
	CHECK(make(&s, turning, &choice, &diagnostics, &warnings) == 0);
	CHECK(s.motions[0].loops && !s.motions[0].returns && s.touch_count == 0);
	CHECK(s.tracks[0].target == SCENERY_TURN && s.motions[0].duration_s == 1);
	scenery_finish(&s);
}

static void a_step_keeps_each_value_until_the_next_time(void **state)
{
	static const float times[] = { 0, 0.5f, 0.5f, 1, 1 }, heights[] = { 0, 0, 4, 4, 4 };
	const struct gltf_choice choice = { 0 };
	struct diagnostics diagnostics = { 0 }, warnings = { 0 };
	struct scenery s;

	(void)state;
	CHECK(make(&s, stepping, &choice, &diagnostics, &warnings) == 0);
	CHECK(s.tracks[0].key_count == 5);
	for (uint32_t i = 0; i < 5; i++) {
		CHECK(s.numbers[i] == times[i]);
		CHECK(s.numbers[5 + 3 * i + 1] == heights[i]);
	}
	scenery_finish(&s);
}

/* From 1 with slope 3 to 0 with slope 2, in x; the polynomial of the specification by hand. */
static void a_spline_is_followed_closely(void **state)
{
	const struct gltf_choice choice = { 0 };
	struct diagnostics diagnostics = { 0 }, warnings = { 0 };
	struct scenery s;
	float worst = 0;

	(void)state;
	CHECK(make(&s, bowing, &choice, &diagnostics, &warnings) == 0);
	CHECK(s.tracks[0].key_count == 9 && s.tracks[0].target == SCENERY_SCALE);
	for (uint32_t i = 0; i <= 800; i++) {
		const float t = (float)i / 800;
		const uint32_t key = i == 800 ? 7 : i / 100;
		const float *x = &s.numbers[9 + 3 * key];
		const float share = t * 8 - (float)key, is = x[0] + share * (x[3] - x[0]);
		const float must = numbers[32] * (2 * t * t * t - 3 * t * t + 1) +
				   numbers[35] * (t * t * t - 2 * t * t + t) +
				   numbers[41] * (3 * t * t - 2 * t * t * t) +
				   numbers[38] * (t * t * t - t * t);

		worst = fmaxf(worst, fabsf(is - must));
	}
	CHECK(worst < 0.03f);
	scenery_finish(&s);
}

/* Gold, as smooth as it is metal; wood that the content names; and what glTF means without a word.
 */
static void a_smooth_metal_shines_and_a_named_material_is_wood(void **state)
{
	static const char three[] = ACCESSORS
		"\"meshes\": [{\"primitives\": [{\"attributes\": {\"POSITION\": 0}, \"material\": 0},"
		"{\"attributes\": {\"POSITION\": 0}, \"material\": 1},"
		"{\"attributes\": {\"POSITION\": 0}, \"material\": 2}]}],\n"
		"\"materials\": [{\"pbrMetallicRoughness\": {\"roughnessFactor\": 0.5,"
		"\"baseColorFactor\": [1, 0.5, 0, 1]}}, {\"name\": \"beam\"}, {}],\n"
		"\"nodes\": [{\"mesh\": 0}], \"scenes\": [{\"nodes\": [0]}]";
	const struct gltf_choice choice = { 0 };
	struct diagnostics diagnostics = { 0 }, warnings = { 0 };
	const struct scenery_material *m;
	struct scenery s;

	(void)state;
	CHECK(make(&s, three, &choice, &diagnostics, &warnings) == 0 && warnings.count == 0);
	CHECK(s.material_count == 3);
	m = s.materials;
	CHECK(m[0].by_pixel && m[0].shininess == 30 && fabsf(m[0].mirror - 0.3f) < 1e-6f);
	CHECK(m[0].specular[0] > m[0].specular[1] && m[0].specular[2] == 0);
	CHECK(m[1].substance == SUBSTANCE_WOOD && m[1].by_pixel && m[1].mirror == 0);
	CHECK(s.meshes[1].vertices[0].rgb[0] > s.meshes[1].vertices[0].rgb[2] + 30); /* brown */
	CHECK(!m[2].by_pixel && m[2].shininess == 0 && m[2].mirror == 0);
	scenery_finish(&s);
}

static void normals_of_the_file_are_kept(void **state)
{
	static const char lit[] = ACCESSORS
		"\"meshes\": [{\"primitives\": [{\"attributes\": {\"POSITION\": 0, \"NORMAL\": 2}}]}],"
		"\"nodes\": [{\"mesh\": 0}], \"scenes\": [{\"nodes\": [0]}]";
	/* the first is 0 0 0, so it is that of the face; 0 4 0; 0 4 8 */
	static const float wanted[3][3] = { { 0, 0, 1 }, { 0, 1, 0 }, { 0, 0.4472f, 0.8944f } };
	const struct gltf_choice choice = { 0 };
	struct diagnostics diagnostics = { 0 }, warnings = { 0 };
	struct scenery s;

	(void)state;
	CHECK(make(&s, lit, &choice, &diagnostics, &warnings) == 0 && warnings.count == 0);
	CHECK(s.meshes[0].vertex_count == 3);
	for (uint32_t v = 0; v < 3; v++) {
		float normal[3];

		normal_decode(normal, s.meshes[0].vertices[v].normal);
		for (int k = 0; k < 3; k++)
			CHECK(fabsf(normal[k] - wanted[v][k]) < 0.02f);
	}
	scenery_finish(&s);
}

static void a_scene_is_chosen_by_its_name(void **state)
{
	const struct gltf_choice b = { .scene = "b" }, c = { .scene = "c" };
	struct diagnostics diagnostics = { 0 }, warnings = { 0 };
	struct scenery s;

	(void)state;
	CHECK(make(&s, moving, &b, &diagnostics, &warnings) == 0);
	CHECK(s.node_count == 1 && s.mesh_count == 1 && s.motion_count == 0);
	CHECK(strstr(warnings.first.text, "animation \"open\" moves nothing of the scene"));
	scenery_finish(&s);
	CHECK(make(&s, moving, &c, &diagnostics, &warnings) == -EINVAL);
	CHECK(strstr(diagnostics.first.text, "a.gltf: has no scene \"c\""));
}

/* A triangle whose second corner rises by 4 and third by 4 and 8 times a weight of 0, 1 and 2. */
#define MORPH                                                                                      \
	"\"meshes\": [{\"weights\": [0.5], \"primitives\": [{\"attributes\":"                      \
	" {\"POSITION\": 0}, \"targets\": [{\"POSITION\": 2}]}]}],\n"

static void weights_of_morph_targets_make_shapes(void **state)
{
	static const char bends[] = ACCESSORS MORPH "\"nodes\": [{}, {\"mesh\": 0}]," ANIMATION(
		"weights", "\"input\": 1, \"output\": 1") "\"scenes\": [{\"nodes\": [1]}]";
	static const char stands[] =
		ACCESSORS MORPH "\"nodes\": [{\"mesh\": 0}],\"scenes\": [{\"nodes\": [0]}]";
	static const char idle[] = ACCESSORS MESHES "\"nodes\": [{}, {\"mesh\": 0}]," ANIMATION(
		"weights", "\"input\": 1, \"output\": 1") "\"scenes\": [{\"nodes\": [1]}]";
	const struct gltf_choice choice = { 0 };
	struct diagnostics diagnostics = { 0 }, warnings = { 0 };
	const struct scenery_mesh *mesh;
	struct scenery s;

	(void)state;
	if (make(&s, bends, &choice, &diagnostics, &warnings) != 0)
		fail_msg("%s", diagnostics.first.text);
	CHECK(warnings.count == 0 && s.mesh_count == 1 && s.track_count == 1);
	mesh = s.meshes;
	CHECK(mesh->shape_count == 3 && mesh->vertex_count == 3 && mesh->node == s.tracks[0].node);
	CHECK(s.tracks[0].target == SCENERY_SHAPE && s.tracks[0].key_count == 3);
	CHECK(s.numbers[s.tracks[0].first + 1] == 0.5f && s.numbers[s.tracks[0].first + 5] == 2);
	CHECK(s.touch_count == 1 && s.motions[0].returns && s.motions[0].duration_s == 2);
	for (uint32_t shape = 0; shape < 3; shape++)
		for (uint32_t v = 0; v < 3; v++) {
			const uint16_t *at = mesh->shapes[3 * shape + v].place;
			float place[3];

			for (int k = 0; k < 3; k++)
				place[k] = mesh->origin_m[k] + mesh->step_m * (float)at[k];
			CHECK(fabsf(place[0] - (v == 1 ? 2 : 0)) < 1e-3f);
			CHECK(fabsf(place[1] - ((v == 2 ? 2 : 0) +
						(v > 0 ? 4.0f * (float)shape : 0))) < 1e-3f);
			CHECK(fabsf(place[2] - (v == 2 ? 8.0f * (float)shape : 0)) < 1e-3f);
		}
	scenery_finish(&s);
	/* Without an animation it stands as its weights say. */
	CHECK(make(&s, stands, &choice, &diagnostics, &warnings) == 0);
	CHECK(s.meshes[0].shape_count == 0 && s.node_count == 1);
	CHECK(fabsf(s.meshes[0].step_m * (SCENERY_PLACE_MAX - 1) - 4) < 1e-3f);
	scenery_finish(&s);
	/* Weights of a mesh without targets move nothing. */
	CHECK(make(&s, idle, &choice, &diagnostics, &warnings) == 0);
	CHECK(s.motion_count == 0 && strstr(warnings.first.text, "moves nothing of the scene"));
	scenery_finish(&s);
}

static void what_is_refused_names_place_and_cure(void **state)
{
	static const struct {
		const char *text, *words;
		int error;
	} cases[] = {
		{ ACCESSORS MESHES
		  "\"nodes\": [\n{\"name\": \"man\", \"mesh\": 0, \"skin\": 0}]," SCENES,
		  "node \"man\" is bent by a skin, which scenery does not have; export it as stiff",
		  -ENOTSUP },
		{ ACCESSORS
		  "\"meshes\": [{\"primitives\": [{\"attributes\": {\"POSITION\": 0}, "
		  "\"targets\": [{\"POSITION\": 5}]}]}], \"nodes\": [{\"mesh\": 0}]," SCENES,
		  "another number of vertices", -EBADMSG },
		{ ACCESSORS MORPH "\"nodes\": [{}, {\"mesh\": 0}]," ANIMATION(
			  "weights",
			  "\"input\": 1, \"output\": 4") "\"scenes\": [{\"nodes\": [1]}]",
		  "another number of times than of values", -EBADMSG },
		{ ACCESSORS MESHES NODES ANIMATION("scale", "\"input\": 4, \"output\": 2") SCENES,
		  "another number of times than of values", -EBADMSG },
		{ ACCESSORS MESHES NODES ANIMATION("scale", "\"input\": 4, \"output\": 3") SCENES,
		  "accessor 3 has elements of another width", -EBADMSG },
		{ ACCESSORS MESHES NODES ANIMATION("scale", "\"input\": 9, \"output\": 3") SCENES,
		  "\"input\" is no accessor", -EBADMSG },
		{ ACCESSORS MESHES "\"nodes\": [{\"children\": [0]}]," SCENES, "is below two nodes",
		  -EBADMSG },
		{ ACCESSORS MESHES "\"nodes\": [{\"children\": [7]}]," SCENES,
		  "has a child that is none", -EBADMSG },
		{ ACCESSORS MESHES "\"nodes\": [{\"scale\": [1, 2]}]," SCENES,
		  "has a place that is none", -EBADMSG },
		{ "\"scenes\": []", "has no scene", -EINVAL },
		{ "\"bufferViews\": [{\"buffer\": 0, \"byteLength\": 189}], \"accessors\": ["
		  "{\"bufferView\": 0, \"componentType\": 5126, \"count\": 3, \"type\": \"VEC3\"}]," MESHES
			  NODES SCENES,
		  "accessor 0 reaches past the end of its buffer", -EBADMSG },
	};

	(void)state;
	for (size_t i = 0; i < ARRAY_COUNT(cases); i++) {
		const struct gltf_choice choice = { 0 };
		struct diagnostics diagnostics = { 0 }, warnings = { 0 };
		struct scenery s;
		const int rc = make(&s, cases[i].text, &choice, &diagnostics, &warnings);

		if (rc != cases[i].error || !strstr(diagnostics.first.text, cases[i].words) ||
		    strncmp(diagnostics.first.text, "a.gltf:", 7) != 0)
			fail_msg("case %zu: %d %s", i, rc, diagnostics.first.text);
	}
}

/* A GLB is refused however it is cut, and a buffer beside is asked for by its name. */
static void a_glb_is_read_whole_or_not_at_all(void **state)
{
	static const char json[] = "{\"asset\": {\"version\": \"2.0\"}, \"buffers\": "
				   "[{\"byteLength\": 4}], \"scenes\": [{}]}   ";
	const uint32_t json_bytes = (uint32_t)(sizeof(json) - 1) / 4 * 4;
	const struct gltf_options options = { 0 };
	uint8_t glb[256] = "glTF\2\0\0";
	const size_t size = 12 + 8 + json_bytes + 8 + 4;

	(void)state;
	glb[12] = (uint8_t)json_bytes;
	memcpy(glb + 16, "JSON", 4);
	memcpy(glb + 20, json, json_bytes);
	glb[20 + json_bytes] = 4;
	memcpy(glb + 24 + json_bytes, "BIN\0data", 8);
	for (size_t cut = 0; cut <= size; cut++) {
		struct diagnostics diagnostics = { 0 };
		uint8_t *exact = malloc(cut ? cut : 1); /* no slack for ASan */
		struct gltf gltf;
		int rc;

		memcpy(exact, glb, cut);
		rc = gltf_read(&gltf, (struct bytes){ exact, cut }, "a.glb", &options,
			       &diagnostics);
		/* Without its second chunk it lacks the buffer. */
		CHECK((rc == 0) == (cut == size));
		CHECK(rc == 0 || strncmp(diagnostics.first.text, "a.glb", 5) == 0);
		if (rc == 0)
			CHECK(gltf.buffers[0].size == 4 && gltf.buffers[0].data[0] == 'd');
		gltf_finish(&gltf);
		free(exact);
	}
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(an_animation_moves_its_node_when_that_is_touched),
		cmocka_unit_test(what_plays_always_loops_and_needs_no_touch),
		cmocka_unit_test(a_step_keeps_each_value_until_the_next_time),
		cmocka_unit_test(a_spline_is_followed_closely),
		cmocka_unit_test(a_smooth_metal_shines_and_a_named_material_is_wood),
		cmocka_unit_test(normals_of_the_file_are_kept),
		cmocka_unit_test(a_scene_is_chosen_by_its_name),
		cmocka_unit_test(weights_of_morph_targets_make_shapes),
		cmocka_unit_test(what_is_refused_names_place_and_cure),
		cmocka_unit_test(a_glb_is_read_whole_or_not_at_all),
	};

	return cmocka_run_group_tests(tests, NULL, NULL);
}
