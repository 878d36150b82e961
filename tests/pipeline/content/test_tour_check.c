/* Which tours are refused: a wall in the way, stone too near to it, a hole that is none. */
#include "pipeline/content/tour_check.h"

#include <errno.h>
#include <math.h>

#include "geometry/tour_path.h"
#include "tests/pipeline/content/info_folder.h"
#include "tests/pipeline/toy.h"

static struct mesh mesh;

/* A wall at x = 0, 20 m wide and 10 high, with a gate of 2 x 4 m in its middle, on 40 x 40 m of
 * ground; all of it without thickness. */
static void wall_piece(float y0, float y1, float z0, float z1)
{
	static const uint8_t grey[3] = { 128, 128, 128 };
	const uint32_t v[4] = {
		toy_vertex(&mesh, 0, y0, z0, grey),
		toy_vertex(&mesh, 0, y1, z0, grey),
		toy_vertex(&mesh, 0, y1, z1, grey),
		toy_vertex(&mesh, 0, y0, z1, grey),
	};

	toy_triangle(&mesh, v[0], v[1], v[2]);
	toy_triangle(&mesh, v[0], v[2], v[3]);
}

static int set_up_wall(void **state)
{
	static const uint8_t grey[3] = { 128, 128, 128 };
	uint32_t v[4];

	mesh = toy_empty(64, 32);
	for (int i = 0; i < 4; i++)
		v[i] = toy_vertex(&mesh, i == 1 || i == 2 ? 20 : -20, i > 1 ? 20 : -20, 0, grey);
	toy_triangle(&mesh, v[0], v[1], v[2]);
	toy_triangle(&mesh, v[0], v[2], v[3]);
	wall_piece(-10, -1, 0, 10);
	wall_piece(1, 10, 0, 10);
	wall_piece(-1, 1, 4, 10);
	return set_up(state);
}

static int tear_down_wall(void **state)
{
	toy_free(&mesh);
	return tear_down(state);
}

static int judge(const char *stops, const char *more)
{
	const struct tour_check_options options = { &mesh, &told };
	struct info_built built;
	char json[2000];
	int rc;

	snprintf(
		json, sizeof(json),
		"{\"tours\": [{\"id\": \"walk\", \"title\": {\"en\": \"Walk\"}%s, \"stops\": [\n%s\n]}]}",
		more, stops);
	write_text("tours.json", json);
	CHECK(build(&built) == 0);
	diagnostics_finish(&told);
	rc = tour_check(&built, &options);
	info_built_finish(&built);
	return rc;
}

#define AT(x, y, z) "{\"eye\": [" #x ", " #y ", " #z "], \"target\": [0, 0, 2.5]}"

static void a_way_through_the_gate_is_free(void **state)
{
	(void)state;
	CHECK(judge(AT(15, 0, 2) ",\n" AT(3, 0, 2) ",\n"
						   "{\"eye\": [-9, 0, 2], \"target\": [-20, 0, 2]}",
		    "") == 0);
	CHECK(told.count == 0);
}

static void a_way_through_the_wall_is_refused_with_leg_and_place(void **state)
{
	(void)state;
	CHECK(judge(AT(15, 0, 2) ",\n" AT(9, 5, 5) ",\n"
						   "{\"eye\": [-9, 5, 5], \"target\": [-20, 0, 2]}",
		    "") == -EINVAL);
	CHECK(told.count == 1);
	CHECK(was_told("tours.json", 4, "from stop 2 to stop 3: the way leads through"));
	CHECK(strstr(told.first.text, "at 0.0") || strstr(told.first.text, "at -0.0"));
}

/* The wall's edge is beside the way: nothing is crossed, and a near plane would cut it open. */
static void a_way_too_near_to_the_wall_is_refused(void **state)
{
	(void)state;
	CHECK(judge(AT(9, 0.9, 2) ",\n{\"eye\": [-9, 0.9, 2], \"target\": [-20, 0.9, 2]}", "") ==
	      -EINVAL);
	CHECK(was_told("tours.json", 3, "is too near to the scan at"));
	CHECK(judge(AT(9, 0.8, 2) ",\n{\"eye\": [-9, 0.8, 2], \"target\": [-20, 0.8, 2]}", "") ==
	      0);
	CHECK(judge(AT(9, 0, 2) ",\n{\"eye\": [9, 9, 0.1], \"target\": [0, 9, 2]}", "") ==
	      -EINVAL); /* the ground */
}

/* Where nobody is there the way is closed, and its last leg is one like the others. */
static void the_way_back_is_judged_where_it_is_flown(void **state)
{
	static const char stops[] = "{\"eye\": [15, 0, 2], \"target\": [0, 0, 2]},\n"
				    "{\"eye\": [3, 0, 2], \"target\": [0, 0, 2]},\n"
				    "{\"eye\": [-6, 0, 2], \"target\": [-20, 0, 2]},\n"
				    "{\"eye\": [-12, 7, 3], \"target\": [0, 6, 3]}";

	(void)state;
	CHECK(judge(stops, "") == 0);
	CHECK(judge(stops, ", \"attract\": true") == -EINVAL);
	CHECK(was_told("tours.json", 2, "from stop 4 to stop 1: the way leads through"));
}

static void what_no_visitor_could_do_is_refused(void **state)
{
	(void)state;
	CHECK(judge(AT(15, 0, 2) ",\n" AT(400, 0, 20), "") == -EINVAL);
	CHECK(was_told("tours.json", 3, "the way is too far away at"));
	CHECK(judge(AT(25, 0, 2) ",\n" AT(25, 0, -1), "") == -EINVAL);
	CHECK(was_told("tours.json", 3, "the way is under the ground at"));
	CHECK(judge(AT(15, 0, 2) ",\n{\"eye\": [15, 0, 2], \"target\": [30, 0, 2], \"travel\": 1}",
		    "") == -EINVAL);
	CHECK(was_told("tours.json", 3, "the view turns too fast, by "));
	CHECK(judge("{\"eye\": [15, 0, 2], \"target\": [0, 0, 2], \"stay\": 120},\n"
		    "{\"eye\": [14, 0, 2], \"target\": [0, 0, 2], \"stay\": 120},\n"
		    "{\"eye\": [15, 1, 2], \"target\": [0, 0, 2], \"stay\": 120},\n"
		    "{\"eye\": [14, 2, 2], \"target\": [0, 0, 2], \"stay\": 120},\n"
		    "{\"eye\": [15, 3, 2], \"target\": [0, 0, 2], \"stay\": 120}",
		    "") == -EINVAL);
	CHECK(was_told("tours.json", 1, "minutes, the limit is"));
}

/* Against a search by hand: every step of the way, every triangle, by sampling its face. */
static void no_triangle_is_missed(void **state)
{
	static struct tour_path path;
	uint32_t refused = 0, let_pass = 0;

	(void)state;
	srand(11);
	for (int trial = 0; trial < 60; trial++) {
		struct tour_view views[2] = { { { 0 }, { 0, 0, 5 }, 6, 0, false },
					      { { 0 }, { 0, 0, 5 }, 6, 0, false } };
		float nearest = INFINITY, clearance, low[3], high[3];
		char stops[300];
		int rc;

		for (int i = 0; i < 2; i++) {
			views[i].eye_m[0] = (float)(i ? -8 : 8);
			views[i].eye_m[1] = (float)(rand() % 360) / 100 - 1.8f;
			views[i].eye_m[2] = 1 + (float)(rand() % 340) / 100;
		}
		snprintf(stops, sizeof(stops),
			 "{\"eye\": [8, %.9g, %.9g], \"target\": [0, 0, 5]},\n"
			 "{\"eye\": [-8, %.9g, %.9g], \"target\": [0, 0, 5], \"travel\": 60}",
			 (double)views[0].eye_m[1], (double)views[0].eye_m[2],
			 (double)views[1].eye_m[1], (double)views[1].eye_m[2]);
		rc = judge(stops, "");
		mesh_box(&mesh, low, high);
		tour_path_init(
			&path, views, 2, false,
			hypotf(hypotf(high[0] - low[0], high[1] - low[1]), high[2] - low[2]));
		clearance = 0.175f;
		for (int i = 0; i <= 4000; i++) {
			float eye[3], beyond;

			tour_path_place(&path, 0, (float)i / 4000, eye);
			/* From the gate's sides and its lintel; below it the wall has the hole. */
			beyond = fmaxf(fabsf(eye[1]) - 1, eye[2] - 4);
			nearest = fminf(nearest,
					beyond >= 0 ? fabsf(eye[0]) : hypotf(eye[0], beyond));
		}
		if (fabsf(nearest - clearance) < 0.002f)
			continue; /* a hair's breadth */
		CHECK((rc == -EINVAL) == (nearest < clearance));
		refused += rc < 0;
		let_pass += rc == 0;
	}
	CHECK(refused > 10 && let_pass > 10);
}

int main(void)
{
#define AT_THE_WALL(claim) cmocka_unit_test_setup_teardown(claim, set_up_wall, tear_down_wall)
	const struct CMUnitTest tests[] = {
		AT_THE_WALL(a_way_through_the_gate_is_free),
		AT_THE_WALL(a_way_through_the_wall_is_refused_with_leg_and_place),
		AT_THE_WALL(a_way_too_near_to_the_wall_is_refused),
		AT_THE_WALL(the_way_back_is_judged_where_it_is_flown),
		AT_THE_WALL(what_no_visitor_could_do_is_refused),
		AT_THE_WALL(no_triangle_is_missed),
	};

	return cmocka_run_group_tests(tests, NULL, NULL);
}
