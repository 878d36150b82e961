/* Pictures and rays of a scene that is looked at by a raking light and cut open, against what the
 * boxes of the little release say. */
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "format/picture.h"
#include "geometry/solid_space.h"
#include "geometry/substance.h"
#include "geometry/vec.h"
#include "render/display/gl.h"
#include "render/display/headless.h"
#include "render/scene/scene_parts.h"
#include "tests/render/scene/little_solid.h"

enum { WIDTH = 480, HEIGHT = 270, PIXELS = WIDTH * HEIGHT, FRAMES_MAX = 3000 };

static struct little_release *release; /* made once for all tests */
static struct hash spoiled_root;       /* of the same with an octree that is damaged */

struct stage {
	struct headless *headless;
	struct gl_target target;
	struct scene *scene;
	struct scene_frame frame;
	uint8_t seen[4 * PIXELS];
};

static struct stage stage;

static const struct scene_options usual = {
	.mode = SCENE_LUMIGRAPH,
	.texture_budget_bytes = 96 << 20,
	.geometry_budget_bytes = 64 << 20,
	.triangle_budget = 200000,
	.patch_error_px = 1,
	.upload_budget_us = 20000,
	.worker_count = 2,
};

static const struct camera eye = {
	.eye_m = { 10, -12, 5 },
	.target_m = { 0, 0, 1.5f },
	.up = { 0, 0, 1 },
	.fov_deg = 45,
	.near_m = 0.1f,
	.far_m = 200,
	.width_px = WIDTH,
	.height_px = HEIGHT,
};

static int raise_stage(void **state)
{
	(void)state;
	memset(&stage, 0, sizeof(stage));
	CHECK(headless_create(&stage.headless) == 0);
	CHECK(gl_target_create(&stage.target, WIDTH, HEIGHT) == 0);
	CHECK(scene_create(&stage.scene, &usual) == 0);
	return scene_open(stage.scene, release->root, release->root_bytes);
}

static int strike_stage(void **state)
{
	(void)state;
	scene_destroy(stage.scene);
	gl_target_destroy(&stage.target);
	CHECK(gl_check("the test") == 0);
	headless_destroy(stage.headless);
	return 0;
}

static void draw(void)
{
	gl_target_bind(&stage.target);
	CHECK(scene_dispatch(stage.scene) == 0);
	scene_draw(stage.scene, &eye, NULL, &stage.frame);
	little_release_serve(release, stage.scene, 16);
}

static int settle(const struct scene_tools *tools, const char *name)
{
	char path[512];
	struct buffer file;
	int frames = 0;

	scene_use(stage.scene, tools);
	for (stage.frame.settled = false; !stage.frame.settled; frames++) {
		CHECK(frames < FRAMES_MAX);
		draw();
	}
	CHECK(gl_target_read(&stage.target, stage.seen) == 0);
	if (!getenv("KEEP_PICTURES"))
		return frames;
	buffer_init(&file, 64 << 20);
	CHECK(picture_encode_png(&file, &(struct picture){ WIDTH, HEIGHT, stage.seen }) == 0);
	snprintf(path, sizeof(path), "%s/%s.png", getenv("KEEP_PICTURES"), name);
	CHECK(bytes_write_file(buffer_bytes(&file), path) == 0);
	buffer_finish(&file);
	return frames;
}

/* The nearest box that the ray meets at or past least: where, and on which side (0 to 5, -1: it
 * begins within). INFINITY: none. */
static float cast(const float from[3], const float direction[3], float least, int *side)
{
	float nearest = INFINITY;

	for (int b = 0; b < LITTLE_BOXES; b++) {
		float low = 0, high = INFINITY;
		int entered = -1;

		for (int i = 0; i < 3; i++) {
			const float d = fabsf(direction[i]) > 1e-9f ? direction[i] : 1e-9f;
			const float a = (little_boxes[b][0][i] - from[i]) / d;
			const float c = (little_boxes[b][1][i] - from[i]) / d;

			if (fminf(a, c) > low) {
				low = fminf(a, c);
				entered = 2 * i + (c < a);
			}
			high = fminf(high, fmaxf(a, c));
		}
		if (low > high || high < least || fmaxf(low, least) >= nearest)
			continue;
		nearest = fmaxf(low, least);
		*side = low < least ? -1 : entered;
	}
	return nearest;
}

static struct scene_tools cut_through_pillars(void)
{
	struct scene_tools tools = { .section = { .on = false } };

	section_init(&tools.section, (float[3]){ -8, -8, -0.5f }, (float[3]){ 8, 8, 5 });
	section_face(&tools.section, eye.eye_m, (float[3]){ 0, 1, 0 });
	section_push(&tools.section, 4); /* y = -4: through the pillars in front */
	return tools;
}

static bool is_section(const uint8_t *pixel)
{
	return abs(pixel[0] - 158) < 12 && abs(pixel[1] - 71) < 12 && abs(pixel[2] - 38) < 12;
}

static void what_is_cut_shows_as_section_and_what_was_hidden_as_itself(void **state)
{
	const struct scene_tools tools = cut_through_pillars();
	uint32_t cut = 0, wrong = 0, sky = 0, shown = 0, off = 0;
	(void)state;

	settle(&tools, "section");
	CHECK(stage.frame.image_share > 0.5f); /* images are asked for what lies behind, too */
	for (int at = 0; at < PIXELS; at++) {
		const float x = (float)(at % WIDTH) + 0.5f, y = (float)(at / WIDTH) + 0.5f;
		const uint8_t *pixel = stage.seen + 4 * at;
		float direction[3], least = 0, most = INFINITY, rgb[3], point[3];
		int side = 0;

		camera_ray(&eye, x, y, direction);
		const bool kept = section_clip(&tools.section, eye.eye_m, direction, &least, &most);
		const float distance = kept ? cast(eye.eye_m, direction, least, &side) : INFINITY;
		if (!isfinite(distance) || distance > most) {
			sky++;
			wrong += pixel[3] > 127;
			continue;
		}
		wrong += (side < 0) != is_section(pixel);
		cut += side < 0;
		if (side < 0)
			continue;
		vec_add_scaled(point, eye.eye_m, distance - 1e-3f, direction);
		little_colour(point, rgb);
		shown++;
		off += fabsf(rgb[0] - pixel[0]) > 40;
	}
	print_message("%u of section, %u shown, %u sky; %u wrong, %u of another colour\n", cut,
		      shown, sky, wrong, off);
	CHECK(cut > 1000 && sky > 10000 && shown > 10000);
	CHECK(wrong < PIXELS / 100 && off < shown / 4);
}

/* The same section of laterite: where it was red, the substance where the ray meets the plane. */
static void a_cut_shows_the_substance_that_the_content_names(void **state)
{
	static uint8_t red[4 * PIXELS];
	const struct scene_tools none = { .section = { .on = false } };
	struct scene_tools tools = cut_through_pillars();
	double sum = 0;
	uint32_t count = 0;
	struct view view;
	(void)state;

	settle(&tools, "red");
	memcpy(red, stage.seen, sizeof(red));
	settle(&none, "whole");
	stage.scene->root.cut = SUBSTANCE_LATERITE;
	settle(&tools, "laterite");
	view_from_camera(&view, &eye);
	for (int i = 0; i < PIXELS; i++) {
		float direction[3], place[3], truth[3], far_m;

		/* exactly red is what lies all within the face, and not at its outline */
		if (abs(red[4 * i] - 158) > 1 || abs(red[4 * i + 1] - 71) > 1)
			continue;
		camera_ray(&eye, (float)(i % WIDTH) + 0.5f, (float)(i / WIDTH) + 0.5f, direction);
		far_m = (-4 - eye.eye_m[1]) / direction[1]; /* to y = -4 */
		for (int k = 0; k < 3; k++)
			place[k] = eye.eye_m[k] + far_m * direction[k];
		substance_colour(truth, SUBSTANCE_LATERITE, place, far_m / view.focal_px);
		for (int k = 0; k < 3; k++) {
			const double d = 255 * (double)truth[k] - stage.seen[4 * i + k];

			sum += d * d;
		}
		count++;
	}
	stage.scene->root.cut = SUBSTANCE_NONE;
	print_message("%u pixels, %.1f dB\n", count, 10 * log10(255.0 * 255 * 3 * count / sum));
	CHECK(count > PIXELS / 50 && 10 * log10(255.0 * 255 * 3 * count / sum) > 30);
}

/* With every set of tools and fog, within what every board has. */
static void every_program_of_a_cut_substance_is_built(void **state)
{
	struct scene *scene = stage.scene;
	struct root_page root;
	struct view view;
	(void)state;

	settle(&(struct scene_tools){ .rake = { .on = false } }, "before");
	root = scene->root;
	root.cut = SUBSTANCE_MARBLE;
	for (unsigned tools = 0; tools < SURFACE_TOOLS; tools++) {
		struct surface_frame frame = {
			.view = &view,
			.root = &root,
			.tiles = &scene->tiles,
			.depth = &scene->depth,
			.repository = &scene->repository,
			.rake = { .on = tools & SURFACE_RAKE },
			.fog = { .share = tools & SURFACE_FOG ? 1 : 0, .range_m = 9 },
		};

		view_from_camera(&view, &eye);
		if (tools & SURFACE_CUT)
			view.cut[1] = 1;
		CHECK(surface_tools(&frame) == tools);
		for (int p = 0; p < SURFACE_PROGRAMS; p++) {
			surface_begin(&scene->surface, &frame, p);
			CHECK(!scene->surface.lacks[tools]);
		}
	}
}

static void rays_go_through_what_is_cut_away(void **state)
{
	const struct scene_tools none = { .section = { .on = false } };
	const struct scene_tools tools = cut_through_pillars();
	uint32_t through = 0;
	float point[3];
	(void)state;

	settle(&none, "whole");
	for (int y = 5; y < HEIGHT; y += 10) {
		for (int x = 5; x < WIDTH; x += 10) {
			float before[3];

			scene_use(stage.scene, &none);
			if (!scene_pick(stage.scene, &eye, (float)x, (float)y, before))
				continue;
			scene_use(stage.scene, &tools);
			const bool there = scene_pick(stage.scene, &eye, (float)x, (float)y, point);
			CHECK(!there || point[1] > -4.001f);
			if (section_keeps(&tools.section, before))
				CHECK(there && vec_distance(point, before) < 1e-3f);
			else
				through++;
		}
	}
	CHECK(through > 50);
	/* What is cut away is no wall. */
	scene_use(stage.scene, &tools);
	CHECK(isinf(
		scene_clearance(stage.scene, (float[3]){ 4, -8, 2 }, (float[3]){ 0, 1, 0 }, 3.5f)));
	scene_use(stage.scene, &none);
	CHECK(fabsf(scene_clearance(stage.scene, (float[3]){ 4, -8, 2 }, (float[3]){ 0, 1, 0 },
				    3.5f) -
		    3) < 0.02f);
}

static void an_eye_stops_before_stone_but_not_before_what_is_cut_away(void **state)
{
	const struct scene_tools none = { .section = { .on = false } };
	const struct scene_tools tools = cut_through_pillars();
	const float from[3] = { 4, -8, 2 }, north[3] = { 0, 1, 0 }, up[3] = { 0, 0, 1 };
	const float in_pillar[3] = { 4, -4.5f, 2 };
	const struct solid *solid;
	float reach;
	int axis;
	(void)state;

	CHECK(!scene_solid(stage.scene));
	settle(&none, "octree");
	solid = scene_solid(stage.scene);
	CHECK(solid && solid_is_free(solid, from) && !solid_is_free(solid, in_pillar));
	/* The pillar is 3 m away, as rays say. */
	reach = scene_reach(stage.scene, from, north, 9, 0, &axis);
	CHECK(reach <= 3 - solid->room_m && reach > 3 - solid->room_m - 2 * solid->cell_m);
	CHECK(axis == 1);
	CHECK(isinf(scene_reach(stage.scene, from, north, 2, 0, &axis)));
	CHECK(scene_reach(stage.scene, in_pillar, up, 1, 0, &axis) == 0);
	scene_use(stage.scene, &tools);
	CHECK(isinf(scene_reach(stage.scene, from, north, 3.5f, 0, &axis)));
	CHECK(isinf(scene_reach(stage.scene, in_pillar, up, 1, 0, &axis)));
	reach = scene_reach(stage.scene, from, north, 9, 0, &axis);
	CHECK(reach >= 3.99f && reach < 9);
}

static void a_damaged_octree_leaves_the_rays(void **state)
{
	const float from[3] = { 4, -8, 2 }, north[3] = { 0, 1, 0 };
	const struct scene_tools none = { .section = { .on = false } };
	int axis;
	(void)state;

	CHECK(scene_open(stage.scene, spoiled_root, release->root_bytes) == 0);
	settle(&none, "rays");
	CHECK(!scene_solid(stage.scene) && scene_refused(stage.scene) == 1);
	CHECK(fabsf(scene_reach(stage.scene, from, north, 9, 0.3f, &axis) - 2.7f) < 0.02f);
	CHECK(isinf(scene_reach(stage.scene, from, north, 2.6f, 0.3f, &axis)));
	CHECK(axis == -1);
}

static void the_light_is_what_its_twin_says(void **state)
{
	static uint8_t before[4 * PIXELS];
	const struct scene_tools none = { .rake = { .on = false } };
	struct scene_tools tools = { .rake = { .on = true } };
	const struct root_page *root;
	struct view view;
	(void)state;

	settle(&none, "unlit");
	memcpy(before, stage.seen, sizeof(before));
	root = scene_root(stage.scene);
	view_from_camera(&view, &eye);
	for (int where = 0; where < 4; where++) {
		double sum = 0, off = 0;
		uint32_t count = 0;
		float to[3];

		rake_place(&tools.rake, cosf((float)where * 1.571f), sinf((float)where * 1.571f));
		rake_direction(&tools.rake, view.right, view.up, view.forward, to);
		settle(&tools, (const char *[]){ "right", "above", "left", "below" }[where]);
		for (int at = 0; at < PIXELS; at++) {
			float direction[3], normal[3] = { 0 };
			int side = -1;

			camera_ray(&eye, (float)(at % WIDTH) + 0.5f, (float)(at / WIDTH) + 0.5f,
				   direction);
			if (!isfinite(cast(eye.eye_m, direction, 0, &side)) || side < 0)
				continue;
			normal[side / 2] = side & 1 ? 1 : -1;
			const float light = rake_light_at(normal, 1, root->sun, root->lit, to);
			const float want = fminf((float)before[4 * at] * light, 255);

			off += fabs((double)want - stage.seen[4 * at]);
			sum += want;
			count++;
		}
		print_message("light %d: %.2f of 255 off in the mean, of %.1f\n", where,
			      off / count, sum / count);
		CHECK(count > PIXELS / 5 && off / count < 3);
	}
}

static void a_light_that_is_moved_moves_the_picture_and_one_at_rest_does_not(void **state)
{
	struct scene_tools tools = { .rake = { .on = true, .at = { 0.5f, 0 } } };
	(void)state;

	settle(&tools, "rest");
	scene_use(stage.scene, &tools); /* the same once more */
	draw();
	CHECK(stage.frame.settled && !stage.frame.moving);
	rake_place(&tools.rake, 0.6f, 0);
	scene_use(stage.scene, &tools);
	draw();
	CHECK(!stage.frame.settled && stage.frame.moving);
	CHECK(settle(&tools, "rest") <= 40); /* nothing but its frames at rest */
	tools = cut_through_pillars();
	settle(&tools, "rest");
	scene_use(stage.scene, &tools);
	draw();
	CHECK(stage.frame.settled && !stage.frame.moving);
	section_push(&tools.section, 0.1f);
	scene_use(stage.scene, &tools);
	draw();
	CHECK(stage.frame.moving);
}

static double psnr(const uint8_t *rgba)
{
	static uint8_t truth[3 * PIXELS];
	double sum = 1;

	little_truth(&eye, truth);
	for (int i = 0; i < 3 * PIXELS; i++) {
		const double d = (double)rgba[i / 3 * 4 + i % 3] - truth[i];

		sum += d * d;
	}
	return 10 * log10(255.0 * 255.0 * 3 * PIXELS / sum);
}

static void without_tools_the_picture_is_what_it_was(void **state)
{
	static uint8_t before[4 * PIXELS];
	const struct scene_tools none = { .rake = { .on = false } };
	struct scene_tools tools = cut_through_pillars();
	(void)state;

	settle(&none, "before");
	memcpy(before, stage.seen, sizeof(before));
	for (int p = 0; p < SURFACE_PROGRAMS; p++) /* and no program was made for them */
		for (int t = 1; t < SURFACE_TOOLS; t++)
			CHECK(stage.scene->surface.of[t][p].program == 0);
	tools.rake.on = true;
	settle(&tools, "both");
	CHECK(memcmp(before, stage.seen, sizeof(before)) != 0);
	settle(&none, "after");
	/* A little less: which tiles are there depends on what was looked at between, as after a
	 * way of the eye. */
	print_message("%.2f dB before, %.2f after\n", psnr(before), psnr(stage.seen));
	CHECK(psnr(stage.seen) > psnr(before) - 1.5);
	for (uint32_t p = 0; p < stage.scene->hierarchy.patch_count; p++)
		CHECK(stage.scene->geometry.patches[p].sides != SIDES_BOTH);
}

#define ON_A_STAGE(test) cmocka_unit_test_setup_teardown(test, raise_stage, strike_stage)

int main(void)
{
	const struct CMUnitTest tests[] = {
		ON_A_STAGE(what_is_cut_shows_as_section_and_what_was_hidden_as_itself),
		ON_A_STAGE(a_cut_shows_the_substance_that_the_content_names),
		ON_A_STAGE(every_program_of_a_cut_substance_is_built),
		ON_A_STAGE(rays_go_through_what_is_cut_away),
		ON_A_STAGE(an_eye_stops_before_stone_but_not_before_what_is_cut_away),
		ON_A_STAGE(a_damaged_octree_leaves_the_rays),
		ON_A_STAGE(the_light_is_what_its_twin_says),
		ON_A_STAGE(a_light_that_is_moved_moves_the_picture_and_one_at_rest_does_not),
		ON_A_STAGE(without_tools_the_picture_is_what_it_was),
	};
	struct hash plain_root;
	uint32_t plain_bytes;
	int failed;

	release = little_release_make(4);
	plain_root = release->root;
	plain_bytes = release->root_bytes;
	little_solid(release, true);
	spoiled_root = release->root;
	release->root = plain_root;
	release->root_bytes = plain_bytes;
	little_solid(release, false);
	failed = cmocka_run_group_tests(tests, NULL, NULL);
	little_release_free(release);
	return failed;
}
