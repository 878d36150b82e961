/* Draws pieces program by program, and what else a picture has. */
#include "render/scene/scene_picture.h"

#include <math.h>

#include "base/clock.h"
#include "render/scene/scene_backdrop.h"
#include "render/scene/scene_plan.h"
#include "render/scene/scene_scenery.h"
#include "render/scene/scene_stream.h"
#include "render/scene/scene_visibility.h"

enum { NEW_BUDGET_US = 30000 }; /* for the first triangles with a program */

/* What a triangle and a seen pixel of a face take of a picture, in triangles of the visibility
 * pass, by two cores without a GPU. */
static const float triangle_cost = 1.25f, fragment_cost = 0.27f;

/* A range of triangles of the bound patch that is not drawn yet: consecutive pieces that need no
 * uniforms of their own are drawn together. */
struct run {
	uint32_t patch, first, count;
};

static void end_run(struct scene *scene, struct run *run)
{
	if (run->count > 0)
		geometry_draw(&scene->geometry, run->first, run->count);
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
		end_run(scene, run);
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

float scene_piece_cost(const struct scene *scene, const struct visible_piece *v, int faces,
		       float picture_px)
{
	const struct geometry_patch *patch = &scene->geometry.patches[v->patch];
	const struct piece_state *state = &patch->pieces[v->piece];
	return triangle_cost * (float)patch->content.bvh.pieces[v->piece].triangle_count +
	       fragment_cost * (float)(faces > 1 ? faces : 1) * scene_seen_px(state, v) *
		       picture_px / scene->view.picture_px;
}

/* Draws pieces of the slice's program until the cost is reached. Returns that of those it drew. */
static float draw_with(struct scene *scene, const struct surface_frame *frame,
		       struct scene_slice *slice, float cost)
{
	struct run run = { .patch = HIERARCHY_NONE };
	float drawn = 0;
	surface_begin(&scene->surface, frame, slice->program);
	for (; slice->at < slice->count && drawn < cost; slice->at++) {
		const struct visible_piece *v = &slice->pieces[slice->at];
		const struct geometry_patch *patch = &scene->geometry.patches[v->patch];
		/* between two slices it may have been dropped */
		if (v->program != slice->program || !patch->pieces)
			continue;
		draw_piece(scene, frame, v, &run);
		drawn += scene_piece_cost(scene, v, surface_faces(slice->program),
					  frame->view->picture_px);
	}
	end_run(scene, &run);
	return drawn;
}

/* Gives the pieces of the slice's program to the one for a face less. */
static void do_without(struct scene *scene, struct scene_slice *slice)
{
	const int program = slice->program;
	for (uint32_t i = 0; i < slice->count; i++)
		if (slice->pieces[i].program == program)
			slice->pieces[i].program--;
	slice->with[program - 1] += slice->with[program];
	slice->with[program] = 0;
	scene->programs_wait = true;
}

void scene_begin_slices(struct scene *scene, const struct surface_frame *frame,
			struct visible_piece *pieces, uint32_t count, struct scene_slice *out)
{
	*out = (struct scene_slice){ .pieces = pieces,
				     .count = count,
				     .program = SURFACE_PROGRAMS - 1 };
	for (uint32_t i = 0; i < count; i++) {
		struct visible_piece *v = &pieces[i];
		v->program = choose_program(scene, frame, v);
		if (v->program >= 0)
			out->with[v->program]++;
	}
	scene->programs_wait = false;
}

/* Draws program by program, so that each sets its uniforms once. When the first images come, nearly
 * all of them are new, and without a GPU a frame that begins with all takes up to two seconds. */
bool scene_draw_slice(struct scene *scene, const struct surface_frame *frame,
		      struct scene_slice *slice, float cost)
{
	int64_t new_us = 0;
	float drawn = 0;
	for (; slice->program >= 0 && drawn < cost; slice->program--, slice->at = 0) {
		const int program = slice->program;
		const bool can_wait = surface_faces(program) > 0 && !frame->shares;
		const bool is_new = surface_is_new(&scene->surface, frame, program);
		if (slice->with[program] == 0)
			continue;
		if (is_new && can_wait && new_us > NEW_BUDGET_US) {
			do_without(scene, slice);
			continue;
		}
		const int64_t began_us = is_new ? clock_now_us() : 0;
		drawn += draw_with(scene, frame, slice, cost - drawn);
		new_us += is_new ? clock_now_us() - began_us : 0;
		if (slice->at < slice->count)
			break;
	}
	geometry_cull_none();
	return slice->program < 0;
}

void scene_resume_picture(void)
{
	glDisable(GL_BLEND);
	glEnable(GL_DEPTH_TEST);
	glDepthMask(GL_TRUE);
	glDepthFunc(GL_LESS);
}

void scene_begin_picture(const struct scene *scene)
{
	const uint8_t *sky = scene->root.background;
	scene_resume_picture();
	glClearColor(sky[0] / 255.0f, sky[1] / 255.0f, sky[2] / 255.0f, 0);
	glClear(GL_COLOR_BUFFER_BIT | GL_DEPTH_BUFFER_BIT);
}

struct surface_frame scene_surface_frame(const struct scene *scene, const struct view *view,
					 enum picture kind)
{
	const bool images = scene->options.mode != SCENE_POLYGONS && scene->repository.ready;
	return (struct surface_frame){
		.view = view,
		.root = &scene->root,
		.tiles = images ? &scene->tiles : NULL,
		.depth = &scene->depth,
		.repository = &scene->repository,
		/* What is drawn over several frames is seen when it is whole, so nothing of it has
		 * to fade: too many faces would only make it late. */
		.faces = scene->used.share < 1 ? (int)scene->used.faces : PLAN_ENTRIES,
		.rake = scene->tools.rake,
		.fog = scene_fog(scene),
		.even = scene->options.mode == SCENE_CORNERS,
		.shares = kind == PICTURE_SHARES,
		.is_direct = kind == PICTURE_DIRECT,
	};
}

void scene_draw_beside(struct scene *scene, const struct surface_frame *frame)
{
	scene_draw_stream(scene, frame);
	if (!frame->shares)
		scene_draw_backdrop(scene, frame->view);
	scene_draw_scenery(scene, frame);
}

void scene_draw_picture(struct scene *scene, const struct view *view, enum picture kind)
{
	const struct surface_frame frame = scene_surface_frame(scene, view, kind);
	struct scene_slice slice;
	scene_begin_slices(scene, &frame, scene->visible,
			   scene->visible_count + scene->leaving_count, &slice);
	scene_draw_slice(scene, &frame, &slice, INFINITY);
	scene_draw_beside(scene, &frame);
}
