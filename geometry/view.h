/* What follows from a camera: axes, matrix, frustum, pixels. A value; no state, no GL. */
#ifndef GOPURA_GEOMETRY_VIEW_H
#define GOPURA_GEOMETRY_VIEW_H

#include <stdbool.h>

#include "geometry/camera.h"

struct view {
	float eye_m[3];
	float right[3], up[3], forward[3]; /* orthonormal, as the visitor sees it (not the panel) */
	float tan_x, tan_y;                /* of half the field of view */
	float focal_px;                    /* pixels of one unit of tangent, in the middle */
	float picture_px;                  /* width x height */
	float clip[16]; /* metres relative to the eye to clip space, as GL takes it */
	float cut[4];   /* shown is where dot(cut, p) <= cut[3], p metres from the eye: section.h */
	float side_normal[4][3]; /* left, right, bottom, top: inward, unit, through the eye */
	int width_px, height_px;
};

void view_from_camera(struct view *view, const struct camera *camera);
/* Moves the picture by a part of a pixel, for anti-aliasing by accumulation. */
void view_jitter(struct view *view, float x_px, float y_px);

/* Some of the model is cut away. */
bool view_is_cut(const struct view *view);
/* false: no part of the sphere is in the picture. True also of some that just miss a corner. */
bool view_sees_sphere(const struct view *view, const float centre_m[3], float radius_m);
/* Pixels that a sphere covers, at most the picture's; all of them when the eye is inside. */
float view_sphere_px(const struct view *view, const float centre_m[3], float radius_m);
/* Distance from the eye to the sphere's surface; 0 inside. */
float view_sphere_distance(const struct view *view, const float centre_m[3], float radius_m);

#endif
