/* The streaming mesh in the scene: it is the first picture, grows, and dissolves into patches. */
#include <stdio.h>
#include <unistd.h>

#include "format/picture.h"
#include "render/scene/scene_objects.h"
#include "tests/render/scene/little_stage.h"
#include "tests/render/scene/little_stream.h"

enum { FRAMES_MAX = 3000 };

static struct little_release *release;
static struct hash plain_root;
static uint32_t plain_bytes;

/* Gives what is wanted most, but no patches before the whole stream: over a line on which patches
 * took longer, it would come first. */
static void serve(struct stage *stage)
{
	const struct stream_growth *growth = &stage->scene->stream.growth;
	struct message_want wants[64];
	size_t count = scene_wants(stage->scene, wants, 64), i = 0;

	while (i + 1 < count && growth->decoder && growth->block_count < growth->page.child_count &&
	       !growth->damaged && scene_object(stage->scene, wants[i].hash)->kind == OBJECT_GROUP)
		i++;
	if (count > 0)
		scene_give(stage->scene, wants[i].hash,
			   little_object_bytes(release, wants[i].hash));
}

static void settle(struct stage *stage)
{
	for (int i = 0; i < FRAMES_MAX; i++) {
		draw_stage(stage, &usual_camera);
		if (stage->frame.settled)
			return;
		serve(stage);
		usleep(3000);
	}
	fail_msg("not settled");
}

/* The share of pixels that differ clearly. */
static double differing(const uint8_t *a, const uint8_t *b)
{
	int count = 0;

	for (int i = 0; i < PIXELS; i++) {
		int most = 0;

		for (int k = 0; k < 3; k++) {
			const int d = abs(a[4 * i + k] - b[4 * i + k]);

			most = d > most ? d : most;
		}
		count += most > 24;
	}
	return (double)count / PIXELS;
}

static double covered(const uint8_t *rgba)
{
	int count = 0;

	for (int i = 0; i < PIXELS; i++)
		count += rgba[4 * i + 3] > 127;
	return (double)count / PIXELS;
}

static void use_root(bool stream, bool spoiled)
{
	release->root = plain_root;
	release->root_bytes = plain_bytes;
	if (stream)
		little_stream(release, spoiled);
}

static void the_stream_is_the_first_picture(void **state)
{
	static struct stage stage;
	static uint8_t first[4 * PIXELS];

	(void)state;
	use_root(true, false);
	raise_stage(&stage, release, SCENE_POLYGONS);
	draw_stage(&stage, &usual_camera);
	CHECK(stage.frame.stream_triangles == 0 && covered(stage.seen) <= 0);
	serve(&stage); /* the root page */
	draw_stage(&stage, &usual_camera);
	serve(&stage); /* the stream page */
	draw_stage(&stage, &usual_camera);
	CHECK(stage.frame.stream_triangles > 0 && stage.frame.patches == 0);
	CHECK(!stage.frame.settled);
	memcpy(first, stage.seen, sizeof(first));
	settle(&stage);
	CHECK(stage.frame.stream_triangles == 0 && stage.frame.patches > 0);
	CHECK(covered(stage.seen) > 0.2);
	CHECK(fabs(covered(first) - covered(stage.seen)) < 0.03);
	strike_stage(&stage);
}

static void nothing_pops_until_patches_are_shown(void **state)
{
	static struct stage stage;
	double most = 0, coverage = 1;
	int grown = 0, frames;
	uint32_t last = 0;

	(void)state;
	use_root(true, false);
	raise_stage(&stage, release, SCENE_POLYGONS);
	for (frames = 0; frames < FRAMES_MAX && !stage.frame.settled; frames++) {
		const bool first = stage.frame.stream_triangles == 0 && stage.frame.patches == 0;

		draw_stage(&stage, &usual_camera);
		if (!first) {
			const double changed = differing(stage.before, stage.seen);

			most = changed > most ? changed : most;
			coverage = covered(stage.seen) < coverage ? covered(stage.seen) : coverage;
		}
		grown += stage.frame.stream_triangles > last;
		last = stage.frame.stream_triangles;
		/* An object every tenth of a second or so, as over a slow line. */
		if (frames % 16 == 0)
			serve(&stage);
		usleep(8000);
	}
	CHECK(stage.frame.settled);
	CHECK(grown >= 3); /* the base and two blocks at least */
	if (most > 0.04)
		fail_msg("%.1f %% of the pixels change from one frame to the next", 100 * most);
	CHECK(coverage > covered(stage.seen) - 0.01);
	strike_stage(&stage);
}

/* With images, small differences are left: faces are chosen by what had come when. */
static void check_settled(enum scene_mode mode, double most)
{
	static struct stage stage;
	static uint8_t with[4 * PIXELS];
	struct message_want wants[8];

	use_root(true, false);
	raise_stage(&stage, release, mode);
	settle(&stage);
	CHECK(scene_wants(stage.scene, wants, 8) == 0);
	memcpy(with, stage.seen, sizeof(with));
	strike_stage(&stage);
	use_root(false, false);
	raise_stage(&stage, release, mode);
	settle(&stage);
	if (differing(with, stage.seen) > most)
		fail_msg("%.2f %% of the pixels differ", 100 * differing(with, stage.seen));
	strike_stage(&stage);
}

static void the_settled_picture_does_not_depend_on_it(void **state)
{
	(void)state;
	check_settled(SCENE_POLYGONS, 0.001);
	check_settled(SCENE_LUMIGRAPH, 0.05);
}

static void a_damaged_block_is_reported_and_patches_come_all_the_same(void **state)
{
	static struct stage stage;

	(void)state;
	use_root(true, true);
	raise_stage(&stage, release, SCENE_POLYGONS);
	settle(&stage);
	CHECK(scene_refused(stage.scene) == 1);
	CHECK(stage.frame.stream_triangles == 0 && stage.frame.patches > 0);
	strike_stage(&stage);
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(the_stream_is_the_first_picture),
		cmocka_unit_test(nothing_pops_until_patches_are_shown),
		cmocka_unit_test(the_settled_picture_does_not_depend_on_it),
		cmocka_unit_test(a_damaged_block_is_reported_and_patches_come_all_the_same),
	};
	int rc;

	release = little_release_make(2);
	plain_root = release->root;
	plain_bytes = release->root_bytes;
	rc = cmocka_run_group_tests(tests, NULL, NULL);
	little_release_free(release);
	return rc;
}
