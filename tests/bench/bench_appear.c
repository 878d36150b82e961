/* The frames in which scenery appears beside a picture that is complete: its programs and what its
 * mirrors show are made in them. Processor time as on two cores, and how many programs of scenery a
 * frame made.
 *
 *   bench_appear RELEASE VIEWS [ROUNDS]
 *
 * Prints JSON: of each round at the first view the longest frame, the median of all, their number,
 * and the most programs in one. Mesa must not keep programs (MESA_SHADER_CACHE_DISABLE=true). */
#include <errno.h>
#include <stdio.h>
#include <stdlib.h>

#include "app/settings/scene_settings.h"
#include "base/clock.h"
#include "render/scene/scene_around.h"
#include "render/scene/scene_parts.h"
#include "render/scene/scene_scenery.h"
#include "tests/bench/stage.h"

enum { ROUNDS_MAX = 100, FRAMES_MAX = 4000, SETTLE_MS = 120000 };

/* As if it had just arrived. */
static void forget(struct scene *scene)
{
	struct scene_scenery *own = &scene->scenery;

	scenery_programs_finish(&own->picture.programs);
	scenery_picture_surround(&own->picture, 0);
	scene_drop_around(scene);
	own->is_ready = false;
	pose_finish(&own->pose);
	stage_must(pose_init(&own->pose, &own->content), "pose");
}

static void measure(struct stage *stage, const struct camera *camera, bool last)
{
	static double spent[FRAMES_MAX];
	const struct scenery_programs *programs = &stage->scene->scenery.picture.programs;
	struct scene_frame frame = { 0 };
	uint32_t count = 0, most = 0;
	double longest = 0;

	forget(stage->scene);
	do {
		const uint32_t before = programs->count;

		stage_frame(stage, camera, &frame);
		spent[count] = (double)stage->spent_us / 1000;
		longest = spent[count] > longest ? spent[count] : longest;
		most = programs->count - before > most ? programs->count - before : most;
		count++;
	} while (count < FRAMES_MAX && !frame.settled);
	printf("{\"longest_ms\": %.1f, \"median_ms\": %.1f, \"frames\": %u, \"programs\": %u, "
	       "\"most_programs\": %u}%s\n",
	       longest, stage_median(spent, count), count, programs->count, most, last ? "" : ",");
}

int main(int argc, char **argv)
{
	struct camera camera;
	struct scene_frame frame;
	struct stage stage;
	uint32_t rounds;

	if (argc < 3) {
		fprintf(stderr, "bench_appear RELEASE VIEWS [ROUNDS]\n");
		return 2;
	}
	rounds = argc > 3 ? (uint32_t)strtoul(argv[3], NULL, 10) : 5;
	rounds = rounds < 1 ? 1 : rounds < ROUNDS_MAX ? rounds : ROUNDS_MAX;
	stage_read_views(&camera, 1, argv[2], 1280, 720);
	stage_open(&stage, &(struct stage_options){
				   .release = argv[1],
				   .scene = scene_settings(&profile_default, SCENE_LUMIGRAPH),
				   .width_px = 1280,
				   .height_px = 720,
				   .wall_clock = true });
	stage_settle(&stage, &camera, SETTLE_MS, &frame);
	if (!frame.settled || !stage.scene->scenery.is_here)
		stage_die("no settled picture with scenery", -ENOENT);
	printf("[\n");
	for (uint32_t i = 0; i < rounds; i++)
		measure(&stage, &camera, i + 1 == rounds);
	printf("]\n");
	stage_close(&stage);
	return 0;
}
