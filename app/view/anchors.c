/* Projects the anchors of the parts, tests with rays whether the model hides them, and passes both
 * to the overlay. */
#include "app/view/anchors.h"

#include <math.h>

#include "geometry/vec.h"

enum { TESTS_A_FRAME = 3 };

static bool is_hidden(const struct eye *eye, const float anchor_m[3])
{
	const float off = navigator_keep_off_m(&eye->navigator);
	float direction[3], distance, free_m;

	vec_sub(direction, anchor_m, eye->camera.eye_m);
	distance = vec_length(direction);
	if (distance < off / 35)
		return false;
	vec_scale(direction, 1 / distance, direction);
	free_m = scene_clearance(eye->shown->scene, eye->camera.eye_m, direction, distance);
	return free_m < distance - fmaxf(off, 0.03f * distance);
}

static void test_some(struct anchors *anchors, const struct eye *eye, uint32_t count)
{
	const struct info *info = exhibit_info(eye->shown);
	const struct scene_frame *frame = &eye->shown->frame;

	/* Tests all anchors again if the eye moves, the frame still changes, or other triangles
	 * were drawn. Objects that are merely missing do not count, so a kiosk without a network
	 * comes to rest too. */
	if (eye->moves || frame->moving || anchors->tested_triangles != frame->triangles)
		anchors->to_test = count;
	if (anchors->to_test > count)
		anchors->to_test = count;
	anchors->tested_triangles = frame->triangles;
	for (int i = 0; i < TESTS_A_FRAME && anchors->to_test > 0; i++) {
		anchors->next = (anchors->next + 1) % count;
		anchors->hidden[anchors->next] =
			is_hidden(eye, info_part(info, anchors->next)->anchor_m);
		anchors->to_test--;
	}
}

/* Returns the diameter of the part on the panel, in pixels; 0 if it is only a point. */
static float size_on_panel(const struct camera *camera, const struct info_part *part)
{
	const float distance_m = vec_distance(part->anchor_m, camera->eye_m);

	return 2 * region_size_m(&part->region) * camera_px_per_radian(camera) /
	       fmaxf(distance_m, 0.01f);
}

void anchors_place(struct anchors *anchors, const struct eye *eye, const struct viewport *viewport,
		   const struct section *section)
{
	static struct overlay_anchor placed[OVERLAY_PARTS_MAX];
	struct overlay *overlay = exhibit_overlay(eye->shown);
	const struct info *info = exhibit_info(eye->shown);
	const struct rect rect = overlay_scene_rect(overlay);
	const uint32_t count = info_part_count(info);

	if (count == 0 || count > OVERLAY_PARTS_MAX)
		return;
	test_some(anchors, eye, count);
	for (uint32_t i = 0; i < count; i++) {
		struct overlay_anchor *a = &placed[i];
		const struct info_part *part = info_part(info, i);
		const bool before_eye =
			camera_pixel(&eye->camera, part->anchor_m, &a->x_px, &a->y_px);

		if (before_eye)
			viewport_from_panel(viewport, &a->x_px, &a->y_px);
		a->hidden = anchors->hidden[i];
		a->size_px = size_on_panel(&eye->camera, part);
		a->visible = before_eye && section_keeps(section, part->anchor_m) &&
			     a->x_px >= rect.x_px && a->y_px >= rect.y_px &&
			     a->x_px < rect.x_px + rect.width_px &&
			     a->y_px < rect.y_px + rect.height_px;
	}
	overlay_anchors(overlay, placed, count);
}

void anchors_test_again(struct anchors *anchors)
{
	anchors->to_test = OVERLAY_PARTS_MAX;
}

void anchors_on_release(void *data, const struct exhibit_change *change)
{
	struct anchors *anchors = data;

	(void)change;
	anchors->tested_triangles = 0;
}
