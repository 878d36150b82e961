/* Scenery in time: a door opens when it is touched and closes again, layers dissolve. */
#include "render/scenery/pose.h"

#include <math.h>
#include <stdlib.h>

#include "geometry/vec.h"
#include "tests/check.h"
#include "tests/format/little_scenery.h"

enum { DOOR = 1, ROOF = 2 };

static bool is_near(float a, float b)
{
	return fabsf(a - b) < 1e-4f;
}

/* Where the door's far lower corner is: at x = 1 at rest, at y = 1 when it is open. */
static void corner_of(const struct pose *pose, float out[3])
{
	const float *m = pose->nodes[DOOR].matrix;

	for (int k = 0; k < 3; k++)
		out[k] = m[k] + m[12 + k];
}

static void run(struct pose *pose, float ms)
{
	for (; ms > 0; ms -= 10)
		pose_step(pose, 10);
}

static void a_door_opens_and_closes(void **state)
{
	struct little_scenery s;
	struct pose pose;
	float at[3];

	(void)state;
	little_scenery_init(&s);
	CHECK(pose_init(&pose, &s.scenery) == 0);
	run(&pose, 700);
	CHECK(!pose_moves(&pose)); /* it has appeared, and waits */
	corner_of(&pose, at);
	CHECK(is_near(at[0], 1) && is_near(at[1], 0));
	CHECK(!pose_touch(&pose, ROOF));
	CHECK(pose_touch(&pose, DOOR)); /* by the node above it */
	run(&pose, 1000);
	corner_of(&pose, at);
	CHECK(is_near(at[0], sqrtf(0.5f)) && is_near(at[1], sqrtf(0.5f)));
	run(&pose, 1100);
	corner_of(&pose, at);
	CHECK(is_near(at[0], 0) && is_near(at[1], 1) && !pose_moves(&pose));
	CHECK(is_near(pose.nodes[DOOR].high, 0.5f)); /* half as solid */
	CHECK(pose_touch(&pose, DOOR));
	run(&pose, 2100);
	corner_of(&pose, at);
	CHECK(is_near(at[0], 1) && !pose_moves(&pose));
	pose_finish(&pose);
}

static void a_touch_on_the_way_turns_it_back(void **state)
{
	struct little_scenery s;
	struct pose pose;
	float at[3];

	(void)state;
	little_scenery_init(&s);
	CHECK(pose_init(&pose, &s.scenery) == 0);
	CHECK(pose_touch(&pose, DOOR));
	run(&pose, 500);
	CHECK(pose_touch(&pose, DOOR));
	run(&pose, 510);
	corner_of(&pose, at);
	CHECK(is_near(at[0], 1) && !pose.motions[0].runs);
	pose_touch(&pose, DOOR);
	run(&pose, 2100);
	pose_reset(&pose); /* the visitor has gone */
	run(&pose, 2100);
	corner_of(&pose, at);
	CHECK(is_near(at[0], 1) && !pose_moves(&pose));
	pose_finish(&pose);
}

/* What does not turn back jumps, so there is one more picture to draw. */
static void a_reset_is_drawn(void **state)
{
	struct little_scenery s;
	struct pose pose;
	float at[3];

	(void)state;
	little_scenery_init(&s);
	s.motion.returns = false;
	CHECK(pose_init(&pose, &s.scenery) == 0);
	CHECK(pose_touch(&pose, DOOR));
	run(&pose, 2100);
	CHECK(!pose_moves(&pose));
	pose_reset(&pose);
	CHECK(pose_step(&pose, 16) && !pose_moves(&pose));
	corner_of(&pose, at);
	CHECK(is_near(at[0], 1));
	pose_finish(&pose);
}

static void layers_share_the_pixels_while_they_dissolve(void **state)
{
	struct little_scenery s;
	struct pose pose;

	(void)state;
	little_scenery_init(&s);
	CHECK(pose_init(&pose, &s.scenery) == 0);
	run(&pose, 700);
	CHECK(pose.nodes[ROOF].high <= pose.nodes[ROOF].low); /* in the second layer */
	pose_choose(&pose, 1);
	CHECK(pose_moves(&pose));
	run(&pose, 450);
	CHECK(is_near(pose.nodes[ROOF].low, 0.5f) && is_near(pose.nodes[ROOF].high, 1));
	run(&pose, 500);
	CHECK(pose.nodes[ROOF].low == 0 && pose.nodes[ROOF].high == 1 && !pose_moves(&pose));
	pose_reset(&pose);
	run(&pose, 1000);
	CHECK(pose.layer_shares[0] == 1 && pose.nodes[ROOF].high <= pose.nodes[ROOF].low);
	pose_finish(&pose);
}

/* VRML97 6.52: T C R SR S -SR -C. */
static void a_place_turns_and_scales_about_its_centre(void **state)
{
	const float h = sqrtf(0.5f);
	const struct scenery_place place = { .move_m = { 10, 0, 0 },
					     .turn = { 0, 0, h, h }, /* 90 degrees about z */
					     .scale = { 2, 1, 1 },
					     .centre_m = { 1, 0, 0 },
					     .stretch = { 0, 0, h, h } };
	float m[16], at[3];

	(void)state;
	pose_matrix(m, &place);
	/* The stretch makes y what is scaled: (1, 1, 0) is 1 above the centre, becomes 2 above,
	 * and turns to the left of it. */
	for (int k = 0; k < 3; k++)
		at[k] = m[k] + m[4 + k] + m[12 + k];
	CHECK(is_near(at[0], 10 + 1 - 2) && is_near(at[1], 0) && is_near(at[2], 0));
}

static void steps_and_single_keys_have_values(void **state)
{
	float numbers[] = { 0, 0.5f, 0.5f, 1, /* values */ 0, 0, 1, 1 }, value;
	struct scenery scenery = { .numbers = numbers };
	const struct scenery_track track = { .target = SCENERY_OPACITY, .key_count = 4 };
	const struct scenery_track one = { .target = SCENERY_OPACITY, .key_count = 1, .first = 3 };

	(void)state;
	pose_value(&scenery, &track, 0.49f, &value);
	CHECK(value == 0);
	pose_value(&scenery, &track, 0.5f, &value);
	CHECK(value == 1);
	pose_value(&scenery, &one, 0.2f, &value); /* before its only key, at 1 */
	CHECK(value == 0);
}

/* Two shapes, a colour and a glow over the door's motion, which runs always here. */
static void meshes_bend_and_change_their_colours(void **state)
{
	static const float numbers[] = { 0, 1, 0, 1, /* the shape; then red to green, for two */
					 0, 1, 1, 0, 0, 0, 1, 0, 0, 1, 1, 0, 0, 0, 1, 0 };
	struct little_scenery s;
	const struct scenery_vertex *roof;
	struct pose pose;
	uint32_t version;

	(void)state;
	little_scenery_init(&s);
	little_scenery_add_shapes(&s);
	s.scenery.touch_count = 0;
	s.motion = (struct scenery_motion){ .duration_s = 2, .loops = true, .track_count = 3 };
	struct scenery_track tracks[3] = {
		{ .node = ROOF, .target = SCENERY_SHAPE, .key_count = 2 },
		{ .node = ROOF, .target = SCENERY_COLOUR, .key_count = 2, .first = 4 },
		{ .node = DOOR, .target = SCENERY_GLOW, .key_count = 2, .first = 12 }
	};
	s.scenery.tracks = tracks;
	s.scenery.track_count = 3;
	s.scenery.numbers = (float *)numbers;
	s.scenery.number_count = 20;
	CHECK(scenery_is_sane(&s.scenery));
	CHECK(pose_init(&pose, &s.scenery) == 0);
	CHECK(pose.bend.meshes[0].vertices == NULL); /* it only glows */
	roof = bend_vertices(&pose.bend, &s.scenery, 1);
	CHECK(roof[1].place[1] == 0 && roof[1].rgb[0] == 120 && roof[1].normal[1] == -127);
	CHECK(pose_material(&pose, 0).emissive[0] == 0 && pose_material(&pose, 0).emissive[2] == 1);
	run(&pose, 1000);
	roof = bend_vertices(&pose.bend, &s.scenery, 1);
	version = pose.bend.meshes[1].version;
	CHECK(abs(roof[1].place[1] - 100) <= 1 && roof[1].place[0] == 1000);
	CHECK(roof[1].normal[0] > 50 && roof[1].normal[1] < -50);
	CHECK(abs(roof[1].rgb[0] - 128) <= 2 && abs(roof[1].rgb[1] - 128) <= 2 &&
	      roof[1].rgb[2] == 0);
	CHECK(abs(pose_material(&pose, 0).emissive[0] - 128) <= 2);
	CHECK(pose_material(&pose, 1).emissive[2] == 0); /* the roof's own */
	pose.motions[0].runs = false;
	run(&pose, 1000);
	CHECK(pose.bend.meshes[1].version == version); /* at rest nothing is done */
	pose_finish(&pose);
}

/* The eye is 5 m before the sheets, which stand at y = 0. */
static void pull(struct pose *pose, float x, float z)
{
	const float eye_m[3] = { 0, -5, 0 };
	float direction[3] = { x, 5, z };

	vec_normalise(direction);
	pose_drag(pose, eye_m, direction);
}

static bool grab(struct pose *pose, uint32_t node, float x, float z)
{
	const float at_m[3] = { x, 0, z };
	float direction[3] = { x, 5, z };

	vec_normalise(direction);
	return pose_grab(pose, node, at_m, direction);
}

/* The handle's x and y are the model's x and z, as a sheet stands. */
static void what_a_finger_drags_follows_it(void **state)
{
	const float h = sqrtf(0.5f);
	struct little_scenery s;
	struct pose pose;

	(void)state;
	little_scenery_init(&s);
	little_scenery_add_drag(&s);
	s.nodes[0].place.turn[0] = s.nodes[0].place.turn[3] = h;
	s.drag.low[1] = -1;
	s.drag.high[1] = 1;
	CHECK(pose_init(&pose, &s.scenery) == 0);
	run(&pose, 700);
	CHECK(!grab(&pose, ROOF, 0, 0) && pose.held == SCENERY_NONE);
	CHECK(grab(&pose, DOOR, 0.1f, 0.2f) && pose.held == 0);
	CHECK(!pose_moves(&pose)); /* until the finger moves */
	pull(&pose, 0.3f, 0.3f);
	CHECK(is_near(pose.places[DOOR].move_m[0], 0.2f) &&
	      is_near(pose.places[DOOR].move_m[1], 0.1f) && pose.places[DOOR].move_m[2] == 0);
	CHECK(pose_moves(&pose) && pose_step(&pose, 10) && !pose_moves(&pose));
	pull(&pose, 3, 0.3f); /* it stops at its end, and comes back with the finger */
	CHECK(is_near(pose.places[DOOR].move_m[0], 0.5f));
	pull(&pose, 0.2f, 0.3f);
	CHECK(is_near(pose.places[DOOR].move_m[0], 0.1f));
	pose_let_go(&pose);
	pull(&pose, 0.6f, 0.3f);
	CHECK(is_near(pose.places[DOOR].move_m[0], 0.1f));
	CHECK(grab(&pose, DOOR, 0, 0)); /* it goes on from where it was left */
	pull(&pose, 0.1f, 0);
	CHECK(is_near(pose.places[DOOR].move_m[0], 0.2f) &&
	      is_near(pose.places[DOOR].move_m[1], 0.1f));
	pose_reset(&pose); /* the visitor has gone, with a finger on the glass */
	pull(&pose, 0.5f, 0);
	CHECK(pose.places[DOOR].move_m[0] == 0 && pose_moves(&pose));
	CHECK(grab(&pose, DOOR, 0, 0));
	pull(&pose, 0.1f, 0);
	CHECK(is_near(pose.places[DOOR].move_m[0], 0.1f));
	pose_finish(&pose);
}

static void check_z(const struct pose *pose, float x, float y, float z)
{
	const float *m = &pose->nodes[DOOR].matrix[8];

	CHECK(is_near(m[0], x) && is_near(m[1], y) && is_near(m[2], z));
}

static const float straight_up[3] = { 0, 0, 1 };

/* Its axis is y of a node that is turned as VRML97's files are: z of the model. */
static void a_billboard_turns_to_the_eye_about_its_axis(void **state)
{
	const float h = sqrtf(0.5f);
	struct little_scenery s;
	struct pose pose;

	(void)state;
	little_scenery_init(&s);
	s.nodes[0].place.turn[0] = s.nodes[0].place.turn[3] = h;
	s.nodes[0].place.move_m[0] = 7;
	for (int k = 0; k < 3; k++)
		s.nodes[0].place.scale[k] = 2;
	s.nodes[DOOR].sight = (struct scenery_sight){ SCENERY_SIGHT_FACES, { 0, 1, 0 }, 0, 0 };
	CHECK(scenery_is_sane(&s.scenery) && pose_init(&pose, &s.scenery) == 0);
	run(&pose, 700);
	pose_look(&pose, (const float[3]){ 7, -9, 4 }, straight_up);
	check_z(&pose, 0, -2, 0);
	pose_look(&pose, (const float[3]){ 17, 10, -4 }, straight_up);
	check_z(&pose, 2 * h, 2 * h, 0);
	CHECK(is_near(pose.nodes[DOOR].matrix[6], 2)); /* y stays up */
	CHECK(!pose_moves(&pose));
	s.nodes[0].place.move_m[0] = 27; /* it goes by, and the eye rests */
	pose.places[0].move_m[0] = 27;
	CHECK(pose_touch(&pose, DOOR) && pose_step(&pose, 1e-3f));
	check_z(&pose, -2 * h, 2 * h, 0);
	pose_look(&pose, (const float[3]){ 27, 0, 50 }, straight_up); /* on the axis */
	for (int k = 0; k < 16; k++)
		CHECK(isfinite(pose.nodes[DOOR].matrix[k]));
	pose_finish(&pose);
}

static void a_billboard_without_axis_is_upright_in_the_picture(void **state)
{
	const float h = sqrtf(0.5f), eye_m[3] = { 5, 0, 5 };
	struct little_scenery s;
	const float *m;
	struct pose pose;

	(void)state;
	little_scenery_init(&s);
	s.nodes[DOOR].sight.kind = SCENERY_SIGHT_FACES;
	CHECK(pose_init(&pose, &s.scenery) == 0);
	m = pose.nodes[DOOR].matrix;
	pose_look(&pose, eye_m, (const float[3]){ -h, 0, h });
	check_z(&pose, h, 0, h);
	CHECK(is_near(m[1], 1) && is_near(m[4], -h) && is_near(m[6], h));
	/* the picture is turned: x of the board is down, y right */
	pose_look(&pose, eye_m, (const float[3]){ 0, 1, 0 });
	check_z(&pose, h, 0, h);
	CHECK(is_near(m[5], 1) && is_near(m[0], h) && is_near(m[2], -h));
	pose_look(&pose, eye_m, (const float[3]){ 1, 0, 1 }); /* nothing is up */
	CHECK(isfinite(m[0]) && isfinite(m[5]) && isfinite(m[10]));
	pose_finish(&pose);
}

static float width_of(const struct pose *pose, uint32_t node)
{
	return pose->nodes[node].high - pose->nodes[node].low;
}

/* Two levels that meet at 5 of the node's metres, which are 2 of the model's. */
static void the_distance_chooses_a_level(void **state)
{
	struct little_scenery s;
	struct pose pose;

	(void)state;
	little_scenery_init(&s);
	s.scenery.layer_count = s.scenery.title_count = 0;
	s.nodes[ROOF] = little_node(0, SCENERY_NONE);
	s.nodes[0].place.scale[0] = s.nodes[0].place.scale[1] = s.nodes[0].place.scale[2] = 2;
	s.nodes[DOOR].sight = (struct scenery_sight){ SCENERY_SIGHT_LEVEL, { 1, 0, 0 }, 0, 5 };
	s.nodes[ROOF].sight =
		(struct scenery_sight){ SCENERY_SIGHT_LEVEL, { 1, 0, 0 }, 5, INFINITY };
	CHECK(scenery_is_sane(&s.scenery) && pose_init(&pose, &s.scenery) == 0);
	run(&pose, 700);
	for (float x = 2; x < 200; x += 0.02f) {
		const float metres = x / 2 - 1;

		pose_look(&pose, (const float[3]){ x, 0, 0 }, straight_up);
		CHECK(pose.nodes[DOOR].high == pose.nodes[ROOF].low);
		CHECK(is_near(width_of(&pose, DOOR) + width_of(&pose, ROOF), 1));
		CHECK(metres > 4.84f || (width_of(&pose, DOOR) == 1 && width_of(&pose, ROOF) == 0));
		CHECK(metres < 5.16f || (width_of(&pose, ROOF) == 1 && width_of(&pose, DOOR) == 0));
	}
	pose_finish(&pose);
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(a_door_opens_and_closes),
		cmocka_unit_test(a_touch_on_the_way_turns_it_back),
		cmocka_unit_test(a_reset_is_drawn),
		cmocka_unit_test(layers_share_the_pixels_while_they_dissolve),
		cmocka_unit_test(a_place_turns_and_scales_about_its_centre),
		cmocka_unit_test(steps_and_single_keys_have_values),
		cmocka_unit_test(meshes_bend_and_change_their_colours),
		cmocka_unit_test(what_a_finger_drags_follows_it),
		cmocka_unit_test(a_billboard_turns_to_the_eye_about_its_axis),
		cmocka_unit_test(a_billboard_without_axis_is_upright_in_the_picture),
		cmocka_unit_test(the_distance_chooses_a_level),
	};

	return cmocka_run_group_tests(tests, NULL, NULL);
}
