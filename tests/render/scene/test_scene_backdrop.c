/* The backdrop: at a vantage point its images are the picture until the mesh is here. */
#include <stdio.h>
#include <unistd.h>

#include "render/display/gl.h"
#include "render/display/headless.h"
#include "render/scene/scene_objects.h"
#include "tests/render/scene/little_stream.h"

enum { WIDTH = 320, HEIGHT = 180, PIXELS = WIDTH * HEIGHT, FRAMES_MAX = 1500 };

static const struct camera vantage_camera = {
	.eye_m = { 10, -12, 5 },
	.target_m = { 0, 0, 1.5f },
	.up = { 0, 0, 1 },
	.fov_deg = 45,
	.near_m = 0.1f,
	.far_m = 200,
	.width_px = WIDTH,
	.height_px = HEIGHT,
};

static struct little_release *release;

struct stage {
	struct headless *headless;
	struct gl_target target;
	struct scene *scene;
	struct scene_frame frame;
	uint8_t seen[4 * PIXELS];
};

static void raise_stage(struct stage *stage)
{
	const struct scene_options options = {
		.mode = SCENE_LUMIGRAPH,
		.texture_budget_bytes = 96 << 20,
		.geometry_budget_bytes = 64 << 20,
		.triangle_budget = 200000,
		.patch_error_px = 1,
		.upload_budget_us = 20000,
	};

	CHECK(headless_create(&stage->headless) == 0);
	CHECK(gl_target_create(&stage->target, WIDTH, HEIGHT) == 0);
	CHECK(scene_create(&stage->scene, &options) == 0);
	CHECK(scene_open(stage->scene, release->root, release->root_bytes) == 0);
}

static void strike_stage(struct stage *stage)
{
	scene_destroy(stage->scene);
	gl_target_destroy(&stage->target);
	CHECK(gl_check("the test") == 0);
	headless_destroy(stage->headless);
}

static void draw(struct stage *stage, const struct camera *camera)
{
	gl_target_bind(&stage->target);
	CHECK(scene_dispatch(stage->scene) == 0);
	scene_draw(stage->scene, camera, NULL, &stage->frame);
	CHECK(gl_target_read(&stage->target, stage->seen) == 0);
}

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
		draw(stage, &vantage_camera);
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

	little_truth(&vantage_camera, truth);
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
	struct camera aside = vantage_camera;
	double nothing, without_mesh;

	(void)state;
	raise_stage(&stage);
	draw(&stage, &vantage_camera);
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
		draw(&stage, &aside);
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
	raise_stage(&stage);
	settle(&stage, false);
	without_mesh = psnr(&stage);
	settle(&stage, true);
	CHECK(stage.frame.settled && stage.frame.patches > 0);
	CHECK(stage.scene->backdrop.share <= 0 && stage.scene->backdrop.look_count == 0);
	printf("%.1f dB with the mesh\n", psnr(&stage));
	CHECK(psnr(&stage) > without_mesh - 2);
	strike_stage(&stage);
}

/* A tool changes what is seen, which images cannot follow. */
static void tools_need_the_mesh(void **state)
{
	static struct stage stage;
	struct scene_tools tools = { 0 };

	(void)state;
	raise_stage(&stage);
	settle(&stage, false);
	tools.rake.on = true;
	scene_use(stage.scene, &tools);
	for (int i = 0; i < 50; i++) {
		draw(&stage, &vantage_camera);
		usleep(10000);
	}
	CHECK(stage.scene->backdrop.share <= 0);
	strike_stage(&stage);
}

static int make_release(void **state)
{
	(void)state;
	release = little_release_from(4, vantage_camera.eye_m);
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
		cmocka_unit_test(tools_need_the_mesh),
	};

	return cmocka_run_group_tests(tests, make_release, free_release);
}
