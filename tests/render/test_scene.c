#include <stdio.h>
#include <unistd.h>

#include "format/picture.h"
#include "render/gl.h"
#include "render/headless.h"
#include "tests/render/little_release.h"

enum { WIDTH = 480, HEIGHT = 270, FRAMES_MOST = 3000 };

struct stage {
	struct headless *headless;
	struct gl_target target;
	struct little_release *release;
	struct scene *scene;
	struct scene_frame frame;
	uint8_t *seen; /* RGBA */
};

static const struct scene_options usual = {
	.mode = SCENE_LUMIGRAPH,
	.texture_budget_bytes = 96 << 20,
	.geometry_budget_bytes = 64 << 20,
	.triangle_budget = 200000,
	.patch_error_px = 1,
	.upload_budget_us = 20000,
	.worker_count = 2,
};

static const struct camera usual_camera = {
	.eye_m = { 10, -12, 5 },
	.target_m = { 0, 0, 1.5f },
	.up = { 0, 0, 1 },
	.fov_deg = 45,
	.near_m = 0.1f,
	.far_m = 200,
	.width_px = WIDTH,
	.height_px = HEIGHT,
};

static void raise_stage(struct stage *stage, const struct scene_options *options)
{
	memset(stage, 0, sizeof(*stage));
	CHECK(headless_create(&stage->headless) == 0);
	CHECK(gl_target_create(&stage->target, WIDTH, HEIGHT) == 0);
	CHECK(scene_create(&stage->scene, options) == 0);
	stage->release = little_release_make(4);
	stage->seen = malloc(4 * WIDTH * HEIGHT);
	CHECK(scene_open(stage->scene, stage->release->root, stage->release->root_bytes) == 0);
}

static void strike_stage(struct stage *stage)
{
	scene_destroy(stage->scene);
	gl_target_destroy(&stage->target);
	CHECK(gl_check("the test") == 0);
	headless_destroy(stage->headless);
	little_release_free(stage->release);
	free(stage->seen);
}

static void draw(struct stage *stage, const struct camera *camera, const struct region *region)
{
	gl_target_bind(&stage->target);
	CHECK(scene_dispatch(stage->scene) == 0);
	scene_draw(stage->scene, camera, region, &stage->frame);
}

/* Serves and draws until the scene says that it is settled. Returns frames. */
static int settle(struct stage *stage, const struct camera *camera, const struct region *region)
{
	for (int i = 0; i < FRAMES_MOST; i++) {
		draw(stage, camera, region);
		little_release_serve(stage->release, stage->scene, 16);
		if (stage->frame.settled) {
			CHECK(gl_target_read(&stage->target, stage->seen) == 0);
			return i;
		}
	}
	fail_msg("not settled after %d frames", FRAMES_MOST);
	return 0;
}

static void keep_picture(const char *name, const uint8_t *rgba)
{
	const char *folder = getenv("KEEP_PICTURES");
	char path[512];
	struct buffer file;
	if (!folder)
		return;
	buffer_init(&file, 64 << 20);
	const struct picture picture = { WIDTH, HEIGHT, (uint8_t *)rgba };
	CHECK(picture_encode_png(&file, &picture) == 0);
	snprintf(path, sizeof(path), "%s/%s.png", folder, name);
	CHECK(bytes_write_file(buffer_bytes(&file), path) == 0);
	buffer_finish(&file);
}

static double psnr(const struct stage *stage, const struct camera *camera)
{
	uint8_t *truth = malloc(3 * WIDTH * HEIGHT);
	double sum = 0;
	little_truth(camera, truth);
	for (int i = 0; i < WIDTH * HEIGHT; i++) {
		for (int k = 0; k < 3; k++) {
			double d = (double)stage->seen[4 * i + k] - truth[3 * i + k];
			sum += d * d;
		}
	}
	free(truth);
	return 10 * log10(255.0 * 255.0 * 3 * WIDTH * HEIGHT / (sum + 1));
}

static double settled_psnr(enum scene_mode mode, const char *name)
{
	struct stage stage;
	struct scene_options options = usual;
	options.mode = mode;
	raise_stage(&stage, &options);
	int frames = settle(&stage, &usual_camera, NULL);
	double quality = psnr(&stage, &usual_camera);
	keep_picture(name, stage.seen);
	print_message("%s: %.2f dB, %d frames, %u kB, images %.3f\n", name, quality, frames,
		      (unsigned)(stage.release->given_bytes / 1024),
		      (double)stage.frame.image_share);
	strike_stage(&stage);
	return quality;
}

static void images_show_what_vertices_cannot(void **state)
{
	(void)state;
	double polygons = settled_psnr(SCENE_POLYGONS, "polygons");
	double corners = settled_psnr(SCENE_CORNERS, "corners");
	double lumigraph = settled_psnr(SCENE_LUMIGRAPH, "lumigraph");
	CHECK(lumigraph > polygons + 4);
	CHECK(lumigraph > corners);
	CHECK(lumigraph > 22);
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(images_show_what_vertices_cannot),
	};
	return cmocka_run_group_tests(tests, NULL, NULL);
}
