/* What frames cost in instructions, on any architecture that QEMU emulates
 * (tests/tools/count_instructions.c, a plugin that counts what this program does between marks).
 *
 *   bench_instructions RELEASE VIEWS
 *
 * For the first of the views (eye x y z, target x y z, vertical field of view in degrees) at 640 x
 * 360: all frames until it has settled, with everything that is decoded for it; then frames of an
 * eye that moves a millimetre a frame, at levels of the governor. Before and after each part it
 * writes to the descriptor -1, and prints the part's name and frames. */
#include <stdio.h>
#include <unistd.h>

#include "app/settings/scene_settings.h"
#include "base/compiler.h"
#include "render/scene/governor.h"
#include "tests/bench/stage.h"

enum { WIDTH = 640, HEIGHT = 360, FRAMES = 20, SETTLE_MS = 60000 };

static void mark(void)
{
	/* to no file: the plugin sees the call */
	const ssize_t none = write(-1, "", 1);
	(void)none;
}

static void move(struct stage *stage, struct camera *camera, struct governor *governor, float level)
{
	struct scene_frame frame;
	governor->level = level;
	const struct scene_effort effort = governor_effort(governor);
	mark();
	for (int i = 0; i < FRAMES; i++) {
		camera->eye_m[0] += 0.001f;
		camera->target_m[0] += 0.001f;
		scene_spend(stage->scene, &effort);
		stage_frame(stage, camera, &frame);
		glFinish();
	}
	mark();
	printf("level %.1f, %d\n", (double)level, FRAMES);
}

int main(int argc, char **argv)
{
	static const float levels[] = { 1, 0, -0.4f };
	struct camera camera;
	struct stage stage;
	struct governor governor;
	struct scene_frame frame;

	if (argc != 3) {
		fputs("usage: bench_instructions RELEASE VIEWS\n", stderr);
		return 2;
	}
	stage_read_views(&camera, 1, argv[2], WIDTH, HEIGHT);
	governor_init(&governor,
		      &(struct governor_bounds){ .scale_least = profile_default.scale_least });
	stage_open(&stage, &(struct stage_options){
				   .release = argv[1],
				   .scene = scene_settings(&profile_default, SCENE_LUMIGRAPH),
				   .width_px = WIDTH,
				   .height_px = HEIGHT });
	mark();
	const uint32_t frames = stage_settle(&stage, &camera, SETTLE_MS, &frame);
	glFinish();
	mark();
	printf("first view, %u\n", frames);
	if (!frame.settled)
		stage_die("not settled", 0);
	governor.whole = frame.triangles;
	for (size_t i = 0; i < ARRAY_COUNT(levels); i++)
		move(&stage, &camera, &governor, levels[i]);
	stage_close(&stage);
	return 0;
}
