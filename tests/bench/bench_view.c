/* Draws views of a release as the kiosk does, from an empty scene, and says what each cost; against
 * true pictures, how good it is. The stage's clock makes it repeatable to the bit.
 *
 *   bench_view RELEASE VIEWS OUT [--mode lumigraph|corners|polygons] [--size WxH] [--truth FOLDER]
 *              [--error-px E] [--triangles N] [--texture-mb N] [--price PX] [--link MBIT]
 *              [--trace DB] [--shown FILE]
 *
 * VIEWS: a line a view, eye x y z, target x y z, vertical field of view in degrees. OUT gets
 * view-NNNN.png (alpha is coverage) and views.jsonl. FOLDER holds view-NNNN.png of the same views
 * (gopura-content render). --link: objects come at so many megabits a second, 40 ms away.
 * --trace: tells what the first view is worth at rest after every 100 KB, and when it had DB.
 * --shown: writes how much of each view every tile makes up (shown.h) into FILE-NNNN. */
#include <errno.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>

#include "app/settings/scene_settings.h"
#include "base/clock.h"
#include "tests/bench/shown.h"
#include "tests/bench/stage.h"

enum { SETTLE_MS = 240000, TRACE_BYTES = 100000 };

struct bench {
	const char *release, *views, *out, *truth, *shown;
	struct stage_options options;
	struct stage stage;
	struct camera camera[STAGE_VIEWS_MAX];
	uint32_t view_count;
	double trace_db;
	uint64_t bytes_to_db; /* of the first view; 0: not reached */
	double psnr[STAGE_VIEWS_MAX];
	uint32_t scored;
	FILE *lines;
};

static void read_option(struct bench *bench, const char *name, const char *value)
{
	struct scene_options *scene = &bench->options.scene;

	if (!strcmp(name, "--mode"))
		scene->mode = !strcmp(value, "polygons")  ? SCENE_POLYGONS
			      : !strcmp(value, "corners") ? SCENE_CORNERS
							  : SCENE_LUMIGRAPH;
	else if (!strcmp(name, "--shown"))
		bench->shown = value;
	else if (!strcmp(name, "--size"))
		sscanf(value, "%dx%d", &bench->options.width_px, &bench->options.height_px);
	else if (!strcmp(name, "--truth"))
		bench->truth = value;
	else if (!strcmp(name, "--error-px"))
		scene->patch_error_px = strtof(value, NULL);
	else if (!strcmp(name, "--triangles"))
		scene->triangle_budget = (uint32_t)strtoul(value, NULL, 10);
	else if (!strcmp(name, "--texture-mb"))
		scene->texture_budget_bytes = strtoull(value, NULL, 10) << 20;
	else if (!strcmp(name, "--price"))
		scene->price_px_per_kb = strtof(value, NULL);
	else if (!strcmp(name, "--link"))
		bench->options.bits_a_second = strtoull(value, NULL, 10) * 1000000;
	else if (!strcmp(name, "--trace"))
		bench->trace_db = strtod(value, NULL);
	else
		stage_die(name, -EINVAL);
}

static void parse(struct bench *bench, int argc, char **argv)
{
	bench->options = (struct stage_options){
		.width_px = 1280,
		.height_px = 720,
		.frame_us = 100000,
		.latency_us = 40000,
		.scene = scene_settings(&profile_default, SCENE_LUMIGRAPH),
	};
	if (argc < 4)
		stage_die("RELEASE VIEWS OUT are needed", -EINVAL);
	bench->options.release = argv[1];
	bench->views = argv[2];
	bench->out = argv[3];
	for (int i = 4; i + 1 < argc; i += 2)
		read_option(bench, argv[i], argv[i + 1]);
	if (bench->options.bits_a_second == 0)
		bench->options.latency_us = 0;
}

/* ---- views */

/* The first view, judged at rest after every TRACE_BYTES. */
static void trace(struct bench *bench)
{
	struct stage *stage = &bench->stage;
	struct scene_frame frame = { 0 };

	while (!frame.settled) {
		uint8_t *rgba;
		double psnr;

		uint64_t before;

		stage->bytes_most = stage->bytes + TRACE_BYTES;
		do {
			before = stage->bytes;
			stage_frame(stage, &bench->camera[0], &frame);
		} while (frame.moving || stage->flights > 0 || stage->bytes != before);
		rgba = stage_read(stage);
		psnr = stage_psnr(stage, rgba, stage_grey, bench->truth, 0);
		free(rgba);
		printf("%8.0f KB %6.2f dB %7u triangles\n", (double)stage->bytes / 1000, psnr,
		       frame.triangles);
		if (psnr >= bench->trace_db && bench->bytes_to_db == 0)
			bench->bytes_to_db = stage->bytes;
	}
	stage->bytes_most = UINT64_MAX;
}

/* FILE-NNNN: the tiles of a view. */
static void write_shown(const struct bench *bench, uint32_t view)
{
	char path[512];
	FILE *file;

	snprintf(path, sizeof(path), "%s-%04u", bench->shown, view);
	file = fopen(path, "we");
	if (!file)
		stage_die(path, -errno);
	stage_must(shown_write(bench->stage.scene, file), path);
	fclose(file);
}

static void draw_view(struct bench *bench, uint32_t view)
{
	struct stage *stage = &bench->stage;
	const uint64_t bytes = stage->bytes, objects = stage->objects;
	const int64_t began_ms = clock_now_ms();
	struct scene_frame frame;
	const uint32_t frames = stage_settle(stage, &bench->camera[view], SETTLE_MS, &frame);
	const int64_t settled_ms = clock_now_ms() - began_ms;
	uint8_t *rgba = stage_read(stage);
	const double psnr =
		bench->truth ? stage_psnr(stage, rgba, stage_grey, bench->truth, view) : NAN;

	stage_keep(stage, rgba, bench->out, view);
	free(rgba);
	if (bench->shown)
		write_shown(bench, view);
	if (!isnan(psnr))
		bench->psnr[bench->scored++] = psnr;
	fprintf(bench->lines,
		"{\"view\": %u, \"settled\": %s, \"psnr\": %.2f, \"bytes\": %llu, \"objects\": "
		"%llu, \"settled_ms\": %lld, \"frames\": %u, \"triangles\": %u, \"patches\": %u, "
		"\"image_share\": %.3f}\n",
		view, frame.settled ? "true" : "false", isnan(psnr) ? 0 : psnr,
		(unsigned long long)(stage->bytes - bytes),
		(unsigned long long)(stage->objects - objects), (long long)settled_ms, frames,
		frame.triangles, frame.patches, (double)frame.image_share);
	fflush(bench->lines);
}

static void conclude(struct bench *bench)
{
	double sum = 0;

	printf("%u views, %.0f KB/view", bench->view_count,
	       (double)bench->stage.bytes / 1000 / bench->view_count);
	for (uint32_t i = 0; i < bench->scored; i++)
		sum += bench->psnr[i];
	if (bench->scored > 0) {
		stage_median(bench->psnr, bench->scored); /* sorted now */
		printf(", PSNR mean %.2f dB, 5 %%: %.2f dB, worst %.2f dB", sum / bench->scored,
		       bench->psnr[bench->scored / 20], bench->psnr[0]);
	}
	if (bench->trace_db > 0)
		printf(", %.1f dB after %.0f KB", bench->trace_db,
		       (double)bench->bytes_to_db / 1000);
	printf("\n");
}

int main(int argc, char **argv)
{
	static struct bench bench;
	char path[512];

	parse(&bench, argc, argv);
	bench.view_count = stage_read_views(bench.camera, STAGE_VIEWS_MAX, bench.views,
					    bench.options.width_px, bench.options.height_px);
	stage_open(&bench.stage, &bench.options);
	mkdir(bench.out, 0777);
	snprintf(path, sizeof(path), "%s/views.jsonl", bench.out);
	bench.lines = fopen(path, "we");
	if (!bench.lines)
		stage_die(path, -errno);
	if (bench.trace_db > 0 && bench.truth)
		trace(&bench);
	for (uint32_t view = 0; view < bench.view_count; view++)
		draw_view(&bench, view);
	fclose(bench.lines);
	conclude(&bench);
	stage_close(&bench.stage);
	return 0;
}
