/* Builds the spline through the stops, measures its legs, and evaluates it by time with a smooth
 * start and end of each run. */
#include "geometry/tour_path.h"

#include <assert.h>
#include <math.h>
#include <string.h>

#include "geometry/vec.h"

#define SPEED_SHARE     0.05f /* diagonals per second */
#define RADIAN_SHARE    0.1f  /* diagonals per radian: 0.5 radians (29 degrees) per second */
#define TRAVEL_LEAST_S  3.0f
#define PITCH_MAX       1.45f /* the kiosk's camera looks no steeper */
#define KNOT_MIN        1e-3f /* for two equal poses */
#define CLEARANCE_M     0.175f
#define CLEARANCE_SHARE 0.01f
#define MS              1000.0

float tour_path_clearance_m(float diagonal_m)
{
	return fminf(CLEARANCE_M, CLEARANCE_SHARE * diagonal_m);
}

/* ---- poses and knots */

static void set_pose(float pose[TOUR_AXES], const struct tour_view *stop, float metres_a_radian)
{
	float to[3];

	vec_sub(to, stop->target_m, stop->eye_m);
	memcpy(pose, stop->eye_m, sizeof(stop->eye_m));
	pose[3] = atan2f(to[1], to[0]) * metres_a_radian;
	pose[4] = fminf(fmaxf(atan2f(to[2], hypotf(to[0], to[1])), -PITCH_MAX), PITCH_MAX) *
		  metres_a_radian;
}

/* Keeps the direction but adds whole turns, so that the camera turns the short way round from the
 * pose before. */
static void turn_from(float pose[TOUR_AXES], const float before[TOUR_AXES], float metres_a_radian)
{
	const float round = 2 * (float)M_PI * metres_a_radian;

	pose[3] = before[3] + remainderf(pose[3] - before[3], round);
}

static float apart(const float a[TOUR_AXES], const float b[TOUR_AXES])
{
	float sum = 0;

	for (int i = 0; i < TOUR_AXES; i++)
		sum += (a[i] - b[i]) * (a[i] - b[i]);
	return sqrtf(sum);
}

/* Centripetal parametrisation: the knot interval is the square root of the distance to the next
 * pose. */
static void set_knots(struct tour_leg *leg)
{
	leg->knots[0] = 0;
	for (int i = 1; i < 4; i++)
		leg->knots[i] = leg->knots[i - 1] +
				fmaxf(sqrtf(apart(leg->poses[i - 1], leg->poses[i])), KNOT_MIN);
}

/* Evaluates the curve by the pyramid of Barry and Goldman; u is 0 to 1 within the leg. */
static void evaluate(const struct tour_leg *leg, float u, float out[TOUR_AXES])
{
	const float *k = leg->knots;
	const float t = k[1] + u * (k[2] - k[1]);
	float level[4][TOUR_AXES];

	memcpy(level, leg->poses, sizeof(level));
	for (int span = 1; span < 4; span++)
		for (int i = 0; i < 4 - span; i++) {
			/* The last step interpolates between the two poses in the middle. */
			const int low = span == 3 ? 1 : i, high = span == 3 ? 2 : i + span;
			const float share = (t - k[low]) / (k[high] - k[low]);

			for (int axis = 0; axis < TOUR_AXES; axis++)
				level[i][axis] += share * (level[i + 1][axis] - level[i][axis]);
		}
	memcpy(out, level[0], sizeof(level[0]));
}

static void measure(struct tour_leg *leg)
{
	float before[TOUR_AXES], at[TOUR_AXES];

	memcpy(before, leg->poses[1], sizeof(before));
	leg->to_m[0] = 0;
	for (int i = 1; i <= TOUR_PIECES; i++) {
		evaluate(leg, (float)i / TOUR_PIECES, at);
		leg->to_m[i] = leg->to_m[i - 1] + apart(before, at);
		memcpy(before, at, sizeof(before));
	}
}

/* ---- the way */

/* An end of an open path has no neighbour: mirrors the other pose at it, so that the curve goes
 * straight on. */
static void mirror(float out[TOUR_AXES], const float end[TOUR_AXES], const float other[TOUR_AXES])
{
	for (int i = 0; i < TOUR_AXES; i++)
		out[i] = 2 * end[i] - other[i];
}

static bool is_even(const struct tour_view *stops, uint32_t leg, uint32_t count)
{
	return stops[(leg + 1) % count].is_even;
}

static void set_leg(struct tour_path *path, const struct tour_view *stops, uint32_t leg,
		    bool closed)
{
	const uint32_t count = path->stop_count;
	struct tour_leg *own = &path->legs[leg];

	for (uint32_t i = 0; i < 4; i++)
		set_pose(own->poses[i], &stops[(leg + count + i - 1) % count],
			 path->metres_a_radian);
	turn_from(own->poses[2], own->poses[1], path->metres_a_radian);
	turn_from(own->poses[3], own->poses[2], path->metres_a_radian);
	turn_from(own->poses[0], own->poses[1], path->metres_a_radian);
	/* Four poses in even steps on a line: the curve is that line, at one speed. */
	if ((!closed && leg == 0) || is_even(stops, leg, count))
		mirror(own->poses[0], own->poses[1], own->poses[2]);
	if ((!closed && leg + 1 == path->leg_count) || is_even(stops, leg, count))
		mirror(own->poses[3], own->poses[2], own->poses[1]);
	set_knots(own);
	measure(own);
}

static float travel_s(const struct tour_path *path, const struct tour_view *stops, uint32_t leg,
		      float diagonal_m)
{
	const float told = stops[(leg + 1) % path->stop_count].travel_s;

	return told > 0 ? told : path->legs[leg].to_m[TOUR_PIECES] / (SPEED_SHARE * diagonal_m);
}

static void set_runs(struct tour_path *path, const struct tour_view *stops, float diagonal_m)
{
	const uint32_t count = path->stop_count;
	struct tour_run *run = NULL;
	double now_s = 0; /* when the run begins; its milliseconds are rounded, not added up */
	double end_s = 0;
	float move_s = 0;
	bool told = false;

	for (uint32_t leg = 0; leg < path->leg_count; leg++) {
		const bool even = is_even(stops, leg, count);

		if (leg == 0 || stops[leg].stay_s > 0 || even || run->is_even) {
			now_s = end_s + (double)stops[leg].stay_s;
			run = &path->runs[path->run_count++];
			*run = (struct tour_run){ .first_leg = leg,
						  .is_even = even,
						  .begin_ms = llround(now_s * MS) };
			move_s = 0;
			told = false;
		}
		run->leg_count++;
		run->length_m += path->legs[leg].to_m[TOUR_PIECES];
		move_s += travel_s(path, stops, leg, diagonal_m);
		told |= stops[(leg + 1) % count].travel_s > 0;
		end_s = now_s + (double)(told ? move_s : fmaxf(move_s, TRAVEL_LEAST_S));
		run->move_ms = llround(end_s * MS) - run->begin_ms;
	}
	if (path->leg_count < count) /* it ends after the last stay, not on arrival */
		end_s += (double)stops[count - 1].stay_s;
	path->duration_ms = llround(end_s * MS);
}

void tour_path_init(struct tour_path *path, const struct tour_view *stops, uint32_t count,
		    bool closed, float diagonal_m)
{
	assert(count >= 2 && count <= TOUR_STOPS_MAX && diagonal_m > 0);
	*path = (struct tour_path){ .stop_count = count,
				    .leg_count = closed ? count : count - 1,
				    .metres_a_radian = RADIAN_SHARE * diagonal_m };
	for (uint32_t leg = 0; leg < path->leg_count; leg++)
		set_leg(path, stops, leg, closed);
	set_runs(path, stops, diagonal_m);
}

/* ---- where it is */

static void pose_at(const struct tour_path *path, uint32_t leg, float way_m, float pose[TOUR_AXES])
{
	const float *to = path->legs[leg].to_m;
	int low = 0, high = TOUR_PIECES;
	float piece_m;

	while (high - low > 1) {
		const int middle = (low + high) / 2;

		if (to[middle] <= way_m)
			low = middle;
		else
			high = middle;
	}
	piece_m = to[high] - to[low];
	evaluate(&path->legs[leg],
		 ((float)low + (piece_m > 0 ? fminf((way_m - to[low]) / piece_m, 1) : 0)) /
			 TOUR_PIECES,
		 pose);
}

static void set_out(const struct tour_path *path, const float pose[TOUR_AXES],
		    struct tour_pose *out)
{
	const float yaw = pose[3] / path->metres_a_radian;
	const float pitch = fminf(fmaxf(pose[4] / path->metres_a_radian, -PITCH_MAX), PITCH_MAX);

	memcpy(out->eye_m, pose, sizeof(out->eye_m));
	out->target_m[0] = pose[0] + cosf(pitch) * cosf(yaw);
	out->target_m[1] = pose[1] + cosf(pitch) * sinf(yaw);
	out->target_m[2] = pose[2] + sinf(pitch);
}

/* Returns the run in progress, or the next one while the camera stays before it. */
static const struct tour_run *run_at(const struct tour_path *path, int64_t ms)
{
	uint32_t i = path->run_count - 1;

	while (i > 0 && ms < path->runs[i].begin_ms) {
		const struct tour_run *before = &path->runs[i - 1];

		if (ms >= before->begin_ms + before->move_ms)
			break; /* it stays before this run begins */
		i--;
	}
	return &path->runs[i];
}

void tour_path_pose(const struct tour_path *path, int64_t ms, struct tour_pose *out)
{
	const struct tour_run *run = run_at(path, ms);
	const int64_t since = ms - run->begin_ms;
	const float part = since >= run->move_ms ? 1
			   : since > 0           ? (float)since / (float)run->move_ms
						 : 0;
	const float share = run->is_even ? part : part * part * (3 - 2 * part);
	float way_m = run->length_m * share, pose[TOUR_AXES];
	uint32_t leg = run->first_leg;
	const uint32_t last = run->first_leg + run->leg_count - 1;

	while (leg < last && way_m > path->legs[leg].to_m[TOUR_PIECES])
		way_m -= path->legs[leg++].to_m[TOUR_PIECES];
	pose_at(path, leg, way_m, pose);
	set_out(path, pose, out);
	out->moves = since >= 0 && since < run->move_ms;
	out->stop = since < 0 ? leg : (leg + 1) % path->stop_count;
}

void tour_path_place(const struct tour_path *path, uint32_t leg, float share, float eye_m[3])
{
	float pose[TOUR_AXES];

	pose_at(path, leg, share * tour_path_leg_m(path, leg), pose);
	memcpy(eye_m, pose, 3 * sizeof(*eye_m));
}

float tour_path_leg_m(const struct tour_path *path, uint32_t leg)
{
	return path->legs[leg].to_m[TOUR_PIECES];
}

int64_t tour_path_rest_ms(const struct tour_path *path, int64_t ms)
{
	const struct tour_run *run = run_at(path, ms);

	if (ms < run->begin_ms)
		return run->begin_ms - ms;
	if (ms < run->begin_ms + run->move_ms || ms >= path->duration_ms)
		return 0;
	return path->duration_ms - ms; /* the stay at the last stop */
}
