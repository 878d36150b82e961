/* A scene that draws a release made in memory (little_release.h) into a small target, frame by
 * frame, and keeps the last two pictures. */
#ifndef GOPURA_TESTS_RENDER_SCENE_LITTLE_STAGE_H
#define GOPURA_TESTS_RENDER_SCENE_LITTLE_STAGE_H

#include <string.h>

#include "render/display/gl.h"
#include "render/display/headless.h"
#include "tests/render/scene/little_release.h"

enum { WIDTH = 320, HEIGHT = 180, PIXELS = WIDTH * HEIGHT };

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

struct stage {
	struct headless *headless;
	struct gl_target target;
	struct scene *scene;
	struct scene_frame frame;
	uint8_t seen[4 * PIXELS], before[4 * PIXELS];
};

static inline void raise_stage(struct stage *stage, const struct little_release *release,
			       enum scene_mode mode)
{
	const struct scene_options options = {
		.mode = mode,
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

static inline void strike_stage(struct stage *stage)
{
	scene_destroy(stage->scene);
	gl_target_destroy(&stage->target);
	CHECK(gl_check("the test") == 0);
	headless_destroy(stage->headless);
}

static inline void draw_marked_stage(struct stage *stage, const struct camera *camera,
				     const struct scene_mark *mark)
{
	memcpy(stage->before, stage->seen, sizeof(stage->seen));
	gl_target_bind(&stage->target);
	CHECK(scene_dispatch(stage->scene) == 0);
	scene_draw(stage->scene, camera, mark, &stage->frame);
	CHECK(gl_target_read(&stage->target, stage->seen) == 0);
}

static inline void draw_stage(struct stage *stage, const struct camera *camera)
{
	draw_marked_stage(stage, camera, NULL);
}

#endif
