/* What a frame costs with the eye moving a millimetre a frame over a warm scene, as a multiple of
 * the same triangles with one plain texture lookup, and of one textured quad that fills the screen.
 * What enlarging a picture of half the size takes. Everything in one run, each frame finished
 * before the clock stops. And how much of the picture changes when the eye crosses the border
 * between two cells of the grid by a millimetre a frame.
 *
 *   bench_frame RELEASE VIEWS [FRAMES [frames|levels]]
 *
 * Prints JSON: medians over the views of VIEWS (eye x y z, target x y z, vertical field of view in
 * degrees), for 1280 x 720 and 1920 x 1080. "frames": of the Lumigraph alone, and no crossing.
 * "levels": instead, at 1920 x 1080, what a frame costs at levels of the governor. */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>

#include "app/settings/scene_settings.h"
#include "base/clock.h"
#include "render/lumigraph/enlargement.h"
#include "render/scene/governor.h"
#include "render/scene/scene_parts.h"
#include "tests/bench/stage.h"

enum { VIEWS_MAX = 16, FRAMES_MAX = 1000, SETTLE_MS = 120000, CROSSING_FRAMES = 10 };

struct bench {
	struct stage stage;
	struct gl_target deep; /* as large, with depth, which a panel's may lack */
	struct enlargement enlargement;
	GLuint quad_program, plain_program, texture, quad_buffer;
	GLint plain_clip, plain_lattice;
	struct camera cameras[VIEWS_MAX], moving;
	struct scene_frame frame; /* drawn last */
	uint32_t views, frames, unsettled;
	bool frames_alone;
	struct governor governor; /* its level is set, not governed: loads of the machine differ */
};

/* ---- the measures: the same triangles, and a quad, with one texture */

static const char *const textured_fragment[] = {
	"precision mediump float;\n"
	"uniform sampler2D picture;\n"
	"varying vec2 at;\n"
	"void main() { gl_FragColor = texture2D(picture, at); }\n",
	NULL
};

static void make_programs(struct bench *bench)
{
	static const float corners[] = { -1, -1, 1, -1, -1, 1, 1, 1 };
	static const char *const quad[] = { "attribute vec2 corner;\n"
					    "varying vec2 at;\n"
					    "void main() {\n"
					    "	at = corner * 0.5 + 0.5;\n"
					    "	gl_Position = vec4(corner, 0.0, 1.0);\n"
					    "}\n",
					    NULL };
	static const char *const plain[] = {
		"attribute vec3 position, base;\n"
		"uniform mat4 clip;\n"
		"uniform vec4 lattice;\n"
		"varying vec2 at;\n"
		"void main() {\n"
		"	gl_Position = clip * vec4(lattice.xyz + lattice.w * (base + position), 1.0);\n"
		"	at = gl_Position.xy / gl_Position.w * 0.5 + 0.5;\n"
		"}\n",
		NULL
	};
	const struct gl_program_source quad_source = { "quad", quad, textured_fragment,
						       (const char *const[]){ "corner", NULL } };
	const struct gl_program_source plain_source = {
		"plain", plain, textured_fragment,
		(const char *const[]){ "position", "normal", "colour", "base", NULL }
	};
	const struct gl_texture_options texture = {
		.width_px = 1024, .height_px = 1024, .format = GL_RGBA, .filter = GL_LINEAR
	};

	stage_must(gl_program_build(&bench->quad_program, &quad_source), "quad");
	stage_must(gl_program_build(&bench->plain_program, &plain_source), "plain");
	bench->plain_clip = glGetUniformLocation(bench->plain_program, "clip");
	bench->plain_lattice = glGetUniformLocation(bench->plain_program, "lattice");
	stage_must(gl_texture_create(&bench->texture, &texture), "texture");
	glGenBuffers(1, &bench->quad_buffer);
	glBindBuffer(GL_ARRAY_BUFFER, bench->quad_buffer);
	glBufferData(GL_ARRAY_BUFFER, sizeof(corners), corners, GL_STATIC_DRAW);
}

static void clear(const struct gl_target *target)
{
	gl_target_bind(target);
	glClearColor(0, 0, 0, 0);
	glClear(GL_COLOR_BUFFER_BIT | GL_DEPTH_BUFFER_BIT);
}

static void draw_quad(struct bench *bench)
{
	gl_target_bind(&bench->stage.target);
	glDisable(GL_DEPTH_TEST);
	glDisable(GL_BLEND);
	glUseProgram(bench->quad_program);
	gl_bind_texture(0, bench->texture);
	glBindBuffer(GL_ARRAY_BUFFER, bench->quad_buffer);
	glEnableVertexAttribArray(0);
	glVertexAttribPointer(0, 2, GL_FLOAT, GL_FALSE, 0, NULL);
	glDrawArrays(GL_TRIANGLE_STRIP, 0, 4);
}

/* A picture of half the size to all of the panel, as at the governor's lower levels. */
static void draw_enlarged(struct bench *bench)
{
	const struct gl_target *panel = &bench->stage.target;
	const struct gl_place place = { .framebuffer = panel->framebuffer };
	const struct view small = { .width_px = panel->width_px / 2,
				    .height_px = panel->height_px / 2 };

	stage_must(enlargement_begin(&bench->enlargement, &small), "enlargement");
	enlargement_end(&bench->enlargement, &place, panel->width_px, panel->height_px);
}

/* The pieces that the scene just drew, all of a patch at once. */
static void draw_plain(struct bench *bench)
{
	struct scene *scene = bench->stage.scene;
	const struct lattice *lattice = &scene->root.lattice;
	const float *eye = scene->view.eye_m;

	clear(&bench->deep);
	glDisable(GL_BLEND);
	glEnable(GL_DEPTH_TEST);
	glUseProgram(bench->plain_program);
	gl_bind_texture(0, bench->texture);
	glUniformMatrix4fv(bench->plain_clip, 1, GL_FALSE, scene->view.clip);
	glUniform4f(bench->plain_lattice, (float)(lattice->origin_m[0] - eye[0]),
		    (float)(lattice->origin_m[1] - eye[1]), (float)(lattice->origin_m[2] - eye[2]),
		    (float)lattice->step_m);
	glEnableVertexAttribArray(0);
	glDisableVertexAttribArray(1);
	glDisableVertexAttribArray(2);
	for (uint32_t i = 0, run = 0; i < scene->visible_count; i += run) {
		const struct visible_piece *v = &scene->visible[i];
		const struct piece *pieces = scene->geometry.patches[v->patch].content.bvh.pieces;
		uint32_t count = 0;

		for (run = 0; i + run < scene->visible_count && v[run].patch == v->patch &&
			      v[run].piece == v->piece + run;
		     run++)
			count += pieces[v[run].piece].triangle_count;
		geometry_bind(&scene->geometry, v->patch);
		geometry_cull(&scene->geometry, v->patch);
		geometry_draw(&scene->geometry, pieces[v->piece].first_triangle, count);
	}
	geometry_cull_none();
}

struct spent {
	double ms, cpu_ms;
};

/* Of the process, llvmpipe's threads and all: what other work on the machine changes little. */
static struct spent spent_until_now(void)
{
	struct timespec cpu;

	clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &cpu);
	return (struct spent){ (double)clock_now_us() / 1000,
			       (double)cpu.tv_sec * 1000 + (double)cpu.tv_nsec / 1e6 };
}

/* Of the frames, the median; the frame that is drawn is finished. */
static struct spent median_spent(struct bench *bench, void (*draw)(struct bench *))
{
	double ms[FRAMES_MAX], cpu_ms[FRAMES_MAX];

	for (uint32_t i = 0; i < bench->frames; i++) {
		const struct spent began = spent_until_now();
		struct spent ended;

		draw(bench);
		glFinish();
		ended = spent_until_now();
		ms[i] = ended.ms - began.ms;
		cpu_ms[i] = ended.cpu_ms - began.cpu_ms;
	}
	return (struct spent){ stage_median(ms, bench->frames),
			       stage_median(cpu_ms, bench->frames) };
}

/* ---- crossing a border */

/* Aside, along the axis where it is nearest: to half way before the border between the cells. */
static void go_to_border(const struct samples_page *grid, struct camera *camera, int *axis)
{
	float nearest = INFINITY;

	for (int i = 0; i < 3; i++) {
		float cell = roundf((camera->eye_m[i] - grid->origin_m[i]) / grid->spacing_m[i]);
		float plane = fminf(fmaxf(cell, 0), (float)(grid->count[i] - 1));
		float way = grid->origin_m[i] + plane * grid->spacing_m[i] - camera->eye_m[i];

		if (fabsf(way) < fabsf(nearest)) {
			nearest = way;
			*axis = i;
		}
	}
	nearest -= 0.001f * (CROSSING_FRAMES + 0.5f) / 2;
	camera->eye_m[*axis] += nearest;
	camera->target_m[*axis] += nearest;
}

/* Of the pixels that show anything in either: those where a colour differs by more than 10. */
static double changed_pct(const uint8_t *a, const uint8_t *b, size_t count)
{
	size_t shown = 0, changed = 0;

	for (size_t i = 0; i < count; i++, a += 4, b += 4) {
		bool differs = false;

		for (int c = 0; c < 3; c++)
			differs = differs || abs(a[c] - b[c]) > 10;
		shown += a[3] > 0 || b[3] > 0;
		changed += differs;
	}
	return shown > 0 ? 100 * (double)changed / (double)shown : 0;
}

/* The most that one of the frames changes; the first ends the rest before it and does not count. */
static double cross_border(struct bench *bench, struct camera camera)
{
	struct stage *stage = &bench->stage;
	struct scene_frame frame;
	uint8_t *before = NULL;
	double most = 0;
	int axis = 0;

	camera.width_px = stage->target.width_px;
	camera.height_px = stage->target.height_px;
	go_to_border(&stage->scene->repository.grid, &camera, &axis);
	stage_settle(stage, &camera, SETTLE_MS, &frame);
	bench->unsettled += !frame.settled;
	for (int i = 0; i < CROSSING_FRAMES; i++) {
		uint8_t *now;

		camera.eye_m[axis] += 0.001f;
		camera.target_m[axis] += 0.001f;
		stage_frame(stage, &camera, &frame);
		now = stage_read(stage);
		if (before)
			most = fmax(most, changed_pct(before, now,
						      (size_t)camera.width_px *
							      (size_t)camera.height_px));
		free(before);
		before = now;
	}
	free(before);
	return most;
}

/* ---- frames */

struct cost {
	struct spent scene, plain;
	double triangles, crossing_pct;
};

static void draw_moving(struct bench *bench)
{
	bench->moving.eye_m[0] += 0.001f;
	bench->moving.target_m[0] += 0.001f;
	const struct scene_effort effort = governor_effort(&bench->governor);

	clear(&bench->stage.target);
	scene_spend(bench->stage.scene, &effort);
	scene_draw(bench->stage.scene, &bench->moving, NULL, &bench->frame);
}

static struct cost cost_of(struct bench *bench, struct camera camera)
{
	struct cost cost = { 0 };

	camera.width_px = bench->stage.target.width_px;
	camera.height_px = bench->stage.target.height_px;
	stage_settle(&bench->stage, &camera, SETTLE_MS, &bench->frame);
	bench->unsettled += !bench->frame.settled;
	bench->governor.whole = bench->frame.triangles;
	bench->moving = camera;
	cost.scene = median_spent(bench, draw_moving);
	cost.plain = median_spent(bench, draw_plain);
	cost.triangles = bench->frame.triangles;
	return cost;
}

/* The middle view's cost. */
static struct cost mode_cost(struct bench *bench, enum scene_mode mode)
{
	struct scene_options options = bench->stage.options.scene;
	double ms[VIEWS_MAX], cpu_ms[VIEWS_MAX], plain_ms[VIEWS_MAX], plain_cpu_ms[VIEWS_MAX];
	double triangles[VIEWS_MAX], crossing_pct[VIEWS_MAX];

	options.mode = mode;
	stage_begin(&bench->stage, &options);
	for (uint32_t i = 0; i < bench->views; i++) {
		const struct cost cost = cost_of(bench, bench->cameras[i]);

		ms[i] = cost.scene.ms;
		cpu_ms[i] = cost.scene.cpu_ms;
		plain_ms[i] = cost.plain.ms;
		plain_cpu_ms[i] = cost.plain.cpu_ms;
		triangles[i] = cost.triangles;
		crossing_pct[i] = bench->frames_alone ? 0 : cross_border(bench, bench->cameras[i]);
	}
	return (struct cost){
		.scene = { stage_median(ms, bench->views), stage_median(cpu_ms, bench->views) },
		.plain = { stage_median(plain_ms, bench->views),
			   stage_median(plain_cpu_ms, bench->views) },
		.triangles = stage_median(triangles, bench->views),
		.crossing_pct = stage_median(crossing_pct, bench->views),
	};
}

static void begin(struct bench *bench, const struct stage_options *options)
{
	stage_open(&bench->stage, options);
	stage_must(gl_target_create(&bench->deep, options->width_px, options->height_px), "target");
	make_programs(bench);
}

static void end(struct bench *bench)
{
	gl_target_destroy(&bench->deep);
	enlargement_finish(&bench->enlargement);
	stage_close(&bench->stage);
}

static void measure(struct bench *bench, const struct stage_options *options, bool last)
{
	struct cost images, polygons = { 0 };
	double quads[2], quad, enlarged;

	begin(bench, options);
	enlarged = median_spent(bench, draw_enlarged).ms;
	quads[0] = median_spent(bench, draw_quad).ms;
	images = mode_cost(bench, SCENE_LUMIGRAPH);
	if (!bench->frames_alone)
		polygons = mode_cost(bench, SCENE_POLYGONS);
	quads[1] = median_spent(bench, draw_quad).ms;
	quad = (quads[0] + quads[1]) / 2;
	printf(" {\"size\": \"%dx%d\", \"quad_ms\": %.3f, \"enlarging_ms\": %.3f, \"plain_ms\": %.3f, \"lumigraph_ms\": %.3f, "
	       "\"plain_cpu_ms\": %.3f, \"lumigraph_cpu_ms\": %.3f, \"triangles\": %.0f, "
	       "\"lumigraph_per_plain\": %.2f, \"lumigraph_per_quad\": %.2f",
	       options->width_px, options->height_px, quad, enlarged, images.plain.ms,
	       images.scene.ms, images.plain.cpu_ms, images.scene.cpu_ms, images.triangles,
	       images.scene.ms / images.plain.ms, images.scene.ms / quad);
	if (!bench->frames_alone)
		printf(", \"polygons_ms\": %.3f, \"polygons_per_quad\": %.2f, "
		       "\"lumigraph_per_polygons\": %.2f, \"crossing_changed_pct\": %.3f, "
		       "\"crossing_changed_pct_polygons\": %.3f",
		       polygons.scene.ms, polygons.scene.ms / quad,
		       images.scene.ms / polygons.scene.ms, images.crossing_pct,
		       polygons.crossing_pct);
	printf("}%s\n", last ? "" : ",");
	fflush(stdout);
	end(bench);
}

/* At each level all views, the measure beside them. */
static void measure_levels(struct bench *bench, const struct stage_options *options)
{
	static const float levels[] = { 1, 0.8f, 0.6f, 0.4f, 0.3f, 0.2f, 0.1f, 0 };

	begin(bench, options);
	for (size_t i = 0; i < ARRAY_COUNT(levels); i++) {
		struct scene_effort effort;
		struct cost cost;

		bench->governor.level = levels[i];
		cost = mode_cost(bench, SCENE_LUMIGRAPH);
		effort = governor_effort(&bench->governor);
		printf(" {\"level\": %.1f, \"scale\": %.2f, \"triangles\": %.0f, \"faces\": %u, "
		       "\"plain_cpu_ms\": %.1f, \"lumigraph_cpu_ms\": %.1f, "
		       "\"cpu_per_plain\": %.2f, \"lumigraph_per_plain\": %.2f}%s\n",
		       (double)levels[i], (double)effort.scale, cost.triangles, effort.faces,
		       cost.plain.cpu_ms, cost.scene.cpu_ms, cost.scene.cpu_ms / cost.plain.cpu_ms,
		       cost.scene.ms / cost.plain.ms, i + 1 < ARRAY_COUNT(levels) ? "," : "");
		fflush(stdout);
	}
	end(bench);
}

int main(int argc, char **argv)
{
	static struct bench bench;
	bool levels;
	unsigned long frames = argc > 3 ? strtoul(argv[3], NULL, 10) : 60;

	if (argc < 3 || frames < 1 || frames > FRAMES_MAX) {
		fputs("usage: bench_frame RELEASE VIEWS [FRAMES, at most 1000 [frames]]\n", stderr);
		return 2;
	}
	struct stage_options options = {
		.release = argv[1],
		.width_px = 1280,
		.height_px = 720,
		.wall_clock = true,
		.scene = scene_settings(&profile_default, SCENE_LUMIGRAPH),
	};
	options.scene.upload_budget_us = 100000; /* warm soon; then nothing is left to upload */
	bench.frames = (uint32_t)frames;
	levels = argc > 4 && strcmp(argv[4], "levels") == 0;
	bench.frames_alone = argc > 4;
	bench.views = stage_read_views(bench.cameras, VIEWS_MAX, argv[2], 0, 0);
	printf("{\"views\": %u, \"frames\": %u, \"sizes\": [\n", bench.views, bench.frames);
	governor_init(&bench.governor,
		      &(struct governor_bounds){ .scale_least = profile_default.scale_least });
	if (levels) {
		options.width_px = 1920;
		options.height_px = 1080;
		measure_levels(&bench, &options);
	} else {
		measure(&bench, &options, false);
		options.width_px = 1920;
		options.height_px = 1080;
		measure(&bench, &options, true);
	}
	printf("], \"unsettled\": %u}\n", bench.unsettled);
	return 0;
}
