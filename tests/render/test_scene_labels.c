/* Labels in the scene: fetched after what is to be seen, they say what was touched. */
#include <errno.h>
#include <stdio.h>

#include "render/gl.h"
#include "render/headless.h"
#include "render/scene_parts.h"
#include "tests/render/little_labels.h"

enum { WIDTH = 480, HEIGHT = 270, FRAMES_MOST = 3000 };

static const struct scene_options usual = {
	.mode = SCENE_POLYGONS,
	.texture_budget_bytes = 96 << 20,
	.geometry_budget_bytes = 64 << 20,
	.triangle_budget = 200000,
	.patch_error_px = 1,
	.upload_budget_us = 20000,
	.worker_count = 2,
};

static const struct camera usual_camera = {
	.eye_m = { 10, -12, 5 },
	.target_m = { 0, 0, 1.5f },
	.up = { 0, 0, 1 },
	.fov_deg = 45,
	.near_m = 0.1f,
	.far_m = 200,
	.width_px = WIDTH,
	.height_px = HEIGHT,
};

/* Over the nearest pillar's edge and the floor beside it. */
static const struct region ball = { .kind = REGION_SPHERE,
				    .centre_m = { 4, -5, 1 },
				    .radius_m = 2 };

struct stage {
	struct headless *headless;
	struct gl_target target;
	struct little_release *release;
	struct scene *scene;
	struct scene_frame frame;
};

static void raise_stage(struct stage *stage, bool labels, bool spoiled)
{
	*stage = (struct stage){ 0 };
	stage->release = little_release_make(2);
	if (labels)
		little_label(stage->release, "ball", &ball, spoiled);
	CHECK(headless_create(&stage->headless) == 0);
	CHECK(gl_target_create(&stage->target, WIDTH, HEIGHT) == 0);
	CHECK(scene_create(&stage->scene, &usual) == 0);
	CHECK(scene_open(stage->scene, stage->release->root, stage->release->root_bytes) == 0);
}

static void strike_stage(struct stage *stage)
{
	scene_destroy(stage->scene);
	gl_target_destroy(&stage->target);
	CHECK(gl_check("the test") == 0);
	headless_destroy(stage->headless);
	little_release_free(stage->release);
}

static void draw(struct stage *stage)
{
	gl_target_bind(&stage->target);
	CHECK(scene_dispatch(stage->scene) == 0);
	scene_draw(stage->scene, &usual_camera, NULL, &stage->frame);
}

static void settle(struct stage *stage)
{
	for (int i = 0; i < FRAMES_MOST; i++) {
		draw(stage);
		little_release_serve(stage->release, stage->scene, 1);
		if (stage->frame.settled)
			return;
	}
	fail_msg("not settled after %d frames", FRAMES_MOST);
}

static void a_touch_is_answered_as_the_region_would(void **state)
{
	struct stage stage;
	uint32_t within = 0, without = 0;

	(void)state;
	raise_stage(&stage, true, false);
	settle(&stage);
	for (int y = 0; y < HEIGHT; y += 3)
		for (int x = 0; x < WIDTH; x += 3) {
			float px = (float)x + 0.5f, py = (float)y + 0.5f, at[3], away;
			const char *part = scene_part(stage.scene, &usual_camera, px, py);

			if (!scene_pick(stage.scene, &usual_camera, px, py, at)) {
				CHECK(part == NULL);
				continue;
			}
			CHECK(part != NULL);
			away = region_distance(&ball, at);
			if (fabsf(away) < 0.03f)
				continue;
			if ((strcmp(part, "ball") == 0) != (away < 0) ||
			    (away > 0 && strcmp(part, "") != 0))
				fail_msg("%d %d: \"%s\", %g m from the outline", x, y, part,
					 (double)away);
			within += away < 0;
			without += away > 0;
		}
	CHECK(within > 50 && without > 1000);
	strike_stage(&stage);
}

static void labels_come_after_what_is_to_be_seen(void **state)
{
	struct stage stage;
	struct message_want wants[32];

	(void)state;
	raise_stage(&stage, true, false);
	for (int i = 0; i < FRAMES_MOST; i++) {
		size_t count;

		draw(&stage);
		count = scene_wants(stage.scene, wants, 32);
		/* Nothing is answered by what is wanted last. */
		if (count > 0 && wants[0].priority == 1)
			break;
		CHECK(scene_part(stage.scene, &usual_camera, WIDTH / 2, HEIGHT / 2) == NULL);
		little_release_serve(stage.release, stage.scene, 1);
		CHECK(!stage.frame.settled);
	}
	CHECK(stage.scene->geometry.loaded[0]);
	settle(&stage);
	CHECK(scene_part(stage.scene, &usual_camera, WIDTH / 2, HEIGHT / 2) != NULL);
	strike_stage(&stage);
}

static void a_release_without_labels_leaves_it_to_regions(void **state)
{
	struct stage stage;

	(void)state;
	raise_stage(&stage, false, false);
	settle(&stage);
	CHECK(scene_part(stage.scene, &usual_camera, WIDTH / 2, HEIGHT / 2) == NULL);
	strike_stage(&stage);
}

static void labels_that_do_not_decode_are_not_wanted_again(void **state)
{
	struct stage stage;

	(void)state;
	raise_stage(&stage, true, true);
	settle(&stage);
	CHECK(scene_refused(stage.scene) > 0);
	CHECK(scene_part(stage.scene, &usual_camera, WIDTH / 2, HEIGHT / 2) == NULL);
	strike_stage(&stage);
}

static void labels_go_with_their_geometry(void **state)
{
	struct stage stage;
	struct scene_memory before, after;
	uint64_t labels = 0;

	(void)state;
	raise_stage(&stage, true, false);
	settle(&stage);
	scene_memory(stage.scene, &before);
	for (uint32_t g = 0; g < stage.scene->hierarchy.group_count; g++)
		labels += label_group_bytes(&stage.scene->geometry.labels[g]);
	CHECK(labels > 0 && before.geometry_bytes > labels);
	CHECK(scene_open(stage.scene, stage.release->root, stage.release->root_bytes) == 0);
	scene_memory(stage.scene, &after);
	CHECK(after.geometry_bytes == 0);
	settle(&stage);
	scene_memory(stage.scene, &after);
	CHECK(after.geometry_bytes == before.geometry_bytes);
	strike_stage(&stage);
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(a_touch_is_answered_as_the_region_would),
		cmocka_unit_test(labels_come_after_what_is_to_be_seen),
		cmocka_unit_test(a_release_without_labels_leaves_it_to_regions),
		cmocka_unit_test(labels_that_do_not_decode_are_not_wanted_again),
		cmocka_unit_test(labels_go_with_their_geometry),
	};

	return cmocka_run_group_tests(tests, NULL, NULL);
}
