/* What the examples of VRML97's Annex D show, in scenes of our own: shapes that are shared,
 * prototypes, interpolators, timers, views, and a program, which is refused. */
#include <errno.h>
#include <stdio.h>
#include <string.h>

#include "tests/pipeline/scene/little_vrml.h"

#define HEAD "#VRML V2.0 utf8\n"

/* Of D.4: a table whose legs and top have colours of their own. */
#define TABLE                                                                                          \
	HEAD "PROTO Table [ field SFColor legs .8 .4 .7 field SFColor top .6 .6 .1 ] {\n"              \
	     "Transform { children [\n"                                                                \
	     "  Transform { translation 0 0.6 0 children Shape { appearance Appearance {\n"            \
	     "    material Material { diffuseColor IS top } } geometry Box { size 1.2 0.2 1.2 } } }\n" \
	     "  Transform { translation -.5 0 -.5 children DEF Leg Shape { appearance Appearance {\n"  \
	     "    material Material { diffuseColor IS legs } }\n"                                      \
	     "    geometry Cylinder { height 1 radius .1 } } }\n"                                      \
	     "  Transform { translation .5 0 -.5 children USE Leg }\n"                                 \
	     "  Transform { translation -.5 0 .5 children USE Leg }\n"                                 \
	     "  Transform { translation .5 0 .5 children USE Leg } ] } }\n"

/* Triangles: circles have 48 corners, balls 24 bands. */
enum {
	BOX = 12,
	BALL = 48 * (2 * 24 - 2),
	CYLINDER = 48 * 2 + 2 * 46,
	CONE = 48 + 46,
};

static const struct example {
	const char *of, *text;
	/* what it comes to */
	uint32_t triangles, nodes, motions, touches, tracks;
} examples[] = {
	{ "D.2, a ball and a box under a transform",
	  HEAD
	  "Transform { children [ NavigationInfo { headlight FALSE }\n"
	  "Transform { translation 3 0 1 children Shape { geometry Sphere { radius 2.3 }\n"
	  "  appearance Appearance { material Material { diffuseColor 1 0 0 } } } }\n"
	  "Transform { translation -2.4 .2 1 rotation 0 1 1 .9 children Shape { geometry Box {}\n"
	  "  appearance Appearance { material Material { diffuseColor 0 0 1 } } } } ] }",
	  BALL + BOX, 1, 0, 0, 0 },
	{ "D.3, one ball used three times",
	  HEAD "Transform { children [ Transform { children DEF Joe Shape {\n"
	       "  geometry Sphere { radius .5 } } }\n"
	       "Transform { translation 2 0 0 children USE Joe }\n"
	       "Transform { translation 2 0 0 children DEF Joe Shape { geometry Box {} } }\n"
	       "Transform { translation -2 0 0 children USE Joe } ] }",
	  2 * BALL + 2 * BOX, 1, 0, 0, 0 },
	{ "D.4, a prototype with colours", TABLE "Table { legs 1 0 0 top 0 1 0 } Table {}",
	  2 * (BOX + 4 * CYLINDER), 1, 0, 0, 0 },
	{ "D.6, colours and normals of faces",
	  HEAD
	  "Shape { geometry IndexedFaceSet { coord Coordinate { point [ 0 0 0, 1 0 0, 1 1 0, "
	  "0 1 0, .5 .5 1 ] } coordIndex [ 0 1 4 -1 1 2 4 -1 2 3 4 -1 3 0 4 -1 ]\n"
	  "colorPerVertex FALSE color Color { color [ 1 0 0, 0 1 0 ] } colorIndex [ 0 1 0 1 ]\n"
	  "normal Normal { vector [ 0 -1 1, 1 0 1, 0 1 1, -1 0 1 ] } normalPerVertex FALSE } }",
	  4, 1, 0, 0, 0 },
	{ "D.7, a hierarchy",
	  HEAD
	  "DEF Base Transform { children [ Shape { geometry Box { size 2 .2 2 } }\n"
	  "Transform { translation 0 .5 0 rotation 0 0 1 .4 children [ Shape { geometry Cone {} }\n"
	  "Transform { translation 0 1 0 scale .5 .5 .5 children Shape { geometry Box {} } } ] } ] }",
	  2 * BOX + CONE, 1, 0, 0, 0 },
	{ "D.8, a colour that changes for ever",
	  HEAD "Shape { geometry Box {} appearance Appearance { material DEF M Material {} } }\n"
	       "DEF T TimeSensor { cycleInterval 9 loop TRUE }\n"
	       "DEF I ColorInterpolator { key [ 0, .5, 1 ] keyValue [ 1 0 0, 0 1 0, 1 0 0 ] }\n"
	       "ROUTE T.fraction_changed TO I.set_fraction\n"
	       "ROUTE I.value_changed TO M.set_diffuseColor",
	  BOX, 2, 1, 0, 1 },
	{ "D.12, a rotor that a touch turns",
	  HEAD
	  "Group { children [ DEF Engine TouchSensor {}\n"
	  "Shape { geometry Sphere { radius .3 } }\n"
	  "DEF Rotor Transform { translation 0 1 0 children Shape { geometry Box { size 4 .1 .3 } } } ] }\n"
	  "DEF T TimeSensor { cycleInterval 1 loop TRUE }\n"
	  "DEF Spin OrientationInterpolator { key [ 0, .5, 1 ]\n"
	  "  keyValue [ 0 1 0 0, 0 1 0 3.14, 0 1 0 6.28 ] }\n"
	  "ROUTE Engine.touchTime TO T.set_startTime\n"
	  "ROUTE T.fraction_changed TO Spin.set_fraction\n"
	  "ROUTE Spin.value_changed TO Rotor.set_rotation",
	  BALL + BOX, 3, 1, 1, 1 },
	{ "D.14, a lift that a button starts",
	  HEAD
	  "Group { children [ DEF Button TouchSensor {} Shape { geometry Box { size .1 .1 .1 } } ] }\n"
	  "DEF Lift Transform { children [ Shape { geometry Box {} } Viewpoint {} ] }\n"
	  "DEF T TimeSensor { cycleInterval 10 }\n"
	  "DEF Way PositionInterpolator { key [ 0, 1 ] keyValue [ 0 0 0, 0 4 0 ] }\n"
	  "ROUTE Button.touchTime TO T.set_startTime\n"
	  "ROUTE T.fraction_changed TO Way.set_fraction\n"
	  "ROUTE Way.value_changed TO Lift.set_translation",
	  2 * BOX, 3, 1, 1, 1 },
};

static int make(struct scenery *out, const char *text, struct diagnostics *diagnostics,
		struct diagnostics *warnings)
{
	const struct vrml_options options = { 0 };

	return little_vrml_make(out, text, &options, NULL, 0, diagnostics, warnings);
}

static void the_examples_become_scenery(void **state)
{
	(void)state;
	for (size_t i = 0; i < ARRAY_COUNT(examples); i++) {
		const struct example *e = &examples[i];
		struct diagnostics diagnostics = { 0 }, warnings = { 0 };
		struct scenery s;

		if (make(&s, e->text, &diagnostics, &warnings) < 0 || warnings.count > 0)
			fail_msg("%s: %s %s", e->of, diagnostics.first.text, warnings.first.text);
		if (scenery_triangles(&s) != e->triangles || s.node_count != e->nodes ||
		    s.motion_count != e->motions || s.touch_count != e->touches ||
		    s.track_count != e->tracks)
			fail_msg("%s: %u triangles, %u nodes, %u motions, %u touches, %u tracks",
				 e->of, scenery_triangles(&s), s.node_count, s.motion_count,
				 s.touch_count, s.track_count);
		scenery_finish(&s);
	}
}

/* D.5, D.10 and D.13 run programs. */
static void a_program_is_refused_with_its_line(void **state)
{
	static const char lamp[] = HEAD
		"DEF Touch TouchSensor {}\nDEF Toggle Script {\n  eventIn SFTime touched\n"
		"  field SFBool on FALSE url \"javascript: function touched() { on = !on; }\" }\n"
		"Shape { geometry Box {} }";
	struct diagnostics diagnostics = { 0 }, warnings = { 0 };
	struct scenery s;

	(void)state;
	CHECK(make(&s, lamp, &diagnostics, &warnings) < 0);
	print_message("%s\n", diagnostics.first.text);
	CHECK(strncmp(diagnostics.first.text, "a.wrl:3: ", 9) == 0 &&
	      strstr(diagnostics.first.text, "Script"));
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(the_examples_become_scenery),
		cmocka_unit_test(a_program_is_refused_with_its_line),
	};

	return cmocka_run_group_tests(tests, NULL, NULL);
}
