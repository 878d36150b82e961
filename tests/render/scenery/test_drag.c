/* What a finger drags: along a plane, on a line, around an axis and about a point. */
#include "render/scenery/drag.h"

#include <math.h>

#include "geometry/vec.h"
#include "tests/check.h"

static const float at_home[16] = { 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1 };

static bool is_near(float a, float b)
{
	return fabsf(a - b) < 1e-3f;
}

static void direction_to(float out[3], const float eye_m[3], float x, float y, float z)
{
	const float to[3] = { x, y, z };

	vec_sub(out, to, eye_m);
	vec_normalise(out);
}

static void take(struct drag *drag, const struct scenery_drag *of, const float handle[16],
		 const float eye_m[3], float x, float y, float z)
{
	const float at_m[3] = { x, y, z };
	float direction[3];

	direction_to(direction, eye_m, x, y, z);
	CHECK(drag_begin(drag, of, handle, at_m, direction));
}

static void move(struct drag *drag, const struct scenery_drag *of, const float eye_m[3], float x,
		 float y, float z)
{
	float direction[3];

	direction_to(direction, eye_m, x, y, z);
	drag_move(drag, of, eye_m, direction);
}

/* A handle turned by 90 degrees about z, twice as large, and elsewhere. */
static void a_plane_is_that_of_its_handle(void **state)
{
	static const float handle[16] = { 0, 2, 0, 0, -2, 0, 0, 0, 0, 0, 2, 0, 7, 8, 9, 1 };
	static const float eye_m[3] = { 7, 8, 19 };
	const struct scenery_drag of = { .low = { 1, 1 }, .offset = { 0.5f, 0, 3 } };
	struct drag drag;

	(void)state;
	drag_init(&drag, &of);
	take(&drag, &of, handle, eye_m, 7, 8, 9);
	move(&drag, &of, eye_m, 7, 10,
	     9); /* 2 m of the model along y are 1 of the handle along x */
	CHECK(is_near(drag.value[0], 1.5f) && is_near(drag.value[1], 0) && drag.value[2] == 3);
	move(&drag, &of, eye_m, 3, 8, 9);
	CHECK(is_near(drag.value[0], 0.5f) && is_near(drag.value[1], 2));
	drag_end(&drag, &of);
	CHECK(drag.offset[1] == 0); /* it does not keep where it was */
}

/* A bolt along x is looked at along its plane, where a plane would lead nowhere. */
static void a_bolt_follows_from_any_side(void **state)
{
	static const float eyes_m[][3] = { { 0.3f, 5, 0 }, { 0, 0, 5 }, { 2, 3, -4 } };
	const struct scenery_drag of = { .high = { 1 } };

	(void)state;
	for (int i = 0; i < 3; i++) {
		struct drag drag;

		drag_init(&drag, &of);
		take(&drag, &of, at_home, eyes_m[i], 0, 0, 0);
		move(&drag, &of, eyes_m[i], 0.4f, 0, 0);
		CHECK(is_near(drag.value[0], 0.4f) && drag.value[1] == 0);
		move(&drag, &of, eyes_m[i], 1.5f, 0, 0);
		CHECK(drag.value[0] == 1);
		move(&drag, &of, eyes_m[i], -9, 0, 0);
		CHECK(drag.value[0] == 0);
	}
}

static float turned(const struct drag *drag, const struct scenery_drag *of)
{
	float turn[4];

	drag_value(drag, of, turn);
	CHECK(turn[0] == 0 && turn[2] == 0);
	return 2 * atan2f(turn[1], turn[3]);
}

/* A door with its hinge on y is taken at its edge, before the hinge and behind it. */
static void a_door_follows_the_finger_on_both_sides(void **state)
{
	static const float eye_m[3] = { 0, 0, 20 };
	const struct scenery_drag of = { .kind = SCENERY_DRAG_CYLINDER,
					 .keeps = true,
					 .low = { -2 },
					 .high = { 2 },
					 .disc_rad = 0.262f };
	struct drag drag;

	(void)state;
	for (int side = -1; side < 2; side += 2)
		for (float angle = 0.1f; angle < 1; angle += 0.1f) {
			drag_init(&drag, &of);
			take(&drag, &of, at_home, eye_m, 0, 0, (float)side);
			CHECK(drag.is_behind == (side < 0) && !drag.is_disc);
			/* The edge goes to where its circle is under the finger. */
			move(&drag, &of, eye_m, (float)side * sinf(angle), 0,
			     (float)side * cosf(angle));
			CHECK(is_near(turned(&drag, &of), angle));
		}
	drag_init(&drag, &of);
	take(&drag, &of, at_home, eye_m, 0, 0, -1);
	for (float x = 0; x > -9; x -= 0.5f)
		move(&drag, &of, eye_m, x, 0, 0);
	/* Beyond the edge that is seen it stays at the edge. */
	CHECK(is_near(drag.value[0], (float)M_PI / 2 + asinf(1 / 20.0f)));
	drag_end(&drag, &of);
	CHECK(drag.offset[0] == drag.value[0]);
}

/* Rolled on and on, a wheel turns more than once; at its limit it stops. */
static void a_wheel_turns_more_than_once(void **state)
{
	static const float eye_m[3] = { 0, 0, 50 }, above_m[3] = { 0, 50, 0.5f };
	const struct scenery_drag free = { .kind = SCENERY_DRAG_CYLINDER, .low = { 1 } };
	const struct scenery_drag disc = { .kind = SCENERY_DRAG_CYLINDER,
					   .high = { 7 },
					   .disc_rad = 0.262f };
	struct drag drag;

	(void)state;
	drag_init(&drag, &free);
	take(&drag, &free, at_home, eye_m, 0, 0, 1);
	for (float x = 0; x < 9; x += 0.1f)
		move(&drag, &free, eye_m, x, 0, 0);
	CHECK(drag.value[0] > 2 * (float)M_PI);
	/* From above it is a disc. The finger goes around it one and a half times. */
	drag_init(&drag, &disc);
	take(&drag, &disc, at_home, above_m, 0, 0, 1);
	CHECK(drag.is_disc);
	for (float angle = 0; angle < 9.42f; angle += 0.1f) {
		move(&drag, &disc, above_m, sinf(angle), 0, cosf(angle));
		CHECK(is_near(drag.value[0], fminf(angle, 7)));
	}
}

static void a_ball_turns_under_the_finger(void **state)
{
	static const float eye_m[3] = { 0, 0, 10 };
	const struct scenery_drag of = { .kind = SCENERY_DRAG_SPHERE, .offset = { 0, 0, 0, 1 } };
	const float angle = 0.7f;
	struct drag drag;

	(void)state;
	drag_init(&drag, &of);
	take(&drag, &of, at_home, eye_m, 0, 0, 2);
	move(&drag, &of, eye_m, 2 * sinf(angle), 0, 2 * cosf(angle));
	CHECK(is_near(drag.value[1], sinf(angle / 2)) && is_near(drag.value[3], cosf(angle / 2)));
	CHECK(is_near(drag.value[0], 0) && is_near(drag.value[2], 0));
	move(&drag, &of, eye_m, 0, 30, 0); /* past its edge: a quarter turn at most, about -x */
	CHECK(drag.value[0] < -0.6f && is_near(drag.value[1], 0));
}

static void what_has_no_size_is_not_held(void **state)
{
	static const float flat[16] = { 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 0, 0, 0, 0, 0, 1 };
	static const float at_m[3], direction[3] = { 0, 0, -1 };
	const struct scenery_drag of = { 0 };
	struct drag drag;

	(void)state;
	drag_init(&drag, &of);
	CHECK(!drag_begin(&drag, &of, flat, at_m, direction));
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(a_plane_is_that_of_its_handle),
		cmocka_unit_test(a_bolt_follows_from_any_side),
		cmocka_unit_test(a_door_follows_the_finger_on_both_sides),
		cmocka_unit_test(a_wheel_turns_more_than_once),
		cmocka_unit_test(a_ball_turns_under_the_finger),
		cmocka_unit_test(what_has_no_size_is_not_held),
	};

	return cmocka_run_group_tests(tests, NULL, NULL);
}
