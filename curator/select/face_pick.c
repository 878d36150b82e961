/* Projects points of triangles into the view and compares their depth with what it shows. */
#include "curator/select/face_pick.h"

#include <errno.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/spill.h"
#include "geometry/vec.h"

/* A point may lie behind what its pixel shows by so many widths of a pixel there: the picture has
 * the surface at the pixel's middle, and is drawn from simpler patches. */
static const float behind_px = 2;

struct picker {
	const struct face_view *view;
	float matrix[16], forward[3];
	uint32_t left, top, right,
		bottom; /* pixels of the part: right and bottom beyond the last */
};

int face_blocks_make(struct face_blocks *out, const struct mesh *mesh)
{
	out->count = (mesh->triangle_count + FACE_BLOCK_TRIANGLES - 1) / FACE_BLOCK_TRIANGLES;
	out->boxes_m = malloc((out->count + 1) * sizeof(*out->boxes_m));
	if (!out->boxes_m) {
		out->count = 0;
		return -ENOMEM;
	}
	for (uint32_t n = 0; n < out->count; n++) {
		for (int i = 0; i < 3; i++) {
			out->boxes_m[n][0][i] = INFINITY;
			out->boxes_m[n][1][i] = -INFINITY;
		}
	}
	for (uint32_t t = 0; t < mesh->triangle_count; t++) {
		float(*box)[3] = out->boxes_m[t / FACE_BLOCK_TRIANGLES];

		for (int k = 0; k < 3; k++) {
			const float *at = mesh->positions[mesh->triangles[t][k]];

			for (int i = 0; i < 3; i++) {
				box[0][i] = vec_least(box[0][i], at[i]);
				box[1][i] = vec_most(box[1][i], at[i]);
			}
		}
		spill_pass(t);
	}
	return 0;
}

void face_blocks_finish(struct face_blocks *blocks)
{
	if (!blocks)
		return;
	free(blocks->boxes_m);
	memset(blocks, 0, sizeof(*blocks));
}

/* Projects a point. Returns one over its distance along the line of sight; 0: behind the eye. */
static float project(const struct picker *picker, const float at[3], float px[2])
{
	const float *m = picker->matrix;
	const struct view_image *image = picker->view->image;
	const float x = m[0] * at[0] + m[4] * at[1] + m[8] * at[2] + m[12],
		    y = m[1] * at[0] + m[5] * at[1] + m[9] * at[2] + m[13],
		    w = m[3] * at[0] + m[7] * at[1] + m[11] * at[2] + m[15];

	if (w <= 0)
		return 0;
	px[0] = (x / w + 1) / 2 * (float)image->width_px;
	px[1] = (1 - y / w) / 2 * (float)image->height_px;
	return 1 / w;
}

/* Whether any of the box may be over the part. */
static bool box_may_be_in(const struct picker *picker, float box[2][3])
{
	float low[2] = { INFINITY, INFINITY }, high[2] = { -INFINITY, -INFINITY };

	for (int corner = 0; corner < 8; corner++) {
		const float at[3] = { box[corner & 1][0], box[corner >> 1 & 1][1],
				      box[corner >> 2][2] };
		float px[2];

		if (project(picker, at, px) <= 0)
			return true; /* around the eye */
		for (int i = 0; i < 2; i++) {
			low[i] = vec_least(low[i], px[i]);
			high[i] = vec_most(high[i], px[i]);
		}
	}
	return low[0] < (float)picker->right && high[0] >= (float)picker->left &&
	       low[1] < (float)picker->bottom && high[1] >= (float)picker->top;
}

/* Whether nothing is before a point. */
static bool is_shown(const struct view_image *image, uint32_t x, uint32_t y, float inverse_m)
{
	float farthest = INFINITY;

	/* On a surface seen at a slant, depth differs within a pixel. */
	for (uint32_t row = y > 0 ? y - 1 : 0; row <= y + 1 && row < image->height_px; row++) {
		for (uint32_t column = x > 0 ? x - 1 : 0;
		     column <= x + 1 && column < image->width_px; column++) {
			const float its = image->inverse_m[row * image->width_px + column];

			if (its > 0)
				farthest = vec_least(farthest, its);
		}
	}
	return inverse_m >= farthest * (1 - behind_px / image->px_per_radian);
}

static bool faces_eye(const struct picker *picker, const float *const corners[3])
{
	float ab[3], ac[3], normal[3], away[3];

	vec_sub(ab, corners[1], corners[0]);
	vec_sub(ac, corners[2], corners[0]);
	vec_cross(normal, ab, ac);
	vec_sub(away, corners[0], picker->view->camera->eye_m);
	return vec_dot(normal, away) < 0;
}

/* What the picture says of a point: 1, it is in the part; -1, it is not; 0, it is not shown. */
static int vote(const struct picker *picker, const float at[3])
{
	const struct view_image *image = picker->view->image;
	float px[2];
	const float inverse_m = project(picker, at, px);

	if (inverse_m <= 0 || px[0] < 0 || px[0] >= (float)image->width_px || px[1] < 0 ||
	    px[1] >= (float)image->height_px)
		return 0;
	const uint32_t x = (uint32_t)px[0], y = (uint32_t)px[1];
	if (!picker->view->through && !is_shown(image, x, y, inverse_m))
		return 0;
	return picker->view->in_part[y * image->width_px + x] ? 1 : -1;
}

/* A triangle of which the middle is seen belongs to where most of what is seen of it lies. */
static bool is_in(const struct picker *picker, const struct mesh *mesh, uint32_t triangle)
{
	/* Points of equal areas: the middle, and about halfway from it to corners and sides. */
	static const float points[][3] = {
		{ 1 / 3.f, 1 / 3.f, 1 / 3.f },   { 2 / 3.f, 1 / 6.f, 1 / 6.f },
		{ 1 / 6.f, 2 / 3.f, 1 / 6.f },   { 1 / 6.f, 1 / 6.f, 2 / 3.f },
		{ 5 / 12.f, 5 / 12.f, 1 / 6.f }, { 5 / 12.f, 1 / 6.f, 5 / 12.f },
		{ 1 / 6.f, 5 / 12.f, 5 / 12.f },
	};
	const float *corners[3];
	int sum = 0;

	for (int k = 0; k < 3; k++)
		corners[k] = mesh->positions[mesh->triangles[triangle][k]];
	if (!picker->view->through && !faces_eye(picker, corners))
		return false;
	for (unsigned n = 0; n < ARRAY_COUNT(points); n++) {
		float at[3];

		for (int i = 0; i < 3; i++)
			at[i] = points[n][0] * corners[0][i] + points[n][1] * corners[1][i] +
				points[n][2] * corners[2][i];
		const int its = vote(picker, at);
		if (n == 0 && its == 0)
			return false;
		sum += its;
	}
	return sum > 0;
}

/* Where the part is. Returns false if it has no pixel. */
static bool find_extent(struct picker *picker)
{
	const struct view_image *image = picker->view->image;

	picker->left = image->width_px;
	picker->top = image->height_px;
	picker->right = picker->bottom = 0;
	for (uint32_t y = 0, at = 0; y < image->height_px; y++) {
		for (uint32_t x = 0; x < image->width_px; x++, at++) {
			if (!picker->view->in_part[at])
				continue;
			picker->left = x < picker->left ? x : picker->left;
			picker->right = x >= picker->right ? x + 1 : picker->right;
			picker->top = y < picker->top ? y : picker->top;
			picker->bottom = y + 1;
		}
	}
	return picker->right > 0;
}

void face_pick(const struct face_view *view, const struct mesh *mesh,
	       const struct face_blocks *blocks, void (*found)(void *user, uint32_t triangle),
	       void *user)
{
	struct picker picker = { .view = view };

	camera_matrix(view->camera, picker.matrix);
	if (!find_extent(&picker))
		return;
	for (uint32_t n = 0; n < blocks->count; n++) {
		const uint32_t first = n * FACE_BLOCK_TRIANGLES;

		if (!box_may_be_in(&picker, blocks->boxes_m[n]))
			continue;
		for (uint32_t t = first;
		     t < mesh->triangle_count && t - first < FACE_BLOCK_TRIANGLES; t++)
			if (is_in(&picker, mesh, t))
				found(user, t);
	}
}
