/* Draws the marked part over the picture: by its labels, and by its region where the labels are
 * missing. */
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

/* Draws the region, only on patches whose labels are not here. */
static void draw_region(struct scene *scene, const struct view *view)
{
	const struct region *region = &scene->marked_region;
	uint32_t bound = HIERARCHY_NONE;
	mark_begin(&scene->mark, view, &scene->root, region);
	glEnableVertexAttribArray(0);
	glDisableVertexAttribArray(1);
	glDisableVertexAttribArray(2);
	for (uint32_t i = 0; i < scene->visible_count; i++) {
		const struct visible_piece *v = &scene->visible[i];
		const struct geometry_patch *patch = &scene->geometry.patches[v->patch];
		const struct piece *piece = &patch->content.bvh.pieces[v->piece];
		if (!region_meets_sphere(region, piece->centre_m, piece->radius_m) ||
		    scene_outline(scene, v->patch))
			continue;
		if (v->patch != bound)
			geometry_bind(&scene->geometry, v->patch);
		bound = v->patch;
		geometry_draw(piece->first_triangle, piece->triangle_count);
	}
	mark_end();
}

/* Calls draw for each visible patch whose outline lines are known. */
static void each_outlined_patch(struct scene *scene, void (*draw)(struct scene *, uint32_t patch))
{
	uint32_t before = HIERARCHY_NONE;
	for (uint32_t i = 0; i < scene->visible_count; i++) {
		const uint32_t patch = scene->visible[i].patch;
		if (patch != before && scene_outline(scene, patch))
			draw(scene, patch);
		before = patch;
	}
}

static void draw_tint(struct scene *scene, uint32_t patch)
{
	const struct outline_lines *lines = &scene->geometry.patches[patch].lines;
	if (lines->whole_count + lines->within_count == 0)
		return;
	geometry_bind(&scene->geometry, patch);
	outline_lines_tint(lines);
}

static void draw_lines(struct scene *scene, uint32_t patch)
{
	geometry_bind_base(&scene->geometry, patch);
	outline_lines_lines(&scene->geometry.patches[patch].lines);
}

void scene_draw_mark(struct scene *scene, const struct view *view)
{
	if (!scene->is_marked)
		return;
	if (scene->marked_region.kind != REGION_POINT)
		draw_region(scene, view);
	if (!scene->labels || !scene->marked_part[0])
		return;
	outline_renderer_begin_tints(&scene->outlines, view, &scene->root);
	each_outlined_patch(scene, draw_tint);
	outline_renderer_begin_lines(&scene->outlines, view, &scene->root);
	each_outlined_patch(scene, draw_lines);
	outline_renderer_end();
}
