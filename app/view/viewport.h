/* The picture on the panel: its size, how it is turned, and by how much it is shifted to spare the
 * panel. The visitor's pixels are those of the picture as the visitor sees it; the panel's are
 * those of the framebuffer. The two differ if the panel is rotated. Pure. */
#ifndef GOPURA_APP_VIEW_VIEWPORT_H
#define GOPURA_APP_VIEW_VIEWPORT_H

#include "geometry/camera.h"

struct viewport {
	int panel_width_px, panel_height_px; /* of the framebuffer */
	int rotation_deg;                    /* 0, 90, 180 or 270, as in a board's profile */
	int shift_px[2];                     /* of the picture: right and up */
	float px_per_mm;                     /* of the panel; estimated if its size is not known */
};

/* Return the size of the picture as the visitor sees it, in pixels: width and height are exchanged
 * if the panel is rotated by 90 or 270 degrees. */
int viewport_width_px(const struct viewport *viewport);
int viewport_height_px(const struct viewport *viewport); /* likewise */
/* Converts a point from the visitor's pixels to the panel's, in place. */
void viewport_to_panel(const struct viewport *viewport, float *x_px, float *y_px);
/* The reverse of viewport_to_panel. */
void viewport_from_panel(const struct viewport *viewport, float *x_px, float *y_px);
/* Converts a point on the glass to the point of the shifted picture shown there, both in the
 * visitor's pixels and in place. */
void viewport_unshift(const struct viewport *viewport, float *x_px, float *y_px);
/* Sets the panel's fields of *camera; leaves the pose. */
void viewport_set_camera(const struct viewport *viewport, struct camera *camera);

#endif
