/* Where frames take too long, pictures are drawn in slices and warped to where the eye is: they
 * look like those that are drawn whole. */
#include <math.h>
#include <stdlib.h>
#include <unistd.h>

#include "render/scene/scene_parts.h"
#include "tests/render/scene/little_stage.h"

enum { FRAMES_MAX = 3000, PAUSE_US = 10000 };
/* The share with which a picture takes several frames. */
static const float slices = 0.15f;
static const float fast_m = 1.2f;

static struct little_release *release; /* made once for all tests */
static struct stage stage;
static int rotation_deg; /* of the panel */

static int raise(void **state)
{
	(void)state;
	rotation_deg = 0;
	raise_stage(&stage, release, SCENE_LUMIGRAPH);
	return 0;
}

static int raise_turned(void **state)
{
	raise(state);
	rotation_deg = 90;
	return 0;
}

static int strike(void **state)
{
	(void)state;
	strike_stage(&stage);
	return 0;
}

static void settle(void)
{
	struct camera camera = usual_camera;

	camera.rotation_deg = rotation_deg;
	for (int i = 0; i < FRAMES_MAX; i++) {
		draw_stage(&stage, &camera);
		if (stage.frame.settled)
			return;
		(void)little_release_serve(release, stage.scene, 16);
	}
	fail_msg("not settled");
}

static void spend(float share, uint32_t faces)
{
	struct scene_effort effort = scene_effort_full;

	effort.scale = 0.5f;
	effort.share = share;
	effort.faces = faces;
	scene_spend(stage.scene, &effort);
}

/* Draws one frame from an eye that has gone aside, at half the scale. Before it the time passes
 * that makes it a slow eye. */
static void draw_aside(float aside_m, float share, const struct scene_mark *mark)
{
	struct camera camera = usual_camera;

	spend(share, PLAN_ENTRIES);
	camera.rotation_deg = rotation_deg;
	for (int k = 0; k < 2; k++) {
		camera.eye_m[k] += 0.7f * aside_m;
		camera.target_m[k] += 0.1f * aside_m;
	}
	usleep(PAUSE_US);
	draw_marked_stage(&stage, &camera, mark);
}

/* Of colours: a panel has no alpha. */
static double difference(const uint8_t *a, const uint8_t *b)
{
	double sum = 0;

	for (int i = 0; i < 4 * PIXELS; i++)
		sum += i % 4 < 3 ? (a[i] - b[i]) * (a[i] - b[i]) : 0;
	return sum / (3.0 * PIXELS);
}

/* How many pixels differ by more than that in some channel. */
static int pixels_changed(const uint8_t *a, const uint8_t *b, int by)
{
	int count = 0;

	for (int i = 0; i < 4 * PIXELS; i += 4)
		count += abs(a[i] - b[i]) > by || abs(a[i + 1] - b[i + 1]) > by ||
			 abs(a[i + 2] - b[i + 2]) > by;
	return count;
}

/* Goes on to the side until there is a picture to warp. Returns how far it has gone. */
static float reach_first(void)
{
	float aside_m = 0;

	for (int i = 0; !stage.scene->references.has_shown; i++) {
		CHECK(i < 20);
		aside_m += 0.025f;
		draw_aside(aside_m, slices, NULL);
	}
	return aside_m;
}

/* While the next one is drawn in slices, each frame shows the last one as the eye sees it. */
static void a_warped_picture_is_that_of_the_eye(void **state)
{
	static uint8_t old[4 * PIXELS];
	const struct scene_references *r = &stage.scene->references;
	uint32_t changes = 0;
	float aside_m;
	int shown;

	(void)state;
	settle();
	draw_aside(0, 1, NULL);
	memcpy(old, stage.seen, sizeof(old));
	CHECK(!r->has_shown);
	aside_m = reach_first();
	shown = r->shown;
	for (int i = 1; i <= 48; i++) {
		aside_m += 0.025f;
		draw_aside(aside_m, slices, NULL);
		CHECK(r->has_shown);
		changes += r->shown != shown;
		shown = r->shown;
		if (i < 24)
			continue;
		draw_aside(aside_m, 1, NULL); /* not moved, but drawn directly */
		CHECK(difference(stage.before, stage.seen) < difference(old, stage.seen) / 5);
		CHECK(difference(stage.before, stage.seen) > 0);
	}
	CHECK(changes >= 3 && changes <= 16); /* drawn in slices, not in each frame */
}

/* An eye that is too fast for the usual pictures has small ones, soon enough to be shown all the
 * time. It goes so far in a frame that it is, however long frames take: a pause of more than a
 * tenth of a second does not count (scene_draw.c). */
static void a_fast_eye_has_small_pictures(void **state)
{
	const struct scene_references *r = &stage.scene->references;
	float aside_m;
	int shown, pictures = 0;

	(void)state;
	settle();
	aside_m = reach_first();
	for (int i = 0; i < 12; i++) {
		shown = r->shown;
		aside_m += fast_m;
		draw_aside(aside_m, 0.05f, NULL);
		pictures += r->shown != shown;
		if (i < 6)
			continue;
		assert_int_equal(r->kind, REFERENCE_SMALL);
		CHECK(image_warp_off(&r->of[r->shown], &stage.scene->view) < 2);
		CHECK(r->of[r->shown].picture.width_px < WIDTH / 3);
	}
	CHECK(pictures >= 3);
	for (int i = 0; r->kind == REFERENCE_SMALL; i++) {
		CHECK(i < 20);
		draw_aside(aside_m += 0.01f, slices, NULL);
	}
}

/* Where nothing of the model is in sight, pictures of the sky follow each other. */
static void an_eye_that_sees_nothing_has_pictures(void **state)
{
	const struct scene_references *r = &stage.scene->references;
	struct camera camera = usual_camera;
	int shown, pictures = 0;

	(void)state;
	settle();
	reach_first();
	for (int k = 0; k < 3; k++)
		camera.target_m[k] = 2 * camera.eye_m[k] - camera.target_m[k];
	for (int i = 0; i < 30; i++) {
		shown = r->shown;
		camera.eye_m[0] += 0.01f;
		camera.target_m[0] += 0.01f;
		spend(slices, PLAN_ENTRIES);
		usleep(PAUSE_US);
		draw_stage(&stage, &camera);
		pictures += i > 10 && r->shown != shown;
	}
	assert_int_equal(stage.scene->counted_all, 0);
	CHECK(pictures > 3);
}

/* What a motion begins with is there before it begins, where it must be: it takes memory. */
static void a_resting_eye_keeps_a_picture_for_the_next_motion(void **state)
{
	const struct scene_references *r = &stage.scene->references;
	struct scene_effort effort = scene_effort_full;
	struct view kept;

	(void)state;
	settle();
	CHECK(!r->has_shown && !r->of[0].picture.framebuffer && !r->of[1].picture.framebuffer);
	effort.scale = 0.5f;
	effort.share = slices;
	scene_spend(stage.scene, &effort);
	settle();
	CHECK(r->has_shown && !r->is_begun);
	kept = r->of[r->shown].view;
	CHECK(memcmp(kept.eye_m, usual_camera.eye_m, sizeof(kept.eye_m)) == 0);
	draw_aside(0.01f, slices, NULL);
	draw_aside(0.02f, slices, NULL);
	CHECK(stage.frame.moved && r->is_begun);
	CHECK(memcmp(&kept, &r->of[r->shown].view, sizeof(kept)) == 0);
	scene_spend(stage.scene, &scene_effort_full);
	settle();
	CHECK(!r->has_shown && !r->of[0].picture.framebuffer && !r->of[1].picture.framebuffer);
}

/* An eye that is suddenly elsewhere sees that place at once, in a small picture; so does one of
 * another release, in the middle of a picture. */
static void a_jump_shows_nothing_of_the_old_place(void **state)
{
	static uint8_t old[4 * PIXELS];
	const struct scene_references *r = &stage.scene->references;

	(void)state;
	settle();
	reach_first();
	memcpy(old, stage.seen, sizeof(old));
	draw_aside(8, slices, NULL);
	assert_int_equal(r->kind, REFERENCE_SMALL);
	CHECK(image_warp_off(&r->of[r->shown], &stage.scene->view) < 1);
	draw_aside(8, 1, NULL);
	CHECK(difference(stage.before, stage.seen) < difference(old, stage.seen) / 4);
	for (int i = 1; !r->is_begun; i++) { /* not in a frame for depths of a face */
		CHECK(i < 20);
		draw_aside(8 + 0.01f * (float)i, slices, NULL);
	}
	CHECK(scene_open(stage.scene, release->root, release->root_bytes) == 0);
	CHECK(!r->has_shown && !r->is_begun);
	settle();
}

/* Returns how many faces the piece blends that has most. */
static int most_blended(void)
{
	const struct scene *scene = stage.scene;
	int most = 0;

	for (uint32_t i = 0; i < scene->visible_count; i++) {
		const struct visible_piece *v = &scene->visible[i];
		const struct blend *blend =
			scene->geometry.patches[v->patch].pieces[v->piece].blend;
		int faces = 0;

		for (int k = 0; k < PLAN_ENTRIES; k++)
			faces += blend[k].held && blend[k].weight > 0;
		most = faces > most ? faces : most;
	}
	return most;
}

/* Faces that go fade where each frame is a new picture. One that takes several frames must not wait
 * for that. */
static void a_picture_for_several_frames_has_no_faces_that_fade(void **state)
{
	const struct scene_references *r = &stage.scene->references;
	struct camera camera = usual_camera;
	uint32_t with_faces = 0;

	(void)state;
	settle();
	camera.eye_m[0] += 0.01f;
	spend(slices, 1);
	usleep(PAUSE_US);
	draw_stage(&stage, &camera);
	CHECK(r->has_shown);
	CHECK(most_blended() > 1);
	for (int i = 0; i < SURFACE_PROGRAMS; i++) {
		if (surface_faces(i) > 1)
			assert_int_equal(r->slice.with[i], 0);
		with_faces += surface_faces(i) == 1 ? r->slice.with[i] : 0;
	}
	CHECK(with_faces > 0);
}

static uint32_t looks, touches; /* how often was asked; of these, how often one waited */

static bool touch_waits(void *data)
{
	(void)data;
	looks++;
	touches += looks % 2;
	return looks % 2;
}

/* Settles an eye that has just moved. */
static void settle_again(float share)
{
	reach_first();
	spend(share, 1);
	settle();
}

/* At rest pictures are drawn in parts, between which a touch is answered; they are those of a board
 * that draws them whole. */
static void a_picture_at_rest_is_left_for_a_touch(void **state)
{
	static uint8_t whole[4 * PIXELS];
	struct camera camera = usual_camera;
	int begun = 0;

	(void)state;
	settle();
	settle_again(1);
	memcpy(whole, stage.seen, sizeof(whole));
	scene_heed(stage.scene, touch_waits, NULL);
	looks = touches = 0;
	settle_again(0.005f);
	CHECK(touches > 2 * ACCUMULATION_FRAMES);
	CHECK(difference(whole, stage.seen) < 1);
	/* what is seen stays, until an eye that moves sees it at once */
	camera.eye_m[0] += 0.05f;
	for (int i = 0; i < 12; i++) {
		draw_stage(&stage, &camera);
		begun += stage.scene->still.is_begun;
		CHECK(!stage.scene->still.is_begun || i < 3 ||
		      difference(stage.before, stage.seen) == 0);
	}
	CHECK(begun > 3);
	while (!stage.scene->still.is_begun)
		draw_stage(&stage, &camera);
	camera.eye_m[0] += 0.05f;
	draw_stage(&stage, &camera);
	CHECK(stage.frame.moved && !stage.scene->still.is_begun);
	CHECK(difference(stage.before, stage.seen) > 0);
}

/* The first picture after a stop waits neither for a visibility pass nor for depths. It and three
 * more are small where a picture at full size takes long. */
static void a_stop_shows_a_whole_picture_at_once(void **state)
{
	const struct scene *scene = stage.scene;
	int64_t counted_us;
	float aside_m;

	(void)state;
	settle();
	aside_m = reach_first();
	draw_aside(aside_m, slices, NULL); /* as those before: a slow finger */
	CHECK(scene->used.share < 1);
	counted_us = scene->visibility_us;
	draw_aside(aside_m, slices, NULL);
	CHECK(scene->used.share == 1 && scene->used.scale == 0.5f);
	CHECK(scene->visibility_us == counted_us && stage.frame.depth_faces_drawn == 0);
	for (int i = 0; i < 3; i++) {
		draw_aside(aside_m, slices, NULL);
		CHECK(scene->visibility_us != counted_us && scene->used.scale == 0.5f);
		CHECK(!scene->still.sum_is_seen);
	}
	draw_aside(aside_m, slices, NULL);
	CHECK(scene->used.scale == 1 && scene->still.sum_is_seen);
}

static void a_board_with_time_is_sharp_at_once(void **state)
{
	const struct scene *scene = stage.scene;

	(void)state;
	settle();
	draw_aside(0.1f, 1, NULL);
	draw_aside(0.1f, 1, NULL);
	CHECK(scene->used.scale == 0.5f && !scene->still.sum_is_seen);
	draw_aside(0.1f, 1, NULL);
	CHECK(scene->used.scale == 1 && scene->still.sum_is_seen);
}

static void a_warped_picture_has_the_mark(void **state)
{
	static const struct scene_mark pillar = { .region = { .kind = REGION_BOX,
							      .centre_m = { 4, -4, 2.2f },
							      .half_m = { 1.2f, 1.2f, 1.7f } } };
	static uint8_t marked[4 * PIXELS];
	int bold;

	(void)state;
	settle();
	for (int i = 1; i <= 12; i++)
		draw_aside(0.01f * (float)i, slices, &pillar);
	memcpy(marked, stage.seen, sizeof(marked));
	for (int i = 1; i <= 12; i++)
		draw_aside(0.01f * (float)i, slices, NULL);
	bold = pixels_changed(stage.seen, marked, 60);
	CHECK(bold > 50 && bold < PIXELS / 8);
}

/* The far side of a pillar. */
static void a_warped_picture_has_no_mark_of_what_is_hidden(void **state)
{
	static const struct scene_mark hidden = { .region = { .kind = REGION_BOX,
							      .centre_m = { 3, -4.05f, 2.4f },
							      .half_m = { 0.1f, 0.65f, 2.1f } } };
	static uint8_t marked[4 * PIXELS];

	(void)state;
	settle();
	for (int i = 1; i <= 12; i++)
		draw_aside(0.01f * (float)i, slices, &hidden);
	CHECK(stage.scene->references.has_shown);
	memcpy(marked, stage.seen, sizeof(marked));
	for (int i = 1; i <= 12; i++)
		draw_aside(0.01f * (float)i, slices, NULL);
	CHECK(pixels_changed(stage.seen, marked, 60) < 20);
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test_setup_teardown(a_warped_picture_is_that_of_the_eye, raise, strike),
		cmocka_unit_test_setup_teardown(a_warped_picture_is_that_of_the_eye, raise_turned,
						strike),
		cmocka_unit_test_setup_teardown(a_fast_eye_has_small_pictures, raise, strike),
		cmocka_unit_test_setup_teardown(an_eye_that_sees_nothing_has_pictures, raise,
						strike),
		cmocka_unit_test_setup_teardown(a_resting_eye_keeps_a_picture_for_the_next_motion,
						raise, strike),
		cmocka_unit_test_setup_teardown(a_picture_for_several_frames_has_no_faces_that_fade,
						raise, strike),
		cmocka_unit_test_setup_teardown(a_picture_at_rest_is_left_for_a_touch, raise,
						strike),
		cmocka_unit_test_setup_teardown(a_jump_shows_nothing_of_the_old_place, raise,
						strike),
		cmocka_unit_test_setup_teardown(a_stop_shows_a_whole_picture_at_once, raise,
						strike),
		cmocka_unit_test_setup_teardown(a_board_with_time_is_sharp_at_once, raise, strike),
		cmocka_unit_test_setup_teardown(a_warped_picture_has_the_mark, raise, strike),
		cmocka_unit_test_setup_teardown(a_warped_picture_has_no_mark_of_what_is_hidden,
						raise, strike),
	};
	int failed;

	release = little_release_make(4);
	failed = cmocka_run_group_tests(tests, NULL, NULL);
	little_release_free(release);
	return failed;
}
