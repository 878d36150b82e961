/* What a frame costs with the eye moving a millimetre a frame over a warm scene, beside one
 * textured quad that fills the screen. Everything in one run, each frame finished before the clock
 * stops.
 *
 *   bench_frame RELEASE VIEWS [FRAMES]
 *
 * Prints JSON: medians over the views of VIEWS (eye x y z, target x y z, vertical field of view in
 * degrees), for 1280 x 720 and 1920 x 1080, for the Lumigraph and for its patches alone. */
#include <dirent.h>
#include <errno.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

#include "base/clock.h"
#include "pipeline/release_reader.h"
#include "render/gl.h"
#include "render/headless.h"
#include "render/scene.h"

enum { VIEWS_MOST = 16, FRAMES_MOST = 1000, WANTS = 64, SETTLE_MS = 20000 };

struct bench {
	struct release_reader *reader;
	struct locator locator;
	struct hash root;
	struct headless *headless;
	struct gl_target target;
	GLuint quad_program, quad_texture, quad_buffer;
	struct camera cameras[VIEWS_MOST];
	uint32_t views, frames, unsettled;
};

static void die(const char *what, int rc)
{
	fprintf(stderr, "bench_frame: %s: %s\n", what, strerror(-rc));
	exit(1);
}

static void must(int rc, const char *what)
{
	if (rc < 0)
		die(what, rc);
}

static void read_views(struct bench *bench, const char *path)
{
	FILE *file = fopen(path, "re");
	char line[256];

	if (!file)
		die(path, -errno);
	while (bench->views < VIEWS_MOST && fgets(line, sizeof(line), file)) {
		struct camera c = { .up = { 0, 0, 1 }, .near_m = 0.1f, .far_m = 2000 };

		if (sscanf(line, "%f %f %f %f %f %f %f", &c.eye_m[0], &c.eye_m[1], &c.eye_m[2],
			   &c.target_m[0], &c.target_m[1], &c.target_m[2], &c.fov_deg) == 7)
			bench->cameras[bench->views++] = c;
	}
	fclose(file);
	if (bench->views == 0)
		die(path, -EINVAL);
}

/* The newest file of locator/ names the root. */
static void open_release(struct bench *bench, const char *release)
{
	const struct release_reader_options options = { .place = release };
	char path[512], newest[HASH_HEX_BYTES] = "";
	struct buffer file;
	time_t when = 0;
	DIR *folder;

	snprintf(path, sizeof(path), "%s/locator", release);
	folder = opendir(path);
	if (!folder)
		die(path, -errno);
	for (struct dirent *entry; (entry = readdir(folder));) {
		struct stat info;

		snprintf(path, sizeof(path), "%s/locator/%.200s", release, entry->d_name);
		if (strlen(entry->d_name) != HASH_HEX_BYTES - 1 || stat(path, &info) < 0 ||
		    info.st_mtime < when)
			continue;
		when = info.st_mtime;
		snprintf(newest, sizeof(newest), "%.32s", entry->d_name);
	}
	closedir(folder);
	must(hash_from_hex(&bench->root, newest), "no locator");
	must(release_reader_create(&bench->reader, &options), release);
	buffer_init(&file, 256 << 20);
	snprintf(path, sizeof(path), "locator/%s", newest);
	must(release_reader_file(bench->reader, path, &file), path);
	must(locator_decode(&bench->locator, buffer_bytes(&file)), path);
	buffer_finish(&file);
}

static void serve(struct bench *bench, struct scene *scene)
{
	struct message_want wants[WANTS];
	const size_t count = scene_wants(scene, wants, WANTS);

	for (size_t i = 0; i < count; i++) {
		const struct page_child child = { .hash = wants[i].hash, .size = wants[i].size };
		struct bytes bytes;

		if (release_reader_child(bench->reader, &bench->locator, wants[i].page,
					 wants[i].offset, &child, &bytes) < 0)
			die(release_reader_why(bench->reader), -EIO);
		scene_give(scene, wants[i].hash, bytes);
	}
}

/* ---- the measure: a quad with a texture as large as the screen allows everywhere */

static void make_quad(struct bench *bench)
{
	static const float corners[] = { -1, -1, 1, -1, -1, 1, 1, 1 };
	static const char *const vertex[] = { "attribute vec2 corner;\n"
					      "varying vec2 at;\n"
					      "void main() {\n"
					      "	at = corner * 0.5 + 0.5;\n"
					      "	gl_Position = vec4(corner, 0.0, 1.0);\n"
					      "}\n",
					      NULL };
	static const char *const fragment[] = {
		"precision mediump float;\n"
		"uniform sampler2D picture;\n"
		"varying vec2 at;\n"
		"void main() { gl_FragColor = texture2D(picture, at); }\n",
		NULL
	};
	static const char *const attributes[] = { "corner", NULL };
	const struct gl_program_source source = { "quad", vertex, fragment, attributes };
	const struct gl_texture_options texture = {
		.width_px = 1024, .height_px = 1024, .format = GL_RGBA, .filter = GL_LINEAR
	};

	must(gl_program_build(&bench->quad_program, &source), "quad");
	must(gl_texture_create(&bench->quad_texture, &texture), "quad");
	glGenBuffers(1, &bench->quad_buffer);
	glBindBuffer(GL_ARRAY_BUFFER, bench->quad_buffer);
	glBufferData(GL_ARRAY_BUFFER, sizeof(corners), corners, GL_STATIC_DRAW);
}

static void draw_quad(const struct bench *bench)
{
	glDisable(GL_DEPTH_TEST);
	glDisable(GL_BLEND);
	glUseProgram(bench->quad_program);
	gl_bind_texture(0, bench->quad_texture);
	glBindBuffer(GL_ARRAY_BUFFER, bench->quad_buffer);
	glEnableVertexAttribArray(0);
	glVertexAttribPointer(0, 2, GL_FLOAT, GL_FALSE, 0, NULL);
	glDrawArrays(GL_TRIANGLE_STRIP, 0, 4);
}

/* ---- frames */

static int by_value(const void *a, const void *b)
{
	const double left = *(const double *)a, right = *(const double *)b;

	return left < right ? -1 : left > right;
}

static double median(double *values, uint32_t count)
{
	qsort(values, count, sizeof(values[0]), by_value);
	return values[count / 2];
}

static void clear(const struct bench *bench)
{
	gl_target_bind(&bench->target);
	glClearColor(0, 0, 0, 0);
	glClear(GL_COLOR_BUFFER_BIT | GL_DEPTH_BUFFER_BIT);
}

static double quad_ms(const struct bench *bench)
{
	double ms[FRAMES_MOST];

	for (uint32_t i = 0; i < bench->frames; i++) {
		const int64_t began_us = clock_now_us();

		gl_target_bind(&bench->target);
		draw_quad(bench);
		glFinish();
		ms[i] = (double)(clock_now_us() - began_us) / 1000;
	}
	return median(ms, bench->frames);
}

/* Until nothing is wanted any more, at most SETTLE_MS. */
static void settle(struct bench *bench, struct scene *scene, const struct camera *camera)
{
	const int64_t until_ms = clock_now_ms() + SETTLE_MS;
	struct scene_frame frame = { 0 };

	while (!frame.settled) {
		clear(bench);
		scene_draw(scene, camera, NULL, &frame);
		serve(bench, scene);
		must(scene_dispatch(scene), "scene");
		usleep(500);                     /* the workers decode */
		if (clock_now_ms() > until_ms) { /* warm enough, and the report says so */
			fprintf(stderr,
				"bench_frame: a view did not settle: %u tiles in its last frame\n",
				frame.tiles_uploaded);
			bench->unsettled++;
			return;
		}
	}
}

struct cost {
	double ms, triangles;
};

static struct cost frames_of(struct bench *bench, struct scene *scene, struct camera camera)
{
	struct scene_frame frame;
	double ms[FRAMES_MOST];

	settle(bench, scene, &camera);
	for (uint32_t i = 0; i < bench->frames; i++) {
		int64_t began_us;

		camera.eye_m[0] += 0.001f;
		camera.target_m[0] += 0.001f;
		began_us = clock_now_us();
		clear(bench);
		scene_draw(scene, &camera, NULL, &frame);
		glFinish();
		ms[i] = (double)(clock_now_us() - began_us) / 1000;
		serve(bench, scene);
		must(scene_dispatch(scene), "scene");
	}
	return (struct cost){ median(ms, bench->frames), frame.triangles };
}

/* The middle view's cost. */
static struct cost mode_cost(struct bench *bench, enum scene_mode mode)
{
	const struct scene_options options = {
		.mode = mode,
		.texture_budget_bytes = 64 << 20,
		.geometry_budget_bytes = 64 << 20,
		.triangle_budget = 400000,
		.patch_error_px = 2,
		.upload_budget_us = 100000, /* warm soon; then nothing is left to upload */
		.worker_count = 2
	};
	double ms[VIEWS_MOST], triangles[VIEWS_MOST];
	const struct locator_block *block;
	struct scene *scene;

	must(scene_create(&scene, &options), "scene");
	block = locator_find(&bench->locator,
			     (struct hash){ 0 }); /* the root page is its block alone */
	must(block ? scene_open(scene, bench->root, block->size) : -ENOENT, "scene");
	for (uint32_t i = 0; i < bench->views; i++) {
		struct camera camera = bench->cameras[i];
		struct cost cost;

		camera.width_px = bench->target.width_px;
		camera.height_px = bench->target.height_px;
		cost = frames_of(bench, scene, camera);
		ms[i] = cost.ms;
		triangles[i] = cost.triangles;
	}
	scene_destroy(scene);
	return (struct cost){ median(ms, bench->views), median(triangles, bench->views) };
}

static void measure(struct bench *bench, int width_px, int height_px, bool last)
{
	struct cost images, polygons;
	double quads[2], quad;

	must(gl_target_create(&bench->target, width_px, height_px), "target");
	quads[0] = quad_ms(bench);
	images = mode_cost(bench, SCENE_LUMIGRAPH);
	polygons = mode_cost(bench, SCENE_POLYGONS);
	quads[1] = quad_ms(bench);
	quad = (quads[0] + quads[1]) / 2;
	printf(" {\"size\": \"%dx%d\", \"quad_ms\": %.3f, \"lumigraph_ms\": %.3f, "
	       "\"polygons_ms\": %.3f, \"triangles\": %.0f, \"lumigraph_per_quad\": %.2f, "
	       "\"polygons_per_quad\": %.2f, \"lumigraph_per_polygons\": %.2f}%s\n",
	       width_px, height_px, quad, images.ms, polygons.ms, images.triangles,
	       images.ms / quad, polygons.ms / quad, images.ms / polygons.ms, last ? "" : ",");
	gl_target_destroy(&bench->target);
}

int main(int argc, char **argv)
{
	static struct bench bench;
	unsigned long frames = argc > 3 ? strtoul(argv[3], NULL, 10) : 60;

	if (argc < 3 || frames < 1 || frames > FRAMES_MOST) {
		fputs("usage: bench_frame RELEASE VIEWS [FRAMES, at most 1000]\n", stderr);
		return 2;
	}
	bench.frames = (uint32_t)frames;
	read_views(&bench, argv[2]);
	open_release(&bench, argv[1]);
	must(headless_create(&bench.headless), "no GL");
	make_quad(&bench);
	printf("{\"renderer\": \"%s\", \"views\": %u, \"frames\": %u, \"sizes\": [\n",
	       (const char *)glGetString(GL_RENDERER), bench.views, bench.frames);
	measure(&bench, 1280, 720, false);
	measure(&bench, 1920, 1080, true);
	printf("], \"unsettled\": %u}\n", bench.unsettled);
	headless_destroy(bench.headless);
	release_reader_destroy(bench.reader);
	locator_finish(&bench.locator);
	return 0;
}
