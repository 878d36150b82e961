/* Cameras of a glTF scene as views: those that stand still, and the way of one that moves. */
#include "pipeline/scene/gltf_views.h"

#include <errno.h>
#include <math.h>
#include <stdio.h>
#include <string.h>

#include "tests/check.h"
#include "tests/pipeline/scene/little_gltf.h"

/* Times 0 1 4; 3 moves; times 0 2; 2 turns about y, by half a turn in all. */
static const float numbers[] = {
	0, 1, 4,                   /* accessor 0 */
	0, 0, 0, 6, 0, 0, 6, 3, 0, /* 1 */
	0, 2,                      /* 2 */
	0, 0, 0, 1, 0, 1, 0, 0,    /* 3 */
};

#define ACCESSOR(offset, count, type)                                                              \
	"{\"bufferView\": 0, \"byteOffset\": " #offset                                             \
	", \"componentType\": 5126, \"count\": " #count ", \"type\": \"" type "\"}"
#define LISTS                                                                                                     \
	"\"bufferViews\": [{\"buffer\": 0, \"byteLength\": 88}],\n"                                               \
	"\"accessors\": [" ACCESSOR(0, 3, "SCALAR") "," ACCESSOR(12, 3, "VEC3") "," ACCESSOR(                     \
		48, 2,                                                                                            \
		"SCALAR") "," ACCESSOR(56, 2,                                                                     \
				       "VEC4") "],\n"                                                             \
					       "\"cameras\": [{\"name\": \"lens\", \"type\": \"perspective\"},\n" \
					       "{\"type\": \"orthographic\"}],\n"                                 \
					       "\"scenes\": [{\"nodes\": [0, 2]}, {\"name\": \"flat\", \"nodes\": [3]}],\n"
/* An arm that may turn, 5 m above the ground, with a camera 2 m before it; one that stands, and
 * looks down; a flat one. */
#define NODES                                                                                      \
	"\"nodes\": [{\"name\": \"arm\", \"translation\": [0, 5, 0], \"children\": [1]},\n"        \
	"{\"name\": \"held\", \"camera\": 0, \"translation\": [0, 0, 2]},\n"                       \
	"{\"name\": \"still\", \"camera\": 0, \"translation\": [9, 9, 9],"                         \
	" \"rotation\": [-0.70710678, 0, 0, 0.70710678]},\n"                                       \
	"{\"name\": \"plan\", \"camera\": 1}]"
#define CHANNEL(sampler, node, path)                                                               \
	"{\"sampler\": " #sampler ", \"target\": {\"node\": " #node ", \"path\": \"" path "\"}}"
#define ANIMATIONS(channels)                                                                       \
	",\n\"animations\": [{\"name\": \"go\", \"channels\": [" channels "], \"samplers\": ["     \
	"{\"input\": 0, \"output\": 1}, {\"input\": 2, \"output\": 3},"                            \
	" {\"input\": 0, \"output\": 1, \"interpolation\": \"STEP\"}]}]"

static int read_views(struct scene_views *out, const char *lists, const char *scene,
		      const char *name, struct diagnostics *diagnostics)
{
	struct gltf gltf;
	int rc;

	CHECK(sizeof(numbers) == 88);
	rc = little_gltf_read(&gltf, numbers, sizeof(numbers), lists, diagnostics);
	CHECK(rc == 0);
	rc = gltf_views_read(out, &gltf, scene, name);
	gltf_finish(&gltf);
	return rc;
}

static bool is_at(const float place[3], float x, float y, float z)
{
	return fabsf(place[0] - x) < 1e-3f && fabsf(place[1] - y) < 1e-3f &&
	       fabsf(place[2] - z) < 1e-3f;
}

static void cameras_that_stand_still_come_in_order(void **state)
{
	struct diagnostics diagnostics = { 0 };
	struct scene_views views;

	(void)state;
	CHECK(read_views(&views, LISTS NODES, NULL, NULL, &diagnostics) == 0);
	CHECK(views.count == 2 && !views.moves);
	CHECK(is_at(views.items[0].eye, 0, 5, 2) && is_at(views.items[0].target, 0, 5, 1));
	CHECK(is_at(views.items[1].eye, 9, 9, 9) && is_at(views.items[1].target, 9, 8, 9));
	scene_views_finish(&views);
}

static void a_moving_camera_has_a_view_at_each_key(void **state)
{
	static const float expected[][4] = { { 0, 0, 5, 0 }, { 1, 6, 5, 0 }, { 4, 6, 8, 0 } };
	struct diagnostics diagnostics = { 0 };
	struct scene_views views;

	(void)state;
	CHECK(read_views(&views, LISTS NODES ANIMATIONS(CHANNEL(0, 1, "translation")), NULL, NULL,
			 &diagnostics) == 0);
	CHECK(views.count == 3 && views.moves);
	for (uint32_t i = 0; i < 3; i++)
		CHECK(views.items[i].time_s == expected[i][0] &&
		      is_at(views.items[i].eye, expected[i][1], expected[i][2], expected[i][3]));
	scene_views_finish(&views);
	/* The same in steps: it jumps at its second and third key. */
	CHECK(read_views(&views, LISTS NODES ANIMATIONS(CHANNEL(2, 1, "translation")), NULL, "held",
			 &diagnostics) == 0);
	CHECK(views.count == 5 && views.items[1].time_s == 1 && views.items[2].time_s == 1);
	CHECK(is_at(views.items[1].eye, 0, 5, 0) && is_at(views.items[2].eye, 6, 5, 0));
	scene_views_finish(&views);
}

/* The arm turns by half a turn in 2 s, and the camera goes on an arc around it. */
static void a_camera_goes_with_what_carries_it(void **state)
{
	struct diagnostics diagnostics = { 0 };
	struct scene_views views;

	(void)state;
	/* By the camera's own name, which the one that stands still has too. */
	CHECK(read_views(&views, LISTS NODES ANIMATIONS(CHANNEL(1, 0, "rotation")), NULL, "lens",
			 &diagnostics) == 0);
	CHECK(views.count == 9);
	for (uint32_t i = 0; i < views.count; i++) {
		const float angle = (float)M_PI * views.items[i].time_s / 2;

		CHECK(is_at(views.items[i].eye, 2 * sinf(angle), 5, 2 * cosf(angle)));
		CHECK(is_at(views.items[i].target, sinf(angle), 5, cosf(angle)));
	}
	scene_views_finish(&views);
}

static void what_is_no_view_is_named_with_its_cure(void **state)
{
	static const struct {
		const char *lists, *scene, *name, *words;
		int rc;
	} cases[] = {
		{ LISTS NODES, "flat", NULL, "node \"plan\" is orthographic", -ENOTSUP },
		{ LISTS NODES, "none", NULL, "has no scene \"none\"", -EINVAL },
		{ LISTS NODES, NULL, "held", "no moving camera of the name \"held\"", -EINVAL },
		{ LISTS NODES ANIMATIONS(
			  CHANNEL(0, 1, "translation") "," CHANNEL(0, 2, "translation")),
		  NULL, NULL, "a second camera that moves, of node \"still\"", -EINVAL },
		{ LISTS NODES ANIMATIONS(CHANNEL(1, 1, "translation")), NULL, NULL,
		  "another width than its use", -EBADMSG },
		{ "\"scenes\": [{\"nodes\": []}]", NULL, NULL, "has no camera", -EINVAL },
	};

	(void)state;
	for (size_t i = 0; i < sizeof(cases) / sizeof(*cases); i++) {
		struct diagnostics diagnostics = { 0 };
		struct scene_views views;
		int rc = read_views(&views, cases[i].lists, cases[i].scene, cases[i].name,
				    &diagnostics);

		scene_views_finish(&views);
		if (rc != cases[i].rc || !strstr(diagnostics.first.text, cases[i].words))
			fail_msg("case %zu: %d, %s", i, rc, diagnostics.first.text);
	}
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(cameras_that_stand_still_come_in_order),
		cmocka_unit_test(a_moving_camera_has_a_view_at_each_key),
		cmocka_unit_test(a_camera_goes_with_what_carries_it),
		cmocka_unit_test(what_is_no_view_is_named_with_its_cure),
	};

	return cmocka_run_group_tests(tests, NULL, NULL);
}
