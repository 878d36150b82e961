/* A visit at its own speed with the governor in control: what each frame takes, which level it is
 * drawn at, and what the picture on the panel at that moment is worth.
 *
 *   bench_visit RELEASE VISIT OUT [--truth FOLDER] [--size WxH] [--link MBIT] [--latency MS]
 *               [--price PX] [--load none|core|heat] [--level L] [--times N]
 *               [--effort SCALE,TRIANGLES,FACES,BUDGET[,SHARE]] [--layer N] [--keep yes]
 *
 * A frame takes the time that its work takes on two cores (stage.h, work_clock), so other work on
 * the machine hardly changes what is measured, and neither does the comparison with the truth. The
 * time on the machine's clock is recorded beside it. A frame that misses a refresh of a panel of 60
 * Hz is shown at the next one, and the eye is where the visit has it then.
 *
 * --load core: from 2 to 12 s one of the two cores is taken away. heat: from 2 s on the clock falls
 * to two thirds within 5 s, and is back at 15 s. --level holds the governor there, --effort
 * that effort. --layer shows that layer of scenery. --times plays the legs after the first rest so
 * many times, each way from its begin.
 *
 * Writes OUT/views.txt first: the moments that are judged, four of a second of motion and each
 * rest, for `gopura-content render --views`; without --truth that is all. Then OUT/visit.json and
 * OUT/frames.jsonl; with --keep, pictures of the judged moments. --truth none: times alone. */
#include <errno.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>

#include "app/settings/heap.h"
#include "app/settings/scene_settings.h"
#include "render/scene/governor.h"
#include "tests/bench/stage.h"
#include "tests/bench/visit.h"

enum {
	REFRESH_US = 16667,
	JUDGE_US = 250000, /* between two judged moments of motion */
	FRAMES_MAX = 20000,
	SECONDS_MAX = 600,
};

enum load { LOAD_NONE, LOAD_CORE, LOAD_HEAT };

struct shot {
	int64_t at_us; /* since the visit began */
	uint32_t leg;
	bool rests;
	double spent_ms, wall_ms, thread_ms, psnr; /* NAN: not judged */
	float level;
	struct scene_effort effort;
	uint32_t divisor, triangles, uploads, depths;
};

struct bench {
	const char *truth, *out;
	struct stage_options options;
	struct stage stage;
	struct visit visit;
	struct governor governor;
	struct scene_effort effort; /* if is_held and its scale is not 0 */
	enum load load;
	bool keeps, is_held;
	uint32_t times, layer;
	struct shot shot[FRAMES_MAX];
	uint32_t shot_count;
};

/* ---- the moments that are judged */

static int64_t leg_us(const struct bench *bench, uint32_t leg)
{
	return (int64_t)((double)bench->visit.leg[leg].seconds * 1e6);
}

static bool leg_rests(const struct bench *bench, uint32_t leg)
{
	return bench->visit.leg[leg].gait == VISIT_REST;
}

static struct camera camera_at(const struct bench *bench, uint32_t leg, int64_t in_us)
{
	struct camera camera = { .width_px = bench->options.width_px,
				 .height_px = bench->options.height_px };

	visit_camera(&camera, &bench->visit, leg,
		     fminf((float)in_us / (float)leg_us(bench, leg), 1));
	return camera;
}

/* Since the leg's begin. */
static int64_t moment_us(uint32_t i)
{
	return i * (int64_t)JUDGE_US + JUDGE_US / 2;
}

/* The judged moments of a leg: its rest, or every JUDGE_US. */
static uint32_t moments_of(const struct bench *bench, uint32_t leg)
{
	return leg_rests(bench, leg) ? 1 : (uint32_t)(leg_us(bench, leg) / JUDGE_US);
}

/* Numbers of the truths of a leg begin here. */
static uint32_t first_moment(const struct bench *bench, uint32_t leg)
{
	uint32_t first = 0;

	for (uint32_t l = 1; l < leg; l++)
		first += moments_of(bench, l);
	return first;
}

static void write_views(const struct bench *bench)
{
	char path[512];
	FILE *file;

	mkdir(bench->out, 0777);
	snprintf(path, sizeof(path), "%s/views.txt", bench->out);
	file = fopen(path, "we");
	if (!file)
		stage_die(path, -errno);
	for (uint32_t leg = 1; leg < bench->visit.leg_count; leg++) {
		for (uint32_t i = 0; i < moments_of(bench, leg); i++) {
			const struct camera c = camera_at(bench, leg,
							  leg_rests(bench, leg) ? leg_us(bench, leg)
										: moment_us(i));

			fprintf(file, "%.5f %.5f %.5f %.5f %.5f %.5f 45\n", (double)c.eye_m[0],
				(double)c.eye_m[1], (double)c.eye_m[2], (double)c.target_m[0],
				(double)c.target_m[1], (double)c.target_m[2]);
		}
	}
	if (fclose(file) != 0)
		stage_die(path, -errno);
}

/* ---- loads */

static float ramp(double from, double to, double at)
{
	return (float)fmin(fmax((at - from) / (to - from), 0), 1);
}

static void set_load(struct bench *bench, int64_t at_us)
{
	const double at = (double)at_us / 1e6;

	if (bench->load == LOAD_CORE)
		bench->stage.cores = at >= 2 && at < 12 ? 1 : 2;
	if (bench->load == LOAD_HEAT)
		bench->stage.slowness = 1 + 0.5f * (ramp(2, 7, at) - ramp(10, 15, at));
}

/* ---- frames */

static void judge(struct bench *bench, struct shot *shot, uint32_t moment, bool keeps)
{
	uint8_t *picture;

	if (!strcmp(bench->truth, "none"))
		return;
	picture = stage_read(&bench->stage);
	shot->psnr = stage_psnr(&bench->stage, picture, stage_grey, bench->truth, moment);
	if (bench->keeps && keeps)
		stage_keep(&bench->stage, picture, bench->out, moment);
	free(picture);
}

/* Draws a frame; the next one begins at a refresh. */
static struct shot *shoot(struct bench *bench, uint32_t leg, int64_t began_us,
			  const struct camera *camera)
{
	struct stage *stage = &bench->stage;
	struct shot *shot = &bench->shot[bench->shot_count++];
	const struct scene_effort effort =
		bench->effort.scale > 0 ? bench->effort : governor_effort(&bench->governor);
	struct scene_frame frame;
	int64_t target_us = governor_target_us(&bench->governor);

	if (bench->shot_count == FRAMES_MAX)
		stage_die("the visit is too long", -E2BIG);
	*shot = (struct shot){ .at_us = stage_now_us() - began_us,
			       .leg = leg,
			       .rests = leg_rests(bench, leg),
			       .psnr = NAN,
			       .level = bench->governor.level,
			       .effort = effort,
			       .divisor = bench->governor.divisor };
	set_load(bench, shot->at_us);
	scene_spend(stage->scene, &effort);
	if (shot->rests)
		target_us = REFRESH_US;
	stage->options.frame_us = (uint32_t)target_us;
	scene_choose_layer(stage->scene, bench->layer); /* scenery may come at any time */
	stage_frame(stage, camera, &frame);
	shot->spent_ms = (double)stage->spent_us / 1000;
	shot->wall_ms = (double)stage->wall_us / 1000;
	shot->thread_ms = (double)stage->work_us / 1000;
	shot->triangles = frame.triangles;
	shot->uploads = frame.tiles_uploaded;
	shot->depths = frame.depth_faces_drawn;
	if (frame.moved && !bench->is_held)
		governor_note(&bench->governor, stage->spent_us, frame.triangles);
	else if (frame.moving && !bench->is_held)
		governor_expect(&bench->governor, stage->spent_us, frame.triangles);
	if (bench->is_held && frame.triangles > bench->governor.whole)
		bench->governor.whole = frame.triangles;
	return shot;
}

/* Waits for the refresh at which what was drawn is shown. */
static int64_t next_refresh_us(int64_t began_us)
{
	const int64_t passed_us = stage_now_us() - began_us;

	return (passed_us + REFRESH_US - 100) / REFRESH_US * REFRESH_US;
}

static void play_rest(struct bench *bench, uint32_t leg, int64_t began_us, int64_t from_us)
{
	const struct camera camera = camera_at(bench, leg, leg_us(bench, leg));
	const int64_t until_us = from_us + leg_us(bench, leg);
	struct shot *shot = NULL;
	uint32_t moment = first_moment(bench, leg);

	for (int64_t now_us = from_us; now_us < until_us; now_us = next_refresh_us(began_us)) {
		shot = shoot(bench, leg, began_us, &camera);
		judge(bench, shot, moment, false);
	}
	if (shot && bench->keeps)
		judge(bench, shot, moment, true);
}

/* A frame shows the eye where it is at the refresh after it began, so the first one moves. A judged
 * moment is shown by the first frame after it, exactly as it was then. */
static void play_motion(struct bench *bench, uint32_t leg, int64_t began_us, int64_t from_us)
{
	const int64_t until_us = from_us + leg_us(bench, leg);
	const uint32_t first = first_moment(bench, leg);
	uint32_t judged = 0;

	for (int64_t now_us = from_us; now_us < until_us; now_us = next_refresh_us(began_us)) {
		const bool is_judged =
			judged < moments_of(bench, leg) && now_us - from_us >= moment_us(judged);
		const struct camera camera = camera_at(
			bench, leg, is_judged ? moment_us(judged) : now_us - from_us + REFRESH_US);
		struct shot *shot = shoot(bench, leg, began_us, &camera);

		if (is_judged)
			judge(bench, shot, first + judged++, true);
	}
}

static void play(struct bench *bench)
{
	const int64_t began_us = stage_now_us();
	int64_t from_us = 0;

	for (uint32_t time = 0; time < bench->times; time++) {
		for (uint32_t leg = time ? 2 : 1; leg < bench->visit.leg_count; leg++) {
			if (leg_rests(bench, leg))
				play_rest(bench, leg, began_us, from_us);
			else
				play_motion(bench, leg, began_us, from_us);
			from_us += leg_us(bench, leg);
		}
	}
}

/* ---- the report */

static int by_value(const void *a, const void *b)
{
	const double left = *(const double *)a, right = *(const double *)b;

	return (left > right) - (left < right);
}

static void report_times(const struct bench *bench, FILE *file)
{
	static double ms[FRAMES_MAX];
	uint32_t count = 0, late = 0, scales = 0;
	const struct shot *last = NULL;

	for (uint32_t i = 0; i < bench->shot_count; i++) {
		const struct shot *shot = &bench->shot[i];

		if (shot->rests)
			continue;
		late += shot->spent_ms > 1.02 * shot->divisor * REFRESH_US / 1000;
		scales += last && shot->effort.scale != last->effort.scale;
		ms[count++] = shot->spent_ms;
		last = shot;
	}
	qsort(ms, count, sizeof(*ms), by_value);
	fprintf(file,
		"\"moving_frames\": %u, \"frame_median_ms\": %.2f, \"frame_p99_ms\": %.2f, "
		"\"frame_p99_over_median\": %.2f, \"late_share\": %.3f, \"scale_changes\": %u, ",
		count, ms[count / 2], ms[count * 99 / 100], ms[count * 99 / 100] / ms[count / 2],
		(double)late / count, scales);
}

/* One row for each leg that moves. */
static void report_legs(const struct bench *bench, FILE *file)
{
	fprintf(file, "\"legs\": [");
	for (uint32_t leg = 1, rows = 0; leg < bench->visit.leg_count; leg++) {
		static double ms[FRAMES_MAX];
		double level = 0, db = 0;
		uint32_t count = 0, judged = 0;

		for (uint32_t i = 0; i < bench->shot_count; i++) {
			const struct shot *shot = &bench->shot[i];

			if (shot->leg != leg || shot->rests)
				continue;
			ms[count++] = shot->spent_ms;
			level += (double)shot->level;
			judged += !isnan(shot->psnr);
			db += isnan(shot->psnr) ? 0 : shot->psnr;
		}
		if (count == 0)
			continue;
		fprintf(file, "%s{\"leg\": %u, \"median_ms\": %.1f, \"level\": %.2f, \"db\": %.2f}",
			rows++ ? ", " : "", leg, stage_median(ms, count), level / count,
			judged ? db / judged : 0);
	}
	fprintf(file, "], ");
}

/* In the mean, and in the second of moving pictures that is worst in the mean. */
static void report_motion(const struct bench *bench, FILE *file)
{
	static double sum[SECONDS_MAX], count[SECONDS_MAX];
	double all = 0, judged = 0, worst = 99, least = 99;

	for (uint32_t i = 0; i < bench->shot_count; i++) {
		const struct shot *shot = &bench->shot[i];
		const int64_t second = shot->at_us / 1000000;

		if (shot->rests || isnan(shot->psnr) || second >= SECONDS_MAX)
			continue;
		sum[second] += shot->psnr;
		count[second]++;
		all += shot->psnr;
		judged++;
		least = fmin(least, shot->psnr);
	}
	if (judged == 0)
		return;
	for (int i = 0; i < SECONDS_MAX; i++)
		if (count[i] >= 1)
			worst = fmin(worst, sum[i] / count[i]);
	fprintf(file,
		"\"moving_psnr_db\": %.2f, \"worst_second_db\": %.2f, \"worst_frame_db\": %.2f, ",
		all / judged, worst, least);
}

/* From each stop until the picture is within a decibel of the best that this rest reached. */
static void report_rests(const struct bench *bench, FILE *file)
{
	double rest_db = 0;
	uint32_t rests = 0;

	fprintf(file, "\"stops_ms\": [");
	for (uint32_t i = 0, end; i < bench->shot_count; i = end) {
		double best = 0, last = 0;
		uint32_t within = i;

		for (end = i + 1;
		     end < bench->shot_count && bench->shot[end].leg == bench->shot[i].leg;)
			end++;
		if (!bench->shot[i].rests)
			continue;
		for (uint32_t k = i; k < end; k++) {
			const double psnr = bench->shot[k].psnr;

			best = isnan(psnr) ? best : fmax(best, psnr);
			last = isnan(psnr) ? last : psnr;
		}
		while (within + 1 < end && !(bench->shot[within].psnr >= best - 1))
			within++;
		/* Shown when it is drawn. */
		fprintf(file, "%s%.0f", rests ? ", " : "",
			(double)(bench->shot[within].at_us - bench->shot[i].at_us) / 1000 +
				bench->shot[within].spent_ms);
		rest_db += last;
		rests++;
	}
	fprintf(file, "], \"rest_db\": %.2f, ", rest_db / rests);
}

static void report_frames(const struct bench *bench)
{
	char path[512];
	FILE *file;

	snprintf(path, sizeof(path), "%s/frames.jsonl", bench->out);
	file = fopen(path, "we");
	for (uint32_t i = 0; file && i < bench->shot_count; i++) {
		const struct shot *s = &bench->shot[i];

		fprintf(file,
			"{\"at_ms\": %.1f, \"leg\": %u, \"rests\": %d, \"spent_ms\": %.2f, "
			"\"wall_ms\": %.2f, \"thread_ms\": %.2f, \"level\": %.2f, \"scale\": %.3f, "
			"\"faces\": %u, \"divisor\": %u, \"triangles\": %u, \"uploads\": %u, "
			"\"depths\": %u, \"share\": %.3f, \"psnr\": %.2f}\n",
			(double)s->at_us / 1000, s->leg, s->rests, s->spent_ms, s->wall_ms,
			s->thread_ms, (double)s->level, (double)s->effort.scale, s->effort.faces,
			s->divisor, s->triangles, s->uploads, s->depths, (double)s->effort.share,
			isnan(s->psnr) ? -1 : s->psnr);
	}
	if (file)
		fclose(file);
}

static void report(const struct bench *bench)
{
	char path[512];
	FILE *file;

	snprintf(path, sizeof(path), "%s/visit.json", bench->out);
	file = fopen(path, "we");
	if (!file)
		stage_die(path, -errno);
	fprintf(file, "{\"size\": \"%dx%d\", ", bench->options.width_px, bench->options.height_px);
	report_times(bench, file);
	report_motion(bench, file);
	report_rests(bench, file);
	report_legs(bench, file);
	fprintf(file, "\"kb\": %.0f}\n", (double)bench->stage.bytes / 1000);
	fclose(file);
	report_frames(bench);
}

static void read_option(struct bench *bench, const char *name, const char *value)
{
	if (!strcmp(name, "--truth"))
		bench->truth = value;
	else if (!strcmp(name, "--size"))
		sscanf(value, "%dx%d", &bench->options.width_px, &bench->options.height_px);
	else if (!strcmp(name, "--link"))
		bench->options.bits_a_second = (uint64_t)(strtod(value, NULL) * 1e6);
	else if (!strcmp(name, "--latency"))
		bench->options.latency_us = (uint32_t)(strtod(value, NULL) * 1000);
	else if (!strcmp(name, "--price"))
		bench->options.scene.price_px_per_kb = strtof(value, NULL);
	else if (!strcmp(name, "--times"))
		bench->times = (uint32_t)strtoul(value, NULL, 10);
	else if (!strcmp(name, "--layer"))
		bench->layer = (uint32_t)strtoul(value, NULL, 10);
	else if (!strcmp(name, "--keep"))
		bench->keeps = true;
	else if (!strcmp(name, "--level")) {
		bench->governor.level = strtof(value, NULL);
		bench->is_held = true;
	} else if (!strcmp(name, "--effort")) {
		struct scene_effort *e = &bench->effort;

		e->share = 1;
		if (sscanf(value, "%f,%u,%u,%f,%f", &e->scale, &e->triangles, &e->faces, &e->budget,
			   &e->share) < 4)
			stage_die(value, -EINVAL);
		bench->is_held = true;
	} else if (!strcmp(name, "--load"))
		bench->load = !strcmp(value, "core")   ? LOAD_CORE
			      : !strcmp(value, "heat") ? LOAD_HEAT
						       : LOAD_NONE;
	else
		stage_die(name, -EINVAL);
}

int main(int argc, char **argv)
{
	static struct bench bench;

	heap_prepare();
	if (argc < 4)
		stage_die("RELEASE VISIT OUT are needed", -EINVAL);
	bench.options = (struct stage_options){ .release = argv[1],
						.width_px = 1920,
						.height_px = 1080,
						.work_clock = true,
						.latency_us = 40000,
						.bits_a_second = 10000000,
						.scene = scene_settings(&profile_default,
									SCENE_LUMIGRAPH) };
	bench.out = argv[3];
	bench.times = 1;
	governor_init(&bench.governor,
		      &(struct governor_bounds){ .scale_least = profile_default.scale_least,
						 .refresh_us = REFRESH_US });
	for (int i = 4; i + 1 < argc; i += 2)
		read_option(&bench, argv[i], argv[i + 1]);
	visit_read(&bench.visit, argv[2]);
	write_views(&bench);
	if (!bench.truth)
		return 0;
	stage_open(&bench.stage, &bench.options);
	play(&bench);
	report(&bench);
	stage_close(&bench.stage);
	return 0;
}
