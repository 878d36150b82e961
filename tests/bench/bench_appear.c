/* The frames in which the first picture gets its images, and those in which scenery appears beside
 * a picture that is complete: programs are compiled in them, and what mirrors show is drawn.
 * Processor time as on two cores.
 *
 *   bench_appear RELEASE VIEWS [ROUNDS]
 *
 * Prints JSON: of the first picture and of each round with scenery, at the first view, the longest
 * frame, the median of all, their number, and how many programs of scenery there are, in all and at
 * most from one frame. Mesa must not keep programs (MESA_SHADER_CACHE_DISABLE=true). */
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

/* Draws until the picture is complete, and prints what its frames took. */
static bool measure(struct stage *stage, const struct camera *camera)
{
	static double spent[FRAMES_MAX];
	const struct scenery_programs *programs = &stage->scene->scenery.picture.programs;
	const int64_t until_ms = clock_now_ms() + SETTLE_MS;
	struct scene_frame frame = { 0 };
	uint32_t count = 0, most = 0;
	double longest = 0;

	do {
		const uint32_t before = programs->count;

		stage_frame(stage, camera, &frame);
		spent[count] = (double)stage->spent_us / 1000;
		longest = spent[count] > longest ? spent[count] : longest;
		most = programs->count - before > most ? programs->count - before : most;
		count++;
	} while (count < FRAMES_MAX && !frame.settled && clock_now_ms() < until_ms);
	printf("{\"longest_ms\": %.1f, \"median_ms\": %.1f, \"frames\": %u, \"programs\": %u, "
	       "\"most_programs\": %u}",
	       longest, stage_median(spent, count), count, programs->count, most);
	return frame.settled;
}

int main(int argc, char **argv)
{
	struct camera camera;
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
	printf("{\"first\": ");
	if (!measure(&stage, &camera) || !stage.scene->scenery.is_here)
		stage_die("no settled picture with scenery", -ENOENT);
	printf(",\n\"scenery\": [\n");
	for (uint32_t i = 0; i < rounds; i++) {
		forget(stage.scene);
		measure(&stage, &camera);
		puts(i + 1 == rounds ? "" : ",");
	}
	printf("]}\n");
	stage_close(&stage);
	return 0;
}
