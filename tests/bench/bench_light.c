/* What the raking light and the section cost: a frame with the eye moving a millimetre a frame over
 * a warm scene, with them as a multiple of without. Time of the process, llvmpipe's threads and
 * all: what other work on the machine changes little.
 *
 *   bench_light RELEASE VIEWS [FRAMES]
 *
 * Prints JSON: medians over the views. "section_whole" has its plane beyond the model: the same
 * picture, by the programs that cut. */
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>

#include "app/settings/scene_settings.h"
#include "base/clock.h"
#include "render/scene/scene_parts.h"
#include "tests/bench/stage.h"

enum { VIEWS_MAX = 16, FRAMES_MAX = 1000, SETTLE_MS = 120000 };
enum mode { WITHOUT, LIGHT, SECTION_WHOLE, SECTION, BOTH, MODES };

static const char *const names[MODES] = { "without", "light", "section_whole", "section", "both" };

static double cpu_ms(void)
{
	struct timespec now;

	clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &now);
	return (double)now.tv_sec * 1000 + (double)now.tv_nsec / 1e6;
}

static struct scene_tools tools_of(const struct stage *stage, const struct camera *camera,
				   enum mode mode)
{
	const struct root_page *root = scene_root(stage->scene);
	struct scene_tools tools = { .rake = { .on = mode == LIGHT || mode == BOTH,
					       .at = { -0.6f, 0.5f } } };
	struct view view;

	view_from_camera(&view, camera);
	section_init(&tools.section, root->box_min_m, root->box_max_m);
	if (mode < SECTION_WHOLE)
		return tools;
	section_face(&tools.section, camera->eye_m, view.forward);
	/* Beyond what its fingers could: nothing is cut. */
	tools.section.push_m = mode == SECTION_WHOLE ? 10 * tools.section.reach_m : 0;
	return tools;
}

static void measure(struct stage *stage, struct camera camera, uint32_t frames,
		    double out[MODES][VIEWS_MAX], uint32_t view)
{
	static double spent[MODES][FRAMES_MAX];
	struct scene_frame frame;

	camera.width_px = stage->target.width_px;
	camera.height_px = stage->target.height_px;
	stage_settle(stage, &camera, SETTLE_MS, &frame); /* the model's box is known */
	/* All that any of them shows is there. */
	for (int mode = MODES - 1; mode >= 0; mode--) {
		const struct scene_tools tools = tools_of(stage, &camera, (enum mode)mode);

		scene_use(stage->scene, &tools);
		stage_settle(stage, &camera, SETTLE_MS, &frame);
		if (!frame.settled)
			fprintf(stderr, "view %u, %s: not settled\n", view, names[mode]);
	}
	for (int mode = 0; mode < MODES; mode++) {
		const struct scene_tools tools = tools_of(stage, &camera, (enum mode)mode);

		scene_use(stage->scene, &tools);
		for (uint32_t i = 0; i < frames + 5; i++) {
			double began;

			camera.eye_m[0] += 0.001f;
			camera.target_m[0] += 0.001f;
			glFinish();
			began = cpu_ms();
			gl_target_bind(&stage->target);
			scene_draw(stage->scene, &camera, NULL, &frame);
			glFinish();
			if (i >= 5) /* what was made for the first is there */
				spent[mode][i - 5] = cpu_ms() - began;
		}
	}
	for (int mode = 0; mode < MODES; mode++)
		out[mode][view] = stage_median(spent[mode], frames);
}

static void run(const struct stage_options *options, const char *views, uint32_t frames, bool last)
{
	static double ms[MODES][VIEWS_MAX];
	struct camera cameras[VIEWS_MAX];
	double ratio[VIEWS_MAX];
	struct stage stage;
	const uint32_t count =
		stage_read_views(cameras, VIEWS_MAX, views, options->width_px, options->height_px);

	stage_open(&stage, options);
	for (uint32_t view = 0; view < count; view++)
		measure(&stage, cameras[view], frames, ms, view);
	printf(" {\"size\": \"%dx%d\"", options->width_px, options->height_px);
	for (int mode = MODES - 1; mode >= 0; mode--) {
		for (uint32_t view = 0; view < count; view++)
			ratio[view] = ms[mode][view] / ms[WITHOUT][view];
		if (mode != WITHOUT)
			printf(", \"%s_times\": %.2f", names[mode], stage_median(ratio, count));
	}
	for (int mode = 0; mode < MODES; mode++)
		printf(", \"%s_cpu_ms\": %.2f", names[mode], stage_median(ms[mode], count));
	printf("}%s\n", last ? "" : ",");
	fflush(stdout);
	stage_close(&stage);
}

int main(int argc, char **argv)
{
	static const int sizes[][2] = { { 1280, 720 }, { 1920, 1080 } };

	if (argc < 3) {
		fprintf(stderr, "bench_light RELEASE VIEWS [FRAMES]\n");
		return 2;
	}
	const uint32_t frames = argc > 3 ? (uint32_t)strtoul(argv[3], NULL, 10) : 25;
	printf("{\"sizes\": [\n");
	for (int i = 0; i < 2; i++)
		run(&(struct stage_options){ .release = argv[1],
					     .scene = scene_settings(&profile_default,
								     SCENE_LUMIGRAPH),
					     .width_px = sizes[i][0],
					     .height_px = sizes[i][1],
					     .wall_clock = true },
		    argv[2], frames < FRAMES_MAX ? frames : FRAMES_MAX, i == 1);
	printf("]}\n");
	return 0;
}
