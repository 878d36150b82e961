/* What is derived from a camera: axes, matrix, frustum and pixel sizes. A plain value without
 * hidden state or GL. */
#ifndef GOPURA_GEOMETRY_VIEW_H
#define GOPURA_GEOMETRY_VIEW_H

#include <stdbool.h>

#include "geometry/camera.h"

struct view {
	float eye_m[3];
	/* orthonormal, upright for the visitor (panel rotation excluded) */
	float right[3], up[3], forward[3];
	float tan_x, tan_y; /* tangents of half the field of view */
	/* pixels per unit of tangent, in the middle of the picture */
	float focal_px;
	float picture_px; /* width x height */
	float clip[16];   /* from metres relative to the eye to clip space, as GL takes it */
	/* the section plane (section.h): shown is where dot(cut, p) <= cut[3], p in metres from the
	 * eye */
	float cut[4];
	/* of the frustum's left, right, bottom and top plane; unit, pointing inward */
	float side_normal[4][3];
	int width_px, height_px;
};

/* Fills *view from a camera; no section plane is set. */
void view_from_camera(struct view *view, const struct camera *camera);
/* Shifts the picture by a fraction of a pixel, for anti-aliasing by accumulation. */
void view_jitter(struct view *view, float x_px, float y_px);

/* Returns whether a section plane cuts away part of the model. */
bool view_is_cut(const struct view *view);
/* Returns false where no part of the sphere is in the picture. It may return true for a sphere just
 * outside a corner of the frustum. */
bool view_sees_sphere(const struct view *view, const float centre_m[3], float radius_m);
/* Returns how many pixels a sphere covers, at most those of the picture; all of them where the eye
 * is inside the sphere. */
float view_sphere_px(const struct view *view, const float centre_m[3], float radius_m);
/* Returns the distance in metres from the eye to the surface of the sphere; 0 inside. */
float view_sphere_distance(const struct view *view, const float centre_m[3], float radius_m);

#endif
