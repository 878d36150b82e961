/* Where the eye is. Metres, z up. A value; no state. */
#ifndef GOPURA_RENDER_CAMERA_H
#define GOPURA_RENDER_CAMERA_H

struct camera {
	float eye_m[3], target_m[3];
	float up[3];   /* need not be perpendicular; (0,0,1) but for looks straight down */
	float fov_deg; /* vertical */
	float near_m, far_m;
	int width_px, height_px;
	int rotation_deg; /* of the panel: 0, 90, 180, 270, clockwise; in the projection only */
};

#endif
