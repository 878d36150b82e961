/* Each material in GLES2 is what the formulas in C make of it, pixel by pixel. With
 * KEEP_PICTURES=DIR the pictures are kept in one sheet: GLES2 above, software below
 * (docs/materials.md). */
#include <stdio.h>
#include <stdlib.h>

#include "format/picture.h"
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
			   (float[3]){ (float)i - 1.4f, 2.5f * (float)i - 1, 0 }, 0.6f, 10, 1,
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

static const struct material_case {
	const char *name;
	void (*make)(struct scenery *s);
} cases[] = {
	{ "flat", make_flat },
	{ "Gouraud", make_gouraud },
	{ "Phong", make_phong },
	{ "emissive", make_emissive },
	{ "two sides", make_two_sides },
	{ "transparency in order", make_transparent },
	{ "linear fog", make_linear_fog },
	{ "exponential fog", make_exponential_fog },
};

enum { CASES = sizeof(cases) / sizeof(*cases), ROWS = (CASES + ACROSS - 1) / ACROSS };

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

static void draw_gles(const struct gl_target *target, const struct pose *pose,
		      const struct surface_frame *frame, uint8_t *rgba)
{
	const uint8_t *sky = frame->root->background;
	struct scenery_picture picture = { 0 };

	CHECK(scenery_picture_load(&picture, pose->scenery) == 0);
	gl_target_bind(target);
	glEnable(GL_DEPTH_TEST);
	glDepthFunc(GL_LESS);
	glClearColor(sky[0] / 255.0f, sky[1] / 255.0f, sky[2] / 255.0f, 1);
	glClear(GL_COLOR_BUFFER_BIT | GL_DEPTH_BUFFER_BIT);
	scenery_picture_draw(&picture, pose, frame);
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
	const struct root_page root = stage_root();
	struct software_picture software;
	struct scenery s;
	struct pose pose;
	struct view view;

	stage_init(&s);
	cases[number].make(&s);
	CHECK(scenery_is_sane(&s) && pose_init(&pose, &s) == 0);
	pose_step(&pose, 1e6f);
	view_from_camera(&view, &eye);
	draw_gles(target, &pose,
		  &(struct surface_frame){ .view = &view, .root = &root, .fog = fog_of(&s) },
		  drawn);
	software_init(&software, &pose, &view, &root);
	software_draw(&software, truth);
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
	CHECK(headless_create(&headless) == 0);
	CHECK(gl_target_create(&target, WIDTH, HEIGHT) == 0);
	for (int i = 0; i < CASES; i++) {
		const double db = compare(&target, i);

		print_message("%s: %.1f dB\n", cases[i].name, db);
		worse += db < least_db;
	}
	write_sheet();
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
