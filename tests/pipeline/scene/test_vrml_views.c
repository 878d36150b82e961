/* Viewpoints of a scene as views: those that stand still, and the way of one that moves. */
#include "pipeline/scene/vrml_views.h"

#include <errno.h>
#include <math.h>
#include <string.h>

#include "tests/check.h"

#define HEAD "#VRML V2.0 utf8\n"

/* A walk of 10 s along x that first rests for 2 s, and turns from -z to -x by its end. */
#define WALK                                                                                       \
	HEAD "DEF V Viewpoint { description \"walk\" }\n"                                          \
	     "DEF C TimeSensor { cycleInterval 10 }\n"                                             \
	     "DEF P PositionInterpolator { key [ 0 0.2 1 ] keyValue [ 0 1 0, 0 1 0, 8 1 0 ] }\n"   \
	     "DEF O OrientationInterpolator { key [ 0.5 1 ]\n"                                     \
	     "  keyValue [ 0 1 0 0, 0 1 0 1.5708 ] }\n"                                            \
	     "ROUTE C.fraction_changed TO P.set_fraction\n"                                        \
	     "ROUTE C.fraction_changed TO O.set_fraction\n"                                        \
	     "ROUTE P.value_changed TO V.set_position\n"                                           \
	     "ROUTE O.value_changed TO V.orientation\n"

static int read_views(struct scene_views *out, const char *text, const char *description,
		      struct diagnostics *diagnostics)
{
	const struct bytes bytes = { (const uint8_t *)text, strlen(text) };
	const struct vrml_options options = { 0 };
	struct diagnostics warnings = { 0 };
	struct vrml *scene;
	int rc;

	CHECK(vrml_read(&scene, bytes, "a.wrl", &options, diagnostics, &warnings) == 0);
	rc = vrml_views_read(out, scene, description, diagnostics);
	vrml_destroy(scene);
	return rc;
}

static bool is_at(const float place[3], float x, float y, float z)
{
	return fabsf(place[0] - x) < 1e-3f && fabsf(place[1] - y) < 1e-3f &&
	       fabsf(place[2] - z) < 1e-3f;
}

static void viewpoints_that_stand_still_come_in_order(void **state)
{
	static const char text[] =
		HEAD "Viewpoint {}\n"
		     "Transform { translation 0 0 5 rotation 0 1 0 1.5708 children\n"
		     "  Viewpoint { position 1 0 0 orientation 1 0 0 -1.5708 } }";
	struct diagnostics diagnostics = { 0 };
	struct scene_views views;

	(void)state;
	CHECK(read_views(&views, text, NULL, &diagnostics) == 0);
	CHECK(views.count == 2 && !views.moves);
	CHECK(is_at(views.items[0].eye, 0, 0, 10) && is_at(views.items[0].target, 0, 0, 9));
	/* It looks down, and the Transform turns it and moves it. */
	CHECK(is_at(views.items[1].eye, 0, 0, 4) && is_at(views.items[1].target, 0, -1, 4));
	scene_views_finish(&views);
}

static void a_moving_viewpoint_has_a_view_at_each_key(void **state)
{
	static const float times[] = { 0, 2, 5, 10 };
	struct diagnostics diagnostics = { 0 };
	struct scene_views views;

	(void)state;
	CHECK(read_views(&views, WALK "Viewpoint {}", NULL, &diagnostics) == 0);
	CHECK(views.count == 4 && views.moves);
	for (uint32_t i = 0; i < 4; i++)
		CHECK(fabsf(views.items[i].time_s - times[i]) < 1e-4f);
	CHECK(is_at(views.items[1].eye, 0, 1, 0) && is_at(views.items[1].target, 0, 1, -1));
	/* Between two keys it is on the straight line, at an even speed. */
	CHECK(is_at(views.items[2].eye, 3, 1, 0) && is_at(views.items[2].target, 3, 1, -1));
	CHECK(is_at(views.items[3].eye, 8, 1, 0) && is_at(views.items[3].target, 7, 1, 0));
	scene_views_finish(&views);
}

/* Two keys at one time are a jump: a view just before it, one after. The timer begins before the
 * first key and ends after the last one. */
static void a_jump_has_a_view_on_either_side(void **state)
{
	static const char text[] = HEAD
		"DEF V Viewpoint {}\nDEF C TimeSensor { cycleInterval 10 }\n"
		"DEF P PositionInterpolator { key [ 0.1 0.5 0.5 0.8 ]\n"
		"  keyValue [ 0 0 0, 4 0 0, 4 9 0, 8 9 0 ] }\n"
		"ROUTE C.fraction_changed TO P.set_fraction ROUTE P.value_changed TO V.position";
	static const float expected[][3] = { { 0, 0, 0 }, { 1, 0, 0 }, { 5, 4, 0 },
					     { 5, 4, 9 }, { 8, 8, 9 }, { 10, 8, 9 } };
	struct diagnostics diagnostics = { 0 };
	struct scene_views views;

	(void)state;
	CHECK(read_views(&views, text, NULL, &diagnostics) == 0);
	CHECK(views.count == ARRAY_COUNT(expected));
	for (uint32_t i = 0; i < views.count; i++) {
		CHECK(fabsf(views.items[i].time_s - expected[i][0]) < 1e-4f);
		CHECK(is_at(views.items[i].eye, expected[i][1], expected[i][2], 0));
	}
	scene_views_finish(&views);
}

static void of_several_the_description_says_which(void **state)
{
	static const char text[] = WALK
		"DEF W Viewpoint { description \"still\" orientation 0 0 1 0 }\n"
		"DEF Q PositionInterpolator { key [ 0 1 ] keyValue [ 0 0 0, 0 9 0 ] }\n"
		"ROUTE C.fraction_changed TO Q.set_fraction ROUTE Q.value_changed TO W.position\n";
	struct diagnostics diagnostics = { 0 };
	struct scene_views views;

	(void)state;
	CHECK(read_views(&views, text, NULL, &diagnostics) == -EINVAL);
	CHECK(strstr(diagnostics.first.text, "a second Viewpoint that moves, \"still\""));
	diagnostics = (struct diagnostics){ 0 };
	CHECK(read_views(&views, text, "still", &diagnostics) == 0);
	CHECK(views.count == 2 && is_at(views.items[1].eye, 0, 9, 0));
	scene_views_finish(&views);
	CHECK(read_views(&views, text, "none", &diagnostics) == -EINVAL);
	CHECK(strstr(diagnostics.first.text, "no moving Viewpoint whose description is \"none\""));
}

static void a_faulty_way_is_named_with_line_and_cure(void **state)
{
#define P_ROUTE "ROUTE P.value_changed TO V.position\n"
	static const struct {
		const char *text, *words;
	} cases[] = {
		{ HEAD "Shape { geometry Box {} }", "a.wrl: has no Viewpoint" },
		{ HEAD "DEF V Viewpoint {}\nDEF P PositionInterpolator {}\n" P_ROUTE,
		  "a.wrl:3: PositionInterpolator has no keys" },
		{ HEAD "DEF V Viewpoint {}\n"
		       "DEF P PositionInterpolator { key 0 keyValue 1 2 3 }\n" P_ROUTE,
		  "a.wrl:3: no TimeSensor drives this" },
		{ HEAD "DEF M Transform { children DEF V Viewpoint {} }\n"
		       "DEF P PositionInterpolator { key 0 keyValue 1 2 3 }\n"
		       "ROUTE P.value_changed TO M.translation",
		  "a.wrl:2: this Viewpoint stands in a Transform that moves" },
		{ HEAD "DEF V Viewpoint {}\nDEF C TimeSensor { cycleInterval 0 }\n"
		       "DEF P PositionInterpolator { key 0 keyValue 1 2 3 }\n" P_ROUTE
		       "ROUTE C.fraction_changed TO P.set_fraction",
		  "a.wrl:3: cycleInterval must be above 0" },
		{ WALK
		  "DEF D TimeSensor {} DEF R OrientationInterpolator { key 0 keyValue 0 1 0 0 }"
		  "ROUTE D.fraction_changed TO R.set_fraction\n"
		  "ROUTE R.value_changed TO V.orientation",
		  "a.wrl:2: two TimeSensors move this Viewpoint" },
	};

	(void)state;
	for (size_t i = 0; i < ARRAY_COUNT(cases); i++) {
		struct diagnostics diagnostics = { 0 };
		struct scene_views views;

		CHECK(read_views(&views, cases[i].text, NULL, &diagnostics) < 0);
		scene_views_finish(&views);
		if (!strstr(diagnostics.first.text, cases[i].words))
			fail_msg("case %zu: %s", i, diagnostics.first.text);
	}
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(viewpoints_that_stand_still_come_in_order),
		cmocka_unit_test(a_moving_viewpoint_has_a_view_at_each_key),
		cmocka_unit_test(a_jump_has_a_view_on_either_side),
		cmocka_unit_test(of_several_the_description_says_which),
		cmocka_unit_test(a_faulty_way_is_named_with_line_and_cure),
	};

	return cmocka_run_group_tests(tests, NULL, NULL);
}
