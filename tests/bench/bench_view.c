/* Draws views of a release as the kiosk does, from an empty scene and with nothing between it and
 * the release's folder, and says what each cost; against true pictures, how good it is.
 *
 *   bench_view RELEASE VIEWS OUT [--mode lumigraph|corners|polygons] [--size WxH] [--truth FOLDER]
 *              [--error-px E] [--triangles N] [--texture-mb N]
 *
 * VIEWS: a line a view, eye x y z, target x y z, vertical field of view in degrees. OUT gets
 * view-NNNN.png (alpha is coverage) and views.jsonl. FOLDER holds view-NNNN.png of the same views
 * (gopura-content render). Quality is judged over the union of both silhouettes, on one
 * grey (as tests/tools/compare_pictures does). */
#include <dirent.h>
#include <errno.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

#include "base/clock.h"
#include "format/picture.h"
#include "pipeline/release_reader.h"
#include "render/gl.h"
#include "render/headless.h"
#include "render/scene.h"

enum { VIEWS_MOST = 1000, WANTS = 64, SETTLE_MS = 240000 };

struct bench {
	const char *release, *views, *out, *truth;
	struct camera camera;
	struct scene_options options;
	struct release_reader *reader;
	struct locator locator;
	struct hash root;
	struct headless *headless;
	struct gl_target target;
	struct scene *scene;
	uint64_t bytes, objects;
	double psnr_sum, worst[VIEWS_MOST];
	uint32_t scored, views_done;
	FILE *lines;
};

static void die(const char *what, int rc)
{
	fprintf(stderr, "bench_view: %s: %s\n", what, strerror(-rc));
	exit(1);
}

static void parse(struct bench *bench, int argc, char **argv)
{
	bench->camera = (struct camera){
		.up = { 0, 0, 1 }, .near_m = 0.1f, .far_m = 2000, .width_px = 1280, .height_px = 720
	};
	bench->options = (struct scene_options){ .mode = SCENE_LUMIGRAPH,
						 .texture_budget_bytes = 128 << 20,
						 .geometry_budget_bytes = 256 << 20,
						 .triangle_budget = 1000000,
						 .patch_error_px = 1,
						 .upload_budget_us = 8000,
						 .worker_count = 2 };
	if (argc < 4)
		die("RELEASE VIEWS OUT are needed", -EINVAL);
	bench->release = argv[1];
	bench->views = argv[2];
	bench->out = argv[3];
	for (int i = 4; i + 1 < argc; i += 2) {
		const char *value = argv[i + 1];
		if (!strcmp(argv[i], "--mode"))
			bench->options.mode = !strcmp(value, "polygons")  ? SCENE_POLYGONS
					      : !strcmp(value, "corners") ? SCENE_CORNERS
									  : SCENE_LUMIGRAPH;
		else if (!strcmp(argv[i], "--size"))
			sscanf(value, "%dx%d", &bench->camera.width_px, &bench->camera.height_px);
		else if (!strcmp(argv[i], "--truth"))
			bench->truth = value;
		else if (!strcmp(argv[i], "--error-px"))
			bench->options.patch_error_px = strtof(value, NULL);
		else if (!strcmp(argv[i], "--triangles"))
			bench->options.triangle_budget = (uint32_t)strtoul(value, NULL, 10);
		else if (!strcmp(argv[i], "--texture-mb"))
			bench->options.texture_budget_bytes = strtoull(value, NULL, 10) << 20;
		else
			die(argv[i], -EINVAL);
	}
}

/* The newest file of locator/ names the root. */
static void open_release(struct bench *bench)
{
	char path[512], newest[HASH_HEX_BYTES] = "";
	struct buffer file;
	time_t when = 0;
	snprintf(path, sizeof(path), "%s/locator", bench->release);
	DIR *folder = opendir(path);
	if (!folder)
		die(path, -errno);
	for (struct dirent *entry; (entry = readdir(folder));) {
		struct stat info;
		snprintf(path, sizeof(path), "%s/locator/%.200s", bench->release, entry->d_name);
		if (strlen(entry->d_name) != HASH_HEX_BYTES - 1 || stat(path, &info) < 0 ||
		    info.st_mtime < when)
			continue;
		when = info.st_mtime;
		snprintf(newest, sizeof(newest), "%.32s", entry->d_name);
	}
	closedir(folder);
	const struct release_reader_options options = { .place = bench->release };
	int rc = hash_from_hex(&bench->root, newest);
	if (rc == 0)
		rc = release_reader_create(&bench->reader, &options);
	buffer_init(&file, 256 << 20);
	snprintf(path, sizeof(path), "locator/%s", newest);
	if (rc == 0)
		rc = release_reader_file(bench->reader, path, &file);
	if (rc == 0)
		rc = locator_decode(&bench->locator, buffer_bytes(&file));
	if (rc < 0)
		die("opening the release", rc);
	buffer_finish(&file);
}

static void serve(struct bench *bench)
{
	struct message_want wants[WANTS];
	size_t count = scene_wants(bench->scene, wants, WANTS);
	for (size_t i = 0; i < count; i++) {
		const struct page_child child = { .hash = wants[i].hash, .size = wants[i].size };
		struct bytes bytes;
		int rc = release_reader_child(bench->reader, &bench->locator, wants[i].page,
					      wants[i].offset, &child, &bytes);
		if (rc < 0)
			die(release_reader_why(bench->reader), rc);
		bench->bytes += bytes.size;
		bench->objects++;
		scene_give(bench->scene, wants[i].hash, bytes);
	}
}

/* ---- quality */

static bool read_picture(const char *folder, uint32_t view, struct picture *out)
{
	char path[512];
	struct buffer file;
	snprintf(path, sizeof(path), "%s/view-%04u.png", folder, view);
	buffer_init(&file, 256 << 20);
	int rc = buffer_read_file(&file, path);
	if (rc == 0)
		rc = picture_decode(out, buffer_bytes(&file));
	buffer_finish(&file);
	return rc == 0;
}

static double over_grey(const uint8_t pixel[4], int channel)
{
	return (pixel[channel] * pixel[3] + 96.0 * (255 - pixel[3])) / 255;
}

static double psnr_of(const struct picture *a, const uint8_t *b)
{
	double sum = 0, count = 0;
	for (size_t i = 0; i < (size_t)a->width * a->height; i++) {
		const uint8_t *p = a->rgba + 4 * i, *q = b + 4 * i;
		if (p[3] == 0 && q[3] == 0)
			continue;
		for (int k = 0; k < 3; k++) {
			double d = over_grey(p, k) - over_grey(q, k);
			sum += d * d;
		}
		count += 3;
	}
	return count > 0 ? 10 * log10(255.0 * 255.0 * count / (sum + 1e-3)) : 99;
}

static double score(struct bench *bench, uint32_t view, const uint8_t *rgba)
{
	struct picture truth = { 0 };
	if (!bench->truth || !read_picture(bench->truth, view, &truth))
		return NAN;
	double psnr = NAN;
	if ((int)truth.width == bench->camera.width_px &&
	    (int)truth.height == bench->camera.height_px)
		psnr = psnr_of(&truth, rgba);
	picture_finish(&truth);
	if (!isnan(psnr)) {
		bench->psnr_sum += psnr;
		bench->worst[bench->scored++] = psnr;
	}
	return psnr;
}

static void keep(const struct bench *bench, uint32_t view, uint8_t *rgba)
{
	char path[512];
	struct buffer file;
	const struct picture picture = { (uint32_t)bench->camera.width_px,
					 (uint32_t)bench->camera.height_px, rgba };
	buffer_init(&file, 256 << 20);
	snprintf(path, sizeof(path), "%s/view-%04u.png", bench->out, view);
	int rc = picture_encode_png(&file, &picture);
	if (rc == 0)
		rc = bytes_write_file(buffer_bytes(&file), path);
	if (rc < 0)
		die(path, rc);
	buffer_finish(&file);
}

/* ---- views */

static void draw_view(struct bench *bench, uint32_t view)
{
	struct scene_frame frame = { 0 };
	uint64_t bytes = bench->bytes, objects = bench->objects;
	int64_t began = clock_now_ms(), spent_us = 0, slowest_us = 0;
	uint32_t frames = 0;
	do {
		gl_target_bind(&bench->target);
		int64_t from = clock_now_us();
		int rc = scene_dispatch(bench->scene);
		if (rc < 0)
			die("dispatch", rc);
		scene_draw(bench->scene, &bench->camera, NULL, &frame);
		glFinish();
		int64_t took = clock_now_us() - from;
		spent_us += took;
		slowest_us = took > slowest_us ? took : slowest_us;
		frames++;
		serve(bench);
		if (!frame.moving)
			usleep(2000);
	} while (!frame.settled && clock_now_ms() - began < SETTLE_MS);
	uint8_t *rgba =
		malloc(4 * (size_t)bench->camera.width_px * (size_t)bench->camera.height_px);
	if (!rgba || gl_target_read(&bench->target, rgba) < 0)
		die("reading the picture", -EIO);
	scene_unmix(bench->scene, rgba,
		    (size_t)bench->camera.width_px * (size_t)bench->camera.height_px);
	double psnr = score(bench, view, rgba);
	keep(bench, view, rgba);
	free(rgba);
	fprintf(bench->lines,
		"{\"view\": %u, \"settled\": %s, \"psnr\": %.2f, \"bytes\": %llu, \"objects\": "
		"%llu, \"settled_ms\": %lld, \"frames\": %u, \"frame_ms\": %.1f, \"slowest_ms\": "
		"%.1f, \"triangles\": %u, \"patches\": %u, \"image_share\": %.3f}\n",
		view, frame.settled ? "true" : "false", isnan(psnr) ? 0 : psnr,
		(unsigned long long)(bench->bytes - bytes),
		(unsigned long long)(bench->objects - objects), (long long)(clock_now_ms() - began),
		frames, (double)spent_us / frames / 1000.0, (double)slowest_us / 1000.0,
		frame.triangles, frame.patches, (double)frame.image_share);
	fflush(bench->lines);
}

static void draw_views(struct bench *bench)
{
	char line[512], path[512];
	FILE *views = fopen(bench->views, "re");
	snprintf(path, sizeof(path), "%s/views.jsonl", bench->out);
	mkdir(bench->out, 0777);
	bench->lines = fopen(path, "we");
	if (!views || !bench->lines)
		die(views ? path : bench->views, -errno);
	while (fgets(line, sizeof(line), views) && bench->views_done < VIEWS_MOST) {
		float *e = bench->camera.eye_m, *t = bench->camera.target_m;
		if (sscanf(line, "%f %f %f %f %f %f %f", &e[0], &e[1], &e[2], &t[0], &t[1], &t[2],
			   &bench->camera.fov_deg) == 7)
			draw_view(bench, bench->views_done++);
	}
	fclose(views);
	fclose(bench->lines);
}

static int by_value(const void *a, const void *b)
{
	double left = *(const double *)a, right = *(const double *)b;
	return left < right ? -1 : left > right;
}

static void conclude(struct bench *bench)
{
	printf("%u views, %.0f KB/view", bench->views_done,
	       (double)bench->bytes / 1024 / (bench->views_done ? bench->views_done : 1));
	if (bench->scored > 0) {
		qsort(bench->worst, bench->scored, sizeof(double), by_value);
		printf(", PSNR mean %.2f dB, 5 %%: %.2f dB, worst %.2f dB",
		       bench->psnr_sum / bench->scored, bench->worst[bench->scored / 20],
		       bench->worst[0]);
	}
	printf("\n");
}

int main(int argc, char **argv)
{
	static struct bench bench;
	parse(&bench, argc, argv);
	open_release(&bench);
	int rc = headless_create(&bench.headless);
	if (rc == 0)
		rc = gl_target_create(&bench.target, bench.camera.width_px, bench.camera.height_px);
	if (rc == 0)
		rc = scene_create(&bench.scene, &bench.options);
	/* The root page is its block alone. */
	const struct locator_block *block =
		rc == 0 ? locator_find(&bench.locator, (struct hash){ 0 }) : NULL;
	if (rc == 0)
		rc = block ? scene_open(bench.scene, bench.root, block->size) : -ENOENT;
	if (rc < 0)
		die("starting", rc);
	draw_views(&bench);
	conclude(&bench);
	scene_destroy(bench.scene);
	gl_target_destroy(&bench.target);
	headless_destroy(bench.headless);
	locator_finish(&bench.locator);
	release_reader_destroy(bench.reader);
	return 0;
}
