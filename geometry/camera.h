/* The camera: where the eye is, what it looks at, and its projection. Metres, z up. A plain value
 * without hidden state.
 *
 * width_px x height_px is the size of the framebuffer. A panel that is mounted rotated clockwise by
 * rotation_deg shows its framebuffer rotated likewise. The projection therefore rotates the picture
 * anticlockwise inside the framebuffer; no other code knows about the rotation. The field of view
 * is the vertical one as seen by a visitor in front of the panel. Pixel coordinates are those of
 * the framebuffer: x right, y down; (0, 0) is the corner of the first pixel, (0.5, 0.5) its centre.
 *
 * Matrices are 16 floats in column-major order, as GL takes them. Clip space is GL's, with z in
 * -w..w. */
#ifndef GOPURA_GEOMETRY_CAMERA_H
#define GOPURA_GEOMETRY_CAMERA_H

#include <stdbool.h>

struct camera {
	float eye_m[3], target_m[3];
	/* need not be perpendicular to the view; (0,0,1) unless looking straight down */
	float up[3];
	float fov_deg; /* vertical */
	float near_m, far_m;
	int width_px, height_px;
	/* of the panel, clockwise: 0, 90, 180 or 270; the projection applies it */
	int rotation_deg;
	/* offset, right and up, of the picture in the framebuffer that it is drawn into; pixel
	 * coordinates still count from the picture's corner */
	int shift_px[2];
};

/* Writes the world-to-eye matrix: the eye looks along -z, y is up. Where up is parallel to the line
 * of sight, a fixed other up is used, so the matrix is always a rotation and a translation. */
void camera_view(const struct camera *camera, float out[16]);
/* Writes the eye-to-clip matrix. It includes the rotation of the panel. */
void camera_projection(const struct camera *camera, float out[16]);
/* Writes the world-to-clip matrix. */
void camera_matrix(const struct camera *camera, float out[16]);
/* Returns width over height of the picture as the visitor sees it, after the rotation of the
 * panel. */
float camera_aspect(const struct camera *camera);
/* Returns how many pixels a length of one metre covers at a distance of one metre from the eye, in
 * the middle of the picture. */
float camera_px_per_radian(const struct camera *camera);

/* Writes the direction (a unit vector) from the eye to the target. */
void camera_forward(const struct camera *camera, float out[3]);
/* Writes the direction (a unit vector, from the eye) in which a pixel of the framebuffer looks. */
void camera_ray(const struct camera *camera, float x_px, float y_px, float direction[3]);
/* Projects a point to framebuffer pixels. Returns false where the point is behind the eye; then the
 * pixel is not set. The point is not tested against the near plane, the far plane or the edges of
 * the framebuffer. */
bool camera_pixel(const struct camera *camera, const float point_m[3], float *x_px, float *y_px);

#endif
