/* The backdrop: at a vantage point its images are the picture until the mesh is here. */
#include <stdio.h>
#include <unistd.h>

#include "render/scene/scene_objects.h"
#include "tests/render/scene/little_stage.h"
#include "tests/render/scene/little_stream.h"

enum { FRAMES_MAX = 1500 };

static struct little_release *release;

/* Gives all that is wanted, patches only on request. Returns whether anything was given. */
static bool serve(struct stage *stage, bool patches)
{
	struct message_want wants[64];
	const size_t count = scene_wants(stage->scene, wants, 64);
	bool given = false;

	for (size_t i = 0; i < count; i++) {
		const struct object *object = scene_object(stage->scene, wants[i].hash);

		if (!object || (object->kind == OBJECT_GROUP && !patches))
			continue;
		scene_give(stage->scene, wants[i].hash,
			   little_object_bytes(release, wants[i].hash));
		given = true;
	}
	return given;
}

/* Draws until nothing moves and nothing but patches is wanted; with patches until all is settled.
 */
static void settle(struct stage *stage, bool patches)
{
	int still = 0;

	for (int i = 0; i < FRAMES_MAX; i++) {
		draw_stage(stage, &usual_camera);
		if (stage->frame.settled)
			return;
		still = serve(stage, patches) || stage->frame.moving ? 0 : still + 1;
		if (!patches && still > 20)
			return;
		usleep(3000);
	}
	fail_msg("not settled");
}

/* In dB over the whole picture, sky and all. */
static double psnr(const struct stage *stage)
{
	static uint8_t truth[3 * PIXELS];
	double sum = 0;

	little_truth(&usual_camera, truth);
	for (int i = 0; i < PIXELS; i++)
		for (int k = 0; k < 3; k++) {
			const double d = (double)stage->seen[4 * i + k] - truth[3 * i + k];

			sum += d * d;
		}
	return 10 * log10(255.0 * 255 * 3 * PIXELS / sum);
}

static void images_are_the_picture_before_any_patch(void **state)
{
	static struct stage stage;
	struct camera aside = usual_camera;
	double nothing, without_mesh;

	(void)state;
	raise_stage(&stage, release, SCENE_LUMIGRAPH);
	draw_stage(&stage, &usual_camera);
	nothing = psnr(&stage);
	settle(&stage, false);
	CHECK(!stage.frame.settled && stage.frame.patches == 0);
	CHECK(stage.scene->backdrop.share >= 1);
	without_mesh = psnr(&stage);
	printf("%.1f dB without a mesh, %.1f before\n", without_mesh, nothing);
	CHECK(without_mesh > 22 && nothing < 16);
	/* Half a metre away the images are wrong. */
	aside.eye_m[0] += 0.5f;
	for (int i = 0; i < 50; i++) {
		draw_stage(&stage, &aside);
		usleep(10000);
	}
	CHECK(stage.scene->backdrop.share <= 0);
	strike_stage(&stage);
}

static void it_goes_when_the_mesh_is_here(void **state)
{
	static struct stage stage;
	double without_mesh;

	(void)state;
	raise_stage(&stage, release, SCENE_LUMIGRAPH);
	settle(&stage, false);
	without_mesh = psnr(&stage);
	settle(&stage, true);
	CHECK(stage.frame.settled && stage.frame.patches > 0);
	CHECK(stage.scene->backdrop.share <= 0 && stage.scene->backdrop.look_count == 0);
	printf("%.1f dB with the mesh\n", psnr(&stage));
	CHECK(psnr(&stage) > without_mesh - 2);
	strike_stage(&stage);
}

/* A tool changes what is seen, which images cannot follow. Where frames take long, they fade for as
 * long as elsewhere, not for as many frames; but a pause in which nothing had to be drawn is no
 * part of it. */
static void for_a_tool_it_fades_by_time(void **state)
{
	static struct stage stage;
	struct scene_tools tools = { 0 };

	(void)state;
	raise_stage(&stage, release, SCENE_LUMIGRAPH);
	settle(&stage, false);
	tools.rake.on = true;
	scene_use(stage.scene, &tools);
	usleep(500000);
	draw_stage(&stage, &usual_camera);
	CHECK(stage.scene->backdrop.share > 0.5f && stage.scene->backdrop.share < 1);
	usleep(250000);
	draw_stage(&stage, &usual_camera);
	CHECK(stage.scene->backdrop.share <= 0);
	strike_stage(&stage);
}

/* Gives what is wanted but for tiles and, if it is held back, the page of the last face. Returns
 * the finest level of the tiles that are wanted, -1: none. */
static int finest_wanted(struct stage *stage, bool held_back)
{
	struct message_want wants[64];
	const size_t count = scene_wants(stage->scene, wants, 64);
	int finest = -1;
	bool held = !held_back;

	for (size_t i = count; i-- > 0;) {
		const struct object *object = scene_object(stage->scene, wants[i].hash);

		if (!object || object->kind == OBJECT_GROUP)
			continue;
		if (object->kind == OBJECT_TILE) {
			const int level = tile_name_unpack(object->id).level;

			finest = level > finest ? level : finest;
		} else if (object->kind == OBJECT_FACE && !held) {
			held = true;
		} else {
			scene_give(stage->scene, wants[i].hash,
				   little_object_bytes(release, wants[i].hash));
		}
	}
	return finest;
}

/* Fine ones of a face that is known first would fill the line before what is missing everywhere. */
static void coarse_images_of_all_faces_come_first(void **state)
{
	static struct stage stage;
	int finest[2] = { -1, -1 };

	(void)state;
	raise_stage(&stage, release, SCENE_LUMIGRAPH);
	for (int k = 0; k < 2; k++) {
		for (int i = 0; i < 40; i++) {
			draw_stage(&stage, &usual_camera);
			finest[k] = finest_wanted(&stage, k == 0);
			usleep(3000);
		}
	}
	assert_int_equal(finest[0], 0);
	CHECK(finest[1] > 0);
	strike_stage(&stage);
}

static int make_release(void **state)
{
	(void)state;
	release = little_release_from(4, usual_camera.eye_m);
	return 0;
}

static int free_release(void **state)
{
	(void)state;
	little_release_free(release);
	return 0;
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(images_are_the_picture_before_any_patch),
		cmocka_unit_test(it_goes_when_the_mesh_is_here),
		cmocka_unit_test(for_a_tool_it_fades_by_time),
		cmocka_unit_test(coarse_images_of_all_faces_come_first),
	};

	return cmocka_run_group_tests(tests, make_release, free_release);
}
