/* Draws the mask of the marked part: by its labels, and by its region where the labels are missing.
 */
#include "render/scene/scene_mark.h"

#include <string.h>

#include "base/log.h"
#include "render/scene/scene_labels.h"

bool scene_note_mark(struct scene *scene, const struct scene_mark *mark)
{
	char part[LABEL_ID_BYTES] = "";
	struct region region = { 0 };
	if (mark)
		region = mark->region;
	if (mark && mark->part && strlen(mark->part) < sizeof(part))
		memcpy(part, mark->part, strlen(mark->part));
	bool other = strcmp(part, scene->marked_part) != 0;
	bool changed = other || memcmp(&region, &scene->marked_region, sizeof(region)) != 0;
	scene->mark_serial += other;
	scene->is_marked = mark != NULL;
	scene->marked_region = region;
	memcpy(scene->marked_part, part, sizeof(part));
	return changed;
}

/* Calls visit for each visible piece that the marked part may cover: by its labels, and by its
 * region on patches whose labels are not here. */
static void each_piece(struct scene *scene, const struct view *view, bool by_labels,
		       void (*visit)(struct scene *, const struct view *,
				     const struct visible_piece *))
{
	if (!by_labels && scene->marked_region.kind == REGION_POINT)
		return;
	for (uint32_t i = 0; i < scene->visible_count; i++) {
		const struct visible_piece *v = &scene->visible[i];
		const struct geometry_patch *patch = &scene->geometry.patches[v->patch];
		const struct piece *piece = &patch->content.bvh.pieces[v->piece];
		const bool has_labels = scene_part_area(scene, v->patch);
		if (has_labels != by_labels)
			continue;
		if (has_labels ? !part_buffers_are_empty(&patch->part)
			       : region_meets_sphere(&scene->marked_region, piece->centre_m,
						     piece->radius_m))
			visit(scene, view, v);
	}
}

static void include(struct scene *scene, const struct view *view, const struct visible_piece *v)
{
	const struct geometry_patch *patch = &scene->geometry.patches[v->patch];
	const struct piece *piece = &patch->content.bvh.pieces[v->piece];
	outline_include(&scene->outline, view, piece->centre_m, piece->radius_m);
}

static void draw_region(struct scene *scene, const struct view *view, const struct visible_piece *v)
{
	(void)view;
	const struct piece *piece = &scene->geometry.patches[v->patch].content.bvh.pieces[v->piece];
	geometry_bind(&scene->geometry, v->patch);
	geometry_draw(&scene->geometry, piece->first_triangle, piece->triangle_count);
}

/* The area of a part is that of the whole patch, so the first of its pieces draws it. */
static void draw_area(struct scene *scene, const struct view *view, const struct visible_piece *v)
{
	(void)view;
	if (v > scene->visible && v[-1].patch == v->patch)
		return;
	geometry_bind(&scene->geometry, v->patch);
	part_buffers_draw(&scene->geometry.patches[v->patch].part);
}

void scene_draw_mask(struct scene *scene, const struct view *view, const struct gl_target *picture)
{
	outline_clear(&scene->outline);
	if (!scene->is_marked)
		return;
	each_piece(scene, view, true, include);
	each_piece(scene, view, false, include);
	if (outline_is_empty(&scene->outline))
		return;
	int rc = outline_begin(&scene->outline, picture, scene->view.width_px,
			       scene->view.height_px);
	if (rc < 0) {
		log_warn("render", "no outline of a part: %s", strerror(-rc));
		outline_clear(&scene->outline);
		return;
	}
	mark_begin(&scene->mark, view, &scene->root, &scene->marked_region);
	each_piece(scene, view, false, draw_region);
	part_renderer_begin(&scene->part, view, &scene->root);
	each_piece(scene, view, true, draw_area);
	outline_end(&scene->outline);
}
