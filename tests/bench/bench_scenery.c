/* What scenery costs: a frame with the eye moving a millimetre a frame over a warm scene, with each
 * layer as a multiple of without any, in turns; and decoding the object, which a worker does. Time
 * of the process, llvmpipe's threads and all: what other work on the machine changes little.
 *
 *   bench_scenery RELEASE VIEWS [FRAMES]
 *
 * Prints JSON: of each view the ratio of medians for the first and the last layer. */
#include <errno.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>

#include "app/settings/scene_settings.h"
#include "base/clock.h"
#include "format/scenery_code.h"
#include "render/scene/scene_parts.h"
#include "render/scene/scene_scenery.h"
#include "tests/bench/stage.h"

enum { VIEWS_MAX = 16, FRAMES_MAX = 1000, SETTLE_MS = 120000, DECODES = 21 };
enum mode { WITHOUT, FIRST, LAST, MODES };

static double cpu_ms(void)
{
	struct timespec now;

	clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &now);
	return (double)now.tv_sec * 1000 + (double)now.tv_nsec / 1e6;
}

static double draw(struct stage *stage, struct camera *camera, bool with)
{
	struct scene_frame frame;
	double began;

	camera->eye_m[0] += 0.001f;
	camera->target_m[0] += 0.001f;
	stage->scene->scenery.is_here = with;
	glFinish();
	began = cpu_ms();
	gl_target_bind(&stage->target);
	scene_draw(stage->scene, camera, NULL, &frame);
	glFinish();
	stage->scene->scenery.is_here = true;
	return cpu_ms() - began;
}

/* Chooses a layer and waits until nothing moves. */
static void choose(struct stage *stage, const struct camera *camera, uint32_t layer)
{
	struct scene_frame frame;

	scene_choose_layer(stage->scene, layer);
	for (int i = 0; i < 100; i++) {
		stage_frame(stage, camera, &frame);
		scene_step_scenery(stage->scene, 50);
	}
	stage_settle(stage, camera, SETTLE_MS, &frame);
	if (!frame.settled)
		fprintf(stderr, "layer %u: not settled\n", layer);
}

static void measure(struct stage *stage, struct camera camera, uint32_t frames, bool last)
{
	static double spent[MODES][FRAMES_MAX], beside[FRAMES_MAX];
	uint32_t layers;
	double median, ratio[MODES] = { 0 };
	struct scene_frame frame;

	stage_settle(stage, &camera, SETTLE_MS, &frame);
	if (!stage->scene->scenery.is_here)
		stage_die("the release has no scenery", -ENOENT);
	layers = stage->scene->scenery.content.layer_count;
	for (int mode = FIRST; mode < MODES; mode++) {
		choose(stage, &camera, mode == FIRST || layers == 0 ? 0 : layers - 1);
		for (uint32_t i = 0; i < frames + 5; i++) {
			const uint32_t at = i < 5 ? 0 : i - 5; /* the first warm what is used */

			spent[mode][at] = draw(stage, &camera, true);
			beside[at] = draw(stage, &camera, false);
		}
		median = stage_median(beside, frames);
		ratio[mode] = stage_median(spent[mode], frames) / median;
		printf(" {\"layer\": %d, \"times\": %.3f, \"without_cpu_ms\": %.2f}%s\n",
		       mode == FIRST ? 0 : (int)layers - 1, ratio[mode], median,
		       last && mode == LAST ? "" : ",");
	}
}

static void measure_decoding(const struct stage *stage)
{
	static double spent[DECODES];
	struct buffer bytes;

	buffer_init(&bytes, 1 << 26);
	stage_must(scenery_encode(&bytes, &stage->scene->scenery.content), "scenery");
	for (int i = 0; i < DECODES; i++) {
		struct scenery out;
		const double began = cpu_ms();

		stage_must(scenery_decode(&out, buffer_bytes(&bytes)), "scenery");
		spent[i] = cpu_ms() - began;
		scenery_finish(&out);
	}
	printf("], \"bytes\": %zu, \"triangles\": %u, \"decode_cpu_ms\": %.2f}\n", bytes.size,
	       scenery_triangles(&stage->scene->scenery.content), stage_median(spent, DECODES));
	buffer_finish(&bytes);
}

int main(int argc, char **argv)
{
	struct camera cameras[VIEWS_MAX];
	struct stage stage;
	uint32_t count, frames;

	if (argc < 3) {
		fprintf(stderr, "bench_scenery RELEASE VIEWS [FRAMES]\n");
		return 2;
	}
	frames = argc > 3 ? (uint32_t)strtoul(argv[3], NULL, 10) : 25;
	frames = frames < 1 ? 1 : frames < FRAMES_MAX ? frames : FRAMES_MAX;
	count = stage_read_views(cameras, VIEWS_MAX, argv[2], 1280, 720);
	stage_open(&stage, &(struct stage_options){
				   .release = argv[1],
				   .scene = scene_settings(&profile_default, SCENE_LUMIGRAPH),
				   .width_px = 1280,
				   .height_px = 720,
				   .wall_clock = true });
	printf("{\"views\": [\n");
	for (uint32_t view = 0; view < count; view++)
		measure(&stage, cameras[view], frames, view + 1 == count);
	measure_decoding(&stage);
	stage_close(&stage);
	return 0;
}
