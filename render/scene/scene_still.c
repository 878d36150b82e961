/* Draws pictures at rest, in parts where they take long. */
#include "render/scene/scene_still.h"

#include <math.h>

#include "render/scene/scene_mark.h"
#include "render/scene/scene_picture.h"

/* A part is as much as so many slices of a reference picture: shorter ones cost the driver more
 * than a hand can feel. */
static const float slices = 4;

void scene_heed(struct scene *scene, bool (*waits)(void *data), void *data)
{
	scene->still.waits = waits;
	scene->still.data = data;
}

bool scene_still_is_begun(const struct scene *scene)
{
	return scene->still.is_begun;
}

void scene_still_forget(struct scene *scene)
{
	scene->still.is_begun = scene->still.sum_is_seen = false;
	accumulation_break(&scene->accumulation);
}

void scene_still_renew(struct scene *scene)
{
	scene->still.is_begun = false;
	accumulation_break(&scene->accumulation);
}

/* The last small picture, of a motion or after a stop, lacks the line around a marked part. */
static bool can_show_last(const struct scene *scene)
{
	return scene->still.sum_is_seen ||
	       (scene->enlargement.small.framebuffer && !scene->is_marked);
}

static void show_last(struct scene *scene, const struct gl_place *place)
{
	const struct view *view = &scene->view;
	if (scene->still.sum_is_seen)
		accumulation_show_sum(&scene->accumulation, place);
	else
		enlargement_end(&scene->enlargement, place, view->width_px, view->height_px);
}

/* Returns how much of a picture is drawn before something else may be done. */
static float part_cost(const struct scene *scene)
{
	const float reference = scene->references.cost;
	if (scene->effort.share >= 1 || !(reference > 0) || !scene->still.waits ||
	    !can_show_last(scene))
		return INFINITY;
	return slices * scene->effort.share * reference;
}

static void begin(struct scene *scene, bool changed)
{
	struct scene_still *still = &scene->still;
	float x, y;
	accumulation_offset(&scene->accumulation, changed, &x, &y);
	still->view = scene->view;
	view_jitter(&still->view, x, y);
	still->changed = changed;
	still->is_begun = true;
	scene_begin_picture(scene);
	const struct surface_frame frame = scene_surface_frame(scene, &still->view, PICTURE_ASIDE);
	scene_begin_slices(scene, &frame, scene->visible,
			   scene->visible_count + scene->leaving_count, &still->slice);
}

static bool is_awaited(const struct scene *scene)
{
	gl_finish(); /* or the driver would be told of all parts before the first is drawn */
	return scene->still.waits(scene->still.data);
}

/* Returns whether the picture is whole. */
static bool go_on(struct scene *scene, bool is_new)
{
	struct scene_still *still = &scene->still;
	const struct gl_target *frame = &scene->accumulation.frame;
	const struct gl_place place = { .framebuffer = frame->framebuffer };
	const struct surface_frame surface =
		scene_surface_frame(scene, &still->view, PICTURE_ASIDE);
	const float cost = part_cost(scene);
	/* what was done before it began took as long as a part */
	if (is_new && isfinite(cost) && is_awaited(scene))
		return false;
	while (!scene_draw_slice(scene, &surface, &still->slice, cost))
		if (is_awaited(scene))
			return false;
	scene_draw_beside(scene, &surface);
	scene_draw_mask(scene, &still->view, frame);
	outline_draw(&scene->outline, &place, frame->width_px, frame->height_px);
	still->is_begun = false;
	return true;
}

void scene_still_show(struct scene *scene, const struct gl_place *place, bool draws, bool changed)
{
	struct scene_still *still = &scene->still;
	if (draws) {
		gl_target_bind(&scene->accumulation.frame);
		scene_resume_picture();
		const bool is_new = !still->is_begun;
		if (is_new)
			begin(scene, changed);
		if (!go_on(scene, is_new)) {
			show_last(scene, place);
			return;
		}
		changed = still->changed;
	}
	accumulation_add(&scene->accumulation, place, changed);
	still->sum_is_seen = true;
}
