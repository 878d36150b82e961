#include <errno.h>
#include <stdio.h>
#include <unistd.h>

#include "format/picture.h"
#include "render/display/gl.h"
#include "render/display/headless.h"
#include "render/scene/scene_parts.h"
#include "tests/render/scene/little_release.h"

enum { WIDTH = 480, HEIGHT = 270, FRAMES_MAX = 3000 };

static struct little_release *release; /* made once for all tests */

static bool map_is_full;

int __real_map_set(struct map *map, map_key key, uint64_t value);
int __wrap_map_set(struct map *map, map_key key, uint64_t value);

int __wrap_map_set(struct map *map, map_key key, uint64_t value)
{
	return map_is_full ? -ENOMEM : __real_map_set(map, key, value);
}

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
	stage->release = release;
	release->given_bytes = 0;
	stage->seen = malloc(4 * WIDTH * HEIGHT);
	CHECK(scene_open(stage->scene, stage->release->root, stage->release->root_bytes) == 0);
}

static void strike_stage(struct stage *stage)
{
	scene_destroy(stage->scene);
	gl_target_destroy(&stage->target);
	CHECK(gl_check("the test") == 0);
	headless_destroy(stage->headless);
	free(stage->seen);
}

static void draw(struct stage *stage, const struct camera *camera, const struct region *region)
{
	struct scene_mark mark = { .part = NULL };
	if (region)
		mark.region = *region;
	gl_target_bind(&stage->target);
	CHECK(scene_dispatch(stage->scene) == 0);
	scene_draw(stage->scene, camera, region ? &mark : NULL, &stage->frame);
}

/* Serves and draws until the scene says that it is settled. Returns frames. */
static int settle(struct stage *stage, const struct camera *camera, const struct region *region)
{
	for (int i = 0; i < FRAMES_MAX; i++) {
		draw(stage, camera, region);
		little_release_serve(stage->release, stage->scene, 16);
		if (stage->frame.settled) {
			CHECK(gl_target_read(&stage->target, stage->seen) == 0);
			return i;
		}
	}
	fail_msg("not settled after %d frames", FRAMES_MAX);
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

static size_t wants_left(struct stage *stage)
{
	struct message_want wants[16];
	return scene_wants(stage->scene, wants, 16);
}

static void settled_leaves_nothing_wanted_and_nothing_moving(void **state)
{
	struct stage stage;
	uint8_t *before = malloc(4 * WIDTH * HEIGHT);
	(void)state;
	raise_stage(&stage, &usual);
	settle(&stage, &usual_camera, NULL);
	memcpy(before, stage.seen, 4 * WIDTH * HEIGHT);
	CHECK(wants_left(&stage) == 0);
	CHECK(stage.frame.image_share > 0.8f && stage.frame.image_share <= 1);
	draw(&stage, &usual_camera, NULL);
	CHECK(stage.frame.settled && !stage.frame.moving);
	CHECK(gl_target_read(&stage.target, stage.seen) == 0);
	CHECK(memcmp(before, stage.seen, 4 * WIDTH * HEIGHT) == 0);
	free(before);
	strike_stage(&stage);
}

/* Row 0 is on top; what the picture does not cover is the sky. */
static void check_moved(const uint8_t *before, const uint8_t *after, const int by_px[2])
{
	for (int y = 0; y < HEIGHT; y++)
		for (int x = 0; x < WIDTH; x++) {
			const int from_x = x - by_px[0], from_y = y + by_px[1];
			const bool inside =
				from_x >= 0 && from_x < WIDTH && from_y >= 0 && from_y < HEIGHT;
			const uint8_t *pixel = after + 4 * (y * WIDTH + x);

			if (inside ? memcmp(pixel, before + 4 * (from_y * WIDTH + from_x), 4) != 0
				   : pixel[3] != 0)
				fail_msg("pixel %d, %d", x, y);
		}
}

/* At rest and moving alike: to spare the panel, the picture is drawn a little beside. */
static void a_shifted_picture_is_the_same_beside(void **state)
{
	const int shifts[][2] = { { 3, -2 }, { -4, 4 }, { 0, 0 } };
	struct camera camera = usual_camera;
	uint8_t *before = malloc(4 * WIDTH * HEIGHT);
	struct stage stage;
	(void)state;
	raise_stage(&stage, &usual);
	settle(&stage, &camera, NULL);
	memcpy(before, stage.seen, 4 * WIDTH * HEIGHT);
	for (size_t i = 0; i < ARRAY_COUNT(shifts); i++) {
		memcpy(camera.shift_px, shifts[i], sizeof(camera.shift_px));
		gl_target_bind(&stage.target);
		glClearColor(0, 0, 0, 0);
		glClear(GL_COLOR_BUFFER_BIT);
		draw(&stage, &camera, NULL);
		CHECK(stage.frame.settled && !stage.frame.moving); /* no reason to begin anew */
		CHECK(gl_target_read(&stage.target, stage.seen) == 0);
		check_moved(before, stage.seen, shifts[i]);
	}
	free(before);
	strike_stage(&stage);
}

static void polygons_want_no_images(void **state)
{
	struct stage stage;
	struct scene_options options = usual;
	(void)state;
	options.mode = SCENE_POLYGONS;
	raise_stage(&stage, &options);
	settle(&stage, &usual_camera, NULL);
	/* Root page, hierarchy page and two groups. */
	CHECK(release->given_bytes < 16384);
	CHECK(stage.frame.image_share == 0 && stage.frame.tiles_uploaded == 0);
	strike_stage(&stage);
}

static void objects_that_do_not_decode_are_not_wanted_again(void **state)
{
	struct stage stage;
	static const uint8_t rubbish[] = "this is no object of any kind";
	(void)state;
	raise_stage(&stage, &usual);
	for (int i = 0; i < 200; i++) {
		struct message_want want;
		draw(&stage, &usual_camera, NULL);
		/* From the hierarchy page on, every second object is rubbish. */
		if (scene_root(stage.scene) && i % 2 && scene_wants(stage.scene, &want, 1) == 1) {
			scene_give(stage.scene, want.hash,
				   (struct bytes){ rubbish, sizeof(rubbish) });
			for (int k = 0; k < 50; k++) {
				draw(&stage, &usual_camera, NULL);
				usleep(1000);
			}
			struct message_want again[64];
			size_t count = scene_wants(stage.scene, again, 64);
			for (size_t k = 0; k < count; k++)
				CHECK(!hash_equal(again[k].hash, want.hash));
			if (i > 20)
				break;
		} else {
			little_release_serve(release, stage.scene, 1);
		}
	}
	strike_stage(&stage);
}

static void another_release_is_shown_whole(void **state)
{
	struct stage stage;
	(void)state;
	raise_stage(&stage, &usual);
	for (int i = 0; i < 12; i++) { /* in the middle of its work */
		draw(&stage, &usual_camera, NULL);
		little_release_serve(release, stage.scene, 8);
	}
	CHECK(scene_open(stage.scene, release->root, release->root_bytes) == 0);
	CHECK(scene_root(stage.scene) == NULL);
	settle(&stage, &usual_camera, NULL);
	CHECK(psnr(&stage, &usual_camera) > 24);
	strike_stage(&stage);
}

/* For want of a picture, nothing else would ask for the root again. */
static void a_root_that_memory_was_lacking_for_is_wanted_again(void **state)
{
	struct message_want wants[4];
	struct stage stage;
	(void)state;
	raise_stage(&stage, &usual);
	map_is_full = true;
	CHECK(scene_wants(stage.scene, wants, 4) == 0 && scene_lacked_memory(stage.scene));
	map_is_full = false;
	CHECK(scene_wants(stage.scene, wants, 4) == 1 && !scene_lacked_memory(stage.scene));
	CHECK(hash_equal(wants[0].hash, release->root));
	strike_stage(&stage);
}

static void a_small_atlas_settles_too(void **state)
{
	struct stage stage;
	struct scene_options options = usual;
	(void)state;
	options.texture_budget_bytes = 1 << 20; /* sixteen tiles, the least */
	options.geometry_budget_bytes = 4096;
	raise_stage(&stage, &options);
	settle(&stage, &usual_camera, NULL);
	CHECK(stage.frame.triangles > 0);
	strike_stage(&stage);
}

static void rays_meet_what_is_shown(void **state)
{
	struct stage stage;
	float point[3];
	(void)state;
	raise_stage(&stage, &usual);
	CHECK(!scene_pick(stage.scene, &usual_camera, WIDTH / 2, HEIGHT / 2, point));
	settle(&stage, &usual_camera, NULL);
	CHECK(!scene_pick(stage.scene, &usual_camera, 2, 2, point)); /* sky */
	int met = 0;
	for (int x = 8; x < WIDTH; x += 16) {
		float direction[3], rgb[3];
		camera_ray(&usual_camera, (float)x, 180, direction);
		bool there = little_cast(usual_camera.eye_m, direction, rgb);
		CHECK(scene_pick(stage.scene, &usual_camera, (float)x, 180, point) == there);
		met += there;
	}
	CHECK(met > 10);
	/* From farther away less detail is shown, so what is measured is less exact. */
	struct camera far_off = usual_camera;
	float near_error, far_error;
	for (int k = 0; k < 3; k++)
		far_off.eye_m[k] += 9 * (far_off.eye_m[k] - far_off.target_m[k]);
	CHECK(scene_pick_surface(stage.scene, &usual_camera, WIDTH / 2, HEIGHT / 2, point,
				 &near_error));
	settle(&stage, &far_off, NULL);
	CHECK(scene_pick_surface(stage.scene, &far_off, WIDTH / 2, HEIGHT / 2, point, &far_error));
	CHECK(near_error >= 0 && far_error > near_error && far_error < 1);
	settle(&stage, &usual_camera, NULL);
	const float above[3] = { 1, 1, 3 }, down[3] = { 0, 0, -2 }, up[3] = { 0, 0, 1 };
	CHECK(fabsf(scene_clearance(stage.scene, above, down, 10) - 3) < 0.01f);
	CHECK(isinf(scene_clearance(stage.scene, above, down, 2)));
	CHECK(isinf(scene_clearance(stage.scene, above, up, 100)));
	strike_stage(&stage);
}

static uint32_t pixels_changed(const uint8_t *a, const uint8_t *b, int by)
{
	uint32_t changed = 0;
	for (int i = 0; i < WIDTH * HEIGHT; i++) {
		int most = 0;
		for (int k = 0; k < 3; k++) {
			int d = abs(a[4 * i + k] - b[4 * i + k]);
			most = d > most ? d : most;
		}
		changed += most > by;
	}
	return changed;
}

static uint32_t patches_of_sides(const struct stage *stage, enum geometry_sides sides)
{
	const struct cut *cut = &stage->scene->cut;
	uint32_t count = 0;
	for (uint32_t i = 0; i < cut->patch_count; i++)
		count += stage->scene->geometry.patches[cut->patches[i]].sides == sides;
	return count;
}

/* From within a pillar nothing but backs is seen, which from outside were left out. */
static void backs_are_drawn_where_they_show(void **state)
{
	struct scene_options options = usual;
	struct camera within = usual_camera;
	struct stage stage;
	(void)state;
	options.mode = SCENE_POLYGONS;
	memcpy(within.eye_m, (float[3]){ -4, -4, 2.5f }, sizeof(within.eye_m));
	memcpy(within.target_m, (float[3]){ 0, -4, 2.5f }, sizeof(within.target_m));
	raise_stage(&stage, &options);
	settle(&stage, &usual_camera, NULL);
	CHECK(patches_of_sides(&stage, SIDES_FRONT) > 0);
	settle(&stage, &within, NULL);
	keep_picture("within", stage.seen);
	for (int i = 0; i < WIDTH * HEIGHT; i++)
		CHECK(stage.seen[4 * i + 2] < 170); /* no sky: its blue is 180 */
	CHECK(patches_of_sides(&stage, SIDES_BOTH) > 0);
	strike_stage(&stage);
}

static void a_millimetre_changes_next_to_nothing(void **state)
{
	struct stage stage;
	uint8_t *before = malloc(4 * WIDTH * HEIGHT);
	struct camera camera = usual_camera;
	(void)state;
	raise_stage(&stage, &usual);
	settle(&stage, &camera, NULL);
	memcpy(before, stage.seen, 4 * WIDTH * HEIGHT);
	for (int step = 0; step < 3; step++) {
		camera.eye_m[0] += 0.001f;
		settle(&stage, &camera, NULL);
		CHECK(pixels_changed(before, stage.seen, 24) < WIDTH * HEIGHT / 200);
		memcpy(before, stage.seen, 4 * WIDTH * HEIGHT);
	}
	free(before);
	strike_stage(&stage);
}

/* Draws one frame from a camera that differs a little each time, as a moving eye. */
static void draw_moving(struct stage *stage, float scale, const struct region *region,
			uint8_t *rgba)
{
	static float moved_m;
	struct scene_effort effort = scene_effort_full;
	struct camera camera = usual_camera;
	effort.scale = scale;
	moved_m += 1e-5f;
	camera.eye_m[0] += moved_m;
	scene_spend(stage->scene, &effort);
	draw(stage, &camera, region);
	CHECK(stage->frame.moved);
	CHECK(gl_target_read(&stage->target, rgba) == 0);
}

/* Writes the mean of the colours and the centre of what is covered. */
static void summarise(const uint8_t *rgba, double colour[3], double centre_px[2])
{
	double covered = 0;
	memset(colour, 0, 3 * sizeof(*colour));
	centre_px[0] = centre_px[1] = 0;
	for (int i = 0; i < WIDTH * HEIGHT; i++) {
		for (int k = 0; k < 3; k++)
			colour[k] += rgba[4 * i + k] / (double)(WIDTH * HEIGHT);
		covered += rgba[4 * i + 3];
		centre_px[0] += rgba[4 * i + 3] * (double)(i % WIDTH);
		centre_px[1] += rgba[4 * i + 3] * (double)(i / WIDTH);
	}
	centre_px[0] /= covered;
	centre_px[1] /= covered;
}

static double difference(const uint8_t *a, const uint8_t *b)
{
	double sum = 0;
	for (int i = 0; i < 4 * WIDTH * HEIGHT; i++)
		sum += (a[i] - b[i]) * (a[i] - b[i]);
	return sum / (4.0 * WIDTH * HEIGHT);
}

/* At several scales, of which most do not divide the size. */
static void an_enlarged_picture_has_the_same_colours_at_the_same_place(void **state)
{
	static const float scales[] = { 0.9f, 0.75f, 0.6f, 0.5f };
	uint8_t *full = malloc(4 * WIDTH * HEIGHT), *small = malloc(4 * WIDTH * HEIGHT);
	double colour[2][3], centre_px[2][2];
	struct stage stage;
	(void)state;
	raise_stage(&stage, &usual);
	settle(&stage, &usual_camera, NULL);
	draw_moving(&stage, 1, NULL, full);
	summarise(full, colour[0], centre_px[0]);
	for (int i = 0; i < 4; i++) {
		draw_moving(&stage, scales[i], NULL, small);
		keep_picture("enlarged", small);
		summarise(small, colour[1], centre_px[1]);
		CHECK(difference(full, small) > 1); /* it is another picture */
		for (int k = 0; k < 3; k++)
			CHECK(fabs(colour[0][k] - colour[1][k]) < 0.5);
		for (int k = 0; k < 2; k++)
			CHECK(fabs(centre_px[0][k] - centre_px[1][k]) < 0.25);
	}
	free(full);
	free(small);
	strike_stage(&stage);
}

static void a_picture_is_sharp_in_the_second_frame_of_a_stop(void **state)
{
	uint8_t *full = malloc(4 * WIDTH * HEIGHT), *small = malloc(4 * WIDTH * HEIGHT);
	struct stage stage;
	(void)state;
	raise_stage(&stage, &usual);
	settle(&stage, &usual_camera, NULL);
	draw_moving(&stage, 1, NULL, full);
	draw_moving(&stage, 0.5f, NULL, small);
	const double soft = difference(full, small);
	draw(&stage, &usual_camera, NULL); /* back by a hundredth of a millimetre, and stays */
	draw(&stage, &usual_camera, NULL);
	draw(&stage, &usual_camera, NULL);
	CHECK(!stage.frame.moved);
	CHECK(gl_target_read(&stage.target, small) == 0);
	CHECK(difference(full, small) < soft / 2); /* shifted within its pixel, but sharp */
	free(full);
	free(small);
	settle(&stage, &usual_camera, NULL);
	CHECK(!stage.scene->enlargement.small.framebuffer); /* at rest it takes no memory */
	strike_stage(&stage);
}

/* Pixels of the line's own colour, which enlarging would mix with its surroundings. */
static uint32_t line_pixels(const uint8_t *rgba)
{
	uint32_t count = 0;
	for (int i = 0; i < WIDTH * HEIGHT; i++, rgba += 4)
		count += rgba[0] > 252 && abs(rgba[1] - 199) < 3 && abs(rgba[2] - 64) < 3;
	return count;
}

/* Its mask is as small as the picture. */
static void a_mark_is_as_wide_over_an_enlarged_picture(void **state)
{
	const struct region pillar = { .kind = REGION_BOX,
				       .centre_m = { 4, -4, 2.2f },
				       .half_m = { 1.2f, 1.2f, 1.7f } };
	uint8_t *full = malloc(4 * WIDTH * HEIGHT), *small = malloc(4 * WIDTH * HEIGHT);
	struct stage stage;
	(void)state;
	raise_stage(&stage, &usual);
	settle(&stage, &usual_camera, NULL);
	draw_moving(&stage, 1, &pillar, full);
	draw_moving(&stage, 0.5f, &pillar, small);
	keep_picture("enlarged-mark", small);
	CHECK(difference(full, small) > 1);
	CHECK(line_pixels(full) > 150);
	CHECK(abs((int)line_pixels(full) - (int)line_pixels(small)) <= (int)line_pixels(full) / 10);
	free(full);
	free(small);
	strike_stage(&stage);
}

static void a_mark_draws_its_border_and_leaves_the_rest(void **state)
{
	struct stage stage;
	uint8_t *plain = malloc(4 * WIDTH * HEIGHT);
	const struct region pillar = {
		.kind = REGION_PRISM,
		.floor_m = 0.5f,
		.roof_m = 4,
		.corner_count = 4,
		.corners_m = { { 2.8f, -5.2f }, { 5.2f, -5.2f }, { 5.2f, -2.8f }, { 2.8f, -2.8f } }
	};
	(void)state;
	raise_stage(&stage, &usual);
	settle(&stage, &usual_camera, NULL);
	memcpy(plain, stage.seen, 4 * WIDTH * HEIGHT);
	settle(&stage, &usual_camera, &pillar);
	keep_picture("mark", stage.seen);
	uint32_t bold = pixels_changed(plain, stage.seen, 60);
	uint32_t any = pixels_changed(plain, stage.seen, 2);
	CHECK(bold > 150);
	CHECK(any > bold && any < WIDTH * HEIGHT / 4);
	settle(&stage, &usual_camera, NULL);
	CHECK(pixels_changed(plain, stage.seen, 16) == 0);
	free(plain);
	strike_stage(&stage);
}

/* Up to three pictures of a release, a millimetre apart, the last with a mark. Returns the quality
 * of the first. */
enum { SITE_PICTURES = 3, SITE_BYTES = 4 * WIDTH * HEIGHT };

static double take_pictures(uint8_t *out, int count, const int32_t base[3], double step_m,
			    enum scene_mode mode, bool wide)
{
	static const int32_t none[3];
	const struct region ball = { .kind = REGION_SPHERE,
				     .centre_m = { 3, -5, 3 },
				     .radius_m = 2 };
	struct little_release *before = release;
	struct scene_options options = usual;
	struct camera camera = usual_camera;
	struct stage stage;
	double quality = 0;
	little_move(base, step_m);
	release = little_release_make(2);
	options.mode = mode;
	raise_stage(&stage, &options);
	for (int i = 0; i < count; i++) {
		camera.eye_m[0] += 0.001f;
		settle(&stage, &camera, i == 2 ? &ball : NULL);
		memcpy(out + i * SITE_BYTES, stage.seen, SITE_BYTES);
		quality = i == 0 ? psnr(&stage, &camera) : quality;
	}
	const struct geometry_patch *floor = &stage.scene->geometry.patches[0];
	CHECK((floor->wide != 0) == wide && (floor->content.bvh.base[0] != 0) == (base[0] != 0));
	strike_stage(&stage);
	little_release_free(release);
	release = before;
	little_move(none, 1.0 / 4095);
	return quality;
}

/* The model stands a kilometre from the lattice's origin: with places that count from a base, and
 * on a lattice so fine that the floor is a wide patch. A crack or a jitter would show as pixels
 * that differ from the same model at the origin. */
static void the_far_corner_of_a_site_looks_like_the_near_one(void **state)
{
	static const int32_t near[3] = { 0, 0, 0 }, far[3] = { 4000000, 3900000, 70000 };
	static const int32_t fine[3] = { 16000000, 100000, 15900000 };
	uint8_t *was = malloc(SITE_PICTURES * SITE_BYTES), *is = malloc(SITE_PICTURES * SITE_BYTES);
	(void)state;
	for (int images = 0; images < 2; images++) {
		const enum scene_mode mode = images ? SCENE_LUMIGRAPH : SCENE_POLYGONS;
		const int count = images ? 1 : SITE_PICTURES;
		double quality = take_pictures(was, count, near, 1.0 / 4095, mode, false);
		for (int wide = images; wide < 2; wide++) {
			double other = take_pictures(is, count, wide ? fine : far,
						     1.0 / (wide ? 16380 : 4095), mode, wide);
			print_message("images %d, wide %d: %.2f dB at the origin, %.2f far away\n",
				      images, wide, quality, other);
			/* Which images are blended depends on the order in which they came, and
			 * which back faces were noticed on when visibility passes were drawn. */
			CHECK(fabs(other - quality) < (images ? 1 : 0.1));
			for (int i = 0; i < SITE_PICTURES && !images; i++)
				CHECK(pixels_changed(was + i * SITE_BYTES, is + i * SITE_BYTES,
						     24) < 20);
		}
	}
	keep_picture("site", is);
	free(was);
	free(is);
}

static void regions_know_what_is_in_them(void **state)
{
	(void)state;
	const struct region sphere = { .kind = REGION_SPHERE,
				       .centre_m = { 1, 2, 3 },
				       .radius_m = 2 };
	const struct region box = {
		.kind = REGION_BOX, .centre_m = { 0, 0, 0 }, .half_m = { 4, 1, 1 }, .turn_deg = 90
	};
	/* An L: not convex. */
	const struct region prism = {
		.kind = REGION_PRISM,
		.floor_m = 0,
		.roof_m = 2,
		.corner_count = 6,
		.corners_m = { { 0, 0 }, { 4, 0 }, { 4, 1 }, { 1, 1 }, { 1, 4 }, { 0, 4 } }
	};
	CHECK(region_contains(&sphere, (float[]){ 1, 3.9f, 3 }));
	CHECK(!region_contains(&sphere, (float[]){ 1, 4.1f, 3 }));
	CHECK(region_contains(&box, (float[]){ 0, 3.5f, 0 }));
	CHECK(!region_contains(&box, (float[]){ 3.5f, 0, 0 }));
	CHECK(region_contains(&prism, (float[]){ 3, 0.5f, 1 }));
	CHECK(region_contains(&prism, (float[]){ 0.5f, 3, 1 }));
	CHECK(!region_contains(&prism, (float[]){ 3, 3, 1 }));
	CHECK(!region_contains(&prism, (float[]){ 3, 0.5f, 2.5f }));
	const struct region none = { .kind = REGION_POINT };
	CHECK(!region_contains(&none, (float[]){ 0, 0, 0 }));
}

static int make_release(void **state)
{
	(void)state;
	release = little_release_make(4);
	return 0;
}

static int free_release(void **state)
{
	(void)state;
	little_release_free(release);
	return 0;
}

/* test_scene [NAME]: that test alone. */
int main(int argc, char **argv)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(images_show_what_vertices_cannot),
		cmocka_unit_test(settled_leaves_nothing_wanted_and_nothing_moving),
		cmocka_unit_test(a_shifted_picture_is_the_same_beside),
		cmocka_unit_test(polygons_want_no_images),
		cmocka_unit_test(objects_that_do_not_decode_are_not_wanted_again),
		cmocka_unit_test(another_release_is_shown_whole),
		cmocka_unit_test(a_root_that_memory_was_lacking_for_is_wanted_again),
		cmocka_unit_test(a_small_atlas_settles_too),
		cmocka_unit_test(rays_meet_what_is_shown),
		cmocka_unit_test(backs_are_drawn_where_they_show),
		cmocka_unit_test(a_millimetre_changes_next_to_nothing),
		cmocka_unit_test(an_enlarged_picture_has_the_same_colours_at_the_same_place),
		cmocka_unit_test(a_picture_is_sharp_in_the_second_frame_of_a_stop),
		cmocka_unit_test(a_mark_is_as_wide_over_an_enlarged_picture),
		cmocka_unit_test(a_mark_draws_its_border_and_leaves_the_rest),
		cmocka_unit_test(the_far_corner_of_a_site_looks_like_the_near_one),
		cmocka_unit_test(regions_know_what_is_in_them),
	};
	if (argc > 1)
		cmocka_set_test_filter(argv[1]);
	return cmocka_run_group_tests(tests, make_release, free_release);
}
