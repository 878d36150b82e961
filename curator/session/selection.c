/* Marks pixels, finds the part among them, and projects it back to the scan. */
#include "curator/session/selection.h"

#include <errno.h>
#include <stdlib.h>
#include <string.h>

#include "curator/select/part_cut.h"
#include "curator/select/strokes.h"
#include "geometry/vec.h"

void selection_init(struct selection *selection, struct site *site, struct region_set *set)
{
	*selection = (struct selection){ .site = site, .set = set };
}

void selection_leave(struct selection *selection)
{
	if (selection->has_superpixels)
		superpixels_finish(&selection->superpixels);
	free(selection->marks);
	free(selection->in_part);
	selection->marks = selection->in_part = NULL;
	selection->has_superpixels = selection->has_marks = false;
	selection->image = NULL;
}

static size_t pixel_count(const struct selection *selection)
{
	return (size_t)selection->image->width_px * selection->image->height_px;
}

int selection_look(struct selection *selection, const struct view_image *image,
		   const struct camera *camera)
{
	selection_leave(selection);
	selection->image = image;
	selection->camera = *camera;
	selection->marks = calloc(pixel_count(selection), 1); /* MARK_UNKNOWN */
	selection->in_part = malloc(pixel_count(selection));
	if (!selection->marks || !selection->in_part) {
		selection_leave(selection);
		return -ENOMEM;
	}
	return 0;
}

int selection_prepare(struct selection *selection)
{
	int rc;

	if (!selection->image || selection->has_superpixels)
		return 0;
	rc = superpixels_make(&selection->superpixels, selection->image);
	selection->has_superpixels = rc == 0;
	return rc;
}

/* ---- changes */

struct change {
	struct region_set *set;
	bool in;
};

static void put(void *user, uint32_t triangle)
{
	const struct change *change = user;

	region_set_put(change->set, triangle, change->in);
}

static int change_region(struct selection *selection, bool take, bool through)
{
	const struct face_view view = { .camera = &selection->camera,
					.image = selection->image,
					.in_part = selection->in_part,
					.through = through };
	struct change change = { selection->set, !take };

	region_set_begin(selection->set);
	face_pick(&view, selection->site->mesh, &selection->site->blocks, put, &change);
	return region_set_commit(selection->set);
}

static int find_part(struct selection *selection, const uint8_t *marks)
{
	int rc = selection_prepare(selection);

	return rc == 0 ? part_cut(selection->in_part, marks, selection->image,
				  &selection->superpixels)
		       : rc;
}

static int lasso(struct selection *selection, const struct stroke *stroke)
{
	int rc = strokes_lasso(selection->in_part, selection->image->width_px,
			       selection->image->height_px, stroke);

	for (size_t i = 0; rc == 0 && i < pixel_count(selection); i++)
		selection->in_part[i] = selection->in_part[i] == MARK_PART;
	return rc;
}

static int heavy_lasso(struct selection *selection, const struct stroke *stroke)
{
	int rc = strokes_heavy_lasso(selection->in_part, selection->image->width_px,
				     selection->image->height_px, stroke);

	return rc == 0 ? find_part(selection, selection->in_part) : rc;
}

int selection_stroke(struct selection *selection, const struct request *request)
{
	const struct stroke stroke = { .points_px = (const float(*)[2])request->points_px,
				       .count = request->point_count,
				       .width_px = request->width_px };
	int rc;

	if (!selection->image)
		return -ESTALE;
	if (request->tool == TOOL_PART || request->tool == TOOL_REST) {
		strokes_paint(selection->marks, selection->image->width_px,
			      selection->image->height_px, &stroke,
			      request->tool == TOOL_PART ? MARK_PART_SEED : MARK_REST_SEED);
		selection->has_marks = true;
		return 0;
	}
	rc = request->tool == TOOL_LASSO ? lasso(selection, &stroke)
					 : heavy_lasso(selection, &stroke);
	return rc == 0 ? change_region(selection, request->take, request->through) : rc;
}

int selection_apply(struct selection *selection, bool take, bool through)
{
	int rc;

	if (!selection->image)
		return -ESTALE;
	rc = find_part(selection, selection->marks);
	if (rc == 0)
		rc = change_region(selection, take, through);
	if (rc == 0)
		selection_clear(selection);
	return rc;
}

void selection_clear(struct selection *selection)
{
	if (selection->image)
		memset(selection->marks, MARK_UNKNOWN, pixel_count(selection));
	selection->has_marks = false;
}

bool selection_pick(const struct selection *selection, const float at_px[2], float point_m[3])
{
	float ray[3], forward[3], inverse_m;

	if (!selection->image || at_px[0] < 0 || at_px[1] < 0 ||
	    at_px[0] >= (float)selection->image->width_px ||
	    at_px[1] >= (float)selection->image->height_px)
		return false;
	inverse_m = selection->image->inverse_m[(size_t)at_px[1] * selection->image->width_px +
						(size_t)at_px[0]];
	if (inverse_m <= 0)
		return false;
	camera_forward(&selection->camera, forward);
	camera_ray(&selection->camera, at_px[0], at_px[1], ray);
	vec_copy(point_m, selection->camera.eye_m);
	vec_add_scaled(point_m, point_m, 1 / (inverse_m * vec_dot(ray, forward)), ray);
	return true;
}
