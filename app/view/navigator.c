/* Moves the eye: turning, zooming and panning about a pivot, flings that slow down, and timed
 * flights. The eye stays within bounds. */
#include "app/view/navigator.h"

#include <math.h>

#include "geometry/foot_way.h"
#include "geometry/solid_space.h"
#include "geometry/vec.h"

#define PITCH_MAX      1.45f /* radians; beyond it "up" on the panel would flip */
#define FLING_DECAY_MS 325.0f
#define FLING_MIN      8.0f /* px/s; slower counts as stopped */
/* Distances: in metres for a temple; for a model smaller than a house, as a share of its diagonal.
 * The smaller of the two counts. */
#define GROUND_LEAST_M     0.25f /* lowest height of the eye above the bottom of the box */
#define GROUND_LEAST_SHARE 0.005f
#define KEEP_OFF_M         0.35f /* smallest distance of the eye to a surface */
#define KEEP_OFF_SHARE     0.02f
#define LONGER_MAX         2.0f   /* largest factor by which a way around prolongs a flight */
#define MARGIN_SHARE       0.005f /* of KEEP_OFF_M: where the eye stops before its space ends */
#define FAR_SHARE          2.5f   /* largest distance of the eye, in half diagonals of the model */
#define FAR_OVER_HOME      1.1f   /* or in distances of the first view, if more */
#define STANDING_M         1.6f   /* the eye's height on foot */
#define STANDS_M           0.5f   /* so far above that it still stands there */
#define WALK_M_PER_S       3.0f   /* brisk: visitors wait */
#define WALK_MS_MIN        600.0f
#define WALK_MS_MAX        12000.0f
#define DESCENT_MS         1800.0f /* of the flight to the floor */
#define AHEAD_M            2.0f    /* what a walk looks at on its way */
#define TURN_MS            350.0f  /* in which it has turned there, but for a third */
#define PACE_M             2.0f    /* a pinch by a factor of e walks so far */
#define FOOT_STEP_M        0.3f
#define VIEW_M             1.5f /* what is farther off is seen as well as anything */

enum { HEADINGS = 16 };

static void view_direction(const struct navigator *nav, float out[3])
{
	out[0] = cosf(nav->pitch) * cosf(nav->yaw);
	out[1] = cosf(nav->pitch) * sinf(nav->yaw);
	out[2] = sinf(nav->pitch);
}

static void view_right(const struct navigator *nav, float out[3])
{
	out[0] = sinf(nav->yaw);
	out[1] = -cosf(nav->yaw);
	out[2] = 0;
}

static float clamp(float value, float least, float most)
{
	return fminf(fmaxf(value, least), most);
}

/* Rotates v by an angle about an axis, a unit vector; anticlockwise where the axis points to the
 * viewer. Rodrigues' rotation formula. */
static void rotate(float v[3], float angle, const float axis[3])
{
	const float along = vec_dot(axis, v) * (1 - cosf(angle));
	float across[3];

	vec_cross(across, axis, v);
	vec_scale(v, cosf(angle), v);
	vec_add_scaled(v, v, sinf(angle), across);
	vec_add_scaled(v, v, along, axis);
}

float navigator_diagonal_m(const struct navigator *nav)
{
	return vec_distance(nav->options.box_min_m, nav->options.box_max_m);
}

float navigator_keep_off_m(const struct navigator *nav)
{
	return fminf(KEEP_OFF_M, KEEP_OFF_SHARE * navigator_diagonal_m(nav));
}

static float lowest_m(const struct navigator *nav)
{
	return nav->options.box_min_m[2] +
	       fminf(GROUND_LEAST_M, GROUND_LEAST_SHARE * navigator_diagonal_m(nav));
}

/* Returns the largest distance of the eye from the model's centre, which it writes to middle_m. */
static float farthest_m(const struct navigator *nav, float middle_m[3])
{
	vec_mix(middle_m, nav->options.box_min_m, nav->options.box_max_m, 0.5f);
	return fmaxf(FAR_SHARE * navigator_diagonal_m(nav) / 2,
		     FAR_OVER_HOME * vec_distance(nav->options.home_eye_m, middle_m));
}

/* Moves eye_m to the nearest allowed place: near the model and above the ground. */
static void keep_in_bounds(const struct navigator *nav, float eye_m[3])
{
	float middle[3], from_middle[3], distance;
	const float most = farthest_m(nav, middle);

	vec_sub(from_middle, eye_m, middle);
	distance = vec_length(from_middle);
	if (distance > most) {
		vec_scale(from_middle, most / distance, from_middle);
		vec_add(eye_m, middle, from_middle);
	}
	eye_m[2] = fmaxf(eye_m[2], lowest_m(nav));
}

static const struct solid *solid_of(const struct navigator *nav)
{
	return nav->options.solid ? nav->options.solid(nav->options.data) : NULL;
}

/* Returns how far the eye may go from from_m, a little less than where its space ends, at most
 * length_m. */
static float reach(const struct navigator *nav, const float from_m[3], const float direction[3],
		   float length_m, int *axis)
{
	const struct navigator_options *o = &nav->options;
	const float margin_m = MARGIN_SHARE * navigator_keep_off_m(nav);
	float reach_m;

	*axis = -1;
	if (!o->reach)
		return length_m;
	reach_m = o->reach(o->data, from_m, direction, length_m + margin_m, axis) - margin_m;
	return clamp(reach_m, 0, length_m);
}

/* An eye that was put into stone, by a pose of the content or another release, comes out of it
 * before it is moved: no way leads on from there. */
static void leave_stone(struct navigator *nav)
{
	const struct solid *solid = solid_of(nav);
	const float up[3] = { 0, 0, 1 };
	float free_m[3];
	int axis;

	/* What the section cuts away holds nobody up, though the octree has it. */
	if (solid && !solid_is_free(solid, nav->eye_m) &&
	    nav->options.reach(nav->options.data, nav->eye_m, up, 1, &axis) <= 0 &&
	    solid_nearest_free(solid, nav->eye_m, INFINITY, free_m))
		vec_copy(nav->eye_m, free_m);
}

/* Moves the eye towards to_m until something is in the way, and then along that. Returns true if it
 * got there. to_m is first moved into the bounds. */
static bool move_eye(struct navigator *nav, float to_m[3])
{
	const float least_m = 1e-6f * navigator_diagonal_m(nav);
	float left[3];

	keep_in_bounds(nav, to_m);
	vec_sub(left, to_m, nav->eye_m);
	for (int slide = 0; slide < 3; slide++) {
		float direction[3], length_m, go_m;
		int axis;

		vec_copy(direction, left);
		length_m = vec_normalise(direction);
		if (length_m < least_m)
			return slide == 0;
		go_m = reach(nav, nav->eye_m, direction, length_m, &axis);
		if (go_m >= length_m && slide == 0) {
			vec_copy(nav->eye_m, to_m);
			return true;
		}
		vec_add_scaled(nav->eye_m, nav->eye_m, go_m, direction);
		vec_add_scaled(left, left, -go_m, direction);
		if (axis < 0)
			return false;
		left[axis] = 0;
	}
	return false;
}

static void stop(struct navigator *nav)
{
	nav->fling_px_s[0] = nav->fling_px_s[1] = 0;
	nav->flight_left_ms = 0;
}

static void angles_of(const float from[3], const float to[3], float *yaw, float *pitch)
{
	const float dx = to[0] - from[0], dy = to[1] - from[1], dz = to[2] - from[2];

	*yaw = atan2f(dy, dx);
	*pitch = clamp(atan2f(dz, hypotf(dx, dy)), -PITCH_MAX, PITCH_MAX);
}

void navigator_look(struct navigator *nav, const float eye_m[3], const float target_m[3])
{
	stop(nav);
	vec_copy(nav->eye_m, eye_m);
	vec_copy(nav->pivot_m, target_m);
	angles_of(eye_m, target_m, &nav->yaw, &nav->pitch);
}

void navigator_init(struct navigator *nav, const struct navigator_options *options)
{
	*nav = (struct navigator){ .options = *options };
	navigator_look(nav, options->home_eye_m, options->home_target_m);
}

void navigator_grab(struct navigator *nav, const float pivot_m[3])
{
	stop(nav);
	vec_copy(nav->pivot_m, pivot_m);
}

/* ---- on foot */

static struct foot foot_of(const struct navigator *nav)
{
	return (struct foot){ .solid = solid_of(nav),
			      .ground_m = nav->options.box_min_m[2],
			      .height_m = STANDING_M };
}

/* Returns whether the eye is where somebody stands, and not in the air; *at becomes where. */
static bool stands(const struct navigator *nav, struct foot_stance *at)
{
	const struct foot foot = foot_of(nav);

	return foot.solid && foot_stand(&foot, nav->eye_m, INFINITY, at) &&
	       nav->eye_m[2] <= at->eye_m[2] + STANDS_M;
}

/* In the air, from where the first walk leads down, fingers move the eye as ever. */
static bool walks_now(const struct navigator *nav)
{
	struct foot_stance at;

	return nav->on_foot && stands(nav, &at);
}

/* As if the picture were held by the finger. */
static void look_around(struct navigator *nav, float dx_px, float dy_px, float height_px)
{
	const float radians_per_px = nav->options.fov_deg * (float)M_PI / 180 / height_px;

	nav->yaw += dx_px * radians_per_px;
	nav->pitch = clamp(nav->pitch + dy_px * radians_per_px, -PITCH_MAX, PITCH_MAX);
}

/* Steps by a distance forward and to the right, as far as there is a floor. */
static void step_on(struct navigator *nav, float forward_m, float right_m)
{
	const struct foot foot = foot_of(nav);
	const float x = forward_m * cosf(nav->yaw) + right_m * sinf(nav->yaw);
	const float y = forward_m * sinf(nav->yaw) - right_m * cosf(nav->yaw);
	const int steps = (int)ceilf(hypotf(x, y) / FOOT_STEP_M);
	struct foot_stance at;

	if (!stands(nav, &at))
		return;
	for (int i = 0; i < steps; i++) {
		const float by_x = x / (float)steps, by_y = y / (float)steps;

		/* Along a wall only one of the two leads on. */
		if (!foot_step(&foot, &at, at.eye_m[0] + by_x, at.eye_m[1] + by_y, &at) &&
		    !foot_step(&foot, &at, at.eye_m[0] + by_x, at.eye_m[1], &at) &&
		    !foot_step(&foot, &at, at.eye_m[0], at.eye_m[1] + by_y, &at))
			break;
	}
	vec_copy(nav->eye_m, at.eye_m);
	keep_in_bounds(nav, nav->eye_m);
}

/* Turns eye and view rigidly about the pivot, so that the pivot stays where it is on the panel.
 * Where a wall or the ground holds the eye, the view does not turn either. */
static void turn_about_pivot(struct navigator *nav, float yaw_by, float pitch_by)
{
	const float pitch = clamp(nav->pitch + pitch_by, -PITCH_MAX, PITCH_MAX);
	float arm[3], right[3], eye[3];
	float up[3] = { 0, 0, 1 };
	struct navigator before;

	leave_stone(nav);
	before = *nav;
	vec_sub(arm, nav->eye_m, nav->pivot_m);
	view_right(nav, right);
	rotate(arm, pitch - nav->pitch, right);
	rotate(arm, yaw_by, up);
	vec_add(eye, nav->pivot_m, arm);
	nav->pitch = pitch;
	nav->yaw += yaw_by;
	if (eye[2] < lowest_m(nav) || !move_eye(nav, eye)) {
		*nav = before;
		nav->fling_px_s[0] = nav->fling_px_s[1] = 0;
		if (yaw_by != 0 && pitch != nav->pitch)
			turn_about_pivot(nav, yaw_by, 0); /* slide along the obstacle */
	}
}

void navigator_turn(struct navigator *nav, float dx_px, float dy_px, float height_px)
{
	const float radians_per_px = (float)M_PI / height_px;

	if (walks_now(nav)) {
		look_around(nav, dx_px, dy_px, height_px);
		return;
	}
	turn_about_pivot(nav, -dx_px * radians_per_px, dy_px * -radians_per_px);
}

void navigator_pinch(struct navigator *nav, float scale, float dx_px, float dy_px, float twist,
		     float height_px)
{
	const float focal_px = height_px / 2 / tanf(nav->options.fov_deg * (float)M_PI / 360);
	float direction[3], right[3], up[3], arm[3], eye[3], depth;

	leave_stone(nav);
	if (walks_now(nav)) {
		const float forward =
			scale > 0 && isfinite(scale) ? logf(clamp(scale, 0.2f, 5)) : 0;

		step_on(nav, PACE_M * forward, -PACE_M * 2 * dx_px / height_px);
		look_around(nav, 0, dy_px, height_px);
		nav->yaw += twist;
		return;
	}
	if (scale > 0 && isfinite(scale)) {
		vec_sub(arm, nav->eye_m, nav->pivot_m);
		vec_scale(arm, 1 / clamp(scale, 0.2f, 5), arm);
		vec_add(eye, nav->pivot_m, arm);
		move_eye(nav, eye);
	}
	view_direction(nav, direction);
	view_right(nav, right);
	vec_cross(up, right, direction);
	vec_sub(arm, nav->pivot_m, nav->eye_m);
	depth = fmaxf(vec_dot(arm, direction), navigator_keep_off_m(nav) / 3);
	vec_copy(eye, nav->eye_m);
	vec_add_scaled(eye, eye, -dx_px * depth / focal_px, right);
	vec_add_scaled(eye, eye, dy_px * depth / focal_px, up);
	move_eye(nav, eye);
	if (twist != 0)
		turn_about_pivot(nav, twist, 0);
}

void navigator_fling(struct navigator *nav, float vx_px_s, float vy_px_s)
{
	nav->fling_px_s[0] = vx_px_s;
	nav->fling_px_s[1] = vy_px_s;
}

/* Plans the way of a flight. Returns whether there is one; else it is its last point alone. */
static bool plan(struct navigator *nav, const float to_m[3])
{
	const struct solid *solid = solid_of(nav);
	float direction[3], to[3], length_m;
	int axis, rc = 0;

	vec_copy(to, to_m);
	keep_in_bounds(nav, to);
	vec_sub(direction, to, nav->eye_m);
	length_m = vec_normalise(direction);
	solid_way_straight(&nav->way, nav->eye_m, to);
	if (reach(nav, nav->eye_m, direction, length_m, &axis) >= length_m)
		return true;
	if (solid)
		rc = solid_way_plan(&nav->way, solid, nav->eye_m, to);
	if (solid && rc == 0)
		return true;
	vec_copy(to, solid_way_end_m(&nav->way));
	solid_way_straight(&nav->way, to, to);
	return false;
}

void navigator_fly(struct navigator *nav, const float eye_m[3], const float target_m[3],
		   float duration_ms)
{
	float turn, straight_m, longer;

	stop(nav);
	if (!plan(nav, eye_m))
		duration_ms = 1;
	straight_m = vec_distance(nav->eye_m, solid_way_end_m(&nav->way));
	longer = straight_m > 0 ? solid_way_length_m(&nav->way) / straight_m : 1;
	vec_copy(nav->pivot_m, target_m);
	nav->from_yaw = nav->yaw;
	nav->from_pitch = nav->pitch;
	angles_of(solid_way_end_m(&nav->way), target_m, &nav->to_yaw, &nav->to_pitch);
	turn = remainderf(nav->to_yaw - nav->from_yaw, 2 * (float)M_PI); /* the shorter way round */
	nav->to_yaw = nav->from_yaw + turn;
	nav->walks = false;
	nav->flight_ms = nav->flight_left_ms = fmaxf(duration_ms * clamp(longer, 1, LONGER_MAX), 1);
}

void navigator_set_on_foot(struct navigator *nav, bool on_foot)
{
	nav->on_foot = on_foot;
}

/* Returns the heading nearest to the given one in which somebody at a place sees something of it,
 * and does not stand before a wall. */
static float open_heading(const struct navigator *nav, const float eye_m[3], float heading)
{
	float best = heading, best_score = -INFINITY;

	for (int i = 0; i < HEADINGS; i++) {
		const float turn =
			2 * (float)M_PI / HEADINGS * (float)((i + 1) / 2) * (i % 2 ? 1.0f : -1.0f);
		const float direction[3] = { cosf(heading + turn), sinf(heading + turn), 0 };
		int axis;
		const float score =
			reach(nav, eye_m, direction, VIEW_M, &axis) / VIEW_M - 0.2f * fabsf(turn);

		if (score > best_score) {
			best_score = score;
			best = heading + turn;
		}
	}
	return best;
}

/* The heading of a way's end: where its last part leads. */
static float last_heading(const struct navigator *nav)
{
	const float length_m = solid_way_length_m(&nav->way), *end = solid_way_end_m(&nav->way);
	float before[3];

	solid_way_at(&nav->way, vec_most(1 - AHEAD_M / vec_most(length_m, AHEAD_M), 0), before);
	return atan2f(end[1] - before[1], end[0] - before[0]);
}

/* Looks at what was touched, if that is not the floor under the feet. */
static float heading_to(const float touched_m[3], const float end_m[3], float otherwise)
{
	const float x = touched_m[0] - end_m[0], y = touched_m[1] - end_m[1];

	return hypotf(x, y) > FOOT_STEP_M ? atan2f(y, x) : otherwise;
}

bool navigator_walk(struct navigator *nav, const float touched_m[3])
{
	const struct foot foot = foot_of(nav);
	struct foot_stance from, to;

	if (!foot.solid || !foot_stand_at(&foot, touched_m, nav->eye_m, &to))
		return false;
	stop(nav);
	leave_stone(nav);
	if (!stands(nav, &from)) {
		const float heading =
			heading_to(touched_m, to.eye_m, open_heading(nav, to.eye_m, nav->yaw));
		float ahead[3];

		vec_copy(ahead, to.eye_m);
		ahead[0] += cosf(heading);
		ahead[1] += sinf(heading);
		navigator_fly(nav, to.eye_m, ahead, DESCENT_MS);
		return true;
	}
	if (foot_way_plan(&nav->way, &foot, &from, &to) < 0)
		return false;
	nav->walks = true;
	nav->to_yaw = heading_to(touched_m, solid_way_end_m(&nav->way), last_heading(nav));
	nav->to_pitch = 0;
	nav->flight_ms = nav->flight_left_ms = clamp(
		solid_way_length_m(&nav->way) / WALK_M_PER_S * 1000, WALK_MS_MIN, WALK_MS_MAX);
	return true;
}

void navigator_goal(const struct navigator *nav, float eye_m[3], float target_m[3])
{
	struct navigator there = *nav;
	float direction[3];

	if (nav->flight_left_ms > 0) {
		vec_copy(there.eye_m, solid_way_end_m(&nav->way));
		there.yaw = nav->to_yaw;
		there.pitch = nav->to_pitch;
	}
	view_direction(&there, direction);
	vec_copy(eye_m, there.eye_m);
	vec_copy(target_m, there.eye_m);
	vec_add_scaled(target_m, target_m, fmaxf(vec_distance(there.eye_m, there.pivot_m), 1e-3f),
		       direction);
}

bool navigator_is_left_alone(const struct navigator *nav)
{
	return nav->flight_left_ms > 0 ||
	       (nav->flight_ms > 0 &&
		vec_distance(nav->eye_m, solid_way_end_m(&nav->way)) < 1e-3f &&
		fabsf(remainderf(nav->yaw - nav->to_yaw, 2 * (float)M_PI)) < 1e-4f &&
		fabsf(nav->pitch - nav->to_pitch) < 1e-4f);
}

/* Turns to where the walk leads, as a head does. */
static void look_ahead(struct navigator *nav, float share, float dt_ms)
{
	const float length_m = vec_most(solid_way_length_m(&nav->way), 1e-3f);
	const float turned = 1 - expf(-dt_ms / TURN_MS);
	float ahead[3], yaw = nav->to_yaw;

	solid_way_at(&nav->way, vec_least(share + AHEAD_M / length_m, 1), ahead);
	if (share + AHEAD_M / length_m < 1)
		yaw = atan2f(ahead[1] - nav->eye_m[1], ahead[0] - nav->eye_m[0]);
	nav->yaw += turned * remainderf(yaw - nav->yaw, 2 * (float)M_PI);
	nav->pitch += turned * (nav->to_pitch - nav->pitch);
}

static void step_flight(struct navigator *nav, float dt_ms)
{
	float t;

	nav->flight_left_ms = fmaxf(0, nav->flight_left_ms - dt_ms);
	t = 1 - nav->flight_left_ms / nav->flight_ms;
	t = t * t * (3 - 2 * t);
	solid_way_at(&nav->way, t, nav->eye_m);
	if (nav->walks) {
		look_ahead(nav, t, dt_ms);
		return;
	}
	nav->yaw = nav->from_yaw + t * (nav->to_yaw - nav->from_yaw);
	nav->pitch = nav->from_pitch + t * (nav->to_pitch - nav->from_pitch);
}

bool navigator_step(struct navigator *nav, float dt_ms, float height_px)
{
	float decay;

	if (nav->flight_left_ms > 0) {
		step_flight(nav, dt_ms);
		return true;
	}
	if (hypotf(nav->fling_px_s[0], nav->fling_px_s[1]) < FLING_MIN) {
		nav->fling_px_s[0] = nav->fling_px_s[1] = 0;
		return false;
	}
	navigator_turn(nav, nav->fling_px_s[0] * dt_ms / 1000, nav->fling_px_s[1] * dt_ms / 1000,
		       height_px);
	decay = expf(-dt_ms / FLING_DECAY_MS);
	nav->fling_px_s[0] *= decay;
	nav->fling_px_s[1] *= decay;
	return true;
}

void navigator_camera(const struct navigator *nav, struct camera *camera)
{
	float direction[3];
	float middle[3];
	const float reach = 2 * farthest_m(nav, middle) + navigator_diagonal_m(nav);

	view_direction(nav, direction);
	vec_copy(camera->eye_m, nav->eye_m);
	vec_add(camera->target_m, nav->eye_m, direction);
	camera->up[0] = camera->up[1] = 0;
	camera->up[2] = 1;
	camera->fov_deg = nav->options.fov_deg;
	camera->near_m = navigator_keep_off_m(nav) / 3;
	camera->far_m = reach;
}
