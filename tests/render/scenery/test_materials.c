/* Each material in GLES2 is what the formulas in C make of it, pixel by pixel. With
 * KEEP_PICTURES=DIR the pictures are kept in one sheet: GLES2 above, software below
 * (docs/materials.md). */
#include <stdio.h>
#include <stdlib.h>

#include "format/picture.h"
#include "geometry/substance.h"
#include "render/display/gl.h"
#include "render/display/headless.h"
#include "render/scenery/scenery_picture.h"
#include "tests/render/scenery/material_stage.h"
#include "tests/render/scenery/software_scenery.h"

enum { WIDTH = 160, HEIGHT = 120, PIXELS = WIDTH * HEIGHT, ACROSS = 4 };

static const uint8_t ochre[3] = { 196, 140, 84 }, white[3] = { 230, 230, 230 };
static const uint8_t red[3] = { 220, 40, 30 }, green[3] = { 40, 170, 60 },
		     blue[3] = { 40, 70, 220 };
static const float middle[3];

static const struct camera eye = {
	.eye_m = { 0, -3.4f, 0.6f },
	.up = { 0, 0, 1 },
	.fov_deg = 40,
	.near_m = 0.1f,
	.far_m = 100,
	.width_px = WIDTH,
	.height_px = HEIGHT,
};

/* ---- the cases */

static void make_flat(struct scenery *s)
{
	stage_ball(s, &(struct scenery_material){ .opacity = 1 }, middle, 1, 8, 1, true, ochre);
}

static void make_gouraud(struct scenery *s)
{
	const struct scenery_material shiny = { .opacity = 1,
						.specular = { 200, 200, 200 },
						.shininess = 24 };

	stage_ball(s, &shiny, middle, 1, 8, 1, false, ochre);
}

static void make_phong(struct scenery *s)
{
	const struct scenery_material shiny = {
		.opacity = 1, .by_pixel = true, .specular = { 200, 200, 200 }, .shininess = 24
	};

	stage_ball(s, &shiny, middle, 1, 8, 1, false, ochre);
}

static void make_emissive(struct scenery *s)
{
	const struct scenery_material lamp = { .opacity = 1, .emissive = { 120, 70, 0 } };

	stage_ball(s, &lamp, middle, 1, 12, 1, false, red);
}

static void make_two_sides(struct scenery *s)
{
	const struct scenery_material sides[2] = {
		{ .opacity = 1, .has_two_sides = true, .by_pixel = true },
		{ .opacity = 1, .has_two_sides = false },
	};

	stage_ball(s, &sides[0], (float[3]){ -0.75f, 0, 0.2f }, 0.7f, 12, 0.45f, false, ochre);
	stage_ball(s, &sides[1], (float[3]){ 0.75f, 0, 0.2f }, 0.7f, 12, 0.45f, false, ochre);
}

static void make_transparent(struct scenery *s)
{
	const struct scenery_material glass = { .opacity = 0.5f, .has_two_sides = true };
	const struct scenery_material bubble = { .opacity = 0.35f,
						 .has_two_sides = true,
						 .by_pixel = true,
						 .specular = { 255, 255, 255 },
						 .shininess = 60 };
	const float across[3] = { 1.2f, 0, 0 }, along[3] = { 0, 0, 1.2f };

	/* nearest first, so that drawing them in this order would be wrong */
	stage_pane(s, &glass, (float[3]){ -0.4f, -1, 0 }, across, along, 2, red);
	stage_pane(s, &glass, (float[3]){ 0, -0.6f, 0.2f }, across, along, 2, green);
	stage_pane(s, &glass, (float[3]){ 0.4f, -0.2f, -0.1f }, across, along, 2, blue);
	stage_ball(s, &bubble, (float[3]){ 0.2f, 0.9f, 0.3f }, 0.8f, 12, 1, false, white);
	stage_ball(s, &(struct scenery_material){ .opacity = 1 }, (float[3]){ 0.2f, 0.9f, 0.3f },
		   0.35f, 10, 1, false, ochre);
}

static void make_row(struct scenery *s, bool is_exponential)
{
	for (int i = 0; i < 5; i++)
		stage_ball(s, &(struct scenery_material){ .opacity = 1 },
			   (float[3]){ (float)i - 0.5f, 2.5f * (float)i - 1, 0 }, 0.6f, 10, 1,
			   false, ochre);
	s->fog = (struct scenery_fog){ .range_m = 13,
				       .is_exponential = is_exponential,
				       .rgb = { 150, 170, 190 },
				       .layer = SCENERY_NONE };
}

static void make_linear_fog(struct scenery *s)
{
	make_row(s, false);
}

static void make_exponential_fog(struct scenery *s)
{
	make_row(s, true);
}

/* Half of it in a node that is turned, scaled and moved. */
static void make_substance(struct scenery *s, enum substance_kind kind, float relief_m)
{
	const struct scenery_material solid = {
		.opacity = 1, .by_pixel = true, .substance = (uint8_t)kind, .relief_m = relief_m
	};
	struct scenery_place *place = &s->nodes[0].place;
	uint8_t rgb[3];
	float mean[3];

	substance_colour(mean, kind, middle, 1000);
	for (int k = 0; k < 3; k++)
		rgb[k] = (uint8_t)lrintf(mean[k] * 255);
	for (int k = 0; k < 3; k++)
		place->scale[k] = 0.01f; /* centimetres */
	place->turn[2] = 0.3826834f;
	place->turn[3] = 0.9238795f;
	stage_ball(s, &solid, (float[3]){ 5, -8, 10 }, 35, 12, 1, false, rgb);
	stage_pane(s, &solid, (float[3]){ 5, -20, -28 }, (float[3]){ 200, 0, 0 },
		   (float[3]){ 0, 140, 0 }, 4, rgb);
}

static void make_marble(struct scenery *s)
{
	make_substance(s, SUBSTANCE_MARBLE, 0);
}

static void make_wood(struct scenery *s)
{
	make_substance(s, SUBSTANCE_WOOD, 0);
	for (uint32_t i = 0; i < s->material_count; i++)
		memcpy(s->materials[i].grain, (float[3]){ 1, 0, 0 }, 12);
}

static void make_rough_sandstone(struct scenery *s)
{
	make_substance(s, SUBSTANCE_SANDSTONE, 0.01f);
}

static void make_rough_laterite(struct scenery *s)
{
	make_substance(s, SUBSTANCE_LATERITE, 0.006f);
}

static void make_hewn(struct scenery *s)
{
	make_substance(s, SUBSTANCE_NONE + 1, 0.03f);
	for (uint32_t i = 0; i < s->material_count; i++)
		s->materials[i].substance = SUBSTANCE_NONE;
}

static void make_mirror(struct scenery *s)
{
	const struct scenery_material silver = { .opacity = 1, .by_pixel = true, .mirror = 0.8f };

	stage_ball(s, &silver, middle, 1, 16, 1, false, white);
}

static void make_rough_gold(struct scenery *s)
{
	const struct scenery_material gold = { .opacity = 1,
					       .by_pixel = true,
					       .specular = { 255, 220, 120 },
					       .shininess = 30,
					       .relief_m = 0.01f,
					       .mirror = 0.4f };

	stage_ball(s, &gold, middle, 1, 16, 1, false, (const uint8_t[3]){ 212, 160, 50 });
}

/* Near and far: enlarged in front, halved again and again behind. */
static void make_painted(struct scenery *s)
{
	const struct scenery_material board = {
		.opacity = 1, .by_pixel = true, .specular = { 60, 60, 60 }, .shininess = 20
	};
	struct scenery_mesh *mesh =
		stage_pane(s, &board, (float[3]){ 0, 1, 0.1f }, (float[3]){ 2, -1.6f, 0 },
			   (float[3]){ 0, 0, 1.6f }, 4, white);

	stage_paint(s, mesh, 64, 1);
}

static void make_tiled(struct scenery *s)
{
	const struct scenery_material tiles = { .opacity = 1, .by_pixel = true };
	struct scenery_mesh *mesh =
		stage_pane(s, &tiles, (float[3]){ 0, 2.5f, 0.2f }, (float[3]){ 3, -6, 0 },
			   (float[3]){ 0, 0, 1.8f }, 4, white);

	stage_paint(s, mesh, 128, 7);
}

static void make_embossed(struct scenery *s)
{
	const struct scenery_material plaster = {
		.opacity = 1, .by_pixel = true, .specular = { 60, 60, 60 }, .shininess = 20
	};
	struct scenery_mesh *mesh =
		stage_pane(s, &plaster, (float[3]){ 0, 0.6f, 0.1f }, (float[3]){ 2.2f, -1, 0 },
			   (float[3]){ 0, 0, 1.8f }, 4, ochre);

	stage_emboss(s, mesh, 64, 3);
}

/* Round, with a picture too, and seen from both sides: a dome outside is a dent inside. */
static void make_embossed_bowl(struct scenery *s)
{
	const struct scenery_material clay = { .opacity = 1,
					       .by_pixel = true,
					       .has_two_sides = true };
	const uint32_t before = s->mesh_count;

	stage_ball(s, &clay, middle, 1, 14, 0.6f, false, white);
	CHECK(s->mesh_count == before + 1);
	stage_paint(s, &s->meshes[before], 64, 1);
	stage_emboss(s, &s->meshes[before], 64, 1);
}

static const struct material_case {
	const char *name;
	void (*make)(struct scenery *s);
	float closer; /* the eye, by so many times */
} cases[] = {
	{ "flat", make_flat, 1 },
	{ "Gouraud", make_gouraud, 1 },
	{ "Phong", make_phong, 1 },
	{ "emissive", make_emissive, 1 },
	{ "two sides", make_two_sides, 1 },
	{ "transparency in order", make_transparent, 1 },
	{ "linear fog", make_linear_fog, 1 },
	{ "exponential fog", make_exponential_fog, 1 },
	{ "marble", make_marble, 2.5f },
	{ "wood", make_wood, 4 },
	{ "sandstone with relief", make_rough_sandstone, 2.5f },
	{ "laterite with relief", make_rough_laterite, 2.5f },
	{ "hewn stone", make_hewn, 2.5f },
	{ "environment", make_mirror, 1 },
	{ "environment, relief, highlight", make_rough_gold, 1 },
	{ "picture", make_painted, 1 },
	{ "picture that repeats", make_tiled, 1 },
	{ "normal map", make_embossed, 1 },
	{ "normal map, picture, two sides", make_embossed_bowl, 1 },
};

enum { CASES = sizeof(cases) / sizeof(*cases), ROWS = (CASES + ACROSS - 1) / ACROSS };

/* ---- what is around */

enum { CUBE_PX = 32 };

/* A sky that darkens upwards, over ground with stripes towards the south. */
static struct appearance_cube make_around(void)
{
	static uint8_t pixels[6][4 * CUBE_PX * CUBE_PX];
	struct appearance_cube cube = { .side_px = CUBE_PX };

	for (int face = 0; face < 6; face++) {
		cube.faces[face] = pixels[face];
		for (int i = 0; i < CUBE_PX * CUBE_PX; i++) {
			const float s = 2 * ((float)(i % CUBE_PX) + 0.5f) / CUBE_PX - 1,
				    t = 2 * ((float)(i / CUBE_PX) + 0.5f) / CUBE_PX - 1;
			const float d[6][3] = { { 1, -t, -s }, { -1, -t, s }, { s, 1, t },
						{ s, -1, -t }, { s, -t, 1 },  { -s, -t, -1 } };
			const float high = d[face][2] / vec_length(d[face]);
			uint8_t *p = &pixels[face][4 * i];

			p[0] = (uint8_t)(high > 0 ? 200 - 120 * high : 110 + 40 * d[face][1]);
			p[1] = (uint8_t)(high > 0 ? 210 - 90 * high : 80);
			p[2] = (uint8_t)(high > 0 ? 235 : 60 + 50 * d[face][0]);
			p[3] = 255;
		}
	}
	return cube;
}

/* ---- pictures of both */

static uint8_t sheet[4 * 2 * ROWS * HEIGHT * ACROSS * WIDTH];

static void keep(int number, int row, const uint8_t *rgba)
{
	const int x = number % ACROSS * WIDTH, y = (2 * (number / ACROSS) + row) * HEIGHT;

	for (int line = 0; line < HEIGHT; line++)
		memcpy(&sheet[4 * ((y + line) * ACROSS * WIDTH + x)], &rgba[4 * line * WIDTH],
		       (size_t)4 * WIDTH);
}

static void write_sheet(void)
{
	const struct picture picture = { ACROSS * WIDTH, 2 * ROWS * HEIGHT, sheet };
	char path[512];
	struct buffer file;

	if (!getenv("KEEP_PICTURES"))
		return;
	buffer_init(&file, 64 << 20);
	CHECK(picture_encode_png(&file, &picture) == 0);
	snprintf(path, sizeof(path), "%s/materials.png", getenv("KEEP_PICTURES"));
	CHECK(bytes_write_file(buffer_bytes(&file), path) == 0);
	buffer_finish(&file);
}

static double psnr(const uint8_t *a, const uint8_t *b)
{
	double sum = 0;

	for (int i = 0; i < 4 * PIXELS; i++)
		sum += i % 4 < 3 ? (a[i] - b[i]) * (a[i] - b[i]) : 0;
	return 10 * log10(255.0 * 255.0 * 3 * PIXELS / (sum + 1e-9));
}

static void draw_gles(const struct gl_target *target, const struct pose *pose, struct scenery *s,
		      const struct surface_frame *frame, const struct appearance_cube *around,
		      uint8_t *rgba)
{
	const uint8_t *sky = frame->root->background;
	struct scenery_picture picture = { 0 };
	GLuint cube;

	CHECK(scenery_picture_load(&picture, pose->scenery) == 0);
	CHECK(scenery_cube_create(&cube, around) == 0);
	scenery_picture_surround(&picture, cube);
	while (!scenery_textures_next(&picture.textures, s))
		continue;
	gl_target_bind(target);
	glEnable(GL_DEPTH_TEST);
	glDepthFunc(GL_LESS);
	glClearColor(sky[0] / 255.0f, sky[1] / 255.0f, sky[2] / 255.0f, 1);
	do {
		glClear(GL_COLOR_BUFFER_BIT | GL_DEPTH_BUFFER_BIT);
	} while (!scenery_picture_draw(&picture, pose, frame));
	CHECK(gl_target_read(target, rgba) == 0);
	scenery_picture_finish(&picture);
}

static struct surface_fog fog_of(const struct scenery *s)
{
	struct surface_fog fog = { .share = s->fog.range_m > 0 ? 1 : 0,
				   .range_m = s->fog.range_m,
				   .is_exponential = s->fog.is_exponential };

	for (int k = 0; k < 3; k++)
		fog.rgb[k] = (float)s->fog.rgb[k] / 255;
	return fog;
}

/* Returns the likeness of both in decibel. */
static double compare(const struct gl_target *target, int number)
{
	static uint8_t drawn[4 * PIXELS], truth[4 * PIXELS];
	const struct appearance_cube around = make_around();
	const struct root_page root = stage_root();
	struct software_picture software;
	struct camera camera;
	struct scenery s;
	struct pose pose;
	struct view view;

	stage_init(&s);
	cases[number].make(&s);
	CHECK(scenery_is_sane(&s) && pose_init(&pose, &s) == 0);
	pose_step(&pose, 1e6f);
	camera = eye;
	vec_scale(camera.eye_m, 1 / cases[number].closer, eye.eye_m);
	view_from_camera(&view, &camera);
	software_init(&software, &pose, &view, &root, &around);
	software_draw(&software, truth);
	draw_gles(target, &pose, &s,
		  &(struct surface_frame){ .view = &view, .root = &root, .fog = fog_of(&s) },
		  &around, drawn);
	keep(number, 0, drawn);
	keep(number, 1, truth);
	software_finish(&software);
	pose_finish(&pose);
	scenery_finish(&s);
	return psnr(drawn, truth);
}

/* A pixel at an outline may fall to the other side; that alone leaves about 40 dB. */
static const double least_db = 38;

static void every_material_is_what_software_makes_of_it(void **state)
{
	struct headless *headless;
	struct gl_target target;
	int worse = 0;

	(void)state;
	memset(sheet, 255, sizeof(sheet));
	CHECK(headless_create(&headless) == 0);
	CHECK(gl_target_create(&target, WIDTH, HEIGHT) == 0);
	for (int i = 0; i < CASES; i++) {
		const double db = compare(&target, i);

		print_message("%s: %.1f dB\n", cases[i].name, db);
		worse += db < least_db;
	}
	write_sheet();
	CHECK(gl_has_extension("GL_OES_standard_derivatives")); /* else there was no normal map */
	gl_target_destroy(&target);
	CHECK(gl_check("the test") == 0);
	headless_destroy(headless);
	CHECK(worse == 0);
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(every_material_is_what_software_makes_of_it),
	};

	return cmocka_run_group_tests(tests, NULL, NULL);
}
