/* A recorded visit on a clock of its own, over a link on the same clock: what the pictures are
 * worth while the eye moves, how long they take to be as good as they get once it stops, what a
 * frame costs while tiles arrive, and whether anything pops.
 *
 *   bench_motion RELEASE VISIT OUT [--truth FOLDER] [--size WxH] [--fps N] [--link MBIT]
 *                [--latency MS] [--price PX] [--level L] [--fault none|patch|tile|sample] [--mode
 * M]
 *
 * --level is of the governor while the eye moves (1, the default: full effort).
 *
 * Writes OUT/views.txt first: the frames that are judged, a line each, for `gopura-content render
 * --views`; without --truth and --fault that is all. Then OUT/view-NNNN.png of those and
 * OUT/motion.json.
 *
 * Every camera is drawn twice, before and after a frame's time passed for the scene: what differs
 * then is no motion. A block of 8 x 8 pixels whose mean changes by POP in that time pops; one in
 * which HOLE pixels were model and are sky is a hole. --fault breaks the scene once a second
 * (fades: all the time), to show that it is found. */
#include <errno.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>

#include "app/settings/scene_settings.h"
#include "base/clock.h"
#include "render/scene/governor.h"
#include "render/scene/scene_parts.h"
#include "tests/bench/stage.h"
#include "tests/bench/visit.h"

enum { FRAMES_MAX = 6000, BLOCK = 8, POP = 16, HOLE = 16 };

/* Of the model's blocks, how many may pop in one frame before it shows. */
static const double pop_share = 0.002;

enum harm { HARM_NONE, HARM_PATCH, HARM_TILE, HARM_SAMPLE };

/* What is known of a frame. */
struct moment {
	struct camera camera;
	bool rests;     /* the eye does */
	uint32_t judge; /* number of its truth, + 1; 0: none */
	double psnr, cpu_ms;
	uint32_t triangles, tiles_uploaded, depth_faces, popped, holes;
	uint64_t bytes;
};

struct bench {
	const char *presence, *out, *truth;
	struct stage_options options;
	struct stage stage;
	float level;
	bool tries_fault;
	enum harm harm;
	struct visit visit;
	uint32_t fps;
	struct moment moment[FRAMES_MAX];
	uint32_t moment_count, judged;
};

/* ---- the visit */

/* Judged: four frames a second of what moves, of a rest all with its last frame's truth. */
static void add_moment(struct bench *bench, uint32_t leg, uint32_t i, uint32_t count)
{
	struct moment *m = &bench->moment[bench->moment_count++];

	if (bench->moment_count == FRAMES_MAX)
		stage_die("the visit is too long", -E2BIG);
	m->camera = (struct camera){ .width_px = bench->options.width_px,
				     .height_px = bench->options.height_px };
	visit_camera(&m->camera, &bench->visit, leg, (float)(i + 1) / (float)count);
	m->rests = bench->visit.leg[leg].gait == VISIT_REST;
	if (m->rests ? i == 0 : i % (bench->fps / 4) == 0)
		bench->judged++;
	if (m->rests || i % (bench->fps / 4) == 0)
		m->judge = bench->judged;
}

static void write_views(const struct bench *bench)
{
	char path[512];
	uint32_t written = 0;
	FILE *file;

	mkdir(bench->out, 0777);
	snprintf(path, sizeof(path), "%s/views.txt", bench->out);
	file = fopen(path, "we");
	if (!file)
		stage_die(path, -errno);
	for (uint32_t i = 0; i < bench->moment_count; i++) {
		const float *e = bench->moment[i].camera.eye_m,
			    *t = bench->moment[i].camera.target_m;

		if (bench->moment[i].judge <= written)
			continue;
		written = bench->moment[i].judge;
		fprintf(file, "%.5f %.5f %.5f %.5f %.5f %.5f 45\n", (double)e[0], (double)e[1],
			(double)e[2], (double)t[0], (double)t[1], (double)t[2]);
	}
	if (fclose(file) != 0)
		stage_die(path, -errno);
}

static void plan_visit(struct bench *bench)
{
	visit_read(&bench->visit, bench->presence);
	for (uint32_t leg = 1; leg < bench->visit.leg_count; leg++) {
		const float seconds = bench->visit.leg[leg].seconds;
		const uint32_t count = (uint32_t)(seconds * (float)bench->fps + 0.5f);

		for (uint32_t i = 0; i < count; i++)
			add_moment(bench, leg, i, count);
	}
	write_views(bench);
}

/* ---- faults, by hand in the scene's own state */

struct broken {
	struct patch_bvh *bvh;
	uint32_t piece_count;
};

/* The patch that shows most. */
static void break_patch(struct scene *scene, struct broken *broken)
{
	uint32_t best = 0;

	for (uint32_t p = 0; p < scene->hierarchy.patch_count; p++)
		if (scene->seen_px[p] > scene->seen_px[best])
			best = p;
	broken->bvh = &scene->geometry.patches[best].content.bvh;
	broken->piece_count = broken->bvh->piece_count;
	broken->bvh->piece_count = 0;
}

/* As if each had been there for long. */
static void break_fades(struct scene *scene)
{
	for (uint32_t i = 0; i < scene->tiles.face_count; i++)
		memset(scene->tiles.faces[i].born_ms, 0, sizeof(scene->tiles.faces[i].born_ms));
	for (uint32_t i = 0; i < scene->visible_count; i++) {
		const struct visible_piece *v = &scene->visible[i];
		struct blend *blend = scene->geometry.patches[v->patch].pieces[v->piece].blend;

		for (int k = 0; k < PLAN_ENTRIES; k++)
			if (blend[k].held)
				blend[k].weight = blend[k].target;
	}
}

/* Pixels that each face slot colours. */
static void count_faces(const struct scene *scene, float pixels[TILES_FACES_MAX])
{
	memset(pixels, 0, TILES_FACES_MAX * sizeof(*pixels));
	for (uint32_t i = 0; i < scene->visible_count; i++) {
		const struct visible_piece *v = &scene->visible[i];
		const struct piece_state *state =
			&scene->geometry.patches[v->patch].pieces[v->piece];

		for (int k = 0; k < PLAN_ENTRIES; k++) {
			const struct blend *blend = &state->blend[k];
			const int slot =
				blend->held ? tiles_face_slot(&scene->tiles, blend->face) : -1;

			if (slot >= 0)
				pixels[slot] += blend->weight * state->seen_px;
		}
	}
}

static uint32_t take_most(float pixels[TILES_FACES_MAX])
{
	uint32_t most = 0;

	for (uint32_t i = 1; i < TILES_FACES_MAX; i++)
		if (pixels[i] > pixels[most])
			most = i;
	pixels[most] = -1;
	return most;
}

/* The two faces that colour most exchange their pictures. */
static void break_sample(struct scene *scene)
{
	float pixels[TILES_FACES_MAX];
	uint16_t slots[TILES_CELLS][TILES_CELLS];

	count_faces(scene, pixels);
	struct tiles_face *a = &scene->tiles.faces[take_most(pixels)];
	struct tiles_face *b = &scene->tiles.faces[take_most(pixels)];
	memcpy(slots, a->slot, sizeof(slots));
	memcpy(a->slot, b->slot, sizeof(slots));
	memcpy(b->slot, slots, sizeof(slots));
	a->dirty = b->dirty = true;
}

static void break_scene(struct bench *bench, uint32_t frame, struct broken *broken)
{
	struct scene *scene = bench->stage.scene;

	if (bench->harm == HARM_TILE)
		break_fades(scene);
	if (!scene->has_hierarchy || frame % bench->fps != bench->fps / 2)
		return;
	if (bench->harm == HARM_PATCH)
		break_patch(scene, broken);
	if (bench->harm == HARM_SAMPLE)
		break_sample(scene);
}

/* ---- frames */

static double luma(const uint8_t *p)
{
	return 0.299 * p[0] + 0.587 * p[1] + 0.114 * p[2];
}

/* What changed without any motion. */
static void compare(const struct bench *bench, struct moment *m, const uint8_t *before,
		    const uint8_t *after)
{
	const int width = bench->options.width_px, height = bench->options.height_px;

	m->holes = m->popped = 0;
	for (int y = 0; y + BLOCK <= height; y += BLOCK) {
		for (int x = 0; x + BLOCK <= width; x += BLOCK) {
			double sum = 0;
			int lost = 0;

			for (int k = 0; k < BLOCK * BLOCK; k++) {
				const size_t at = 4 * ((size_t)(y + k / BLOCK) * (size_t)width +
						       (size_t)(x + k % BLOCK));

				sum += fabs(luma(before + at) - luma(after + at));
				lost += before[at + 3] == 255 && after[at + 3] == 0;
			}
			m->holes += lost >= HOLE;
			m->popped += sum / (BLOCK * BLOCK) >= POP;
		}
	}
}

static void draw_moment(struct bench *bench, uint32_t i)
{
	struct stage *stage = &bench->stage;
	struct moment *m = &bench->moment[i];
	struct broken broken = { 0 };
	struct scene_frame frame;

	stage_frame(stage, &m->camera, &frame);
	m->cpu_ms = (double)stage->work_us / 1000;
	m->triangles = frame.triangles;
	m->tiles_uploaded = frame.tiles_uploaded;
	m->depth_faces = frame.depth_faces_drawn;
	m->bytes = stage->bytes;
	uint8_t *before = stage_read(stage);
	m->psnr = m->judge && bench->truth
			  ? stage_psnr(stage, before, stage_grey, bench->truth, m->judge - 1)
			  : NAN;
	if (m->judge && (i + 1 == bench->moment_count || bench->moment[i + 1].judge != m->judge))
		stage_keep(stage, before, bench->out, m->judge - 1);
	if (!m->rests) {
		struct camera still = m->camera;
		uint8_t *after;

		break_scene(bench, i, &broken);
		still.eye_m[0] += 1e-5f; /* so that it is not a rest */
		stage_frame(stage, &still, &frame);
		after = stage_read(stage);
		compare(bench, m, before, after);
		free(after);
		if (broken.bvh)
			broken.bvh->piece_count = broken.piece_count;
	}
	free(before);
}

/* ---- the report */

/* From the stop at moment `first` until within a decibel of the best that the rest reached, ms. */
static double settling_ms(const struct bench *bench, uint32_t first, uint32_t count)
{
	double best = 0;
	uint32_t i = 0;

	for (uint32_t k = 0; k < count; k++)
		best = fmax(best, bench->moment[first + k].psnr);
	while (bench->moment[first + i].psnr < best - 1)
		i++;
	return 1000.0 * i / bench->fps;
}

static void report(const struct bench *bench)
{
	static double cpu[FRAMES_MAX], stops[VISIT_LEGS_MAX], rests[VISIT_LEGS_MAX];
	uint32_t cpus = 0, stop_count = 0, moving = 0, popping = 0, holes = 0, popped_most = 0;
	double moving_sum = 0, moving_least = 99, accumulation_sum = 0, median;
	char path[512];
	FILE *file;

	for (uint32_t i = 0; i < bench->moment_count; i++) {
		const struct moment *m = &bench->moment[i];
		uint32_t count = 1;
		const double blocks = bench->options.width_px * bench->options.height_px /
				      (double)(BLOCK * BLOCK);

		if (!m->rests) {
			cpu[cpus++] = m->cpu_ms;
			popping += m->popped > pop_share * blocks;
			popped_most = m->popped > popped_most ? m->popped : popped_most;
			holes += m->holes;
			if (!isnan(m->psnr)) {
				moving++;
				moving_sum += m->psnr;
				moving_least = fmin(moving_least, m->psnr);
			}
			continue;
		}
		while (i + count < bench->moment_count &&
		       bench->moment[i + count].judge == m->judge)
			count++;
		rests[stop_count] = bench->moment[i + count - 1].psnr;
		accumulation_sum += rests[stop_count];
		/* The first rest begins with nothing at all: a start, not a stop. */
		stops[stop_count++] = settling_ms(bench, i, count);
		i += count - 1;
	}
	snprintf(path, sizeof(path), "%s/motion.json", bench->out);
	file = fopen(path, "we");
	if (!file)
		stage_die(path, -errno);
	fprintf(file, "{\"frames\": %u, \"fps\": %u, ", bench->moment_count, bench->fps);
	if (bench->truth) {
		fprintf(file,
			"\"moving_db\": %.2f, \"moving_least_db\": %.2f, \"rest_db\": %.2f, "
			"\"stops_ms\": [",
			moving_sum / moving, moving_least, accumulation_sum / stop_count);
		for (uint32_t i = 0; i < stop_count; i++)
			fprintf(file, "%s%.0f", i ? ", " : "", stops[i]);
		fprintf(file, "], \"stop_median_ms\": %.0f, ",
			stage_median(stops + 1, stop_count - 1));
	}
	median = stage_median(cpu, cpus);
	fprintf(file,
		"\"work_median_ms\": %.2f, \"work_p99_ms\": %.2f, \"work_p99_over_median\": %.2f, "
		"\"popping_frames\": %u, \"popped_blocks_most\": %u, \"holes\": %u, "
		"\"kb\": %.0f}\n",
		median, cpu[cpus * 99 / 100], cpu[cpus * 99 / 100] / median, popping, popped_most,
		holes, (double)bench->stage.bytes / 1000);
	fclose(file);
	snprintf(path, sizeof(path), "%s/frames.jsonl", bench->out);
	file = fopen(path, "we");
	for (uint32_t i = 0; file && i < bench->moment_count; i++) {
		const struct moment *m = &bench->moment[i];

		fprintf(file,
			"{\"rests\": %d, \"psnr\": %.2f, \"cpu_ms\": %.2f, \"triangles\": %u, "
			"\"uploads\": %u, \"depths\": %u, \"popped\": %u, \"holes\": %u, \"bytes\": "
			"%llu}\n",
			m->rests, isnan(m->psnr) ? -1 : m->psnr, m->cpu_ms, m->triangles,
			m->tiles_uploaded, m->depth_faces, m->popped, m->holes,
			(unsigned long long)m->bytes);
	}
	if (file)
		fclose(file);
}

static void read_option(struct bench *bench, const char *name, const char *value)
{
	if (!strcmp(name, "--truth"))
		bench->truth = value;
	else if (!strcmp(name, "--size"))
		sscanf(value, "%dx%d", &bench->options.width_px, &bench->options.height_px);
	else if (!strcmp(name, "--fps"))
		bench->fps = (uint32_t)strtoul(value, NULL, 10);
	else if (!strcmp(name, "--link"))
		bench->options.bits_a_second = (uint64_t)(strtod(value, NULL) * 1e6);
	else if (!strcmp(name, "--latency"))
		bench->options.latency_us = (uint32_t)(strtod(value, NULL) * 1000);
	else if (!strcmp(name, "--level"))
		bench->level = strtof(value, NULL);
	else if (!strcmp(name, "--price"))
		bench->options.scene.price_px_per_kb = strtof(value, NULL);
	else if (!strcmp(name, "--mode"))
		bench->options.scene.mode = !strcmp(value, "polygons")  ? SCENE_POLYGONS
					    : !strcmp(value, "corners") ? SCENE_CORNERS
									: SCENE_LUMIGRAPH;
	else if (!strcmp(name, "--fault")) {
		bench->tries_fault = true;
		bench->harm = !strcmp(value, "patch")    ? HARM_PATCH
			      : !strcmp(value, "tile")   ? HARM_TILE
			      : !strcmp(value, "sample") ? HARM_SAMPLE
							 : HARM_NONE;
	} else
		stage_die(name, -EINVAL);
}

static void spend(struct bench *bench)
{
	struct governor governor;
	struct scene_effort effort;

	governor_init(&governor,
		      &(struct governor_bounds){ .scale_least = profile_default.scale_least });
	governor.level = bench->level;
	effort = governor_effort(&governor);
	scene_spend(bench->stage.scene, &effort);
}

int main(int argc, char **argv)
{
	static struct bench bench;

	if (argc < 4)
		stage_die("RELEASE VISIT OUT are needed", -EINVAL);
	bench.options = (struct stage_options){ .release = argv[1],
						.width_px = 1280,
						.height_px = 720,
						.latency_us = 40000,
						.bits_a_second = 10000000,
						.scene = scene_settings(&profile_default,
									SCENE_LUMIGRAPH) };
	bench.presence = argv[2];
	bench.out = argv[3];
	bench.fps = 30;
	bench.level = 1;
	for (int i = 4; i + 1 < argc; i += 2)
		read_option(&bench, argv[i], argv[i + 1]);
	plan_visit(&bench);
	if (!bench.truth && !bench.tries_fault)
		return 0;
	/* A frame is drawn twice while the eye moves, so each takes half of its time. */
	bench.options.frame_us = 500000 / bench.fps;
	stage_open(&bench.stage, &bench.options);
	spend(&bench);
	for (uint32_t i = 0; i < bench.moment_count; i++) {
		struct scene_frame frame;

		draw_moment(&bench, i);
		if (bench.moment[i].rests) /* the other half */
			stage_frame(&bench.stage, &bench.moment[i].camera, &frame);
	}
	report(&bench);
	stage_close(&bench.stage);
	return 0;
}
