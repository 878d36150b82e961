/* Where the eye is. Metres, z up. A value; no state.
 *
 * width_px x height_px is the framebuffer. A panel that hangs turned by rotation_deg clockwise
 * shows its framebuffer turned likewise; so the projection turns the picture anticlockwise in it,
 * and nothing else knows. The field of view is vertical for who stands before the panel. Pixels are
 * the framebuffer's: x right, y down, (0, 0) the corner of the first, (0.5, 0.5) its middle.
 *
 * Matrices are 16 floats, column by column, as GL takes them; clip space is GL's, z in -w..w. */
#ifndef GOPURA_GEOMETRY_CAMERA_H
#define GOPURA_GEOMETRY_CAMERA_H

#include <stdbool.h>

struct camera {
	float eye_m[3], target_m[3];
	float up[3];   /* need not be perpendicular; (0,0,1) but for looks straight down */
	float fov_deg; /* vertical */
	float near_m, far_m;
	int width_px, height_px;
	int rotation_deg; /* of the panel: 0, 90, 180, 270, clockwise; in the projection only */
	int shift_px[2];  /* right and up: where the picture lies in the framebuffer it is drawn
			     into; pixels are counted from the picture's corner all the same */
};

/* World to eye: the eye looks along -z, y is up. Where up runs along the line of sight another one
 * is taken, so that the matrix is always a rotation and a shift. */
void camera_view(const struct camera *camera, float out[16]);
/* Eye to clip space, the panel's rotation in it. */
void camera_projection(const struct camera *camera, float out[16]);
/* World to clip space. */
void camera_matrix(const struct camera *camera, float out[16]);
/* Of the picture as it is seen, rotation accounted for: width over height. */
float camera_aspect(const struct camera *camera);
/* How many pixels a length of one metre covers one metre before the eye. */
float camera_px_per_radian(const struct camera *camera);

/* The direction (unit vector, from the eye) that a pixel of the framebuffer looks along. */
void camera_ray(const struct camera *camera, float x_px, float y_px, float direction[3]);
/* Where a point appears. false: it is behind the eye, and the pixel is not set. Neither near, far
 * nor the framebuffer's edges are judged. */
bool camera_pixel(const struct camera *camera, const float point_m[3], float *x_px, float *y_px);

#endif
