/* Draws pieces program by program, and what else a picture has. */
#include "render/scene/scene_picture.h"

#include "base/clock.h"
#include "render/scene/scene_backdrop.h"
#include "render/scene/scene_plan.h"
#include "render/scene/scene_scenery.h"
#include "render/scene/scene_stream.h"

enum { NEW_BUDGET_US = 30000 }; /* for the first triangles with a program */

/* A range of triangles of the bound patch that is not drawn yet: consecutive pieces that need no
 * uniforms of their own are drawn together. */
struct run {
	uint32_t patch, first, count;
};

static void end_run(struct run *run)
{
	if (run->count > 0)
		geometry_draw(run->first, run->count);
	run->count = 0;
}

static void draw_piece(struct scene *scene, const struct surface_frame *frame,
		       const struct visible_piece *v, struct run *run)
{
	const struct geometry_patch *patch = &scene->geometry.patches[v->patch];
	const struct piece *piece = &patch->content.bvh.pieces[v->piece];
	bool joins = surface_faces(v->program) == 0 && v->patch == run->patch &&
		     piece->first_triangle == run->first + run->count;
	if (!joins)
		end_run(run);
	if (v->patch != run->patch) {
		geometry_bind(&scene->geometry, v->patch);
		if (!view_is_cut(frame->view))
			geometry_cull(&scene->geometry, v->patch);
		surface_dissolve(&scene->surface, v->range);
	}
	run->patch = v->patch;
	if (surface_faces(v->program) > 0)
		surface_blend(&scene->surface, frame, v->program, patch->pieces[v->piece].blend,
			      piece, scene_patch_error_m(scene, v->patch));
	if (run->count == 0)
		run->first = piece->first_triangle;
	run->count += piece->triangle_count;
}

/* Returns the program that draws a piece. While the eye moves and frames take too long, a piece of
 * which nothing was visible of late has its own colours: it costs no uniforms of its own. */
static int choose_program(const struct scene *scene, const struct surface_frame *frame,
			  const struct visible_piece *v)
{
	static const struct blend none[PLAN_ENTRIES];
	const struct piece_state *state = &scene->geometry.patches[v->patch].pieces[v->piece];
	const bool hidden = state->counted && state->seen_px <= 0;
	return surface_choose(frame, scene_gives_way(scene) && hidden ? none : state->blend,
			      v->range);
}

static void draw_with(struct scene *scene, const struct surface_frame *frame, int program)
{
	const uint32_t count = scene->visible_count + scene->leaving_count;
	struct run run = { .patch = HIERARCHY_NONE };
	surface_begin(&scene->surface, frame, program);
	for (uint32_t i = 0; i < count; i++)
		if (scene->visible[i].program == program)
			draw_piece(scene, frame, &scene->visible[i], &run);
	end_run(&run);
}

/* Gives the pieces of a program to the one for a face less. */
static void do_without(struct scene *scene, int program, uint32_t with[SURFACE_PROGRAMS])
{
	const uint32_t count = scene->visible_count + scene->leaving_count;
	for (uint32_t i = 0; i < count; i++)
		if (scene->visible[i].program == program)
			scene->visible[i].program--;
	with[program - 1] += with[program];
	scene->programs_wait = true;
}

/* Draws program by program, so that each sets its uniforms once. When the first images come, nearly
 * all of them are new, and without a GPU a frame that begins with all takes up to two seconds. */
static void draw_pieces(struct scene *scene, const struct surface_frame *frame)
{
	const uint32_t count = scene->visible_count + scene->leaving_count;
	uint32_t with[SURFACE_PROGRAMS] = { 0 };
	int64_t new_us = 0;
	for (uint32_t i = 0; i < count; i++) {
		struct visible_piece *v = &scene->visible[i];
		v->program = choose_program(scene, frame, v);
		if (v->program >= 0)
			with[v->program]++;
	}
	scene->programs_wait = false;
	for (int program = SURFACE_PROGRAMS - 1; program >= 0; program--) {
		const bool can_wait = surface_faces(program) > 0 && !frame->shares;
		if (with[program] == 0)
			continue;
		if (!surface_is_new(&scene->surface, frame, program)) {
			draw_with(scene, frame, program);
		} else if (can_wait && new_us > NEW_BUDGET_US) {
			do_without(scene, program, with);
		} else {
			const int64_t began_us = clock_now_us();
			draw_with(scene, frame, program);
			new_us += clock_now_us() - began_us;
		}
	}
	geometry_cull_none();
}

void scene_begin_picture(const struct scene *scene)
{
	const uint8_t *sky = scene->root.background;
	glDisable(GL_BLEND);
	glEnable(GL_DEPTH_TEST);
	glDepthMask(GL_TRUE);
	glDepthFunc(GL_LESS);
	glClearColor(sky[0] / 255.0f, sky[1] / 255.0f, sky[2] / 255.0f, 0);
	glClear(GL_COLOR_BUFFER_BIT | GL_DEPTH_BUFFER_BIT);
}

void scene_draw_picture(struct scene *scene, const struct view *view, enum picture kind)
{
	bool images = scene->options.mode != SCENE_POLYGONS && scene->repository.ready;
	const struct surface_frame frame = {
		.view = view,
		.root = &scene->root,
		.tiles = images ? &scene->tiles : NULL,
		.depth = &scene->depth,
		.repository = &scene->repository,
		.rake = scene->tools.rake,
		.fog = scene_fog(scene),
		.even = scene->options.mode == SCENE_CORNERS,
		.shares = kind == PICTURE_SHARES,
		.is_direct = kind == PICTURE_DIRECT,
	};
	draw_pieces(scene, &frame);
	scene_draw_stream(scene, &frame);
	if (!frame.shares)
		scene_draw_backdrop(scene, view);
	scene_draw_scenery(scene, &frame);
}
