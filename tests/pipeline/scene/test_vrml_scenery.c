/* Scenes as scenery: what moves becomes nodes and motions, and what does not, triangles. */
#include "pipeline/scene/vrml_scenery.h"

#include <errno.h>
#include <math.h>
#include <string.h>

#include "format/normal.h"
#include "format/scenery_code.h"
#include "tests/pipeline/scene/little_vrml.h"

#define HEAD "#VRML V2.0 utf8\n"

/* A door of 1 x 2 on a hinge, beside a wall that is moved and does not move. */
static const char door[] =
	HEAD "Transform { translation 5 0 0 children Shape { geometry Box {} } }\n"
	     "Transform { translation 0 1 0 children [\n"
	     "  DEF T TouchSensor {}\n"
	     "  DEF Hinge Transform { center -0.5 0 0 children\n"
	     "    Shape { geometry DEF B Box { size 1 2 0.1 } } } ] }\n"
	     "DEF C TimeSensor { cycleInterval 2 }\n"
	     "DEF O OrientationInterpolator { key [ 0 1 ] keyValue [ 0 1 0 0, 0 1 0 1.5708 ] }\n"
	     "ROUTE T.touchTime TO C.set_startTime\n"
	     "ROUTE C.fraction_changed TO O.set_fraction\n"
	     "ROUTE O.value_changed TO Hinge.rotation\n";

static int make_with(struct scenery *out, const char *text, struct scenery_look *looks,
		     uint32_t look_count, struct diagnostics *diagnostics,
		     struct diagnostics *warnings)
{
	const struct vrml_options options = { 0 };

	return little_vrml_make(out, text, &options, looks, look_count, diagnostics, warnings);
}

static int make(struct scenery *out, const char *text, struct diagnostics *diagnostics,
		struct diagnostics *warnings)
{
	return make_with(out, text, NULL, 0, diagnostics, warnings);
}

static void a_door_turns_on_its_hinge_when_it_is_touched(void **state)
{
	struct diagnostics diagnostics = { 0 }, warnings = { 0 };
	struct scenery s;
	const float *values;

	(void)state;
	CHECK(make(&s, door, &diagnostics, &warnings) == 0 && warnings.count == 0);
	/* the root, the group that is touched, the hinge */
	CHECK(s.node_count == 3 && s.nodes[2].parent == 1 && s.nodes[1].parent == 0);
	CHECK(s.nodes[1].place.move_m[1] == 1 && s.nodes[2].place.centre_m[0] == -0.5f);
	CHECK(s.motion_count == 1 && s.motions[0].duration_s == 2 && s.motions[0].returns);
	CHECK(s.touch_count == 1 && s.touches[0].node == 1);
	CHECK(s.track_count == 1 && s.tracks[0].node == 2 && s.tracks[0].target == SCENERY_TURN);
	values = &s.numbers[s.tracks[0].first + 2];
	CHECK(values[3] == 1 && fabsf(values[4 + 1] - sqrtf(0.5f)) < 1e-4f);
	/* The wall is in its place already; boxes have 24 vertices, for their edges are sharp. */
	CHECK(s.mesh_count == 2 && s.meshes[0].node == 0 && s.meshes[1].node == 2);
	CHECK(s.meshes[0].origin_m[0] == 4 && s.meshes[0].vertex_count == 24);
	CHECK(scenery_triangles(&s) == 24);
	scenery_finish(&s);
}

static void a_node_that_is_used_twice_moves_twice(void **state)
{
	static const char twice[] =
		HEAD "DEF G Transform { children Shape { geometry Sphere {} } }\n"
		     "Transform { translation 9 0 0 children USE G }\n"
		     "DEF C TimeSensor { loop TRUE cycleInterval 8 }\n"
		     "DEF P PositionInterpolator { key [ 0 1 ] keyValue [ 0 0 0, 0 1 0 ] }\n"
		     "ROUTE C.fraction_changed TO P.set_fraction\n"
		     "ROUTE P.value_changed TO G.set_translation\n";
	struct diagnostics diagnostics = { 0 }, warnings = { 0 };
	struct scenery s;

	(void)state;
	CHECK(make(&s, twice, &diagnostics, &warnings) == 0 && warnings.count == 0);
	CHECK(s.motion_count == 1 && s.motions[0].loops && !s.motions[0].returns);
	CHECK(s.track_count == 2 && s.tracks[0].node != s.tracks[1].node);
	/* Light is smooth on a sphere: its corners are shared. */
	CHECK(s.meshes[0].vertex_count < s.meshes[0].triangle_count);
	scenery_finish(&s);
}

/* A bolt that slides along x, a wheel, and a globe; and a sensor that leads nowhere. */
static void what_a_finger_drags_is_kept_with_its_limits(void **state)
{
	static const char bolt[] = HEAD
		"Transform { translation 0 1 0 children [\n"
		"  DEF P PlaneSensor { minPosition 0 0 maxPosition 0.3 0 offset 0.1 0 2 }\n"
		"  DEF Bolt Transform { children Shape { geometry Box {} } } ] }\n"
		"Group { children [ DEF C CylinderSensor { minAngle -1 maxAngle 2 diskAngle 9\n"
		"    autoOffset FALSE }\n"
		"  DEF Wheel Transform { children Shape { geometry Cylinder {} } } ] }\n"
		"DEF S SphereSensor { offset 0 0 1 3.1415927 }\n"
		"DEF Globe Transform { children Shape { geometry Sphere {} } }\n"
		"ROUTE P.translation_changed TO Bolt.set_translation\n"
		"ROUTE C.rotation_changed TO Wheel.rotation\n"
		"ROUTE S.rotation_changed TO Globe.rotation\n"
		"ROUTE S.trackPoint_changed TO Globe.translation\n";
	struct diagnostics diagnostics = { 0 }, warnings = { 0 };
	const struct scenery_drag *plane, *cylinder, *sphere;
	struct scenery s;

	(void)state;
	CHECK(make(&s, bolt, &diagnostics, &warnings) == 0);
	CHECK(warnings.count == 1 &&
	      strstr(warnings.first.text, "a.wrl:13: ROUTE from trackPoint"));
	CHECK(s.drag_count == 3 && s.motion_count == 0);
	plane = s.drags;
	CHECK(plane->kind == SCENERY_DRAG_PLANE && plane->keeps);
	CHECK(s.nodes[plane->node].parent == plane->handle);
	CHECK(s.nodes[plane->handle].place.move_m[1] == 1);
	CHECK(plane->high[0] == 0.3f && plane->low[1] == 0 && plane->high[1] == 0);
	CHECK(plane->offset[0] == 0.1f && plane->offset[2] == 2);
	cylinder = &s.drags[1];
	CHECK(cylinder->kind == SCENERY_DRAG_CYLINDER && !cylinder->keeps);
	CHECK(cylinder->low[0] == -1 && cylinder->high[0] == 2 && cylinder->disc_rad < 1.571f);
	sphere = &s.drags[2];
	CHECK(sphere->kind == SCENERY_DRAG_SPHERE && sphere->handle == 0);
	CHECK(fabsf(sphere->offset[2] - 1) < 1e-4f);
	scenery_finish(&s);
}

static void a_faulty_drag_is_named_with_file_and_line(void **state)
{
#define SLIDE(sensor)                                                                              \
	HEAD "DEF M Transform { children Shape { geometry Box {} } }\n" sensor                     \
	     "\nROUTE P.translation_changed TO M.translation"
	struct diagnostics diagnostics = { 0 }, warnings = { 0 };
	struct scenery s;

	(void)state;
	CHECK(make(&s, SLIDE("DEF P PlaneSensor { maxPosition 1e9 1 }"), &diagnostics, &warnings) ==
	      -EBADMSG);
	CHECK(strstr(diagnostics.first.text,
		     "a.wrl:3: the limits or the offset of this PlaneSensor"));
	CHECK(make(&s, SLIDE("DEF P PlaneSensor { enabled FALSE }"), &diagnostics, &warnings) == 0);
	CHECK(s.drag_count == 0 && strstr(warnings.first.text, "a.wrl:3: this PlaneSensor is not"));
	scenery_finish(&s);
}

/* A flag of one face with four corners flaps: its two keys are two shapes. */
static void points_that_move_are_shapes_of_a_mesh(void **state)
{
#define FLAG                                                                                       \
	HEAD "Group { children [ DEF T TouchSensor {}\n"                                           \
	     "Shape { geometry IndexedFaceSet { coordIndex [ 0 1 2 3 -1 ] solid FALSE\n"           \
	     "  coord DEF F Coordinate { point [ 0 0 0, 2 0 0, 2 1 0, 0 1 0 ] } } } ] }\n"         \
	     "DEF C TimeSensor { cycleInterval 3 }\n"
#define ROUTES                                                                                     \
	"ROUTE T.touchTime TO C.startTime ROUTE C.fraction_changed TO I.set_fraction\n"            \
	"ROUTE I.value_changed TO F.set_point\n"
	static const char flag[] =
		FLAG "DEF I CoordinateInterpolator { key [ 0 1 ] keyValue [\n"
		     "  0 0 0, 2 0 0, 2 1 0, 0 1 0,  0 0 0, 2 0 4, 2 1 4, 0 1 0 ] }\n" ROUTES;
	struct diagnostics diagnostics = { 0 }, warnings = { 0 };
	const struct scenery_mesh *mesh;
	struct scenery s;
	float deepest = 0;

	(void)state;
	CHECK(make(&s, flag, &diagnostics, &warnings) == 0 && warnings.count == 0);
	CHECK(s.mesh_count == 1 && s.track_count == 1 && s.tracks[0].target == SCENERY_SHAPE);
	mesh = s.meshes;
	CHECK(mesh->node == s.tracks[0].node && mesh->shape_count == 2);
	CHECK(mesh->vertex_count == 4 && mesh->triangle_count == 2);
	CHECK(s.numbers[s.tracks[0].first + 2] == 0 && s.numbers[s.tracks[0].first + 3] == 1);
	for (uint32_t v = 0; v < 4; v++) {
		const struct scenery_shape_vertex *bent = &mesh->shapes[4 + v];
		const float z = mesh->origin_m[2] + mesh->step_m * (float)bent->place[2];

		CHECK(memcmp(mesh->shapes[v].place, mesh->vertices[v].place, 6) == 0);
		/* What moved is at x = 2, and the light on all of it changed. */
		CHECK(fabsf(z - (bent->place[0] > 0 ? 4 : 0)) < 1e-3f);
		CHECK(memcmp(bent->normal, mesh->vertices[v].normal, 2) != 0);
		deepest = fmaxf(deepest, z);
	}
	CHECK(deepest > 3.9f && s.motions[0].returns);
	scenery_finish(&s);

	CHECK(make(&s, FLAG "DEF I CoordinateInterpolator { key [ 0 1 ] keyValue 0 0 0 }\n" ROUTES,
		   &diagnostics, &warnings) == -EBADMSG);
	CHECK(strstr(diagnostics.first.text, "a.wrl:6: CoordinateInterpolator has another number"));
}

/* From red to green by yellow, and a glow; a box with colours at its corners keeps these. */
static void colours_go_by_their_hue(void **state)
{
	static const char lamp[] = HEAD
		"Shape { geometry Box {} appearance DEF A Appearance { material DEF M Material {\n"
		"  transparency 0.5 diffuseColor 1 0 0 } } }\n"
		"Shape { appearance USE A geometry IndexedFaceSet { coordIndex [ 0 1 2 ]\n"
		"  coord Coordinate { point [ 0 0 0, 1 0 0, 1 1 0 ] }\n"
		"  color Color { color [ 0 0 1, 0 0 1, 0 0 1 ] } } }\n"
		"DEF C TimeSensor { loop TRUE }\n"
		"DEF D ColorInterpolator { key [ 0 1 ] keyValue [ 1 0 0, 0 1 0 ] }\n"
		"DEF E ColorInterpolator { key [ 0 1 ] keyValue [ 0 0 0, 0 0 1 ] }\n"
		"ROUTE C.fraction_changed TO D.set_fraction\n"
		"ROUTE C.fraction_changed TO E.set_fraction\n"
		"ROUTE D.value_changed TO M.diffuseColor\n"
		"ROUTE E.value_changed TO M.set_emissiveColor\n";
	struct diagnostics diagnostics = { 0 }, warnings = { 0 };
	const float *values;
	struct scenery s;

	(void)state;
	CHECK(make(&s, lamp, &diagnostics, &warnings) == 0 && warnings.count == 0);
	CHECK(s.track_count == 3 && s.tracks[0].target == SCENERY_COLOUR);
	CHECK(s.tracks[1].target == SCENERY_GLOW && s.tracks[2].target == SCENERY_GLOW);
	CHECK(s.tracks[0].node == s.meshes[0].node && s.meshes[0].triangle_count == 12);
	CHECK(s.materials[s.meshes[0].material].opacity == 0.5f);
	CHECK(s.tracks[0].key_count == 9);
	values = &s.numbers[s.tracks[0].first + 9];
	CHECK(values[0] == 1 && values[1] == 0 && values[3 * 8] == 0 && values[3 * 8 + 1] == 1);
	CHECK(fabsf(values[3 * 4] - 1) < 1e-4f && fabsf(values[3 * 4 + 1] - 1) < 1e-4f);
	CHECK(values[3 * 4 + 2] == 0);
	values = &s.numbers[s.tracks[1].first + 9];
	CHECK(fabsf(values[3 * 4 + 2] - 0.5f) < 1e-4f && values[3 * 4] == 0);
	scenery_finish(&s);
}

static void what_becomes_transparent_is_a_node(void **state)
{
	static const char fading[] = HEAD
		"Group { children [ DEF T TouchSensor {} Shape { geometry Box {}\n"
		"  appearance Appearance { material DEF M Material {} } } ] }\n"
		"DEF C TimeSensor {} DEF S ScalarInterpolator { key [ 0 1 ] keyValue [ 0 0.75 ] }\n"
		"ROUTE T.touchTime TO C.startTime ROUTE C.fraction_changed TO S.set_fraction\n"
		"ROUTE S.value_changed TO M.transparency";
	struct diagnostics diagnostics = { 0 }, warnings = { 0 };
	struct scenery s;

	(void)state;
	CHECK(make(&s, fading, &diagnostics, &warnings) == 0 && warnings.count == 0);
	CHECK(s.track_count == 1 && s.tracks[0].target == SCENERY_OPACITY);
	CHECK(s.numbers[s.tracks[0].first + 2] == 1 && s.numbers[s.tracks[0].first + 3] == 0.25f);
	CHECK(s.meshes[0].node == s.tracks[0].node);
	scenery_finish(&s);
}

/* The first box is a window, the second shines, the third is not seen. */
static void a_material_is_kept_with_its_highlight_and_transparency(void **state)
{
	static const char boxes[] = HEAD
		"Shape { geometry Box {} appearance Appearance { material Material {\n"
		"  transparency 0.75 specularColor 1 0 0 shininess 0.5 } } }\n"
		"Shape { geometry Box {} appearance DEF L Appearance { material Material {\n"
		"  diffuseColor 0 0 1 emissiveColor 0 1 0 } } }\n"
		"Shape { geometry Box {} appearance Appearance { material Material {\n"
		"  transparency 1 } } }\n"
		"Shape { geometry Box {} appearance USE L }\n"
		"Shape { appearance USE L geometry IndexedFaceSet { solid FALSE\n"
		"  coord Coordinate { point [ 0 0 0, 1 0 0, 1 1 0 ] } coordIndex [ 0 1 2 ] } }";
	struct diagnostics diagnostics = { 0 }, warnings = { 0 };
	const struct scenery_material *m;
	struct scenery s;

	(void)state;
	CHECK(make(&s, boxes, &diagnostics, &warnings) == 0 && warnings.count == 0);
	CHECK(s.material_count == 3 && s.mesh_count == 3 && scenery_triangles(&s) == 37);
	m = s.materials;
	CHECK(m[0].opacity == 0.25f && m[0].specular[0] == 255 && m[0].specular[1] == 0 &&
	      m[0].shininess == 64 && m[0].by_pixel && !m[0].has_two_sides);
	CHECK(m[1].opacity == 1 && m[1].emissive[1] == 255 && !m[1].by_pixel &&
	      m[1].shininess == 0);
	CHECK(m[2].has_two_sides && m[2].emissive[1] == 255);
	CHECK(s.meshes[1].vertices[0].rgb[2] == 255 && s.meshes[1].vertices[0].rgb[1] == 0);
	scenery_finish(&s);
}

static bool has_normal(const struct scenery_mesh *mesh, float x, float y, float z)
{
	for (uint32_t v = 0; v < mesh->vertex_count; v++) {
		float normal[3];

		normal_decode(normal, mesh->vertices[v].normal);
		if (fabsf(normal[0] - x) < 0.02f && fabsf(normal[1] - y) < 0.02f &&
		    fabsf(normal[2] - z) < 0.02f)
			return true;
	}
	return false;
}

/* By vertex, and by face with an index; in a place that scales and mirrors; a missing one is made.
 */
static void normals_of_the_file_are_kept(void **state)
{
#define FACES "IndexedFaceSet { coord Coordinate { point [ 0 0 0, 1 0 0, 0 1 0 ] } "
	static const char faces[] =
		HEAD "Shape { geometry " FACES
		     "coordIndex [ 0 1 2 ] normal Normal { vector [ 1 0 1, 0 2 0 ] } } }"
		     "Transform { translation 1 0 0 scale -2 1 1 children Shape { geometry " FACES
		     "coordIndex [ 0 1 2 -1 0 2 1 ] normalPerVertex FALSE normalIndex [ 1 0 ] "
		     "normal Normal { vector [ 0 0 -1, 1 0 2 ] } } } }";
	struct diagnostics diagnostics = { 0 }, warnings = { 0 };
	struct scenery s;

	(void)state;
	CHECK(make(&s, faces, &diagnostics, &warnings) == 0 && warnings.count == 0);
	CHECK(s.mesh_count == 1 && s.meshes[0].vertex_count == 9);
	CHECK(has_normal(s.meshes, 0.7071f, 0, 0.7071f) && has_normal(s.meshes, 0, 1, 0));
	CHECK(has_normal(s.meshes, 0, 0, 1)); /* of the third corner, which has none */
	/* 1 0 2 is -1/2 0 2 there */
	CHECK(has_normal(s.meshes, -0.2425f, 0, 0.9701f) && has_normal(s.meshes, 0, 0, -1));
	scenery_finish(&s);
}

static void the_first_fog_is_kept_in_metres(void **state)
{
	static const char foggy[] =
		HEAD "Fog { visibilityRange 0 color 1 0 0 }\n"
		     "Fog { visibilityRange 40 color 0 0 1 fogType \"EXPONENTIAL\" }\n"
		     "Shape { geometry Box {} }\n"
		     "Fog { visibilityRange 9 }";
	struct diagnostics diagnostics = { 0 }, warnings = { 0 };
	struct scenery s;

	(void)state;
	CHECK(make(&s, foggy, &diagnostics, &warnings) == 0 && warnings.count == 1);
	CHECK(strcmp(diagnostics_cause(&warnings, 0),
		     "a.wrl:5: there is a Fog already; this one was left out") == 0);
	CHECK(s.fog.range_m == 40 && s.fog.is_exponential && s.fog.rgb[2] == 255 &&
	      s.fog.rgb[0] == 0 && s.fog.layer == SCENERY_NONE);
	scenery_finish(&s);
}

/* A lying beam and a post of one wood, which is called so in a prototype; and stone, by the name of
 * its Appearance, in its own colour. */
static void a_named_material_has_the_substance_that_the_content_says(void **state)
{
	static const char named[] =
		HEAD "PROTO Beam [ field SFVec3f measure 1 1 1 ] { Shape { geometry Box { size IS\n"
		     "  measure } appearance Appearance { material DEF Timber Material {\n"
		     "  diffuseColor 1 0 0 } } } }\n"
		     "Beam { measure 4 0.2 0.2 }\n"
		     "Transform { rotation 0 0 1 1.5708 children Beam { measure 4 0.2 0.2 } }\n"
		     "Shape { geometry Box {} appearance DEF Block Appearance {} }\n"
		     "Shape { geometry Box {} appearance DEF Other Appearance {} }";
	struct diagnostics diagnostics = { 0 }, warnings = { 0 };
	struct scenery_look looks[] = {
		{ .name = "Timber", .substance = SUBSTANCE_WOOD, .relief_m = 0.002f },
		{ .name = "Block", .substance = SUBSTANCE_LATERITE, .mirror = 0.5f },
		{ .name = "Nobody" },
	};
	const struct scenery_material *m;
	struct scenery s;

	(void)state;
	CHECK(make_with(&s, named, looks, 3, &diagnostics, &warnings) == 0 && warnings.count == 0);
	CHECK(looks[0].is_used && looks[1].is_used && !looks[2].is_used);
	CHECK(s.material_count == 4 && s.mesh_count == 4);
	m = s.materials;
	CHECK(m[0].substance == SUBSTANCE_WOOD && m[0].relief_m == 0.002f && m[0].by_pixel);
	CHECK(fabsf(m[0].grain[0]) > 0.999f && fabsf(m[1].grain[1]) > 0.999f);
	CHECK(s.meshes[0].vertices[0].rgb[0] == 255 && s.meshes[0].vertices[0].rgb[1] == 0);
	CHECK(m[2].substance == SUBSTANCE_LATERITE && m[2].mirror == 0.5f && m[2].grain[2] == 1);
	CHECK(s.meshes[2].vertices[0].rgb[0] > 1.5f * s.meshes[2].vertices[0].rgb[2]); /* red */
	CHECK(m[3].substance == 0 && !m[3].by_pixel);
	scenery_finish(&s);
}

static void what_is_not_kept_is_named_with_its_line(void **state)
{
	static const struct {
		const char *text, *warning;
	} cases[] = {
		{ HEAD "DEF T TouchSensor {}\nDEF L NavigationInfo {}\nShape { geometry Box {} }\n"
		       "ROUTE T.isActive TO L.set_bind",
		  "a.wrl:5: ROUTE from isActive to set_bind is not kept; docs/scenery.md says which are" },
		{ HEAD "DEF G Transform { children Shape { geometry Box {} } }\n"
		       "DEF C TimeSensor {}\n"
		       "DEF P PositionInterpolator { key 0 keyValue 0 0 0 }\n"
		       "ROUTE C.fraction_changed TO P.set_fraction\n"
		       "ROUTE P.value_changed TO G.translation",
		  "a.wrl:3: this TimeSensor is started by no TouchSensor's touchTime and does not "
		  "loop; it was left out" },
		{ HEAD "Shape { geometry Box {} }\nGroup { children SpotLight {} }",
		  "a.wrl:3: SpotLight is left out; scan and scenery have the sun of temple.ini" },
		{ HEAD "Shape { geometry Box {} }\nBackground {}",
		  "a.wrl:3: Background is left out; scan and scenery have the background of temple.ini" },
		{ HEAD "Shape { geometry Box {} }\nShape { geometry Group {} }",
		  "a.wrl:3: Group is no geometry; it was left out" },
	};

	(void)state;
	for (size_t i = 0; i < sizeof(cases) / sizeof(*cases); i++) {
		struct diagnostics diagnostics = { 0 }, warnings = { 0 };
		struct scenery s;

		CHECK(make(&s, cases[i].text, &diagnostics, &warnings) == 0);
		if (strcmp(diagnostics_cause(&warnings, 0), cases[i].warning) != 0)
			fail_msg("case %zu: %s", i, diagnostics_cause(&warnings, 0));
		CHECK(s.motion_count == 0 && s.track_count == 0 && s.number_count == 0);
		scenery_finish(&s);
	}
}

static void an_interpolator_without_sense_is_refused(void **state)
{
	static const char text[] =
		HEAD "DEF G Transform { children Shape { geometry Box {} } }\n"
		     "DEF C TimeSensor { loop TRUE }\n"
		     "DEF P PositionInterpolator { key [ 0 1 ] keyValue 0 0 0 }\n"
		     "ROUTE C.fraction_changed TO P.set_fraction\n"
		     "ROUTE P.value_changed TO G.translation";
	struct diagnostics diagnostics = { 0 }, warnings = { 0 };
	struct scenery s;

	(void)state;
	CHECK(make(&s, text, &diagnostics, &warnings) == -EBADMSG);
	CHECK(strcmp(diagnostics_cause(&diagnostics, 0),
		     "a.wrl:4: PositionInterpolator has another number of keys than of values; "
		     "correct them") == 0);
}

/* A sign that can be touched, below a Transform that stands still. */
static void a_billboard_is_a_node_that_faces_the_eye(void **state)
{
	static const char sign[] = HEAD
		"Transform { translation 5 0 0 children [\n"
		"  Billboard { axisOfRotation 0 0 4 children [ DEF T TouchSensor {}\n"
		"    Transform { translation 0 1 0 children Shape { geometry Box {} } } ] }\n"
		"  Billboard { children DEF M Transform { children Shape { geometry Box {} } } }\n"
		"  Billboard { axisOfRotation 0 0 0 children Shape { geometry Box {} } } ] }\n"
		"DEF C TimeSensor {}\n"
		"DEF P PositionInterpolator { key [ 0 1 ] keyValue [ 0 0 0, 0 1 0 ] }\n"
		"ROUTE T.touchTime TO C.startTime\n"
		"ROUTE C.fraction_changed TO P.set_fraction\n"
		"ROUTE P.value_changed TO M.translation\n";
	struct diagnostics diagnostics = { 0 }, warnings = { 0 };
	struct scenery s;

	(void)state;
	CHECK(make(&s, sign, &diagnostics, &warnings) == 0 && warnings.count == 0);
	CHECK(s.node_count == 6 && s.nodes[1].place.move_m[0] == 5);
	CHECK(s.nodes[1].sight.kind == SCENERY_SIGHT_NONE);
	CHECK(s.nodes[2].sight.kind == SCENERY_SIGHT_FACES && s.nodes[2].sight.at[2] == 1);
	CHECK(s.nodes[2].parent == 1 && s.touches[0].node == 2);
	CHECK(s.nodes[3].sight.at[1] == 1 && s.nodes[4].parent == 3 && s.tracks[0].node == 4);
	CHECK(s.nodes[5].sight.kind == SCENERY_SIGHT_FACES && s.nodes[5].sight.at[1] == 0);
	CHECK(s.meshes[0].node == 2 && s.meshes[0].origin_m[1] == 0); /* up by 1 already */
	scenery_finish(&s);
}

#define LOD(fields)                                                                                \
	HEAD "LOD { center 1 2 3 " fields "\n level [ Shape { geometry Box {} }\n"                 \
	     "Transform { translation 9 0 0 children Shape { geometry Box {} } }\n"                \
	     "Shape { geometry Sphere {} } ] }"

static void the_levels_of_an_lod_are_nodes_with_distances(void **state)
{
	struct diagnostics diagnostics = { 0 }, warnings = { 0 };
	struct scenery s;

	(void)state;
	CHECK(make(&s, LOD("range [ 5, 20, 30, 40 ]"), &diagnostics, &warnings) == 0);
	CHECK(s.node_count == 4 && s.mesh_count == 3);
	for (int i = 1; i < 4; i++) {
		CHECK(s.nodes[i].sight.kind == SCENERY_SIGHT_LEVEL && s.nodes[i].parent == 0);
		CHECK(s.nodes[i].sight.at[0] == 1 && s.nodes[i].sight.at[2] == 3);
	}
	CHECK(s.nodes[1].sight.from == 0 && s.nodes[1].sight.to == 5);
	CHECK(s.nodes[2].sight.from == 5 && s.nodes[2].sight.to == 20);
	CHECK(s.nodes[3].sight.from == 20 && isinf(s.nodes[3].sight.to)); /* the last goes on */
	CHECK(s.meshes[1].node == 2 && s.meshes[1].origin_m[0] == 8);
	scenery_finish(&s);
	CHECK(make(&s, LOD("range 5"), &diagnostics, &warnings) == 0);
	CHECK(s.node_count == 3 && s.mesh_count == 2 && isinf(s.nodes[2].sight.to));
	scenery_finish(&s);
	CHECK(make(&s, LOD(""), &diagnostics, &warnings) == 0); /* the first, and no node for it */
	CHECK(s.node_count == 1 && s.mesh_count == 1 && warnings.count == 0);
	scenery_finish(&s);
	CHECK(make(&s, LOD("\nrange [ 5 4 ]"), &diagnostics, &warnings) == -EBADMSG);
	CHECK(strcmp(diagnostics_cause(&diagnostics, 0),
		     "a.wrl:2: LOD has distances in range that do not ascend from above 0; "
		     "correct them") == 0);
	CHECK(make(&s, LOD("range [ 0 4 ]"), &diagnostics, &warnings) == -EBADMSG);
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(a_door_turns_on_its_hinge_when_it_is_touched),
		cmocka_unit_test(a_node_that_is_used_twice_moves_twice),
		cmocka_unit_test(what_a_finger_drags_is_kept_with_its_limits),
		cmocka_unit_test(a_faulty_drag_is_named_with_file_and_line),
		cmocka_unit_test(points_that_move_are_shapes_of_a_mesh),
		cmocka_unit_test(colours_go_by_their_hue),
		cmocka_unit_test(what_becomes_transparent_is_a_node),
		cmocka_unit_test(a_material_is_kept_with_its_highlight_and_transparency),
		cmocka_unit_test(normals_of_the_file_are_kept),
		cmocka_unit_test(the_first_fog_is_kept_in_metres),
		cmocka_unit_test(a_named_material_has_the_substance_that_the_content_says),
		cmocka_unit_test(what_is_not_kept_is_named_with_its_line),
		cmocka_unit_test(an_interpolator_without_sense_is_refused),
		cmocka_unit_test(a_billboard_is_a_node_that_faces_the_eye),
		cmocka_unit_test(the_levels_of_an_lod_are_nodes_with_distances),
	};

	return cmocka_run_group_tests(tests, NULL, NULL);
}
