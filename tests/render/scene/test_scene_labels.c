/* Labels in the scene: fetched after what is to be seen, they say what was touched. */
#include <errno.h>
#include <stdio.h>

#include "render/display/gl.h"
#include "render/display/headless.h"
#include "render/scene/scene_parts.h"
#include "tests/render/scene/little_labels.h"

enum { WIDTH = 480, HEIGHT = 270, FRAMES_MAX = 3000 };

static const struct scene_options usual = {
	.mode = SCENE_POLYGONS,
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

/* Over the nearest pillar's edge and the floor beside it. */
static const struct region ball = { .kind = REGION_SPHERE,
				    .centre_m = { 4, -5, 1 },
				    .radius_m = 2 };

static struct little_release *release; /* made once for all tests */
static struct hash root_without_labels;
static uint32_t bytes_without_labels;

struct stage {
	struct headless *headless;
	struct gl_target target;
	struct scene *scene;
	struct scene_frame frame;
};

static void raise_stage(struct stage *stage, bool labels, bool spoiled)
{
	*stage = (struct stage){ 0 };
	release->root = root_without_labels;
	release->root_bytes = bytes_without_labels;
	if (labels)
		little_label(release, "ball", &ball, spoiled);
	CHECK(headless_create(&stage->headless) == 0);
	CHECK(gl_target_create(&stage->target, WIDTH, HEIGHT) == 0);
	CHECK(scene_create(&stage->scene, &usual) == 0);
	CHECK(scene_open(stage->scene, release->root, release->root_bytes) == 0);
}

static void strike_stage(struct stage *stage)
{
	scene_destroy(stage->scene);
	gl_target_destroy(&stage->target);
	CHECK(gl_check("the test") == 0);
	headless_destroy(stage->headless);
}

static void draw(struct stage *stage)
{
	gl_target_bind(&stage->target);
	CHECK(scene_dispatch(stage->scene) == 0);
	scene_draw(stage->scene, &usual_camera, NULL, &stage->frame);
}

/* The settled picture of it goes to seen, unless that is NULL. */
static void settle_with(struct stage *stage, const struct camera *camera,
			const struct scene_mark *mark, uint8_t *seen)
{
	for (int i = 0; i < FRAMES_MAX; i++) {
		gl_target_bind(&stage->target);
		CHECK(scene_dispatch(stage->scene) == 0);
		scene_draw(stage->scene, camera, mark, &stage->frame);
		little_release_serve(release, stage->scene, 1);
		if (!stage->frame.settled)
			continue;
		if (seen)
			CHECK(gl_target_read(&stage->target, seen) == 0);
		return;
	}
	fail_msg("not settled after %d frames", FRAMES_MAX);
}

static void settle(struct stage *stage)
{
	settle_with(stage, &usual_camera, NULL, NULL);
}

static void a_touch_is_answered_as_the_region_would(void **state)
{
	struct stage stage;
	uint32_t within = 0, without = 0;

	(void)state;
	raise_stage(&stage, true, false);
	settle(&stage);
	for (int y = 0; y < HEIGHT; y += 3)
		for (int x = 0; x < WIDTH; x += 3) {
			float px = (float)x + 0.5f, py = (float)y + 0.5f, at[3], away;
			const char *part = scene_part(stage.scene, &usual_camera, px, py);

			if (!scene_pick(stage.scene, &usual_camera, px, py, at)) {
				CHECK(part == NULL);
				continue;
			}
			CHECK(part != NULL);
			away = region_distance(&ball, at);
			if (fabsf(away) < 0.03f)
				continue;
			if ((strcmp(part, "ball") == 0) != (away < 0) ||
			    (away > 0 && strcmp(part, "") != 0))
				fail_msg("%d %d: \"%s\", %g m from the outline", x, y, part,
					 (double)away);
			within += away < 0;
			without += away > 0;
		}
	CHECK(within > 50 && without > 1000);
	strike_stage(&stage);
}

static void labels_come_after_what_is_to_be_seen(void **state)
{
	struct stage stage;
	struct message_want wants[32];

	(void)state;
	raise_stage(&stage, true, false);
	for (int i = 0; i < FRAMES_MAX; i++) {
		size_t count;

		draw(&stage);
		count = scene_wants(stage.scene, wants, 32);
		/* Nothing is answered by what is wanted last. */
		if (count > 0 && wants[0].priority == 1)
			break;
		CHECK(scene_part(stage.scene, &usual_camera, WIDTH / 2, HEIGHT / 2) == NULL);
		little_release_serve(release, stage.scene, 1);
		CHECK(!stage.frame.settled);
	}
	CHECK(stage.scene->geometry.loaded[0]);
	settle(&stage);
	CHECK(scene_part(stage.scene, &usual_camera, WIDTH / 2, HEIGHT / 2) != NULL);
	strike_stage(&stage);
}

static void a_release_without_labels_leaves_it_to_regions(void **state)
{
	struct stage stage;

	(void)state;
	raise_stage(&stage, false, false);
	settle(&stage);
	CHECK(scene_part(stage.scene, &usual_camera, WIDTH / 2, HEIGHT / 2) == NULL);
	strike_stage(&stage);
}

static void labels_that_do_not_decode_are_not_wanted_again(void **state)
{
	struct stage stage;

	(void)state;
	raise_stage(&stage, true, true);
	settle(&stage);
	CHECK(scene_refused(stage.scene) > 0);
	CHECK(scene_part(stage.scene, &usual_camera, WIDTH / 2, HEIGHT / 2) == NULL);
	strike_stage(&stage);
}

static uint64_t bytes_of_labels(const struct stage *stage)
{
	uint64_t bytes = 0;

	for (uint32_t g = 0; g < stage->scene->hierarchy.group_count; g++)
		bytes += label_group_bytes(&stage->scene->geometry.labels[g]);
	return bytes;
}

static void labels_go_with_their_geometry(void **state)
{
	struct stage stage;
	struct scene_memory before, after;
	uint64_t labels;

	(void)state;
	raise_stage(&stage, true, false);
	settle(&stage);
	scene_memory(stage.scene, &before);
	labels = bytes_of_labels(&stage);
	CHECK(labels > 0 && before.geometry_bytes > labels);
	CHECK(scene_open(stage.scene, release->root, release->root_bytes) == 0);
	scene_memory(stage.scene, &after);
	CHECK(after.geometry_bytes == 0);
	settle(&stage);
	scene_memory(stage.scene, &after);
	/* How many groups were in sight when labels were wanted is a matter of time. */
	CHECK(after.geometry_bytes - bytes_of_labels(&stage) == before.geometry_bytes - labels);
	strike_stage(&stage);
}

/* ---- the border */

static const struct scene_mark marked = { .part = "ball" };

static int difference(const uint8_t *a, const uint8_t *b, int x, int y)
{
	int most = 0;

	for (int k = 0; k < 3; k++) {
		int by = abs(a[4 * (y * WIDTH + x) + k] - b[4 * (y * WIDTH + x) + k]);

		most = by > most ? by : most;
	}
	return most;
}

static void an_area_ends_where_the_region_ends(void **state)
{
	struct stage stage;
	uint32_t border = 0, corners = 0;

	(void)state;
	raise_stage(&stage, true, false);
	settle(&stage);
	const struct geometry *geometry = &stage.scene->geometry;
	for (uint32_t i = 0; i < stage.scene->cut.patch_count; i++) {
		const uint32_t p = stage.scene->cut.patches[i];
		const uint32_t g = stage.scene->hierarchy.patches[p].group;
		struct part_area area;

		CHECK(part_area_create(&area, &geometry->patches[p].content.bvh,
				       &geometry->labels[g],
				       p - stage.scene->hierarchy.groups[g].first_patch, 0) == 0);
		for (uint32_t k = 0; k < area.within_count; k++) {
			float at[3], distance;

			for (int x = 0; x < 3; x++)
				at[x] = (float)(little_lattice.origin_m[x] +
						little_lattice.step_m * (double)area.within[k][x]);
			distance = region_distance(&ball, at);
			CHECK(distance < 0.03f);
			border += distance > -0.03f;
		}
		corners += area.whole_count + area.within_count;
		part_area_finish(&area);
	}
	CHECK(border > 100 && corners > 150);
	strike_stage(&stage);
}

/* Straight down on the southern end of the circle on the floor, where it runs across the picture:
 * the line's pixels in the middle column. */
static int pixels_across(struct stage *stage, float height_m)
{
	struct camera camera = usual_camera;
	uint8_t *plain = malloc(4 * WIDTH * HEIGHT), *bold = malloc(4 * WIDTH * HEIGHT);
	const float south = -5 - sqrtf(3);
	int count = 0;

	memcpy(camera.eye_m, (float[3]){ 4, south, height_m }, sizeof(camera.eye_m));
	memcpy(camera.target_m, (float[3]){ 4, south, 0 }, sizeof(camera.target_m));
	memcpy(camera.up, (float[3]){ 0, 1, 0 }, sizeof(camera.up));
	settle_with(stage, &camera, NULL, plain);
	settle_with(stage, &camera, &marked, bold);
	for (int y = HEIGHT / 2 - 12; y < HEIGHT / 2 + 12; y++)
		count += difference(plain, bold, WIDTH / 2, y) > 70;
	free(plain);
	free(bold);
	return count;
}

static void the_border_is_as_bold_from_near_as_from_afar(void **state)
{
	static const float heights_m[] = { 0.7f, 2, 6, 20 };
	struct stage stage;

	(void)state;
	raise_stage(&stage, true, false);
	for (size_t i = 0; i < sizeof(heights_m) / sizeof(heights_m[0]); i++) {
		int across = pixels_across(&stage, heights_m[i]);

		if (across < 4 || across > 8)
			fail_msg("%d pixels from %g m", across, (double)heights_m[i]);
	}
	strike_stage(&stage);
}

/* From behind the pillar, whose back is none of the part. */
static void the_model_hides_the_border(void **state)
{
	struct stage stage;
	struct camera camera = usual_camera;
	uint8_t *plain = malloc(4 * WIDTH * HEIGHT), *bold = malloc(4 * WIDTH * HEIGHT);
	uint32_t hidden = 0, shown = 0;

	(void)state;
	memcpy(camera.eye_m, (float[3]){ 4, 3, 3 }, sizeof(camera.eye_m));
	memcpy(camera.target_m, (float[3]){ 4, -5, 1 }, sizeof(camera.target_m));
	raise_stage(&stage, true, false);
	settle_with(&stage, &camera, NULL, plain);
	settle_with(&stage, &camera, &marked, bold);
	for (int y = 0; y < HEIGHT; y++)
		for (int x = 0; x < WIDTH; x++) {
			float at[3];

			if (!scene_pick(stage.scene, &camera, (float)x + 0.5f, (float)y + 0.5f, at))
				continue;
			shown += difference(plain, bold, x, y) > 70;
			/* The ball touches the pillar's back in one place. */
			if (fabsf(at[1] + 3) > 0.01f || fabsf(at[0] - 4) > 0.85f || at[2] < 0.2f ||
			    fabsf(at[2] - 1) < 0.6f)
				continue;
			CHECK(difference(plain, bold, x, y) < 16);
			hidden++;
		}
	CHECK(hidden > 1000 && shown > 50);
	free(plain);
	free(bold);
	strike_stage(&stage);
}

/* The middle of the picture, in which each pixel is asked for its part. */
enum { LEFT = 150, RIGHT = 330, BOTTOM = 70, TOP = 200 };

/* Writes which pixels show the part. */
static void find_part(struct stage *stage, const struct camera *camera, bool *is_part)
{
	for (int y = BOTTOM; y < TOP; y++)
		for (int x = LEFT; x < RIGHT; x++) {
			const char *part =
				scene_part(stage->scene, camera, (float)x + 0.5f, (float)y + 0.5f);

			is_part[y * WIDTH + x] = part && strcmp(part, marked.part) == 0;
		}
}

/* Returns how many of the pixels within reach of a pixel show the part, and how many there are. */
static int count_near(const bool *is_part, int x, int y, int reach, int *all)
{
	int count = 0;

	*all = 0;
	for (int v = y - reach; v <= y + reach; v++)
		for (int u = x - reach; u <= x + reach; u++) {
			if (u < LEFT || v < BOTTOM || u >= RIGHT || v >= TOP)
				continue;
			count += is_part[v * WIDTH + u];
			(*all)++;
		}
	return count;
}

/* The line is closed: it is on every pixel where what is seen of the part ends, be it its border,
 * its silhouette against the sky or what stands in front of it; and nowhere else. */
static void check_line(struct stage *stage, const struct camera *camera, const char *name)
{
	uint8_t *plain = malloc(4 * WIDTH * HEIGHT), *bold = malloc(4 * WIDTH * HEIGHT);
	bool *is_part = malloc(WIDTH * HEIGHT * sizeof(*is_part));
	uint32_t ends = 0, missing = 0, stray = 0;

	settle_with(stage, camera, NULL, plain);
	settle_with(stage, camera, &marked, bold);
	find_part(stage, camera, is_part);
	for (int y = BOTTOM + 4; y < TOP - 4; y++)
		for (int x = LEFT + 4; x < RIGHT - 4; x++) {
			const int by = difference(plain, bold, x, y);
			int all, near = count_near(is_part, x, y, 1, &all);
			const bool end = near > 2 && near < all - 2;

			ends += end;
			missing += end && by < 50;
			near = count_near(is_part, x, y, 4, &all);
			stray += (near == 0 && by > 16) || (near == all && by > 50);
		}
	if (ends < 200 || missing > ends / 100 || stray > 0)
		fail_msg("%s: %u pixels where the part ends, %u without a line; %u lines elsewhere",
			 name, ends, missing, stray);
	free(plain);
	free(bold);
	free(is_part);
}

static void the_line_is_closed(void **state)
{
	static const struct {
		const char *name;
		float eye_m[3], target_m[3];
	} views[] = {
		{ "before the sky", { 4, -12, 0.4f }, { 4, -5, 1.5f } },
		{ "from above", { 5, -8, 9 }, { 4, -5, 1 } },
		{ "from behind the pillar", { 4, 3, 3 }, { 4, -5, 1 } },
	};
	struct stage stage;

	(void)state;
	raise_stage(&stage, true, false);
	for (size_t i = 0; i < sizeof(views) / sizeof(views[0]); i++) {
		struct camera camera = usual_camera;

		memcpy(camera.eye_m, views[i].eye_m, sizeof(camera.eye_m));
		memcpy(camera.target_m, views[i].target_m, sizeof(camera.target_m));
		check_line(&stage, &camera, views[i].name);
	}
	strike_stage(&stage);
}

/* The first frame of another view has the line too, although its picture is not settled. */
static void a_moving_picture_has_the_line(void **state)
{
	struct stage stage;
	struct camera camera = usual_camera;
	uint8_t *plain = malloc(4 * WIDTH * HEIGHT), *bold = malloc(4 * WIDTH * HEIGHT);
	uint32_t lines = 0;

	(void)state;
	raise_stage(&stage, true, false);
	settle_with(&stage, &usual_camera, &marked, bold);
	camera.eye_m[0] += 0.01f;
	gl_target_bind(&stage.target);
	scene_draw(stage.scene, &camera, NULL, &stage.frame);
	CHECK(gl_target_read(&stage.target, plain) == 0);
	camera.eye_m[0] += 0.001f;
	gl_target_bind(&stage.target);
	scene_draw(stage.scene, &camera, &marked, &stage.frame);
	CHECK(gl_target_read(&stage.target, bold) == 0);
	for (int i = 0; i < WIDTH * HEIGHT; i++)
		lines += difference(plain, bold, i % WIDTH, i / WIDTH) > 60;
	CHECK(lines > 150 && lines < WIDTH * HEIGHT / 4);
	free(plain);
	free(bold);
	strike_stage(&stage);
}

static bool all_as_before(const uint8_t *before, const uint8_t *after)
{
	for (int i = 0; i < WIDTH * HEIGHT; i++)
		if (difference(before, after, i % WIDTH, i / WIDTH) > 16)
			return false;
	return true;
}

static void no_mark_leaves_no_trace(void **state)
{
	struct stage stage;
	uint8_t *before = malloc(4 * WIDTH * HEIGHT), *after = malloc(4 * WIDTH * HEIGHT);
	uint32_t bold = 0;

	(void)state;
	raise_stage(&stage, true, false);
	settle_with(&stage, &usual_camera, NULL, before);
	settle_with(&stage, &usual_camera, &marked, after);
	for (int i = 0; i < WIDTH * HEIGHT; i++)
		bold += difference(before, after, i % WIDTH, i / WIDTH) > 60;
	CHECK(bold > 150);
	settle_with(&stage, &usual_camera, &(struct scene_mark){ .part = "none" }, after);
	CHECK(all_as_before(before, after));
	settle_with(&stage, &usual_camera, NULL, after);
	CHECK(all_as_before(before, after));
	free(before);
	free(after);
	strike_stage(&stage);
}

static int make_release(void **state)
{
	(void)state;
	release = little_release_make(2);
	root_without_labels = release->root;
	bytes_without_labels = release->root_bytes;
	return 0;
}

static int free_release(void **state)
{
	(void)state;
	little_release_free(release);
	return 0;
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(a_touch_is_answered_as_the_region_would),
		cmocka_unit_test(labels_come_after_what_is_to_be_seen),
		cmocka_unit_test(a_release_without_labels_leaves_it_to_regions),
		cmocka_unit_test(labels_that_do_not_decode_are_not_wanted_again),
		cmocka_unit_test(labels_go_with_their_geometry),
		cmocka_unit_test(an_area_ends_where_the_region_ends),
		cmocka_unit_test(the_border_is_as_bold_from_near_as_from_afar),
		cmocka_unit_test(the_model_hides_the_border),
		cmocka_unit_test(the_line_is_closed),
		cmocka_unit_test(a_moving_picture_has_the_line),
		cmocka_unit_test(no_mark_leaves_no_trace),
	};

	return cmocka_run_group_tests(tests, make_release, free_release);
}
