/* Marks pixels, finds the part among them, and projects it back to the scan. */
#include "curator/session/tools.h"

#include <errno.h>
#include <stdlib.h>
#include <string.h>

#include "curator/select/part_cut.h"
#include "curator/select/strokes.h"
#include "geometry/vec.h"

void tools_init(struct tools *tools, struct site *site, struct region_set *set)
{
	*tools = (struct tools){ .site = site, .set = set };
}

static void drop_view(struct tools *tools)
{
	if (tools->has_superpixels)
		superpixels_finish(&tools->superpixels);
	free(tools->marks);
	free(tools->in_part);
	tools->marks = tools->in_part = NULL;
	tools->has_superpixels = tools->has_marks = false;
	tools->image = NULL;
}

void tools_finish(struct tools *tools)
{
	drop_view(tools);
}

static size_t pixel_count(const struct tools *tools)
{
	return (size_t)tools->image->width_px * tools->image->height_px;
}

int tools_look(struct tools *tools, const struct view_image *image, const struct camera *camera)
{
	drop_view(tools);
	if (!image)
		return 0;
	tools->image = image;
	tools->camera = *camera;
	tools->marks = calloc(pixel_count(tools), 1); /* MARK_UNKNOWN */
	tools->in_part = malloc(pixel_count(tools));
	if (!tools->marks || !tools->in_part) {
		drop_view(tools);
		return -ENOMEM;
	}
	return 0;
}

int tools_prepare(struct tools *tools)
{
	int rc;

	if (!tools->image || tools->has_superpixels)
		return 0;
	rc = superpixels_make(&tools->superpixels, tools->image);
	tools->has_superpixels = rc == 0;
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

static int change_region(struct tools *tools, bool take, bool through)
{
	const struct face_view view = { .camera = &tools->camera,
					.image = tools->image,
					.in_part = tools->in_part,
					.through = through };
	struct change change = { tools->set, !take };

	region_set_begin(tools->set);
	face_pick(&view, tools->site->mesh, &tools->site->blocks, put, &change);
	return region_set_commit(tools->set);
}

static int find_part(struct tools *tools, const uint8_t *marks)
{
	int rc = tools_prepare(tools);

	return rc == 0 ? part_cut(tools->in_part, marks, tools->image, &tools->superpixels) : rc;
}

static int lasso(struct tools *tools, const struct stroke *stroke)
{
	int rc = strokes_lasso(tools->in_part, tools->image->width_px, tools->image->height_px,
			       stroke);

	for (size_t i = 0; rc == 0 && i < pixel_count(tools); i++)
		tools->in_part[i] = tools->in_part[i] == MARK_PART;
	return rc;
}

static int heavy_lasso(struct tools *tools, const struct stroke *stroke)
{
	int rc = strokes_heavy_lasso(tools->in_part, tools->image->width_px,
				     tools->image->height_px, stroke);

	return rc == 0 ? find_part(tools, tools->in_part) : rc;
}

int tools_stroke(struct tools *tools, const struct message *message)
{
	const struct stroke stroke = { .points_px = (const float(*)[2])message->points_px,
				       .count = message->point_count,
				       .width_px = message->width_px };
	int rc;

	if (!tools->image)
		return -ESTALE;
	if (message->tool == TOOL_PART || message->tool == TOOL_REST) {
		strokes_paint(tools->marks, tools->image->width_px, tools->image->height_px,
			      &stroke,
			      message->tool == TOOL_PART ? MARK_PART_SEED : MARK_REST_SEED);
		tools->has_marks = true;
		return 0;
	}
	rc = message->tool == TOOL_LASSO ? lasso(tools, &stroke) : heavy_lasso(tools, &stroke);
	return rc == 0 ? change_region(tools, message->take, message->through) : rc;
}

int tools_apply(struct tools *tools, bool take, bool through)
{
	int rc;

	if (!tools->image)
		return -ESTALE;
	rc = find_part(tools, tools->marks);
	if (rc == 0)
		rc = change_region(tools, take, through);
	if (rc == 0)
		tools_clear(tools);
	return rc;
}

void tools_clear(struct tools *tools)
{
	if (tools->image)
		memset(tools->marks, MARK_UNKNOWN, pixel_count(tools));
	tools->has_marks = false;
}

bool tools_pick(const struct tools *tools, const float at_px[2], float point_m[3])
{
	float ray[3], forward[3], inverse_m;

	if (!tools->image || at_px[0] < 0 || at_px[1] < 0 ||
	    at_px[0] >= (float)tools->image->width_px || at_px[1] >= (float)tools->image->height_px)
		return false;
	inverse_m =
		tools->image
			->inverse_m[(size_t)at_px[1] * tools->image->width_px + (size_t)at_px[0]];
	if (inverse_m <= 0)
		return false;
	camera_forward(&tools->camera, forward);
	camera_ray(&tools->camera, at_px[0], at_px[1], ray);
	vec_copy(point_m, tools->camera.eye_m);
	vec_add_scaled(point_m, point_m, 1 / (inverse_m * vec_dot(ray, forward)), ray);
	return true;
}
