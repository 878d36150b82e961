/* A* over stances on a grid of places a step apart, of which straight walks leave out what they
 * can. A place may have several floors, one above the other. */
#include "geometry/foot_way.h"

#include <errno.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/array.h"
#include "base/map.h"
#include "geometry/search_queue.h"
#include "geometry/solid_space.h"
#include "geometry/vec.h"

#define STEP_M      0.35f /* between neighbouring places */
#define UP_M        0.6f  /* a step up: stairs of temples are steep, up to 60 degrees */
#define DOWN_M      0.8f
#define STOOP_M     0.5f   /* the lowest an eye goes above the floor */
#define LIFT_M      0.002f /* above a floor, where it is free */
#define STOOP_COST  2.0f   /* a metre of way, for each metre that the head is lowered */
#define CLIMB_COST  0.5f   /* for each metre up or down */
#define EAGERNESS   1.5f   /* as that of flights: not always the shortest way, but found soon */
#define FLOORS_M    0.4f   /* floors of one place are at least so far apart */
#define UNEVEN_M    0.08f  /* a floor may be a few times so much higher than where it was touched */
#define BEFORE_M    0.9f   /* from a wall that was touched */
#define EVEN_ROUNDS 6      /* in which the heights of a way are evened out */
#define OFF_LINE_M  0.1f   /* a straight line may leave out what is so near to it */

enum { PLACES_MAX = 8000, TRIALS = 4 };

/* ---- standing ---- */

static float lowest_m(const struct foot *foot)
{
	return foot->ground_m + foot->solid->room_m;
}

bool foot_stand(const struct foot *foot, const float from_m[3], float drop_m,
		struct foot_stance *out)
{
	const float down[3] = { 0, 0, -1 }, up[3] = { 0, 0, 1 };
	const float room_m = foot->solid->room_m, upright_m = foot->height_m - room_m;
	const float least_m = lowest_m(foot);
	float feet[3], head_m, fall_m;

	if (from_m[2] < least_m || !solid_is_free(foot->solid, from_m))
		return false;
	fall_m = solid_reach(foot->solid, from_m, down, from_m[2] - least_m, NULL);
	if (isinf(fall_m))
		fall_m = from_m[2] - least_m;
	if (fall_m > drop_m)
		return false;
	vec_copy(feet, from_m);
	feet[2] -= vec_most(fall_m - LIFT_M, 0);
	head_m = solid_reach(foot->solid, feet, up, upright_m + LIFT_M, NULL);
	head_m = vec_least(head_m - LIFT_M, upright_m);
	if (head_m < STOOP_M - room_m)
		return false;
	out->floor_m = from_m[2] - fall_m;
	vec_copy(out->eye_m, feet);
	out->eye_m[2] += head_m;
	return true;
}

bool foot_stand_at(const struct foot *foot, const float touched_m[3], const float eye_m[3],
		   struct foot_stance *out)
{
	const float flat[3] = { eye_m[0] - touched_m[0], eye_m[1] - touched_m[1], 0 };
	const float far_m = vec_length(flat);
	float at[3];

	for (int i = 1; i <= TRIALS; i++) {
		vec_copy(at, touched_m);
		at[2] = vec_most(at[2], foot->ground_m) + foot->solid->room_m + UNEVEN_M * (float)i;
		if (foot_stand(foot, at, UP_M, out))
			return true;
	}
	for (int i = 1; i <= TRIALS && far_m > 0; i++) {
		vec_copy(at, touched_m);
		vec_add_scaled(at, at, vec_least(BEFORE_M * (float)i / far_m, 1), flat);
		if (foot_stand(foot, at, INFINITY, out))
			return true;
	}
	return false;
}

static bool heads_pass(const struct foot *foot, const struct foot_stance *from,
		       const struct foot_stance *to)
{
	const float z = vec_least(from->eye_m[2], to->eye_m[2]);
	const float a[3] = { from->eye_m[0], from->eye_m[1], z };
	const float b[3] = { to->eye_m[0], to->eye_m[1], z };

	return solid_way_is_free(foot->solid, from->eye_m, to->eye_m) ||
	       (z >= vec_most(from->floor_m, to->floor_m) && solid_way_is_free(foot->solid, a, b));
}

bool foot_step(const struct foot *foot, const struct foot_stance *from, float x_m, float y_m,
	       struct foot_stance *out)
{
	const float heights[2] = { UP_M, UP_M / 3 };
	struct foot_stance next;

	for (int i = 0; i < 2; i++) {
		const float z = vec_least(from->floor_m + heights[i], from->eye_m[2]);
		const float here[3] = { from->eye_m[0], from->eye_m[1], z };
		const float there[3] = { x_m, y_m, z };

		/* Knees and head must get there: nobody steps through a balustrade, and who stoops
		 * on one side stoops on the other. */
		if (foot_stand(foot, there, heights[i] + DOWN_M, &next) &&
		    solid_way_is_free(foot->solid, here, there) && heads_pass(foot, from, &next)) {
			*out = next;
			return true;
		}
	}
	return false;
}

/* ---- the search ---- */

struct place {
	struct foot_stance stance;
	int32_t at[2]; /* in steps from the start */
	uint32_t from; /* index of the place before */
	float cost;
	bool done;
};

struct search {
	const struct foot *foot;
	const struct foot_stance *to;
	float origin_m[2];
	struct place *places; /* owned */
	uint32_t place_count, place_room;
	struct search_queue queue; /* by cost, and EAGERNESS times the distance that is left */
	struct map place_of;       /* by column and floor */
	uint32_t nearest;          /* to the end */
};

static float left_m(const struct search *search, const struct foot_stance *stance)
{
	return vec_distance(stance->eye_m, search->to->eye_m);
}

static float cost_m(const struct foot *foot, const struct foot_stance *from,
		    const struct foot_stance *to)
{
	const float across = hypotf(to->eye_m[0] - from->eye_m[0], to->eye_m[1] - from->eye_m[1]);
	const float upright = foot->height_m - foot->solid->room_m;
	const float stoop = upright - (to->eye_m[2] - to->floor_m);

	return across * (1 + STOOP_COST * vec_most(stoop, 0)) +
	       CLIMB_COST * fabsf(to->floor_m - from->floor_m);
}

static map_key key_of(const int32_t at[2], float floor_m)
{
	return (map_key)(uint32_t)at[0] << 64 | (map_key)(uint32_t)at[1] << 32 |
	       (uint32_t)(int32_t)floorf(floor_m / FLOORS_M);
}

/* Comes to a place; keeps the cheapest way. */
static int come(struct search *search, const struct foot_stance *stance, const int32_t at[2],
		uint32_t from, float cost)
{
	const map_key key = key_of(at, stance->floor_m);
	uint64_t index = map_get(&search->place_of, key);

	if (index == MAP_NONE) {
		if (search->place_count == PLACES_MAX)
			return 0;
		index = search->place_count;
		if (ARRAY_RESERVE(search->places, search->place_room, search->place_count + 1,
				  UINT32_MAX) < 0 ||
		    map_set(&search->place_of, key, index) < 0)
			return -ENOMEM;
		search->places[search->place_count++] = (struct place){ .cost = INFINITY };
	}
	/* One that was left already is not left again, though a cheaper way to it may be found. */
	if (search->places[index].done || search->places[index].cost <= cost)
		return 0;
	search->places[index] = (struct place){ *stance, { at[0], at[1] }, from, cost, false };
	if (left_m(search, stance) < left_m(search, &search->places[search->nearest].stance))
		search->nearest = (uint32_t)index;
	return search_queue_add(&search->queue, cost + EAGERNESS * left_m(search, stance),
				(uint32_t)index);
}

static int step_out(struct search *search, uint32_t index)
{
	const struct place here = search->places[index];
	int rc = 0;

	for (int way = 0; rc == 0 && way < 9; way++) {
		const int32_t at[2] = { here.at[0] + way % 3 - 1, here.at[1] + way / 3 - 1 };
		struct foot_stance next;

		if (way != 4 && foot_step(search->foot, &here.stance,
					  search->origin_m[0] + STEP_M * (float)at[0],
					  search->origin_m[1] + STEP_M * (float)at[1], &next))
			rc = come(search, &next, at, index,
				  here.cost + cost_m(search->foot, &here.stance, &next));
	}
	return rc;
}

/* Whether the end is a step away. */
static bool is_there(const struct search *search, uint32_t index)
{
	const struct foot_stance *stance = &search->places[index].stance, *to = search->to;
	const float across =
		hypotf(stance->eye_m[0] - to->eye_m[0], stance->eye_m[1] - to->eye_m[1]);
	struct foot_stance last;

	return across < STEP_M && fabsf(stance->floor_m - to->floor_m) < UP_M &&
	       foot_step(search->foot, stance, to->eye_m[0], to->eye_m[1], &last) &&
	       fabsf(last.floor_m - to->floor_m) < LIFT_M;
}

/* Returns 1 if the end was found, as the nearest place; 0 if only a nearer one; or an error. */
static int find(struct search *search, const struct foot_stance *from)
{
	const int32_t at[2] = { 0, 0 };
	int rc;

	search->origin_m[0] = from->eye_m[0];
	search->origin_m[1] = from->eye_m[1];
	rc = come(search, from, at, 0, 0);
	while (rc == 0 && search->queue.count > 0) {
		const uint32_t index = search_queue_take(&search->queue);

		if (search->places[index].done)
			continue;
		search->places[index].done = true;
		if (is_there(search, index)) {
			search->nearest = index;
			return 1;
		}
		rc = step_out(search, index);
	}
	return rc < 0 ? rc : search->nearest == 0 ? -ENOENT : 0;
}

/* ---- the way ---- */

/* Walks straight to another stance, in steps. Returns whether that leads there. */
static bool is_straight(const struct foot *foot, const struct foot_stance *from,
			const struct foot_stance *to)
{
	const float x = to->eye_m[0] - from->eye_m[0], y = to->eye_m[1] - from->eye_m[1];
	const int steps = (int)ceilf(hypotf(x, y) / STEP_M);
	struct foot_stance at = *from;

	for (int i = 1; i <= steps; i++) {
		const float share = (float)i / (float)steps;

		if (!foot_step(foot, &at, from->eye_m[0] + share * x, from->eye_m[1] + share * y,
			       &at))
			return false;
	}
	return fabsf(at.floor_m - to->floor_m) < LIFT_M;
}

/* Keeps only the corners of the way: from each place it goes straight as far as doubled and halved
 * strides find that it may. Returns how many there are. */
static uint32_t pull(const struct foot *foot, struct foot_stance *stances, uint32_t count)
{
	uint32_t kept = 1;

	for (uint32_t at = 0; at + 1 < count;) {
		uint32_t next = at + 1, stride = 1;

		while (next + stride < count &&
		       is_straight(foot, &stances[at], &stances[next + stride])) {
			next += stride;
			stride *= 2;
		}
		for (; stride > 0; stride /= 2)
			if (next + stride < count &&
			    is_straight(foot, &stances[at], &stances[next + stride]))
				next += stride;
		/* What was left out is not needed any more, so it may be overwritten. */
		stances[kept++] = stances[next];
		at = next;
	}
	return kept;
}

/* The places of the eye on a way. */
struct trail {
	float (*points_m)[3]; /* owned */
	uint32_t count, room;
};

static int add_point(struct trail *trail, float x, float y, float z)
{
	if (ARRAY_RESERVE(trail->points_m, trail->room, trail->count + 1, UINT32_MAX) < 0)
		return -ENOMEM;
	vec_copy(trail->points_m[trail->count++], (const float[3]){ x, y, z });
	return 0;
}

/* One step on. Where the straight line to it is not free the head goes down first, or up last. */
static int add_step(struct trail *trail, const struct solid *solid, const float from_m[3],
		    const float to_m[3])
{
	int rc = 0;

	if (!solid_way_is_free(solid, from_m, to_m))
		rc = from_m[2] > to_m[2] ? add_point(trail, from_m[0], from_m[1], to_m[2])
					 : add_point(trail, to_m[0], to_m[1], from_m[2]);
	return rc < 0 ? rc : add_point(trail, to_m[0], to_m[1], to_m[2]);
}

/* Follows the corners on the floor, a point a step. */
static int lay(struct trail *trail, const struct foot *foot, const struct foot_stance *corners,
	       uint32_t count)
{
	struct foot_stance at = corners[0], next;
	int rc = add_point(trail, at.eye_m[0], at.eye_m[1], at.eye_m[2]);

	for (uint32_t i = 1; i < count; i++) {
		const float *a = corners[i - 1].eye_m, *b = corners[i].eye_m;
		const int steps = (int)ceilf(hypotf(b[0] - a[0], b[1] - a[1]) / STEP_M);

		for (int s = 1; rc == 0 && s <= steps; s++) {
			const float share = (float)s / (float)steps;

			if (!foot_step(foot, &at, a[0] + share * (b[0] - a[0]),
				       a[1] + share * (b[1] - a[1]), &next))
				return -ENOENT;
			rc = add_step(trail, foot->solid, at.eye_m, next.eye_m);
			at = next;
		}
	}
	return rc;
}

/* Evens the heights out where that stays free: nobody feels each step of a stair. */
static void even_out(struct trail *trail, const struct solid *solid)
{
	for (int round = 0; round < EVEN_ROUNDS; round++)
		for (uint32_t i = 1; i + 1 < trail->count; i++) {
			float *point = trail->points_m[i];
			const float *before = trail->points_m[i - 1];
			const float *after = trail->points_m[i + 1];
			const float z = point[2];

			point[2] = (before[2] + 2 * z + after[2]) / 4;
			if (!solid_way_is_free(solid, before, point) ||
			    !solid_way_is_free(solid, point, after))
				point[2] = z;
		}
}

static float off_line_m(const float point_m[3], const float from_m[3], const float to_m[3])
{
	float line[3], arm[3], across[3];

	vec_sub(line, to_m, from_m);
	vec_sub(arm, point_m, from_m);
	if (vec_normalise(line) <= 0)
		return vec_length(arm);
	vec_cross(across, line, arm);
	return vec_length(across);
}

static bool may_go_straight(const struct trail *trail, const struct solid *solid, uint32_t from,
			    uint32_t to)
{
	const float *a = trail->points_m[from], *b = trail->points_m[to];

	for (uint32_t i = from + 1; i < to; i++)
		if (off_line_m(trail->points_m[i], a, b) > OFF_LINE_M)
			return false;
	return solid_way_is_free(solid, a, b);
}

/* Keeps the points that the way needs. Returns false if there are too many. */
static bool thin_out(const struct trail *trail, const struct solid *solid, struct solid_way *way)
{
	way->count = 0;
	for (uint32_t at = 0;;) {
		uint32_t next = at + 1;

		if (way->count == SOLID_WAY_POINTS_MAX)
			return false;
		vec_copy(way->points_m[way->count++], trail->points_m[at]);
		if (next >= trail->count)
			return way->count >= 2;
		while (next + 1 < trail->count && may_go_straight(trail, solid, at, next + 1))
			next++;
		at = next;
	}
}

static int make_way(struct solid_way *out, const struct search *search, bool arrived)
{
	const struct foot *foot = search->foot;
	struct foot_stance *stances;
	struct solid_way way;
	struct trail trail = { NULL, 0, 0 };
	uint32_t count = arrived ? 2 : 1, at;
	int rc;

	for (uint32_t p = search->nearest; p != 0; p = search->places[p].from)
		count++;
	stances = malloc(count * sizeof(*stances));
	if (!stances)
		return -ENOMEM;
	at = count;
	if (arrived)
		stances[--at] = *search->to;
	for (uint32_t p = search->nearest; at > 0; p = search->places[p].from)
		stances[--at] = search->places[p].stance;
	rc = lay(&trail, foot, stances, pull(foot, stances, count));
	free(stances);
	if (rc == 0) {
		even_out(&trail, foot->solid);
		rc = thin_out(&trail, foot->solid, &way) ? 0 : -ENOENT;
	}
	free(trail.points_m);
	if (rc < 0)
		return rc;
	solid_way_measure(&way);
	*out = way;
	return 0;
}

int foot_way_plan(struct solid_way *way, const struct foot *foot, const struct foot_stance *from,
		  const struct foot_stance *to)
{
	struct search search = { .foot = foot, .to = to };
	int rc = find(&search, from);

	if (rc >= 0)
		rc = make_way(way, &search, rc > 0);
	free(search.places);
	search_queue_finish(&search.queue);
	map_finish(&search.place_of);
	return rc;
}
