#include "pipeline/scene/vrml.h"

#include <errno.h>
#include <fcntl.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/mman.h>
#include <unistd.h>
#include <zlib.h>

#include "pipeline/scene/vrml_surface.h"
#include "tests/check.h"

#define HEAD "#VRML V2.0 utf8\n"

/* What the files beside the scene hold. */
static int open_beside(void *data, const char *name)
{
	const char *text = NULL;
	int fd;

	(void)data;
	if (strcmp(name, "part.wrl") == 0)
		text = HEAD
			"PROTO Other [] { Box {} }\n"
			"PROTO Slab [ field SFVec3f measure 1 1 1 ] { Box { size IS measure } }\n"
			"Shape { geometry Box {} }";
	if (strcmp(name, "deep/er/wall.wrl") == 0)
		text = HEAD "Inline { url \"./stone.wrl\" } Inline { url \"../../part.wrl\" } "
			    "Inline { url \"part.wrl\" }";
	if (strcmp(name, "deep/er/stone.wrl") == 0)
		text = HEAD "Shape { geometry Box { size 1 1 1 } }";
	if (strcmp(name, "deep/er/out.wrl") == 0)
		text = HEAD "Inline { url \"../../../part.wrl\" }";
	if (strcmp(name, "loop.wrl") == 0)
		text = HEAD "Inline { url \"loop.wrl\" }";
	if (!text)
		return -ENOENT;
	fd = memfd_create(name, MFD_CLOEXEC);
	CHECK(fd >= 0 && write(fd, text, strlen(text)) == (ssize_t)strlen(text));
	CHECK(lseek(fd, 0, SEEK_SET) == 0);
	return fd;
}

static int make(struct vrml_surface *out, struct vrml **scene, struct bytes bytes,
		struct diagnostics *diagnostics)
{
	static const struct vrml_options options = { .open_file = open_beside };
	struct diagnostics warnings = { 0 };
	int rc = vrml_read(scene, bytes, "a.wrl", &options, diagnostics, &warnings);

	CHECK((rc == 0) == (*scene != NULL));
	return rc < 0 ? rc : vrml_surface_make(out, *scene, diagnostics);
}

static int make_text(struct vrml_surface *out, struct vrml **scene, const char *text,
		     struct diagnostics *diagnostics)
{
	return make(out, scene, (struct bytes){ (const uint8_t *)text, strlen(text) }, diagnostics);
}

/* The volume that a closed surface encloses: positive if its faces look outwards. */
static double volume_of(const struct soup *soup)
{
	double volume = 0;

	for (uint32_t i = 0; i < soup->count; i++) {
		const struct soup_corner *c = soup->triangles[i].corners;
		const float *a = c[0].position, *b = c[1].position, *d = c[2].position;

		volume += (double)(a[0] * (b[1] * d[2] - b[2] * d[1]) +
				   a[1] * (b[2] * d[0] - b[0] * d[2]) +
				   a[2] * (b[0] * d[1] - b[1] * d[0])) /
			  6;
	}
	return volume;
}

static double area_of(const struct soup *soup)
{
	double area = 0;

	for (uint32_t i = 0; i < soup->count; i++) {
		const struct soup_corner *c = soup->triangles[i].corners;
		double u[3], v[3];

		for (int k = 0; k < 3; k++) {
			u[k] = (double)(c[1].position[k] - c[0].position[k]);
			v[k] = (double)(c[2].position[k] - c[0].position[k]);
		}
		area += sqrt(pow(u[1] * v[2] - u[2] * v[1], 2) + pow(u[2] * v[0] - u[0] * v[2], 2) +
			     pow(u[0] * v[1] - u[1] * v[0], 2)) /
			2;
	}
	return area;
}

static void check_solid(const char *text, double volume, double share)
{
	struct diagnostics diagnostics = { 0 };
	struct vrml_surface surface;
	struct vrml *scene;

	if (make_text(&surface, &scene, text, &diagnostics) < 0)
		fail_msg("%s: %s", text, diagnostics.first.text);
	if (!(fabs(volume_of(&surface.soup) / volume - 1) <= share))
		fail_msg("%s: the volume is %g", text, volume_of(&surface.soup));
	vrml_surface_finish(&surface);
	vrml_destroy(scene);
}

/* A ring of radius 2 of a square rod, in the xz plane or upright. */
static void check_ring(bool is_upright)
{
	enum { STEPS = 48 };
	char text[8192];
	int used = snprintf(text, sizeof(text),
			    HEAD "Shape { geometry Extrusion { crossSection [ .1 .1, .1 -.1, -.1 "
				 "-.1, -.1 .1, .1 .1 ] spine [ ");

	for (int i = 0; i <= STEPS; i++) {
		const double angle = 2 * 3.14159265358979 * (i % STEPS) / STEPS;
		const double x = 2 * cos(angle), y = 2 * sin(angle);

		used += snprintf(text + used, sizeof(text) - (size_t)used, "%.6f %.6f %.6f, ", x,
				 is_upright ? y : 0, is_upright ? 0 : y);
	}
	snprintf(text + used, sizeof(text) - (size_t)used, "] } }");
	check_solid(text, 2 * 3.14159265358979 * 2 * 0.04, 0.02);
}

static void extrusions_follow_their_spine(void **state)
{
	(void)state;
	check_solid(HEAD "Shape { geometry Extrusion {} }", 4, 1e-4);
	check_solid(HEAD "Shape { geometry Extrusion { scale [ 1 1, .5 .5 ] } }", 7 / 3., 1e-4);
	check_solid(HEAD "Shape { geometry Extrusion { spine [ 0 0 0, 3 0 0 ] } }", 12, 1e-4);
	check_solid(HEAD "Shape { geometry Extrusion { spine [ 0 0 0, 0 -2 0 ] } }", 8, 1e-4);
	check_solid(HEAD "Shape { geometry Extrusion { orientation 0 1 0 .7 spine [ 0 0 0, 0 0 1, "
			 "0 0 1, 0 0 2 ] } }",
		    8, 1e-4);
	/* Round a corner: at the bend the section stands at half the angle, so it thins the rod. */
	check_solid(HEAD "Shape { geometry Extrusion { spine [ 0 0 0, 0 5 0, 5 5 0 ] } }",
		    2 * 5 * 4 * (1 + 0.70711) / 2, 0.03);
	check_ring(false);
	check_ring(true);
	/* a concave section */
	check_solid(HEAD "Shape { geometry Extrusion { crossSection [ 2 0, 0 -1, 1 0, "
			 "0 1, 2 0 ] } }",
		    1, 1e-4);
}

static void solids_look_outwards_and_have_their_size(void **state)
{
	const double pi = 3.14159265358979;

	(void)state;
	check_solid(HEAD "Shape { geometry Box { size 1 2 3 } }", 6, 1e-6);
	check_solid(HEAD "Shape { geometry Sphere { radius 2 } }", 4 / 3. * pi * 8, 0.02);
	check_solid(HEAD "Shape { geometry Cylinder { radius 2 height 3 } }", pi * 12, 0.02);
	check_solid(HEAD "Shape { geometry Cone { bottomRadius 2 height 3 } }", pi * 4, 0.02);
	/* mirrored, the outside stays outside */
	check_solid(HEAD "Transform { scale -1 2 1 children Shape { geometry Box {} } }", 16, 1e-6);
	check_solid(HEAD
		    "Transform { scale 1 1 2 scaleOrientation 0 0 1 0.7 rotation 1 2 3 1 center "
		    "4 5 6 translation 7 8 9 children Shape { geometry Box {} } }",
		    16, 1e-5);
	check_solid(HEAD
		    "Shape { geometry IndexedFaceSet { ccw FALSE coord Coordinate { point [ 0 0 0,"
		    " 1 0 0, 0 1 0, 0 0 1 ] } coordIndex [ 0 1 2 -1 0 3 1 -1 0 2 3 -1 1 3 2 ] } }",
		    1 / 6., 1e-6);
}

static void prototypes_files_and_repeated_nodes_are_put_in_place(void **state)
{
	(void)state;
	check_solid(HEAD
		    "DEF a Shape { geometry Box {} } Transform { translation 5 0 0 children [ USE "
		    "a NULL USE a ] }",
		    24, 1e-5);
	check_solid(HEAD
		    "PROTO Slab [ field SFFloat w 3 field SFVec3f s 1 1 1 eventIn SFTime go ] { "
		    "Shape { geometry Box { size IS s } } }\n"
		    "PROTO Two [ field SFVec3f t 1 2 1 ] { Group { children [ Slab { s IS t } Slab "
		    "{ } ] } } Two { } Two { t 1 1 4 }",
		    2 + 1 + 4 + 1, 1e-5);
	check_solid(HEAD
		    "EXTERNPROTO Slab [ field SFVec3f measure ] [ \"gone.wrl\" \"part.wrl#Slab\" "
		    "] Shape { geometry Slab { measure 1 1 7 } }",
		    7, 1e-5);
	check_solid(HEAD "Inline { url \"part.wrl\" } Inline { url \"part.wrl\" }", 16, 1e-5);
	/* Relative to the file that names it, or else to the scan. */
	check_solid(HEAD "Inline { url \"deep/er/wall.wrl\" }", 1 + 8 + 8, 1e-5);
	check_solid(HEAD
		    "Switch { whichChoice 1 choice [ Shape { geometry Sphere {} } Shape { geometry "
		    "Box {} } ] } Switch { choice Shape { geometry Box {} } } LOD { level [ Shape "
		    "{ geometry Box {} } Shape { geometry Sphere {} } ] }",
		    16, 1e-5);
}

static void concave_faces_and_grids_have_their_area(void **state)
{
	static const struct {
		const char *text;
		double area;
	} cases[] = {
		/* a U, a comb that a fan would overlap, and a face in which a hole is joined */
		{ "IndexedFaceSet { convex FALSE coord Coordinate { point [ 0 0 0, 3 0 0, 3 3 0, 2 3 "
		  "0, 2 1 0, 1 1 0, 1 3 0, 0 3 0 ] } coordIndex [ 0 1 2 3 4 5 6 7 -1 ] }",
		  7 },
		{ "IndexedFaceSet { coord Coordinate { point [ 0 0 5, 5 0 5, 5 2 5, 4 1 5, 3 2 5, 2 1 "
		  "5, 1 2 5, 0 1 5 ] } coordIndex [ 7 6 5 4 3 2 1 0 ] }",
		  7.5 },
		{ "IndexedFaceSet { coord Coordinate { point [ 0 0 0, 0 4 0, 0 4 4, 0 0 4, 0 1 1, 0 1 "
		  "3, 0 3 3, 0 3 1 ] } coordIndex [ 0 1 2 3 0 4 5 6 7 4 -1 ] }",
		  12 },
		{ "ElevationGrid { xDimension 3 zDimension 2 xSpacing 2 height [ 1 1 1 1 1 1 ] }",
		  4 },
	};

	(void)state;
	for (size_t i = 0; i < ARRAY_COUNT(cases); i++) {
		struct diagnostics diagnostics = { 0 };
		struct vrml_surface surface;
		struct vrml *scene;
		char text[512];

		snprintf(text, sizeof(text), HEAD "Shape { geometry %s }", cases[i].text);
		CHECK(make_text(&surface, &scene, text, &diagnostics) == 0);
		if (!(fabs(area_of(&surface.soup) - cases[i].area) < 1e-5))
			fail_msg("%s: the area is %g", text, area_of(&surface.soup));
		vrml_surface_finish(&surface);
		vrml_destroy(scene);
	}
}

static void colours_are_of_the_vertex_the_face_or_the_material(void **state)
{
	static const char text[] = HEAD
		"DEF look Shape { appearance Appearance { material Material { diffuseColor 1 0 0 } } "
		"geometry DEF f IndexedFaceSet { coord DEF c Coordinate { point [ 0 0 0 1 0 0 0 1 0 ] "
		"} coordIndex [ 0 1 2 ] } }\n"
		"Shape { geometry IndexedFaceSet { coord USE c coordIndex [ 0 1 2 -1 0 2 1 ] "
		"colorPerVertex FALSE color Color { color [ 0 1 0 0 0 1 ] } colorIndex [ 1 0 ] } }\n"
		"Shape { geometry IndexedFaceSet { coord USE c coordIndex [ 0 1 2 ] color Color { color "
		"[ 0 1 0 0 0 1 1 1 1 ] } } }";
	static const uint8_t red[3] = { 255, 0, 0 }, green[3] = { 0, 255, 0 };
	static const uint8_t blue[3] = { 0, 0, 255 };
	struct diagnostics diagnostics = { 0 };
	struct vrml_surface surface;
	struct vrml *scene;
	const struct soup_triangle *t;

	(void)state;
	CHECK(make_text(&surface, &scene, text, &diagnostics) == 0);
	t = surface.soup.triangles;
	CHECK(surface.soup.count == 4 && surface.has_colours);
	CHECK(memcmp(t[0].corners[2].rgb, red, 3) == 0);
	CHECK(memcmp(t[1].corners[0].rgb, blue, 3) == 0);
	CHECK(memcmp(t[2].corners[0].rgb, green, 3) == 0);
	CHECK(memcmp(t[3].corners[1].rgb, blue, 3) == 0);
	vrml_surface_finish(&surface);
	vrml_destroy(scene);
}

static void a_fault_names_file_line_and_cure(void **state)
{
	static const struct {
		const char *text, *message;
	} cases[] = {
		{ "#VRML V1.0 ascii\n", "a.wrl:1: it is VRML 1.0" },
		{ "ply\n", "a.wrl:1: it does not begin" },
		{ HEAD "\nScript { }", "a.wrl:3: Script is a program" },
		{ HEAD "Group {\nchildren [ Teapot { } ] }", "a.wrl:3: Teapot is no node" },
		{ HEAD "Group { children [", "a.wrl:2: the file ends" },
		{ HEAD "Shape { geometry Box { size 1 x 3 } }",
		  "a.wrl:2: 'x' stands where a number" },
		{ HEAD "Shape { geometry Box { size 1 1e99 3 } }", "a.wrl:2: '1e99'" },
		{ HEAD "USE a", "a.wrl:2: USE names a" },
		{ HEAD "DEF a Group { children USE a }", "a.wrl:2: a contains itself" },
		{ HEAD "ROUTE a.b TO c.d", "a.wrl:2: ROUTE names a" },
		{ HEAD "Inline { url \"gone.wrl\" }", "a.wrl:2: it names gone.wrl" },
		{ HEAD "Inline { url \"deep/er/out.wrl\" }",
		  "deep/er/out.wrl:2: it names ../../../part.wrl" },
		{ HEAD "Inline { url \"loop.wrl\" }", "loop.wrl:2: loop.wrl contains itself" },
		{ HEAD "PROTO P [ ] { P { } } P { }", "a.wrl:2: P is no node" },
		{ HEAD
		  "Shape { geometry\nIndexedFaceSet { coord Coordinate { point 0 0 0 } coordIndex "
		  "[ 0 -1 0 1 ] } }",
		  "a.wrl:3: face 1 of this IndexedFaceSet names point 1" },
		{ HEAD "Shape { geometry ElevationGrid { xDimension 2 zDimension 9 height 1 } }",
		  "a.wrl:2: ElevationGrid has 1 heights" },
	};

	(void)state;
	for (size_t i = 0; i < ARRAY_COUNT(cases); i++) {
		struct diagnostics diagnostics = { 0 };
		struct vrml_surface surface;
		struct vrml *scene;

		CHECK(make_text(&surface, &scene, cases[i].text, &diagnostics) < 0);
		if (strncmp(diagnostics.first.text, cases[i].message, strlen(cases[i].message)) !=
		    0)
			fail_msg("%s: %s", cases[i].text, diagnostics.first.text);
		vrml_destroy(scene);
	}
}

/* Scenes of a few hundred bytes that would need for ever, or all memory. */
static void bombs_are_refused(void **state)
{
	char text[8192];

	(void)state;
	for (int kind = 0; kind < 3; kind++) {
		struct diagnostics diagnostics = { 0 };
		struct vrml_surface surface;
		struct vrml *scene;
		size_t at = (size_t)snprintf(text, sizeof(text), HEAD "%s\n",
					     kind == 0 ? "DEF n0 Group { children Shape { geometry "
							 "Box {} } }"
						       : "PROTO P0 [] { Group {} }");

		for (int i = 1; i < 60 && kind < 2; i++)
			at += (size_t)snprintf(
				text + at, sizeof(text) - at,
				kind == 0 ? "DEF n%d Group { children [ USE n%d USE "
					    "n%d ] }\n"
					  : "PROTO P%d [] { Group { children [ P%d {} P%d {} ] } }",
				i, i - 1, i - 1);
		for (int i = 0; i < 300 && kind == 2; i++)
			at += (size_t)snprintf(text + at, sizeof(text) - at, "Group{children ");
		if (kind == 1)
			snprintf(text + at, sizeof(text) - at, "P59 {}");
		CHECK(make_text(&surface, &scene, text, &diagnostics) == -EFBIG);
		CHECK(strncmp(diagnostics.first.text, "a.wrl:", 6) == 0);
		vrml_destroy(scene);
	}
}

/* Neither what is skipped nor what USE nests may use up the stack. */
static void endless_depth_is_refused(void **state)
{
	enum { LINKS = 200000, ROOM = LINKS * 48 };
	char *text = malloc(ROOM);
	size_t at = (size_t)snprintf(text, ROOM, HEAD "Group { unknown ");
	struct diagnostics diagnostics = { 0 };
	struct vrml_surface surface;
	struct vrml *scene;

	(void)state;
	memset(text + at, '[', ROOM - at);
	text[ROOM - 1] = '\0';
	CHECK(make_text(&surface, &scene, text, &diagnostics) == -EBADMSG);
	at = (size_t)snprintf(text, ROOM, HEAD "Switch { choice [ DEF n0 Group { }\n");
	for (int i = 1; i < LINKS; i++)
		at += (size_t)snprintf(text + at, ROOM - at, "DEF n%d Group{children USE n%d}\n", i,
				       i - 1);
	snprintf(text + at, ROOM - at, "] } USE n%d", LINKS - 1);
	diagnostics = (struct diagnostics){ 0 };
	CHECK(make_text(&surface, &scene, text, &diagnostics) == -EFBIG);
	CHECK(strstr(diagnostics.first.text, "USE nests"));
	vrml_destroy(scene);
	free(text);
}

static void a_gzipped_scene_is_read_and_a_cut_one_refused(void **state)
{
	static const char text[] = HEAD "Shape { geometry Box {} }";
	z_stream stream = { .next_in = (Bytef *)text, .avail_in = sizeof(text) - 1 };
	uint8_t packed[256];
	size_t size;

	(void)state;
	CHECK(deflateInit2(&stream, 9, Z_DEFLATED, 15 + 16, 8, Z_DEFAULT_STRATEGY) == Z_OK);
	stream.next_out = packed;
	stream.avail_out = sizeof(packed);
	CHECK(deflate(&stream, Z_FINISH) == Z_STREAM_END);
	size = sizeof(packed) - stream.avail_out;
	deflateEnd(&stream);
	for (size_t n = 2; n <= size; n++) {
		struct diagnostics diagnostics = { 0 };
		struct vrml_surface surface = { 0 };
		struct vrml *scene;
		int rc = make(&surface, &scene, (struct bytes){ packed, n }, &diagnostics);

		CHECK(rc == (n == size ? 0 : -EBADMSG));
		CHECK(surface.soup.count == (n == size ? 12 : 0));
		vrml_surface_finish(&surface);
		vrml_destroy(scene);
	}
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(solids_look_outwards_and_have_their_size),
		cmocka_unit_test(extrusions_follow_their_spine),
		cmocka_unit_test(prototypes_files_and_repeated_nodes_are_put_in_place),
		cmocka_unit_test(concave_faces_and_grids_have_their_area),
		cmocka_unit_test(colours_are_of_the_vertex_the_face_or_the_material),
		cmocka_unit_test(a_fault_names_file_line_and_cure),
		cmocka_unit_test(bombs_are_refused),
		cmocka_unit_test(endless_depth_is_refused),
		cmocka_unit_test(a_gzipped_scene_is_read_and_a_cut_one_refused),
	};

	return cmocka_run_group_tests(tests, NULL, NULL);
}
