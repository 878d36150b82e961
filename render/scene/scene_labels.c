/* Loads the labels of the release, finds the part under a pixel, and makes the area of the marked
 * part. */
#include "render/scene/scene_labels.h"

#include <errno.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "render/scene/scene_scenery.h"

bool scene_has_labels(const struct scene *scene)
{
	return scene->has_root &&
	       root_page_plain(&scene->root, scene->root_child_count) > ROOT_CHILD_LABELS;
}

void scene_drop_labels(struct scene *scene)
{
	free(scene->labels);
	free(scene->labels_offset);
	free(scene->labels_of);
	scene->labels = NULL;
	scene->labels_offset = scene->labels_of = NULL;
}

static int take_children(struct scene *scene, struct page *page)
{
	scene->labels_offset = calloc((size_t)page->child_count + 1, sizeof(uint32_t));
	if (!scene->labels_offset)
		return -ENOMEM;
	for (uint32_t i = 0; i < page->child_count; i++)
		scene->labels_offset[i + 1] = scene->labels_offset[i] + page->children[i].size;
	scene->labels = page->children;
	page->children = NULL;
	page->child_count = 0;
	return 0;
}

int scene_open_labels(struct scene *scene, struct bytes bytes)
{
	struct page page;
	int rc = page_decode(&page, bytes);
	if (rc < 0)
		return rc;
	rc = page.kind == PAGE_LABELS && page.child_count > 0 ? 0 : -EBADMSG;
	if (rc == 0)
		rc = label_page_decode(&scene->labels_of, scene->hierarchy.group_count,
				       page.child_count, page.payload);
	if (rc == 0)
		rc = take_children(scene, &page);
	page_finish(&page);
	if (rc < 0)
		scene_drop_labels(scene);
	return rc;
}

const char *scene_part(struct scene *scene, const struct camera *camera, float x_px, float y_px)
{
	float direction[3], distance = INFINITY, least = camera->near_m;
	struct geometry_hit hit;
	if (!scene->has_hierarchy || !scene->labels)
		return NULL;
	camera_ray(camera, x_px, y_px, direction);
	if (!section_clip(&scene->tools.section, camera->eye_m, direction, &least, &distance) ||
	    !geometry_ray(&scene->geometry, &scene->cut, camera->eye_m, direction, least, &distance,
			  &hit))
		return NULL;
	if (scene_ray_scenery(scene, camera->eye_m, direction, least, &distance) != SCENERY_NONE)
		return ""; /* it stands in front of the part */
	const uint32_t group = scene->hierarchy.patches[hit.patch].group;
	const struct label_group *labels = &scene->geometry.labels[group];
	if (scene->labels_of[group] == LABEL_NONE)
		return "";
	if (labels->patch_count == 0)
		return NULL;
	int part =
		label_part_at(labels, hit.patch - scene->hierarchy.groups[group].first_patch,
			      scene->geometry.patches[hit.patch].content.bvh.order[hit.on.triangle],
			      hit.on.u, hit.on.v);
	return part < 0 ? "" : labels->parts[part].id;
}

static int make_area(struct scene *scene, uint32_t patch, const struct label_group *labels)
{
	const struct hierarchy_patch *known = &scene->hierarchy.patches[patch];
	struct geometry_patch *out = &scene->geometry.patches[patch];
	struct part_area area = { 0 };
	int part = label_find(labels, scene->marked_part), rc = 0;
	if (part >= 0)
		rc = part_area_create(&area, &out->content.bvh, labels,
				      patch - scene->hierarchy.groups[known->group].first_patch,
				      (uint32_t)part);
	if (rc == 0)
		rc = part_buffers_make(&out->part, &area, scene->mark_serial);
	part_area_finish(&area);
	return rc;
}

bool scene_part_area(struct scene *scene, uint32_t patch)
{
	const uint32_t group = scene->hierarchy.patches[patch].group;
	const struct label_group *labels = &scene->geometry.labels[group];
	if (!scene->labels || !scene->marked_part[0])
		return false;
	if (scene->labels_of[group] == LABEL_NONE) /* no part touches this group */
		return true;
	if (labels->patch_count == 0)
		return false;
	if (scene->geometry.patches[patch].part.serial == scene->mark_serial)
		return true;
	return make_area(scene, patch, labels) == 0;
}
