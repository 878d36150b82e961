/* What each material of scenery costs beside flat shading, with the scenes of Tables 2-1 and 2-2 of
 * paper 003: 12 spheres of about 256 polygons, and 24 bodies of about 12 544 (teapots there,
 * spheres here). JSON to standard output. In each round every material is drawn in turn. Ratios are
 * of processor time, of all threads together, to flat shading in the same round: other work on the
 * machine changes it little. */
#include <stdio.h>
#include <stdlib.h>
#include <time.h>

#include "base/clock.h"
#include "geometry/substance.h"
#include "render/display/gl.h"
#include "render/display/headless.h"
#include "render/scenery/scenery_picture.h"
#include "tests/render/scenery/material_stage.h"

enum { WIDTH = 640, HEIGHT = 480, ROUNDS = 5, CUBE_PX = 64 };

static const struct way {
	const char *name;
	bool is_flat, is_foggy, is_painted, is_embossed;
	struct scenery_material material;
} ways[] = {
	{ "flat", true, false, .material = { .opacity = 1 } },
	{ "Gouraud", false, false, .material = { .opacity = 1 } },
	{ "Gouraud with highlight", false, false,
	  .material = { .opacity = 1, .specular = { 200, 200, 200 }, .shininess = 24 } },
	{ "Phong", false, false,
	  .material = { .opacity = 1,
			.by_pixel = true,
			.specular = { 200, 200, 200 },
			.shininess = 24 } },
	{ "two-sided", false, false, .material = { .opacity = 1, .has_two_sides = true } },
	{ "fog", false, true, .material = { .opacity = 1 } },
	{ "transparency in order", false, false, .material = { .opacity = 0.5f } },
	{ "marble", false, false,
	  .material = { .opacity = 1, .by_pixel = true, .substance = SUBSTANCE_MARBLE } },
	{ "wood", false, false,
	  .material = { .opacity = 1, .by_pixel = true, .substance = SUBSTANCE_WOOD } },
	{ "sandstone", false, false,
	  .material = { .opacity = 1, .by_pixel = true, .substance = SUBSTANCE_SANDSTONE } },
	{ "laterite", false, false,
	  .material = { .opacity = 1, .by_pixel = true, .substance = SUBSTANCE_LATERITE } },
	{ "bumps of hewn stone", false, false,
	  .material = { .opacity = 1, .by_pixel = true, .relief_m = 0.01f } },
	{ "wood with its bumps", false, false,
	  .material = { .opacity = 1,
			.by_pixel = true,
			.substance = SUBSTANCE_WOOD,
			.relief_m = 0.002f } },
	{ "environment", false, false,
	  .material = { .opacity = 1, .by_pixel = true, .mirror = 0.7f } },
	{ "picture", .is_painted = true, .material = { .opacity = 1, .by_pixel = true } },
	{ "normal map", .is_embossed = true, .material = { .opacity = 1, .by_pixel = true } },
};

enum { WAYS = sizeof(ways) / sizeof(*ways) };

static const struct setting {
	const char *name;
	int count, across, bands, frames;
} settings[] = {
	{ "12 spheres of 224 triangles", 12, 4, 8, 20 },
	{ "24 spheres of 12320 triangles", 24, 6, 56, 2 },
};

/* A material that is being measured. */
struct measured {
	struct scenery scenery;
	struct pose pose;
	struct scenery_picture picture;
	struct surface_fog fog;
	double ms[ROUNDS], processor_ms[ROUNDS];
	bool is_left_out; /* more transparent triangles than scenery may have */
};

static struct measured measured[WAYS];

/* Lays a picture of 256 x 256 pixels on the last ball: the same on all. */
static void put_picture(struct scenery *s, bool is_map)
{
	struct scenery_mesh *mesh = &s->meshes[s->mesh_count - 1];
	struct scenery_material *material = &s->materials[mesh->material];

	if (s->texture_count == 0) {
		if (is_map)
			stage_emboss(s, mesh, 256, 1);
		else
			stage_paint(s, mesh, 256, 1);
		return;
	}
	stage_lay(mesh, 1);
	material->texture = !is_map;
	material->normals = is_map;
}

static void make(struct measured *m, const struct way *way, const struct setting *setting)
{
	static const uint8_t ochre[3] = { 196, 140, 84 };
	static uint8_t sky[4 * CUBE_PX * CUBE_PX];
	const struct appearance_cube around = { { sky, sky, sky, sky, sky, sky }, CUBE_PX };
	GLuint cube;

	*m = (struct measured){ .is_left_out =
					way->material.opacity < 1 &&
					setting->count * setting->bands * setting->bands * 4 >
						SCENERY_CLEAR_TRIANGLES_MAX };
	if (m->is_left_out)
		return;
	stage_init(&m->scenery);
	for (int i = 0; i < setting->count; i++) {
		const int rows = setting->count / setting->across;
		const float centre[3] = { (float)(i % setting->across) -
						  (float)(setting->across - 1) / 2,
					  0, (float)(i / setting->across) - (float)(rows - 1) / 2 };

		stage_ball(&m->scenery, &way->material, centre, 0.48f, setting->bands, 1,
			   way->is_flat, ochre);
		if (way->is_painted || way->is_embossed)
			put_picture(&m->scenery, way->is_embossed);
	}
	m->fog = (struct surface_fog){ .share = way->is_foggy, .range_m = 9 };
	CHECK(scenery_is_sane(&m->scenery) && pose_init(&m->pose, &m->scenery) == 0);
	pose_step(&m->pose, 1e6f);
	CHECK(scenery_picture_load(&m->picture, &m->scenery) == 0);
	CHECK(scenery_cube_create(&cube, &around) == 0);
	scenery_picture_surround(&m->picture, cube);
	while (!scenery_textures_next(&m->picture.textures, &m->scenery))
		continue;
}

static void finish(struct measured *m)
{
	scenery_picture_finish(&m->picture);
	pose_finish(&m->pose);
	scenery_finish(&m->scenery);
}

static double processor_ms(void)
{
	struct timespec now;

	CHECK(clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &now) == 0);
	return (double)now.tv_sec * 1e3 + (double)now.tv_nsec / 1e6;
}

/* Draws some frames as a round. */
static void draw(struct measured *m, int frames, int round)
{
	const struct root_page root = stage_root();
	struct camera camera = { .up = { 0, 0, 1 },
				 .fov_deg = 40,
				 .near_m = 0.1f,
				 .far_m = 100,
				 .width_px = WIDTH,
				 .height_px = HEIGHT };
	double began_ms;
	int64_t began_us;
	struct view view;

	camera.eye_m[1] = -5.6f;
	view_from_camera(&view, &camera);
	const struct surface_frame frame = { .view = &view, .root = &root, .fog = m->fog };
	while (!scenery_picture_draw(&m->picture, &m->pose, &frame))
		continue;
	began_us = clock_now_us();
	began_ms = processor_ms();
	for (int i = 0; i < frames; i++) {
		glClear(GL_COLOR_BUFFER_BIT | GL_DEPTH_BUFFER_BIT);
		(void)scenery_picture_draw(&m->picture, &m->pose, &frame);
		glFinish();
	}
	m->ms[round] = (double)(clock_now_us() - began_us) / 1000 / frames;
	m->processor_ms[round] = (processor_ms() - began_ms) / frames;
}

static int ascending(const void *a, const void *b)
{
	const double x = *(const double *)a, y = *(const double *)b;

	return (x > y) - (x < y);
}

static void print(const struct setting *setting, bool is_last)
{
	bool is_first = true;

	printf("  \"%s\": {\n", setting->name);
	for (int i = 0; i < WAYS; i++) {
		double ratios[ROUNDS];

		if (measured[i].is_left_out)
			continue;
		printf("%s    \"%s\": {\"ms\": [", is_first ? "" : ",\n", ways[i].name);
		is_first = false;
		for (int k = 0; k < ROUNDS; k++) {
			printf("%s%.2f", k ? ", " : "", measured[i].ms[k]);
			ratios[k] = measured[i].processor_ms[k] / measured[0].processor_ms[k];
		}
		printf("], \"processor_ms\": [");
		for (int k = 0; k < ROUNDS; k++)
			printf("%s%.2f", k ? ", " : "", measured[i].processor_ms[k]);
		printf("], \"to_flat\": [");
		for (int k = 0; k < ROUNDS; k++)
			printf("%s%.3f", k ? ", " : "", ratios[k]);
		qsort(ratios, ROUNDS, sizeof(*ratios), ascending);
		printf("], \"median_to_flat\": %.3f}", ratios[ROUNDS / 2]);
	}
	printf("\n  }%s\n", is_last ? "" : ",");
}

static void measure(const struct setting *setting, bool is_last)
{
	for (int i = 0; i < WAYS; i++) {
		make(&measured[i], &ways[i], setting);
		if (!measured[i].is_left_out)
			draw(&measured[i], 1, 0); /* builds the programs */
	}
	for (int round = 0; round < ROUNDS; round++)
		for (int i = 0; i < WAYS; i++)
			if (!measured[i].is_left_out)
				draw(&measured[i], setting->frames, round);
	print(setting, is_last);
	for (int i = 0; i < WAYS; i++)
		finish(&measured[i]);
}

int main(void)
{
	const int count = (int)(sizeof(settings) / sizeof(*settings));
	struct headless *headless;
	struct gl_target target;

	CHECK(headless_create(&headless) == 0);
	CHECK(gl_target_create(&target, WIDTH, HEIGHT) == 0);
	glEnable(GL_DEPTH_TEST);
	glDepthFunc(GL_LESS);
	printf("{\n  \"renderer\": \"%s\", \"width_px\": %d, \"height_px\": %d,\n",
	       (const char *)glGetString(GL_RENDERER), WIDTH, HEIGHT);
	for (int i = 0; i < count; i++)
		measure(&settings[i], i + 1 == count);
	puts("}");
	gl_target_destroy(&target);
	headless_destroy(headless);
	return EXIT_SUCCESS;
}
